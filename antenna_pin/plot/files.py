"""The whole set of figures, written to a folder."""

from __future__ import annotations

import functools
import io
import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from antenna_pin.errors import OutputError, UnknownNameError
from antenna_pin.plot._runs import Run, choose_joint, labelled
from antenna_pin.plot._style import Width, styled
from antenna_pin.plot.audit import figure_energy, figure_momentum
from antenna_pin.plot.forces import figure_contact_forces
from antenna_pin.plot.motion import QUANTITIES, figure_motion

FORMATS = ("png", "pdf", "svg")

# Without dates and versions the same figure gives the same file.
_LEFT_OUT = {"png": "Software", "pdf": "CreationDate", "svg": "Date"}


def save_figures(
    runs: Iterable[Run],
    folder: str | Path,
    formats: Sequence[str] = ("png",),
    *,
    joint: str | None = None,
    width: Width = "page",
) -> list[Path]:
    """Draw all figures that the runs allow, write them, and return their paths.

    The files are ``motion_angle``, ``motion_rate``, ``motion_acceleration`` (where a joint turns about an
    axis), ``contact_forces`` (where a run
    has contact), ``energy`` and ``momentum`` (where a run has a free base). Each appears whole or not at all.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        folder: Where to write; made if it is missing.
        formats: Any of "png", "pdf" and "svg".
        joint: The joint to draw; the first one with clearance if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    for suffix in formats:
        if suffix not in FORMATS:
            raise UnknownNameError("figure", "format", suffix, FORMATS)
    every = labelled(runs)
    pairs: list[Run] = [(run.label, run.data) for run in every]
    turning = any(run.joints for run in every)
    if turning or joint is not None:
        choose_joint(every, joint)  # refuses an unknown one before anything is made
    long_enough = [run for run in every if run.time.size > 1]

    drawings: dict[str, Callable[[], Figure]] = {}
    for quantity in QUANTITIES if turning else ():
        drawings[f"motion_{quantity}"] = functools.partial(
            figure_motion, pairs, quantity, joint=joint, width=width
        )
    touched = [run for run in long_enough if not run.ideal]
    if any(joint is None or joint in run.clearance_joints for run in touched):
        drawings["contact_forces"] = functools.partial(figure_contact_forces, pairs, joint=joint, width=width)
    drawings["energy"] = functools.partial(figure_energy, pairs, width=width)
    if any("base_position" in run.data for run in long_enough):
        drawings["momentum"] = functools.partial(figure_momentum, pairs, width=width)

    target = _made(Path(folder))
    written: list[Path] = []
    for name, draw in drawings.items():
        figure = draw()
        written += [_save(figure, target / f"{name}.{suffix}") for suffix in formats]
    return written


def _made(folder: Path) -> Path:
    """Make the folder, or say why it cannot be made."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder}: cannot make this folder for the figures ({error.strerror})") from error
    return folder


@styled
def _save(figure: Figure, path: Path) -> Path:
    """Write a figure beside its place and move it there, so that no half figure is ever seen."""
    suffix = path.suffix[1:]
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        figure.savefig(temporary, format=suffix, metadata={_LEFT_OUT[suffix]: None})
        os.replace(temporary, path)
    except OSError as error:
        raise OutputError(f"{path}: cannot write this figure ({error.strerror})") from error
    finally:
        temporary.unlink(missing_ok=True)
    return path


@styled
def rendered(figure: Figure, suffix: str, dpi: float = 300.0) -> bytes:
    """Return a figure as the bytes of a file.

    Args:
        figure: One that a function of this room drew.
        suffix: "png", "pdf" or "svg".
        dpi: Of "png", and of what is rasterised in the others [1/inch].
    """
    if suffix not in FORMATS:
        raise UnknownNameError("figure", "format", suffix, FORMATS)
    buffer = io.BytesIO()
    figure.savefig(buffer, format=suffix, dpi=dpi, metadata={_LEFT_OUT[suffix]: None})
    return buffer.getvalue()
