"""Elements that change their mode in a run: what is looked for, and what happens then.

A function of an element (:mod:`antenna_pin.elements.modal`) is positive while its mode stays. It is located
as an event's is; what happens is the element's to say. All that passes at one instant is gathered and made
together, in rounds (:meth:`Modes.resolve`). What the search has not located passes by logic: a function that
is zero but for round-off where its rate is negative, one of a load where it is negative.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import Adjustments, Workspace, acting_in, first_modes, kernels
from antenna_pin.dynamics.acting import Acting
from antenna_pin.elements import FAMILIES, Change, Met, Modal, StickingFriction
from antenna_pin.elements.modal import AFTER, BLOW, CAPTURE
from antenna_pin.errors import MechanismError
from antenna_pin.simulation.blows import Blows, Result
from antenna_pin.simulation.moment import Moment
from antenna_pin.simulation.own_actions import GRAZE, Switch
from antenna_pin.simulation.passages import Blow, Struck, Turned
from antenna_pin.simulation.sticking import NeverSettlesError, Settling
from antenna_pin.simulation.switches import Changed, hold_of

__all__ = ["ZERO", "Modes"]

Array = NDArray[np.float64]

# Changes at one instant, for each element, from which on they would never end.
_AT_MOST = 100
# Of a function of angles and rates: what round-off leaves of it where it is zero.
ZERO = 1e-11


class _Pending(NamedTuple):
    """A function that was located at this instant: of which element in which mode, and its value there."""

    place: str
    number: int
    mode: int
    value: float


class _Passing(NamedTuple):
    """A function that passes: of which element, how that meets its joint, and what changes by it."""

    place: str
    number: int
    met: Met
    change: Change


class Modes:
    """The elements with modes of a run.

    Args:
        workspace: What the run works on.
        adjustments: Its elements as they are; written.

    Attributes:
        changed: What has happened, in order.
        done: What has been done since that was last forgotten, for who does it again to neighbours.
        grazed: Functions that were located at the last instant and do not pass: of elements by place, and
            their numbers.
    """

    def __init__(self, workspace: Workspace, adjustments: Adjustments) -> None:
        """Begin with what the system has."""
        self._workspace = workspace
        self._adjustments = adjustments
        self._moment = Moment(workspace)
        system = workspace.system
        self._acting: Mapping[str, Acting] = {
            one.place: one for one in acting_in(system) if isinstance(one.element, Modal)
        }
        self._holds = [one.name for one in system.holds]
        self.changed: list[Changed] = []
        self.done: list[Turned | Blow] = []
        self.grazed: set[tuple[str, int]] = set()
        self._rates = np.zeros(workspace.model.nv + workspace.manifold.nx)
        self._rest = Settling(workspace, adjustments, self._acting)
        self._blows = Blows(workspace, adjustments, self._acting)
        self._limit = _AT_MOST * (1 + len(self._acting))
        self._instant, self._taken = math.nan, 0

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._acting)

    def _element(self, place: str) -> Modal:
        element = self._adjustments.elements[place]
        assert isinstance(element, Modal)
        return element

    def _met(self, place: str, t: float, y: Array) -> Met:
        nq = self._workspace.model.nq
        angle, rate, _, _ = kernels.joint_motion(self._workspace.program, self._acting[place].block, y, nq)
        load = 0.0
        if self._element(place).holds:
            load = self._moment.set(t, y).load(self._holds.index(place))
        head = self._workspace.program[self._acting[place].block :][: kernels.PARAMETERS]
        first = nq + self._workspace.model.nv + int(head.view(kernels.ELEMENT)[0]["x"])
        own = tuple(float(y[first + k]) for k in range(len(self._element(place).integrals)))
        inertia = 0.0
        if self._element(place).weighs:
            inertia = self._moment.set(t, y).inertia(self._acting[place].block)
        return Met(t, float(angle), float(rate), load, own, inertia)

    def prepare(self, t: float, y: Array) -> None:
        """Bring all into the modes that they have before anything happens at the start of a run."""
        for place, value in first_modes(self._workspace.system, y, t):
            self._adjustments.set(place, value)

    def begin(self, t: float, y: Array) -> None:
        """Let happen what does at the start of a run; y is changed in place.

        What takes an impulse is recorded; modes in which elements begin are none of its changes.

        Raises:
            MechanismError: What sticks and what slips does not settle.
        """
        try:
            self.resolve((), t, y)
        except NeverSettlesError as error:
            raise MechanismError(
                f"{error}: what sticks and what slips at the start does not settle; give its friction a "
                "Stribeck rate, by which it falls bit by bit as it begins to slip"
            ) from None
        self.changed[:] = [one for one in self.changed if one.impulse != 0.0]

    def arm(self, place: str, key: str, t: float, y: Array) -> None:
        """Pass the state of its joint to an element with modes of which a number, or ``on``, was set."""
        element = self._adjustments.elements.get(place)
        if isinstance(element, Modal) and element.acts:
            change = element.moved(key, self._met(place, t, y))
            if change is not None:
                self._adjustments.change(place, change)

    def jammed(self, t: float, y: Array) -> str:
        """Return of which joints friction by load has no solution, as a part of a message; "" if of none."""
        return self._rest.jammed(t, y) if self._rest else ""

    def taken(self, y: Array) -> float:
        """Return what impulses and dampers have taken of the energy so far, but for works of motions [J]."""
        return self._blows.taken(y)

    def lost_at_start(self) -> list[tuple[int, float]]:
        """Return where in the state losses are booked, and what impulses took at the start of a run [J]."""
        return [(self._blows.losses[one.element], one.loss) for one in self.changed if one.time == 0.0]

    # --- what happens at one instant ------------------------------------------------------------------------

    def resolve(self, located: Sequence[Switch], t: float, y: Array) -> bool:
        """Let all happen that happens at one instant; y is changed in place.

        In rounds: what is captured, all together; else all blows, by one problem of impulses; else all other
        changes; else what rests and what slips. Behind each round all is looked at anew, so that nothing
        hangs on the order of elements.

        Args:
            located: Functions that have been found to pass here.
            t: Time [s].
            y: State.

        Returns:
            Whether anything was changed.

        Raises:
            NeverSettlesError: Changes at one instant would never end.
        """
        if t != self._instant:
            self._instant, self._taken = t, 0
        self._moment.set(t, y)
        pending = [
            _Pending(one.place, one.number, self._element(one.place).mode, self._value(one)[0])
            for one in located
        ]
        changed = False
        self.grazed = {(one.place, one.number) for one in pending if self._grazes(one, t, y)}
        pending = [one for one in pending if (one.place, one.number) not in self.grazed]
        while True:
            passing = self._passing(t, y, pending)
            self._taken += 1
            if self._taken > self._limit and (passing or located):
                raise NeverSettlesError(passing[0].place if passing else located[0].place)
            first = min((one.change.phase for one in passing), default=AFTER)
            together = [one for one in passing if one.change.phase == first]
            if together:
                before = dict(self._adjustments.elements)
                self._make(first, together, t, y)
                pending = self._still(pending, before, t, y)
            elif self._settle(t, y, [Switch(one.place, one.number) for one in pending]):
                pending = []
            else:
                break
            changed = True
        if not changed:
            for one in located:
                if hold_of(self._element(one.place), one.place, one.number, self._holds) < 0:
                    self._moment.set(t, y)
                    if self._value(one)[0] < -ZERO:
                        raise NeverSettlesError(one.place)
        return changed

    def _value(self, one: Switch | _Pending) -> tuple[float, float]:
        """Return a function and its rate at the moment's state."""
        hold = hold_of(self._element(one.place), one.place, one.number, self._holds)
        return self._moment.switch(self._acting[one.place].block, one.number, hold)

    def _grazes(self, one: Switch | _Pending, t: float, y: Array) -> bool:
        """Return whether a function that is about zero goes back from there, by its next derivative.

        The search finds zeros in the dense output, which is off by more than a step's end is. A function f
        with rate f' < 0 and f'' > 0 comes down to f - f'^2 / (2 f''): where that is above zero but for
        round-off nothing passes.
        """
        value, slope = self._value(one)
        if slope == 0.0 or value < -GRAZE:
            return False
        nq, nv = self._workspace.model.nq, self._workspace.model.nv
        self._workspace.derivative(t, y, self._rates)
        faster = y.copy()
        faster[nq : nq + nv] += self._rates[:nv]
        self._moment.set(t, faster)
        bend = self._value(one)[1] - slope
        self._moment.set(t, y)
        return bend > 0.0 and (slope > 0.0 or value - 0.5 * slope * slope / bend > -GRAZE)

    def _passing(self, t: float, y: Array, pending: Sequence[_Pending]) -> list[_Passing]:
        """Return what passes at this state, of each element what comes first."""
        known = {(one.place, one.number) for one in pending}
        self._moment.set(t, y)
        found = []
        for place in self._acting:
            element = self._element(place)
            numbers = [
                k
                for k in range(element.switches)
                if not self._rest.decides(place, k)
                and ((place, k) in known or self._passes(Switch(place, k), bool(known), t, y))
            ]
            if not numbers:
                continue
            met = self._met(place, t, y)
            self._moment.set(t, y)
            changes = [
                _Passing(place, k, met, change)
                for k in numbers
                if (change := element.passed(k, met)) is not None
            ]
            found += [min(changes, key=lambda one: one.change.phase)] if changes else []
        return found

    def _passes(self, one: Switch, first: bool, t: float, y: Array) -> bool:
        """Return whether a function that was not located passes; loads count behind the first round."""
        loaded = hold_of(self._element(one.place), one.place, one.number, self._holds) >= 0
        if loaded and first:
            return False
        value, slope = self._value(one)
        if loaded or abs(value) > ZERO:
            return value < 0.0
        return slope < -ZERO and not self._grazes(one, t, y)

    def _still(
        self, pending: Sequence[_Pending], before: Mapping[str, object], t: float, y: Array
    ) -> list[_Pending]:
        """Return which of the located functions still pass behind changes."""
        self._moment.set(t, y)
        found = []
        for one in pending:
            if (
                self._rest.decides(one.place, one.number)
                or self._adjustments.elements[one.place] is before[one.place]
            ):
                value, slope = self._value(one)
                if abs(value - one.value) <= ZERO * max(1.0, abs(one.value)) and slope <= 0.0:
                    found.append(one)
        return found

    def _make(self, phase: int, together: Sequence[_Passing], t: float, y: Array) -> None:
        """Make the changes of one round, with their impulses, and record them."""
        before = {place: self._element(place) for place in self._acting}
        results = {one.place: Result(one.met, one.change) for one in together}
        struck, alone = tuple[Struck, ...](), True
        if phase != BLOW:
            for place, one in results.items():
                self._adjustments.change(place, one.change)
        locked = phase == CAPTURE and {
            place: one
            for place, one in results.items()
            if self._element(place).holds and self._adjustments.holds(place)
        }
        if phase == BLOW:
            results, struck, alone = self._blows.make(results, t, y)
        elif locked:
            more, struck, alone = self._blows.make(locked, t, y)
            results |= more
        numbers = {one.place: one.number for one in together}
        for place, one in results.items():
            self._adjustments.change(place, one.change)
            for other in one.change.switches_off:
                self._adjustments.set(f"{other}.on", False)
        for place, one in results.items():
            changes = _by_function(numbers[place]) if place in numbers else _by_letting_go
            self.done.append(Turned(place, before[place], changes))
            self._record(
                place, one, t, y, one.change.what or self._element(place).change_said(before[place].mode)
            )
        if struck:
            self.done.append(Blow(self._workspace.program.copy(), struck, alone))

    def _settle(self, t: float, y: Array, located: Sequence[Switch]) -> bool:
        """Have what rests and what sticks agree; return whether any mode has changed."""
        shifts = self._rest.settle(t, y, located) if self._rest else []
        for place, before, met in shifts:
            element = self._element(place)
            what = element.change_said(before.mode)
            self._record(place, Result(met, Change(element.mode)), t, y, what)
            self.done.append(Turned(place, before, _by_sticking))
        return bool(shifts)

    def _record(self, place: str, result: Result, t: float, y: Array, what: str) -> None:
        """Record what has become of an element, if that has a name."""
        if not what:
            return
        element, one, (met, change, loss, blow) = self._element(place), self._acting[place], result
        self.changed.append(
            Changed(
                name=f"{FAMILIES[one.family].word} {one.name}: {what}",
                element=place,
                time=t,
                mode=element.modes[change.mode],
                angle=met.angle,
                rate=met.rate,
                rate_after=self._met(place, t, y).rate,
                loss=change.loss + loss,
                impulse=change.impulse + blow,
                energy=met.energy if element.weighs else math.nan,
            )
        )


def _by_function(number: int) -> Callable[[Modal, Met], Change | None]:
    return lambda element, met: element.passed(number, met)


def _by_letting_go(element: Modal, met: Met) -> Change | None:
    return element.lets_go()


def _by_sticking(element: Modal, met: Met) -> Change | None:
    return element.sticks(met) if isinstance(element, StickingFriction) else None
