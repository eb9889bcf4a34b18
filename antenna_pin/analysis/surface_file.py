"""Surfaces of stops, gears and joints as a file describes them, for contact stress.

A result holds the bores, sockets and balls of its joints. What carries the load of a stop, the width of a
gear, or the rounding of a flange's edge stands in no motion, so it is given here, in SI units or with units.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, ValidationError, model_validator

from antenna_pin.base.arguments import takes
from antenna_pin.errors import ScenarioError
from antenna_pin.scenario.mechanism import MaterialSpec
from antenna_pin.scenario.shipped import read_toml
from antenna_pin.scenario.spec import (
    PositiveLength,
    QuantityRule,
    Spec,
    ValuePlace,
    Version,
    dotted,
    explained,
    refuse,
)

#: Pressure angle of gears that give none [rad]: 20 deg.
_PRESSURE_ANGLE = 0.3490658503988659


class JointSurface(Spec):
    """Surfaces of a joint with play beyond what a result holds.

    Attributes:
        bearing_material: Name of a material, instead of the scenario's.
        journal_material: Likewise.
        length: Of the line of contact of all ends together [m]; the bearing's length if left out.
        edge_radius: Rounding of the edges of flange, bearing or key [m]; a sharp edge has no finite pressure.
        pv_limit: Largest permitted product of mean pressure and sliding speed [W/m^2], as ``"0.1 MPa*m/s"``.
    """

    bearing_material: str | None = None
    journal_material: str | None = None
    length: PositiveLength | None = None
    edge_radius: PositiveLength | None = None
    pv_limit: Annotated[float, QuantityRule("W/m**2", "positive")] | None = None


class StopSurface(Spec):
    """Contact surface of a stop: ball or cylinder on a flat or in a hollow.

    Attributes:
        lever: Distance of the contact from the joint's axis [m]; left out where the joint slides.
        radius: Of the ball or cylinder [m].
        length: Of the cylinder [m]; left out of a ball.
        hollow_radius: Of the hollow that it meets [m]; a flat if left out.
        materials: Names of both materials.
    """

    lever: PositiveLength | None = None
    radius: PositiveLength
    length: PositiveLength | None = None
    hollow_radius: PositiveLength | None = None
    materials: tuple[str, str]

    @model_validator(mode="after")
    def _check_hollow(self) -> Self:
        if self.hollow_radius is not None and not self.hollow_radius > self.radius:
            refuse(
                f"must be above radius = {self.radius:g} m, got {self.hollow_radius:g} m",
                "hollow_radius",
                value=self.hollow_radius,
            )
        return self


class FlankSurface(Spec):
    """Teeth of a pair of gears, or of a pinion and a rack.

    Attributes:
        input_radius: Pitch radius of the input's gear [m]; of a rack the pinion's, which the scenario has.
        output_radius: Of the output's gear [m]; left out of a rack.
        width: Of the teeth [m].
        pressure_angle: [rad].
        materials: Names of the materials of input and output.
    """

    input_radius: PositiveLength
    output_radius: PositiveLength | None = None
    width: PositiveLength
    pressure_angle: Annotated[float, QuantityRule("rad", "positive")] = _PRESSURE_ANGLE
    materials: tuple[str, str]


class SurfaceFile(Spec):
    """Surfaces for contact stress, by the names of joints, stops and gears of a scenario.

    Attributes:
        format: Version of the format.
        materials: Materials by name, before the scenario's and the shipped ones.
        joints: Joints with play.
        stops: Stops, by their names in ``[stops.NAME]``.
        gears: Gears and racks, by their names in ``[gears.NAME]``.
    """

    format: Version = 1
    materials: dict[str, MaterialSpec] = Field(default_factory=dict)
    joints: dict[str, JointSurface] = Field(default_factory=dict)
    stops: dict[str, StopSurface] = Field(default_factory=dict)
    gears: dict[str, FlankSurface] = Field(default_factory=dict)


@takes()
def read_surfaces(path: str | os.PathLike[str]) -> SurfaceFile:
    """Return the surfaces in a TOML file.

    Raises:
        ScenarioError: With one line that gives file, place, rule, the value seen and a way out.
    """
    label = os.fspath(path)
    found = Path(label).expanduser()
    if not found.is_file():
        raise ScenarioError(f"{label}: must be an existing TOML file of surfaces")
    data = read_toml(found, label)
    try:
        return SurfaceFile.validated(data)
    except ValidationError as error:
        raise explained(error, lambda at: ValuePlace(f"{label}: {dotted(at)}".strip())) from None
