"""The run: steps, contact memory, events, sampling, stopping rules."""

from antenna_pin.simulation.events import Angle, Event, Force, Gap, Jump, Mark, Rate, Set, Stop, Time
from antenna_pin.simulation.moment import Moment
from antenna_pin.simulation.progress import Progress
from antenna_pin.simulation.run import simulate

__all__ = [
    "Angle",
    "Event",
    "Force",
    "Gap",
    "Jump",
    "Mark",
    "Moment",
    "Progress",
    "Rate",
    "Set",
    "Stop",
    "Time",
    "simulate",
]
