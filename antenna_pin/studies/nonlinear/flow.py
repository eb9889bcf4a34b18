"""The flow of a system as a map over a time span, and its derivative."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import Slope, slope
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.base.records import memory_records
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.dynamics import System, Workspace
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.run.simulation.events import Event
from antenna_pin.run.simulation.inputs import check_without_controllers, events_of, settings_of
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.run import simulate
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.assemble import build_system, initial_angles, initial_state
from antenna_pin.studies.nonlinear.chart import Chart
from antenna_pin.studies.nonlinear.coordinates import Frame, Lift
from antenna_pin.studies.nonlinear.perturbed_system import ParameterSlopes
from antenna_pin.studies.nonlinear.variational import TangentPropagation
from antenna_pin.trajectory import Outcome, Trajectory

# Difference steps in error scales: the noise of a run is some 1e-12 of a scale.
_STEPS = (1e-1, 2e-2, 4e-3, 8e-4)
# Default tolerance of runs that are differentiated; least error of a tangent in tolerances of its run;
# coarsest tolerance, which leaves four digits.
_RTOL, _TOLERANCES, _COARSEST = 1e-12, 100.0, 1e-6


class FlowError(AntennaPinError, RuntimeError):
    """A run of a flow that aborted; the message gives the reason."""


class _SpanRun(NamedTuple):
    """Result of a flow's run over a span."""

    end: State  # state at the end
    onsets: int  # number of onsets
    events: int  # number of events
    changes: tuple[float, ...]  # times of onsets, releases and events, in order [s]
    touching: tuple[tuple[float, float], ...]  # begin and end of each contact [s]


class Tangent(NamedTuple):
    """Derivative of a flow over a span, in coordinates at both ends."""

    matrix: Array  # (size at the end, size at the start)
    # error estimate of each column: difference from less exact differences, or a hundred times the run's
    # tolerance. Differences of runs include events that appear or disappear with the perturbed state (a
    # graze)
    doubt: Array
    end: State  # end state of the unperturbed one
    # number of directions of perturbed states lost at changes of mode, as where a joint comes to rest; 0 for
    # differences of runs
    lost: int = 0


