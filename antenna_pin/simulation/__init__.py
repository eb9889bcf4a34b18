"""The run: steps, contact memory, events, sampling, stopping rules."""

from antenna_pin.simulation.progress import Progress
from antenna_pin.simulation.run import simulate
from antenna_pin.simulation.settings import ErrorScales, RunSettings

__all__ = ["ErrorScales", "Progress", "RunSettings", "simulate"]
