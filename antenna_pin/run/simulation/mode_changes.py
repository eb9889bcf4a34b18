"""Changes of mode of elements, with the impulses of rigid stops and latches."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import (
    Adjustments,
    Push,
    System,
    Workspace,
    acting_in,
    apart,
    first_modes,
    kernels,
    push_apart,
)
from antenna_pin.dynamics.adjust import Acting
from antenna_pin.dynamics.constraints import rows_that_share
from antenna_pin.dynamics.impulse import check_restraint
from antenna_pin.elements import (
    FAMILIES,
    GROSS_WORK,
    LOSS,
    WORK,
    Change,
    Met,
    Modal,
    Motion,
    StickingFriction,
)
from antenna_pin.elements.modal import AFTER, BLOW, CAPTURE
from antenna_pin.errors import MechanismError
from antenna_pin.run.engine.touch_kernels import TOUCH
from antenna_pin.run.simulation.element_events import (
    CoincidentChange,
    CoincidentEvents,
    ImpulseEffect,
    ModeChangeEvent,
    ModeEffect,
    NeverSettlesError,
    StruckElement,
    met_at,
)
from antenna_pin.run.simulation.events import STILL, Switch
from antenna_pin.run.simulation.sticking import RestingJoints

Array = NDArray[np.float64]

# --- impulses -----------------------------------------------------------------------------------------------


class ChangeResult(NamedTuple):
    """Change of an element, with the state of its joint before and the impulse."""

    met: Met  # state of the joint before the change
    change: Change  # change of mode
    loss: float = 0.0  # energy that the impulse takes [J]
    impulse: float = 0.0  # impulse on the child [N m s] ([N s])


class ImpactSolver:
    """Impulses of a run's stops and latches.

    All elements struck at one time are one problem (:func:`antenna_pin.dynamics.push_apart`). Joints that
    rest on stops leave them where an impulse lifts them off; friction is finite, bears no impulse, and slips
    if its joint moves afterwards.

    Attributes:
        losses: Places of the losses in the state, by element.
    """

    def __init__(self, workspace: Workspace, adjustments: Adjustments, acting: Mapping[str, Acting]) -> None:
        """Find the places of losses and works in the state."""
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
        #: Places in a state of the work and the gross work of each motion of the plan.
        self._works = [
            [at + one.x + Motion.integrals.index(which) for which in (WORK, GROSS_WORK)]
            for one in workspace.system.motions
        ]

    def lost(self, y: Array) -> float:
        """Return the losses of these elements so far, without works of motions [J]."""
        return float(sum(y[k] for k in self.losses.values()) - self.worked(y))

    def worked(self, y: Array) -> float:
        """Return the work of motions so far [J]."""
        return float(sum(y[k] for k, _ in self._works))

    def _element(self, place: str) -> Modal:
        element = self._adjustments.elements[place]
        assert isinstance(element, Modal)
        return element

    def make(
        self, together: Mapping[str, ChangeResult], t: float, y: Array
    ) -> tuple[dict[str, ChangeResult], tuple[StruckElement, ...], bool]:
        """Apply simultaneous impulses; y is changed in place.

        Returns:
            Changes of elements, by place: of these, unless others keep their joint from its stop; of stops
            that a resting joint leaves; of friction that no longer sticks. Further the elements at which
            impulses act, and whether these are independent.
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
                "impulse: motions, closures, couplings and locks prescribe contradictory rates; remove one "
                "of them"
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
            struck.append(StruckElement(place, self._slots[place], self._acting[place].block, back))
        for place in resting:
            change = self._element(place).lets_go()
            if rates[place] > STILL and change is not None:
                results[place] = ChangeResult(others[place], change)
        for place in loose:
            element, rate = self._element(place), met_at(self._workspace, self._acting[place], t, y).rate
            if abs(rate) > STILL and isinstance(element, StickingFriction):
                results[place] = ChangeResult(others[place], element.slips(rate))
        alone = len(struck) < 2 or apart(
            self._workspace,
            t,
            y,
            [one.at for one in struck],
            {*free, *(self._holds.index(place) for place in together)},
        )
        return results, tuple(struck), alone

    def _one_sided(self) -> tuple[dict[str, float], list[str]]:
        """Return stops that carry a resting joint, with directions, and holds without impulse."""
        resting, loose = {}, []
        for place in self._holds:
            if place in self._acting and self._adjustments.holds(place):
                least, most = self._element(place).bears
                if least == most:
                    loose.append(place)
                elif 0.0 in (least, most):
                    resting[place] = 1.0 if least == 0.0 else -1.0
        return resting, loose