class Flow:
    """Flow of a system: states to states.

    Derivatives include the saltation of events and contact memory, by the variational equation as well as by
    differences of runs, each of which locates its own events.

    Args:
        system: The system; its drives may depend on time.
        settings: Settings of integration; for differentiated runs a tolerance near round-off.
        events: Events of runs besides contacts.
        scenario: Scenario of the system; None for one built in Python.
    """

    def __init__(
        self,
        system: System,
        settings: RunSettings | None = None,
        events: Sequence[Event] = (),
        scenario: Scenario | None = None,
    ) -> None:
        """Take the settings over, without samples."""
        self.system, self.scenario = system, scenario
        used = settings or RunSettings(rtol=_RTOL)
        self._settings, self._events = used, tuple(events)

    @property
    def rtol(self) -> float:
        """Tolerance of its runs [-]."""
        return self._settings.rtol

    def first(self, q: Array, v: Array, angles: Mapping[str, float] | None = None) -> State:
        """Return the state at time zero of a configuration, (nq,), and velocity, (nv,).

        Args:
            q: Configuration.
            v: Velocity.
            angles: As for :meth:`antenna_pin.dynamics.System.state`.
        """
        run = Run(self.system, self.system.state(q, v, angles), 1.0, self._sampled(1.0), self._events)
        return run.present()

    def check_long_enough(self, place: str, name: str, span: float, time: float) -> None:
        """Refuse a span [s] shorter than the steps at a time [s] allow."""
        self._settings.check_long_enough(place, name, span, time)

    def _sampled(self, span: float) -> RunSettings:
        return dataclasses.replace(
            self._settings, accuracy=None, output_rate=0.5 / span, output_times=(), output_form="lean"
        )

    def after(self, start: State, span: float) -> State:
        """Return the state a span of time [s] after another.

        Raises:
            FlowError: The run ended before.
        """
        return self.traverse(start, span).end

    def traverse(self, start: State, span: float) -> _SpanRun:
        """Return the state a span of time [s] later, with the contacts and events between.

        Raises:
            FlowError: The run ended before.
        """
        end = start.time + span
        run = Run(self.system, start, end, self._sampled(span), self._events)
        run.advance()
        self.check_ended(run, span, start)
        begun, ended = run.episodes["onset"], run.episodes["release"]
        onsets = int(np.count_nonzero(begun > start.time))
        events = [one.time for one in run.actions.happened]
        changes = [t for t in (*begun.tolist(), *ended.tolist(), *events) if start.time < t <= end]
        lasted = zip(begun.tolist(), np.where(ended <= end, ended, end).tolist(), strict=True)
        return _SpanRun(run.present(), onsets, len(events), tuple(sorted(changes)), tuple(lasted))

    def sampled(self, start: State, span: float, count: int) -> Trajectory:
        """Return the run over a span [s] from a state, sampled evenly.

        Raises:
            FlowError: The run ended before.
        """
        settings = dataclasses.replace(self._sampled(span), output_rate=count / span, output_form="full")
        run = simulate(self.system, start=start, duration=span, settings=settings, events=self._events)
        if not uninterrupted(run).completed:
            raise FlowError(f"a run of {span:g} s from t = {start.time:g} s: {run.message}")
        return run

    def probe(self, start: State, span: float) -> Trajectory:
        """Return a run much shorter than a span [s], to check names."""
        return self.sampled(start, max(1e-6 * span, self._settings.shortest_at(start.time)), 1)

    def rates(self, state: State) -> tuple[Array, Array]:
        """Return velocity and acceleration in a state, (nv,) each."""
        workspace = Workspace(self.system)
        workspace.memory[:] = memory_records(state.memory)
        out = np.zeros(self.system.model.nv + workspace.manifold.nx)
        workspace.derivative(state.time, np.ascontiguousarray(state.y), out)
        return state.v.copy(), out[: self.system.model.nv].copy()

    def tangent(self, start: State, span: float, chart: Chart | None = None) -> Tangent:
        """Return the derivative of the flow over a span [s], by the variational equation.

        Onsets, releases and events act on it by their saltation
        (:mod:`antenna_pin.studies.nonlinear.variational`).

        Args:
            start: State at the start.
            span: [s].
            chart: Coordinates at the end; by default about the end state. Those of a chart about the start
                apply at the start too.

        Raises:
            FlowError: The run did not come to its end.
            NotAlikeError: Other contacts touch at its end than in the chart, or elements are in other modes.
        """
        here = chart if chart is not None and chart.origin is start else Chart(self.system, start)
        carrier, end = self.propagate(start, span, here.frame)
        there = chart or Chart(self.system, end)
        there.coordinates(end)
        carrier.turn(there.frame)
        matrix = carrier.tangents.matrix
        # The run's own error adds at least its tolerance.
        least = _TOLERANCES * self._settings.rtol * np.linalg.norm(matrix, axis=0)
        lost = here.size - carrier.rank
        return Tangent(matrix, np.maximum(carrier.doubt, least), end, lost)

    def propagate(
        self,
        start: State,
        span: float,
        frame: Frame,
        ways: Array | Callable[[Lift], Array] | None = None,
        *,
        numbers: ParameterSlopes | None = None,
        looks: Sequence[float] = (),
        on_look: Callable[[TangentPropagation, float, Array, Array], None] | None = None,
    ) -> tuple[TangentPropagation, State]:
        """Return the tangents propagated over a span [s], and the state at its end.

        Args:
            start: From where.
            span: [s].
            frame: Axes of coordinates in that state.
            ways: Tangents in these, (size, k), or what makes them of these; all of them if left out.
            numbers: Parameters of the system, which coordinates have too.
            looks: Times of intermediate tangents, ascending [s].
            on_look: Called at each, ``(carrier, time, y, tangents)``, the last (perturbation, k).

        Raises:
            FlowError: The run did not come to its end.
        """
        run = self.logged_run(start, span)
        carrier = TangentPropagation(run, frame, ways, numbers, looks)
        if on_look is not None:
            carrier.on_look = functools.partial(on_look, carrier)
        run.advance(observer=carrier)
        self.check_ended(run, span, start)
        return carrier, run.present()

    def logged_run(self, start: State, span: float) -> Run:
        """Return the run over a span [s] before its first step, with a step log."""
        return Run(self.system, start, start.time + span, self._sampled(span), self._events, logged=True)

    def tangent_by_runs(
        self, start: State, span: float, chart: Chart | None = None, *, step: float | None = None
    ) -> Tangent:
        """Return the derivative of the flow by differences of runs, each with its own events.

        Args:
            start: From where.
            span: [s].
            chart: As for :meth:`tangent`.
            step: Of differences of second order, in error scales; if not given, differences of sixth order of
                steps that are chosen by the doubt, at four times the runs [-].

        Raises:
            FlowError: A run did not come to its end.
            NotAlikeError: A perturbed state ends with other contacts, or the start does than the chart.
            OutOfReachError: Closures do not hold in perturbed states.
        """
        end = self.after(start, span)
        here = chart if chart is not None and chart.origin is start else Chart(self.system, start)
        there = chart or Chart(self.system, end)
        at_end = there.coordinates(end)

        def along(way: Array, s: float) -> Array:
            return there.coordinates(self.after(here.state(s * way), span)) if s else at_end

        columns, doubts = [], []
        for way in np.eye(here.size):
            if step is None:
                found = _slope(functools.partial(along, way))
            else:
                ahead, behind = along(way, step), along(way, -step)
                found = Slope((ahead - behind) / (2.0 * step), float(np.linalg.norm(ahead + behind)))
            columns.append(found.value)
            doubts.append(found.doubt)
        matrix = np.column_stack(columns) if columns else np.zeros((there.size, 0))
        return Tangent(matrix, np.array(doubts), end)

    def check_ended(self, run: Run, span: float, start: State) -> None:
        """Refuse a run that did not complete."""
        if uninterrupted(run).outcome is not Outcome.COMPLETED:
            raise FlowError(f"a run of {span:g} s from t = {start.time:g} s: {run.message}")


