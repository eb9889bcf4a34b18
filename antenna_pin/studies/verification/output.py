"""Files of a verification: JSON, CSV, nominal run, worst cases as scenarios."""

from __future__ import annotations

import io
import json
import math
import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import replacing
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.base.readable import number, printed_unit, readable
from antenna_pin.base.tables import write_csv
from antenna_pin.base.units import any_quantity
from antenna_pin.errors import AntennaPinError
from antenna_pin.run.simulation import simulate
from antenna_pin.scenario import Scenario, found_from, scenario_toml
from antenna_pin.scenario.requirements import RequirementSpec
from antenna_pin.studies.verification.plan import UncertainNumber
from antenna_pin.studies.verification.quantity import ANALYSES
from antenna_pin.studies.verification.verify import Demonstration, Verified
from antenna_pin.trajectory import Trajectory, library_versions

# A number, and what follows it.
_WRITTEN = re.compile(r"([-+]?[0-9_.]*(?:[eE][-+]?[0-9]+)?)\s*(.*)", re.DOTALL)

#: File of the nominal scenario in the folder of the output.
NOMINAL = "nominal.toml"

#: Subjects of a mechanism's verification that no analysis here covers.
NOT_COVERED = (
    "strength and fatigue of the structure, cables and fasteners: no stress but that of contacts",
    "lubrication: its film, outgassing, migration, and loss of lubricant over time",
    "life by test: cycles, torque at the end of life, wear debris",
    "thermal analysis: temperatures are given, not computed",
    "latch capture over temperature, unless a requirement varies it by an uncertain number",
    "materials: corrosion, cold welding, stress corrosion, radiation",
    "electromagnetic effects, electronics, software beyond the sampled control law",
    "manufacture, inspection and test records",
    "the model itself: its correlation with a test is the user's to show (antenna-pin fit)",
)

#: Columns of the matrix as CSV.
_COLUMNS = (
    *("requirement", "text", "clause", "quantity", "of", "units", "at_least", "at_most", "over", "method"),
    *("nominal", "result", "margin", "verdict", "failure_probability", "probability_low", "probability_high"),
    *("confidence", "allowed_probability", "points", "worst_case", "shown_in", "outcome", "energy_error"),
    *("energy_tolerance", "message"),
)


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _uncertain(one: UncertainNumber) -> dict[str, Any]:
    return {
        "name": one.name,
        "key": ", ".join(one.keys),
        "nominal": _number(one.nominal),
        "units": one.unit or "1",
        "low": _number(one.low),
        "high": _number(one.high),
        "limits": list(one.texts),
        "distribution": _distribution(one),
        "note": one.note,
    }


def _distribution(one: UncertainNumber) -> str:
    spec = one.spec
    if spec.values is not None:
        return "list"
    if spec.tolerance is not None:
        return f"{spec.tolerance.distribution} within its tolerance"
    if spec.distribution is not None:
        return str(spec.distribution.get("name"))
    return "even" if spec.spacing == "linear" else "even in its logarithm"


def _parted(value: object) -> tuple[str, str]:
    """Return number and unit of a written quantity, the unit "" of a bare number."""
    digits, unit = _WRITTEN.fullmatch(str(value).strip()).groups()  # type: ignore[union-attr]
    return digits, unit


def _bound(spec: RequirementSpec) -> str:
    """Return the bounds as they are written, their units in print."""
    ends = (("at least", spec.at_least), ("at most", spec.at_most))
    given = [(words, *_parted(value)) for words, value in ends if value is not None]
    return " and ".join(f"{words} {_joined(digits, unit)}" for words, digits, unit in given)


def _joined(digits: str, unit: str) -> str:
    """Return number and unit in print, which no line break parts."""
    return f"{digits} {printed_unit(unit)}".strip().replace(" ", "\N{NO-BREAK SPACE}")


def _unit_of_bound(spec: RequirementSpec) -> dict[str, Any]:
    """Return unit and size in SI units of a written bound, if it has one."""
    for value in (spec.at_most, spec.at_least):
        unit = "" if value is None else _parted(value)[1]
        size = any_quantity(f"1 {unit}") if unit else None
        if size is not None and any_quantity(f"0 {unit}") == (0.0, size[1]):  # no scale with an offset
            return {"unit": unit, "size": size[0]}
    return {}


@takes()
def result_text(requirement: Mapping[str, Any], value: float | None, digits: int = 4) -> str:
    """Return a result, or a margin, as text in the unit of the requirement's bound.

    Args:
        requirement: Of :func:`facts_of`.
        value: In SI units; None gives a dash.
        digits: Significant digits.
    """
    of_bound = requirement.get("bound_unit")
    if value is None or not of_bound or value == 0.0:
        return readable(value, requirement["units"], digits)
    return _joined(number(value / of_bound["size"], digits), of_bound["unit"])


