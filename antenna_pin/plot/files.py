"""Figures as files: one, or the whole set in a folder."""

from __future__ import annotations

import gc
import io
import re
from collections.abc import Callable, Collection, Iterable, Sequence
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from antenna_pin.arguments import takes
from antenna_pin.errors import AntennaPinError, OutputError, UnknownNameError
from antenna_pin.files import replacing
from antenna_pin.plot._runs import Run, labelled
from antenna_pin.plot._style import MANY, Width, styled
from antenna_pin.plot.catalogue import CATALOGUE, Allowed, allowed_figures

FORMATS = ("png", "pdf", "svg")

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
) -> list[Path]:
    """Draw the figures of the catalogue that the runs allow, write them, and return their paths.

    Each file bears its figure's name in :data:`CATALOGUE`, and is whole or not there at all. Figures of a
    joint are drawn of every joint that the runs are about; of the second and later ones they bear its name as
    well, as in ``journal_orbit-lower``.

    Args:
        runs: Trajectories, or pairs of a label and a dataset or trajectory.
        folder: Where to write; made if it is missing.
        formats: Any of "png", "pdf" and "svg".
        joint: The one joint to draw; each with clearance if left out.
        names: The figures to draw; the standard ones if left out.
        width: "column" (88 mm) or "page" (180 mm).
        on_left_out: Told the name of a figure that the data do not allow although the runs are of the kind
            for it, or that was asked for by name, and the reason; nobody is if left out.
    """
    check_formats(formats)
    given = list(runs)
    drawings: dict[str, Allowed] = {}
    for each in allowed_figures(given, joint, names):
        drawings[_free_name(each, drawings)] = each
    target = folder_for_figures(folder)
    written: list[Path] = []
    long = any(run.data.sizes.get("time", 0) > MANY for run in labelled(given))
    tell = on_left_out or (lambda name, reason: None)
    for name in sorted(set(names or ()) - {each.figure.name for each in drawings.values()}):
        tell(name, f"no run has {CATALOGUE[name].needed}")
    for name, each in drawings.items():
        try:
            figure = each.draw(given, width=width)
        except AntennaPinError as error:  # a variable is missing, or all are too short
            tell(name, str(error))
            continue
        written += save_figure(figure, target / name, formats)
        del figure
        if long:  # Matplotlib's figures refer to themselves: Python leaves many of them before it looks
            gc.collect()
    return written


def _free_name(each: Allowed, taken: Collection[str]) -> str:
    """Return the file's name for a figure: its own, with the joint's where a joint before has taken that."""
    name = each.figure.name
    if name in taken:
        name += "-" + re.sub(r"[^\w.+-]", "_", str(each.joint))
    while name in taken:
        name += "_"
    return name


def check_formats(formats: Sequence[str]) -> None:
    """Raise if a format is none that figures are written in."""
    for suffix in formats:
        if suffix not in FORMATS:
            raise UnknownNameError("figure", "format", suffix, FORMATS)


@takes()
def save_figure(figure: Figure, path: str | Path, formats: Sequence[str] = ("png",)) -> list[Path]:
    """Write a figure in each format, the format added to the path, and return the files.

    Args:
        figure: What to write.
        path: Name without a format, in a folder that exists.
        formats: Any of "png", "pdf" and "svg".
    """
    check_formats(formats)
    return [_save(figure, Path(f"{path}.{suffix}")) for suffix in formats]


@takes()
def folder_for_figures(folder: str | Path) -> Path:
    """Make the folder, or say why it cannot be made."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder}: cannot make this folder for the figures ({error.strerror})") from error
    return folder


@styled
def _save(figure: Figure, path: Path) -> Path:
    """Write a figure beside its place and move it there, so that no half figure is ever seen."""
    suffix = path.suffix[1:]
    with replacing(path) as partial:
        figure.savefig(partial, format=suffix, metadata={_LEFT_OUT[suffix]: None})
    return path


@takes()
@styled
def rendered(figure: Figure, suffix: str, dpi: float = 300.0) -> bytes:
    """Return a figure as the bytes of a file; letters of an SVG are outlines, which need no font.

    Args:
        figure: One that a function of this room drew.
        suffix: "png", "pdf" or "svg".
        dpi: Of "png", and of what is rasterised in the others [1/inch].
    """
    if suffix not in FORMATS:
        raise UnknownNameError("figure", "format", suffix, FORMATS)
    buffer = io.BytesIO()
    with matplotlib.rc_context({"svg.fonttype": "path"}):
        figure.savefig(buffer, format=suffix, dpi=dpi, metadata={_LEFT_OUT[suffix]: None})
    return buffer.getvalue()
