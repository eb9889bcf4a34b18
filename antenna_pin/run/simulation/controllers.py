"""Controllers of a run: sample times, commands, record."""

from __future__ import annotations

import copy
import math
from array import array
from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import answer_of, number_in, unknown_type
from antenna_pin.base.directions import direction as unit_of
from antenna_pin.base.state import ControllerMemory
from antenna_pin.dynamics import JointMotion, System, Workspace, acting_on_links, actuators_of, settled
from antenna_pin.elements.control import Controller, Instants, check_controller, kept, measures_of, remembered
from antenna_pin.errors import AntennaPinError, FunctionError, InvalidParameterError, UnknownNameError
from antenna_pin.run.simulation.event_actions import Actions
from antenna_pin.run.simulation.events import Moment

Array = NDArray[np.float64]

# --- state passed to controllers ----------------------------------------------------------------------------


class ControllerView(Moment):
    """State of a run at a sample time (:class:`antenna_pin.elements.control.Now`).

    Attributes:
        tick: Number of the sample time of the calling controller.
        noted: Signals recorded by the controller.
    """

    def __init__(self, workspace: Workspace) -> None:
        """Allocate once; ``set`` and ``begin`` supply state and sample time."""
        super().__init__(workspace)
        self.tick = 0
        self.noted: dict[str, float] = {}
        self._commands: Mapping[str, Callable[[], float]] = {}
        self._data = self.system.mechanism.model.createData()
        self._placed = False

    def set(self, time: float, y: Array) -> ControllerView:
        """Set time and state; return the view."""
        self._placed = False
        super().set(time, y)
        return self

    def begin(self, tick: int, commands: Mapping[str, Callable[[], float]]) -> None:
        """Set the number of the sample time, and the functions of the present commands."""
        self.tick, self._commands, self.noted = tick, commands, {}

    def note(self, **signals: float) -> None:
        """Record signals beside the commands of this sample time."""
        self.noted.update(signals)

    def command(self, name: str) -> float:
        """Return the command that an actuator has followed until now."""
        if name not in self._commands:
            raise UnknownNameError("controller", "actuator", name, self._commands)
        return self._commands[name]()

    # --- the base -------------------------------------------------------------------------------------------

    def _check_base(self, what: str) -> None:
        if self.system.mechanism.base != "free":
            rule = "asked of a free base only; set mechanism.base"
            raise InvalidParameterError("controller", what, rule, "fixed")

    def base_quaternion(self) -> Array:
        """Return the base's attitude in the world, xyzw, (4,)."""
        self._check_base("base_quaternion")
        return self.q[3:7]

    def base_rotation(self) -> Array:
        """Return the base's attitude as a rotation vector, (3,), world axes [rad]."""
        self._check_base("base_rotation")
        return np.asarray(pin.log3(pin.Quaternion(self.q[3:7]).toRotationMatrix()))

    def base_rate(self) -> Array:
        """Return the base's angular velocity, (3,), in its own axes [rad/s]."""
        self._check_base("base_rate")
        return self.v[3:6]

    # --- links and joints -----------------------------------------------------------------------------------

    def direction(self, link: str, axis: ArrayLike) -> Array:
        """Return an axis of a link, (3,), in the world, of length 1."""
        mechanism = self.system.mechanism
        frame = mechanism.model.frames[mechanism.frame(link)]
        if not self._placed:
            pin.forwardKinematics(mechanism.model, self._data, self.q)
            self._placed = True
        turned: Array = self._data.oMi[frame.parentJoint].rotation @ frame.placement.rotation
        return turned @ unit_of(axis, "controller", "axis")

    def off_axis(self, link: str, axis: ArrayLike, target: ArrayLike) -> float:
        """Return the angle between a link's axis and a direction of the world [rad]."""
        here, there = self.direction(link, axis), unit_of(target, "controller", "target")
        return math.atan2(float(np.linalg.norm(np.cross(here, there))), float(here @ there))

    def joint_load(self, joint: str) -> Array:
        """Return a joint's force [N] and moment [N m] on its child, (6,), joint axes.

        Torques of drives and springs at the joint are included. The load follows from the motion of all links
        that the joint carries, less the forces on these; closures and springs between points are not
        permitted.
        """
        system = self.system
        if system.closures or system.point_springs:
            rule = "asked where there are no closures and no springs between points"
            raise InvalidParameterError("controller", "joint_load", rule, joint)
        slot = system.mechanism.joint(joint)
        self._workspace.derivative(self.time, self._y, self._rates)
        self._evaluated, self._measured, self._placed = True, False, False
        model, data = system.mechanism.model, self._data
        pin.forwardKinematics(model, data, self.q)
        outside = [pin.Force.Zero() for _ in range(model.njoints)]
        for link, wrench in acting_on_links(system, self._workspace.program):
            if link != "world":
                carries = model.frames[system.mechanism.frame(link)].parentJoint
                outside[carries] += data.oMi[carries].actInv(pin.Force(wrench))
        pin.rnea(model, data, self.q, self.v, self._rates[: self._nv].copy(), outside)
        return np.asarray(data.f[slot.joint_id].vector).copy()


