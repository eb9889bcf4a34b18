"""Parts shared by the commands: one-line refusals, files, figures.

Rooms are imported inside the functions, so ``--help`` does not wait for them.
"""

from __future__ import annotations

import contextlib
import errno
import functools
import io
import itertools
import os
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn, ParamSpec, TypeVar

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.base.interruption import acknowledge, ended_by, held_back, is_interruption
from antenna_pin.errors import (
    AntennaPinError,
    InvalidParameterError,
    OutputError,
    UnknownNameError,
    one_line,
    printable,
)

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario
    from antenna_pin.studies.sweep import Executor
    from antenna_pin.trajectory import Trajectory


def package_folders(folders: list[Path] | None) -> list[Path]:
    """Return the option's folders as absolute paths; refuse one that is none."""
    for folder in folders or ():
        if not folder.is_dir():
            refuse(
                f"--package-path {folder}: must be a folder, got {'a file' if folder.exists() else 'none'}"
            )
    return [folder.absolute() for folder in folders or ()]


REFUSED, ENDED_EARLY, UNBALANCED, DOUBTFUL = 2, 3, 4, 5

#: Exit code of a stopped command, less the signal's number.
SIGNALLED = 128

#: Suffixes of figures.
FIGURES = (".png", ".pdf", ".svg")

P = ParamSpec("P")
R = TypeVar("R")


STANDARD_OUTPUT = "standard output cannot be written"


