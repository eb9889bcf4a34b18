r"""Sensors: readings of a run behind low-pass filters, and statistics for their comparison.

An accelerometer at a point r of a link, with its axis d, both in the link's axes R, reads the specific force

.. math:: f = (\mathbf{R} \mathbf{d})^T [\dot{\mathbf{v}}_P - \mathbf{g}], \quad
    \mathbf{v}_P = \mathbf{v} + \boldsymbol{\omega} \times \mathbf{R} \mathbf{r}.

Behind a filter velocity and position of the point count as well as its acceleration: of an impact between two
samples they give the impulse and the time. The transfer function of a Butterworth filter is a sum over its
poles,

.. math:: H(s) = \sum_i \frac{r_i}{s - p_i}, \quad r_i = \prod_{j \neq i} (p_i - p_j)^{-1},

in units of the corner's angular frequency. Each term obeys a linear equation of first order, whose solution
over an interval of length h is :math:`x' = e^{p h} x + \int_0^h e^{p (h - \tau)} f(\tau)\,d\tau`. Between two
samples of a run the input f is a polynomial and impulses at known times; an impulse J at time s contributes
:math:`J e^{p (h - s)}`. So the response follows the time of an impact smoothly, however short the impact.

An acceleration is sampled with the velocity and position that belong to it. Over an interval from a to b
these fix its zeroth and first moments exactly,

.. math:: \int_a^b \dot{v}\,dt = v_b - v_a, \quad \int_a^b (b - t)\,\dot{v}\,dt = x_b - x_a - (b - a)\,v_a,

whatever the acceleration does in between. A straight line from one sampled acceleration to the next accounts
for a part of both moments; the rest is an impulse, whose size is the rest of the zeroth moment and whose time
is the ratio of the rests. If that time is outside the interval, two opposite impulses at its ends supply the
rest of the first moment.
"""

from __future__ import annotations

import json
import math
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.linalg import solve_banded

from antenna_pin.analysis import joint_loads, mechanism_of, quantity
from antenna_pin.base.arrays import Array
from antenna_pin.base.directions import unit as along
from antenna_pin.base.units import quantity as in_si
from antenna_pin.errors import AntennaPinError, ScenarioError, UnknownNameError
from antenna_pin.mechanism import link_motion
from antenna_pin.studies.fit.specs import BlowsSpec, ColumnSpec, SpectrumSpec

# --- low-pass filters ---------------------------------------------------------------------------------------

# Gauss-Legendre nodes and weights on [0, 1]: exact to the fifth degree, where |p h| is 0.3 at most.
_NODES, _WEIGHTS = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)]), np.array([5.0, 8.0, 5.0]) / 18.0


class _FilterInput(NamedTuple):
    """Input of a filter over the n - 1 intervals between n sample times."""

    time: Array  # sample times, rising, (n,) [s]
    smooth: Array  # coefficients of a polynomial in the share of the interval, (n - 1, 3)
    impulses: Array  # sizes of impulses in each interval, (n - 1, k), in the input's unit times s
    places: Array  # times of the impulses after the interval's start, (n - 1, k) [s]

    def at(self, intervals: NDArray[np.intp], share: Array) -> Array:
        """Return the smooth part of the input at shares of some intervals, (m,)."""
        first, second, third = self.smooth[intervals].T
        return np.asarray(first + share * (second + share * third))


def input_of_values(time: Array, values: Array) -> _FilterInput:
    """Return the input that is linear between its values at sample times, (n,) each."""
    smooth = np.column_stack([values[:-1], np.diff(values), np.zeros(len(time) - 1)])
    none = np.zeros((len(time) - 1, 0))
    return _FilterInput(time, smooth, none, none)


