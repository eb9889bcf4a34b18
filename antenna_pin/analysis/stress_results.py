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
    """

    # of the surfaces: ``hinge.radial+`` of a contact, ``stops.hinge``, ``gears.stage``,
    # ``bearings.main.inner``
    place: str
    surface: str  # ``bore``, ``socket``, ``flange``, ``wall``, ``key``, ``stop``, ``flank`` or ``raceway``
    theory: str  # name of the theory that gives the pressure, and of the criterion by which it was chosen
    time: float  # when the pressure was largest [s]
    force: float  # normal force then [N]
    pressure: float  # largest pressure in the middle of the contact [Pa]
    half_width: float  # half-width of the contact then, of an ellipse the shorter half-axis [m]
    half_length: float  # longer half-axis of an ellipse, half the length of a line [m]
    shear: float  # greatest shear stress below the surface [Pa]
    shear_depth: float  # its depth [m]
    material: str  # name of the material with the lower limit
    limit: float  # yield limit of that material, of a raceway the pressure that ISO 76 permits [Pa]
    share: float  # pressure over limit [-]
    margin: float  # margin of safety, ``yield_share * limit / (factor * pressure) - 1`` [-]
    notes: tuple[str, ...]  # lines on assumptions, and on what makes the number doubtful
    history: Array  # pressure at the samples of the run, (samples,) [Pa]; empty of a lean result
    line_load_ratio: float = math.nan  # of a bore, largest load per length over its mean at the peak [-]
    # place of the largest load, from the middle of the bore along its axis; NaN of an even one [m]
    along: float = math.nan
    loaded_length: float = math.nan  # length of the line that touches then [m]
    # whether the load is largest at an end of the bore, and above 1.5 times its mean
    edge_loaded: bool = False
    # along the bore's axis, (nodes,) [m]; empty of other surfaces
    places: Array = field(default_factory=lambda: np.zeros(0))
    profile: Array = field(default_factory=lambda: np.zeros(0))  # pressure there at the peak, (nodes,) [Pa]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BushingLoad:
    """Mean pressure and sliding speed of a bushing over a run."""

    joint: str  # name of the joint
    pressure: float  # largest mean pressure, radial force over length times diameter [Pa]
    speed: float  # largest sliding speed while touching [m/s]
    pv: float  # largest product of both at one time [W/m^2], 1e6 of which are 1 MPa m/s
    time: float  # when that was [s]
    mean_pv: float  # mean of the product over the whole time [W/m^2]
    limit: float  # permitted product [W/m^2]; NaN if not given
    share: float  # largest product over the permitted one [-]
    history: Array  # product at the samples, (samples,) [W/m^2]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BearingRating:
    """Static rating and safety of a ball bearing over a run."""

    place: str  # of the bearing, ``bearings.main``
    radial_rating: float  # C_0r of a row by the definition of ISO 76 [N]
    axial_rating: float  # C_0a of a row [N]
    ball_load: float  # largest load of a ball [N]
    ball: int  # its number, row by row from 1
    time: float  # when that was [s]
    pressure: float  # largest pressure at a raceway [Pa]
    static_factor: float  # s_0, load of a ball at 4200 MPa over its largest load [-]
    loads: Array  # load of each ball at the samples, (samples, balls) [N]
    notes: tuple[str, ...]  # lines on assumptions


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContactStress:
    """Stress of all surfaces of a run that meet."""

    surfaces: tuple[SurfaceStress, ...]  # contacts of joints with play, stops, gears and raceways
    bushings: tuple[BushingLoad, ...]  # bores with a length
    bearings: tuple[BearingRating, ...]  # ball bearings given by their balls
    time: Array  # samples of the run, (samples,) [s]; empty of a lean result
    yield_share: float  # share of the yield limit that a pressure may reach [-]
    factor: float  # factor on the pressure [-]
    notes: tuple[str, ...]  # lines on what has no stress here, and why

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
