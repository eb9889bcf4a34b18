"""Events of runs, to be found by completion: ``antenna_pin.events.<TAB>``.

An :class:`Event` is a function of a :class:`Moment` that passes zero, or one of :class:`Angle`,
:class:`Rate`, :class:`Gap`, :class:`Force`, :class:`Time` and :class:`ElementChange`; what it does is
:class:`Mark`, :class:`Stop`, :class:`Set` or :class:`Jump`. Given to ``simulate(events=[...])``.
"""

from antenna_pin._lazy import only_public
from antenna_pin.simulation import (
    Angle,
    ElementChange,
    Event,
    Force,
    Gap,
    Jump,
    Mark,
    Moment,
    Rate,
    Set,
    Stop,
    Time,
)

__all__ = [
    "Angle",
    "ElementChange",
    "Event",
    "Force",
    "Gap",
    "Jump",
    "Mark",
    "Moment",
    "Rate",
    "Set",
    "Stop",
    "Time",
]

only_public(__name__)