def input_of_acceleration(
    time: Array, axes: Array, position: Array, velocity: Array, acceleration: Array, gravity: Array
) -> _FilterInput:
    """Return the specific force along a moving axis as a filter's input.

    Args:
        time: Sample times, rising, (n,) [s].
        axes: Unit vectors of the sensitive axis, (n, 3).
        position: Position of the sensor, (n, 3) [m].
        velocity: Its velocity, (n, 3) [m/s].
        acceleration: Its acceleration, at a jump the value afterwards, (n, 3) [m/s^2].
        gravity: (3,) [m/s^2].
    """
    h = np.diff(time)[:, None]
    turn, bend = np.diff(axes, axis=0), np.diff(acceleration, axis=0)
    force = acceleration[:-1] - gravity
    smooth = np.column_stack(
        [_dot(axes[:-1], force), _dot(axes[:-1], bend) + _dot(turn, force), _dot(turn, bend)]
    )
    impulse = np.diff(velocity, axis=0) - h * (acceleration[:-1] + 0.5 * bend)
    moment = np.diff(position, axis=0) - h * velocity[:-1] - h**2 * (acceleration[:-1] / 2.0 + bend / 6.0)
    size = _dot(impulse, impulse)
    left = np.divide(_dot(impulse, moment), size, out=np.zeros(len(size)), where=size > 0.0)  # to the end
    place = h[:, 0] - np.clip(left, 0.0, h[:, 0])
    share = np.divide(place, h[:, 0], out=np.zeros(len(size)), where=h[:, 0] > 0.0)
    axis = axes[:-1] + share[:, None] * turn
    along = _dot(axis, impulse)
    lack = _dot(axis, moment) - along * (h[:, 0] - place)
    pair = np.divide(lack, h[:, 0], out=np.zeros(len(size)), where=h[:, 0] > 0.0)
    return _FilterInput(
        time,
        smooth,
        np.column_stack([pair, along, -pair]),
        np.column_stack([np.zeros(len(size)), place, h[:, 0]]),
    )


def filter_response(signal: _FilterInput, rows: Array, corner: float, order: int) -> Array:
    """Return the output at rising times, (m,), of a filter with a corner [Hz].

    Before the first sample the input is constant.
    """
    omega = 2.0 * np.pi * corner
    poles = np.exp(0.5j * np.pi * (1.0 + (2.0 * np.arange(order) + 1.0) / order))
    every = np.arange(len(signal.time) - 1)
    inside = np.clip(np.searchsorted(signal.time, rows, side="right") - 1, 0, len(every) - 1)
    lengths, out = np.diff(signal.time), np.zeros(len(rows))
    for i, pole in enumerate(poles):
        if pole.imag < -1e-9:  # the conjugate of one that counts twice
            continue
        times = 2.0 if pole.imag > 1e-9 else 1.0
        residue = 1.0 / np.prod(pole - np.delete(poles, i))
        p = omega * pole
        driven = omega * _driven(signal, p, every, lengths)
        first = -signal.smooth[0, 0] / pole
        bands = np.ones((2, len(signal.time)), dtype=complex)
        bands[1, :-1] = -np.exp(p * lengths)
        states = solve_banded((1, 0), bands, np.concatenate([[first], driven]), check_finite=False)
        into = rows - signal.time[inside]
        found = np.exp(p * into) * states[inside] + omega * _driven(signal, p, inside, into)
        out += times * (residue * found).real
    return out


def _driven(
    signal: _FilterInput, p: complex, intervals: NDArray[np.intp], into: Array
) -> NDArray[np.complex128]:
    """Return the contribution of intervals' inputs to a pole's state after a time, (m,)."""
    lengths = np.diff(signal.time)[intervals]
    total = np.zeros(len(intervals), dtype=complex)
    for node, weight in zip(_NODES, _WEIGHTS, strict=True):
        share = np.divide(node * into, lengths, out=np.zeros(len(into)), where=lengths > 0.0)
        total += weight * into * np.exp(p * into * (1.0 - node)) * signal.at(intervals, share)
    for size, place in zip(signal.impulses[intervals].T, signal.places[intervals].T, strict=True):
        after = into - place
        total += np.where(after >= 0.0, size * np.exp(p * np.maximum(after, 0.0)), 0.0)
    return total


def _dot(one: Array, other: Array) -> Array:
    return np.asarray(np.einsum("ni,ni->n", one, other))


# --- readings -----------------------------------------------------------------------------------------------

# Samples of a filter's input per period of its corner: of an acceleration with known moments, and of values
# linear between samples, to (2 pi / 64)^2 / 12 = 8e-4 at the corner.
_PER_PERIOD, _PER_PERIOD_OF_VALUES = 24, 64


def sensor_unit(data: xr.Dataset, column: ColumnSpec, place: str) -> str:
    """Return the SI unit of a sensor's reading; refuse an unknown link, joint or quantity."""
    if column.sensor == "accelerometer":
        _check_link(data, str(column.link), f"{place}.link")
        return "m/s^2"
    if column.sensor == "force-cell":
        if column.link is not None:
            _check_link(data, column.link, f"{place}.link")
        joints = [str(name) for name in joint_loads(data, [0])["moving_joint"].values]
        if column.joint not in joints:
            raise UnknownNameError(f"{place}.joint", "joint", str(column.joint), joints)
        return "N" if (column.load or "force") == "force" else "N m"
    try:
        return quantity(data, str(column.of)).units
    except AntennaPinError as error:
        raise ScenarioError(f"{place}.of: {error}") from None


