"""The FMU's inside: a session behind the functions of FMI, as pythonfmu3 calls them.

A master sets parameters and inputs, steps, reads outputs. An input is held over a step; one that is set to
what it was leaves the run alone. The results are the numbers of one run in which events set what was
commanded at the communication points, bit for bit.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from pythonfmu3 import DefaultExperiment, Float64, Fmi3Causality, Fmi3Slave, Unit
from pythonfmu3.enums import Fmi3Initial, Fmi3Status, Fmi3Variability
from pythonfmu3.fmi3slave import Fmi3StepResult

from antenna_pin.apps.fmu.packed import Packed, UnitVariable, place_of
from antenna_pin.base.state import State
from antenna_pin.errors import AntennaPinError
from antenna_pin.run.session import Session, start
from antenna_pin.scenario import Scenario
from antenna_pin.trajectory import Outcome

# --- units as FMI has them: products of powers of SI units ---

# Those that stand in results and scenarios beside the base units.
_DERIVED = {
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "Hz": {"s": -1},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "H": {"kg": 1, "m": 2, "s": -2, "A": -2},
    "ohm": {"kg": 1, "m": 2, "s": -3, "A": -2},
    **{base: {base: 1} for base in ("kg", "m", "s", "A", "K", "rad")},
}
_PART = re.compile(r"([A-Za-z]+)(?:(?:\^|\*\*)(-?\d+))?")


def powers_of(unit: str) -> dict[str, int] | None:
    """Return the powers of SI units in a unit such as ``N m/rad``."""
    found: dict[str, int] = {}
    for side, parts in enumerate(unit.split("/")):
        for part in parts.replace("**", "^").replace("*", " ").replace("(", " ").replace(")", " ").split():
            match = _PART.fullmatch(part)
            if match is None or match[1] not in _DERIVED:
                if part == "1" and side == 0:
                    continue
                return None
            power = int(match[2] or 1) * (-1 if side else 1)
            for base, one in _DERIVED[match[1]].items():
                found[base] = found.get(base, 0) + power * one
    return {base: power for base, power in found.items() if power} or None


# Of a communication point: how far a master's sum of steps may be off.
_ROUND_OFF = 1e-9
_COSIMULATION = {
    "canHandleVariableCommunicationStepSize": True,
    "canGetAndSetFMUState": True,
    "canSerializeFMUState": True,
    "needsExecutionTool": True,
    "canBeInstantiatedOnlyOncePerProcess": False,
}


class Slave(Fmi3Slave):  # type: ignore[misc]  # the library has no types
    """Instance of an FMU.

    Args:
        **options: As pythonfmu3 gives them: the instance's name, the folder of resources.
    """

    def __init__(self, **options: Any) -> None:
        """Make a session of the scenario that is packed, and the variables."""
        super().__init__(**options)
        self.packed = Packed.read(Path(options["resources"]))
        self.guid = self.packed.token
        self.time = self._first = 0.0
        self._parameters: dict[str, float] = {}
        self._inputs: dict[str, float] = {}
        self._places: dict[str, str] = {}
        self._begin()
        session = self._session
        about = self.packed.scenario
        self.description = about.title or about.name
        self.default_experiment = DefaultExperiment(
            start_time=0.0, stop_time=about.duration, step_size=1.0 / about.output.rate
        )
        self._starts: dict[str, float] = {}
        self._register(
            UnitVariable("time", "s", 0.0, "of the mechanism"),
            Fmi3Causality.independent,
            getter=lambda: self.time,
        )
        for one in self.packed.parameters_of(session):
            self._parameters[one.name] = one.start
            self._register_numbers(one, Fmi3Causality.parameter, self._parameters)
        for one in self.packed.inputs_of(session):
            self._inputs[one.name] = one.start
            self._register_numbers(one, Fmi3Causality.input, self._inputs)
        self._places = {name: place_of(session, name) for name in self.packed.inputs}
        for one in self.packed.outputs_of(session):
            self._register(one, Fmi3Causality.output, getter=lambda name=one.name: self._read(name))

    # --- variables ------------------------------------------------------------------------------------------

    def _register_numbers(self, one: UnitVariable, causality: Any, numbers: dict[str, float]) -> None:
        def write(value: float, name: str = one.name) -> None:
            numbers[name] = value

        self._register(one, causality, getter=lambda: numbers[one.name], setter=write)
        self._starts[one.name] = one.start

    def _register(self, one: UnitVariable, causality: Any, **functions: Any) -> None:
        named: dict[str, Any] = {"description": one.meaning, **functions}
        powers = powers_of(one.unit)
        if powers is not None:
            named["unit"] = one.unit
            self.register_units([Unit(one.unit, **powers)])
        if causality is Fmi3Causality.parameter:
            named |= {"variability": Fmi3Variability.fixed, "initial": Fmi3Initial.exact}
        elif causality is Fmi3Causality.output:
            named |= {"variability": Fmi3Variability.continuous, "initial": Fmi3Initial.calculated}
        else:
            named |= {"variability": Fmi3Variability.continuous}
        self.register_variable(Float64(one.name, causality=causality, **named), nested=False)

    def to_xml(self, *options: Any) -> Element:
        """Return the model description, with names and numbers as they are here."""
        root: Element = super().to_xml(*options)
        root.set("variableNamingConvention", "flat")
        kind = root.find("CoSimulation")
        assert kind is not None
        for name, value in _COSIMULATION.items():
            kind.set(name, str(value).lower())
        for variable in root.iter("Float64"):
            if (start := self._starts.get(variable.get("name", ""))) is not None:
                variable.set("start", repr(start))  # to the last bit
        return root

    # --- what a master calls --------------------------------------------------------------------------------

    def setup_experiment(self, start_time: float) -> None:
        """Take the master's time at the start as time zero of the scenario."""
        self.time = self._first = start_time

    def exit_initialization_mode(self) -> None:
        """Begin with the parameters that have been set."""
        self._begin()

    def do_step(self, current_time: float, step_size: float) -> Fmi3StepResult:
        """Command what has changed, go on to the next communication point."""
        try:
            return self._step(current_time, step_size)
        except AntennaPinError as error:
            return self._failed(str(error))

    def _step(self, current: float, size: float) -> Fmi3StepResult:
        session = self._session
        now, end = current - self._first, current + size - self._first
        if abs(now - session.time) > _ROUND_OFF * max(abs(end), size):
            return self._failed(
                f"doStep: currentCommunicationPoint must be {session.time + self._first!r} s, where the last "
                f"step ended, got {current!r}; go back by the state that was got there"
            )
        self._command()
        went = session.run_until(end)
        self.time = session.time + self._first if not went else current + size
        if session.outcome is Outcome.STOPPED:
            self.log(f"antenna_pin: {session.message}", Fmi3Status.ok)
            return Fmi3StepResult(terminateSimulation=True)
        return Fmi3StepResult() if went else self._failed(session.message)

    def _command(self) -> None:
        """Command the inputs that have changed."""
        for name, place in self._places.items():
            if self._session[place] != self._inputs[name]:
                self._session.set(place, self._inputs[name])

    def _read(self, name: str) -> float:
        """Return an output; it may depend on the inputs at once."""
        with self._logged():
            self._command()
        return self._session[name]

    @contextmanager
    def _logged(self) -> Iterator[None]:
        """Log an error on its way to the master."""
        try:
            yield
        except AntennaPinError as error:
            self.log(f"antenna_pin: {error}", Fmi3Status.error)
            raise

    def _failed(self, words: str) -> Fmi3StepResult:
        self.log(f"antenna_pin: {words}", Fmi3Status.error)
        return Fmi3StepResult(status=Fmi3Status.error)

    def terminate(self) -> None:
        """End the session."""
        self._session.close()

    def _begin(self) -> None:
        with self._logged():
            self._session: Session = start(self._scenario(), record=False)

    def _scenario(self) -> Scenario:
        own = {place: value for place, value in self._parameters.items() if value != self._starts[place]}
        return self.packed.scenario.with_overrides(own) if own else self.packed.scenario

    # --- its state ------------------------------------------------------------------------------------------

    def _get_fmu_state(self) -> dict[str, Any]:
        """Return all that the instance's future depends on, as plain values."""
        return {
            "state": self._session.state.to_json(),
            "parameters": dict(self._parameters),
            "inputs": dict(self._inputs),
            "times": [self.time, self._first],
        }

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        """Go to a state that was got from an instance of this FMU."""
        if state["parameters"] != self._parameters:
            self._parameters.update(state["parameters"])
            self._begin()
        self._inputs.update(state["inputs"])
        self.time, self._first = state["times"]
        self._session.restore(State.from_json(state["state"]))

    @staticmethod
    def _fmu_state_to_bytes(state: dict[str, Any]) -> bytes:
        return json.dumps(state).encode()

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(state.decode())
        return found
