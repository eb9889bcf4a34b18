"""HTML of recordings: shared head, embedded parts, and whole pages."""

from __future__ import annotations

import base64
import functools
import html
import json
import zlib
from collections.abc import Sequence
from importlib.resources import files
from typing import Any, NamedTuple

from antenna_pin.base.arguments import takes
from antenna_pin.base.views import policy, script
from antenna_pin.show.record.scene import viewer_licences, viewer_script

# The parts of the player, in the order in which they need one another.
_PARTS = ("numbers", "page", "triad", "scene", "eye", "overlay", "curve", "panel", "bar", "player", "slots")


def _asset(name: str) -> str:
    return files("antenna_pin.show.record").joinpath("player", name).read_text(encoding="utf-8")


def _player() -> str:
    """Return the player as one script, whose names are its own."""
    parts = "\n".join(_asset(f"{name}.js") for name in _PARTS)
    return f'(function () {{\n"use strict";\n{parts}}})();\n'


def _json(data: Any) -> str:
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", r"\u003c")


# Attribute of a script element with a deflated text (RFC 1950, base64).
_PACKED = 'type="application/zlib"'


def _deflated(text: str) -> str:
    return base64.b64encode(zlib.compress(text.encode(), 9)).decode()


class SharedHead(NamedTuple):
    """Shared part of a page's head for recordings."""

    html: str  # style and scripts
    scripts: tuple[str, ...]  # contents of its script elements, for the page's `pages.policy`


@takes()
def shared_head(*, packed: bool = False) -> SharedHead:
    """Return style and scripts of recordings, once per page, for its head.

    Args:
        packed: Whether the viewer is deflated, to a third: then recordings appear some time after the page.
    """
    scripts = script(viewer_script()), script(_player())
    viewer, player = (f"<script>{text}</script>\n" for text in scripts)
    if packed:
        viewer = f'<script {_PACKED} class="ap-viewer">{_deflated(scripts[0])}</script>\n'
    return SharedHead(
        f"<style>\n{_asset('player.css')}</style>\n"
        f'<script type="text/plain" class="ap-licences">{script(viewer_licences())}</script>\n'
        f"{viewer}{player}",
        scripts,
    )


@functools.cache
def viewer_megabytes() -> float:
    """Return the size of style and scripts in a page [MB]."""
    return 1e-6 * len(shared_head().html.encode())


def embedded(data: dict[str, Any], identity: str, height: str = "30rem", *, packed: bool = False) -> str:
    """Return a recording's part of a page whose head has :func:`shared_head`.

    Its scene is built when it is scrolled into view, so that a page may have many. ``identity`` is the
    element's unique id, ``height`` its CSS height; ``packed`` data are deflated.
    """
    name = html.escape(identity, quote=True)
    kind, text = (_PACKED, _deflated(_json(data))) if packed else ('type="application/json"', _json(data))
    return (
        f'<div class="ap-frame" id="{name}" style="height:{html.escape(height, quote=True)}"></div>\n'
        f'<script {kind} id="{name}-data">{text}</script>\n'
    )


def page(data: dict[str, Any]) -> str:
    """Return a page of one recording; ``window.recording`` is its player."""
    return _page(
        " - ".join(text for text in (data["title"], data["subtitle"]) if text),
        "html { color-scheme: light dark; } html, body { margin: 0; height: 100%; }\n"
        "#recording { height: 100vh; height: 100dvh; }",
        '<div id="recording" class="ap-whole"></div>\n'
        f'<script type="application/json" id="recording-data">{_json(data)}</script>\n',
    )


def page_of_several(recordings: Sequence[tuple[str, dict[str, Any]]], title: str) -> str:
    """Return a page of recordings below one another, each with its heading."""
    parts = "".join(
        f"<h2>{html.escape(heading)}</h2>\n{embedded(data, f'recording-{k}')}"
        for k, (heading, data) in enumerate(recordings)
    )
    style = """html { color-scheme: light dark; }
body { margin: 0 auto; max-width: 60rem; padding: 0 1rem 2rem; font: 1rem/1.4 system-ui, sans-serif; }
h1 { font-size: 1.3rem; } h2 { font-size: 1rem; margin: 1.6rem 0 0.4rem; }"""
    return _page(title, style, f"<h1>{html.escape(title)}</h1>\n{parts}")


def _page(title: str, style: str, body: str) -> str:
    head = shared_head()
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
{policy(*head.scripts)}<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{html.escape(title)}</title>
<style>
{style}
</style>
{head.html}</head>
<body>
{body}</body>
</html>
"""
