"""Recordings of runs in 3D, and pictures and videos of them by a real browser."""

from antenna_pin.record._browser import BrowserPrograms, find_browser
from antenna_pin.record.page import shared_head
from antenna_pin.record.recording import Recording, View, record

__all__ = ["BrowserPrograms", "Recording", "View", "find_browser", "record", "shared_head"]
