"""What curves come to where they cannot be compared row by row: rms, powers of bands, histograms of blows."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import ScenarioError
from antenna_pin.fit.columns import BlowsSpec, ColumnSpec, SpectrumSpec
from antenna_pin.fit.sensors import amount, noise_of

__all__ = ["Target", "compared", "slopes_of", "target_of"]

Array = NDArray[np.float64]

# Of a count n the root of n + 3/8 has a variance of 1/4 (Anscombe 1948, Biometrika 35, 246).
_ANSCOMBE = 0.375
# Of segments that overlap by half under Hann's window, the share that counts as independent: the variance of
# a mean over K of them is 1/K (1 + 2/36) of one alone (Welch 1967, IEEE Trans. Audio 15, 70-73).
_OVERLAP = 1.0 / (1.0 + 2.0 / 36.0)
# Neighbouring lines of Hann's window are no two numbers: its noise bandwidth.
_BANDWIDTH = 1.5


class Target(NamedTuple):
    """What a column is compared by.

    Attributes:
        at: Where along it each number stands: a time [s], a band's middle [Hz], a bin's middle.
        unit: Of that.
        data: Of the record, (numbers,), in the measure in which it is compared.
        sd: Of each, in that measure.
        measure: In words, for who reads it: ``reading``, ``rms``, ``ln power``, ``2 sqrt(count + 3/8)``.
    """

    at: Array
    unit: str
    data: Array
    sd: Array
    measure: str


def target_of(column: ColumnSpec, unit: str, time: Array, values: Array, place: str) -> Target:
    """Return what of a record a column is compared by.

    Args:
        column: As the fit file has it.
        unit: SI unit of what it reads.
        time: Of its rows [s].
        values: As measured, (rows,).
        place: Of the column, for messages.

    Raises:
        ScenarioError: The record is too short for its segments, has no power in a band, or no blows.
    """
    if column.spectrum is not None:
        _check_bands(column.spectrum, time, place)
    data = compared(column, unit, time, values)
    if column.compare == "curve":
        return Target(time, "s", data, np.full(len(time), noise_of(column, unit)), "reading")
    if column.compare == "rms":
        return Target(
            np.array([0.5 * (time[0] + time[-1])]), "s", data, np.array([noise_of(column, unit)]), "rms"
        )
    if column.spectrum is not None:
        edges = np.array(column.spectrum.edges)
        for low, high, value in zip(edges, edges[1:], data, strict=False):
            if not math.isfinite(value):
                raise ScenarioError(
                    f"{place} must have power from {low:g} Hz to {high:g} Hz, got none in the record"
                )
        if column.sd is not None:
            sd = np.full(len(data), amount(column.sd, "1", f"{place}.sd"))
        else:
            sd = _band_noise(column.spectrum, time)
        return Target(np.sqrt(edges[:-1] * edges[1:]), "Hz", data, sd, "ln power")
    assert column.blows is not None
    edges, counted = _edges(column.blows, unit)
    if not np.any(data > 2.0 * math.sqrt(_ANSCOMBE)):
        raise ScenarioError(
            f"{place} must have blows above its level in the record, got none between the edges"
        )
    # The model's own counts scatter as those of the record do, where the motion is chaotic.
    return Target(
        np.sqrt(edges[:-1] * edges[1:]),
        counted,
        data,
        np.full(len(data), math.sqrt(2.0)),
        "2 sqrt(count + 3/8)",
    )


def compared(column: ColumnSpec, unit: str, time: Array, values: Array) -> Array:
    """Return the numbers by which a curve is compared, of a record or of the model."""
    if column.compare == "rms":
        return np.array([math.sqrt(float(np.mean(values**2)))])
    if column.spectrum is not None:
        return _band_powers(column.spectrum, time, values)
    if column.blows is not None:
        edges, _ = _edges(column.blows, unit)
        counts = _spread(_blows(column.blows, unit, time, values), edges)
        return 2.0 * np.sqrt(counts + _ANSCOMBE)
    return values


def slopes_of(column: ColumnSpec, time: Array, values: Array, slopes: Array) -> Array:
    """Return the derivatives of what :func:`compared` makes of a curve, (numbers, fitted).

    Not of blows, which are found anew in each run.

    Args:
        column: As the fit file has it.
        time: Of its rows [s].
        values: Of the model, (rows,).
        slopes: Their derivatives, (rows, fitted).
    """
    assert column.blows is None
    if column.compare == "rms":
        return np.asarray(values @ slopes / (len(values) * math.sqrt(float(np.mean(values**2)))))[np.newaxis]
    if column.spectrum is None:
        return slopes
    here, columns = np.exp(_band_powers(column.spectrum, time, values)), []
    for way in slopes.T:
        # Powers are of second degree in a curve: central differences of any step are exact but for round-off.
        largest = float(np.abs(way).max(initial=0.0))
        step = float(np.abs(values).max()) / largest if largest > 0.0 else 1.0
        ahead, behind = (
            np.exp(_band_powers(column.spectrum, time, values + sign * step * way)) for sign in (1, -1)
        )
        columns.append((ahead - behind) / (2.0 * step * here))
    return np.column_stack(columns) if columns else np.zeros((len(here), 0))


def _pace(time: Array) -> float:
    return (len(time) - 1) / float(time[-1] - time[0])


def _check_bands(spec: SpectrumSpec, time: Array, place: str) -> None:
    pace, length = _pace(time), float(time[-1] - time[0])
    if spec.segment > length:
        raise ScenarioError(
            f"{place}.spectrum.segment must be within the record's {length:g} s, got {spec.segment:g} s"
        )
    if spec.edges[-1] > 0.5 * pace:
        rule = f"must be below half of the record's {pace:g} rows per second"
        raise ScenarioError(f"{place}.spectrum.edges {rule}, got {spec.edges[-1]:g} Hz")
    for low, high in zip(spec.edges, spec.edges[1:], strict=False):
        if (high - low) * spec.segment < 1.0:
            rule = f"must be {1.0 / spec.segment:g} Hz apart at least, as lines of {spec.segment:g} s are"
            raise ScenarioError(f"{place}.spectrum.edges {rule}, got {low:g} Hz and {high:g} Hz")


def _band_powers(spec: SpectrumSpec, time: Array, values: Array) -> Array:
    """Return the logarithm of the power in each band, (bands,); minus infinity where there is none."""
    from scipy.signal import welch

    pace = _pace(time)
    rows = min(len(values), max(2, round(spec.segment * pace)))
    frequency, density = welch(values, pace, nperseg=rows, detrend="constant")
    # Up to each edge, straight between the lines: a band's power follows its edges without jumps.
    total = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(frequency))])
    power = np.diff(np.interp(spec.edges, frequency, total))
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(power))


def _band_noise(spec: SpectrumSpec, time: Array) -> Array:
    """Return the standard deviation of each band's logarithm, of record and model together, (bands,)."""
    segments = max(1.0, 2.0 * float(time[-1] - time[0]) / spec.segment - 1.0) * _OVERLAP
    lines = np.maximum(1.0, np.diff(spec.edges) * spec.segment / _BANDWIDTH)
    return np.asarray(np.sqrt(2.0 / (segments * lines)))


