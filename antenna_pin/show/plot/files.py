"""Figures as files: one, or the whole set in a folder."""

from __future__ import annotations

import contextlib
import gc
import io
import re
from collections.abc import Callable, Collection, Iterable, Sequence
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import replacing
from antenna_pin.base.side_by_side import cores_for, side_by_side
from antenna_pin.errors import AntennaPinError, InvalidParameterError, OutputError, UnknownNameError
from antenna_pin.show.plot._runs import Run, labelled
from antenna_pin.show.plot._style import MANY, Width, styled
from antenna_pin.show.plot.catalogue import CATALOGUE, Allowed, allowed_figures

FORMATS = ("png", "pdf", "svg")

#: What a process may take that draws figures of long runs, beside the runs [bytes].
_MEMORY = 4e8

# Without dates and versions the same figure gives the same file.
_LEFT_OUT = {"png": "Software", "pdf": "CreationDate", "svg": "Date"}


@takes()
def save_figures(
    runs: Iterable[Run],
    folder: str | Path,
    formats: Sequence[str] = ("png",),
    *,
    joint: str | None = None,
    names: Collection[str] | None = None,
    width: Width = "page",
    on_left_out: Callable[[str, str], None] | None = None,
    processes: int = 1,
) -> list[Path]:
    """Draw the catalogue's figures that runs allow, write them, and return their paths.

    Each file bears its figure's name in :data:`CATALOGUE`, and that of the joint that it is of, as in
    ``journal_orbit-lower``; it is whole or not there at all.

    Args:
        runs: Trajectories, or pairs of a label and a dataset or trajectory.
        folder: Folder of the files; made if it is missing.
        formats: Any of "png", "pdf" and "svg".
        joint: The one joint to draw; each with clearance if left out.
        names: The figures to draw; the standard ones if left out.
        width: "column" (88 mm) or "page" (180 mm).
        on_left_out: Called with the name of a figure that the data do not allow although the runs are of its
            kind, or that was requested by name, and the reason.
        processes: Number of processes that draw, at most. More than one are forked from this one
            (:func:`antenna_pin.base.side_by_side.side_by_side`), which no other thread may be at work beside.
    """
    check_formats(formats)
    given = list(runs)
    check_one_mechanism(given)
    drawings: dict[str, Allowed] = {}
    for each in allowed_figures(given, joint, names):
        drawings[_free_name(each, drawings)] = each
    target = folder_for_figures(folder)
    long = any(run.data.sizes.get("time", 0) > MANY for run in labelled(given))

    def drawn(each: Allowed) -> list[bytes] | str:
        """Return the figure as files of the formats, or why there is none."""
        try:
            figure = each.draw(given, width=width)
        except AntennaPinError as error:  # a variable is missing, or all are too short
            return str(error)
        found = [_as_file(figure, suffix) for suffix in formats]
        del figure
        if long:  # Matplotlib's figures refer to themselves: Python leaves many of them before it looks
            gc.collect()
        return found

    tell = on_left_out or (lambda name, reason: None)
    for name in sorted(set(names or ()) - {each.figure.name for each in drawings.values()}):
        tell(name, f"no run has {CATALOGUE[name].needed}")
    written: list[Path] = []
    with contextlib.closing(side_by_side(drawn, [*drawings.values()], processes)) as every:
        for name, found in zip(drawings, every, strict=True):
            if isinstance(found, str):
                tell(name, found)
                continue
            for suffix, content in zip(formats, found, strict=True):
                written.append(_write(content, target / f"{name}.{suffix}"))
    return written


@takes()
def check_one_mechanism(runs: Iterable[Run]) -> None:
    """Raise if two runs have no joint in common: figures compare runs of one mechanism.

    Args:
        runs: Trajectories, or pairs of a label and a dataset or trajectory.
    """
    first: tuple[str, set[str]] | None = None
    for run in labelled(runs):
        mine = {*run.joints, *run.sliding_joints, *run.clearance_joints}
        if first is None or not mine or not first[1]:
            first = first or (run.label, mine)
        elif not mine & first[1]:
            one, other = (", ".join(sorted(names)) for names in (first[1], mine))
            raise InvalidParameterError(
                "plot",
                "runs",
                "of one mechanism (draw others by a command of their own)",
                said=f"{first[0]} with joints {one} and {run.label} with joints {other}",
            )


def _free_name(each: Allowed, others: Collection[str]) -> str:
    """Return a figure's file name, with that of its joint."""
    name = each.figure.name
    if each.joint is not None:
        name += "-" + re.sub(r"[^\w.+-]", "_", each.joint)
    while name in others:
        name += "_"
    return name


def processes_to_draw() -> int:
    """Return the number of drawing processes that cores and memory allow."""
    return cores_for(_MEMORY)


def check_formats(formats: Sequence[str]) -> None:
    """Raise if a format is none that figures are written in."""
    for suffix in formats:
        if suffix not in FORMATS:
            raise UnknownNameError("figure", "format", suffix, FORMATS)


@takes()
def save_figure(figure: Figure, path: str | Path, formats: Sequence[str] = ("png",)) -> list[Path]:
    """Write a figure in each format, added to the path, and return the files.

    Args:
        figure: Figure to write.
        path: Name without a format, in a folder that exists.
        formats: Any of "png", "pdf" and "svg".
    """
    check_formats(formats)
    return [_write(_as_file(figure, suffix), Path(f"{path}.{suffix}")) for suffix in formats]


@takes()
def folder_for_figures(folder: str | Path) -> Path:
    """Make the folder, or refuse with the reason."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder}: cannot make this folder for the figures ({error.strerror})") from error
    return folder


def _write(content: bytes, path: Path) -> Path:
    """Write a file beside its place and move it there, so that it is whole."""
    with replacing(path) as partial:
        partial.write_bytes(content)
    return path


@takes()
def rendered(figure: Figure, suffix: str, dpi: float = 300.0) -> bytes:
    """Return a figure as the bytes of a file; letters of an SVG are outlines.

    Args:
        figure: Figure drawn by a function of this room.
        suffix: "png", "pdf" or "svg".
        dpi: Of "png", and of what is rasterised in the others [1/inch].
    """
    check_formats([suffix])
    return _as_file(figure, suffix, dpi, {"svg.fonttype": "path"})


@styled
def _as_file(figure: Figure, suffix: str, dpi: float | None = None, settings: Any = None) -> bytes:
    """Return a figure's file, by default at the style's resolution."""
    buffer = io.BytesIO()
    with matplotlib.rc_context(settings):
        figure.savefig(buffer, format=suffix, dpi=dpi, metadata={_LEFT_OUT[suffix]: None})
    return buffer.getvalue()
