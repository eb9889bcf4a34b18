r"""Joints at rest: consistent modes of sticking, slipping and resting on rigid stops.

Each joint with dry friction that is at rest has a torque :math:`\lambda` and an acceleration a, with

.. math:: a = 0,\ |\lambda| \le T \qquad\text{or}\qquad \lambda = -\mathrm{sign}(a)\, T,

and each at rest at a rigid stop, with both counted off it,

.. math:: 0 \le \lambda \quad\perp\quad a \ge 0,

which all interact. Frictions begin as sticking except those that have just let go, stops in their present
modes except those just left. Then all joints that violate their rule are pivoted, again and again; if that
does not reduce their number, only the first of them: block pivoting, with the least-index pivoting of Murty
and Bard as fallback, which ends at the unique solution if friction does not fall as a joint begins to slip.
As all are pivoted together, the result does not depend on their order, and equal joints behave alike. Where
friction falls at once there may be several solutions, or none: then pivoting may not end, which is an error.

A joint whose rate is prescribed, by a motion of its own or through couplings and loops, does not stick:
its friction slips by the sign of that rate, and keeps its mode while the joint is at rest.

A joint held at rest by others, as in a closed loop with more sticking joints than freedoms, has saturated
friction once its row has carried that much, and stays; so all must be overcome before one moves.
At a joint that sticks and rests on its stop either may carry the load: the motion is unique, not the share.

References:
    Kostreva (1978), Block pivot methods for solving the complementarity problem, Linear Algebra Appl. 21.
    Murty (1974), Note on a Bard-type scheme for solving the complementarity problem, Opsearch 11.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.dynamics import Adjustments, Workspace, impulse, kernels, prescribing
from antenna_pin.dynamics.adjust import Acting
from antenna_pin.dynamics.mode_kernels import grip_of
from antenna_pin.elements import Change, Met, RigidStop, StickingFriction, kind_of
from antenna_pin.elements.limits import FREE, LOWER, UPPER
from antenna_pin.elements.rigid_stop import LOADED
from antenna_pin.elements.sticking_friction import BACKWARD, FORWARD, PULLED, PUSHED, STUCK, UNDECIDED
from antenna_pin.run.simulation.element_events import NeverSettlesError, met_at
from antenna_pin.run.simulation.events import Switch

Array = NDArray[np.float64]

_AT_REST = 1e-11
# Distance at which a joint is at a stop [rad] ([m]). Height of a hop that is round-off: relative to the
# position of the stop, and for a stop at zero.
_AT_STOP, _HOP, _LEAST_HOP = 1e-11, 4.0 * np.finfo(float).eps, 1e-20
# Round-off of a stop's load and acceleration, relative to the largest ones; ten times as much each time that
# it is pivoted.
_SLACK = 1e-13
# Time ahead at which the next derivative is evaluated [s].
_SOON = 1e-6
# Acceleration that counts as zero [rad/s^2] ([m/s^2]).
_NO_MOTION = 1e-12
# Rounds of pivoting all that do not reduce the number of violations.
_PATIENCE = 4
# Relative error of the located torque at which a joint lets go.
_LOCATED = 1e-9
# Round-off of the compliance of a joint held by others, relative to the joint alone.
_HELD = 1e-9


class RestingChange(NamedTuple):
    """Change of mode: the element's place, its state before, and that of its joint."""

    place: str
    before: StickingFriction | RigidStop
    met: Met


