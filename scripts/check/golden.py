#!/usr/bin/env python3
"""A fingerprint of what the package does, made before a change of its structure and compared after it.

    scripts/check/golden.py make before.json               # ten minutes on two cores
    scripts/check/golden.py compare before.json            # makes it again, and says what differs
    scripts/check/golden.py compare before.json --only cases figures
    scripts/check/golden.py compare before.json after.json # two that have been made

Sections:

- ``cases``: every shipped case by both engines, with gaps in closed form by the compiled one. Runs end
  after so many trial steps that each takes about a second.
- ``random``: 200 random scenarios by both engines, every other one with elements besides play.
- ``commands``: what each command that reads results or scenarios prints, as text, JSON and CSV.
- ``figures``: the numbers that every figure draws of the runs of ``commands``.
- ``schemas``: keys, units, rules, defaults of scenarios, studies and fits; variables of a result.
- ``derived``: sensitivities, modes, an orbit, exponents and a fit of a fixed list.

Numbers are compared bit for bit, by a digest of each array; those of ``derived`` to 1e-6. Of an array that
differs the sums of its magnitudes are printed. Exit code 1 if anything does.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import hashlib
import io
import json
import math
import os
import re
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from antenna_pin import Scenario, list_scenarios, load_scenario, simulate
from antenna_pin.errors import AntennaPinError

Entry = dict[str, Any]
Job = tuple[str, str, tuple[Any, ...]]

ENGINES = ("compiled", "pinocchio")
STEPS, RANDOM_STEPS = 600, 150  # trial steps of a run
RANDOM = 200
# What results say of the machine and of libraries, not of the motion.
_MACHINE = "wall created version hash git platform history host checksum finished folder".split()
_TEXT = (
    (r"antenna-pin: note: \w+ is at work.*\n", ""),
    (r"simulated in .*? s(?: \(and .*?\))?,", "simulated in ~,"),
    (r"\d[\d.,]*(e[-+]\d+)? s (each|of wall time)", r"~ s \2"),
    (r"/\S*/golden-\w+/", ""),
    (r"\"(wall_\w+|\w+_wall_time|created|versions?)\": [^,}]+", r'"\1": ~'),
)
#: Runs that commands read and figures draw: name, case, changes.
RUNS: dict[str, tuple[str, str | None, tuple[str, ...]]] = {
    "ideal": ("bai2020", "case1", ("duration=0.15",)),
    "play": ("bai2020", "case3", ("duration=0.15",)),
    "petals": ("bai2020", "petals", ("duration=0.03",)),
    "planar": ("you2010", None, ("duration=0.1",)),
    "parallel": ("chen2021", "friction-010", ("duration=0.02",)),
    "array": ("solar_array", None, ("duration=0.3",)),
    "gear": ("pointing_gear", "play", ("duration=0.3",)),
    "wheel": ("reaction_wheel", "bearings", ("duration=0.01",)),
    "shaker": ("shaker", None, ("duration=0.2",)),
    "crank": ("slider_crank", "planar", ("duration=0.1",)),
}
_EACH = (
    "info", "info --all", "info --json", "info --csv t.csv",
    "analyse", "analyse --json", "analyse --csv t.csv",
)  # fmt: skip

_CONTACT = ("impacts", "impacts --json", "impacts --csv t.csv", "impacts --strongest 3")
_ALONE = (
    "list", "list bai2020", "info bai2020", "info solar_array", "info chen2021 --json",
    "urdf bai2020 --case case3",
    "urdf bai2020 --check", "modes bai2020", "modes solar_array --json", "modes shaker --csv t.csv",
    "pointing play.nc --ideal ideal.nc", "pointing play.nc --ideal ideal.nc --json",
    "phase play.nc --list", "contact laws", "contact --help", "figures --help", "study --help", "fit --help",
)  # fmt: skip


def main() -> int:
    """Make a fingerprint, or compare two."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("task", choices=("make", "compare"))
    parser.add_argument("before", type=Path, metavar="FILE")
    parser.add_argument("after", type=Path, nargs="?", metavar="FILE")
    parser.add_argument("--only", nargs="+", choices=SECTIONS, default=list(SECTIONS), metavar="SECTION")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    asked = parser.parse_args()
    if asked.task == "make":
        made = fingerprint(asked.only, asked.workers)
        asked.before.write_text(json.dumps(made, indent=0, sort_keys=True) + "\n", encoding="utf-8")
        print(f"{sum(map(len, made.values())):,} entries in {asked.before}")
        return 0
    before = json.loads(asked.before.read_text(encoding="utf-8"))
    after = json.loads(asked.after.read_text(encoding="utf-8")) if asked.after else None
    after = fingerprint(asked.only, asked.workers) if after is None else after
    count, differences = 0, 0
    for section in asked.only:
        for line in compared(before[section], after[section]):
            print(f"{section}: {line}")
            differences += 1
        count += len(before[section])
    print(f"{count:,} entries compared, {differences:,} differ")
    return int(differences > 0)


