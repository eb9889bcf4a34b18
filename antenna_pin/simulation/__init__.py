"""The run: steps, contact memory, events, sampling, stopping rules."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.simulation.checkpoint import Checkpoint
    from antenna_pin.simulation.events import (
        Angle,
        ElementChange,
        Event,
        Force,
        Gap,
        Jump,
        Mark,
        Rate,
        Set,
        Stop,
        Time,
    )
    from antenna_pin.simulation.finish import UnsavedError
    from antenna_pin.simulation.keeper import CheckpointsWaitedWarning, NotKeptWarning
    from antenna_pin.simulation.moment import Moment
    from antenna_pin.simulation.progress import Progress
    from antenna_pin.simulation.run import simulate

__all__ = [
    "Angle",
    "Checkpoint",
    "CheckpointsWaitedWarning",
    "ElementChange",
    "Event",
    "Force",
    "Gap",
    "Jump",
    "Mark",
    "Moment",
    "NotKeptWarning",
    "Progress",
    "Rate",
    "Set",
    "Stop",
    "Time",
    "UnsavedError",
    "simulate",
]

loaded_when_used(
    __name__,
    {
        "checkpoint": "Checkpoint",
        "events": "Angle ElementChange Event Force Gap Jump Mark Rate Set Stop Time",
        "finish": "UnsavedError",
        "keeper": "CheckpointsWaitedWarning NotKeptWarning",
        "moment": "Moment",
        "progress": "Progress",
        "run": "simulate",
    },
)