@takes()
def point_text(requirement: Mapping[str, Any]) -> str:
    """Return the worst case of a requirement as text; "" of the nominal one.

    Args:
        requirement: Of :func:`facts_of`.
    """
    return ", ".join(f"{name} {_rounded(value)}" for name, value in requirement["worst_values"].items())


def _rounded(value: str) -> str:
    """Return a written quantity with four digits; other texts unchanged."""
    size, (digits, unit) = any_quantity(value), _parted(value)
    if size is None or any_quantity(f"0 {unit}") not in ((0.0, size[1]), None):
        return value
    if len(size[1]) > len(unit):  # no unit with a name: in base units it would be harder to read
        return _joined(number(float(digits)), unit)
    return readable(size[0], size[1] or "1").replace(" ", "\N{NO-BREAK SPACE}")


def _requirement(verified: Verified, shown: Demonstration) -> dict[str, Any]:
    plan = verified.plan
    spec, quantity = plan.requirements[shown.name], plan.quantities[shown.name]
    chance = shown.probability
    found: dict[str, Any] = {
        "requirement": shown.name,
        "text": spec.text,
        "clause": spec.clause,
        "quantity": quantity.name,
        "meaning": quantity.meaning,
        "analysis": quantity.analysis,
        "of": spec.of or "",
        "units": shown.units,
        "at_least": _number(shown.low),
        "at_most": _number(shown.high),
        "bound": _bound(spec),
        "bound_unit": _unit_of_bound(spec),
        "over": spec.over,
        "method": shown.method,
        "nominal": _number(shown.nominal),
        "result": _number(shown.result),
        "margin": _number(shown.margin),
        "verdict": shown.verdict,
        "points": shown.runs,
        "inside": shown.inside,
        "worst_case": {key: str(value) for key, value in shown.overrides.items()},
        "worst_values": {name: str(value) for name, value in shown.worst.items()},
        "shown_in": f"worst/{shown.name}.toml",
        "integrity": {key: value for key, value in shown.facts.items() if key != "wall_time"},
        "options": {
            key: getattr(spec, key)
            for key in sorted(spec.options)
            if key in ("band", "after", "before", "quality")
        },
        "message": shown.message,
    }
    if chance is not None:
        found["probability"] = {
            **{
                key: _number(value) if isinstance(value, float) else value
                for key, value in asdict(chance).items()
            },
            "allowed": round(1.0 - float(spec.probability or 0.0), 12),
        }
    return found


@takes()
def facts_of(verified: Verified, command: str = "") -> dict[str, Any]:
    """Return all numbers of a verification as JSON types, in SI units.

    Args:
        verified: The result.
        command: Command line that made it.
    """
    plan = verified.plan
    requirements = [_requirement(verified, one) for one in verified.demonstrations.values()]
    effects = [
        {
            "requirement": one.requirement,
            "number": one.number,
            "units": verified.demonstrations[one.requirement].units,
            "nominal": _number(one.nominal),
            "low": _number(one.low),
            "high": _number(one.high),
            "change": _number(one.change),
        }
        for one in verified.effects
    ]
    return {
        "format": "antenna_pin verification 1",
        "name": plan.name,
        "title": plan.title,
        "file": plan.label,
        "scenario": plan.base.name,
        "case": plan.base.case or "",
        "command": command,
        "finished": datetime.now(UTC).isoformat(timespec="seconds"),
        "digest": verified.digest,
        "store": f"points/{verified.digest}",
        "points": verified.points,
        "versions": library_versions(),
        "met": verified.met,
        "requirements": requirements,
        "uncertain": [_uncertain(one) for one in plan.uncertain.values()],
        "effects": effects,
        "budget": list(_budget(verified)),
        "analyses": ANALYSES,
        "not_covered": list(NOT_COVERED),
    }


def _budget(verified: Verified) -> Iterator[dict[str, Any]]:
    """Yield the budget of each requirement: sums of the effects of all uncertain numbers."""
    for name, shown in verified.demonstrations.items():
        changes = {one.number: one.change for one in verified.effects if one.requirement == name}
        known = {number: change for number, change in changes.items() if math.isfinite(change)}
        if not known:
            continue
        largest = max(known, key=lambda number: abs(known[number]))
        yield {
            "requirement": name,
            "units": shown.units,
            "largest": largest if known[largest] else "",
            "largest_change": known[largest],
            "sum": sum(abs(change) for change in known.values()),
            "root_sum_square": math.sqrt(sum(change**2 for change in known.values())),
        }


