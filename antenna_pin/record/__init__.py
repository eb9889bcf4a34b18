"""Recordings of runs in 3D, and pictures and videos of them by a real browser."""

from antenna_pin._lazy import exported

exported(__name__)
