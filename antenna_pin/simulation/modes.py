"""Elements that change their mode in a run: what is looked for, and what happens then.

A function of an element (:mod:`antenna_pin.elements.modal`) is positive while its mode stays. It is located
as an event's is; what happens is the element's to say. All that passes at one instant is gathered and made
together, in rounds (:meth:`Modes.resolve`). What the search has not located passes by logic: a function that
is zero but for round-off where its rate is negative, one of a load where it is negative.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from antenna_pin.constraints import rows_that_share
from antenna_pin.dynamics import Adjustments, Workspace, acting_in, first_modes
from antenna_pin.dynamics.acting import Acting
from antenna_pin.dynamics.restraints import check_restraint
from antenna_pin.elements import FAMILIES, Change, Met, Modal, StickingFriction
from antenna_pin.elements.modal import AFTER, BLOW, CAPTURE
from antenna_pin.errors import MechanismError
from antenna_pin.simulation.blows import Blows, Result
from antenna_pin.simulation.due import Due, Passing
from antenna_pin.simulation.ending import NeverSettlesError
from antenna_pin.simulation.own_actions import Switch
from antenna_pin.simulation.passages import Blow, Struck, Turned
from antenna_pin.simulation.sticking import Settling
from antenna_pin.simulation.switches import Changed

__all__ = ["Modes"]

Array = NDArray[np.float64]

# Changes at one instant, for each element, from which on they would never end.
_AT_MOST = 100


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
        system = workspace.system
        self._acting: Mapping[str, Acting] = {
            one.place: one for one in acting_in(system) if isinstance(one.element, Modal)
        }
        self._holds = [one.name for one in system.holds]
        self._due = Due(workspace, adjustments, self._acting)
        self.changed: list[Changed] = []
        self.done: list[Turned | Blow] = []
        self.grazed: set[tuple[str, int]] = set()
        self._rest = Settling(workspace, adjustments, self._acting)
        self._blows = Blows(workspace, adjustments, self._acting)
        #: What has held a freedom together with others, by name: how they share its load is not determined.
        self.shares: set[str] = set()
        self._limit = _AT_MOST * (1 + len(self._acting))
        self._instant, self._taken = math.nan, 0

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._acting)

    def _element(self, place: str) -> Modal:
        element = self._adjustments.elements[place]
        assert isinstance(element, Modal)
        return element

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
            change = element.moved(key, self._due.met(place, t, y))
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

    def is_due(self, t: float, y: Array) -> bool:
        """Return whether a function of any element passes at this state."""
        return bool(self._due.passing(t, y, (), lambda place, number: False))

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
        pending = [self._due.pending(one, t, y) for one in located]
        changed = False
        self.grazed = {(one.place, one.number) for one in pending if self._due.grazes(one, t, y)}
        pending = [one for one in pending if (one.place, one.number) not in self.grazed]
        while True:
            passing = self._due.passing(t, y, pending, self._rest.decides)
            self._taken += 1
            if self._taken > self._limit and (passing or located):
                raise NeverSettlesError(passing[0].place if passing else located[0].place)
            first = min((one.change.phase for one in passing), default=AFTER)
            together = [one for one in passing if one.change.phase == first]
            if together:
                before = dict(self._adjustments.elements)
                self._make(first, together, t, y)
                pending = self._due.still(pending, before, self._rest.decides, t, y)
            elif self._settle(t, y, [Switch(one.place, one.number) for one in pending]):
                pending = []
            else:
                break
            changed = True
        if changed and self._holds:
            self._see_shares(t, y)
        if not changed and (past := next((one for one in located if self._due.is_past(one, t, y)), None)):
            raise NeverSettlesError(past.place)
        return changed

    def _see_shares(self, t: float, y: Array) -> None:
        """Note which elements hold a freedom together with others."""
        constraints = self._workspace.constraints
        assert constraints is not None
        constraints.residuals(t, y, self._workspace.program)
        names = [self._holds[k] for k in rows_that_share(constraints)]
        names += [place for place in self._acting if self._rest.pushes(place)]
        self.shares.update(self._acting[name].label for name in names if name in self._acting)

    def _make(self, phase: int, together: Sequence[Passing], t: float, y: Array) -> None:
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
        for place in results if phase == BLOW else locked or ():
            check_restraint(self._workspace, self._adjustments, t, y, place, self._holds)
        if phase == BLOW:
            results, struck, alone = self._blows.make(results, t, y)
        elif locked:
            more, struck, alone = self._blows.make(locked, t, y)
            results |= more
        self._put(results, {one.place: one.number for one in together}, before, struck, alone, t, y)

    def drive(self, t: float, y: Array) -> float:
        """Give all the rates that motions have from now on, y in place; return their work [J].

        Raises:
            MechanismError: What is held has no such rates.
        """
        before, taken = {place: self._element(place) for place in self._acting}, self._blows.worked(y)
        results, struck, alone = self._blows.make({}, t, y)
        self._put(results, {}, before, struck, alone, t, y)
        return self._blows.worked(y) - taken

    def _put(
        self,
        results: Mapping[str, Result],
        numbers: Mapping[str, int],
        before: Mapping[str, Modal],
        struck: tuple[Struck, ...],
        alone: bool,
        t: float,
        y: Array,
    ) -> None:
        """Bring elements into their next modes, and record that."""
        for place, one in results.items():
            self._adjustments.change(place, one.change)
            for other in one.change.switches_off:
                self._adjustments.set(f"{other}.on", False)
        for place, one in results.items():
            changes = _by_function(numbers[place]) if place in numbers else _by_letting_go
            self.done.append(Turned(place, before[place], changes))
            what = one.change.what or self._element(place).change_said(before[place].mode)
            self._record(place, one, t, y, what)
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
                what=what,
                time=t,
                mode=element.modes[change.mode],
                angle=met.angle,
                rate=met.rate,
                rate_after=self._due.met(place, t, y).rate,
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
