#!/usr/bin/env python3
"""Random scenarios at default settings: do they keep their ledgers, and do they end with a word?

``scenario_generator.py`` says what is random. Every scenario is known by the seed and its number, and is run
in a process apart, so that one that hangs or dies is listed like any other failure::

    scripts/check/random_scenarios.py --count 200             # all
    scripts/check/random_scenarios.py --seed 1 --only 37      # one again
    scripts/check/random_scenarios.py --count 500 --engines   # with both engines, which must agree
    scripts/check/random_scenarios.py --count 200 --elements  # with stops, latches, gears, ... as well

What must hold, of runs that end early as well:

- Momentum, where it is conserved (free base, no gravity): linear and angular drift at most 1e-9 of the run's
  own scale, the largest sum of the magnitudes of the momenta of the bodies other than the base. Both are the
  result's (``Trajectory.summary()["conservation"]``).
- Energy: the ledger's error at most 1e-5 of what the run had to spend. That is the gross work of the drives,
  plus what was stored in springs and contacts at the start, plus the kinetic energy at the start without that
  of the mass centre of a free base, plus what gravity gave or took (the span of its potential). Gross work
  alone would do for an antenna that starts at rest, but many of these scenarios have hardly any drive: they
  live from their initial motion, their springs or their weight, and a share of next to nothing says nothing.
- It ends ``COMPLETED``, or early with an outcome whose message says why and where, or is refused with an
  error of the package. An exception of another kind, a warning, a number in the result that is not finite
  (but for the release of contacts that still touch), a process that dies, or a run that takes more than
  ``--seconds`` of a processor counts as a failure.
- Of all runs together at least 90 % are completed and had contacts.
- With ``--engines`` the compiled engine makes the run, and the other one makes it again: both end alike, keep
  their ledgers, and are in the same place after a tenth of the time, to 1e-6; what impacts make of round-off
  is more, later.

Exit code 1 on any failure.
"""

from __future__ import annotations

import argparse
import csv
import dataclasses
import functools
import itertools
import math
import sys
import time
import traceback
import warnings
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from robust.trials import tried
from scenario_elements import with_elements
from scenario_generator import draw_scenario

from antenna_pin import AntennaPinError, Scenario, Trajectory, simulate
from antenna_pin.errors import LongRunWarning, StiffRunWarning

MOMENTUM = 1e-9
ENERGY = 1e-5
COMPLETED = 0.9  # least share of runs completed with contacts
SECONDS = 120.0  # [s]; coal under distributed load takes most, about half a millisecond an evaluation

AGREE, PART = 1e-6, 0.1  # how near engines come, after which part of a run

# Of a contact that still touches; of a change of what is no latch; of what a controller does not have yet.
_MAY_BE_NAN = ("release_time", "change_energy", "change_peak_effort", "change_peak_time", "tick_signal")


@dataclass(slots=True)
class Row:
    """What became of one scenario."""

    number: int  # its number
    # Name of the outcome; REFUSED where the package raised an error, FAILED where there is none.
    outcome: str = "FAILED"
    message: str = ""  # what it says
    linear: float = math.nan  # drift of linear momentum over its scale; NaN where it is not conserved [-]
    angular: float = math.nan  # the same of angular momentum [-]
    energy: float = math.nan  # error of the energy's ledger over what there was to spend [-]
    energy_error: float = math.nan  # the same [J]
    gross_work: float = math.nan  # of the drives [J]
    to_spend: float = math.nan  # gross work and what was stored at the start or given by gravity [J]
    episodes: int = 0  # of contact
    steps: int = 0  # accepted
    evaluations: int = 0  # of the equations of motion
    gap_difference: float = math.nan  # coal's gaps less those in closed form, the largest [m]
    # How far apart the engines are after a part of the run, over what has moved [-].
    engines: float = math.nan
    wall: float = math.nan  # time of the run [s]
    # What it is an example of: names by kind, such as ``law`` or ``load``.
    classes: dict[str, tuple[str, ...]] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)  # what is wrong

    @property
    def momentum(self) -> float:
        """The larger drift of momentum; NaN where it is not conserved [-]."""
        return self.linear if math.isnan(self.angular) else float(np.fmax(self.linear, self.angular))


# --- one scenario ------------------------------------------------------------------------------------------


