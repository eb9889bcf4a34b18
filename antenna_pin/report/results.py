"""How runs ended, what is to be warned of, and their key numbers side by side."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from antenna_pin.analysis import (
    blocks,
    impacts,
    load_statistics,
    round_off_scales,
    said_of_limits,
    said_of_singular,
    said_of_spin,
)
from antenna_pin.readable import number, readable
from antenna_pin.report._page import (
    Row,
    Section,
    Table,
    counts,
    quantities,
    said_of_zeros,
    shares_row,
    words,
)
from antenna_pin.report._runs import ReportedRun, ideal_of, labels_of

__all__ = ["CONSERVED_WITHIN", "Status", "key_results", "conservation", "statuses", "warnings"]

#: Relative errors of what must be conserved beyond which a run is not to be trusted.
CONSERVED_WITHIN = 1e-6

#: Largest difference of the gaps by coal and by the closed form that passes without a warning [m].
GAPS_WITHIN = 1e-9


@dataclass(frozen=True, slots=True)
class Status:
    """How a run ended.

    Attributes:
        label: Of the run.
        completed: Whether it reached its end.
        outcome: Its name: COMPLETED, INTERRUPTED, ...
        text: In words, with the time that it reached.
    """

    label: str
    completed: bool
    outcome: str
    text: str


def statuses(runs: Sequence[ReportedRun]) -> list[Status]:
    """Return how each run ended."""
    return [_status(run) for run in runs]


def _status(run: ReportedRun) -> Status:
    reached = f"{readable(run.end, 's')} in {run.samples} sample{'s' if run.samples != 1 else ''}"
    wanted = run.run.scenario.duration if run.run.scenario is not None else None
    if not run.run.completed and wanted is not None:
        reached += f", of {readable(wanted, 's')} asked for"
    return Status(run.label, run.run.completed, run.run.outcome.name, f"{run.run.message} ({reached})")


def warnings(runs: Sequence[ReportedRun]) -> list[str]:
    """Return what a reader must know before believing the numbers, one sentence each."""
    said: dict[str, list[str]] = {}
    for run in runs:
        for text in _warnings(run):
            said.setdefault(text, []).append(run.label)
    return [f"{', '.join(labels)}: {text}" for text, labels in said.items()] + list(_differences(runs))


def _warnings(run: ReportedRun) -> Iterator[str]:
    data = run.data
    if run.samples < 2:
        yield "one sample only, so nothing is drawn or analysed over time."
    kept = _conserved(run)
    for key, what in (
        ("energy_error_relative", "the energy balance is off by"),
        ("linear_momentum_drift_relative", "linear momentum drifts by"),
        ("angular_momentum_drift_relative", "angular momentum drifts by"),
    ):
        value = kept.get(key)
        if value is not None and not abs(value) <= CONSERVED_WITHIN:
            yield (
                f"{what} {number(value, 2)} of its scale, more than {number(CONSERVED_WITHIN)}; "
                "tighten integrator.rtol."
            )
    if run.run.advice:
        yield f"the run was {run.run.advice}."
    if singular := said_of_singular(run.run.constraints):
        yield f"{singular}."
    if spun := said_of_spin(data):
        yield f"{spun}."
    for passed in said_of_limits(data):
        yield f"{passed}."
    gaps = float(data.attrs.get("gap_difference", 0.0))
    if not gaps <= GAPS_WITHIN:
        yield (
            f"coal and the closed form differ by {readable(gaps, 'm', 2)} in the gaps, more than "
            f"{readable(GAPS_WITHIN, 'm')}."
        )
    scenario = run.run.scenario
    if scenario is not None and scenario.mechanism.allow_impossible_inertia:
        bodies = ", ".join(scenario.mechanism.allow_impossible_inertia)
        yield f"no real body has the inertia of {bodies}, which breaks the triangle rule."


def _differences(runs: Sequence[ReportedRun]) -> Iterator[str]:
    if len({round(run.end, 9) for run in runs}) > 1:
        ends = ", ".join(f"{run.label} {readable(run.end, 's')}" for run in runs)
        yield f"The runs are not equally long ({ends}): compare totals and largest values with care."
    versions = {json.loads(run.data.attrs.get("versions", "{}")).get("antenna_pin") for run in runs}
    if len(versions) > 1:
        yield "The runs were made by different versions of antenna_pin; see Provenance."
    scenarios = {run.run.scenario.name for run in runs if run.run.scenario is not None}
    if len(scenarios) > 1:
        yield f"The runs are of different scenarios: {', '.join(sorted(scenarios))}."


def _conserved(run: ReportedRun) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(run.data.attrs.get("conservation", "{}"))
    return found


# --- key numbers ---


def key_results(runs: Sequence[ReportedRun]) -> Section:
    """Return the key numbers of all runs in one table, columns being runs."""
    scales = round_off_scales(*(run.data for run in runs))
    rows = [
        words("outcome", (run.run.outcome.name.lower().replace("_", " ") for run in runs)),
        quantities("simulated time", [run.end for run in runs], "s"),
    ]
    for joint in _every(runs, "joint"):
        rows += _joint_rows(runs, joint, scales)
    for joint in _every(runs, "clearance_joint"):
        rows += _clearance_rows(runs, joint)
    if any("base_position" in run.data for run in runs):
        rows += [
            Row("base"),
            quantities(
                "farthest from its start", [_base(run, _displacement) for run in runs], "m", 4, scales
            ),
            quantities("largest turn from its start", [_base(run, _turn) for run in runs], "rad", 4, scales),
        ]
    table = Table(
        columns=("", *labels_of(runs)), rows=tuple(rows), caption="Key numbers of the runs", key="key-results"
    )
    notes = []
    if _every(runs, "clearance_joint"):
        notes.append(
            "Forces, depths and speeds of contacts are the largest of the integrator's dense output, not of "
            "samples. Impulse is the integral of the normal forces over time; energy lost is that of "
            "contacts, normal and friction."
        )
    notes += said_of_zeros([table])
    return Section(key="results", title="Key results", items=(table,), notes=tuple(notes))


def _every(runs: Sequence[ReportedRun], dimension: str) -> list[str]:
    return list(dict.fromkeys(name for run in runs for name in run.names(dimension)))


def _joint_rows(runs: Sequence[ReportedRun], joint: str, scales: Mapping[str, float]) -> Iterator[Row]:
    def column(pick: Callable[[ReportedRun, int], float]) -> list[float | None]:
        return [
            pick(run, run.names("joint").index(joint)) if joint in run.names("joint") else None
            for run in runs
        ]

    yield Row(f"joint {joint}")
    angles, rates = (
        column(lambda run, k, of=of: _last(run, of, k))  # type: ignore[misc]
        for of in ("motion_angle", "motion_rate")
    )
    yield quantities("angle at the end", angles, "rad", 5, scales)
    yield quantities("rate at the end", rates, "rad/s", 5, scales)
    peaks = column(lambda run, k: _largest(run, "motion_acceleration", k))
    yield quantities("largest acceleration", peaks, "rad/s^2", scales=scales)
    ideal = ideal_of(runs)
    if ideal is not None and joint in ideal.names("joint"):
        own = peaks[list(runs).index(ideal)]
        ratios = [peak / own if peak is not None and own else None for peak in peaks]
        yield quantities("the same over the ideal joint's", ratios, "1", 3)


def _clearance_rows(runs: Sequence[ReportedRun], joint: str) -> Iterator[Row]:
    tables = [impacts(run.data, joint) if joint in run.names("clearance_joint") else None for run in runs]
    loads = [
        load_statistics(run.data, joint) if joint in run.names("clearance_joint") else None for run in runs
    ]

    def largest(name: str) -> list[float | None]:
        return [None if t is None else float(t[name].max()) if t.sizes["impact"] else 0.0 for t in tables]

    def total(name: str) -> list[float | None]:
        return [None if found is None else float(found[f"joint_{name}"].values[0]) for found in loads]

    yield Row(f"contact in {joint}")
    yield counts("contacts", (None if t is None else t.sizes["impact"] for t in tables))
    yield counts("blows", (None if t is None else len(set(t["blow"].values.tolist())) for t in tables))
    yield quantities("largest normal force", largest("peak_force"), "N")
    yield quantities("greatest depth", largest("peak_depth"), "m")
    yield quantities("fastest approach", largest("approach_speed"), "m/s")
    yield quantities("impulse", total("impulse"), "N s")
    yield quantities("energy lost", total("dissipated"), "J")
    yield shares_row("share of time in contact", total("contact_share"))


def _last(run: ReportedRun, name: str, k: int) -> float:
    return float(run.data[name][-1, k])


def _largest(run: ReportedRun, name: str, k: int) -> float:
    return max(float(np.abs(part[name].values[:, k]).max()) for part in blocks(run.data))


def _base(run: ReportedRun, of: Callable[[ReportedRun], float]) -> float | None:
    return of(run) if "base_position" in run.data else None


def _displacement(run: ReportedRun) -> float:
    start = run.data["base_position"][0].values
    parts = (part["base_position"].values - start for part in blocks(run.data))
    return max(float(np.linalg.norm(part, axis=1).max()) for part in parts)


def _turn(run: ReportedRun) -> float:
    x0 = run.data["base_attitude"][0].values
    return max(_largest_turn(x0, part["base_attitude"].values) for part in blocks(run.data))


def _largest_turn(x0: np.ndarray, q: np.ndarray) -> float:
    # Of q0* q the vector part is sin of half the angle; small angles keep their digits that way.
    scalar = q @ x0
    vector = (
        x0[3] * q[:, :3] - q[:, 3:] * x0[:3] - np.cross(np.broadcast_to(x0[:3], q[:, :3].shape), q[:, :3])
    )
    return float((2.0 * np.arctan2(np.linalg.norm(vector, axis=1), np.abs(scalar))).max())


# --- conservation ---


def conservation(runs: Sequence[ReportedRun]) -> Section:
    """Return how well each run kept what must be kept."""
    kept = [_conserved(run) for run in runs]

    def row(name: str, key: str, unit: str = "1") -> Row:
        return quantities(name, [found.get(key) for found in kept], unit, 3)

    rows = [
        Row("energy"),
        row("error of the balance", "energy_error", "J"),
        row("gross work of drives and forces", "gross_work", "J"),
        row("scale: gross work, or the largest kinetic energy where there is none", "energy_scale", "J"),
        row("error over scale", "energy_error_relative"),
        Row("linear momentum"),
        row("drift", "linear_momentum_drift", "kg m/s"),
        row("scale", "linear_momentum_scale", "kg m/s"),
        row("drift over scale", "linear_momentum_drift_relative"),
        Row("angular momentum, about the mass centre"),
        row("drift", "angular_momentum_drift", "kg m^2/s"),
        row("scale", "angular_momentum_scale", "kg m^2/s"),
        row("drift over scale", "angular_momentum_drift_relative"),
    ]
    if any(run.names("contact") for run in runs):
        gaps = [float(run.data.attrs["gap_difference"]) if run.names("contact") else None for run in runs]
        rows += [Row("contact geometry"), quantities("gaps, coal against closed form", gaps, "m", 3)]
    table = Table(
        columns=("", *labels_of(runs)),
        rows=tuple(rows),
        caption="What must be conserved, and by how much it was not",
        key="conservation",
    )
    return Section(
        key="conservation",
        title="Conservation",
        items=(table,),
        notes=(
            "Energy balance: what is stored, less that at the start and the drives' work, plus all losses. A "
            "momentum's scale is the largest sum of its magnitudes over the bodies without the base. A dash: "
            "nothing to compare with, or not conserved here (a fixed base, gravity).",
        ),
    )
