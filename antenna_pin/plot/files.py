"""The whole set of figures, written to a folder."""

from __future__ import annotations

import functools
import io
import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TypeAlias

import matplotlib
from matplotlib.figure import Figure

from antenna_pin.errors import AntennaPinError, OutputError, UnknownNameError
from antenna_pin.files import replacing
from antenna_pin.plot._runs import LabelledRun, Run, choose_moving_joint, labelled, long_enough
from antenna_pin.plot._style import Width, styled
from antenna_pin.plot.audit import figure_energy, figure_momentum
from antenna_pin.plot.base import BASE_QUANTITIES, figure_base
from antenna_pin.plot.eccentricity import figure_eccentricity
from antenna_pin.plot.forces import figure_contact_forces
from antenna_pin.plot.loads import figure_joint_load
from antenna_pin.plot.motion import QUANTITIES, figure_motion
from antenna_pin.plot.orbit import figure_bore_load, figure_orbit
from antenna_pin.plot.pointing import figure_pointing
from antenna_pin.plot.scenarios import figure_scenarios
from antenna_pin.plot.spectra import figure_spectra, figure_spectrogram

FORMATS = ("png", "pdf", "svg")

# Without dates and versions the same figure gives the same file.
_LEFT_OUT = {"png": "Software", "pdf": "CreationDate", "svg": "Date"}
_Drawings: TypeAlias = "dict[str, Callable[[], Figure]]"


def save_figures(
    runs: Iterable[Run],
    folder: str | Path,
    formats: Sequence[str] = ("png",),
    *,
    joint: str | None = None,
    width: Width = "page",
    on_left_out: Callable[[str, str], None] | None = None,
) -> list[Path]:
    """Draw all figures that the runs allow, write them, and return their paths.

    The files, each whole or not there at all:

    - ``motion_angle``, ``motion_rate``, ``motion_acceleration`` where a joint turns about an axis;
    - ``contact_forces``, ``joint_load``, ``journal_orbit``, ``bore_load``, ``eccentricity`` and
      ``contact_scenarios`` where a run has contact;
    - ``base_position``, ``base_velocity``, ``base_acceleration``, ``base_attitude``,
      ``base_angular_velocity``, ``base_angular_acceleration`` and ``momentum`` where a run has a free base;
    - ``pointing`` where a scenario says what looks where;
    - ``spectra`` where a run has 16 samples or more, ``spectrogram`` where it has 64;
    - ``energy``.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        folder: Where to write; made if it is missing.
        formats: Any of "png", "pdf" and "svg".
        joint: The joint to draw; the first one with clearance if left out.
        width: "column" (88 mm) or "page" (180 mm).
        on_left_out: Told the name of a figure that the data do not allow although the runs are of the kind
            for it, and the reason; nobody is if left out.
    """
    check_formats(formats)
    every = labelled(runs)
    if any(run.joints for run in every) or joint is not None:
        choose_moving_joint(every, joint)  # refuses an unknown one before anything is made
    drawings = _standard([(run.label, run.data) for run in every], every, joint, width)
    target = folder_for_figures(folder)
    written: list[Path] = []
    for name, draw in drawings.items():
        try:
            figure = draw()
        except AntennaPinError as error:  # a variable is missing, or all are too short
            if on_left_out is not None:
                on_left_out(name, str(error))
            continue
        written += save_figure(figure, target / name, formats)
    return written


def _standard(pairs: list[Run], every: list[LabelledRun], joint: str | None, width: Width) -> _Drawings:
    """Return the figures that runs of this kind have, by the names of their files."""
    long = long_enough(every)
    turning = any(joint in (None, name) for run in every for name in run.joints)
    touching = any(joint in (None, name) for run in long for name in run.clearance_joints)
    floating = any("base_position" in run.data for run in long)
    # Those of an older version of the format can be looked into where they carry their scenario.
    known = any("urdf" in run.data.attrs or run.data.attrs.get("scenario") for run in long)
    of_joint = functools.partial(functools.partial, joint=joint, width=width)
    plain = functools.partial(functools.partial, width=width)
    drawings: _Drawings = {}
    for quantity in QUANTITIES if turning else ():
        drawings[f"motion_{quantity}"] = of_joint(figure_motion, pairs, quantity)
    if touching:
        drawings["contact_forces"] = of_joint(figure_contact_forces, pairs)
        if known:
            drawings["joint_load"] = of_joint(figure_joint_load, pairs)
            drawings["journal_orbit"] = of_joint(figure_orbit, pairs)
            drawings["eccentricity"] = of_joint(figure_eccentricity, pairs)
        drawings["bore_load"] = of_joint(figure_bore_load, pairs)
        drawings["contact_scenarios"] = of_joint(figure_scenarios, pairs)
    for part in BASE_QUANTITIES if floating else ():
        drawings[f"base_{part}"] = plain(figure_base, pairs, part)
    if any(_points(run) for run in long):
        drawings["pointing"] = plain(figure_pointing, pairs)
    if known and (turning or touching):
        drawings["spectra"] = of_joint(figure_spectra, pairs)
        chosen = choose_moving_joint(every, joint)
        turns = any(chosen in run.joints for run in every)  # a ball joint does not, about an axis
        drawings["spectrogram"] = of_joint(figure_spectrogram, pairs, "acceleration" if turns else "force")
    drawings["energy"] = plain(figure_energy, pairs)
    if floating:
        drawings["momentum"] = plain(figure_momentum, pairs)
    return drawings


def _points(run: LabelledRun) -> bool:
    """Whether the scenario of a run says what looks where."""
    try:
        return bool(json.loads(run.data.attrs["scenario"])["pointing"])
    except (KeyError, TypeError, ValueError):
        return False


def check_formats(formats: Sequence[str]) -> None:
    """Raise if a format is none that figures are written in."""
    for suffix in formats:
        if suffix not in FORMATS:
            raise UnknownNameError("figure", "format", suffix, FORMATS)


def save_figure(figure: Figure, path: str | Path, formats: Sequence[str] = ("png",)) -> list[Path]:
    """Write a figure in each format, the format added to the path, and return the files.

    Args:
        figure: What to write.
        path: Name without a format, in a folder that exists.
        formats: Any of "png", "pdf" and "svg".
    """
    check_formats(formats)
    return [_save(figure, Path(f"{path}.{suffix}")) for suffix in formats]


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
