"""How results hang on the scenario's numbers: derivatives of all that a run gives, through its events."""

from antenna_pin.base.lazy import exported

exported(__name__)