def run_number(seed: int, number: int, engines: bool = False, elements: bool = False) -> Row:
    """Make and run one scenario; return what became of it, whatever that is."""
    row = Row(number)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            scenario = draw_scenario(seed, number)
            if elements:
                scenario = with_elements(scenario, seed, number)
            row.classes = classes_of(scenario)
            if engines:
                _run_with_both(row, scenario)
            else:
                _run(row, scenario)
        except Exception as error:  # whatever it is, it is what is looked for
            where = traceback.extract_tb(error.__traceback__)[-1]
            text = f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})"
            row.failures.append(text)
    # That a run is stiff, or long, is said to be helpful; it goes on.
    found = [one for one in said if not issubclass(one.category, StiffRunWarning | LongRunWarning)]
    texts = {f"warning {one.category.__name__}: {one.message}" for one in found}
    row.failures += sorted(texts)
    return row


def _run(row: Row, scenario: Scenario) -> Trajectory | None:
    """Run a scenario and write what became of it into its row; return the run, or None if it was refused."""
    began = time.perf_counter()
    try:
        run = simulate(scenario)
    except AntennaPinError as error:
        row.outcome, row.message = "REFUSED", str(error)
        return None
    row.wall = time.perf_counter() - began
    _judge(row, scenario, run)
    return run


def _run_with_both(row: Row, scenario: Scenario) -> None:
    """Run a scenario with both engines, and write into its row where they do not agree."""
    closed = {f"clearance.{name}.geometry": "closed-form" for name in scenario.clearance}
    other = Row(row.number)
    runs = [
        _run(each, scenario.with_overrides({**closed, "integrator.engine": engine}))
        for each, engine in ((row, "compiled"), (other, "pinocchio"))
    ]
    row.failures += [f"by pinocchio: {text}" for text in other.failures]
    if row.outcome != other.outcome:
        row.failures.append(f"compiled ended {row.outcome}, pinocchio {other.outcome}: {other.message}")
    if None in runs:
        return
    ours, theirs = (run.data.q.interp(time=PART * scenario.duration).values for run in runs if run)
    row.engines = float(np.abs(ours - theirs).max() / max(1.0, np.abs(theirs).max()))
    if not row.engines <= AGREE:
        row.failures.append(f"engines are {row.engines:.3g} apart after {PART:g} of the run, limit {AGREE:g}")


def _judge(row: Row, scenario: Scenario, run: Trajectory) -> None:
    """Write a run's numbers into its row, and what is wrong with them."""
    summary = run.summary()
    kept = summary["conservation"]
    row.outcome, row.message = run.outcome.name, run.message
    row.episodes = int(run.data.sizes["episode"])
    row.steps, row.evaluations = run.counts.accepted, run.counts.evaluations
    row.gap_difference = summary["gap_difference"]
    row.energy_error, row.gross_work = kept["energy_error"], kept["gross_work"]
    row.to_spend = energy_to_spend(scenario, run)
    row.energy = row.energy_error / row.to_spend if row.to_spend > 0.0 else math.inf
    for name in ("linear", "angular"):
        drift = kept[f"{name}_momentum_drift_relative"]
        setattr(row, name, math.nan if drift is None else drift)
        if drift is not None and not drift <= MOMENTUM:
            row.failures.append(f"{name} momentum drifts by {drift:.3g} of its scale, limit {MOMENTUM:g}")
    if not row.energy <= ENERGY:
        share = f"{row.energy:.3g} of {row.to_spend:.3g} J"
        row.failures.append(f"energy error {row.energy_error:.3g} J is {share}, limit {ENERGY:g}")
    if names := not_finite(run):
        row.failures.append(f"not finite: {', '.join(names)}")
    if row.outcome == "INTERRUPTED" or not row.message:
        row.failures.append(f"ended with {row.outcome} and message {row.message!r}")


def energy_to_spend(scenario: Scenario, run: Trajectory) -> float:
    """Return the gross work of the drives and the energy at the start or given by gravity [J].

    Of the kinetic energy of a free base the mass centre's is left out: it is spent on nothing, and depends on
    who looks.
    """
    data = run.data
    stored = sum(float(data[f"{name}_energy"][0]) for name in ("kinetic", "contact", "spring"))
    if "element_energy" in data:
        stored += float(data["element_energy"][0].sum())
    if scenario.mechanism.base == "free":
        masses = ElementTree.fromstring(scenario.urdf_text).iter("mass")
        momentum = data["linear_momentum"].values[0]
        stored -= 0.5 * float(momentum @ momentum) / sum(float(mass.get("value", "nan")) for mass in masses)
    fallen = float(np.ptp(data["gravity_energy"].values))
    return float(run.summary()["conservation"]["gross_work"]) + max(stored, 0.0) + fallen