def _slope(function: Callable[[float], Array]) -> Slope:
    """Return a derivative at zero by the largest steps at which perturbed runs exist.

    The largest may be so large that a loop tears, or that a perturbed state touches at the end or presses too
    deep.
    """
    for steps in (_STEPS[k:] for k in range(len(_STEPS) - 1)):
        try:
            return slope(function, steps)
        except AntennaPinError:
            continue
    return slope(function, _STEPS[-1:])


@takes()
def flow_of(
    scenario: Scenario, settings: RunSettings | None = None, *, rtol: float | None = None
) -> tuple[Flow, State]:
    """Return the flow of a scenario and the state that it starts from.

    Args:
        scenario: The scenario; its engine is taken, with order 8(5,3) at a tolerance of 1e-12, or at its own
            if that is this order at a finer one.
        settings: How to integrate instead.
        rtol: Another tolerance of that order, coarser where a run is long, 1e-6 at most [-].

    Raises:
        InvalidParameterError: There is no such tolerance, or derivatives would be worth nothing.
    """
    if rtol is not None and not 0.0 < rtol <= _COARSEST:
        rule = f"above 0 and at most {_COARSEST:g}: derivatives are good to a hundred times it"
        raise InvalidParameterError("flow", "rtol", rule, rtol)
    check_without_controllers("flow", scenario)
    system = build_system(scenario)
    own = settings_of(scenario)
    if settings is None:
        if rtol is None:
            rtol = min(own.rtol, _RTOL) if own.method == "dormand-prince-853" else _RTOL
        settings = dataclasses.replace(own, accuracy=None, method="dormand-prince-853", rtol=rtol)
    q, v = initial_state(scenario, system)
    flow = Flow(system, settings, events_of(scenario), scenario)
    return flow, flow.first(q, v, initial_angles(scenario, system))
