"""One-file reports on any number of runs, to be read on a screen, a phone or paper."""

from antenna_pin._lazy import exported

exported(__name__)
