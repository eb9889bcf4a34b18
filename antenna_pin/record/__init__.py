"""Recordings of runs in 3D, and pictures and videos of them by a real browser."""

from antenna_pin._lazy import only_public
from antenna_pin.record._browser import BrowserPrograms, find_browser
from antenna_pin.record.bending import bending_magnification
from antenna_pin.record.page import SharedHead, shared_head, viewer_megabytes
from antenna_pin.record.recording import Recording, View, record
from antenna_pin.record.several import record_several
from antenna_pin.record.video import Filmed, check_film, film_times, save_frames, save_picture, save_video

__all__ = [
    "BrowserPrograms",
    "Filmed",
    "Recording",
    "SharedHead",
    "View",
    "bending_magnification",
    "check_film",
    "film_times",
    "find_browser",
    "record",
    "record_several",
    "save_frames",
    "save_picture",
    "save_video",
    "shared_head",
    "viewer_megabytes",
]

only_public(__name__)