# --- largest efforts so far ---------------------------------------------------------------------------------


class RunningPeaks:
    """Largest efforts so far: of elements in touch, by side, and of drives at commands.

    The compiled loop updates those of touches in each accepted step
    (:mod:`antenna_pin.run.engine.touch_kernels`). A drive's effort may jump where a command changes; between
    commands the samples tell (:class:`antenna_pin.run.simulation.recorder.EffortPeaks`).

    Attributes:
        numbers: TOUCH, (sides + drives,); the drives have no side.
    """

    def __init__(self, system: System, acting: Mapping[str, Acting]) -> None:
        """Begin without touch."""
        self._nq = system.model.nq
        self._sides = [
            (place, name, 1 << k)
            for place, element in ((place, one.element) for place, one in acting.items())
            if isinstance(element, Modal) and "touch" in element.change_names and not element.holds
            for k, name in enumerate(element.sides)
        ]
        blocks = [acting[place].block for place, _, _ in self._sides]
        self.numbers = np.zeros(len(blocks) + len(system.drives), TOUCH)
        self.numbers["block"] = [*blocks, *system.drive_blocks.values()]
        self.numbers["side"][: len(blocks)] = [bit for _, _, bit in self._sides]
        self._prescribed = [isinstance(drive, Motion) for drive in system.drives.values()]

    @property
    def drives(self) -> NDArray[Any]:
        """Largest efforts of the drives at commands, TOUCH, (drives,)."""
        own: NDArray[Any] = self.numbers[len(self._sides) :]
        return own

    def command(self, program: Array, t: float, y: Array) -> None:
        """Update the largest efforts of the drives at the present commands."""
        for own, prescribed in zip(self.drives, self._prescribed, strict=True):
            if not prescribed:
                effort = abs(float(kernels.element_state(program, int(own["block"]), t, y, self._nq)[0]))
                if effort > own["effort"]:
                    own["effort"], own["time"] = effort, t

    def change(self, place: str, before: int, after: int, t: float) -> tuple[float, float]:
        """Begin and end touches by a change of mode.

        Returns:
            Largest effort [N m] ([N]) and its time [s], of the touch that ends; NaN if none does.
        """
        found = math.nan, math.nan
        for own, (owner, _, bit) in zip(self.numbers, self._sides, strict=False):
            if owner == place and bit & (before ^ after):
                if bit & before:
                    found = float(own["effort"]), float(own["time"])
                own["effort"], own["time"] = 0.0, t
        return found

    def with_open(
        self, changed: Sequence[ModeChangeEvent], modes: Mapping[str, int]
    ) -> list[ModeChangeEvent]:
        """Return recorded changes, with the peaks so far at the onsets of touches that last."""
        found = list(changed)
        for own, (place, name, bit) in zip(self.numbers, self._sides, strict=False):
            mine = [k for k, one in enumerate(found) if one.element == place and one.what.startswith(name)]
            if modes[place] & bit and mine:
                found[mine[-1]] = replace(
                    found[mine[-1]], peak_effort=float(own["effort"]), peak_time=float(own["time"])
                )
        return found


# --- changes of mode ----------------------------------------------------------------------------------------

