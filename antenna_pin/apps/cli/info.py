"""``antenna-pin info`` and ``plot``: summaries and figures of results."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import (
    complain,
    figure_folder,
    figure_formats,
    label_of,
    labels_of,
    load,
    load_result,
    refuse,
    say,
    say_notes,
)
from antenna_pin.apps.cli._export import csv_target, rows_of, say_json, write_csv
from antenna_pin.apps.cli._options import argument, flag, option, several
from antenna_pin.apps.cli._tables import Zeros, flat, print_summaries, print_summary, say_answer, text_of

if TYPE_CHECKING:
    from typing import Literal

    from antenna_pin.scenario import Scenario
    from antenna_pin.trajectory import TableKind, Trajectory


def kinds_of(files: Sequence[Path]) -> dict[Path, TableKind]:
    """Return the kind of each file with a dataset other than a run."""
    from antenna_pin.trajectory import FORMATS, format_of

    kinds = {name: kind for kind, name in FORMATS.items()}
    said = {path: format_of(path) for path in files if path.is_file()}
    return {path: kinds[one] for path, one in said.items() if one in kinds}


def draw_tables(
    kinds: dict[Path, TableKind],
    out: Path,
    suffixes: Sequence[str],
    names: Sequence[str] | None,
    width: Literal["column", "page"],
) -> None:
    """Draw the figures of datasets, each called after its file, and print where they are."""
    from antenna_pin.show.plot import folder_for_figures, save_figure, table_figures
    from antenna_pin.trajectory import open_table

    wanted = [(path, one) for path, kind in kinds.items() for one in table_figures(open_table(path, kind))]
    known = list(dict.fromkeys(one.name for _, one in wanted))
    for name in names or ():
        if name not in known:
            refuse(f"plot: --figure must be one of {', '.join(known)}, got {name}")
    folder = folder_for_figures(out)
    for path, one in wanted:
        if names is None or one.name in names:
            for file in save_figure(one.draw(width=width), folder / f"{path.stem}-{one.name}", suffixes):
                typer.echo(file)


def names_scenario(text: str) -> bool:
    """Return whether an argument is a scenario: a file, a folder, a shipped name."""
    path = Path(text)
    if path.suffix == ".toml" or path.is_dir():
        return True
    if path.suffix or path.exists():
        return False
    from antenna_pin.scenario import list_scenarios

    return text in {one.name for one in list_scenarios()}


def say_scenario(name: str, case: str | None, settings: Sequence[str] | None, as_json: bool) -> None:
    """Print the description of a scenario."""
    scenario = load(name, case, settings)

    from antenna_pin.scenario.assemble import scenario_facts

    facts = scenario_facts(scenario)
    if as_json:
        typer.echo(json.dumps({"scenario": scenario.name, "case": scenario.case or "", **facts}))
        return
    case_name = f", case {scenario.case}" if scenario.case else ""
    say(f"{scenario.name}{case_name}: {scenario.title}".rstrip(": "))
    for line in (*_lines(facts, scenario), *_of_file(facts)):
        say(f"  {line}")


def _lines(facts: dict[str, Any], scenario: Scenario) -> Iterator[str]:
    from antenna_pin.analysis import said_of_constraints, said_of_coupling, said_of_moving

    counts = facts["constraints"]
    joints = facts["joints"]
    moving, freedoms = _many(len(joints), "moving joint"), counts["freedoms"]
    yield f"{facts['base']} base, {moving}, {_many(freedoms, 'freedom')}"
    yield from _by_kind("joint", joints)
    closures = {
        name: f"{one['kind']}, {_many(one['equations'], 'equation')}"
        for name, one in facts["closures"].items()
    }
    yield from _by_kind("closure", closures, lambda name: _links(name, facts["closures"][name]))
    for coupling, one in facts["couplings"].items():
        yield f"coupling {coupling}: {said_of_coupling(one)}"
    # A drive's text ends in its joint, which mostly is called like it.
    alike = {name: text.removesuffix(f", at {name}") for name, text in facts["drives"].items()}
    shared = [text for text in set(alike.values()) if list(alike.values()).count(text) > 1]
    yield from _by_kind(
        "drive",
        {name: alike[name] if alike[name] in shared else text for name, text in facts["drives"].items()},
    )
    yield from _elements(scenario)
    yield said_of_constraints(counts)
    if facts["closures"] or facts["couplings"] or counts["motions"]:
        gap, turn = facts["residuals"]
        yield f"the start is closed to {gap:.2g} m and {turn:.2g} rad"
        slides = [joint for joint, text in joints.items() if text == "prismatic"]
        found = (
            f"{joint} {value:.6g} m" if joint in slides else f"{joint} {math.degrees(value):.6g} deg"
            for joint, value in facts["start"].items()
        )
        yield f"the start found: {', '.join(found) or 'no hinges or slides'}"
        if facts["moved"]:
            far = (f"{joint} by {_way(one)}" for joint, one in facts["moved"].items())
            yield f"moved far from where the search began: {', '.join(far)}"
        if moving := said_of_moving(counts, scenario):
            yield moving


def _by_kind(
    noun: str, kinds: Mapping[str, str], label: Callable[[str], str] = str, nouns: str = ""
) -> Iterator[str]:
    """Yield a line for each kind of thing, with the names of those of it."""
    names: dict[str, list[str]] = {}
    for name, kind in kinds.items():
        names.setdefault(kind, []).append(name)
    for kind, mine in names.items():
        if len(mine) == 1:
            yield f"{noun} {label(mine[0])}: {kind}"
        else:
            each = " each" * ("equation" in kind)
            yield f"{len(mine)} {nouns or noun + 's'} {', '.join(map(label, mine))}: {kind}{each}"


def _links(name: str, closure: Mapping[str, Any]) -> str:
    """Return a closure's name with what it joins."""
    turned = "; the axes point opposite ways, and the second is taken the other way" * closure["turned"]
    return f"{name} ({' - '.join(closure['links'])}{turned})"


