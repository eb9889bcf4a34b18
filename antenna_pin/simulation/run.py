"""A scenario or a system in, a trajectory out."""

from __future__ import annotations

import contextlib
import math
import os
import time
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from antenna_pin.assemble import build_system, initial_angles, initial_state
from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable
from antenna_pin.base.interruption import interruptible
from antenna_pin.base.parameters import holds
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.base.units import shown
from antenna_pin.compiled.compile_time import compiling_timed
from antenna_pin.control import Controller, check_controller, measures_of
from antenna_pin.dynamics import (
    JointMotion,
    System,
    actuators_of,
    check_closed,
    check_motions,
    settled,
)
from antenna_pin.engine import check_compiled
from antenna_pin.errors import InvalidParameterError, ScenarioError, UnknownNameError
from antenna_pin.scenario import Scenario, scenario_named, settings_key
from antenna_pin.simulation.checkpoint import Checkpoint, about_run, check_same
from antenna_pin.simulation.events import Event, check_events
from antenna_pin.simulation.finish import finished
from antenna_pin.simulation.first import check_lengths, check_sizes, check_spans, check_start
from antenna_pin.simulation.from_scenario import as_run, both, controllers_of, events_of, settings_of
from antenna_pin.simulation.keeper import Keeper
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.motions import check_sets
from antenna_pin.simulation.progress import Progress
from antenna_pin.simulation.samples import check_room
from antenna_pin.trajectory import Trajectory

__all__ = ["check_scenario", "settings_of", "simulate"]


# --- what is looked at of controllers before a run begins ---


