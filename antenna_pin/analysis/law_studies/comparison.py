"""Elastic laws compared for one joint: ratios of their forces at the same depth."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from antenna_pin.base.arguments import takes
from antenna_pin.contact import (
    NORMAL_LAWS,
    CompiledNormalLaw,
    ElasticLaw,
    Material,
    NormalLaw,
    effective_modulus,
    internal_hertz_stiffness,
    is_elastic,
    law_parameters,
    make_normal_law,
)
from antenna_pin.errors import InvalidParameterError


@takes()
def elastic_laws_of_joint(
    *, bearing_radius: float, journal_radius: float, length: float, bearing: Material, journal: Material
) -> dict[str, ElasticLaw]:
    """Return every elastic law for a journal in a bore, by name.

    Laws that do not hold for these dimensions are left out; :func:`laws_left_out` gives the reason.

    Args:
        bearing_radius: R_i [m].
        journal_radius: R_j [m].
        length: L, of the line of contact [m].
        bearing: Material of the bearing.
        journal: Material of the journal.
    """
    tried = _try_all(bearing_radius, journal_radius, length, bearing, journal)
    return {name: law for name, law in tried.items() if not isinstance(law, InvalidParameterError)}


@takes()
def laws_left_out(
    *, bearing_radius: float, journal_radius: float, length: float, bearing: Material, journal: Material
) -> dict[str, InvalidParameterError]:
    """Return the reasons against elastic laws; arguments as of :func:`elastic_laws_of_joint`."""
    tried = _try_all(bearing_radius, journal_radius, length, bearing, journal)
    return {name: law for name, law in tried.items() if isinstance(law, InvalidParameterError)}


def _try_all(
    bearing_radius: float, journal_radius: float, length: float, bearing: Material, journal: Material
) -> dict[str, ElasticLaw | InvalidParameterError]:
    """Return every elastic law by name, or its refusal."""
    modulus = effective_modulus(bearing, journal)
    stiffness = internal_hertz_stiffness(bearing_radius, journal_radius, modulus)
    known = {"length": length, "modulus": modulus, "stiffness": stiffness}
    known |= {"journal_radius": journal_radius, "bearing_radius": bearing_radius}
    found: dict[str, ElasticLaw | InvalidParameterError] = {}
    for name, cls in NORMAL_LAWS.items():
        if not is_elastic(name):
            continue
        parameters = {key: known[key] for key, p in law_parameters(cls).items() if p.from_joint}
        try:
            law: CompiledNormalLaw = make_normal_law(name, parameters)
        except InvalidParameterError as refusal:
            found[name] = refusal
            continue
        assert isinstance(law, ElasticLaw)
        found[name] = law
    return found


@takes()
def differing_factor(forces: Iterable[float]) -> float | None:
    """Return the ratio of the largest to the smallest force; None for fewer than two.

    Forces are those of several laws at one depth [N], NaN where a law does not hold.
    """
    known = [force for force in forces if math.isfinite(force)]
    return max(known) / min(known) if len(known) > 1 else None


@takes()
def force_table(laws: Mapping[str, NormalLaw], depths: Iterable[float]) -> dict[str, tuple[float, ...]]:
    """Return the elastic force of each law at each depth [N]; NaN beyond its range."""
    points = tuple(depths)
    return {name: tuple(force_within(law, depth) for depth in points) for name, law in laws.items()}


@takes()
def force_within(law: NormalLaw, depth: float) -> float:
    """Return the elastic force of a law at a depth [N]; NaN out of range."""
    return law.elastic_force(depth) if depth <= getattr(law, "depth_limit", math.inf) else math.nan