# --- sample times -------------------------------------------------------------------------------------------

# Sample times within this distance are one: round-off of phase and period [ulp].
_SAME = 4.0


class ControllerRecord(NamedTuple):
    """Record of the sample times of one controller."""

    name: str  # name of the controller
    columns: tuple[str, ...]  # names of the columns of ``values``: signals, then commands
    saturated: int | None  # column of saturation; None without
    times: Array  # sample times, (n,) [s]
    values: Array  # signals and commands, NaN where missing, (n, columns)


class _ControlLoop:
    """Controller of a run, with its queue of delayed commands."""

    def __init__(self, name: str, controller: Controller, places: Mapping[str, str]) -> None:
        self.name, self.controller = name, controller
        self.places = {command: places[command] for command in controller.commands}
        self.instants = Instants(controller)
        self.tick, self.begins = 0, True
        self.queue: deque[tuple[int, dict[str, float]]] = deque()
        self.columns = (*controller.signals, *controller.commands)
        self.times, self.values = array("d"), array("d")

    @property
    def next(self) -> float:
        """Time of the next sample or delayed command [s]."""
        ask = self.instants.tick(self.tick)
        return min(ask, self.instants.write(self.queue[0][0])) if self.queue else ask

    def state_set(self, state: Any) -> None:
        object.__setattr__(self.controller, "state", state)  # of frozen classes too

    def call(self, view: ControllerView) -> dict[str, float]:
        """Call the controller; return its commands."""
        place = f"controller {self.name!r}: update"
        told = f"instant {self.tick}, t = {view.time:.9g} s"
        answer = answer_of(place, told, "commands by name", self.controller.update, view)
        if not isinstance(answer, Mapping):
            raise FunctionError(place, told, "commands by name", unknown_type(answer))
        for what, numbers, known in (
            ("commands", answer, self.controller.commands),
            ("signals", view.noted, self.controller.signals),
        ):
            for name, value in numbers.items():
                if name not in known:
                    rule = f"{what} among {', '.join(known) or 'none'}"
                    raise FunctionError(place, told, rule, f"one called {name!r}")
                number = number_in(value)
                if number is None or not math.isfinite(number):
                    raise FunctionError(place, told, f"a finite number for {name}", unknown_type(value))
        return {name: float(value) for name, value in answer.items()}

    def keep(self, view: ControllerView, commands: Mapping[str, float]) -> None:
        self.times.append(view.time)
        self.values.extend(view.noted.get(name, math.nan) for name in self.controller.signals)
        self.values.extend(commands.get(name, math.nan) for name in self.controller.commands)


