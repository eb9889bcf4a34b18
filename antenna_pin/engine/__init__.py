"""How the steps of a run are made: their pace, and the compiled loop of them."""

from antenna_pin.base.lazy import exported

exported(__name__)
