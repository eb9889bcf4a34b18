"""Further analyses of a verification's nominal state, for its report: margins over travel, loops, stress."""

from __future__ import annotations

import json
import math
import shlex
import warnings
from collections.abc import Callable, Iterator
from typing import Any

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number, readable
from antenna_pin.base.units import any_quantity
from antenna_pin.errors import AntennaPinError
from antenna_pin.scenario.requirements import RequirementSpec
from antenna_pin.studies.verification.design_quantities import loop_of, margin_of, orders_of, stress_of
from antenna_pin.studies.verification.output import NOMINAL
from antenna_pin.studies.verification.quantity import Case
from antenna_pin.studies.verification.verify import Verified
from antenna_pin.trajectory import Trajectory

_MARGINS = (
    "gain_margin", "phase_margin", "delay_margin", "modulus_margin", "loop_damping", "bandwidth",
)  # fmt: skip
# Amplitudes of a measured loop over that of its requirement.
_AMPLITUDES = (0.5, 1.0, 2.0)
_MEASURED_MARGINS = ("measured_phase_margin", "measured_gain_margin")
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
        ``head`` and ``rows`` of a table, ``made_by``, the command or call that repeats it in the folder of
        the output, and what a figure is drawn of.
    """
    case = Case(verified.plan.base, lambda: run)  # type: ignore[arg-type, return-value]
    curves: list[dict[str, Any]] = []
    parts: list[Callable[[], Iterator[dict[str, Any]]]] = [
        lambda: _margins(verified, case),
        lambda: _torque_angle(verified, case),
        lambda: _orders(verified, case),
        lambda: _measured_loops(verified),
        lambda: _chains(verified),
    ]
    if run is not None:
        parts.append(lambda: _stress(case))
    by_run = f"antenna-pin stress nominal-{verified.digest}.nc"
    for part in parts:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of runs beside the nominal one
                curves += [{"made_by": by_run, **one} for one in part()]
        except AntennaPinError as error:
            say(f"note: {error}")
    return list(_loops(verified, say)), curves


def _specs(verified: Verified, *names: str) -> list[RequirementSpec]:
    """Return the requirements of some quantities, one of each object and options."""
    found: dict[str, RequirementSpec] = {}
    for spec in verified.plan.requirements.values():
        if spec.quantity in names:
            found.setdefault(f"{spec.of} {spec.travel} {spec.factors} {spec.torque} {spec.speeds}", spec)
    return list(found.values())


def _command(command: str, *options: tuple[str, Any]) -> str:
    """Return the command that repeats an analysis of the nominal scenario."""
    words = [f"--{name}={value}" for name, value in options if value is not None]
    return shlex.join(["antenna-pin", command, NOMINAL, *words])


def _call(function: str, *arguments: Any, **options: Any) -> str:
    """Return the call in Python that repeats an analysis of the nominal scenario."""
    words = [f'load_scenario("{NOMINAL}")', *(json.dumps(one) for one in arguments)]
    words += [f"{name}={json.dumps(value)}" for name, value in options.items() if value is not None]
    return f"{function}({', '.join(words)})"


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
            "made_by": _call("loop_margins", name),
            "frequency": found.frequency[::20],
            "response": found.response[::20],
        }


def _measured_loops(verified: Verified) -> Iterator[dict[str, Any]]:
    """Yield the loops of requirements that measure them in runs, one line for each amplitude."""
    from antenna_pin.studies.linear import loop_margins
    from antenna_pin.studies.verification.measurement import (
        frequencies_around,
        margins_of_points,
        measured_loop,
    )

    scenario = verified.plan.base
    asked: dict[tuple[str, Any], set[tuple[float, str]]] = {}
    for spec in verified.plan.requirements.values():
        read = None if spec.amplitude is None else any_quantity(spec.amplitude)
        if spec.quantity in _MEASURED_MARGINS and spec.of is not None and read is not None:
            sizes = {(share * read[0], read[1]) for share in _AMPLITUDES}
            asked.setdefault((spec.of, spec.operating_point), set()).update(sizes)
    for (name, point), amplitudes in asked.items():
        small = loop_margins(scenario, name)
        rows = [
            [
                "small motions",
                readable(small.bandwidth, "Hz", 3),
                readable(math.degrees(small.phase_margin), "deg", 3),
                readable(small.gain_margin, "1", 3),
                "0",
            ]
        ]
        lines, frequencies = {}, frequencies_around(small)
        for size, measure in sorted(amplitudes):
            amplitude = readable(size, measure or "1")
            points = measured_loop(scenario, name, frequencies, size, point)
            found = margins_of_points(points)
            numbers = ((found.crossing, "Hz"), (math.degrees(found.phase), "deg"), (found.gain, "1"))
            rows.append(
                [
                    amplitude,
                    *(
                        readable(value, unit, 3) if math.isfinite(value) else "outside"
                        for value, unit in numbers
                    ),
                    readable(max(point.distortion for point in points), "1", 2),
                ]
            )
            lines[amplitude] = ([point.frequency for point in points], [point.gain for point in points])
        yield {
            "analysis": "control",
            "key": f"measured-loop-{name}",
            "made_by": _call("measured_loop", name, frequencies, max(amplitudes)[0], operating_point=point),
            "title": f"Loop {name} measured in runs with sine references, through play and friction",
            "head": ("amplitude", "gain 1 at", "phase margin", "gain margin", "largest distortion"),
            "rows": rows,
            "measured": (small.frequency[::20], {name: small.response[::20]}, lines),
            "caption": f"Loop {name}: small motions (line), and fundamentals in runs",
            "notes": (
                "Measured loops depend on the amplitude, as a describing function does; limits, "
                "quantisation, sticking and play are in them.",
            ),
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
            "made_by": _command(
                "margin",
                ("joint", spec.of),
                ("travel", spec.travel and f"{spec.travel[0]}:{spec.travel[1]}"),
                ("count", spec.positions),
                ("factors", spec.factors),
            ),
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
            "made_by": _command(
                "statics", ("joint", spec.of), ("loop", spec.torque), *(("hold", one) for one in spec.hold)
            ),
            "title": f"Torque-angle loop of {found.joint}, {readable(found.amplitude, units['friction'])}",
            "head": ("measure", "value", "definition"),
            "sentences": True,
            "rows": rows,
            "loop": found.data,
            "caption": f"Torque-angle loop of {found.joint}",
            "notes": found.notes,
        }


def _orders(verified: Verified, case: Case) -> Iterator[dict[str, Any]]:
    for count, spec in enumerate(_specs(verified, "order_coefficient", "order_amplitude"), start=1):
        found = orders_of(case, spec)
        rows = []
        for order in found["order"].values:
            for axis in found["axis"].values:
                one = found.sel(order=order, axis=axis)
                largest = float(one["amplitude"].max())
                if largest == 0.0:
                    continue
                force = str(axis).startswith("f")
                resonant = [
                    f"{30.0 / math.pi * speed:.4g}" for speed in one["speed"].values[one["resonant"].values]
                ]
                rows.append(
                    [
                        f"{order:.6g}",
                        str(axis),
                        readable(float(one["coefficient"]), "kg m" if force else "kg m^2"),
                        readable(float(one["misfit"]), "1", 2),
                        readable(largest, "N" if force else "N m"),
                        ", ".join(resonant) or "none",
                    ]
                )
        yield {
            "analysis": "disturbance",
            "key": f"orders-{count}",
            "made_by": _call("measured_orders", spec.of, list(spec.speeds or ()), count=spec.positions),
            "title": f"Orders of {spec.of}: harmonics h and coefficients C, nominal state",
            "head": ("order h", "axis", "C", "misfit", "largest amplitude", "resonant at [rpm]"),
            "rows": rows,
            "orders": found,
            "caption": f"Amplitudes of {spec.of}'s orders over its speed; lines: C times its square",
            "notes": (
                "Orders: force and moment of the mechanism on its base, least squares over the wheel's angle "
                "in runs at each speed; resonant speeds do not count in C.",
            ),
        }


def _chains(verified: Verified) -> Iterator[dict[str, Any]]:
    """Yield the tolerance chains of the scenario at its temperatures."""
    from antenna_pin.scenario.assemble import tolerance_chain

    scenario = verified.plan.base
    for name, spec in scenario.tolerances.items():
        chain = tolerance_chain(scenario, name)
        rows = [
            [
                one.name,
                readable(one.nominal, "m", 6),
                f"{readable(one.minus, 'm')} to {readable(one.plus, 'm')}",
                number(one.coefficient),
                one.distribution,
                f"{100.0 * chain.shares[one.name]:.3g} %",
            ]
            for one in chain.dimensions
        ]
        sums = (("worst case", chain.worst_case), ("root sum square", chain.root_sum_square))
        rows += [
            [
                title,
                readable(chain.nominal, "m", 6),
                " to ".join(readable(end, "m") for end in ends),
                "",
                "",
                "",
            ]
            for title, ends in sums
        ]
        yield {
            "analysis": "budget",
            "key": f"chain-{name}",
            "made_by": _command("tolerance"),
            "title": f"Tolerance chain {name}",
            "head": (
                "dimension",
                "nominal",
                "deviations; range of the sum",
                "coefficient",
                "distribution",
                "share",
            ),
            "rows": rows,
            "chain": (chain, spec.least, spec.most),
            "caption": f"Tolerance chain {name}: dimensions, and distribution of their sum",
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
