"""Further analyses of a verification's nominal state, for its report: margins over travel, loops, stress."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number, readable
from antenna_pin.errors import AntennaPinError
from antenna_pin.scenario.requirements import RequirementSpec
from antenna_pin.studies.verification.design_quantities import loop_of, margin_of, stress_of
from antenna_pin.studies.verification.quantity import Case
from antenna_pin.studies.verification.verify import Verified
from antenna_pin.trajectory import Trajectory

__all__ = ["analyses_of"]

_MARGINS = (
    "gain_margin", "phase_margin", "delay_margin", "modulus_margin", "loop_damping", "bandwidth",
)  # fmt: skip
_LOOP_MEASURES = ("stiffness", "lost_motion", "dead_band", "hysteresis", "loop_friction")


@takes()
def analyses_of(
    verified: Verified, run: Trajectory | None, say: Callable[[str], None]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return sampled loops, and tables and curves of other analyses, all of the nominal state.

    Args:
        verified: The result.
        run: The nominal run, or None.
        say: Called with each note, one line.

    Returns:
        Of each PID loop its margins and response; of each other analysis ``analysis``, ``key``, ``title``,
        ``head`` and ``rows`` of a table, and the data of a figure.
    """
    case = Case(verified.plan.base, lambda: run)  # type: ignore[arg-type, return-value]
    curves: list[dict[str, Any]] = []
    parts: list[Callable[[], Iterator[dict[str, Any]]]] = [
        lambda: _margins(verified, case),
        lambda: _torque_angle(verified, case),
    ]
    if run is not None:
        parts.append(lambda: _stress(case))
    for part in parts:
        try:
            curves += list(part())
        except AntennaPinError as error:
            say(f"note: {error}")
    return list(_loops(verified, say)), curves


def _specs(verified: Verified, *names: str) -> list[RequirementSpec]:
    """Return the requirements of some quantities, one of each object and options."""
    found: dict[str, RequirementSpec] = {}
    for spec in verified.plan.requirements.values():
        if spec.quantity in names:
            found.setdefault(f"{spec.of} {spec.travel} {spec.factors} {spec.torque}", spec)
    return list(found.values())


def _loops(verified: Verified, say: Callable[[str], None]) -> Iterator[dict[str, Any]]:
    from antenna_pin.studies.linear import loop_margins

    scenario = verified.plan.base
    for name in (name for name, table in scenario.controllers.items() if table.kind == "pid"):
        try:
            found = loop_margins(scenario, name)
        except AntennaPinError as error:
            say(f"note: no margins of loop {name}: {error}")
            continue
        yield {key: float(getattr(found, key)) for key in _MARGINS} | {
            "controller": name,
            "frequency": found.frequency[::20],
            "response": found.response[::20],
        }


def _margins(verified: Verified, case: Case) -> Iterator[dict[str, Any]]:
    for count, spec in enumerate(_specs(verified, "motorization_margin"), start=1):
        found = margin_of(case, spec)
        data = found.data.sel(position=found.position, method="nearest")
        unit = "N" if found.sliding else "N m"
        rows = []
        for k, source in enumerate(data["source"].values):
            rows.append(
                [
                    str(source),
                    str(data["symbol"].values[k]),
                    readable(float(data["resistance"].values[k]), unit),
                    readable(float(data["resistance_factor"].values[k]), "1"),
                    readable(float(data["drive"].values[k]), unit),
                    readable(float(data["drive_factor"].values[k]), "1"),
                    "measured" if data["by_measurement"].values[k] else "theoretical",
                ]
            )
        place = readable(found.position, "m" if found.sliding else "rad")
        yield {
            "analysis": "motorization",
            "key": f"motorization-{count}",
            "title": f"Motorization of {found.joint} at {place}, where its margin is smallest",
            "head": ("source", "class", "resists", "factor", "drives", "factor", "value"),
            "rows": rows,
            "margin": found.data,
            "caption": f"Motorization of {found.joint} over its travel, {found.factors.source}",
            "notes": (*found.notes, f"Factors: {found.factors.source}, {found.factors.clause}."),
        }


def _torque_angle(verified: Verified, case: Case) -> Iterator[dict[str, Any]]:
    from antenna_pin.studies.statics.torque_angle import DEFINITIONS

    for count, spec in enumerate(_specs(verified, *_LOOP_MEASURES), start=1):
        found = loop_of(case, spec)
        turning = {"stiffness": "N m/rad", "area": "J", "friction": "N m"}
        sliding = {"stiffness": "N/m", "area": "J", "friction": "N"}
        units = sliding if found.sliding else turning
        plain = "m" if found.sliding else "rad"
        rows = [
            [name.replace("_", " "), readable(float(getattr(found, name)), units.get(name, plain)), words]
            for name, words in DEFINITIONS.items()
        ]
        yield {
            "analysis": "motorization",
            "key": f"torque-angle-{count}",
            "title": f"Torque-angle loop of {found.joint}, {readable(found.amplitude, units['friction'])}",
            "head": ("measure", "value", "definition"),
            "sentences": True,
            "rows": rows,
            "loop": found.data,
            "caption": f"Torque-angle loop of {found.joint}",
            "notes": found.notes,
        }


def _stress(case: Case) -> Iterator[dict[str, Any]]:
    found = stress_of(case)
    met = [one for one in found.surfaces if math.isfinite(one.pressure) and one.pressure > 0.0]
    told: dict[str, list[str]] = {}
    rows = [
        [
            one.place,
            one.surface,
            readable(one.force, "N"),
            readable(one.pressure, "Pa"),
            readable(one.half_width, "m"),
            readable(one.shear_depth, "m"),
            readable(one.margin, "1", 3) if math.isfinite(one.margin) else "unknown",
            f"{number(one.line_load_ratio, 3)}{', edge loaded' if one.edge_loaded else ''}",
            one.theory,
        ]
        for one in met
    ]
    for one in met:
        for note in one.notes:
            told.setdefault(note, []).append(one.place)
    if rows:
        yield {
            "analysis": "stress",
            "key": "surfaces",
            "sentences": True,
            "title": "Contact stress at its peak, nominal run",
            "head": (
                *("surface", "kind", "force", "pressure", "half-width", "shear at", "margin"),
                *("largest / mean load", "theory"),
            ),
            "rows": rows,
            "stress": found,
            "caption": "Contact pressure over the nominal run",
            "notes": (*(f"{', '.join(places)}: {note}" for note, places in told.items()), *found.notes),
        }
    if found.bearings:
        yield {
            "analysis": "stress",
            "key": "ratings",
            "title": "Ball bearings, nominal run",
            "head": ("bearing", "C0r of a row", "C0a of a row", "largest ball load", "pressure", "s0"),
            "rows": [
                [
                    one.place,
                    readable(one.radial_rating, "N"),
                    readable(one.axial_rating, "N"),
                    readable(one.ball_load, "N"),
                    readable(one.pressure, "Pa"),
                    readable(one.static_factor, "1"),
                ]
                for one in found.bearings
            ],
        }
    if found.bushings:
        yield {
            "analysis": "stress",
            "key": "bushings",
            "title": "Bushings, nominal run",
            "head": ("joint", "mean pressure", "sliding speed", "PV", "mean PV"),
            "rows": [
                [
                    one.joint,
                    readable(one.pressure, "Pa"),
                    readable(one.speed, "m/s"),
                    readable(one.pv, "Pa m/s"),
                    readable(one.mean_pv, "Pa m/s"),
                ]
                for one in found.bushings
            ],
        }
