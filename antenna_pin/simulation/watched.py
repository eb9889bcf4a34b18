"""What a run looks for, in numbers: the compiled loop says in which steps something may happen."""

from __future__ import annotations

import numpy as np

from antenna_pin.dynamics import motion_block
from antenna_pin.engine import watch_kernels as kernels
from antenna_pin.simulation.events import Angle, ElementChange, Event, Force, Gap, Rate, Time
from antenna_pin.simulation.kinks import Passing
from antenna_pin.simulation.switches import Switching
from antenna_pin.simulation.watch import Watch

__all__ = ["Watched", "is_known"]


def is_known(event: Event) -> bool:
    """Whether compiled code knows an event's function: those of one's own it does not."""
    return isinstance(event.when, Angle | Rate | Gap | Force | Time | ElementChange | Passing | Switching)


class Watched:
    """The events of a run as compiled code sees them: a step may be one of those that it does not know.

    Args:
        watch: The run's.

    Attributes:
        numbers: As the kernels take them.
    """

    def __init__(self, watch: Watch) -> None:
        """Lay them out."""
        system = watch.moment.system
        self._watch = watch
        known = [k for k, event in enumerate(watch.events) if is_known(event)]
        self._places = [k for k in known if not isinstance(watch.events[k].when, Time | ElementChange)]
        functions = np.zeros(len(self._places), kernels.WATCHED)
        blocks = [system.program]
        for row, k in zip(functions, self._places, strict=True):
            event = watch.events[k]
            when = event.when
            row["parts"] = event.nodes
            if isinstance(when, Passing):
                row["what"], row["where"], row["number"] = kernels.KINK, when.block, when.number
            elif isinstance(when, Switching):
                row["what"], row["where"] = kernels.SWITCH, when.block
                row["number"], row["hold"] = when.number, when.hold
            elif isinstance(when, Angle | Rate):
                row["what"] = kernels.ANGLE if isinstance(when, Angle) else kernels.RATE
                row["where"], row["value"] = sum(map(len, blocks)), when.value
                blocks.append(motion_block(system, when.joint))
            elif isinstance(when, Gap | Force):
                row["what"] = kernels.GAP if isinstance(when, Gap) else kernels.FORCE
                row["where"], row["value"] = watch.moment.contact_number(when.contact), when.value
        self.numbers = kernels.Watched(
            functions=functions,
            program=np.concatenate(blocks),
            rates=np.zeros(system.model.nv + system.manifold.nx),
            instants=np.array([*watch.instants, *[np.inf] * (watch.tick is not None)], dtype=float),
            values=np.zeros(2),
            dips=np.zeros(6),
            unknown=len(watch.events) - len(known),
        )

    def renew(self) -> None:
        """Take over on which sides the functions are, and when controllers are called next."""
        if self._watch.tick is not None:
            self.numbers.instants[-1] = self._watch.tick
        for row, k in zip(self.numbers.functions, self._places, strict=True):
            row["side"] = self._watch.side(k)
