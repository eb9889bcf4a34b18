"""Where the boresight looks beside where it should: indices of ECSS-E-ST-60-10C, runs side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr

from antenna_pin.analysis import error_components, pointing_error, pointing_indices
from antenna_pin.base.readable import number, readable
from antenna_pin.errors import AntennaPinError
from antenna_pin.report._page import Details, Picture, Row, Section, Table, quantities
from antenna_pin.report._runs import ReportedRun, ideal_of

__all__ = ["pointing"]

#: Of the levels [-].
CONFIDENCE = 0.997
#: Places that levels are taken from; these are printed with four digits.
RESOLUTION = 100
#: Samples of a run up to which its windows are looked at.
WITH_WINDOWS = 150_000
#: Windows in a run, where no length is given.
WINDOWS = 10
_ASKED = ("window", "drift_spacing", "periods")


def pointing(runs: Sequence[ReportedRun], window: float | None, pictures: Sequence[Picture] = ()) -> Section:
    """Return pointing indices of the runs whose scenario says what looks where.

    Args:
        runs: What is reported.
        window: Length of the windows [s]; a tenth of the shortest run if left out.
        pictures: Its figures.
    """
    looking = [run for run in runs if run.run.scenario is not None and run.run.scenario.pointing is not None]
    ideal = ideal_of(runs)
    found: list[tuple[ReportedRun, xr.Dataset]] = []
    notes: list[str] = []
    against: dict[str, list[str]] = {}
    judged = [run for run in looking if run is not ideal or _commanded(run)]
    span = min((run.end - float(run.data["time"].values[0]) for run in judged), default=0.0)
    length = span / WINDOWS if window is None else window
    for run in judged:
        if not _commanded(run) and ideal is None:
            continue
        try:
            errors = pointing_error(run.run, None if _commanded(run) or ideal is None else ideal.run)
            long = run.samples > WITH_WINDOWS
            indices = _indices(errors, None if long else length)
            if long:
                notes.append(
                    f"{run.label}: windows over more than {WITH_WINDOWS} samples take more memory than a "
                    "report is to; `antenna-pin pointing --window` has them."
                )
        except AntennaPinError as error:
            notes.append(f"{run.label}: {error}.")
            continue
        found.append((run, indices))
        told = str(errors.attrs["against"]) + ("" if _commanded(run) or ideal is None else f", {ideal.label}")
        against.setdefault(f"boresight of {errors.attrs['body']} against the {told}", []).append(run.label)
    if not found:
        return Section(key="pointing", title="Pointing", items=tuple(pictures), notes=tuple(notes))
    lead = tuple(f"{', '.join(labels)}: {what}." for what, labels in against.items())
    table = Table(
        columns=("", *(run.label for run, _ in found)),
        rows=tuple(_rows([indices for _, indices in found])),
        caption="Pointing error indices of ECSS-E-ST-60-10C",
        key="pointing",
    )
    asked = next((one.attrs for _, one in found if "window" in one.attrs), None)
    said = ""
    if asked is not None:
        width, spacing, period = (readable(asked[name], "s") for name in _ASKED)
        said = (
            f"Windows of {width}; drift over {spacing} from one window's start to the other's; "
            f"reproducibility between periods of {period}. Largest: over all places of the windows. "
        )
    meaning = (
        f"{said}Half-cone: the angle by which the boresight is off; cross and up: its parts about the "
        "antenna's axes; boresight: the turn about it."
    )
    folded = Details(title="Pointing error indices", tables=(table,), notes=(meaning,))
    return Section(key="pointing", title="Pointing", lead=lead, items=(*pictures, folded), notes=tuple(notes))


def _commanded(run: ReportedRun) -> bool:
    """Whether the run's scenario names a direction to compare with, rather than an ideal run."""
    scenario = run.run.scenario
    return scenario is not None and scenario.pointing is not None and scenario.pointing.commanded != "ideal"


def _indices(errors: xr.Dataset, window: float | None) -> xr.Dataset:
    time = np.asarray(errors["time"].values, dtype=float)
    span = float(time[-1] - time[0])
    return pointing_indices(
        time,
        error_components(errors),
        window=window,
        drift_spacing=None if window is None else span / 4.0,
        periods=None if window is None else span / 2.0,
        confidence=CONFIDENCE,
        resolution=RESOLUTION,
    )


def _rows(found: Sequence[xr.Dataset]) -> Iterator[Row]:
    kinds = list(dict.fromkeys(str(kind) for one in found for kind in one["index"].values))
    components = list(dict.fromkeys(str(name) for one in found for name in one["component"].values))
    components.sort(key=lambda name: name != "half-cone")  # what counts for a dish stands first
    meanings = {
        str(kind): str(text).partition(":")[0]
        for one in found
        for kind, text in zip(one["index"].values, one["definition"].values, strict=True)
    }
    for kind in kinds:
        yield Row(f"{kind}, {meanings[kind]}")
        for name in components:
            cells = [_picked(one, "extreme", kind, name) for one in found]
            yield quantities(f"{name}, largest", cells, "rad")
            if name == "half-cone":
                levels = [_picked(one.sel(interpretation="temporal"), "level", kind, name) for one in found]
                yield quantities(f"{name}, {number(100.0 * CONFIDENCE)} % of the time", levels, "rad")


def _picked(found: xr.Dataset, variable: str, kind: str, name: str) -> float | None:
    if kind not in found["index"].values or name not in found["component"].values:
        return None
    return float(found[variable].sel(index=kind, component=name))