def _check_link(data: xr.Dataset, link: str, place: str) -> None:
    links = [one.name for one in mechanism_of(data).urdf.robot.links]
    if link not in links:
        raise UnknownNameError(place, "link", link, links)


def check_sensor(column: ColumnSpec, unit: str, place: str) -> None:
    """Refuse numbers of a column in a wrong unit."""
    for name in ("sd", "offset", "resolution"):
        value = getattr(column, name)
        relative = name == "sd" and column.compare in ("spectrum", "blows")
        if value is not None:
            si_amount(value, "1" if relative else unit, f"{place}.{name}")
    if column.sensor == "encoder" and not si_amount(column.resolution, unit, place) > 0.0:
        raise ScenarioError(f"{place}.resolution must be positive, got {column.resolution!r}")
    if column.point is not None:
        for i, value in enumerate(column.point):
            si_amount(value, "m", f"{place}.point[{i}]")
    if column.blows is not None:
        si_amount(column.blows.level, unit, f"{place}.blows.level")
        counted = _counted_unit(column.blows, unit)
        for i, edge in enumerate(column.blows.edges):
            si_amount(edge, counted, f"{place}.blows.edges[{i}]")


def si_amount(value: object, unit: str, place: str) -> float:
    """Return a number of a fit file in SI units, the default; refuse another unit."""
    written = unit.replace("^", "**").replace(" ", "*")
    return in_si(value, written or "1", place)


def reading_noise(column: ColumnSpec, unit: str) -> float:
    """Return the standard deviation of a row, of an encoder with its steps [SI].

    A step of size s rounds by a uniform error, of variance s^2 / 12.
    """
    noise = si_amount(column.sd, unit, "sd")
    if column.sensor == "encoder":
        noise = math.hypot(noise, si_amount(column.resolution, unit, "resolution") / math.sqrt(12.0))
    return noise


def sample_times(column: ColumnSpec, time: Array) -> Array:
    """Return the times at which a run is sampled, for readings at rising times [s].

    Behind a filter these are even steps from zero on, and the last of the times.
    """
    if column.filter is None:
        return time
    count = _PER_PERIOD if column.sensor == "accelerometer" else _PER_PERIOD_OF_VALUES
    step, last = 1.0 / (count * column.filter.corner), float(time[-1])
    return np.append(np.arange(math.ceil(last / step)) * step, last)


def reading(data: xr.Dataset, column: ColumnSpec, unit: str, time: Array) -> Array:
    """Return a sensor's readings at times, (n,), before gain and offset.

    The result is of a run at the :func:`sample_times`; behind a filter further samples in between, such as
    those at events, count too.
    """
    if column.filter is None:
        return _unfiltered(data, column, unit)
    if column.sensor == "accelerometer":
        given = _acceleration(data, column)
    else:
        given = input_of_values(np.asarray(data["time"].values, dtype=float), _unfiltered(data, column, unit))
    return filter_response(given, time, column.filter.corner, column.filter.order)


def _unfiltered(data: xr.Dataset, column: ColumnSpec, unit: str) -> Array:
    """Return a sensor's readings at a result's samples, without a filter."""
    if column.sensor == "accelerometer":
        axes, arms, motion = _sensor_motion(data, column)
        return _dot(axes, _arm_acceleration(motion, arms) - _gravity(data, column))
    if column.sensor == "force-cell":
        loads = joint_loads(data)[column.load or "force"].sel(moving_joint=column.joint).values
        direction = along(column.direction or (0.0, 0.0, 1.0))
        if column.link is None:
            return np.asarray(loads @ direction)
        axes = _motion(data, column.link)[0] @ direction
        return _dot(axes, loads)
    values = np.asarray(quantity(data, str(column.of)).values, dtype=float)
    if column.rounding == "down":  # on average half a step is still to come
        return values - 0.5 * si_amount(column.resolution, unit, "resolution")
    return values


def _acceleration(data: xr.Dataset, column: ColumnSpec) -> _FilterInput:
    """Return the specific force between a result's samples as a filter's input."""
    axes, arms, motion = _sensor_motion(data, column)
    velocity = motion[:, 1] + np.cross(motion[:, 2], arms)
    return input_of_acceleration(
        np.asarray(data["time"].values, dtype=float),
        axes,
        motion[:, 0] + arms,
        velocity,
        _arm_acceleration(motion, arms),
        _gravity(data, column),
    )


