"""Analyses of the motion: deviation from the ideal run, dominant frequencies, pointing."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
import xarray as xr

from antenna_pin.analysis import (
    DeviationMeasures,
    Growth,
    blocks,
    deviation_measures,
    dominant_frequencies,
    elastic_parts_of,
    error_components,
    is_round_off,
    pointing_error,
    pointing_indices,
    round_off_scales,
)
from antenna_pin.base.readable import number, readable
from antenna_pin.errors import AntennaPinError
from antenna_pin.show.report._page import (
    Cell,
    Details,
    PageTable,
    Picture,
    Row,
    Section,
    quantities,
    quantity,
    words,
)
from antenna_pin.show.report._runs import ReportedRun, every, ideal_of, run_table

#: Frequencies named per signal and run.
FREQUENCIES = 3
# Returns a signal from one sample up to another; None of a run that has no such.
_Pick: TypeAlias = Callable[[ReportedRun, int, int], np.ndarray | None]


# --- deviation ---


def deviations(runs: Sequence[ReportedRun]) -> Section:
    """Return each run's deviation from the ideal one."""
    ideal = ideal_of(runs)
    if ideal is None:
        return _section(notes=("No other run, without clearance, to deviate from; add one to see this.",))
    found: list[tuple[ReportedRun, tuple[DeviationMeasures, ...]]] = []
    notes = []
    for run in runs:
        if run is ideal:
            continue
        try:
            found.append((run, deviation_measures(run.data, ideal.data)))
        except AntennaPinError as error:
            notes.append(f"{run.label}: {error}.")
    if not found:
        return _section(notes=tuple(notes))
    measured = list(dict.fromkeys(m.of for _, one in found for m in one))
    joints = [of for of in measured if not of.startswith("base ")]
    bases = [of for of in measured if of.startswith("base ")]
    scales = round_off_scales(*(run.data for run in runs))
    items: list[PageTable | Details] = []
    if joints:
        caption = f"Motion of the joints less that of {ideal.label}"
        first = [of for of in joints if of.endswith((" angle", " position"))]
        items.append(_deviation_table(found, first, caption, "deviation", scales))
        rest = [of for of in joints if of not in first]
        if rest:
            table = _deviation_table(found, rest, caption, "deviation-rates", scales)
            items.append(Details(title="Deviation of rates and accelerations", tables=(table,)))
    if bases:
        caption = f"Motion of the base less that in {ideal.label}: lengths of vectors in world axes"
        table = _deviation_table(found, bases, caption, "deviation-base", scales)
        items.append(Details(title="Deviation of the base", tables=(table,)))
    meaning = (
        f"Against {ideal.label}, which is interpolated to each run's own samples, while both last. Growth: "
        "what explains the envelope best, a power of time or an exponential, with its coefficient of "
        "determination."
    )
    return _section(items=tuple(items), notes=tuple(notes), meaning=(meaning,))


def _section(
    items: tuple[PageTable | Details, ...] = (), notes: tuple[str, ...] = (), meaning: tuple[str, ...] = ()
) -> Section:
    title = "Deviation from the ideal run"
    return Section(key="deviation", title=title, items=items, notes=notes, meaning=meaning)


def _deviation_table(
    deviations: Sequence[tuple[ReportedRun, Sequence[DeviationMeasures]]],
    quantities: Sequence[str],
    caption: str,
    key: str,
    scales: Mapping[str, float],
) -> PageTable:
    """Return a table with a row per quantity, and per run of several."""
    rows: list[Row] = []
    for of in quantities:
        if len(deviations) > 1:
            rows.append(Row(of))
        for run, one in deviations:
            rows += [
                _measures(run.label if len(deviations) > 1 else of, m, scales) for m in one if m.of == of
            ]
    columns = ("", "largest", "at", "root mean square", "at the end", "growth")
    return PageTable(columns=columns, rows=tuple(rows), caption=caption, key=key)


def _measures(name: str, of: DeviationMeasures, scales: Mapping[str, float]) -> Row:
    still = is_round_off(of.maximum, of.units, scales)
    cells = (
        quantity(of.maximum, of.units, scales=scales),
        quantity(None if still else of.time_of_maximum, "s"),
        quantity(of.rms, of.units, scales=scales),
        quantity(of.end, of.units, scales=scales),
        Cell("zero to round-off" if still else _growth(of.growth)),
    )
    return Row(name, cells)


def _growth(growth: Growth) -> str:
    if growth.kind == "power":
        return f"like time to the {number(growth.exponent, 3)} ({number(growth.power_r2, 3)})"
    if growth.kind == "exponential":
        return f"like exp({number(growth.rate, 3)} t/s) ({number(growth.exponential_r2, 3)})"
    return growth.note


# --- frequencies ---


