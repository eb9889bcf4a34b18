"""Content of an FMU of a scenario besides its model description, and its variables."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, Self

from antenna_pin.errors import FileFormatError, InvalidParameterError, UnknownNameError, one_line
from antenna_pin.run.session import Session
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.merge import key_parts

#: In the FMU's folder of resources.
FILE = "antenna_pin.json"


class UnitVariable(NamedTuple):
    """Number that an FMU takes or gives."""

    name: str
    unit: str  # SI; empty or "1" for none
    start: float  # value at the start
    meaning: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Packed:
    """A scenario, and which of its numbers are an FMU's."""

    scenario: Scenario  # the scenario
    # What is commanded: names of :attr:`antenna_pin.run.session.Session.command`, or places of numbers.
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]  # what is read by name, as a session is
    parameters: tuple[str, ...]  # places of the scenario's numbers that may be set before the start
    token: str  # token that connects a model description with its unit

    def write(self, folder: Path) -> None:
        """Write it into a folder."""
        about = {
            "inputs": self.inputs,
            "outputs": self.outputs,
            "parameters": self.parameters,
            "token": self.token,
            "scenario": json.loads(self.scenario.model_dump_json()),
        }
        (folder / FILE).write_text(json.dumps(about, indent=1), encoding="utf-8")

    @classmethod
    def read(cls, folder: Path) -> Self:
        """Read it from a folder.

        Raises:
            FileFormatError: It is not as it was written.
        """
        try:
            about = json.loads((folder / FILE).read_text(encoding="utf-8"))
            scenario = Scenario.model_validate_json(json.dumps(about.pop("scenario")))
            names = {key: tuple(about.pop(key)) for key in ("inputs", "outputs", "parameters")}
            if about.keys() != {"token"} or not all(isinstance(one, str) for one in sum(names.values(), ())):
                raise ValueError("other entries than names and a token")
            return cls(scenario=scenario, token=str(about["token"]), **names)
        except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
            words = one_line(" ".join(repr(error).split()))[:200]
            raise FileFormatError(
                f"fmu: {FILE} must be as it was packed, got {words}; export it again"
            ) from None

    # --- its variables, in a session of the scenario --------------------------------------------------------

    def inputs_of(self, session: Session) -> list[UnitVariable]:
        """Return the inputs.

        Raises:
            AntennaPinError: There is nothing to command of one's name.
        """
        places = {name: place_of(session, name) for name in self.inputs}
        for name, place in places.items():
            same = [other for other in places if places[other] == place] + [place] * (
                place in self.parameters
            )
            if len(same) > 1:
                rule = f"one of each number; {place} is commanded by {' and '.join(same)}: leave one out"
                raise InvalidParameterError("fmu", "inputs", rule, name)
        return [
            UnitVariable(name, session.unit(place), session[place], f"commanded: {place}, held over a step")
            for name, place in places.items()
        ]

    def outputs_of(self, session: Session) -> list[UnitVariable]:
        """Return the outputs.

        Raises:
            AntennaPinError: There is no number of one's name.
        """
        return [
            UnitVariable(name, session.unit(name), session[name], "at the present") for name in self.outputs
        ]

    def parameters_of(self, session: Session) -> list[UnitVariable]:
        """Return the parameters.

        Raises:
            AntennaPinError: The scenario has no number at one's place.
        """
        known = session.settable
        return [
            UnitVariable(
                place,
                session.unit(place) if place in known else "",
                number_at(self.scenario, place),
                "of the scenario, in SI units",
            )
            for place in self.parameters
        ]


def place_of(session: Session, name: str) -> str:
    """Return the place of an input: that of a command, or a place itself.

    Raises:
        UnknownNameError: Neither is of that name.
        InvalidParameterError: It is a motion's position, which would jump at each step.
    """
    if name in session.command:
        return session.command.place(name)
    if name not in session.settable:
        raise UnknownNameError("fmu", "input", name, [*session.command, *session.settable])
    element, _, key = name.rpartition(".")
    if key == "position" and any(element == f"drives.{one.name}" for one in session.system.motions):
        rule = (
            "left out: an input is held over a step, and a motion's position cannot jump; use "
            f"{element}.rate, which continues the motion from its present position, or a pd drive"
        )
        raise InvalidParameterError("fmu", name, rule, said="a motion's position")
    return name


def number_at(scenario: Scenario, place: str) -> float:
    """Return a number of a scenario in SI units, by its place: ``initial.joints.hinge.position``.

    Raises:
        InvalidParameterError: There is none, or no single one.
    """
    found: Any = scenario.model_dump()
    for key in key_parts(place):
        found = found.get(key) if isinstance(found, Mapping) else None
    if isinstance(found, bool) or not isinstance(found, int | float) or place == "format":
        rule = "the place of one number that the scenario has, such as integrator.rtol"
        raise InvalidParameterError("fmu", "parameters", rule, place)
    return float(found)


def check_names(kind: str, names: Iterable[str], others: Iterable[str]) -> None:
    """Refuse names that stand twice."""
    seen = set(others)
    for name in names:
        if name in seen:
            raise InvalidParameterError("fmu", kind, "named once each, and no two alike", name)
        seen.add(name)
