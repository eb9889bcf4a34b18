r"""Joints with dry friction that are at rest together: which of them stick, and which slip.

Each that is at rest has a torque of friction :math:`\lambda` and an acceleration a, with

.. math:: a = 0,\ |\lambda| \le T \qquad\text{or}\qquad \lambda = -\mathrm{sign}(a)\, T,

where what one does changes what the others need. All begin as sticking but one that has just let go; then
the first in order that does not keep its rule is turned over, again and again: the least-index pivoting of
Murty and Bard for linear complementarity, which ends at the one solution there is where friction does not
fall as a joint begins to slip. Where it falls at once there may be several, or none: then turning over does
not end, and that is said.

A joint whose rate motions prescribe, its own or that of others by couplings and loops, does not stick:
its friction slips by the sign of that rate, and stays as it was while the joint stands.

A joint that others hold at rest, as in a closed loop with more sticking joints than it has freedoms, has all
its friction pushing once its row has carried that much, and stays; so all must be overcome before one moves.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.dynamics import Adjustments, Workspace, impulse, kernels, prescribing
from antenna_pin.dynamics.acting import Acting
from antenna_pin.elements import Change, Met, Modal, StickingFriction, kind_of
from antenna_pin.elements import kernels as of_elements
from antenna_pin.elements.sticking_friction_kernels import BACKWARD, FORWARD, PULLED, PUSHED, STUCK
from antenna_pin.simulation.own_actions import Switch

__all__ = ["NeverSettlesError", "Settling", "Shift"]

Array = NDArray[np.float64]

_AT_REST = 1e-11
# Of a grip: by what a torque at which a joint lets go, which is located, may be off.
_LOCATED = 1e-9
# Of what a joint would yield to a torque alone: what round-off leaves of that where others hold it.
_HELD = 1e-9


class NeverSettlesError(Exception):
    """Changes of mode at one instant would never end; of which element."""


class Shift(NamedTuple):
    """A change of mode that has come about: which element's, as it was before, and what it met."""

    place: str
    before: StickingFriction
    met: Met


