"""Contact law studies: impacts, comparisons, and a measured joint."""

from antenna_pin.base.lazy import exported

exported(__name__)