def _way(far: Mapping[str, float]) -> str:
    parts = [f"{math.degrees(far['turn']):.4g} deg"] * (far["turn"] > 0.0)
    return " and ".join([*parts, *[f"{far['shift']:.4g} m"] * (far["shift"] > 0.0)])


# Tables of a scenario whose entries are told by their kind: of one, of several.
_TABLES = {
    "springs": "spring",
    "stops": "stop",
    "latches": "latch",
    "gears": "gear",
    "bearings": "bearing",
    "forces": "force",
    "flexible": "flexible link",
    "controllers": "controller",
    "events": "event",
}


def _elements(scenario: Scenario) -> Iterator[str]:
    """Yield the elements of a scenario by table and kind."""
    for table, noun in _TABLES.items():
        kinds = {name: str(one.kind) for name, one in (getattr(scenario, table, None) or {}).items()}
        yield from _by_kind(noun, kinds, nouns=table.replace("flexible", "flexible links"))
    for name, link in scenario.flexible.items():
        if reading := getattr(link, "reading", ""):
            yield f"flexible.{name}: {_many(len(link.frequency), 'mode')} of {link.file}, read from {reading}"


def _of_file(facts: dict[str, Any]) -> Iterator[str]:
    from antenna_pin.mechanism import PassedOver

    for what, lines in facts["passed_over"].items():
        yield f"passed over in the URDF: {PassedOver(what, tuple(lines)).text()}"
    if facts["unbounded"]:
        yield f"without bounds in the URDF: {', '.join(facts['unbounded'])}"
    if facts["points"]:
        yield f"point masses, without moments of inertia in the URDF: {', '.join(facts['points'])}"
    if facts["unlimited"]:
        yield f"continuous, whatever bounds the URDF states: {', '.join(facts['unlimited'])}"
    for line in facts["impossible"]:
        yield f"inertia that no body has: {line}"