def _edges(spec: BlowsSpec, unit: str) -> tuple[Array, str]:
    counted = {"peaks": unit, "intervals": "s", "impulses": f"{unit} s"}[spec.of]
    return np.array([amount(edge, counted, "edges") for edge in spec.edges]), counted


def _blows(spec: BlowsSpec, unit: str, time: Array, values: Array) -> Array:
    """Return what is counted of each blow."""
    level, size = amount(spec.level, unit, "level"), np.abs(values)
    above = np.concatenate([[False], size > level, [False]]).astype(int)
    begins, ends = np.flatnonzero(np.diff(above) > 0), np.flatnonzero(np.diff(above) < 0)
    if spec.of == "intervals":
        return np.asarray(np.diff(time[begins]))
    if spec.of == "peaks":
        return np.array([size[i:j].max() for i, j in zip(begins, ends, strict=True)])
    step = 1.0 / _pace(time)
    return np.array([size[i:j].sum() * step for i, j in zip(begins, ends, strict=True)])


def _spread(found: Array, edges: Array) -> Array:
    """Return the count of each bin; each number counts in parts in the two whose middles it is between."""
    middles = 0.5 * (np.log(edges[1:]) + np.log(edges[:-1]))
    inside = np.log(found[(found >= edges[0]) & (found <= edges[-1])])
    place = np.interp(inside, middles, np.arange(len(middles), dtype=float))
    left = np.minimum(place.astype(int), len(middles) - 2) if len(middles) > 1 else place.astype(int)
    counts = np.zeros(len(middles))
    np.add.at(counts, left, 1.0 - (place - left))
    if len(middles) > 1:
        np.add.at(counts, left + 1, place - left)
    return counts
