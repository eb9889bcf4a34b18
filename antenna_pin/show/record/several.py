"""Several runs on one page, one recording below the other."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable, replacing
from antenna_pin.errors import InvalidParameterError
from antenna_pin.show.record.page import page_of_several
from antenna_pin.show.record.recording import record
from antenna_pin.trajectory import Trajectory

# Key frames of each in all; short runs have as many as they have samples.
_FPS = 1e6


@takes()
def record_several(
    runs: Iterable[Trajectory], path: str | os.PathLike[str], title: str, max_megabytes: float = 5.0
) -> Path:
    """Write one page with a recording of each run, headed by its case.

    Every sample is a key frame, and there are no curves: for runs of few samples, such as the swings of mode
    shapes, which have no series but their motion.

    Args:
        runs: The runs, one or more.
        path: Path of the page, ``NAME.html``; returned.
        title: Title of the page.
        max_megabytes: Largest size of each recording, the viewer included [MB].

    Raises:
        AntennaPinError: A run that cannot be recorded, or a page that cannot be written.
    """
    target = check_writable(path, ".html")
    made = [
        (str(run.data.attrs.get("case") or run.data.attrs.get("title") or f"run {k}"), run)
        for k, run in enumerate(runs, 1)
    ]
    if not made:
        raise InvalidParameterError("recording", "runs", "at least one", 0)
    parts = [
        (heading, record(run, fps=_FPS, curves=(), max_megabytes=max_megabytes).data) for heading, run in made
    ]
    with replacing(target) as partial:
        partial.write_text(page_of_several(parts, title), encoding="utf-8", errors="backslashreplace")
    return target