def check_controllers(controllers: Mapping[str, Controller], system: System) -> None:
    """Refuse controllers that do not fit a system, or each other.

    Raises:
        AntennaPinError: What they command or measure is not there, or two command one thing.
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


class First(NamedTuple):
    """Where a run starts, as its user gives it (:func:`simulate`)."""

    q: ArrayLike | None = None
    v: ArrayLike | None = None
    angles: Mapping[str, float] | None = None
    start: State | None = None

    def told(self, scenario: Scenario | None) -> str:
        """Return where from, in words; empty if from where the scenario starts, or without one."""
        if self.start is not None:
            return f"another run's state at {self.start.reached:.12g} s: the first sample"
        own = scenario is None or (self.q is None and self.v is None)
        return "" if own else "given in Python: the first sample"


class Ready(NamedTuple):
    """What a run is made of, all of it looked at.

    Attributes:
        system: What is run.
        scenario: What it came from; None for a system built in Python.
        settings: How it is integrated and sampled.
        events: What is looked for.
        controllers: What commands it, by name.
        begin: From when on it records [s].
        span: How long it is to be [s]; None where nobody has said.
        first: A state that a run left, or the first one as [q, v, x].
    """

    system: System
    scenario: Scenario | None
    settings: RunSettings
    events: tuple[Event, ...]
    controllers: Mapping[str, Controller]
    begin: float
    span: float | None
    first: State | np.ndarray


def prepared(
    place: str,
    model: Scenario | System,
    given: First,
    settings: RunSettings | None,
    events: Sequence[Event],
    duration: float | None,
    begin: float | None = None,
    controllers: Mapping[str, Controller] = MappingProxyType({}),
) -> Ready:
    """Return what a run is made of, or refuse it before any work.

    Args:
        place: Who asks, for messages.
        model: What to run.
        given: Where it starts.
        settings: Integration and sampling; the scenario's, or the defaults.
        events: What to look for beside the scenario's own.
        duration: Time span [s]; the scenario's if not given.
        begin: From when on it records, if not from where it starts [s].
        controllers: What commands it beside the scenario's own.

    Raises:
        AntennaPinError: The input is not valid.
    """
    q, v, angles, start = given
    for name, one in (("q", q), ("v", v), ("angles", angles)):
        if start is not None and one is not None:
            raise InvalidParameterError(place, name, "left out beside start, which holds it", one)
    told: object = angles
    if not isinstance(told, Mapping | None):
        rule = "a mapping of joints' names to turned angles [rad]"
        raise InvalidParameterError(place, "angles", rule, said=shown(told))
    scenario = model if isinstance(model, Scenario) else None
    if scenario is not None:
        system = build_system(scenario)
        first_q, first_v = initial_state(scenario, system)
        if q is None:
            angles = {**initial_angles(scenario, system), **(angles or {})}
        span: float | None = scenario.duration if duration is None else duration
        used = settings or settings_of(scenario)
        events = (*events_of(scenario), *events)
        controllers = both(controllers_of(scenario), controllers)
    elif isinstance(model, System):
        system = model
        first_q, first_v = system.neutral(), np.zeros(system.model.nv)
        span, used = duration, settings or RunSettings()
    else:
        raise InvalidParameterError(place, "model", "a Scenario or a System", type(model).__name__)
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
        check_lengths(system, y)
        first = y
    else:
        here, y, first = start.reached, start.y, start
    if span is not None:
        check_motions(system, y, here, begin + span)
    check_events(events, system, y)
    if start is None:  # else numbers may be others by now: the run itself tells
        check_sets(events, system, y)
    check_controllers(controllers, system)
    return Ready(system, scenario, used, tuple(events), controllers, begin, span, first)


@takes(duration="s", checkpoint="s", angles="rad")
def simulate(
    model: Scenario | System | str | os.PathLike[str],
    duration: float | str | None = None,
    *,
    q: ArrayLike | None = None,
    v: ArrayLike | None = None,
    angles: Mapping[str, float] | None = None,
    start: State | None = None,
    settings: RunSettings | None = None,
    events: Sequence[Event] = (),
    controllers: Mapping[str, Controller] = MappingProxyType({}),
    progress: Callable[[Progress], None] | None = None,
    out: str | os.PathLike[str] | None = None,
    checkpoint: float | str = math.inf,
    resume: bool = False,
) -> Trajectory:
    """Run a scenario, or a system built in Python, and return the trajectory.

    A run that cannot go on, or is stopped by Ctrl-C, returns what it has; its ``outcome`` says why.

    With ``out`` the result is written there, and memory does not limit the run: a record that grows large
    goes to the disk in parts, in the folder ``OUT.parts``, and the trajectory that is returned reads from the
    file what is asked of it. In that folder are checkpoints too, of a run that was stopped and at an
    interval: with ``resume`` the run goes on from there, and ends bit for bit as if it had never stopped.

    Args:
        model: What to run; or the name of a shipped scenario, or a path, whose default case is run.
        duration: Time span [s], or text as ``"0.1 s"``, from ``start`` on; the scenario's if not given. This
            and ``settings`` enter the result's scenario as overrides.
        q: Initial configuration, (nq,); the scenario's, or neutral. Its quaternions must be of length 1 to
            1e-6 and are made so exactly.
        v: Initial velocity, (nv,); the scenario's, or zero.
        angles: Beside q, angles of joints that turn without end, by name [rad]: their whole turns, which q
            does not hold. Those not given are in (-pi, pi].
        start: What to go on from instead, the ``end`` of a run of the same system: the two runs together are
            bit for bit the one run. It brings time, contacts and step sizes along.
        settings: Integration and sampling; the scenario's, or the defaults.
        events: What to look for, and what to do then, beside the scenario's own.
        controllers: What commands it at instants of its own, by name, beside the scenario's own. The run
            works on copies: nothing that is given is changed.
        progress: Called about ten times a second.
        out: File of the result, ``NAME.nc``, written at the end; its folder of parts is removed then, unless
            the run was interrupted.
        checkpoint: Wall time from one checkpoint to the next [s].
        resume: Whether to go on with the run whose checkpoint is beside ``out``; what it was begun with, the
            initial state excepted, is given again. ``duration`` is that run's if not given.

    Raises:
        AntennaPinError: The input is not valid; raised before any step is made.
        FileFormatError: Likewise; there is no checkpoint, or it is damaged, or of another version or run.
        OutputError: The result cannot be written; :class:`antenna_pin.simulation.UnsavedError` holds it.
    """
    assert not isinstance(duration, str) and not isinstance(checkpoint, str)  # read already, by `takes`
    if not holds(checkpoint, "positive") and checkpoint != math.inf:
        raise InvalidParameterError("simulate", "checkpoint", "positive [s]", checkpoint)
    if resume and out is None:
        raise InvalidParameterError("simulate", "out", "given beside resume", None)
    target = None if out is None else check_writable(out, ".nc")
    stood = Checkpoint.load(target) if resume and target is not None else None
    if stood is not None:
        for name, begun in (("start", start), ("q", q), ("v", v), ("angles", angles)):
            if begun is not None:
                rule = "left out beside resume, which goes on from a checkpoint"
                raise InvalidParameterError("simulate", name, rule, said=type(begun).__name__)
        start, duration = stood.start, stood.about["span"] if duration is None else duration
    given, began = First(q, v, angles, start), None if stood is None else stood.begin
    ready = prepared("simulate", scenario_named(model), given, settings, events, duration, began, controllers)
    system, scenario, used, events, controllers, begin, span, first = ready
    if span is None:
        raise InvalidParameterError("simulate", "duration", "given for a system built in Python [s]", None)
    if scenario is not None:
        scenario = as_run(scenario, float(span), used)
    told = given.told(scenario) if stood is None else stood.about["start"]
    keeper = None
    if target is None:
        check_room(system, float(span) * used.output_rate + len(used.output_times))
    else:
        about = about_run(system, scenario, used, float(span), told, events, controllers)
        if stood is not None:
            check_same(stood, about)
        keeper = Keeper(target, system, about, checkpoint, stood)
    with keeper or contextlib.nullcontext(), compiling_timed() as compiling:
        run = Run(system, first, begin + float(span), used, events, begin, controllers=controllers)
        if stood is not None:
            stood.give_to(run)
        with interruptible() as interrupted:
            before = compiling.seconds  # the run's own time begins with its first step
            run.advance(progress, interrupted, keeper)
            run.wall -= compiling.seconds - before
            return finished(run, scenario, told, keeper, time.perf_counter(), compiling)


def check_scenario(scenario: Scenario) -> None:
    """Refuse a scenario that :func:`simulate` would refuse, without a step.

    Raises:
        AntennaPinError: As it would say.
    """
    system = build_system(scenario)
    q, v = initial_state(scenario, system)
    used, span = settings_of(scenario), scenario.duration
    _check_settings("simulate", used, 0.0, span, scenario)
    check_spans(system, 0.0, span)
    y = system.state(q, v, initial_angles(scenario, system))
    check_closed(system, y)
    check_start(system, y)
    check_lengths(system, y)
    check_motions(system, y, 0.0, span)
    check_events(events_of(scenario), system, y)
    check_sets(events_of(scenario), system, y)
    check_controllers(controllers_of(scenario), system)
    if used.engine == "compiled":
        check_compiled(system)


def _check_settings(
    place: str, used: RunSettings, begin: float, end: float, scenario: Scenario | None
) -> None:
    """Refuse settings that do not fit a run's times, by the keys of the scenario that they come from."""
    try:
        used.check_span(begin, end)
    except InvalidParameterError as error:
        if scenario is None:
            raise
        raise ScenarioError(f"{place}: {'.'.join(settings_key(error.parameter))} {error.reason}") from error


def _numbers(place: str, name: str, given: ArrayLike) -> np.ndarray:
    try:
        return np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise InvalidParameterError(place, name, "an array of numbers", said=shown(given)) from None