def not_finite(run: Trajectory) -> list[str]:
    """Return the names of a result's variables that hold a number that is not finite but must be."""
    return [
        str(name)
        for name, variable in run.data.variables.items()
        if variable.dtype.kind == "f" and name not in _MAY_BE_NAN and not np.isfinite(variable.values).all()
    ]


def classes_of(scenario: Scenario) -> dict[str, tuple[str, ...]]:
    """Return what a scenario is an example of: names by kind."""
    joints = [one for one in scenario.clearance.values() if one.model != "ideal"]
    found: dict[str, Iterable[str]] = {
        "base": [scenario.mechanism.base],
        "gravity": ["yes" if any(scenario.mechanism.gravity) else "no"],
        "links": [str(scenario.urdf_text.count("<link "))],
        "joints with play": [str(len(joints))],
        "joint": [one.model for one in joints],
        "load": [f"{one.model} {one.load}" for one in joints if one.model == "contact"],
        "backend": [one.geometry for one in joints],
        "flanges": ["play" if one.axial_clearance else "no play" for one in joints if one.model == "contact"],
        "drives": [drive.kind for drive in scenario.drives.values()] or ["none"],
        "springs": ["yes" if scenario.springs else "no"],
        "law": [one.normal.law for one in joints if one.normal is not None],
        "dissipation": [one.normal.dissipation or "-" for one in joints if one.normal is not None],
        "friction": [one.friction.law for one in joints],
        "element": [
            f"{table} {one.kind}"
            for table in ("stops", "latches", "frictions", "gears", "couplings", "forces", "shake")
            for one in getattr(scenario, table).values()
        ],
    }
    return {kind: tuple(sorted(set(names))) for kind, names in found.items()}


# --- many, in processes of their own -----------------------------------------------------------------------


def run_numbers(seed: int, numbers: Iterable[int], jobs: int, seconds: float, **how: bool) -> Iterator[Row]:
    """Run numbers in several processes, each at most some seconds; yield rows as they come."""
    act = functools.partial(run_number, seed, **how)
    for number, row, fault, spent in tried(act, list(numbers), seconds, jobs):
        found = Row(number, wall=spent, failures=[fault]) if row is None else row
        found.classes = found.classes or _classes_without_running(seed, number)
        yield found


def _classes_without_running(seed: int, number: int) -> dict[str, tuple[str, ...]]:
    """Return what a scenario is an example of whose process came to no end."""
    try:
        return classes_of(draw_scenario(seed, number))
    except Exception:  # then it could not be drawn, which its row says
        return {}


# --- the report --------------------------------------------------------------------------------------------


def failure_lines(rows: Iterable[Row], seed: int) -> list[str]:
    """Return a line for each thing that is wrong, with what is needed to repeat it."""
    return [
        f"--seed {seed} --only {row.number}: {text}"
        + (f" [{row.message}]" if row.message and row.outcome != "COMPLETED" else "")
        for row in sorted(rows, key=lambda row: row.number)
        for text in row.failures
    ]


def class_table(rows: Iterable[Row]) -> list[str]:
    """Return a line for each class: runs, episodes, largest drift and energy error with their numbers."""
    groups: dict[tuple[str, str], list[Row]] = defaultdict(list)
    for row in rows:
        for kind, names in row.classes.items():
            for name in names:
                groups[kind, name].append(row)
    head = f"{'':<40} {'runs':>5} {'early':>5} {'episodes':>8}  {'momentum':>9} {'number':>6}"
    lines = [head + f"  {'energy':>9} {'number':>6}  {'wall [s]':>8} {'number':>6}"]
    kinds = list(dict.fromkeys(kind for kind, _ in groups))
    for kind in kinds:
        for name in sorted((name for one, name in groups if one == kind)):
            mine = groups[kind, name]
            early = sum(row.outcome != "COMPLETED" for row in mine)
            line = f"{f'{kind}: {name}':<40} {len(mine):>5} {early:>5} {sum(r.episodes for r in mine):>8}"
            for quantity in ("momentum", "energy", "wall"):
                known = [row for row in mine if not math.isnan(getattr(row, quantity))]
                if known:
                    worst = max(known, key=lambda row: getattr(row, quantity))
                    value, wide = getattr(worst, quantity), 8 if quantity == "wall" else 9
                    line += f"  {value:>{wide}.2g} {worst.number:>6}"
                else:
                    line += f"  {'-':>{8 if quantity == 'wall' else 9}} {'':>6}"
            lines.append(line)
    return lines


