"""``antenna-pin sweep``: the runs of a parameter study that its store lacks."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import complain, executor_of, refuse, say
from antenna_pin.apps.cli._options import argument, flag, option
from antenna_pin.apps.cli._progress import study_bar
from antenna_pin.apps.cli._tables import print_rows
from antenna_pin.apps.cli.study import is_grid, print_grid, print_outcomes, run_rows, said_of_time
from antenna_pin.base.rules import NumberRule

if TYPE_CHECKING:
    from antenna_pin.studies.sweep import Executor, Study


def sweep(
    study: Annotated[
        str | None, argument("Study file, or name of a shipped study; lists those if left out.", "[STUDY]")
    ] = None,
    out: Annotated[Path | None, option("Folder of the store; NAME.study here if left out.", "FOLDER")] = None,
    settings: Annotated[
        list[str] | None, options.settings_of("the study", "sampling.count=64 or 'set.duration=0.5 s'")
    ] = None,
    dry_run: Annotated[
        bool, flag("--dry-run", "Print the planned runs and their duration; run nothing.")
    ] = False,
    workers: options.Workers = None,
    threads: Annotated[
        int | None,
        option("Threads of this process, not processes; 0 for one for each core.", "N"),
        NumberRule("zero or more"),
    ] = None,
    scheduler: Annotated[
        str | None, option("Dask scheduler that has workers: tcp://host:8786.", "URL")
    ] = None,
    tls_ca: Annotated[
        Path | None, option("Certificate of the authority, for a tls:// scheduler.", "FILE")
    ] = None,
    tls_cert: Annotated[Path | None, option("Certificate of this client.", "FILE")] = None,
    tls_key: Annotated[Path | None, option("Its private key.", "FILE")] = None,
    apart: Annotated[
        bool, flag("--apart", "If the store belongs to another study or version, create a second store.")
    ] = False,
    progress: options.Progress = True,
    quiet: options.Quiet = False,
) -> None:
    """Make the runs of a parameter study that its store lacks.

    All combinations are built before any is run. The same command continues an interrupted one.
    """
    from antenna_pin.studies.sweep import list_studies, load_study, run_study

    if study is None:
        for name in list_studies():
            typer.echo(f"{name}: {load_study(name).title}")
        return
    loaded = load_study(study, settings or ())
    if dry_run:
        _show(loaded, out, workers if threads is None else threads or None)
        return
    executor = _executor(workers, threads, scheduler, {"ca": tls_ca, "cert": tls_cert, "key": tls_key})
    try:
        with study_bar(loaded.name, progress and not quiet) as report:
            table = run_study(
                loaded,
                out,
                executor=executor,
                apart=apart,
                progress=report,
                say=lambda line: complain(f"note: {line}"),
            )
    finally:
        executor.close()
    for name in loaded.responses:
        without = int((table[name].isnull() & (table["outcome"] == "COMPLETED")).sum())
        if without:
            complain(
                f"note: response {name} has no number in {without} of {table['outcome'].size} runs; why is "
                f"with each run: antenna-pin study show {table.attrs['path']} --csv runs.csv"
            )
    if not quiet:
        if is_grid(table):
            print_grid(loaded.name, table)
        print_outcomes(loaded.name, table)
        say(f"saved {table.attrs['path']}")


def _executor(
    workers: int | None, threads: int | None, scheduler: str | None, tls: dict[str, Path | None]
) -> Executor:
    given = {name: str(path) for name, path in tls.items() if path is not None}
    if scheduler is not None and workers is not None:
        refuse("--workers: must be left out with --scheduler, which has its own workers")
    if given and (scheduler is None or len(given) < 3):
        refuse("--tls-ca, --tls-cert, --tls-key: must be given together, with --scheduler tls://...")
    for name, path in given.items():
        if not os.path.isfile(path):
            refuse(f"--tls-{name} {path}: no such file")
    if threads is None:
        return executor_of(workers, scheduler, given or None)
    if workers is not None or scheduler is not None:
        refuse("--threads: must be left out with --workers and --scheduler, which name processes")
    from antenna_pin.studies.sweep import Threads

    return Threads(threads or None)


def _show(study: Study, out: Path | None, workers: int | None) -> None:
    from antenna_pin.studies.sweep import prepare, run_seconds, trial

    prepared = prepare(study)
    design = prepared.design
    title = f"{study.name}: {study.title}" if study.title else study.name
    head, rows = run_rows(design)
    print_rows(f"{title}: {design.count} runs", head, rows, numbers=False)
    if design.count > len(rows):
        typer.echo(f"... and {design.count - len(rows)} more")
    shown = trial(prepared)
    for note in shown.notes:
        say(f"note: {note}")
    names: Any = ", ".join(
        f"{name} [{response.unit}]" if response.unit not in ("", "1") else name
        for name, response in study.responses.items()
    )
    typer.echo(f"responses: {names}")
    cores = os.cpu_count() or 1 if workers is None else max(1, workers)
    typer.echo(said_of_time(design.count, run_seconds(prepared), cores))
