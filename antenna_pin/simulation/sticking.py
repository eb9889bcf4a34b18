r"""Joints that rest together: which stick and which slip, and which stand on their rigid stops.

Each joint with dry friction that is at rest has a torque :math:`\lambda` and an acceleration a, with

.. math:: a = 0,\ |\lambda| \le T \qquad\text{or}\qquad \lambda = -\mathrm{sign}(a)\, T,

and each at rest at a rigid stop, with both counted off it,

.. math:: 0 \le \lambda \quad\perp\quad a \ge 0,

where what one does changes what the others need. Frictions begin as sticking but those that have just let go,
stops as they are but those that have just been left. Then all that do not keep their rule are turned over,
again and again; where that makes them no fewer, only the first of them: block pivoting, with the least-index
pivoting of Murty and Bard behind it, which ends at the one solution there is where friction does not fall as
a joint begins to slip. As all are turned over together, nothing hangs on their order, and what is alike does
alike. Where friction falls at once there may be several solutions, or none: then turning over may not end,
and that is said.

A joint whose rate motions prescribe, its own or that of others by couplings and loops, does not stick:
its friction slips by the sign of that rate, and stays as it was while the joint stands.

A joint that others hold at rest, as in a closed loop with more sticking joints than it has freedoms, has all
its friction pushing once its row has carried that much, and stays; so all must be overcome before one moves.
Of a joint that sticks and stands at its stop either may carry the load: the motion is unique, not the share.

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
from antenna_pin.dynamics.acting import Acting
from antenna_pin.elements import Change, Met, RigidStop, StickingFriction, kind_of
from antenna_pin.elements import kernels as of_elements
from antenna_pin.elements.limits import FREE, LOWER, UPPER
from antenna_pin.elements.rigid_stop import LOADED
from antenna_pin.elements.sticking_friction_kernels import BACKWARD, FORWARD, PULLED, PUSHED, STUCK, UNDECIDED
from antenna_pin.simulation.element_events import NeverSettlesError, met_at
from antenna_pin.simulation.events import Switch

__all__ = ["RestingJoints"]

Array = NDArray[np.float64]

_AT_REST = 1e-11
# A joint is at a stop that is no farther off [rad] ([m]). A hop off it is none that is lower than so many
# units of round-off of where the stop is, and at zero than this.
_AT_STOP, _HOP, _LEAST_HOP = 1e-11, 4.0 * np.finfo(float).eps, 1e-20
# Of a stop's load and acceleration, over the largest there are: round-off, ten times as much each time that
# it is turned over.
_SLACK = 1e-13
# When the next derivative is looked for [s].
_SOON = 1e-6
# An acceleration that is none [rad/s^2] ([m/s^2]).
_NO_MOTION = 1e-12
# Rounds in which turning over all makes those that do not keep their rule no fewer.
_PATIENCE = 4
# Of a grip: by what a torque at which a joint lets go, which is located, may be off.
_LOCATED = 1e-9
# Of what a joint would yield to a torque alone: what round-off leaves of that where others hold it.
_HELD = 1e-9


class RestingChange(NamedTuple):
    """A change of mode that has come about: which element's, as it was before, and what it met."""

    place: str
    before: StickingFriction | RigidStop
    met: Met


