"""Reports in one file on any number of runs, for screen, phone and paper."""

from antenna_pin.base.lazy import exported

exported(__name__)
