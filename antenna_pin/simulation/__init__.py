"""The run: steps, contact memory, events, sampling, stopping rules."""

from antenna_pin._lazy import exported

exported(__name__)
