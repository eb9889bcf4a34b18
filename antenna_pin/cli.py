"""Command line: parse, call, print. What it does, the Python API does in as few lines.

Rooms are imported inside the commands, so ``--help`` and ``list`` do not wait for the mechanics.

Exit codes: 0 done; 2 refused, with one line on the error stream that says why; 3 a run ended before its time
(its result is saved); 130 interrupted (what was computed is saved).
"""

from __future__ import annotations

import contextlib
import errno
import functools
import json
import signal
from collections.abc import Callable, Iterator, Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn, ParamSpec, TypeVar

import typer

from antenna_pin.cli_contact import app as contact_app
from antenna_pin.errors import AntennaPinError, OutputError, UnknownNameError

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario
    from antenna_pin.simulation import Progress
    from antenna_pin.trajectory import Trajectory

__all__ = ["app", "main"]

REFUSED = 2
ENDED_EARLY = 3
INTERRUPTED = 130

P = ParamSpec("P")
R = TypeVar("R")

app = typer.Typer(
    name="antenna-pin",
    help="Simulate mechanisms with imperfect joints on a free-floating base.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


class Geometry(StrEnum):
    """Backends that find where journal and bearing touch."""

    COAL = "coal"
    CLOSED_FORM = "closed-form"


class Width(StrEnum):
    """Widths of figures."""

    COLUMN = "column"
    PAGE = "page"


def main() -> None:
    """Run the command line."""
    app()


def _complain(message: str) -> None:
    """Print one line on the error stream."""
    typer.echo(f"antenna-pin: {' '.join(message.split())}", err=True)


def _refuse(message: str) -> NoReturn:
    _complain(message)
    raise typer.Exit(REFUSED)


def _one_line_errors(command: Callable[P, R]) -> Callable[P, R]:
    """Turn what a user can act on into one line and an exit code; a bug keeps its traceback."""

    @functools.wraps(command)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return command(*args, **kwargs)
        except KeyboardInterrupt:
            _complain("interrupted")
            raise typer.Exit(INTERRUPTED) from None
        except AntennaPinError as error:
            _refuse(str(error))
        except OSError as error:
            if error.errno == errno.EPIPE:  # the reader of a pipe has gone: nothing to say
                raise
            where = f"{error.filename}: " if error.filename else ""
            _refuse(f"{where}{error.strerror or error}")

    return wrapper


def _show_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"antenna-pin {version('antenna-pin')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


# --- list ---


@app.command("list")
@_one_line_errors
def list_scenarios() -> None:
    """List the shipped scenarios and their cases."""
    from antenna_pin.scenario import list_scenarios as shipped

    for name, title, cases in shipped():
        typer.echo(f"{name}: {title}")
        widest = max((len(case) for case, _ in cases), default=0)
        for case, description in cases:
            typer.echo(f"  {case:<{widest}}  {description}".rstrip())


# --- run ---

ScenarioArgument = Annotated[
    str, typer.Argument(metavar="SCENARIO", help="Name of a shipped scenario, or path of a TOML file.")
]
CaseOption = Annotated[str | None, typer.Option(help="Case of the scenario; its default case if left out.")]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change one entry of the scenario, such as integrator.rtol=1e-9 or"
        " 'clearance.elevation.radial_clearance=0.1 mm'. May be repeated.",
    ),
]


