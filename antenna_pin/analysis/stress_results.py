"""Results of the stress analysis of contacts: surfaces, bushings, ball bearings."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import UnknownNameError


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SurfaceStress:
    """Stress of one pair of surfaces over a run, at its peak and over time.

    Numbers are NaN where they are not known, with a note that says why.

    Attributes:
        place: Of the surfaces: ``hinge.radial+`` of a contact, ``stops.hinge``, ``gears.stage``,
            ``bearings.main.inner``.
        surface: ``bore``, ``socket``, ``flange``, ``wall``, ``key``, ``stop``, ``flank`` or ``raceway``.
        theory: Name of the theory that gives the pressure, and of the criterion by which it was chosen.
        time: When the pressure was largest [s].
        force: Normal force then [N].
        pressure: Largest pressure in the middle of the contact [Pa].
        half_width: Half-width of the contact then, of an ellipse the shorter half-axis [m].
        half_length: Longer half-axis of an ellipse, half the length of a line [m].
        shear: Greatest shear stress below the surface [Pa].
        shear_depth: Its depth [m].
        material: Name of the material with the lower limit.
        limit: Yield limit of that material, of a raceway the pressure that ISO 76 permits [Pa].
        share: Pressure over limit [-].
        margin: Margin of safety, ``yield_share * limit / (factor * pressure) - 1`` [-].
        notes: Lines on assumptions, and on what makes the number doubtful.
        history: Pressure at the samples of the run, (samples,) [Pa]; empty of a lean result.
        line_load_ratio: Of a bore, largest load per length over its mean at the peak [-].
        along: Place of the largest load, from the middle of the bore along its axis; NaN of an even one [m].
        loaded_length: Length of the line that touches then [m].
        edge_loaded: Whether the load is largest at an end of the bore, and above 1.5 times its mean.
        places: Along the bore's axis, (nodes,) [m]; empty of other surfaces.
        profile: Pressure there at the peak, (nodes,) [Pa].
    """

    place: str
    surface: str
    theory: str
    time: float
    force: float
    pressure: float
    half_width: float
    half_length: float
    shear: float
    shear_depth: float
    material: str
    limit: float
    share: float
    margin: float
    notes: tuple[str, ...]
    history: Array
    line_load_ratio: float = math.nan
    along: float = math.nan
    loaded_length: float = math.nan
    edge_loaded: bool = False
    places: Array = field(default_factory=lambda: np.zeros(0))
    profile: Array = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BushingLoad:
    """Mean pressure and sliding speed of a bushing over a run.

    Attributes:
        joint: Name of the joint.
        pressure: Largest mean pressure, radial force over length times diameter [Pa].
        speed: Largest sliding speed while touching [m/s].
        pv: Largest product of both at one time [W/m^2], 1e6 of which are 1 MPa m/s.
        time: When that was [s].
        mean_pv: Mean of the product over the whole time [W/m^2].
        limit: Permitted product [W/m^2]; NaN if not given.
        share: Largest product over the permitted one [-].
        history: Product at the samples, (samples,) [W/m^2].
    """

    joint: str
    pressure: float
    speed: float
    pv: float
    time: float
    mean_pv: float
    limit: float
    share: float
    history: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BearingRating:
    """Static rating and safety of a ball bearing over a run.

    Attributes:
        place: Of the bearing, ``bearings.main``.
        radial_rating: C_0r of a row by the definition of ISO 76 [N].
        axial_rating: C_0a of a row [N].
        ball_load: Largest load of a ball [N].
        ball: Its number, row by row from 1.
        time: When that was [s].
        pressure: Largest pressure at a raceway [Pa].
        static_factor: s_0, load of a ball at 4200 MPa over its largest load [-].
        loads: Load of each ball at the samples, (samples, balls) [N].
        notes: Lines on assumptions.
    """

    place: str
    radial_rating: float
    axial_rating: float
    ball_load: float
    ball: int
    time: float
    pressure: float
    static_factor: float
    loads: Array
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContactStress:
    """Stress of all surfaces of a run that meet.

    Attributes:
        surfaces: Contacts of joints with play, stops, gears and raceways.
        bushings: Bores with a length.
        bearings: Ball bearings given by their balls.
        time: Samples of the run, (samples,) [s]; empty of a lean result.
        yield_share: Share of the yield limit that a pressure may reach [-].
        factor: Factor on the pressure [-].
        notes: Lines on what has no stress here, and why.
    """

    surfaces: tuple[SurfaceStress, ...]
    bushings: tuple[BushingLoad, ...]
    bearings: tuple[BearingRating, ...]
    time: Array
    yield_share: float
    factor: float
    notes: tuple[str, ...]

    def surface(self, place: str) -> SurfaceStress:
        """Return the stress at a place, as ``hinge.radial+``.

        Raises:
            UnknownNameError: There is none.
        """
        for one in self.surfaces:
            if one.place == place:
                return one
        raise UnknownNameError("ContactStress", "surface", place, [one.place for one in self.surfaces])

    @property
    def worst(self) -> SurfaceStress | None:
        """Surface with the least margin; None without any known margin."""
        known = [one for one in self.surfaces if math.isfinite(one.margin)]
        return min(known, key=lambda one: one.margin, default=None)


@takes()
def numbers_of_row(row: SurfaceStress | BushingLoad | BearingRating) -> dict[str, Any]:
    """Return numbers and texts of a row by name, without arrays."""
    found: dict[str, Any] = {}
    for item in fields(row):
        value = getattr(row, item.name)
        if isinstance(value, np.ndarray):
            continue
        found[item.name] = "; ".join(value) if isinstance(value, tuple) else value
    return found
