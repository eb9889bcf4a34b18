"""Command line: thin face of the Python API; parses, calls, prints.

Rooms are imported inside the commands, so ``--help`` and ``list`` do not wait for the mechanics.

Exit codes: 0 done; 1 a requirement of ``verify`` is not shown to be met; 2 refused, with one line on the
error stream; 3 a run ended before its time (its result is saved); 4 its energy or momentum does not balance
(likewise); 130, 143, 129 interrupted by Ctrl-C, SIGTERM, SIGHUP (what was computed is saved).
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
from collections.abc import Callable
from typing import Annotated

import typer

from antenna_pin.apps.cli import (
    analyse,
    bifurcation,
    contact,
    demo,
    explore,
    export,
    figures,
    fit,
    info,
    lyapunov,
    margin,
    modes,
    orbit,
    phase,
    poincare,
    pointing,
    record,
    report,
    run,
    sensitivity,
    statics,
    stress,
    study,
    sweep,
    tolerance,
    urdf,
    verify,
    vibration,
    view,
)
from antenna_pin.apps.cli._common import (
    StandardOutput,
    complain,
    one_line_errors,
    report_interruption,
    report_unwritable,
)
from antenna_pin.apps.cli._progress import said_at_work
from antenna_pin.apps.cli._usage import OneLineGroup, with_plain_numbers
from antenna_pin.base.interruption import ending_by_signals

__all__ = ["app", "main"]

app = typer.Typer(
    name="antenna-pin",
    cls=OneLineGroup,
    help="Simulate mechanisms with imperfect joints on a free-floating base.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """Run the command line, which SIGTERM and SIGHUP end as Ctrl-C does."""
    ending_by_signals()
    _have_streams()
    quiet = not {"-q", "--quiet"}.isdisjoint(sys.argv)
    command = next((word for word in sys.argv[1:] if not word.startswith("-")), "it")
    try:
        with contextlib.nullcontext() if quiet else said_at_work(command, complain):
            app()
    except KeyboardInterrupt:  # while the commands are made
        sys.exit(report_interruption())
    except OSError as error:  # of a page of help
        sys.exit(report_unwritable(error))


def _have_streams() -> None:
    """Occupy the places of closed standard streams, so that no opened file takes them.

    Complaints then go nowhere; what is printed fails, as it must, on a file that is open for reading only.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            place = os.open(os.devnull, os.O_WRONLY if name == "stderr" else os.O_RDONLY)
            if place != number:
                os.dup2(place, number)
                os.close(place)
            stream = open(number, "w" if number else "r", closefd=False)
            setattr(sys, name, stream)
            setattr(sys, f"__{name}__", stream)
    out = sys.stdout
    if isinstance(out, io.TextIOWrapper):
        sys.stdout = StandardOutput(out.buffer, out.encoding, out.errors, line_buffering=out.line_buffering)


def _show_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"antenna-pin {version('antenna-pin')}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


# In the order in which --help shows them.
_COMMANDS: dict[str, Callable[..., None]] = {
    "demo": demo.demo,
    "list": run.list_scenarios,
    "run": run.run,
    "info": info.info,
    "analyse": analyse.analyse,
    "impacts": analyse.impacts,
    "stress": stress.stress,
    "tolerance": tolerance.tolerance,
    "pointing": pointing.pointing,
    "modes": modes.modes,
    "statics": statics.statics,
    "margin": margin.margin,
    "phase": phase.phase,
    "poincare": poincare.poincare,
    "bifurcation": bifurcation.bifurcation,
    "orbit": orbit.orbit,
    "lyapunov": lyapunov.lyapunov,
    "sensitivity": sensitivity.sensitivity,
    "plot": info.plot,
    "figures": figures.figures,
    "explore": explore.explore,
    "view": view.view,
    "record": record.record,
    "report": report.report,
    "urdf": urdf.urdf,
    "sweep": sweep.sweep,
    "verify": verify.verify,
    "fit": fit.fit,
}
for _name, _command in _COMMANDS.items():
    app.command(_name)(one_line_errors(with_plain_numbers(_command)))

for _group in (contact.app, study.app, vibration.app, export.app):
    for _registered in _group.registered_commands:
        assert _registered.callback is not None
        _registered.callback = one_line_errors(with_plain_numbers(_registered.callback))
    app.add_typer(_group)


def __dir__() -> list[str]:
    return sorted(__all__)