def summary_lines(rows: list[Row]) -> list[str]:
    """Return how the runs ended, how the ledgers lie, and where time went."""
    lines = [f"{name}: {count}" for name, count in Counter(row.outcome for row in rows).most_common()]
    for row in rows:
        if row.outcome not in ("COMPLETED", "FAILED"):
            lines.append(f"  {row.number}: {row.message}")
    met = sum(completed_with_contacts(row) for row in rows)
    lines.append(f"completed with contacts: {met} of {len(rows)}")
    limits = {"momentum": MOMENTUM, "energy": ENERGY, "engines": AGREE}
    limits |= dict.fromkeys(("gap_difference", "wall", "episodes"))
    for quantity, limit in limits.items():
        values = np.array([getattr(row, quantity) for row in rows], dtype=float)
        values = values[np.isfinite(values)]
        if values.size:
            quartiles = np.quantile(values, [0.5, 0.9, 1.0])
            text = f"{quantity}: median {quartiles[0]:.2g}, nine in ten below {quartiles[1]:.2g}, "
            lines.append(text + f"largest {quartiles[2]:.2g}" + (f" (limit {limit:g})" if limit else ""))
    return lines


def completed_with_contacts(row: Row) -> bool:
    """Whether a run came to its end and had contacts."""
    return row.outcome == "COMPLETED" and row.episodes > 0


def save(rows: Iterable[Row], seed: int, path: Path) -> None:
    """Write a row for each scenario."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        names = [item.name for item in dataclasses.fields(Row) if item.name not in ("classes", "failures")]
        kinds = list(dict.fromkeys(itertools.chain.from_iterable(row.classes for row in rows)))
        writer.writerow(["seed", *names, *kinds, "failures"])
        for row in rows:
            classes = [" ".join(row.classes.get(kind, ())) for kind in kinds]
            numbers = [getattr(row, name) for name in names]
            writer.writerow([seed, *numbers, *classes, "; ".join(row.failures)])


def main() -> int:
    """Run the scenarios and report."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add = parser.add_argument
    add("--seed", type=int, default=2024, help="of all that is random (%(default)s)")
    add("--count", type=int, default=200, help="how many scenarios (%(default)s)")
    add("--first", type=int, default=0, metavar="K", help="number of the first (%(default)s)")
    add("--only", type=int, metavar="K", help="run this number alone")
    add("--jobs", type=int, default=2, help="processes (%(default)s)")
    add("--seconds", type=float, default=SECONDS, help="of a processor that a run may take (%(default)s)")
    add("--engines", action="store_true", help="have both engines make each run")
    add("--elements", action="store_true", help="give joints what they may have besides play")
    add("--brief", action="store_true", help="without the table of classes")
    add("--save", type=Path, metavar="FILE.csv", help="write a row for each scenario")
    given = parser.parse_args()
    if given.count < 1 or given.jobs < 1 or given.first < 0:
        parser.error("--count and --jobs must be 1 or more, --first 0 or more")
    numbers = range(given.first, given.first + given.count) if given.only is None else [given.only]
    _compile()
    rows = []
    how = {"engines": given.engines, "elements": given.elements}
    for row in run_numbers(given.seed, numbers, min(given.jobs, len(numbers)), given.seconds, **how):
        rows.append(row)
        for line in failure_lines([row], given.seed):
            print(f"FAILED {line}", flush=True)
    rows.sort(key=lambda row: row.number)
    if given.save is not None:
        save(rows, given.seed, given.save)
    failures = failure_lines(rows, given.seed)
    table = [] if given.brief else ["", *class_table(rows), ""]
    print("\n".join([*table, *summary_lines(rows), ""]))
    share = sum(completed_with_contacts(row) for row in rows) / len(rows)
    if given.only is None and share < COMPLETED:
        failures.append(f"only {100 * share:.3g} % were completed with contacts, least {100 * COMPLETED:g} %")
    print("\n".join([f"{len(failures)} failures", *failures]) if failures else "no failures")
    return 1 if failures else 0


def _compile() -> None:
    """Have the kernels compiled and cached, so that no scenario's time is taken by that."""
    from antenna_pin import load_scenario

    simulate(load_scenario("bai2020"), duration=0.005)


if __name__ == "__main__":
    sys.exit(main())
