"""The browser that pages are opened with, found before any work is done."""

from __future__ import annotations

import os
import sys
import webbrowser

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
