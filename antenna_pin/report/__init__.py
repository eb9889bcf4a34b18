"""One-file reports on any number of runs, to be read on a screen, a phone or paper."""

from antenna_pin.base.lazy import exported

exported(__name__)