class StandardOutput(io.TextIOWrapper):
    """Standard output whose errors name it."""

    def write(self, text: str) -> int:
        """Write a text."""
        with self._naming():
            return super().write(text)

    def flush(self) -> None:
        """Pass on what has been written."""
        with self._naming():
            super().flush()

    @contextlib.contextmanager
    def _naming(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            error.filename = STANDARD_OUTPUT
            raise


def say(line: str) -> None:
    """Print a line with its control characters escaped."""
    typer.echo(printable(line))


def complain(message: str, colour: str | None = None) -> None:
    """Print one line on the error stream, coloured on a terminal."""
    with contextlib.suppress(OSError):
        typer.secho(f"antenna-pin: {one_line(' '.join(message.split()))}", err=True, fg=colour)


def refuse(message: str) -> NoReturn:
    complain(message)
    raise typer.Exit(REFUSED)


def one_line_errors(command: Callable[P, R]) -> Callable[P, R]:
    """Report a user's error in one line with an exit code; raise a bug."""

    @functools.wraps(command)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            with warnings.catch_warnings():
                warnings.showwarning = _print_note
                return command(*args, **kwargs)
        except (KeyboardInterrupt, Exception) as error:
            if is_interruption(error):
                raise typer.Exit(report_interruption()) from None
            if isinstance(error, AntennaPinError):
                refuse(str(error))
            if isinstance(error, OSError) and error.errno != errno.EPIPE:  # of a pipe whose reader has gone
                raise typer.Exit(report_unwritable(error)) from None
            raise

    return wrapper


def report_unwritable(error: OSError) -> int:
    """Print the file that cannot be read or written, and return the exit code."""
    if error.filename == STANDARD_OUTPUT:
        _discard(sys.stdout.fileno())  # or Python would try again at its end
    where = f"{error.filename}: " if error.filename else ""
    complain(f"{where}{error.strerror or error}")
    return REFUSED


def report_interruption() -> int:
    """Print that a signal has ended the command, and return its exit code."""
    acknowledge()
    _discard_closed_streams()
    complain("interrupted")
    return SIGNALLED + ended_by()


def _print_note(message: Warning | str, *about: object, **more: object) -> None:
    complain(f"note: {message}")


def _discard_closed_streams() -> None:
    """Discard further output where the terminal has been closed, or printing raises."""
    for stream in (sys.stdout, sys.stderr):
        try:
            number = stream.fileno()
            os.write(number, b"")
        except (OSError, ValueError, AttributeError) as error:  # the latter two: not a stream of the system
            if getattr(error, "errno", None) == errno.EIO:
                _discard(number)


def _discard(number: int) -> None:
    """Discard further output of a stream."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, number)
    os.close(nowhere)


def load(
    name: str,
    case: str | None,
    settings: Sequence[str] | None,
    geometry: options.Geometry | None = None,
    duration: str | None = None,
) -> Scenario:
    """Return the scenario with the changes of the command line."""
    from antenna_pin.scenario import load_scenario
    from antenna_pin.scenario.merge import key_of

    changes = list(settings or ())
    if duration is not None:
        changes.append(f"duration={duration}")
    loaded = load_scenario(name, case=case, overrides=changes)
    if geometry is None or not loaded.clearance:
        return loaded
    changes += [f"{key_of(('clearance', joint, 'geometry'))}={geometry.value}" for joint in loaded.clearance]
    return load_scenario(name, case=case, overrides=changes)


def executor_of(
    workers: int | None, scheduler: str | None = None, tls: dict[str, str] | None = None
) -> Executor:
    """Return what makes runs: processes here, those of a scheduler, or this process alone."""
    from antenna_pin.studies.sweep import Cluster, Here

    return Here() if workers == 0 else Cluster(workers, scheduler, tls)


def stem(scenario: Scenario) -> str:
    """Return NAME-CASE, or NAME of a scenario without cases, as a file name."""
    name = f"{scenario.name}-{scenario.case}" if scenario.case else str(scenario.name)
    return name.replace("/", "-").replace("\\", "-")


def writable_file(path: Path, suffix: str) -> Path:
    """Return a path for a result, or refuse it before any work."""
    from antenna_pin.base.files import check_writable

    return check_writable(path, suffix)


def figure_target(path: Path | None, command: str, option: str) -> Path | None:
    """Return the file of a figure, or refuse it."""
    if path is None:
        return None
    if path.suffix not in FIGURES:
        raise InvalidParameterError(command, option, f"a file that ends in {', '.join(FIGURES)}", str(path))
    return writable_file(path, path.suffix)


@contextlib.contextmanager
def not_interrupted() -> Iterator[None]:
    """Hold back interrupts while a result is written and its place is printed."""
    _discard_closed_streams()
    with held_back():
        yield


def save_result(trajectory: Trajectory, path: Path) -> None:
    """Write a result; on failure write it elsewhere and end the command."""
    try:
        trajectory.save(path)
    except OutputError as error:
        save_elsewhere(trajectory, path, error)


def save_elsewhere(trajectory: Trajectory, path: Path, error: OutputError) -> NoReturn:
    """Write a result to another folder, as on a full disk, and exit."""
    for folder in dict.fromkeys((os.curdir, tempfile.gettempdir(), os.path.expanduser("~"))):
        numbers = itertools.count(2)
        elsewhere = Path(folder, path.name)
        while os.path.lexists(elsewhere):
            elsewhere = Path(folder, f"{path.stem}-{next(numbers)}{path.suffix}")
        with contextlib.suppress(OutputError):
            trajectory.save(elsewhere)
            refuse(f"{error}; the result is in {elsewhere} instead")
    refuse(f"{error}; no other folder could be written either; free disk space and run again")


def load_result(path: Path, scenario: bool = True) -> Trajectory:
    """Return a result, faster without its scenario."""
    from antenna_pin.trajectory import Trajectory

    return Trajectory.load(path, scenario=scenario)


def label_of(trajectory: Trajectory, path: Path) -> str:
    return str(trajectory.data.attrs.get("case") or path.stem)


def labels_of(paths: Sequence[Path]) -> list[str]:
    """Return column headings of results: file names, or paths where names coincide."""
    names = [path.stem for path in paths]
    return names if len(set(names)) == len(names) else [str(path) for path in paths]


def figure_formats(text: str) -> list[str]:
    """Return the formats of figures in a comma-separated list, each once."""
    known = [suffix[1:] for suffix in FIGURES]
    suffixes = list(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    for suffix in suffixes or [""]:
        if suffix not in known:
            raise UnknownNameError("--format", "figure format", suffix, known)
    return suffixes


def figure_folder(out: Path) -> Path:
    """Return the folder for figures, or refuse a file."""
    if out.exists() and not out.is_dir():
        raise OutputError(f"--out {out}: this is a file; name a folder for the figures")
    return out


def say_notes(trajectory: Trajectory, before: str) -> None:
    """Print spin and limits that a run has passed, each line after the text ``before``."""
    texts: list[str | None] = []
    if "elastic_part" in trajectory.data.sizes:
        from antenna_pin.analysis import said_of_spin

        texts.append(said_of_spin(trajectory))
    if "<limit" in str(trajectory.data.attrs.get("urdf", "")):
        from antenna_pin.analysis import said_of_limits

        texts += said_of_limits(trajectory)
    for text in filter(None, texts):
        say(f"{before}{text}")


def say_start(trajectory: Trajectory, scenario: Scenario, before: str) -> None:
    """Print the joints that move at the start without a given rate."""
    if trajectory.constraints:
        from antenna_pin.analysis import said_of_moving

        if said := said_of_moving(trajectory.constraints, scenario):
            say(f"{before}{said}")