def frequencies(runs: Sequence[ReportedRun]) -> Section:
    """Return the strongest periodic parts of the joints' accelerations and the journals' forces."""
    signals: dict[str, _Pick] = {}
    units: dict[str, str] = {}
    for name in every(runs, "joint"):
        label = f"acceleration of {name}"
        signals[label], units[label] = _picker("motion_acceleration", "joint", name), "rad/s^2"
    for name in every(runs, "elastic_part"):
        slides = any(elastic_parts_of(run.data).get(name, {}).get("slides") for run in runs)
        label = f"deflection of {name}"
        signals[label], units[label] = _picker("deflection", "elastic_part", name), "m" if slides else "rad"
    for name in every(runs, "clearance_joint"):
        label = f"force on the journal of {name}"
        signals[label], units[label] = _picker("joint_force", "clearance_joint", name), "N"
    rows: list[Row] = []
    notes: list[str] = []
    for label, pick in signals.items():
        found: list[xr.Dataset | None] = []
        for run in runs:
            try:
                if pick(run, 0, 1) is None:
                    found.append(None)
                    continue
                time, scale = run.data["time"].values, _scale(run, signals, units, units[label])
                found.append(dominant_frequencies(time, _reader(run, pick), FREQUENCIES, scale=scale))
            except AntennaPinError as error:
                found.append(None)
                notes.append(f"{run.label}, {label}: {error}.")
        if any(one is not None for one in found):
            rows += _frequency_rows(label, found, units[label])
    table = run_table(runs, rows, "Strongest frequencies", "frequencies")
    meaning = (
        "Strongest first, with the amplitude of the sine; only what stands out five times above its "
        "surroundings. An amplitude is a mean over the whole run."
    )
    return Section(
        key="frequencies",
        title="Dominant frequencies",
        items=(table,) if rows else (),
        notes=tuple(dict.fromkeys(notes)),
        meaning=(meaning,) if rows else (),
        folded=True,
    )


def _scale(run: ReportedRun, signals: Mapping[str, _Pick], units: Mapping[str, str], unit: str) -> float:
    """Return the largest size of a run's signals of a unit, for round-off."""
    largest = 0.0
    for part in blocks(run.data):
        own = replace(run, run=replace(run.run, data=part))
        picked = (pick(own, 0, own.samples) for label, pick in signals.items() if units[label] == unit)
        known = (values[np.isfinite(values)] for values in picked if values is not None)
        largest = max([largest, *(float(np.abs(values).max(initial=0.0)) for values in known)])
    return largest


def _picker(variable: str, dimension: str, name: str) -> _Pick:
    def pick(run: ReportedRun, begin: int, last: int) -> np.ndarray | None:
        if name not in run.names(dimension):
            return None
        values = np.asarray(run.data[variable].sel({dimension: name})[begin:last].values, dtype=float)
        return np.linalg.norm(values, axis=1) if values.ndim == 2 else values

    return pick


def _reader(run: ReportedRun, pick: _Pick) -> Callable[[int, int], np.ndarray]:
    """Return what reads a signal that a run has."""

    def read(begin: int, last: int) -> np.ndarray:
        values = pick(run, begin, last)
        assert values is not None
        return values

    return read


def _frequency_rows(label: str, spectra: Sequence[xr.Dataset | None], unit: str) -> Iterator[Row]:
    yield Row(label)
    most = max(one.sizes["peak"] for one in spectra if one is not None)
    if not most:
        quiet = all(one is None or one.attrs["round_off"] for one in spectra)
        yield words("nothing above round-off" if quiet else "nothing stands out", ("" for _ in spectra))
    for k in range(most):
        cells = []
        for one in spectra:
            if one is None or k >= one.sizes["peak"]:
                cells.append(Cell(number(None)))
                continue
            frequency, amplitude = float(one["frequency"][k]), float(one["amplitude"][k])
            cells.append(Cell(f"{readable(frequency, 'Hz')}, {readable(amplitude, unit, 3)}", frequency))
        yield Row(f"{k + 1}.", tuple(cells))


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
    """Return pointing indices of the runs whose scenario defines a boresight.

    ``window``: length of the windows [s]; a tenth of the shortest run if left out.
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
        reference = None if _commanded(run) else ideal
        if reference is None and not _commanded(run):
            continue
        try:
            errors = pointing_error(run.run, None if reference is None else reference.run)
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
        told = str(errors.attrs["against"]) + ("" if reference is None else f", {reference.label}")
        against.setdefault(f"boresight of {errors.attrs['body']} against the {told}", []).append(run.label)
    if not found:
        return Section(key="pointing", title="Pointing", items=tuple(pictures), notes=tuple(notes))
    lead = tuple(f"{', '.join(labels)}: {what}." for what, labels in against.items())
    table = PageTable(
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
    """Return whether the run's scenario commands a direction."""
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


def _rows(indices: Sequence[xr.Dataset]) -> Iterator[Row]:
    kinds = list(dict.fromkeys(str(kind) for one in indices for kind in one["index"].values))
    components = list(dict.fromkeys(str(name) for one in indices for name in one["component"].values))
    components.sort(key=lambda name: name != "half-cone")  # what counts for a dish stands first
    meanings = {
        str(kind): str(text).partition(":")[0]
        for one in indices
        for kind, text in zip(one["index"].values, one["definition"].values, strict=True)
    }
    for kind in kinds:
        yield Row(f"{kind}, {meanings[kind]}")
        for name in components:
            cells = [_picked(one, "extreme", kind, name) for one in indices]
            yield quantities(f"{name}, largest", cells, "rad")
            if name == "half-cone":
                levels = [_picked(one.sel(interpretation="temporal"), "level", kind, name) for one in indices]
                yield quantities(f"{name}, {number(100.0 * CONFIDENCE)} % of the time", levels, "rad")


def _picked(indices: xr.Dataset, variable: str, kind: str, name: str) -> float | None:
    if kind not in indices["index"].values or name not in indices["component"].values:
        return None
    return float(indices[variable].sel(index=kind, component=name))
