"""Checked inputs of a run: settings, events and controllers of a scenario, initial state."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from antenna_pin.base.parameters import holds
from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State, breach_of_state
from antenna_pin.base.units import shown
from antenna_pin.dynamics import (
    Adjustments,
    System,
    Workspace,
    acting_in,
    check_begins,
    check_closed,
    check_motions,
    check_restraints,
    first_modes,
)
from antenna_pin.elements import FAMILIES
from antenna_pin.elements.control import Controller
from antenna_pin.errors import InvalidParameterError, ScenarioError, UnknownNameError
from antenna_pin.joints.pose_kernels import place_journal
from antenna_pin.run.engine import check_compiled
from antenna_pin.run.simulation.constraints import check_sets
from antenna_pin.run.simulation.controllers import check_controllers
from antenna_pin.run.simulation.events import (
    Action,
    Angle,
    Condition,
    ElementChange,
    Event,
    Force,
    Gap,
    Mark,
    Moment,
    Rate,
    Set,
    Stop,
    Time,
)
from antenna_pin.scenario import Scenario, settings_key
from antenna_pin.scenario.assemble import build_system, initial_angles, initial_state, reference_for
from antenna_pin.trajectory.quantities import KEEPABLE

# --- settings, events and controllers of a scenario ---------------------------------------------------------

_DIRECTIONS: dict[str, Literal[-1, 0, 1]] = {"both": 0, "rising": 1, "falling": -1}


def settings_of(scenario: Scenario) -> RunSettings:
    """Return the settings of integration and sampling of a scenario."""
    output = scenario.output
    settings: RunSettings = scenario.integrator.build(
        output_rate=output.rate,
        output_times=output.times,
        output_form=output.form,
        output_keep=output.keep,
    )
    return settings


def as_run(scenario: Scenario, duration: float, settings: RunSettings) -> Scenario:
    """Return the scenario with the given settings, so that the result can be repeated."""
    changes: dict[str, Any] = {}
    planned = settings_of(scenario)
    for name, place in (("", "integrator"), ("scales", "integrator.scales")):
        used, told = (getattr(one, name) if name else one for one in (settings, planned))
        for field in dataclasses.fields(used):
            value = getattr(used, field.name)
            if field.name != "scales" and value is not None and value != getattr(told, field.name):
                output = field.name.startswith("output_")
                changes[field.name.replace("_", ".") if output else f"{place}.{field.name}"] = value
    if duration != scenario.duration and not changes:
        return scenario.lasting(duration)
    if duration != scenario.duration:
        changes = {"duration": duration, **changes}
    return scenario.with_overrides(changes) if changes else scenario


def events_of(scenario: Scenario) -> tuple[Event, ...]:
    """Return the events of a scenario."""
    return tuple(
        Event(
            name=name,
            when=_CONDITIONS[table.kind](table),
            direction=_DIRECTIONS[_direction(table)],
            action=_actions(scenario, name),
            after=table.after,
            once=table.once,
        )
        for name, table in scenario.events.items()
    )


def controllers_of(scenario: Scenario) -> dict[str, Controller]:
    """Return the controllers of a scenario, by name."""
    found = {}
    for name, table in scenario.controllers.items():
        follows = getattr(table, "follows", None)
        more = {} if follows is None else {table.course: reference_for(scenario, follows, None).over_time()}
        found[name] = table.build(**more)
    return found


def check_without_controllers(place: str, scenario: Scenario) -> None:
    """Refuse a scenario with controllers, for uses in which the state alone determines the motion.

    Raises:
        InvalidParameterError: The scenario has controllers.
    """
    if scenario.controllers:
        rule = "without [controllers], whose memory is no part of its states; have a pd drive follow a course"
        raise InvalidParameterError(place, "scenario", rule, said=", ".join(scenario.controllers))


# Conditions by the kind of an event's table.
_CONDITIONS: Mapping[str, Callable[[Any], Condition]] = {
    "angle": lambda table: Angle(table.joint, table.value),
    "rate": lambda table: Rate(table.joint, table.value),
    "time": lambda table: Time(*table.time),
    "gap": lambda table: Gap(table.contact, table.value),
    "force": lambda table: Force(table.contact, table.value),
    "change": lambda table: (
        ElementChange(table.of, table.change, table.side) if _is_element(table) else _of_contact(table)
    ),
}
# Changes of a contact by the direction of its gap through zero.
_OF_CONTACTS = {"touch": "falling", "lift-off": "rising"}


def _is_element(table: Any) -> bool:
    return table.of.partition(".")[0] in FAMILIES


def _of_contact(table: Any) -> Gap:
    """Return the condition of a change of contact: its gap passes zero."""
    if table.change not in _OF_CONTACTS:
        raise UnknownNameError("events", f"change of contact {table.of}", table.change, _OF_CONTACTS)
    if table.side is not None:
        raise InvalidParameterError("events", "side", "left out for a contact", table.side)
    return Gap(table.of, 0.0)


def _direction(table: Any) -> str:
    if table.kind == "change" and not _is_element(table):
        return _OF_CONTACTS.get(table.change, "both")
    return str(getattr(table, "direction", "both"))


def _actions(scenario: Scenario, name: str) -> Action | tuple[Mark | Stop | Set, ...]:
    found: list[Mark | Stop | Set] = []
    for one in scenario.events[name].actions:
        if one == "set":
            found += [Set(place, number) for place, number in scenario.to_set(name).items()]
        else:
            found.append(Stop() if one == "stop" else Mark())
    return found[0] if len(found) == 1 else tuple(found)


# --- checks of the initial state ----------------------------------------------------------------------------


def check_sizes(system: System, state: State, place: str = "simulate", name: str = "start") -> None:
    """Refuse a state that no run leaves, or that is of another system."""
    if not isinstance(state, State):
        raise InvalidParameterError(place, name, "a State", type(state).__name__)
    breach = breach_of_state(state)
    if breach is not None:
        raise InvalidParameterError(place, f"{name}.{breach.place}", breach.rule, breach.value)
    sizes = {"q": system.model.nq, "v": system.model.nv, "x": system.manifold.nx}
    sizes |= {"memory": len(system.contact_names)}
    for part, size in sizes.items():
        found = len(getattr(state, part))
        if found != size:
            rule = f"that of a run of this system, {size} long"
            raise InvalidParameterError(place, f"{name}.{part}", rule, found)


def check_start(system: System, y: np.ndarray) -> None:
    """Refuse an impossible initial pose, motion without inertia, springs without direction."""
    system.check_pose(y[: system.model.nq], "initial pose")
    first_modes(system, y)
    check_begins(system, y)
    check_restraints(system, y)
    table = np.zeros(system.rows, CONTACT)
    workspace = Workspace(system)
    workspace.locate(y, table)
    for joint in system.clearances:
        if joint.axial_clearance is not None:
            pose = np.zeros(1, POSE)
            place_journal(system.program, system.clearance_blocks[joint.name], y, system.model.nq, pose)
            axis = pose["axis"][0]
            if axis[2] < 0.0:
                raise InvalidParameterError(
                    "initial pose",
                    f"tilt of {joint.name}",
                    "below 90 deg; for a journal put in the other way round turn the axis in the URDF",
                    f"{np.degrees(np.arctan2(np.hypot(*axis[:2]), axis[2])):.6g} deg",
                )
    limits = [limit for joint in system.clearances for limit in joint.depth_limits]
    reasons = [reason for joint in system.clearances for reason in joint.limit_reasons]
    for name, row, limit, reason in zip(system.contact_names, table, limits, reasons, strict=False):
        if not -row.gap <= limit:
            rule = f"maximum_depth = {limit:g} m" if reason == "maximum_depth" else f"{limit:g} m ({reason})"
            raise InvalidParameterError(
                "initial pose",
                f"penetration of {name}",
                f"at most {rule}; start with the journal inside its clearance",
                float(f"{-row.gap:.6g}"),
            )
    if system.point_springs:
        for (name, spring), length in zip(system.point_springs.items(), workspace.lengths(y), strict=True):
            spring.check_length(f"spring {name!r}", length)


def check_spans(system: System, begin: float, end: float) -> None:
    """Refuse a run beyond the times that an element covers."""
    for one in acting_in(system):
        one.element.check_span(one.label, begin, end)


def check_events(events: Sequence[Event], system: System, y: ArrayLike) -> None:
    """Refuse events that do not fit a system in its initial state [q, v, x].

    Raises:
        AntennaPinError: Unknown names, places that cannot be set, a function without a valid value.
    """
    names = [event.name for event in events]
    if len(set(names)) != len(names):
        raise InvalidParameterError("simulate", "events", "of different names", names)
    if not events:
        return
    workspace = Workspace(system)
    moment = Moment(workspace)
    trial = Adjustments(system, workspace.program.copy())
    for event in events:
        moment.set(0.0, y)  # type: ignore[arg-type]
        if isinstance(event.when, Force):
            moment.contact_number(event.when.contact)
        if isinstance(event.when, ElementChange):
            event.when.check(f"event {event.name!r}", system)
        for function in event.functions():
            if function is not None:
                function(moment)
        for action in event.actions:
            if isinstance(action, Set):
                trial.set(action.place, action.value)


# --- all inputs of a run ------------------------------------------------------------------------------------


class RunStart(NamedTuple):
    """Start of a run as its user gives it (:func:`simulate`)."""

    q: ArrayLike | None = None
    v: ArrayLike | None = None
    angles: Mapping[str, float] | None = None
    start: State | None = None

    def text(self, scenario: Scenario | None) -> str:
        """Return the origin of the start as text; empty for a scenario's own start."""
        if self.start is not None:
            return f"another run's state at {self.start.reached:.12g} s: the first sample"
        own = scenario is None or (self.q is None and self.v is None)
        return "" if own else "given in Python: the first sample"


