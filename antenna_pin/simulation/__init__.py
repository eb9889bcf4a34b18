"""The run: steps, contact memory, events, sampling, stopping rules."""

from antenna_pin.base.lazy import exported

exported(__name__)