# Changes at one time, per element, beyond which they count as endless.
_AT_MOST = 100


class ModeChanges:
    """Elements of a run that have modes.

    A function of an element (:mod:`antenna_pin.elements.modal`) is positive while its mode persists. Its zero
    is located like an event's; the element defines the change. Coincident changes are carried out together,
    in rounds (:meth:`resolve`).

    Attributes:
        changed: Recorded changes of mode, in order.
        peaks: Largest efforts so far of elements in touch, and of drives at commands.
        effects: Effects at the present time, to be applied to perturbed states.
        grazed: Functions located at the last event that do not pass: places of the elements, and
            their numbers.
    """

    def __init__(self, workspace: Workspace, adjustments: Adjustments) -> None:
        """Begin with the elements of the system."""
        self._workspace = workspace
        self._adjustments = adjustments
        system = workspace.system
        self._acting: Mapping[str, Acting] = {
            one.place: one for one in acting_in(system) if isinstance(one.element, Modal)
        }
        self._holds = [one.name for one in system.holds]
        self._due = CoincidentEvents(workspace, adjustments, self._acting)
        self.changed: list[ModeChangeEvent] = []
        self.peaks = RunningPeaks(system, self._acting)
        self.effects: list[ModeEffect | ImpulseEffect] = []
        self.grazed: set[tuple[str, int]] = set()
        self._rest = RestingJoints(workspace, adjustments, self._acting)
        self._blows = ImpactSolver(workspace, adjustments, self._acting)
        #: Elements that have held a freedom together with others, by name: their shares are indeterminate.
        self.shares: set[str] = set()
        self._limit = _AT_MOST * (1 + len(self._acting))
        self._instant, self._taken = math.nan, 0

    def __bool__(self) -> bool:
        """Return whether the system has elements with modes."""
        return bool(self._acting)

    def _element(self, place: str) -> Modal:
        element = self._adjustments.elements[place]
        assert isinstance(element, Modal)
        return element

    def prepare(self, t: float, y: Array) -> None:
        """Set the modes that elements have before any event at the start of a run."""
        for place, value in first_modes(self._workspace.system, y, t):
            self._adjustments.set(place, value)

    def begin(self, t: float, y: Array) -> None:
        """Carry out the changes at the start of a run; y is changed in place.

        Impulses are recorded; initial modes are no changes of the run.

        Raises:
            MechanismError: No consistent modes of sticking and slipping are found.
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
        """Update an element whose number, or ``on``, was set, by its joint's state."""
        element = self._adjustments.elements.get(place)
        if isinstance(element, Modal) and element.acts:
            change = element.moved(key, self._due.met(place, t, y))
            if change is not None:
                self._adjustments.change(place, change)

    def jammed(self, t: float, y: Array) -> str:
        """Return the joints with unsolvable friction by load, as text; "" if none."""
        return self._rest.jammed(t, y) if self._rest else ""

    def losses(self, y: Array) -> float:
        """Return the energy lost in impulses and dampers, without works of motions [J]."""
        return self._blows.lost(y)

    def lost_at_start(self) -> list[tuple[int, float]]:
        """Return the losses of impulses at the start [J], with their places in the state."""
        return [(self._blows.losses[one.element], one.loss) for one in self.changed if one.time == 0.0]

    def is_due(self, t: float, y: Array) -> bool:
        """Return whether a function of any element passes at this state."""
        return bool(self._due.passing(t, y, (), lambda place, number: False))

    # --- coincident changes ---------------------------------------------------------------------------------

    def resolve(self, located: Sequence[Switch], t: float, y: Array) -> bool:
        """Carry out all coincident changes; y is changed in place.

        In rounds: all captures; else all impulses, as one problem; else all other changes; else sticking and
        slipping. After each round all functions are evaluated again, so that the result does not depend on
        the order of elements.

        Returns:
            Whether anything was changed.

        Raises:
            NeverSettlesError: The changes would never end.
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
            self._note_shared_loads(t, y)
        if not changed and (past := next((one for one in located if self._due.is_past(one, t, y)), None)):
            raise NeverSettlesError(past.place)
        return changed

    def _note_shared_loads(self, t: float, y: Array) -> None:
        """Record the elements that hold a freedom together with others."""
        constraints = self._workspace.constraints
        assert constraints is not None
        constraints.residuals(t, y, self._workspace.program)
        names = [self._holds[k] for k in rows_that_share(constraints)]
        names += [place for place in self._acting if self._rest.pushes(place)]
        self.shares.update(self._acting[name].label for name in names if name in self._acting)

    def _make(self, phase: int, together: Sequence[CoincidentChange], t: float, y: Array) -> None:
        """Carry out and record the changes of one round, with their impulses."""
        before = {place: self._element(place) for place in self._acting}
        results = {one.place: ChangeResult(one.met, one.change) for one in together}
        struck, alone = tuple[StruckElement, ...](), True
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
        """Apply the present rates of motions, y in place; return their work [J].

        Raises:
            MechanismError: The constraints do not permit these rates.
        """
        before, taken = {place: self._element(place) for place in self._acting}, self._blows.worked(y)
        results, struck, alone = self._blows.make({}, t, y)
        self._put(results, {}, before, struck, alone, t, y)
        return self._blows.worked(y) - taken

    def _put(
        self,
        results: Mapping[str, ChangeResult],
        numbers: Mapping[str, int],
        before: Mapping[str, Modal],
        struck: tuple[StruckElement, ...],
        alone: bool,
        t: float,
        y: Array,
    ) -> None:
        """Set and record the next modes of elements."""
        for place, one in results.items():
            self._adjustments.change(place, one.change)
            for other in one.change.switches_off:
                self._adjustments.set(f"{other}.on", False)
        for place, one in results.items():
            changes = _by_function(numbers[place]) if place in numbers else _by_letting_go
            self.effects.append(ModeEffect(place, before[place], changes))
            what = one.change.what or self._element(place).change_said(before[place].mode)
            peak = self.peaks.change(place, before[place].mode, self._element(place).mode, t)
            self._record(place, one, t, y, what, peak)
        if struck:
            self.effects.append(ImpulseEffect(self._workspace.program.copy(), struck, alone))

    def _settle(self, t: float, y: Array, located: Sequence[Switch]) -> bool:
        """Find consistent modes of resting joints; return whether any mode has changed."""
        shifts = self._rest.settle(t, y, located) if self._rest else []
        for place, before, met in shifts:
            element = self._element(place)
            what = element.change_said(before.mode)
            self._record(place, ChangeResult(met, Change(element.mode)), t, y, what)
            self.effects.append(ModeEffect(place, before, _by_sticking))
        return bool(shifts)

    def recorded(self) -> list[ModeChangeEvent]:
        """Return the recorded changes, with the peaks so far of touches that last."""
        return self.peaks.with_open(
            self.changed, {place: self._element(place).mode for place in self._acting}
        )

    def _record(
        self,
        place: str,
        result: ChangeResult,
        t: float,
        y: Array,
        what: str,
        peak: tuple[float, float] = (math.nan, math.nan),
    ) -> None:
        """Record the change of an element, if it has a name."""
        if not what:
            return
        element, one, (met, change, loss, blow) = self._element(place), self._acting[place], result
        self.changed.append(
            ModeChangeEvent(
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
                peak_effort=peak[0],
                peak_time=peak[1],
            )
        )


def _by_function(number: int) -> Callable[[Modal, Met], Change | None]:
    return lambda element, met: element.passed(number, met)


def _by_letting_go(element: Modal, met: Met) -> Change | None:
    return element.lets_go()


def _by_sticking(element: Modal, met: Met) -> Change | None:
    return element.sticks(met) if isinstance(element, StickingFriction) else None
