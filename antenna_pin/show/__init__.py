"""Rendering of results: figures, recordings, reports, cards and tables."""

from antenna_pin.base.lazy import exported

exported(__name__)