class RestingJoints:
    """The joints with dry friction, and those with rigid stops, of a run.

    Args:
        workspace: What the run works on.
        adjustments: Its elements as they are; written.
        acting: Elements with modes, by place.
    """

    def __init__(self, workspace: Workspace, adjustments: Adjustments, acting: Mapping[str, Acting]) -> None:
        """Find them."""
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
        # Joints that have begun to slip at the last instant: they do not stick again there for being at rest.
        self._instant, self._gone = math.nan, set[str]()

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._acting)

    def pushes(self, place: str) -> bool:
        """Return whether an element is friction that pushes with all it has at a joint that others hold."""
        return place in self._dry and self._element(place).mode in (PUSHED, PULLED)

    def decides(self, place: str, number: int) -> bool:
        """Return whether what passes by a function of an element is decided here."""
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
        """Bring those that are at rest into modes that agree; y is changed in place, by round-off.

        Args:
            t: Time [s].
            y: State.
            located: Functions by which some have come to rest, or have let go.

        Returns:
            The changes of mode.

        Raises:
            NeverSettlesError: There are no such modes, or none are found.
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
                # Where a stop is left, what pushed beside it may hold alone.
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
        """Return at which side of their stops joints stand, by place; and how they meet them, in ``met``."""
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
        """Return whether a joint at a stop moves off it by no more than round-off, if at all."""
        if abs(rate) <= _AT_REST:
            return True
        if rate < 0.0:
            return False
        self._loads(t, y)
        back, stop = -self._off(place, side), self._stop_of(place)
        hop = max(_HOP * abs(stop.lowest if side == LOWER else stop.highest), _LEAST_HOP)
        return rate * rate < 2.0 * hop * back

    def _off(self, place: str, side: int) -> float:
        """Return the acceleration of a joint off a side of its stop, of the last evaluation."""
        return (1.0 if side == LOWER else -1.0) * float(self._rates[self._slot[place]])

    def jammed(self, t: float, y: Array) -> str:
        """Return of which joints friction by load has no solution, as a part of a message; "" if of none."""
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
        """Take away what round-off leaves of the rates of those that stick, or rest."""
        nq, nv = self._workspace.model.nq, self._workspace.model.nv
        sticks = [place for place in resting if self._adjustments.holds(place)]
        if any(y[nq + self._slot[place]] != 0.0 for place in sticks):
            y[nq : nq + nv], _, _ = impulse(self._workspace, t, y, {})
            for place in sticks:
                y[nq + self._slot[place]] = 0.0

    def _loads(self, t: float, y: Array) -> Array:
        """Evaluate; return what rows carry."""
        self._workspace.derivative(t, y, self._rates)
        constraints = self._workspace.constraints
        return np.zeros(0) if constraints is None else constraints.loads().copy()

    def _grip(self, place: str) -> float:
        one = self._acting[place]
        first = one.block + int(kernels.PARAMETERS)
        return float(of_elements.grip(kind_of(type(one.element)), self._workspace.program, first))

    def _agree(
        self,
        t: float,
        y: Array,
        resting: Sequence[str],
        sides: Mapping[str, int],
        met: Mapping[str, Met],
        let_go: set[str],
    ) -> None:
        """Turn over what does not keep its rule, until all do."""
        rows = (*resting, *sides)
        slack, foreseen = dict.fromkeys(sides, _SLACK), set[str]()
        fewest, patience = len(rows) + 1, _PATIENCE
        for _ in range(8 * (1 + len(rows)) ** 2):
            loads = self._loads(t, y)
            wrong = [place for place in resting if self._errs(place, y, loads, let_go)]
            wrong += [place for place in sides if self._errs_at_stop(place, sides[place], y, loads, slack)]
            # Those that push against others turn over as they are looked at.
            pushing = [one for one in resting if self._element(one).mode in (PUSHED, PULLED)]
            count = len(wrong) + sum(not self._push(place, t, y) for place in pushing)
            if count == 0 and (soon := self._soon_at_stops(sides, foreseen, t, y)):
                foreseen.update(soon)
                for place in soon:
                    self._turn(place, self._stop_of(place).rests(sides[place]))
                    slack[place] = max(slack[place], _LOCATED)
                fewest, patience = len(rows) + 1, _PATIENCE
            elif count == 0:
                # What slips against a stop that now holds the joint pushes.
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
        """Return joints at their stops that do not accelerate, but for round-off, and soon go into them.

        As where friction lets go of a joint that its growing load presses to the stop.
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
        """Return the acceleration of a joint over a torque there, with nothing held."""
        model, at = self._workspace.model, self._slot[place]
        return float(pin.computeMinverse(model, self._workspace.data, y[: model.nq])[at, at])

    def _errs_at_stop(
        self, place: str, side: int, y: Array, loads: Array, slack: Mapping[str, float]
    ) -> bool:
        """Return whether a stop pulls, or a joint that is off it goes into it."""
        size = float(np.abs(loads).max(initial=0.0))
        if self._stop_of(place).mode != FREE:
            pushes = (1.0 if side == LOWER else -1.0) * float(loads[self._hold[place]])
            return pushes < -max(slack[place] * size, _NO_MOTION / self._alone(place, y))
        most = float(np.abs(self._rates[: self._workspace.model.nv]).max())
        return self._off(place, side) < -slack[place] * (most + self._alone(place, y) * size) - _NO_MOTION

    def _errs(self, place: str, y: Array, loads: Array, let_go: set[str]) -> bool:
        """Return whether a joint that sticks carries too much, or one that slips goes the other way.

        What lets go here, which is located, carries all its grip and does not move yet, but for round-off.
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
        """Have one that slips push if others hold it, or the other way round; return whether they do."""
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
