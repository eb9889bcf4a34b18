"""The run: steps, contact memory, events, sampling, stopping rules."""

from antenna_pin.simulation.progress import Progress
from antenna_pin.simulation.run import simulate

__all__ = ["Progress", "simulate"]
