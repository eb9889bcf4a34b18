"""Derivatives of a result by the variational equation, along one run and through its events."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.assemble import build_system, initial_angles, initial_state
from antenna_pin.base.differences import few
from antenna_pin.base.settings import RunSettings
from antenna_pin.base.state import State
from antenna_pin.dynamics import System
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.nonlinear import Flow
from antenna_pin.nonlinear.chart import Chart, Displacer
from antenna_pin.nonlinear.coordinates import Lift
from antenna_pin.nonlinear.perturbed_system import Beside, Numbers
from antenna_pin.nonlinear.variational import Carrier
from antenna_pin.scenario import Scenario, with_number
from antenna_pin.sensitivity.along import Along
from antenna_pin.sensitivity.of_states import OfStates
from antenna_pin.sensitivity.parameters import GrazeError, Parameter, SensitivityError
from antenna_pin.sensitivity.starts import begun_from, is_of_start
from antenna_pin.simulation.inputs import check_without_controllers, events_of

__all__ = ["ByEquation"]

Array = NDArray[np.float64]

# Step of differences of first states, in a parameter's scale.
_START = 1e-3


class Neighbour(NamedTuple):
    """A scenario next to the given one.

    Attributes:
        scenario: The scenario.
        system: What it builds.
        first: The state that it starts from.
    """

    scenario: Scenario
    system: System
    first: State


class ByEquation:
    """Differentiates samples of one run of a scenario.

    Args:
        scenario: The scenario.
        parameters: Its numbers.
        settings: How to integrate.
        start: From where it goes on; the scenario's start if None.

    Raises:
        InvalidParameterError: It has controllers, or a parameter is one of an event.
    """

    def __init__(
        self,
        scenario: Scenario,
        parameters: Sequence[Parameter],
        settings: RunSettings,
        start: State | None = None,
    ) -> None:
        """Build the system and its neighbours."""
        check_without_controllers("sensitivities", scenario)
        self._scenario, self.parameters, self.settings = scenario, tuple(parameters), settings
        self._from = start
        self.made = functools.cache(self._neighbour)
        self._here = self.made(0, 0.0)
        system = self._here.system
        self.flow = Flow(system, settings, events_of(scenario), scenario)
        builds = [functools.partial(self._system, k) for k in range(len(self.parameters))]
        self._numbers = Numbers(system, builds, [one.key for one in self.parameters])
        self._next = Displacer(system, len(self.parameters))
        # A neighbour begins with its own numbers of elements; what these keep is displaced by itself.
        self._numbers.slopes["program"][:, self._next.kept.words] = 0.0
        beside = Beside(system, settings, self._numbers, self._system)
        scales = np.array([one.scale for one in self.parameters])
        #: What a result says of its states, and of displaced ones.
        self.told = OfStates(beside, self._next, settings, self._here.first, scales)

    def _neighbour(self, k: int, s: float) -> Neighbour:
        """Return the scenario with a parameter so many scales farther."""
        one, scenario = self.parameters[k], self._scenario
        if s != 0.0:
            value = one.value + s * one.scale
            try:
                scenario = with_number(scenario, one.key, value)
            except AntennaPinError as error:
                said = f"sensitivities: {one.key} must have room on both sides: {error}"
                raise SensitivityError(said) from error
            if scenario.events != self._scenario.events:
                rule = "none of an event's, which only differences of runs take (method = 'runs')"
                raise InvalidParameterError("sensitivities", "key", rule, said=one.key)
        system = build_system(scenario)
        if self._from is not None:
            first = self._from
            if s != 0.0 and is_of_start(self.parameters[k].key):
                first = begun_from(first, self._scenario, scenario, system)
            return Neighbour(scenario, system, first)
        flow = Flow(system, self.settings, events_of(scenario))
        first = flow.first(*initial_state(scenario, system), initial_angles(scenario, system))
        return Neighbour(scenario, system, first)

    def _system(self, k: int, s: float) -> System:
        return self.made(k, s).system

    def _start(self, lift: Lift) -> Array:
        """Return the displacements of the first state in coordinates, (size, parameters)."""
        columns = []
        for k in range(len(self.parameters)):
            columns.append(few(functools.partial(self._apart, k), _START)[0])
        ways = np.column_stack(columns)
        ways[self._next.parts[-3]] = np.eye(len(self.parameters))
        return np.asarray(lift.down @ ways)

    def _apart(self, k: int, j: int) -> Array:
        """Return the displacement of a neighbour's first state, without that of the parameter itself."""
        here, s = self._here.first, j * _START
        found = self._next.between(here, self.made(k, s).first if j else here)
        if found is None:
            one = self.parameters[k]
            raise GrazeError(
                f"sensitivities: with {one.key} = {one.value + s * one.scale:.9g} other contacts touch "
                "at the start: it has no derivative there; start apart, or deeper",
                here.time,
            )
        return found

    def carried(self, times: Array, duration: float, moments: Array) -> Along:
        """Return the run with how parameters displace it, seen at some times and where contacts are deepest.

        Its samples are the run's first one and these, in order.

        Args:
            times: When, ascending (n,) [s].
            duration: Of the run [s].
            moments: When besides, such as at the largest forces of contacts, (m,) [s].

        Raises:
            GrazeError: A contact begins, or an event happens, with no speed.
        """
        first, flow = self._here.first, self.flow
        begin, end = first.reached, first.reached + duration
        span = end - first.time
        every = np.unique(np.concatenate([[begin, end], times, moments]))
        samples = every[(every >= begin) & (every <= end)].tolist()
        run = flow.begun(first, span)
        carrier = Carrier(run, Chart(flow.system, first).frame, self._start, self._numbers, samples)
        along = Along(run, carrier, self._numbers, begin, len(self.parameters))
        run.advance(observer=along)
        flow.check_ended(run, span, first)
        return along