class Controllers:
    """Controllers of a run, called at their sample times.

    Coincident controllers are all called, in their order, before any command is written; then the commands
    that are due are written, earlier ones first. Events of the same time come before.

    Args:
        controllers: By name; the run works on copies.
    """

    def __init__(
        self, controllers: Mapping[str, Controller], workspace: Workspace, actions: Actions, begin: float
    ) -> None:
        """Begin before the first sample time."""
        self._begin = begin
        self._actions = actions
        self._view: ControllerView | None = None
        self._commands: dict[str, Callable[[], float]] = {}
        self._loops: list[_ControlLoop] = []
        if controllers:
            system = workspace.system
            places = actuators_of(system)
            self._view = ControllerView(workspace)
            self._commands = {name: partial(self._number, place) for name, place in places.items()}
            own = settled(copy.deepcopy(dict(controllers)), system)
            self._loops = [_ControlLoop(name, one, places) for name, one in own.items()]

    def __bool__(self) -> bool:
        """Return whether the run has controllers."""
        return bool(self._loops)

    def _number(self, place: str) -> float:
        element, _, key = place.rpartition(".")
        return float(getattr(self._actions.adjustments.elements[element], key))

    @property
    def next(self) -> float | None:
        """Time of the next sample or command [s]; None without controllers."""
        return min(loop.next for loop in self._loops) if self._loops else None

    # --- a sample time --------------------------------------------------------------------------------------

    def update(self, t: float, y: Array) -> bool:
        """Call controllers and write commands due at a time [s]; return whether any were."""
        until = t + _SAME * math.ulp(t)
        due = [loop for loop in self._loops if loop.instants.tick(loop.tick) <= until]
        late = [loop for loop in self._loops if loop.queue and loop.instants.write(loop.queue[0][0]) <= until]
        if not due and not late:
            return False
        if due:
            self._call(due, t, y)
        writes: list[tuple[float, int, dict[str, float]]] = []
        for k, loop in enumerate(self._loops):
            while loop.queue and loop.instants.write(loop.queue[0][0]) <= until:
                tick, commands = loop.queue.popleft()
                written = {loop.places[name]: value for name, value in commands.items()}
                writes.append((loop.instants.tick(tick), k, written))
        commanded: dict[str, float] = {}
        for *_, written in sorted(writes, key=lambda one: one[:2]):
            commanded |= written
        self._write(commanded)
        return True

    def _call(self, due: list[_ControlLoop], t: float, y: Array) -> None:
        """Call controllers before any command is written; if one fails, restore all."""
        assert self._view is not None
        before = [copy.deepcopy(loop.controller.state) for loop in due]
        answers = []
        try:
            for loop in due:
                self._view.set(t, y).begin(loop.tick, self._commands)
                answers.append((loop, loop.call(self._view), dict(self._view.noted)))
        except BaseException:
            for loop, state in zip(due, before, strict=True):
                loop.state_set(state)
            raise
        for loop, commands, noted in answers:
            if t > self._begin or (loop.begins and t == self._begin):
                self._view.noted = noted
                loop.keep(self._view, commands)
            loop.queue.append((loop.tick, commands))
            loop.tick += 1

    def _write(self, commanded: Mapping[str, float]) -> None:
        new = {place: value for place, value in commanded.items() if self._number(place) != value}
        if not new:
            return
        try:
            self._actions.command(new)
        except AntennaPinError as error:
            told = ", ".join(f"{place} = {value:g}" for place, value in new.items())
            rule = "a command that its actuator can follow"
            raise FunctionError("controller", told, rule, " ".join(str(error).split())) from error

    # --- discrete state -------------------------------------------------------------------------------------

    def value(self) -> tuple[ControllerMemory, ...]:
        """Return the discrete states of the controllers."""
        return tuple(
            ControllerMemory(
                name=loop.name,
                tick=loop.tick,
                queue=tuple((tick, tuple(commands.items())) for tick, commands in loop.queue),
                state=kept(loop.controller.state),
            )
            for loop in self._loops
        )

    def take_up(self, memories: tuple[ControllerMemory, ...], reached: float) -> None:
        """Continue from the discrete states of another run's controllers, by name."""
        known = {one.name: one for one in memories}
        for loop in self._loops:
            one = known.get(loop.name)
            if one is None:
                loop.tick = loop.instants.first_from(reached)
                continue
            loop.tick, loop.begins = one.tick, False
            loop.queue = deque((tick, dict(commands)) for tick, commands in one.queue)
            loop.state_set(remembered(one.state, loop.controller.state))

    # --- record ---------------------------------------------------------------------------------------------

    @property
    def records(self) -> tuple[ControllerRecord, ...]:
        """Records of the controllers' sample times."""
        return tuple(
            ControllerRecord(
                loop.name,
                (*loop.controller.signals, *(f"command {name}" for name in loop.controller.commands)),
                loop.columns.index("saturated") if "saturated" in loop.columns else None,
                np.array(loop.times),
                np.array(loop.values).reshape(-1, len(loop.columns)),
            )
            for loop in self._loops
        )

    def counts(self) -> tuple[int, ...]:
        """Return the number of recorded sample times of each controller."""
        return tuple(len(loop.times) for loop in self._loops)

    def cut(self, counts: tuple[int, ...]) -> None:
        """Discard the records beyond these numbers of sample times."""
        for loop, count in zip(self._loops, counts, strict=True):
            del loop.times[count:], loop.values[count * len(loop.columns) :]

    def forget_before(self, begin: float) -> None:
        """Discard the records before a time [s]."""
        for loop in self._loops:
            first = int(np.searchsorted(np.array(loop.times), begin))
            del loop.times[:first], loop.values[: first * len(loop.columns)]

    def numbers(self) -> dict[str, Array]:
        """Return the record as arrays for a file."""
        return {
            f"tick_{what}_{k}": np.array(getattr(loop, what))
            for k, loop in enumerate(self._loops)
            for what in ("times", "values")
        }

    def take_up_record(self, numbers: Mapping[str, NDArray[Any]]) -> None:
        """Continue with a record from :meth:`numbers`."""
        for k, loop in enumerate(self._loops):
            for what in ("times", "values"):
                setattr(loop, what, array("d", numbers[f"tick_{what}_{k}"].tolist()))


