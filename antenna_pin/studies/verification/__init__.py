"""Requirements verified: runs, worst cases, probabilities, and the numbers of one report."""

from antenna_pin.base.lazy import exported

exported(__name__)
