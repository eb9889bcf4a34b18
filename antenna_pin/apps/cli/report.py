"""``antenna-pin report``: one page on any number of runs and findings."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from antenna_pin.apps.cli._common import writable_file
from antenna_pin.apps.cli._options import argument, option, several
from antenna_pin.base.readable import bare


def report(
    files: Annotated[
        list[Path],
        argument(
            "Result files of runs; also what phase, poincare, bifurcation, orbit and lyapunov save.",
            "FILES...",
        ),
    ],
    out: Annotated[Path, option("The report, an HTML file.", "FILE")],
    title: Annotated[str | None, option("Title; that of the runs if left out.")] = None,
    figures: Annotated[bool, option("Draw figures.")] = True,
    recordings: Annotated[bool, option("Embed 3D recordings, which play in a browser.")] = True,
    quantities: Annotated[
        list[str] | None, several("A key number by a function of a run.", "FILE.py:NAME", "--quantity")
    ] = None,
    window: Annotated[
        str | None,
        option("Length of the windows of pointing indices ('0.5 s'); a tenth of the run if left out."),
    ] = None,
) -> None:
    """Write a report that compares runs: one HTML file for screen, phone and paper.

    Portraits, sections, bifurcation diagrams, orbits, branches and exponents have a section each.
    """
    target = writable_file(out, ".html")
    words = ["antenna-pin", "report", *map(str, files), "--out", str(out)]
    words += [] if title is None else ["--title", title]
    words += [] if figures else ["--no-figures"]
    words += [] if recordings else ["--no-recordings"]
    words += [word for one in quantities or () for word in ("--quantity", one)]
    words += [] if window is None else ["--window", window]

    from antenna_pin.base.units import quantity
    from antenna_pin.show.plot import processes_to_draw
    from antenna_pin.show.report import report as make

    length = None if window is None else quantity(bare(window), "s", "--window")
    made = make(
        files,
        title=title,
        figures=figures,
        recordings=recordings,
        window=length,
        quantities=quantities or (),
        command=shlex.join(words),
        processes=processes_to_draw(),
    )
    typer.echo(f"saved {made.save(target)}")