def fingerprint(sections: list[str], workers: int | None) -> dict[str, Entry]:
    """Return the entries of some sections by name; the work of all is shared out to processes."""
    jobs = [(section, *job) for section in sections for job in SECTIONS[section][1]()]
    found: dict[str, Entry] = {section: {} for section in sections}
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for section, entries in pool.map(_done, jobs):
            found[section] |= entries
    return found


def compared(before: Entry, after: Entry) -> Iterator[str]:
    """Yield a line for each entry of a section that is in one only, or that differs."""
    for name in sorted(before.keys() | after.keys()):
        if name not in after or name not in before:
            yield f"{name}: {'only before' if name in before else 'only after'}"
            continue
        old, new = before[name], after[name]
        if isinstance(old, str) or isinstance(new, str):
            if old != new:
                yield f"{name}: {_first_difference(str(old), str(new))}"
        elif "doubt" in old and len(old["value"]) != len(new.get("value", ())):
            yield f"{name}: {len(old['value'])} numbers before, {len(new.get('value', ()))} numbers after"
        elif "doubt" in old:
            values = zip(old["value"], new["value"], old["doubt"], new["doubt"], strict=True)
            if not all(abs(a - b) <= c + d or a == b or a != a != b for a, b, c, d in values):
                yield f"{name}: {old['value']} before, {new['value']} after, uncertain by {old['doubt']}"
        elif old["digest"] != new["digest"]:
            texts = [f"shape {one['shape']}, sum {one['sum']:.17g}" for one in (old, new)]
            yield f"{name}: {texts[0]} before, {texts[1]} after"


def _first_difference(old: str, new: str) -> str:
    lines = old.splitlines(), new.splitlines()
    for a, b in zip(*lines, strict=False):
        if a != b:
            return f"{a!r} before, {b!r} after"
    return f"{len(lines[0])} lines before, {len(lines[1])} after"


def _done(job: Any) -> tuple[str, Entry]:
    section, name, arguments = job
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return section, SECTIONS[section][0](name, *arguments)
        except Exception as error:  # a fingerprint, too
            return section, {name: f"{type(error).__name__}: {error}"}


# --- runs ---


def _array(values: Any) -> Entry:
    """Return the digest of an array, its shape and the sum of its magnitudes."""
    values = np.ascontiguousarray(values)
    total = math.nan
    if values.dtype.kind in "fiu":
        total = float(np.nansum(np.abs(values.astype(float))))
        values = values + np.zeros((), values.dtype)  # minus zero and zero are the same number
    elif values.dtype.kind in "OU":
        values = np.array("\n".join(map(str, values.ravel().tolist())).encode())
    return {
        "digest": hashlib.sha256(values.tobytes()).hexdigest()[:16],
        "shape": list(values.shape),
        "sum": total,
    }