@app.command()
@_one_line_errors
def run(
    scenario: ScenarioArgument,
    case: CaseOption = None,
    duration: Annotated[
        str | None, typer.Option(help="Simulated time, in seconds or with a unit ('20 ms').")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Result file; NAME-CASE.nc here if left out.")] = None,
    settings: SetOption = None,
    geometry: Annotated[
        Geometry | None, typer.Option(help="How gaps are found, for all joints with clearance.")
    ] = None,
    progress: Annotated[bool, typer.Option(help="Show a progress bar.")] = True,
    summary: Annotated[bool, typer.Option(help="Print a summary of the result.")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
) -> None:
    """Simulate a scenario and save the result."""
    chosen = _load(scenario, case, settings, geometry, duration)
    path = _writable_file(out or Path(f"{_stem(chosen)}.nc"), ".nc")

    from antenna_pin.simulation import simulate

    with _progress_bar(_stem(chosen), progress and not quiet) as report:
        trajectory = simulate(chosen, progress=report)
    with _not_interrupted():
        trajectory.save(path)
    if summary and not quiet:
        _print_table([(_label(trajectory, path), trajectory.summary())])
    if not quiet:
        typer.echo(f"saved {path}")
    outcome = trajectory.outcome.name
    if outcome == "COMPLETED":
        return
    _complain(f"{_stem(chosen)}: {trajectory.message} (the result up to there is in {path})")
    raise typer.Exit(INTERRUPTED if outcome == "INTERRUPTED" else ENDED_EARLY)


def _load(
    name: str,
    case: str | None,
    settings: Sequence[str] | None,
    geometry: Geometry | None = None,
    duration: str | None = None,
) -> Scenario:
    """Return the scenario with the changes that the command line asks for."""
    from antenna_pin.scenario import load_scenario

    changes = list(settings or ())
    if duration is not None:
        changes.append(f"duration={duration}")
    loaded = load_scenario(name, case=case, overrides=changes)
    if geometry is None or not loaded.clearance:
        return loaded
    changes += [f"clearance.{joint}.geometry={geometry.value}" for joint in loaded.clearance]
    return load_scenario(name, case=case, overrides=changes)


def _stem(scenario: Scenario) -> str:
    """Return NAME-CASE, or NAME where a scenario has no cases."""
    return f"{scenario.name}-{scenario.case}" if scenario.case else str(scenario.name)


def _writable_file(path: Path, suffix: str) -> Path:
    """Return a path that a result can be written to, or say what keeps it from being one.

    Asked before a run, so that hours of work do not end in a missing folder.
    """
    from antenna_pin.trajectory import check_writable

    if path.suffix != suffix and not path.is_dir():
        raise OutputError(f"{path}: the output's name must end in {suffix}; try {path.with_suffix(suffix)}")
    return check_writable(path)


@contextlib.contextmanager
def _not_interrupted() -> Iterator[None]:
    """Let a result be written to its end: a second Ctrl-C must not cost it."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextlib.contextmanager
def _progress_bar(title: str, shown: bool) -> Iterator[Callable[[Progress], None] | None]:
    """Yield what a run reports its progress to: simulated time, speed and step size on the error stream."""
    if not shown:
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    bar = Bar(
        TextColumn("{task.description}"),
        BarColumn(bar_width=None),
        TextColumn("{task.fields[time]}"),
        TextColumn("{task.fields[speed]}"),
        TextColumn("{task.fields[step]}"),
        TimeRemainingColumn(compact=True),
        console=Console(stderr=True),
        expand=True,
        refresh_per_second=5,
    )
    task = bar.add_task(title, total=None, time="", speed="", step="")

    def report(now: Progress) -> None:
        speed = now.time / now.wall if now.wall > 0.0 else 0.0
        bar.update(
            task,
            completed=now.time,
            total=now.end,
            time=f"{now.time:.4g} of {now.end:g} s",
            speed=f"{speed:.3g} s/s",
            step=f"step {_seconds(now.step)}",
        )
        bar.start()  # with the first step: what is refused before leaves no bar behind

    try:
        yield report
    finally:
        if bar.live.is_started:
            bar.stop()


def _seconds(value: float) -> str:
    """Return a short duration with a unit that suits it."""
    for size, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value:.3g} s"


# --- info ---

FilesArgument = Annotated[list[Path], typer.Argument(metavar="FILES...", help="Result files of runs.")]


@app.command()
@_one_line_errors
def info(
    files: FilesArgument,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object per file, each on one line.")
    ] = False,
) -> None:
    """Say what results are: how they ended, counts, peaks, conservation."""
    runs = [(path, _load_result(path)) for path in files]
    if as_json:
        for path, trajectory in runs:
            typer.echo(json.dumps({"file": str(path), **_facts(trajectory)}, default=str))
        return
    _print_table([(_label(trajectory, path), _facts(trajectory)) for path, trajectory in runs])


def _facts(trajectory: Trajectory) -> dict[str, Any]:
    """Return the summary of a run with the share of time that each joint spent in each contact scenario."""
    from antenna_pin.analysis import scenario_shares

    shares = scenario_shares(trajectory)
    found = {
        str(joint): {
            f"radial {radial}, axial {axial}".replace("_", " "): float(share)
            for radial, row in zip(shares["radial"].values, table, strict=True)
            for axial, share in zip(shares["axial"].values, row, strict=True)
            if share > 0.0
        }
        for joint, table in zip(shares["clearance_joint"].values, shares.values, strict=True)
    }
    return trajectory.summary() | ({"share of time": found} if found else {})


def _load_result(path: Path) -> Trajectory:
    from antenna_pin.trajectory import Trajectory

    return Trajectory.load(path)


def _label(trajectory: Trajectory, path: Path) -> str:
    return str(trajectory.data.attrs.get("case") or path.stem)


# How the entries of a summary are called in a table, and their units; others keep their own names.
_ENTRIES = {
    "time": ("simulated time", "s"),
    "accepted": ("steps accepted", ""),
    "rejected": ("steps rejected", ""),
    "relocated": ("steps cut to a change of contact", ""),
    "wall_seconds": ("wall time", "s"),
    "energy_error": ("energy balance error", "J"),
    "energy_error_relative": ("energy balance error, relative", "-"),
    "gross_work": ("gross work of the drives", "J"),
    "linear_momentum_drift": ("linear momentum drift", "kg m/s"),
    "linear_momentum_scale": ("linear momentum scale", "kg m/s"),
    "linear_momentum_drift_relative": ("linear momentum drift, relative", "-"),
    "angular_momentum_drift": ("angular momentum drift", "kg m²/s"),
    "angular_momentum_scale": ("angular momentum scale", "kg m²/s"),
    "angular_momentum_drift_relative": ("angular momentum drift, relative", "-"),
    "gap_difference": ("gaps, coal against closed form", "m"),
    "angle": ("angle at the end", "rad"),
    "rate": ("rate at the end", "rad/s"),
    "peak_acceleration": ("peak acceleration", "rad/s²"),
    "peak_force": ("peak force", "N"),
    "peak_depth": ("peak depth", "m"),
    "largest_approach_speed": ("largest approach speed", "m/s"),
    "impulse": ("impulse", "N s"),
    "dissipated": ("energy lost", "J"),
}
# Groups of a summary whose name says nothing that their entries do not say.
_PLAIN_GROUPS = ("counts", "conservation", "motion", "contacts")


def _print_table(summaries: Sequence[tuple[str, dict[str, Any]]]) -> None:
    """Print summaries side by side, one row per figure."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    columns = [dict(_rows(summary)) for _, summary in summaries]
    titles = dict.fromkeys(str(summary.get("title", "")) for _, summary in summaries)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title="; ".join(filter(None, titles)))
    table.title_justify = "left"
    table.add_column("", no_wrap=True)
    for label, _ in summaries:
        table.add_column(label, justify="right", overflow="fold")
    for row in dict.fromkeys(name for column in columns for name in column):
        table.add_row(row, *(column.get(row, "-") for column in columns))
    # Units stand in brackets, which are no markup. A pipe has no width to keep to.
    console = Console(highlight=False, markup=False)
    if not console.is_terminal:
        console = Console(highlight=False, markup=False, width=max(100, 50 + 36 * len(summaries)))
    console.print(table)


def _rows(summary: dict[str, Any], group: str = "") -> Iterator[tuple[str, str]]:
    """Yield name and text of every entry of a summary, those of a group after its name."""
    for key, value in summary.items():
        if isinstance(value, dict):
            yield from _rows(value, group if key in _PLAIN_GROUPS else f"{group}{key} ")
        elif not (key in ("title", "case") and not group):
            name, unit = _ENTRIES.get(key, (key.replace("_", " "), ""))
            yield f"{group}{name}" + (f" [{unit}]" if unit else ""), _text(value)


def _text(value: Any) -> str:
    """Return an entry as it stands in a table."""
    if value is None or value == "":
        return "-"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)):
        return ", ".join(map(_text, value))
    return str(value)