def _many(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _show_versions(wanted: bool) -> None:
    """Print the versions of the libraries, and whether the shim is used."""
    if wanted:
        from antenna_pin.compiled.native import native_state
        from antenna_pin.trajectory import library_versions

        for name, one in library_versions().items():
            say(f"{name:<12} {one}")
        say(f"{'native shim':<12} {native_state()}")
        raise typer.Exit


def info(
    files: Annotated[list[str], argument("Result files of runs, or one scenario.", "FILES...")],
    case: options.Case = None,
    settings: options.Set = None,
    everything: Annotated[
        bool, flag("--all", "All numbers, by kind of thing; of several results side by side.")
    ] = False,
    as_json: Annotated[bool, flag("--json", "Print one JSON object per file, each on one line.")] = False,
    csv: options.Csv = None,
    quantities: Annotated[
        list[str] | None, several("A number by a function of a run.", "FILE.py:NAME", "--quantity")
    ] = None,
    versions: Annotated[
        bool,
        option(
            "Print the versions of the libraries, and whether their machine code is called directly.",
            None,
            "--versions",
            callback=_show_versions,
            is_eager=True,
        ),
    ] = False,
) -> None:
    """Summarise results: outcome, main numbers, conservation; or describe a scenario.

    A scenario with closed loops is closed, and its freedoms are counted. A CSV file has a row for each
    result.
    """
    target = csv_target(csv)

    if any(map(names_scenario, files)):
        if len(files) > 1:
            refuse(f"{' '.join(files)}: give result files (NAME.nc), any number, or one scenario alone")
        for name, of_results in (("--all", everything), ("--csv", csv), ("--quantity", quantities)):
            if of_results:
                refuse(f"{name}: is for results only, and {files[0]} is a scenario; leave it out")
        say_scenario(files[0], case, settings, as_json)
        return
    for name, given in (("--case", case), ("--set", settings)):
        if given:
            refuse(f"{name}: is for scenarios only, and {files[0]} is a result; leave it out")
    runs = [(path, load_result(path, scenario=False)) for path in map(Path, files)]
    from antenna_pin.analysis import own_numbers

    own = [own_numbers(run, quantities) for _, run in runs] if quantities else [[] for _ in runs]
    if everything or as_json or target is not None:
        facts = [_facts(trajectory) for _, trajectory in runs]
    if target is not None:
        flats = [
            {"file": str(path), **flat(each), **{one.heading: one.value for one in mine}}
            for (path, _), each, mine in zip(runs, facts, own, strict=True)
        ]
        write_csv(target, *rows_of(flats), silent=as_json)
    if as_json:
        for (path, _), each, mine in zip(runs, facts, own, strict=True):
            more = {"quantities": {one.name: one.value for one in mine}} if mine else {}
            say_json({"file": str(path), **each, **more})
    if as_json or target is not None:
        return
    labels = labels_of([path for path, _ in runs])
    if everything:
        zeros = Zeros(trajectory for _, trajectory in runs)
        if len(runs) == 1:
            print_summary(labels[0], facts[0], zeros)
        else:
            print_summaries(list(zip(labels, facts, strict=True)), zeros)
        zeros.say()
    for label, (_, trajectory), mine in zip(labels, runs, own, strict=True):
        if not everything:
            say_answer(trajectory, label if len(runs) > 1 else "")
        for one in mine:
            say(f"{label}: {one.heading} {text_of(one.value)}")
        _say_notes(label, trajectory, everything)


def _say_notes(label: str, trajectory: Trajectory, everything: bool) -> None:
    """Print the notes of a run."""
    if trajectory.outcome.name != "COMPLETED":
        say(f"{label}: {trajectory.message}")
    elif trajectory.advice:
        say(f"{label}: the run was {trajectory.advice}")
    for line in trajectory.assumed:
        say(f"{label}: {line}")
    say_notes(trajectory, f"{label}: ")
    if counts := trajectory.constraints:
        from antenna_pin.analysis import said_of_constraints, said_of_singular

        if everything:
            say(f"{label}: {said_of_constraints(counts)}")
        if singular := said_of_singular(counts):
            say(f"{label}: {singular}")


def _facts(trajectory: Trajectory) -> dict[str, Any]:
    """Return a run's summary with the time shares of each joint's contact scenarios.

    A lean result does not hold the shares.
    """
    from antenna_pin.analysis import scenario_shares
    from antenna_pin.trajectory import contacts_of, is_lean

    if is_lean(trajectory.data):
        return trajectory.summary()
    shares = scenario_shares(trajectory)
    many = {
        joint
        for joint in map(str, shares["clearance_joint"].values)
        if len(contacts_of(trajectory.data, joint)) > 1
        and not contacts_of(trajectory.data, joint, flanges=True)
    }
    found = {
        str(joint): {
            _pair(str(radial), str(axial), joint in many): float(share)
            for radial, row in zip(shares["radial"].values, table, strict=True)
            for axial, share in zip(shares["axial"].values, row, strict=True)
            if share > 0.0
        }
        for joint, table in zip(shares["clearance_joint"].values, shares.values, strict=True)
    }
    return trajectory.summary() | ({"share of time": found} if found else {})


def _pair(radial: str, axial: str, many: bool) -> str:
    """Return a pair of scenarios in words; for many contacts only whether any touches."""
    if many:
        return "no contact" if radial == "none" else "contact"
    return f"radial {radial}, axial {axial}".replace("_", " ")


def plot(
    files: options.Results,
    out: Annotated[Path, option("Folder for the figures; created if missing.", "DIR")],
    formats: options.FigureFormats = "png",
    joint: Annotated[
        str | None, option("The one joint to draw; every joint with clearance if left out.")
    ] = None,
    names: Annotated[
        list[str] | None, several("Figure to draw, instead of the standard ones.", "NAME", "--figure")
    ] = None,
    width: options.FigureWidth = options.Width.PAGE,
) -> None:
    """Draw the figures of results: runs, fits, orbits, diagrams and other datasets."""
    suffixes = figure_formats(formats)
    figure_folder(out)
    tables = kinds_of(files)
    if tables:
        others = [str(path) for path in files if path not in tables]
        if others:
            refuse(f"plot: {others[0]} must be drawn apart from datasets that are no runs")
        if joint is not None:
            refuse(f"plot: --joint must be left out: {files[0]} is no run")
        draw_tables(tables, out, suffixes, names, width.value)
        return
    runs = [(path, load_result(path)) for path in files]
    from antenna_pin.show.plot import check_one_mechanism, processes_to_draw, save_figures

    check_one_mechanism([(str(path), run) for path, run in runs])
    labels = [label_of(trajectory, path) for path, trajectory in runs]
    if len(set(labels)) < len(labels):  # the same case twice: the files tell them apart
        labels = [path.stem for path, _ in runs]

    pairs = [(label, trajectory) for label, (_, trajectory) in zip(labels, runs, strict=True)]

    def left_out(name: str, reason: str) -> None:
        complain(f"{name} is not drawn: {reason}")

    files = save_figures(
        pairs,
        out,
        suffixes,
        joint=joint,
        names=names,
        width=width.value,
        on_left_out=left_out,
        processes=processes_to_draw(),
    )
    for figure in files:
        typer.echo(figure)