def _run(name: str, scenario: Scenario, engine: str, steps: int) -> Entry:
    """Return a run's variables and what it says of itself."""
    closed = {f"clearance.{joint}.geometry": "closed-form" for joint in scenario.clearance}
    limits = {"integrator.engine": engine, "integrator.max_steps": steps}
    run = simulate(scenario.with_overrides(limits | (closed if engine == "compiled" else {})))
    data = run.data
    found: Entry = {f"{name}/{variable}": _array(data[variable].values) for variable in data.variables}
    for key, value in data.attrs.items():
        if not any(word in key.lower() for word in _MACHINE):
            found[f"{name}@{key}"] = _clean(str(value))
    return found


def _case_jobs() -> Iterator[tuple[str, tuple[Any, ...]]]:
    for model in list_scenarios():
        for case in model.cases:
            for engine in ENGINES:
                yield f"{model.name}/{case.name}/{engine}", (model.name, case.name, engine)


def _case(name: str, model: str, case: str, engine: str) -> Entry:
    return _run(name, load_scenario(model, case), engine, STEPS)


def _random_jobs() -> Iterator[tuple[str, tuple[Any, ...]]]:
    for number in range(RANDOM):
        for engine in ENGINES:
            yield f"{number}/{engine}", (number, engine)


def _random(name: str, number: int, engine: str) -> Entry:
    from scenario_elements import with_elements
    from scenario_generator import draw_scenario

    scenario = draw_scenario(0, number)
    if number % 2:
        scenario = with_elements(scenario, 0, number)
    return _run(name, scenario, engine, RANDOM_STEPS)


# --- what commands print and figures draw ---


def _saved(folder: Path, names: tuple[str, ...] = tuple(RUNS)) -> dict[str, Any]:
    """Return the runs of ``RUNS``, saved in a folder."""
    runs = {}
    for name in names:
        model, case, changes = RUNS[name]
        closed = {f"clearance.{j}.geometry": "closed-form" for j in load_scenario(model, case).clearance}
        scenario = load_scenario(model, case, overrides=list(changes)).with_overrides(
            {**closed, "integrator.engine": "compiled"}
        )
        run = simulate(scenario)
        counts = dataclasses.replace(run.counts, wall_seconds=1.0, compile_seconds=0.0)
        runs[name] = dataclasses.replace(run, counts=counts)
        runs[name].save(folder / f"{name}.nc")
    return runs


def _clean(text: str) -> str:
    for pattern, by in _TEXT:
        text = re.sub(pattern, by, text)
    return text


def _said(words: str, folder: Path) -> str:
    """Return what a command prints and the CSV file that it writes, and its exit code."""
    from antenna_pin.apps._entry import main as command

    out = io.StringIO()
    os.environ["COLUMNS"] = "120"
    before = sys.argv
    sys.argv = ["antenna-pin", *words.split()]
    code: Any = 0
    try:
        with contextlib.chdir(folder), contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            code = command()
    except SystemExit as end:
        code = end.code
    finally:
        sys.argv = before
    table = folder / "t.csv"
    text = f"exit code {code or 0}\n{out.getvalue()}{table.read_text() if table.exists() else ''}"
    table.unlink(missing_ok=True)
    return _clean(text)


def _commands(name: str) -> Entry:
    with tempfile.TemporaryDirectory(prefix="golden-") as path:
        folder = Path(path)
        if name == "alone":
            _saved(folder, ("ideal", "play"))
            return {f"{words}": _said(words, folder) for words in _ALONE}
        (run,) = _saved(folder, (name,)).values()
        contacts = _CONTACT if "contact" in run.data.sizes else ()
        found = {}
        for words in (*_EACH, *contacts):
            command, *options = words.split()
            found[f"{words} of {name}"] = _said(" ".join([command, f"{name}.nc", *options]), folder)
        return found


