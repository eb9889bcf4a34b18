"""Steps of a run: their pace, and the compiled loop."""

from antenna_pin.base.lazy import exported

exported(__name__)
