"""Stress of two surfaces that meet: materials, criteria, peak and margin."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from antenna_pin.analysis.stress_results import SurfaceStress
from antenna_pin.base.arrays import Array
from antenna_pin.contact import Material, effective_modulus


@dataclass(frozen=True, slots=True, kw_only=True)
class StressCriteria:
    """Criteria of the analysis."""

    yield_share: float  # share of the yield limit that a pressure may reach [-]
    factor: float  # factor on the pressure [-]
    conformal_above: float  # half-width over radius above which a bore is conformal [-]


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """Two materials that touch, by name."""

    names: tuple[str, ...]  # their names; empty where none is known
    materials: tuple[Material, ...]  # their numbers
    modulus: float  # E* [Pa]; NaN if unknown

    @classmethod
    def of(cls, bearing: str, journal: str, known: Callable[[str], Material]) -> Pair:
        """Return the pair of two names."""
        both = known(bearing), known(journal)
        return cls(names=(bearing, journal), materials=both, modulus=effective_modulus(*both))

    @property
    def weakest(self) -> tuple[str, float]:
        """Name and yield limit of the weaker known material [Pa]; NaN without any."""
        limits = [(one.yield_strength, name) for name, one in zip(self.names, self.materials, strict=True)]
        known = [(limit, name) for limit, name in limits if limit is not None]
        limit, name = min(known, default=(math.nan, ""))
        return name, limit

    @property
    def unknown(self) -> tuple[str, ...]:
        """Names of the materials without a known yield limit, each once."""
        both = zip(self.names, self.materials, strict=True)
        return tuple(dict.fromkeys(name for name, one in both if one.yield_strength is None))

    @property
    def poisson(self) -> float:
        """Poisson's ratio of the weaker material, 0.3 if unknown [-]."""
        name, _ = self.weakest
        return self.materials[self.names.index(name)].poisson if name in self.names else 0.3


class Stresses(NamedTuple):
    """Stress over some forces, each (n,)."""

    pressure: Array  # [Pa]
    half_width: Array  # [m]
    half_length: Array  # [m]
    shear: Array  # [Pa]
    shear_depth: Array  # [m]


class ForcePeak(NamedTuple):
    """Largest force of a contact, between samples too."""

    force: float  # [N]
    time: float  # [s]
    sample: int = -1  # nearest one in contact; -1 for none


def surface_of(
    place: str,
    surface: str,
    theory: str,
    pair: Pair,
    limits: StressCriteria,
    peak: ForcePeak,
    stress: Stresses,
    history: Array,
    notes: list[str],
) -> SurfaceStress:
    """Return the row of a surface with its margin against yield."""
    name, limit = pair.weakest
    pressure = float(stress.pressure[0])
    for unknown in pair.unknown:
        notes = [
            *notes,
            f"the yield limit of {unknown} is not known: give materials.{unknown}.yield_strength",
        ]
    loaded = pressure > 0.0
    return SurfaceStress(
        place=place,
        surface=surface,
        theory=theory,
        time=peak.time,
        force=peak.force,
        pressure=pressure,
        half_width=float(stress.half_width[0]),
        half_length=float(stress.half_length[0]),
        shear=float(stress.shear[0]),
        shear_depth=float(stress.shear_depth[0]),
        material=name,
        limit=limit,
        share=pressure / limit,
        margin=limits.yield_share * limit / (limits.factor * pressure) - 1.0 if loaded else math.inf * limit,
        notes=tuple(notes),
        history=history,
    )
