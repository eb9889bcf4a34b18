"""The recording that plays on the first page of the site, in the place of a picture of the player."""

from __future__ import annotations

import re
from pathlib import Path

from antenna_pin import load_scenario, simulate
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.show.record import record

_NAME = "recording.html"  # beside the site's own index
_DURATION = 0.6  # [s] with blows at both ends of the bore
_CURVES = ("|contact_force[elevation.radial-]|", "motion_acceleration[elevation]")
_PICTURE = re.compile(r"^\[!\[(.*)\]\(images/recording_player\.png\)\]\(recordings\.md\)$", re.MULTILINE)
_FRAME = """```{{raw}} html
<iframe src="../{name}" title="{title}" class="first-recording" loading="lazy"></iframe>
```"""


def add_recording(docs: Path) -> None:
    """Write the recording, and have the first page play it.

    Args:
        docs: Folder of the pages in the source of the site.

    Raises:
        SystemExit: The first page has no picture of the player, or more than one.
    """
    play, ideal = (
        uninterrupted(simulate(load_scenario("bai2020", case=case), duration=_DURATION))
        for case in ("case3", "case1")
    )
    record(play, ideal, curves=_CURVES).save(docs / "extra" / _NAME)
    page = docs / "index.md"
    text, count = _PICTURE.subn(lambda found: _FRAME.format(name=_NAME, title=found[1]), page.read_text())
    if count != 1:
        raise SystemExit(
            "docs: index.md must have the picture images/recording_player.png on a line, linked, once"
        )
    page.write_text(text)
