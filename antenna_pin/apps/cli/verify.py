"""``antenna-pin verify``: requirements, the runs that show them, and one report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import complain, executor_of, not_interrupted, say
from antenna_pin.apps.cli._export import csv_target, say_json, write_csv
from antenna_pin.apps.cli._options import argument, option
from antenna_pin.apps.cli._progress import verification_bar
from antenna_pin.apps.cli._tables import print_rows
from antenna_pin.apps.cli._usage import command_of

if TYPE_CHECKING:
    from antenna_pin.studies.verification import Verification, Verified

#: Exit code of a verification with a requirement that is not shown to be met.
SHORT = 1


def verify(
    context: typer.Context,
    file: Annotated[
        str | None,
        argument(
            "Requirements file, scenario with requirements, or name of a shipped one; lists those if"
            " left out.",
            "[FILE]",
        ),
    ] = None,
    output: Annotated[
        Path | None, option("Folder of report, numbers and runs; NAME.verification if left out.", "DIR")
    ] = None,
    workers: options.Workers = None,
    settings: Annotated[list[str] | None, options.settings_of("the file", "'set.duration=0.5 s'")] = None,
    figures: Annotated[bool, option("Draw figures.")] = True,
    report: Annotated[bool, option("Write the report.")] = True,
    as_json: options.Json = False,
    csv: Annotated[
        Path | None, option("Write the verification matrix to a CSV file, too.", "FILE", "--csv")
    ] = None,
    progress: options.Progress = True,
    quiet: options.Quiet = False,
) -> None:
    """Verify requirements: make the missing runs, and write one report.

    Exit code 1 if a requirement is not shown to be met. The same command continues an interrupted one.
    """
    from antenna_pin.studies.verification import (
        facts_of,
        list_verifications,
        load_verification,
        save_verification,
    )
    from antenna_pin.studies.verification import verify as make

    if file is None:
        for name in list_verifications():
            say(f"{name}: {load_verification(name).title}")
        return
    target = csv_target(csv)
    plan = load_verification(file, settings or ())
    folder = output or Path(f"{plan.name}.verification")
    executor = executor_of(workers)
    try:
        with verification_bar(plan.name, progress and not quiet) as tell:
            result = make(plan, folder, executor=executor, progress=tell)
    finally:
        executor.close()
    facts = facts_of(result, command_of(context))
    with not_interrupted():
        save_verification(result, facts, folder)
        if target is not None:
            head, rows = _rows(facts)
            write_csv(target, head, rows, silent=as_json or quiet)
    if report:
        _report(plan, result, facts, folder, figures)
    if as_json:
        say_json(facts)
    elif not quiet:
        _print(facts)
        if report:
            say(f"saved {folder / 'report.html'}")
    if not result.met:
        raise typer.Exit(SHORT)


def _report(
    plan: Verification, result: Verified, facts: Mapping[str, Any], folder: Path, figures: bool
) -> None:
    from antenna_pin.show.plot import processes_to_draw
    from antenna_pin.show.report import verification_report
    from antenna_pin.studies.verification import analyses_of, nominal_run, save_analyses

    run, path = nominal_run(result, folder)
    loops, curves = analyses_of(result, run, complain)
    save_analyses(loops, curves, folder)
    made = verification_report(
        facts,
        nominal=run,
        file=path,
        loops=loops,
        curves=curves,
        figures=figures,
        processes=processes_to_draw(),
    )
    made.save(folder / "report.html")


def _rows(facts: Mapping[str, Any]) -> tuple[list[str], Iterator[list[Any]]]:
    names = "requirement quantity of units at_least at_most nominal result margin verdict".split()
    return names, ([one[name] for name in names] for one in facts["requirements"])


def _print(facts: Mapping[str, Any]) -> None:
    from antenna_pin.studies.verification import point_text, result_text

    rows = []
    for one in facts["requirements"]:
        bounds = [one["bound"]]
        chance = one.get("probability")
        result, margin = result_text(one, one["result"]), result_text(one, one["margin"], 3)
        if chance:
            result = f"fails {chance['low']:.2g} to {chance['high']:.2g}"
            margin = f"{one['margin']:.3g}"
            bounds.append(f"probability {1.0 - chance['allowed']:.6g}")
        worst = point_text(one) or "nominal"
        rows.append([one["requirement"], ", ".join(bounds), result, margin, one["verdict"], worst])
    head = ["requirement", "bound", "worst result", "margin", "verdict", "worst case"]
    print_rows(f"{facts['name']}: {facts['title']}", head, rows, numbers=False)
    for one in facts["requirements"]:
        if one["verdict"] != "met" and one["message"]:
            say(f"{one['requirement']}: {one['message']}")
