"""Parameter estimation: numbers of a scenario from measured records."""

from antenna_pin.base.lazy import exported

exported(__name__)
