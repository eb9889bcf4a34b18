"""What every room may use, and nothing of mechanics: parameters, checks, units, text, files, state."""

from antenna_pin.base.lazy import exported

exported(__name__)