def _figures(name: str) -> Entry:
    from antenna_pin.show.plot import CATALOGUE, allowed_figures, drawn_numbers

    with tempfile.TemporaryDirectory(prefix="golden-") as path:
        runs = _saved(Path(path), ("ideal", "play") if name == "play" else (name,))
        found: Entry = {}
        for allowed in allowed_figures(list(runs.items()), names=list(CATALOGUE)):
            key = f"{name}/{allowed.figure.name}/{allowed.joint}"
            try:
                figure = allowed.draw(list(runs.items()))
            except AntennaPinError as error:
                found[key] = str(error)
                continue
            for n, drawn in enumerate(drawn_numbers(figure)):
                for m, column in enumerate(drawn.columns):
                    found[f"{key}/{n}.{m} {drawn.panel}: {drawn.label} {drawn.names[m]}"] = _array(column)
        return found


# --- schemas ---


def _schemas(name: str) -> Entry:
    if name == "result":
        from antenna_pin.trajectory.schema import COORDINATES, DIMENSIONS, VARIABLES

        rows = {one.name: one for one in COORDINATES} | VARIABLES
        return {"result/dimensions": json.dumps(DIMENSIONS)} | {
            f"result/{k}": repr(row) for k, row in rows.items()
        }
    sys.path.append(str(Path(__file__).parents[1] / "pages"))
    from scenario_tables import GROUPS, page_of

    lines = [line for group in GROUPS for line in page_of(group).splitlines() if line.strip()]
    return {f"scenario/{n}": line for n, line in enumerate(lines)}


# --- what is derived ---

_DRIVEN = "--set drives.motor={joint='hinge',kind='sine',amplitude=1.0,frequency=0.625}"
DERIVED = {
    "modes": "modes bai2020 --case flexible-ideal --json",
    "sensitivity": "sensitivity impact_pair clearance.bore.radial_clearance "
    "clearance.bore.normal.restitution --method equation --set clearance.bore.geometry=closed-form --json",
    "orbit": f"orbit pendulum --case ideal {_DRIVEN} --json --no-progress",
    "lyapunov": f"lyapunov pendulum --case ideal --interval 0.2 --count 20 {_DRIVEN} --json --no-progress",
    "fit": "fit liu2013/power --no-progress --workers 0",
}


def _within(value: Any, doubt: Any) -> Entry:
    values, doubts = (np.atleast_1d(np.asarray(one, dtype=float)).ravel().tolist() for one in (value, doubt))
    return {"value": values, "doubt": doubts if len(doubts) == len(values) else doubts * len(values)}


def _derived(name: str) -> Entry:
    with tempfile.TemporaryDirectory(prefix="golden-") as path:
        folder = Path(path)
        text = _said(DERIVED[name], folder)
        numbers = [float(one) for one in re.findall(r"-?\d+\.?\d*(?:e[-+]?\d+)?", text)]
        return {
            f"{name}: numbers": _within(numbers, [1e-6 * abs(one) + 1e-12 for one in numbers]),
            f"{name}: words": re.sub(r"-?\d+\.?\d*(?:e[-+]?\d+)?", "~", text),
        }


#: Of each section what makes its entries, and the jobs that it makes them of: names, with arguments.
SECTIONS: Mapping[str, tuple[Callable[..., Entry], Callable[[], Iterable[tuple[str, tuple[Any, ...]]]]]] = {
    "cases": (_case, _case_jobs),
    "random": (_random, _random_jobs),
    "commands": (_commands, lambda: [(name, ()) for name in (*RUNS, "alone")]),
    "figures": (_figures, lambda: [(name, ()) for name in RUNS if name != "ideal"]),
    "schemas": (_schemas, lambda: [(name, ()) for name in ("scenario", "result")]),
    "derived": (_derived, lambda: [(name, ()) for name in DERIVED]),
}


if __name__ == "__main__":
    sys.exit(main())
