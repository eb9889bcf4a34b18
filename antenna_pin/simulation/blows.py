"""The impulses of one instant: of rigid stops that are struck, of rigid latches that capture.

All that are struck at one instant are one problem (:func:`antenna_pin.dynamics.push_apart`). Joints that
rest on stops leave them where they are taken off; friction is finite, bears no impulse, and slips where its
joint moves behind it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Adjustments, Push, Workspace, apart, kernels, push_apart
from antenna_pin.dynamics.acting import Acting
from antenna_pin.elements import GROSS_WORK, LOSS, WORK, Change, Met, Modal, Motion, StickingFriction
from antenna_pin.errors import MechanismError
from antenna_pin.simulation.due import met_at
from antenna_pin.simulation.own_actions import STILL
from antenna_pin.simulation.passages import Struck

__all__ = ["Blows", "Result"]

Array = NDArray[np.float64]


class Result(NamedTuple):
    """A change of an element, as it meets its joint before, with the impulse that it takes.

    Attributes:
        met: How it met its joint.
        change: Of its mode.
        loss: Energy that the impulse takes [J].
        impulse: On the child [N m s] ([N s]).
    """

    met: Met
    change: Change
    loss: float = 0.0
    impulse: float = 0.0


class Blows:
    """Makes the impulses of a run's elements.

    Args:
        workspace: What the run works on.
        adjustments: Its elements as they are.
        acting: Elements with modes, by place.

    Attributes:
        losses: Where in the state each books what is lost, by place.
    """

    def __init__(self, workspace: Workspace, adjustments: Adjustments, acting: Mapping[str, Acting]) -> None:
        """Find where in the state what impulses take and do is booked."""
        self._workspace, self._adjustments, self._acting = workspace, adjustments, acting
        self._holds = [one.name for one in workspace.system.holds]
        at = workspace.model.nq + workspace.model.nv
        heads = {
            place: workspace.program[one.block :][: kernels.PARAMETERS].view(kernels.ELEMENT)[0]
            for place, one in acting.items()
        }
        self.losses = {
            place: at + int(heads[place]["x"]) + one.element.integrals.index(LOSS)
            for place, one in acting.items()
        }
        self._slots = {place: int(heads[place]["v"]) for place in acting}
        #: Of each motion of the plan where its work and its gross work stand in a state.
        self._works = [
            [at + one.x + Motion.integrals.index(which) for which in (WORK, GROSS_WORK)]
            for one in workspace.system.motions
        ]

    def taken(self, y: Array) -> float:
        """Return what these elements have lost so far, but for works of motions [J]."""
        return float(sum(y[k] for k in self.losses.values()) - self.worked(y))

    def worked(self, y: Array) -> float:
        """Return the work of motions so far [J]."""
        return float(sum(y[k] for k, _ in self._works))

    def _element(self, place: str) -> Modal:
        element = self._adjustments.elements[place]
        assert isinstance(element, Modal)
        return element

    def make(
        self, together: Mapping[str, Result], t: float, y: Array
    ) -> tuple[dict[str, Result], tuple[Struck, ...], bool]:
        """Make impulses, all together; y is changed in place.

        Args:
            together: Stops that joints come to, or rigid latches that hold them by now, by place.
            t: Time [s].
            y: State.

        Returns:
            What becomes of elements, by place: of these, unless others keep their joint from its stop; of
            those that joints rested on and leave; of friction that no longer sticks. Further those of which
            impulses are, and whether none of these feels the others.
        """
        ways = {
            place: -math.copysign(1.0, one.met.rate)
            for place, one in together.items()
            if one.change.restitution is not None
        }
        pushes = [
            Push(self._slots[place], way, float(together[place].change.restitution or 0.0))
            for place, way in ways.items()
        ]
        resting, loose = self._one_sided()
        pushes += [Push(self._slots[place], way, 0.0) for place, way in resting.items()]
        others = {place: met_at(self._workspace, self._acting[place], t, y) for place in (*resting, *loose)}
        free = [self._holds.index(place) for place in others]
        found = push_apart(self._workspace, t, y, pushes, free)
        if not found.met:
            raise MechanismError(
                "impulse: motions, closures, couplings and locks ask for rates that exclude each other; "
                "take one of them away"
            )
        nq, nv = self._workspace.model.nq, self._workspace.model.nv
        y[nq : nq + nv] = found.velocity
        for (work, gross), done in zip(self._works, found.works.tolist(), strict=True):
            y[work] += done
            y[gross] += abs(done)
        results, struck = {}, []
        sizes = dict(zip(ways, found.pushes, strict=False))
        rates = dict(zip((*ways, *resting), found.rates, strict=True))
        for place, one in together.items():
            if place in ways and sizes[place] <= 0.0:
                continue
            if place in ways:
                blow = ways[place] * float(sizes[place])
                loss = -0.5 * blow * (one.met.rate + ways[place] * float(rates[place]))
            else:
                hold = self._holds.index(place)
                blow, loss = float(found.holds[hold]), float(found.lost[hold])
            y[self.losses[place]] += loss
            results[place] = one._replace(loss=loss, impulse=blow)
            back = one.change.restitution or None
            struck.append(Struck(place, self._slots[place], self._acting[place].block, back))
        for place in resting:
            change = self._element(place).lets_go()
            if rates[place] > STILL and change is not None:
                results[place] = Result(others[place], change)
        for place in loose:
            element, rate = self._element(place), met_at(self._workspace, self._acting[place], t, y).rate
            if abs(rate) > STILL and isinstance(element, StickingFriction):
                results[place] = Result(others[place], element.slips(rate))
        alone = len(struck) < 2 or apart(
            self._workspace,
            t,
            y,
            [one.at for one in struck],
            {*free, *(self._holds.index(place) for place in together)},
        )
        return results, tuple(struck), alone

    def _one_sided(self) -> tuple[dict[str, float], list[str]]:
        """Return stops that joints rest on, with the way that each pushes, and what bears no impulse."""
        resting, loose = {}, []
        for place in self._holds:
            if place in self._acting and self._adjustments.holds(place):
                least, most = self._element(place).bears
                if least == most:
                    loose.append(place)
                elif 0.0 in (least, most):
                    resting[place] = 1.0 if least == 0.0 else -1.0
        return resting, loose

    def _met(self, place: str, t: float, y: Array) -> Met:
        block, nq = self._acting[place].block, self._workspace.model.nq
        angle, rate, _, _ = kernels.joint_motion(self._workspace.program, block, y, nq)
        return Met(t, float(angle), float(rate), 0.0)
