"""Thin faces: command line, sliders in a browser, FMU export."""

from antenna_pin.base.lazy import exported

exported(__name__)