def _arm_acceleration(motion: Array, arms: Array) -> Array:
    """Return the acceleration of a point at an arm on a link, (n, 3) [m/s^2]."""
    spin = motion[:, 2]
    turned: Array = np.cross(motion[:, 4], arms) + np.cross(spin, np.cross(spin, arms))
    return motion[:, 3] + turned


def _sensor_motion(data: xr.Dataset, column: ColumnSpec) -> tuple[Array, Array, Array]:
    """Return axis and arm of a sensor, (n, 3), and its link's motion, world axes."""
    attitudes, motion = _motion(data, str(column.link))
    point = [si_amount(value, "m", "point") for value in column.point or (0.0, 0.0, 0.0)]
    return attitudes @ along(column.direction or (0.0, 0.0, 1.0)), attitudes @ np.array(point), motion


def _motion(data: xr.Dataset, link: str) -> tuple[Array, Array]:
    q, v, a = (np.asarray(data[name].values, dtype=float) for name in "qva")
    return link_motion(mechanism_of(data), link, q, v, a)


def _gravity(data: xr.Dataset, column: ColumnSpec) -> Array:
    """Return the gravity that a sensor reads, (3,) [m/s^2]."""
    if column.gravity is False:
        return np.zeros(3)
    return np.asarray(json.loads(data.attrs["mechanism"])["gravity"], dtype=float)


# --- statistics of readings ---------------------------------------------------------------------------------

# The root of n + 3/8 of a count n has a variance of 1/4 (Anscombe 1948, Biometrika 35, 246).
_ANSCOMBE = 0.375
# Independent share of half-overlapping segments under Hann's window: the variance of a mean over K of them is
# 1/K (1 + 2/36) of one alone (Welch 1967, IEEE Trans. Audio 15, 70-73).
_OVERLAP = 1.0 / (1.0 + 2.0 / 36.0)
# Noise bandwidth of Hann's window in lines.
_BANDWIDTH = 1.5


class Target(NamedTuple):
    """Data of a column for comparison."""

    at: Array  # abscissa of each number: a time [s], a band's middle [Hz], a bin's middle
    unit: str  # of the abscissa
    data: Array  # of the record, (numbers,), in the compared measure
    sd: Array  # of each number, in that measure
    measure: str  # as text: ``reading``, ``rms``, ``ln power``, ``2 sqrt(count + 3/8)``


def comparison_target(column: ColumnSpec, unit: str, time: Array, values: Array, place: str) -> Target:
    """Return the data of a record's column for comparison.

    Raises:
        ScenarioError: The record is too short for its segments, has no power in a band, or no impacts.
    """
    if column.spectrum is not None:
        _check_bands(column.spectrum, time, place)
    data = compared_numbers(column, unit, time, values)
    if column.compare in ("curve", "rms"):
        at = time if column.compare == "curve" else np.array([0.5 * (time[0] + time[-1])])
        measure = "reading" if column.compare == "curve" else "rms"
        return Target(at, "s", data, np.full(len(at), reading_noise(column, unit)), measure)
    if column.spectrum is not None:
        edges = np.array(column.spectrum.edges)
        for low, high, value in zip(edges, edges[1:], data, strict=False):
            if not math.isfinite(value):
                raise ScenarioError(
                    f"{place} must have power from {low:g} Hz to {high:g} Hz, got none in the record"
                )
        if column.sd is not None:
            sd = np.full(len(data), si_amount(column.sd, "1", f"{place}.sd"))
        else:
            sd = _band_noise(column.spectrum, time)
        return Target(np.sqrt(edges[:-1] * edges[1:]), "Hz", data, sd, "ln power")
    assert column.blows is not None
    edges, counted = _edges(column.blows, unit)
    if not np.any(data > 2.0 * math.sqrt(_ANSCOMBE)):
        raise ScenarioError(
            f"{place} must have blows above its level in the record, got none between the edges"
        )
    # The model's counts scatter as the record's, where the motion is chaotic.
    sd = np.full(len(data), math.sqrt(2.0))
    return Target(np.sqrt(edges[:-1] * edges[1:]), counted, data, sd, "2 sqrt(count + 3/8)")


