"""Recordings of runs in 3D, and pictures and videos of them by a real browser."""

from antenna_pin.base.lazy import exported

exported(__name__)
