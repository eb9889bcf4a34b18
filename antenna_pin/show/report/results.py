"""Outcomes of runs, warnings, and conservation."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from antenna_pin.analysis import answer, said_of_limits, said_of_singular, said_of_spin
from antenna_pin.base.readable import number, readable
from antenna_pin.show.report._page import Details, Picture, Section, Status
from antenna_pin.show.report._runs import ReportedRun, row_of, run_table
from antenna_pin.trajectory.quantities import RUN

#: Relative errors of what must be conserved beyond which a run is not to be trusted.
CONSERVED_WITHIN = 1e-6

#: Of what an answer tells beside the hardest blow, and how much of it stands at the head of a page.
_ANSWERS = ("pointing", "latches", "stops", "closures", "gears")
_MOST = 3

#: Largest difference of the gaps by coal and by the closed form that passes without a warning [m].
GAPS_WITHIN = 1e-9


def status(run: ReportedRun) -> Status:
    """Return the outcome of a run."""
    reached = f"{readable(run.end, 's')} in {run.samples} sample{'s' if run.samples != 1 else ''}"
    wanted = run.run.scenario.duration if run.run.scenario is not None else None
    if not run.run.completed and wanted is not None:
        reached += f", of {readable(wanted, 's')} requested"
    said = _answered(run) if run.run.completed else f"{run.run.message} ({reached})"
    return Status(run.label, run.run.completed, run.run.outcome.name, said)


def _answered(run: ReportedRun) -> str:
    """Return a run's result in a sentence: hardest blow, pointing, other events."""
    lines = answer(run.run).lines if run.samples > 1 else ()
    told = [line for line in lines if line.about != "energy"] or list(lines)
    hardest = [line for line in told if line.about in run.names("clearance_joint")][:1]
    others = [line for line in told if line.about in _ANSWERS and not line.text.startswith("0 ")]
    chosen = [*hardest, *others][:_MOST] or told[:1]
    text = ". ".join(f"{line.about[:1].upper()}{line.about[1:]}: {line.text}" for line in chosen)
    return text or f"{run.run.message} ({readable(run.end, 's')})"


def warnings(runs: Sequence[ReportedRun]) -> list[str]:
    """Return the warnings on the runs, one sentence each."""
    said: dict[str, list[str]] = {}
    for run in runs:
        for text in _warnings(run):
            said.setdefault(text, []).append(run.label)
    return [f"{', '.join(labels)}: {text}" for text, labels in said.items()] + list(_differences(runs))


def _warnings(run: ReportedRun) -> Iterator[str]:
    data = run.data
    if run.samples < 2:
        yield "one sample only, so nothing is drawn or analysed over time."
    for key, what in (
        ("energy_error_relative", "the energy balance is off by"),
        ("linear_momentum_drift_relative", "linear momentum drifts by"),
        ("angular_momentum_drift_relative", "angular momentum drifts by"),
    ):
        value = run.conserved.get(key)
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
    for said in json.loads(data.attrs["mechanism"]).get("impossible_inertia", ()):
        yield f"no body has the inertia of {said}; it was used unchanged."
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
        yield "The runs come from different versions of antenna_pin; see Provenance."
    scenarios = {run.run.scenario.name for run in runs if run.run.scenario is not None}
    if len(scenarios) > 1:
        yield f"The runs are of different scenarios: {', '.join(sorted(scenarios))}."


# --- conservation ---


def conservation(runs: Sequence[ReportedRun], pictures: Sequence[Picture] = ()) -> Section:
    """Return the errors of conserved quantities of each run."""
    rows = [
        row_of(of, [run.conserved.get(of.name) for run in runs])
        for of in RUN.values()
        if of.source == "conservation"
    ]
    if any(run.names("contact") for run in runs):
        gaps = [float(run.data.attrs["gap_difference"]) if run.names("contact") else None for run in runs]
        rows.append(row_of(RUN["gap_difference"], gaps))
    table = run_table(runs, rows, "Errors and drifts", "conservation")
    return Section(
        key="conservation",
        title="Energy and momentum",
        items=(
            *pictures,
            Details(title="What must be conserved, and by how much it was not", tables=(table,)),
        ),
        meaning=(
            "Energy balance: what is stored, less that at the start and the drives' work, plus all losses. A "
            "momentum's scale is the largest sum of its magnitudes over the bodies without the base. A dash: "
            "nothing to compare with, or not conserved here (a fixed base, gravity).",
        ),
    )