def compared_numbers(column: ColumnSpec, unit: str, time: Array, values: Array) -> Array:
    """Return the compared numbers of a curve, of a record or of the model."""
    if column.compare == "rms":
        return np.array([math.sqrt(float(np.mean(values**2)))])
    if column.spectrum is not None:
        return _band_powers(column.spectrum, time, values)
    if column.blows is not None:
        edges, _ = _edges(column.blows, unit)
        counts = _soft_histogram(_blows(column.blows, unit, time, values), edges)
        return 2.0 * np.sqrt(counts + _ANSCOMBE)
    return values


def compared_slopes(column: ColumnSpec, time: Array, values: Array, slopes: Array) -> Array:
    """Return the derivatives of :func:`compared_numbers` over a curve, (numbers, fitted).

    Impacts, which are detected again in each run, have none.
    """
    assert column.blows is None
    if column.compare == "rms":
        return np.asarray(values @ slopes / (len(values) * math.sqrt(float(np.mean(values**2)))))[np.newaxis]
    if column.spectrum is None:
        return slopes
    here, columns = np.exp(_band_powers(column.spectrum, time, values)), []
    for way in slopes.T:
        # Powers are quadratic in a curve: central differences are exact but for round-off.
        largest = float(np.abs(way).max(initial=0.0))
        step = float(np.abs(values).max()) / largest if largest > 0.0 else 1.0
        ahead, behind = (
            np.exp(_band_powers(column.spectrum, time, values + sign * step * way)) for sign in (1, -1)
        )
        columns.append((ahead - behind) / (2.0 * step * here))
    return np.column_stack(columns) if columns else np.zeros((len(here), 0))


def _row_rate(time: Array) -> float:
    return (len(time) - 1) / float(time[-1] - time[0])


def _check_bands(spec: SpectrumSpec, time: Array, place: str) -> None:
    pace, length = _row_rate(time), float(time[-1] - time[0])
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
    """Return the logarithm of the power in each band, (bands,); minus infinity for none."""
    from scipy.signal import welch

    pace = _row_rate(time)
    rows = min(len(values), max(2, round(spec.segment * pace)))
    frequency, density = welch(values, pace, nperseg=rows, detrend="constant")
    # Linear between the lines up to each edge: a band's power follows its edges without jumps.
    total = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(frequency))])
    power = np.diff(np.interp(spec.edges, frequency, total))
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(power))


def _band_noise(spec: SpectrumSpec, time: Array) -> Array:
    """Return the standard deviation of each band's logarithm, of record and model together, (bands,)."""
    segments = max(1.0, 2.0 * float(time[-1] - time[0]) / spec.segment - 1.0) * _OVERLAP
    lines = np.maximum(1.0, np.diff(spec.edges) * spec.segment / _BANDWIDTH)
    return np.asarray(np.sqrt(2.0 / (segments * lines)))


def _counted_unit(spec: BlowsSpec, unit: str) -> str:
    return {"peaks": unit, "intervals": "s", "impulses": f"{unit} s"}[spec.of]


def _edges(spec: BlowsSpec, unit: str) -> tuple[Array, str]:
    counted = _counted_unit(spec, unit)
    return np.array([si_amount(edge, counted, "edges") for edge in spec.edges]), counted


def _blows(spec: BlowsSpec, unit: str, time: Array, values: Array) -> Array:
    """Return the counted number of each impact."""
    level, size = si_amount(spec.level, unit, "level"), np.abs(values)
    above = np.concatenate([[False], size > level, [False]]).astype(int)
    begins, ends = np.flatnonzero(np.diff(above) > 0), np.flatnonzero(np.diff(above) < 0)
    if spec.of == "intervals":
        return np.asarray(np.diff(time[begins]))
    if spec.of == "peaks":
        return np.array([size[i:j].max() for i, j in zip(begins, ends, strict=True)])
    step = 1.0 / _row_rate(time)
    return np.array([size[i:j].sum() * step for i, j in zip(begins, ends, strict=True)])


def _soft_histogram(numbers: Array, edges: Array) -> Array:
    """Return the count of each bin, numbers shared between the two nearest middles."""
    middles = 0.5 * (np.log(edges[1:]) + np.log(edges[:-1]))
    inside = np.log(numbers[(numbers >= edges[0]) & (numbers <= edges[-1])])
    place = np.interp(inside, middles, np.arange(len(middles), dtype=float))
    left = np.minimum(place.astype(int), len(middles) - 2) if len(middles) > 1 else place.astype(int)
    counts = np.zeros(len(middles))
    np.add.at(counts, left, 1.0 - (place - left))
    if len(middles) > 1:
        np.add.at(counts, left + 1, place - left)
    return counts
