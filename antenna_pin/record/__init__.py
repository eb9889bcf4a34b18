"""Recordings of runs in 3D, and pictures and videos of them by a real browser."""

from antenna_pin.record._browser import BrowserPrograms, find_browser

__all__ = ["BrowserPrograms", "find_browser"]