@takes()
def nominal_run(verified: Verified, folder: Path) -> tuple[Trajectory | None, Path | None]:
    """Return the nominal run and its file; None where nothing needs it.

    Args:
        verified: The result.
        folder: Folder of the output.
    """
    if not any(one.needs_run for one in verified.plan.quantities.values()):
        return None, None
    path = folder / f"nominal-{verified.digest}.nc"
    if path.is_file():
        try:
            return Trajectory.load(path), path
        except AntennaPinError:  # damaged: made anew
            pass
    run = uninterrupted(simulate(verified.plan.base))
    run.save(path)
    return run, path


@takes()
def save_verification(verified: Verified, facts: Mapping[str, Any], folder: Path) -> list[Path]:
    """Write numbers and worst cases; return the paths.

    Args:
        verified: The result.
        facts: All its numbers (:func:`facts_of`).
        folder: Folder of the output.

    Raises:
        OutputError: A file cannot be written.
    """
    worst = folder / "worst"
    worst.mkdir(exist_ok=True)
    paths = [folder / "verification.json", folder / "matrix.csv"]
    with replacing(paths[0]) as partial:
        partial.write_text(
            json.dumps(facts, indent=1, ensure_ascii=False, default=str) + "\n", encoding="utf-8"
        )
    with replacing(paths[1]) as partial:
        partial.write_text(_matrix(facts), encoding="utf-8")
    paths.append(folder / NOMINAL)
    with replacing(paths[-1]) as partial:
        head = f"# Nominal scenario of {verified.plan.label}\n\n"
        partial.write_text(
            head + scenario_toml(found_from(verified.plan.base, folder.resolve())), encoding="utf-8"
        )
    for name, shown in verified.demonstrations.items():
        path = worst / f"{name}.toml"
        scenario = verified.plan.base
        if shown.overrides:
            scenario = scenario.with_overrides(shown.overrides)
        with replacing(path) as partial:
            partial.write_text(_worst(verified, name, scenario, worst), encoding="utf-8")
        paths.append(path)
    return paths


@takes()
def save_analyses(
    loops: Sequence[Mapping[str, Any]], curves: Sequence[Mapping[str, Any]], folder: Path
) -> Path:
    """Write the tables of further analyses with their commands; return the path.

    Args:
        loops: Sampled loops (:func:`analyses_of`).
        curves: Tables and curves, likewise.
        folder: Folder of the output.
    """
    kept = ("analysis", "key", "title", "made_by", "head", "rows", "notes")
    tables = [{name: one[name] for name in kept if name in one} for one in curves]
    numbers = [
        {name: value for name, value in one.items() if name not in ("frequency", "response")} for one in loops
    ]
    path = folder / "analyses.json"
    with replacing(path) as partial:
        text = json.dumps({"loops": numbers, "tables": tables}, indent=1, ensure_ascii=False, default=str)
        partial.write_text(text + "\n", encoding="utf-8")
    return path


def _worst(verified: Verified, name: str, scenario: Scenario, folder: Path) -> str:
    shown = verified.demonstrations[name]
    sets = ", ".join(f"{key} = {value}" for key, value in shown.overrides.items()) or "nominal values"
    head = [
        f"# Worst case of requirement {name} of {verified.plan.label}: {' '.join(sets.split())}",
        f"# Run it: antenna-pin run {shlex.quote(f'worst/{name}.toml')} --out {shlex.quote(f'{name}.nc')}",
    ]
    return "\n".join(head) + "\n\n" + scenario_toml(found_from(scenario, folder.resolve()))


def _matrix(facts: Mapping[str, Any]) -> str:
    """Return the verification matrix as CSV text."""
    stream = io.StringIO()
    rows = []
    for one in facts["requirements"]:
        chance, books = one.get("probability", {}), one["integrity"]
        more = {
            "failure_probability": chance.get("probability"),
            "probability_low": chance.get("low"),
            "probability_high": chance.get("high"),
            "confidence": chance.get("confidence"),
            "allowed_probability": chance.get("allowed"),
            "worst_case": "; ".join(f"{key}={value}" for key, value in one["worst_case"].items()),
            "outcome": books.get("outcome"),
            "energy_error": books.get("energy_error"),
            "energy_tolerance": books.get("energy_tolerance"),
        }
        row = one | more
        rows.append([row.get(column) for column in _COLUMNS])
    write_csv(stream, _COLUMNS, rows)
    return stream.getvalue()
