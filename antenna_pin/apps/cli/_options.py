"""Options and arguments that commands share, and short declarations of their own."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from antenna_pin.base.rules import NumberRule


def argument(text: str, metavar: str | None = None) -> Any:
    """Return an argument with its help, and the name of its value."""
    return typer.Argument(metavar=metavar, help=text)


def option(text: str, metavar: str | None = None, *flags: str, **more: Any) -> Any:
    """Return an option with its help, the name of its value, and its own flags."""
    return typer.Option(*flags, metavar=metavar, help=text, **more)


def several(text: str, metavar: str, *flags: str) -> Any:
    """Return an option that may be repeated (:func:`option`)."""
    return option(f"{text} May be repeated.", metavar, *flags)


def flag(name: str, text: str) -> Any:
    """Return an option without a value that cannot be negated."""
    return typer.Option(name, help=text)


def settings_of(what: str, examples: str) -> Any:
    """Return the option ``--set`` of a command."""
    return several(f"Change one entry of {what}, such as {examples}.", "KEY=VALUE", "--set")


class Engine(StrEnum):
    """Engine of a run."""

    PINOCCHIO = "pinocchio"
    COMPILED = "compiled"


class Geometry(StrEnum):
    """Backends that find where journal and bearing touch."""

    COAL = "coal"
    CLOSED_FORM = "closed-form"


class Width(StrEnum):
    """Widths of figures."""

    COLUMN = "column"
    PAGE = "page"


_PACKAGES = "Folder with packages of package:// names, before ROS_PACKAGE_PATH."
_ENTRIES = "integrator.rtol=1e-9 or 'clearance.elevation.radial_clearance=0.1 mm'"
_FOLDER = "Folder for figures, created if missing; without it no figures are drawn."
_PROCESSES = "Processes; one for each core if left out, 0 for this one alone."
_TABLE = "Write the numbers to a CSV file, in SI units, instead."

# What commands read.
Scenario = Annotated[str, argument("Name of a shipped scenario, or path of a TOML file.", "SCENARIO")]
Result = Annotated[Path, argument("Result file of a run.", "FILE")]
Results = Annotated[list[Path], argument("Result files of runs.", "FILES...")]
Case = Annotated[str | None, option("Case of the scenario; its default case if left out.")]
Set = Annotated[list[str] | None, settings_of("the scenario", _ENTRIES)]
Duration = Annotated[str | None, option("Simulated time, in seconds or with a unit ('20 ms').")]
Gaps = Annotated[Geometry | None, option("Method that finds gaps, for all joints with clearance.")]
PackagePath = Annotated[list[Path] | None, several(_PACKAGES, "DIR", "--package-path")]
Workers = Annotated[int | None, option(_PROCESSES, "N"), NumberRule("zero or more")]

# What they print and write.
Progress = Annotated[bool, option("Show a progress bar.")]
Quiet = Annotated[bool, option("Print nothing but errors.", None, "--quiet", "-q")]
Json = Annotated[bool, flag("--json", "Print one JSON object, in SI units, instead of tables.")]
Csv = Annotated[Path | None, option(_TABLE, "FILE", "--csv")]
Dataset = Annotated[Path | None, option("Dataset of the result, NAME.nc.", "FILE", "--out")]
Plot = Annotated[Path | None, option("Figure of the result: png, pdf or svg.", "FILE", "--plot")]
FigureWidth = Annotated[Width, option("Width of the figures: 88 mm or 180 mm.")]
FigureFolder = Annotated[Path | None, option(_FOLDER, "DIR")]
FigureFormats = Annotated[str, option("Any of png, pdf, svg, separated by commas.", "LIST", "--format")]
