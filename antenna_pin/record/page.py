"""The HTML around recordings: what they share, each recording's own part, and a page of one recording."""

from __future__ import annotations

import html
import json
from collections.abc import Sequence
from importlib.resources import files
from typing import Any

from antenna_pin.record.scene import viewer_licences, viewer_script

__all__ = ["embedded", "page", "page_of_several", "shared_head"]


def _asset(name: str) -> str:
    return files("antenna_pin.record").joinpath(name).read_text(encoding="utf-8")


def _script(text: str) -> str:
    """Return a script element; what would end it early is written in another way."""
    return "<script>\n" + text.replace("</script", r"<\/script").replace("<!--", r"<\!--") + "\n</script>\n"


def _json(data: Any) -> str:
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", r"\u003c")


def shared_head() -> str:
    """Return style and scripts that recordings need, once per page, for its head."""
    licences = viewer_licences().replace("</script", "<\\/script")
    return (
        f"<style>\n{_asset('player.css')}</style>\n"
        f'<script type="text/plain" class="ap-licences">\n{licences}\n</script>\n'
        f"{_script(viewer_script())}{_script(_asset('player.js'))}"
    )


def embedded(data: dict[str, Any], identity: str, height: str = "26rem") -> str:
    """Return the part of a page that shows one recording; the page's head must have :func:`shared_head`.

    Its scene is built when it is scrolled into view, so that a page may have many.

    Args:
        data: Of the recording.
        identity: The element's id, unique in the page.
        height: Of the element, CSS.
    """
    name = html.escape(identity, quote=True)
    return (
        f'<div class="ap-frame" id="{name}" style="height:{html.escape(height, quote=True)}"></div>\n'
        f'<script type="application/json" id="{name}-data">{_json(data)}</script>\n'
        f"<script>AntennaPin.later({_json(identity)});</script>\n"
    )


def page(data: dict[str, Any]) -> str:
    """Return a page that shows one recording and nothing else; ``window.recording`` is its player."""
    title = html.escape(" - ".join(text for text in (data["title"], data["subtitle"]) if text))
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>html, body {{ margin: 0; height: 100%; }} #recording {{ height: 100vh; height: 100dvh; }}</style>
{shared_head()}</head>
<body>
<div id="recording"></div>
<script type="application/json" id="recording-data">{_json(data)}</script>
<script>
window.recording = AntennaPin.mount(
  document.getElementById("recording"), JSON.parse(document.getElementById("recording-data").textContent)
);
</script>
</body>
</html>
"""


def page_of_several(recordings: Sequence[tuple[str, dict[str, Any]]], title: str) -> str:
    """Return a page that shows several recordings, one below the other, each with its heading.

    Args:
        recordings: Heading and data of each.
        title: Of the page.
    """
    parts = "".join(
        f"<h2>{html.escape(heading)}</h2>\n{embedded(data, f'recording-{k}')}"
        for k, (heading, data) in enumerate(recordings)
    )
    said = html.escape(title)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{said}</title>
<style>
body {{ margin: 0 auto; max-width: 60rem; padding: 0 1rem 2rem; font: 1rem/1.4 system-ui, sans-serif; }}
h1 {{ font-size: 1.3rem; }} h2 {{ font-size: 1rem; margin: 1.6rem 0 0.4rem; }}
</style>
{shared_head()}</head>
<body>
<h1>{said}</h1>
{parts}</body>
</html>
"""