class Settling:
    """The joints with dry friction of a run.

    Args:
        workspace: What the run works on.
        adjustments: Its elements as they are; written.
        acting: Elements with modes, by place.
    """

    def __init__(self, workspace: Workspace, adjustments: Adjustments, acting: Mapping[str, Acting]) -> None:
        """Find them."""
        self._workspace, self._adjustments = workspace, adjustments
        self._acting = {
            place: one
            for place, one in acting.items()
            if isinstance(one.element, Modal) and one.element.together
        }
        names = [one.name for one in workspace.system.holds]
        self._hold = {place: names.index(place) for place in self._acting}
        self._others = [place for place in names if place not in self._acting]
        self._slot = {
            place: workspace.system.mechanism.joint(str(one.element.acts_at)).v.start
            for place, one in self._acting.items()
        }
        self._rates = np.zeros(workspace.model.nv + workspace.manifold.nx)

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._acting)

    def __contains__(self, place: str) -> bool:
        """Whether an element is one of them."""
        return place in self._acting

    def _element(self, place: str) -> StickingFriction:
        element = self._adjustments.elements[place]
        assert isinstance(element, StickingFriction)
        return element

    def settle(self, t: float, y: Array, action: Switch | None = None) -> list[Shift]:
        """Bring those that are at rest into modes that agree; y is changed in place, by round-off.

        Args:
            t: Time [s].
            y: State.
            action: The one that has come to rest, or has let go, if one has.

        Raises:
            NeverSettlesError: There are no such modes, or none are found.
        """
        met = {place: self._met(place, t, y) for place in self._acting if self._element(place).on}
        before = {place: self._element(place) for place in met}
        if action is not None and action.number == 1:
            loads = self._loads(t, y)
        resting = []
        for place, one in met.items():
            element = self._element(place)
            if prescribing(self._workspace, self._adjustments, t, y, self._slot[place], self._others):
                self._turn(place, element.follows(one))
                continue
            if element.prescribed:
                self._turn(place, element.is_free())
                element = self._element(place)
            comes = action is not None and action.place == place and action.number == 0
            if comes or element.mode == STUCK or abs(one.rate) <= _AT_REST:
                resting.append(place)
                if element.mode in (PUSHED, PULLED):
                    continue
                if action is not None and action.place == place and action.number == 1:
                    change = element.slips(-math.copysign(1.0, loads[self._hold[place]]))
                else:
                    change = element.sticks(one)
            else:
                change = element.slips(math.copysign(1.0, one.rate))
            self._turn(place, change)
        self._stop(t, y, resting)
        if action is not None and action.number == 1 and action.place in resting:
            self._push(action.place, t, y)
        self._agree(t, y, resting, met)
        return [Shift(place, before[place], one) for place, one in met.items()]

    def jammed(self, t: float, y: Array) -> str:
        """Return of which joints friction by load has no solution, as a part of a message; "" if of none."""
        self._loads(t, y)
        if np.isfinite(self._rates[: self._workspace.model.nv]).all():
            return ""
        names = [self._acting[place].label for place in self._acting if self._element(place).under_load]
        return (
            f", {' or '.join(names)}: under its own load it jams, and no acceleration solves it"
            if names
            else ""
        )

    def _met(self, place: str, t: float, y: Array) -> Met:
        block, nq = self._acting[place].block, self._workspace.model.nq
        angle, rate, _, _ = kernels.joint_motion(self._workspace.program, block, y, nq)
        return Met(t, float(angle), float(rate), 0.0)

    def _turn(self, place: str, change: Change) -> None:
        if change.mode != self._element(place).mode or change.memory:
            self._adjustments.change(place, change)

    def _stop(self, t: float, y: Array, resting: list[str]) -> None:
        """Take away what round-off leaves of the rates of those that stick."""
        nq, nv = self._workspace.model.nq, self._workspace.model.nv
        sticks = [place for place in resting if self._element(place).mode == STUCK]
        if any(y[nq + self._slot[place]] != 0.0 for place in sticks):
            y[nq : nq + nv], _, _ = impulse(self._workspace, t, y, {})
            for place in sticks:
                y[nq + self._slot[place]] = 0.0

    def _loads(self, t: float, y: Array) -> Array:
        """Evaluate; return what rows carry."""
        self._workspace.derivative(t, y, self._rates)
        assert self._workspace.constraints is not None
        return self._workspace.constraints.loads().copy()

    def _grip(self, place: str) -> float:
        one = self._acting[place]
        first = one.block + int(kernels.PARAMETERS)
        return float(of_elements.grip(kind_of(type(one.element)), self._workspace.program, first))

    def _agree(self, t: float, y: Array, resting: list[str], met: Mapping[str, Met]) -> None:
        settled: set[str] = set()
        for _ in range(8 * (1 + len(resting)) ** 2):
            loads = self._loads(t, y)
            for place in resting:
                if place not in settled and self._turned_over(place, t, y, loads, met[place]):
                    settled.clear()
                    break
                settled.add(place)
            else:
                return
        raise NeverSettlesError(resting[0])

    def _turned_over(self, place: str, t: float, y: Array, loads: Array, met: Met) -> bool:
        """Turn one over if it does not keep its rule; return whether it did not."""
        element, load = self._element(place), float(loads[self._hold[place]])
        if element.mode == STUCK:
            if abs(load) <= self._grip(place) * (1.0 + _LOCATED):
                return False
            self._turn(place, element.slips(-math.copysign(1.0, load)))
            self._push(place, t, y)
            return True
        direction = 1.0 if element.mode in (FORWARD, PUSHED) else -1.0
        if element.mode in (PUSHED, PULLED):
            return not self._push(place, t, y)
        if direction * self._rates[self._slot[place]] >= 0.0:
            return False
        self._turn(place, element.sticks(met))
        needed = float(self._loads(t, y)[self._hold[place]])
        if -direction * needed < self._grip(place) * (1.0 - _LOCATED):
            return True
        # It lets go here: that it does not move yet is round-off.
        self._turn(place, element.slips(direction))
        self._loads(t, y)
        return False

    def _push(self, place: str, t: float, y: Array) -> bool:
        """Have one that slips push if others hold it, or the other way round; return whether they do."""
        workspace, at = self._workspace, self._slot[place]
        assert workspace.constraints is not None
        element = self._element(place)
        forward = element.mode in (FORWARD, PUSHED)
        self._turn(place, Change(FORWARD if forward else BACKWARD))
        workspace.apply_elements(t, y, self._rates)
        effort = workspace.tau.copy()
        size = max(1.0, float(np.abs(effort).max()))
        free = workspace.acceleration(t, y, effort)[at]
        effort[at] += size
        yields = (workspace.acceleration(t, y, effort)[at] - free) / size
        alone = pin.computeMinverse(workspace.model, workspace.data, y[: workspace.model.nq])[at, at]
        held = bool(abs(yields) < _HELD * alone)
        if held:
            self._turn(place, Change(PUSHED if forward else PULLED))
        self._loads(t, y)
        return held