class PreparedRun(NamedTuple):
    """Checked inputs of a run."""

    system: System  # system to run
    scenario: Scenario | None  # scenario; None for a system built in Python
    settings: RunSettings  # settings of integration and sampling
    events: tuple[Event, ...]  # events of the scenario and the user
    controllers: Mapping[str, Controller]  # controllers, by name
    begin: float  # time from which the run records [s]
    span: float | None  # duration [s]; None if open
    first: State | np.ndarray  # state left by a run, or initial state [q, v, x]


def prepare_run(
    place: str,
    model: Scenario | System,
    origin: RunStart,
    settings: RunSettings | None,
    events: Sequence[Event],
    duration: float | None,
    begin: float | None = None,
    controllers: Mapping[str, Controller] = MappingProxyType({}),
) -> PreparedRun:
    """Return the checked inputs of a run, or refuse them before any work.

    Raises:
        AntennaPinError: The input is not valid.
    """
    q, v, angles, start = origin
    for name, one in (("q", q), ("v", v), ("angles", angles)):
        if start is not None and one is not None:
            raise InvalidParameterError(place, name, "omitted if start is given, which contains it", one)
    turned: object = angles
    if not isinstance(turned, Mapping | None):
        rule = "a mapping of joints' names to turned angles [rad]"
        raise InvalidParameterError(place, "angles", rule, said=shown(turned))
    scenario = model if isinstance(model, Scenario) else None
    if scenario is not None:
        system = build_system(scenario)
        first_q, first_v = initial_state(scenario, system)
        if q is None:
            angles = {**initial_angles(scenario, system), **(angles or {})}
        span: float | None = scenario.duration if duration is None else duration
        used = settings or settings_of(scenario)
        events = (*events_of(scenario), *events)
        own = controllers_of(scenario)
        if shared := [name for name in controllers if name in own]:
            rule = f"of other names than the scenario's own, {', '.join(own)}"
            raise InvalidParameterError("simulate", "controllers", rule, shared[0])
        controllers = {**own, **controllers}
    elif isinstance(model, System):
        system = model
        first_q, first_v = system.neutral(), np.zeros(system.model.nv)
        span, used = duration, settings or RunSettings()
    else:
        raise InvalidParameterError(place, "model", "a Scenario or a System", type(model).__name__)
    for name in used.output_keep or ():
        if name not in KEEPABLE:
            raise UnknownNameError(f"{place}: output.keep", "quantity of a lean result", name, KEEPABLE)
    if span is not None and not holds(span, "positive"):
        raise InvalidParameterError(place, "duration", "positive and finite [s]", span)
    if start is not None:
        check_sizes(system, start)
    start_q = first_q if q is None else _numbers(place, "q", q)
    start_v = first_v if v is None else _numbers(place, "v", v)
    if begin is None:
        begin = 0.0 if start is None else start.reached
    if span is not None:
        _check_settings(place, used, begin, begin + span, None if settings is not None else scenario)
        check_spans(system, begin, begin + span)
    first: State | np.ndarray
    if start is None:
        here, y = begin, system.state(start_q, start_v, angles)
        check_closed(system, y)
        check_start(system, y)
        first = y
    else:
        here, y, first = start.reached, start.y, start
    if span is not None:
        check_motions(system, y, here, begin + span)
    check_events(events, system, y)
    if start is None:  # else numbers may have changed: the run itself refuses
        check_sets(events, system, y)
    check_controllers(controllers, system)
    return PreparedRun(system, scenario, used, tuple(events), controllers, begin, span, first)


def check_scenario(scenario: Scenario) -> None:
    """Refuse a scenario that :func:`simulate` would refuse, without a step.

    Raises:
        AntennaPinError: The scenario is not valid.
    """
    run = prepare_run("simulate", scenario, RunStart(), None, (), None)
    if run.settings.engine == "compiled":
        check_compiled(run.system)


def _check_settings(
    place: str, used: RunSettings, begin: float, end: float, scenario: Scenario | None
) -> None:
    """Refuse settings that do not fit a run's times, naming the scenario's keys."""
    try:
        used.check_span(begin, end)
    except InvalidParameterError as error:
        if scenario is None:
            raise
        raise ScenarioError(f"{place}: {'.'.join(settings_key(error.parameter))} {error.reason}") from error


def _numbers(place: str, name: str, values: ArrayLike) -> np.ndarray:
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InvalidParameterError(place, name, "an array of numbers", said=shown(values)) from None
