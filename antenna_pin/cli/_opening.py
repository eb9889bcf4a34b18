"""The browser that pages are opened with, found before any work is done."""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
import webbrowser
from collections.abc import Iterator
from html import escape
from pathlib import Path

from antenna_pin.errors import MissingToolError

# Of systems with X or Wayland: one of these names the screen, or a browser is named that needs none.
_SCREENS = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")


def browser_for_pages(command: str, way_out: str) -> webbrowser.BaseBrowser:
    """Return the browser.

    Args:
        command: Who asks, for the message.
        way_out: What to do where there is none.

    Raises:
        MissingToolError: There is no screen, or no browser.
    """
    if sys.platform not in ("win32", "darwin") and not any(os.environ.get(name) for name in _SCREENS):
        raise MissingToolError(
            f"{command}: a browser needs a screen, and none of {', '.join(_SCREENS)} is set; {way_out}"
        )
    try:
        return webbrowser.get()
    except webbrowser.Error:
        raise MissingToolError(f"{command}: a browser must be installed, found none; {way_out}") from None


@contextlib.contextmanager
def opened_by_file(browser: webbrowser.BaseBrowser, address: str) -> Iterator[bool]:
    """Open an address that has a key in it; yield whether the browser has started.

    Every user of a machine reads the command lines of all programs. That of the browser has the name of a
    file which leads to the address, and which this user alone can read while the block lasts.
    """
    with tempfile.TemporaryDirectory(prefix="antenna-pin-") as folder:
        page = Path(folder) / "open.html"
        with open(os.open(page, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as file:
            there = escape(address, quote=True)
            file.write(f'<!doctype html><meta http-equiv="refresh" content="0; url={there}">\n')
        yield browser.open(page.as_uri())