class RestingJoints:
    """Joints of a run with dry friction or rigid stops."""

    def __init__(self, workspace: Workspace, adjustments: Adjustments, acting: Mapping[str, Acting]) -> None:
        """Find the joints."""
        self._workspace, self._adjustments = workspace, adjustments
        self._dry = [place for place, one in acting.items() if isinstance(one.element, StickingFriction)]
        self._stops = [place for place, one in acting.items() if isinstance(one.element, RigidStop)]
        self._acting = {place: acting[place] for place in (*self._dry, *self._stops)}
        names = [one.name for one in workspace.system.holds]
        self._hold = {place: names.index(place) for place in self._acting}
        self._others = [place for place in names if place not in self._acting]
        self._slot = {
            place: workspace.system.mechanism.joint(str(one.element.acts_at)).v.start
            for place, one in self._acting.items()
        }
        self._rates = np.zeros(workspace.model.nv + workspace.manifold.nx)
        # Joints that have begun to slip at the last event: they do not stick again there for being at rest.
        self._instant, self._gone = math.nan, set[str]()

    def __bool__(self) -> bool:
        """Return whether there are such joints."""
        return bool(self._acting)

    def pushes(self, place: str) -> bool:
        """Return whether an element is saturated friction at a joint held by others."""
        return place in self._dry and self._element(place).mode in (PUSHED, PULLED)

    def decides(self, place: str, number: int) -> bool:
        """Return whether changes by a function of an element are decided here."""
        return place in self._acting and (place in self._dry or number == LOADED)

    def _element(self, place: str) -> StickingFriction:
        element = self._adjustments.elements[place]
        assert isinstance(element, StickingFriction)
        return element

    def _stop_of(self, place: str) -> RigidStop:
        element = self._adjustments.elements[place]
        assert isinstance(element, RigidStop)
        return element

    def settle(self, t: float, y: Array, located: Sequence[Switch] = ()) -> list[RestingChange]:
        """Find consistent modes of the joints at rest; y is changed in place, by round-off.

        Returns:
            The changes of mode.

        Raises:
            NeverSettlesError: No consistent modes exist or are found.
        """
        before = {place: self._adjustments.elements[place] for place in self._acting}
        met = {
            place: met_at(self._workspace, self._acting[place], t, y)
            for place in self._dry
            if self._element(place).on
        }
        comes_to_rest = {one.place for one in located if one.place in met and one.number == 0}
        let_go = {one.place for one in located if one.place in met and one.number == 1}
        let_go = {place for place in let_go if self._element(place).mode == STUCK}
        loads = self._loads(t, y) if let_go else np.zeros(0)
        if t != self._instant:
            self._instant, self._gone = t, set()
        left = {one.place for one in located if one.place in self._stops and one.number == LOADED}
        resting = []
        for place, one in met.items():
            element = self._element(place)
            if prescribing(self._workspace, self._adjustments, t, y, self._slot[place], self._others):
                self._turn(place, element.follows(one))
                continue
            if element.prescribed:
                self._turn(place, element.is_free())
                element = self._element(place)
            comes = place in comes_to_rest and element.mode != UNDECIDED  # else it was switched on
            if comes or element.mode == STUCK or abs(one.rate) <= _AT_REST:
                resting.append(place)
                # Where a stop is left, saturated friction beside it may hold alone.
                pushes = element.mode in (PUSHED, PULLED) and not left
                if pushes or (place in self._gone and element.mode in (FORWARD, BACKWARD)):
                    continue
                if place in let_go:
                    change = element.slips(-math.copysign(1.0, loads[self._hold[place]]))
                else:
                    change = element.sticks(one)
            else:
                change = element.slips(math.copysign(1.0, one.rate))
            self._turn(place, change)
        sides = self._at_stops(t, y, met)
        for place in left:
            if self._stop_of(place).mode != FREE:
                self._turn(place, self._stop_of(place).lets_go())
        self._stop(t, y, resting)
        for place in let_go.intersection(resting):
            self._push(place, t, y)
        if resting or sides:
            self._agree(t, y, resting, sides, met, let_go | self._gone)
        self._gone = {place for place in resting if self._element(place).mode in (FORWARD, BACKWARD)}
        self._stop(t, y, [place for place in sides if self._stop_of(place).mode != FREE])
        after = {place: self._adjustments.elements[place] for place in before}
        return [
            RestingChange(place, one, met[place])
            for place, one in before.items()
            if isinstance(one, StickingFriction | RigidStop) and one != after[place]
        ]

    def _at_stops(self, t: float, y: Array, met: dict[str, Met]) -> dict[str, int]:
        """Return the sides of stops at which joints rest, by place; add them to ``met``."""
        sides = {}
        for place in self._stops:
            stop = self._stop_of(place)
            if not stop.on:
                continue
            one = met_at(self._workspace, self._acting[place], t, y)
            for side, gap, rate in (
                (LOWER, one.angle - stop.lowest, one.rate),
                (UPPER, stop.highest - one.angle, -one.rate),
            ):
                if stop.mode == side or (
                    stop.mode == FREE and abs(gap) <= _AT_STOP and self._stands(place, rate, side, t, y)
                ):
                    sides[place], met[place] = side, one
        return sides

    def _stands(self, place: str, rate: float, side: int, t: float, y: Array) -> bool:
        """Return whether a joint at a stop leaves it by no more than round-off."""
        if abs(rate) <= _AT_REST:
            return True
        if rate < 0.0:
            return False
        self._loads(t, y)
        back, stop = -self._off(place, side), self._stop_of(place)
        hop = max(_HOP * abs(stop.lowest if side == LOWER else stop.highest), _LEAST_HOP)
        return rate * rate < 2.0 * hop * back

    def _off(self, place: str, side: int) -> float:
        """Return a joint's acceleration off a side of its stop, as last evaluated."""
        return (1.0 if side == LOWER else -1.0) * float(self._rates[self._slot[place]])

    def jammed(self, t: float, y: Array) -> str:
        """Return the joints with unsolvable friction by load, as text; "" if none."""
        self._loads(t, y)
        if np.isfinite(self._rates[: self._workspace.model.nv]).all():
            return ""
        names = [self._acting[place].label for place in self._dry if self._element(place).under_load]
        return (
            f", {' or '.join(names)}: under its own load it jams, and no acceleration solves it"
            if names
            else ""
        )

    def _turn(self, place: str, change: Change) -> None:
        if change.mode != self._adjustments.elements[place].mode or change.memory:  # type: ignore[attr-defined]
            self._adjustments.change(place, change)

    def _stop(self, t: float, y: Array, resting: list[str]) -> None:
        """Remove round-off from the rates of joints that stick or rest."""
        nq, nv = self._workspace.model.nq, self._workspace.model.nv
        sticks = [place for place in resting if self._adjustments.holds(place)]
        if any(y[nq + self._slot[place]] != 0.0 for place in sticks):
            y[nq : nq + nv], _, _ = impulse(self._workspace, t, y, {})
            for place in sticks:
                y[nq + self._slot[place]] = 0.0

    def _loads(self, t: float, y: Array) -> Array:
        """Evaluate the derivative; return the loads of the rows."""
        self._workspace.derivative(t, y, self._rates)
        constraints = self._workspace.constraints
        return np.zeros(0) if constraints is None else constraints.loads().copy()

    def _grip(self, place: str) -> float:
        one = self._acting[place]
        first = one.block + int(kernels.PARAMETERS)
        return float(grip_of(kind_of(type(one.element)), self._workspace.program, first))

    def _agree(
        self,
        t: float,
        y: Array,
        resting: Sequence[str],
        sides: Mapping[str, int],
        met: Mapping[str, Met],
        let_go: set[str],
    ) -> None:
        """Pivot joints that violate their rule, until none does."""
        rows = (*resting, *sides)
        slack, foreseen = dict.fromkeys(sides, _SLACK), set[str]()
        fewest, patience = len(rows) + 1, _PATIENCE
        for _ in range(8 * (1 + len(rows)) ** 2):
            loads = self._loads(t, y)
            wrong = [place for place in resting if self._errs(place, y, loads, let_go)]
            wrong += [place for place in sides if self._errs_at_stop(place, sides[place], y, loads, slack)]
            # Saturated friction is pivoted as it is checked.
            pushing = [one for one in resting if self._element(one).mode in (PUSHED, PULLED)]
            count = len(wrong) + sum(not self._push(place, t, y) for place in pushing)
            if count == 0 and (soon := self._soon_at_stops(sides, foreseen, t, y)):
                foreseen.update(soon)
                for place in soon:
                    self._turn(place, self._stop_of(place).rests(sides[place]))
                    slack[place] = max(slack[place], _LOCATED)
                fewest, patience = len(rows) + 1, _PATIENCE
            elif count == 0:
                # Slipping friction against a stop that now holds the joint is saturated.
                slips = [one for one in resting if self._element(one).mode in (FORWARD, BACKWARD)]
                if not sides or not any([self._push(place, t, y) for place in slips]):
                    return
                fewest, patience = len(rows) + 1, _PATIENCE
            if count == 0:
                continue
            if count < fewest:
                fewest, patience = count, _PATIENCE
            else:
                patience -= 1
            for place in wrong if patience > 0 else wrong[:1]:
                if place in sides:
                    stop = self._stop_of(place)
                    self._turn(place, stop.rests(sides[place]) if stop.mode == FREE else stop.lets_go())
                    slack[place] *= 10.0
                elif self._element(place).mode == STUCK:
                    load = float(loads[self._hold[place]])
                    self._turn(place, self._element(place).slips(-math.copysign(1.0, load)))
                    self._push(place, t, y)
                else:
                    self._turn(place, self._element(place).sticks(met[place]))
                    let_go.add(place)
        raise NeverSettlesError(rows[0])

    def _soon_at_stops(self, sides: Mapping[str, int], foreseen: set[str], t: float, y: Array) -> list[str]:
        """Return joints at stops, without acceleration, that will soon press on them.

        As after friction lets go of a joint whose growing load presses on the stop.
        """
        model, nq = self._workspace.model, self._workspace.model.nq
        most = _LOCATED * float(np.abs(self._rates[: model.nv]).max(initial=0.0))
        still = [
            place
            for place, side in sides.items()
            if place not in foreseen
            and self._stop_of(place).mode == FREE
            and abs(self._off(place, side)) <= most + _LOCATED
        ]
        if not still:
            return []
        later, v = y.copy(), y[nq : nq + model.nv]
        later[:nq] = pin.integrate(model, y[:nq], _SOON * v)
        later[nq : nq + model.nv] += _SOON * self._rates[: model.nv]
        self._loads(t + _SOON, later)
        found = [place for place in still if self._off(place, sides[place]) < -_NO_MOTION - _SOON * most]
        self._loads(t, y)
        return found

    def _alone(self, place: str, y: Array) -> float:
        """Return the acceleration of a joint per torque there, with nothing held."""
        model, at = self._workspace.model, self._slot[place]
        return float(pin.computeMinverse(model, self._workspace.data, y[: model.nq])[at, at])

    def _errs_at_stop(
        self, place: str, side: int, y: Array, loads: Array, slack: Mapping[str, float]
    ) -> bool:
        """Return whether a stop pulls, or a joint off its stop penetrates it."""
        size = float(np.abs(loads).max(initial=0.0))
        if self._stop_of(place).mode != FREE:
            pushes = (1.0 if side == LOWER else -1.0) * float(loads[self._hold[place]])
            return pushes < -max(slack[place] * size, _NO_MOTION / self._alone(place, y))
        most = float(np.abs(self._rates[: self._workspace.model.nv]).max())
        return self._off(place, side) < -slack[place] * (most + self._alone(place, y) * size) - _NO_MOTION

    def _errs(self, place: str, y: Array, loads: Array, let_go: set[str]) -> bool:
        """Return whether a sticking joint is overloaded, or a slipping one moves backward.

        Friction that lets go at a located time carries its full grip and does not move, except for round-off.
        """
        element = self._element(place)
        if element.mode == STUCK:
            less = -_LOCATED if place in let_go else _LOCATED
            return abs(float(loads[self._hold[place]])) > self._grip(place) * (1.0 + less)
        if element.mode in (PUSHED, PULLED):
            return False
        forth = (1.0 if element.mode == FORWARD else -1.0) * float(self._rates[self._slot[place]])
        slack = _LOCATED * self._grip(place) * self._alone(place, y) if place in let_go else 0.0
        return forth < -slack

    def _push(self, place: str, t: float, y: Array) -> bool:
        """Set saturated friction where others hold the joint; return whether they do."""
        workspace, at = self._workspace, self._slot[place]
        element = self._element(place)
        forward = element.mode in (FORWARD, PUSHED)
        self._turn(place, Change(FORWARD if forward else BACKWARD))
        workspace.apply_elements(t, y, self._rates)
        effort = workspace.tau.copy()
        size = max(1.0, float(np.abs(effort).max()))
        free = workspace.acceleration(t, y, effort)[at]
        effort[at] += size
        yields = (workspace.acceleration(t, y, effort)[at] - free) / size
        held = bool(abs(yields) < _HELD * self._alone(place, y))
        if held:
            self._turn(place, Change(PUSHED if forward else PULLED))
        self._loads(t, y)
        return held