# --- plot ---


@app.command()
@_one_line_errors
def plot(
    files: FilesArgument,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the figures; made if missing.")],
    formats: Annotated[
        str, typer.Option("--format", metavar="LIST", help="Any of png, pdf, svg, separated by commas.")
    ] = "png",
    joint: Annotated[
        str | None, typer.Option(help="Joint to draw; the first one with clearance if left out.")
    ] = None,
    width: Annotated[Width, typer.Option(help="Width of the figures: 88 mm or 180 mm.")] = Width.PAGE,
) -> None:
    """Draw motion, contact forces, energy, momentum."""
    suffixes = list(dict.fromkeys(part.strip() for part in formats.split(",") if part.strip()))
    for suffix in suffixes or [""]:
        if suffix not in ("png", "pdf", "svg"):
            raise UnknownNameError("--format", "figure format", suffix, ("png", "pdf", "svg"))
    if out.exists() and not out.is_dir():
        raise OutputError(f"--out {out}: this is a file; name a folder for the figures")
    runs = [(path, _load_result(path)) for path in files]
    labels = [_label(trajectory, path) for path, trajectory in runs]
    if len(set(labels)) < len(labels):  # the same case twice: the files tell them apart
        labels = [path.stem for path, _ in runs]

    from antenna_pin.plot import save_figures

    pairs = [(label, trajectory.data) for label, (_, trajectory) in zip(labels, runs, strict=True)]
    for figure in save_figures(pairs, out, suffixes, joint=joint, width=width.value):
        typer.echo(figure)


# --- urdf ---


@app.command()
@_one_line_errors
def urdf(
    scenario: ScenarioArgument,
    case: CaseOption = None,
    out: Annotated[Path | None, typer.Option(help="URDF file; NAME-CASE.urdf here if left out.")] = None,
    settings: SetOption = None,
) -> None:
    """Write the URDF that a case simulates.

    Joints with clearance are free in it; other tools can load it.
    """
    chosen = _load(scenario, case, settings)
    path = _writable_file(out or Path(f"{_stem(chosen)}.urdf"), ".urdf")

    from antenna_pin.assemble import urdf_variant

    urdf_variant(chosen).write(path)
    typer.echo(f"saved {path}")


# --- contact ---

for _command in contact_app.registered_commands:
    assert _command.callback is not None
    _command.callback = _one_line_errors(_command.callback)
app.add_typer(contact_app)


if __name__ == "__main__":
    main()