# --- check of controllers -----------------------------------------------------------------------------------


def check_controllers(controllers: Mapping[str, Controller], system: System) -> None:
    """Refuse controllers that do not fit a system, or each other.

    Raises:
        AntennaPinError: An unknown command or measurement, or two controllers for one actuator.
    """
    places = actuators_of(system)
    taken: dict[str, str] = {}
    for name, one in controllers.items():
        check_controller(name, one)
        for command in one.commands:
            if command not in places:
                raise UnknownNameError(f"controller {name!r}", "actuator", command, places)
            if places[command] in taken:
                rule = f"of another actuator than controller {taken[places[command]]!r}"
                raise InvalidParameterError(f"controller {name!r}", "commands", rule, command)
            taken[places[command]] = name
    for name, one in settled(controllers, system).items():
        for measure in measures_of(one):
            place = f"controller {name!r}: measures {str(measure)!r}"
            if measure.of == "joint":
                if measure.name not in system.mechanism.joints:
                    raise UnknownNameError(place, "joint", measure.name, system.mechanism.joints)
                JointMotion(system, measure.name)
            elif measure.of == "contact" and measure.name not in system.contact_names:
                raise UnknownNameError(place, "contact", measure.name, system.contact_names)
            elif measure.of == "actuator" and measure.name not in places:
                raise UnknownNameError(place, "actuator", measure.name, places)
            elif measure.of == "axis" and system.mechanism.base != "free":
                rule = "of a joint where mechanism.base is fixed"
                raise InvalidParameterError(f"controller {name!r}", "measures", rule, str(measure))
