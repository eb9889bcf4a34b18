"""Curves under a recording's slider: series of the run, thinned without loss of peaks."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.analysis import Quantity, QuantityName, quantities, quantity
from antenna_pin.base.readable import printed_unit
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.show.record.scene import packed_doubles
from antenna_pin.trajectory import Trajectory

Array = NDArray[np.float64]

# What is offered by itself: variables in this order, then others as the run has them. So many series, by the
# bytes that they may take.
_FIRST = """
    contact_force motion_angle slide_position motion_rate slide_rate drive_torque element_effort
    joint_force closure_force coupling_torque motion_acceleration gap journal_tilt kinetic_energy
""".split()
_FEWEST, _MOST = 4, 40
# Variables that stand in a result for others to use, or that bodies show by themselves.
_NOT = ("q", "v", "a", "base_attitude", "journal_attitude", "contact_point")
_BYTES = 2 * 8 * 4 / 3  # of a sample, its time and its value in base64
_SAMPLES = (200, 1000)  # of a series, at least and at most
_OFF = 1e-4  # of the range, by which no sample may be off the curve
# Largest number of samples that are all compared; number of stretches whose extremes are compared beyond it.
_ALL, _STRETCHES = 200_000, 20_000


def curves_of(
    run: Trajectory,
    start: float,
    end: float,
    *,
    ideal: Trajectory | None = None,
    wanted: Iterable[str] | None = None,
    joint: str | None = None,
    megabytes: float = 1.0,
) -> dict[str, Any]:
    """Return the series of a page in a span, and the first one displayed.

    Times and values are those of the run's samples to the last bit.

    Args:
        run: The run.
        start: Start of the recording [s].
        end: End of the recording [s].
        ideal: A run whose series of the same names stand beside, where it has them.
        wanted: Names of quantities (:func:`antenna_pin.analysis.quantity`) that come first; no series at
            all if empty, the strongest contact's force first if left out.
        joint: Clearance joint whose series alone are offered by default; all if left out.
        megabytes: Largest size [MB].

    Raises:
        UnknownNameError: The run has no such quantity.
        InvalidParameterError: A name leaves open which quantity it is.
    """
    asked = None if wanted is None else [quantity(run, name).name for name in wanted]
    if asked is not None and not asked:
        return {"series": [], "first": 0}
    # Values are read again where they are drawn: those of a long run are not all held at once.
    found, peaks = list(asked or ()), dict[int, float]()
    room = 1e6 * megabytes / _BYTES / _SAMPLES[0]  # series, with the fewest samples each
    room = min(max(room, _FEWEST), _MOST)
    for name in _offered(run, joint):
        if len(found) >= room:
            break
        values = quantity(run, name).values
        if name not in found and _moves(values):
            if name.startswith("|contact_force"):
                peaks[len(found)] = float(np.nanmax(values))
            found.append(name)
    beside = [ideal is not None and _same(ideal, name) is not None for name in found]
    most = int(np.clip(1e6 * megabytes / _BYTES / max(len(found) + sum(beside), 1), *_SAMPLES))
    series = [_packed(run, quantity(run, name), start, end, most) for name in found]
    for packed, name, is_beside in zip(series, found, beside, strict=True):
        other = _same(ideal, name) if is_beside and ideal is not None else None
        drawn = {} if other is None else _drawn(other, start, end, most)
        if drawn.get("samples", 0) > 1:
            packed["ideal"] = drawn
    first = 0 if asked else max(peaks, key=lambda k: peaks[k], default=0)
    return {"series": series, "first": first}


def thinned(times: Array, values: Array, most: int) -> tuple[NDArray[np.intp], float]:
    """Return at most ``most`` samples that draw a curve, and the largest error.

    The curve is straight between them, 4 at least. To the ends and the least and greatest of all, the sample
    farthest off is added (Ramer, Douglas and Peucker, along the values), until no other is off by
    more than a ten-thousandth of the range, or there are enough. Beside a blow the samples of zero are added:
    the straight line from peak to peak would be a force where there is none. Times do not decrease, (n,) [s].
    """
    every = np.arange(len(times))
    if len(times) <= 4:
        return every, 0.0
    known = np.flatnonzero(np.isfinite(values))
    if len(known) < len(times):  # a gap would have no least or greatest
        kept = _extremes(times, values, most // 4)
    else:
        some = every
        if len(times) > _ALL:
            peaks = _extremes(times, values, _STRETCHES)
            some = np.unique(np.clip(np.concatenate([peaks - 1, peaks, peaks + 1]), 0, len(times) - 1))
        order = some[_farthest_first(times[some], values[some], most)]
        kept, fewest, count = np.unique(order[:4]), 4, len(order)
        while fewest <= count:  # as many of the first as leave room for the rests beside them
            middle = (fewest + count) // 2
            tried = _with_rests(values, order[:middle])
            if len(tried) <= most:
                kept, fewest = tried, middle + 1
            else:
                count = middle - 1
    sure = kept[np.isfinite(values[kept])]
    once = known[np.append(True, np.diff(times[known]) > 0.0) & np.append(np.diff(times[known]) > 0.0, True)]
    off = np.abs(np.interp(times[once], times[sure], values[sure]) - values[once])
    return kept, float(off.max(initial=0.0))


def _farthest_first(times: Array, values: Array, most: int) -> NDArray[np.intp]:
    """Return the samples that draw a curve in the order of their addition."""
    kept = sorted({0, int(np.argmin(values)), int(np.argmax(values)), len(times) - 1})
    waiting: list[tuple[float, int, int, int]] = []
    least = _OFF * float(np.ptp(values))

    def look(begin: int, end: int) -> None:
        """Note the sample between two that lies farthest off the line through them."""
        if end - begin < 2:
            return
        span = times[end] - times[begin]
        inside = slice(begin + 1, end)
        share = (times[inside] - times[begin]) / span if span > 0.0 else np.zeros(end - begin - 1)
        off = abs(values[begin] + share * (values[end] - values[begin]) - values[inside])
        k = int(off.argmax())
        if off[k] > least:
            heapq.heappush(waiting, (-float(off[k]), begin, begin + 1 + k, end))

    for begin, end in itertools.pairwise(kept):
        look(begin, end)
    while waiting and len(kept) < most:
        _, begin, middle, end = heapq.heappop(waiting)
        kept.append(middle)
        look(begin, middle)
        look(middle, end)
    return np.array(kept)


def _with_rests(values: Array, chosen: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return sorted samples, with nearby rests that the line would miss."""
    chosen = np.unique(chosen)
    rest = np.abs(values) <= _OFF * float(np.ptp(values))
    places = np.arange(len(values))
    before = np.maximum.accumulate(np.where(rest, places, -1))  # the last at rest up to each sample
    after = np.minimum.accumulate(np.where(rest, places, len(values))[::-1])[::-1]
    left, right = chosen[:-1], chosen[1:]
    passed = after[left] < right
    return np.unique(np.concatenate([chosen, after[left][passed], before[right][passed]]))


def _extremes(times: Array, values: Array, stretches: int) -> NDArray[np.intp]:
    """Return extremes of stretches of time, its ends, and ends of gaps."""
    edges = np.searchsorted(times, np.linspace(times[0], times[-1], max(stretches, 1) + 1)[1:-1])
    known = np.isfinite(values)
    low, high = np.where(known, values, np.inf), np.where(known, values, -np.inf)
    kept = [0, len(times) - 1]
    for first, last in zip([0, *edges], [*edges, len(times)], strict=True):
        if first == last:
            continue
        kept += [first + int(np.argmin(low[first:last])), first + int(np.argmax(high[first:last]))]
        if not known[first:last].all():
            kept.append(first + int(np.argmin(known[first:last])))
    return np.unique(kept)


def _offered(run: Trajectory, joint: str | None) -> Iterator[str]:
    """Yield names of quantities in order of interest, of vectors the length."""
    ranked: list[tuple[int, int, str]] = []
    for number, name in enumerate(quantities(run)):
        said = QuantityName.parse(name)
        recorded = said.variable in run.data.data_vars
        vector = recorded and run.data[said.variable].dims[-1] in ("axis", "quaternion")
        if not recorded or said.variable in _NOT or (vector and not said.size):
            continue
        if joint is not None and not any(one == joint or one.startswith(f"{joint}.") for one in said.labels):
            continue
        rank = _FIRST.index(said.variable) if said.variable in _FIRST else len(_FIRST)
        ranked.append((rank, number, name))
    for _, _, name in sorted(ranked):
        yield name


def _moves(values: Array) -> bool:
    some = values[np.isfinite(values)]
    return bool(some.size) and bool(np.ptp(some) > 0.0)


def _same(ideal: Trajectory, name: str) -> Quantity | None:
    """Return a run's quantity; None if it has none, as without play."""
    try:
        return quantity(ideal, name)
    except (UnknownNameError, InvalidParameterError):
        return None


def _drawn(one: Quantity, start: float, end: float, most: int) -> dict[str, Any]:
    """Return a quantity's drawn samples, their number, and the largest error."""
    inside = (one.time >= start) & (one.time <= end)
    times, values = one.time[inside], np.asarray(one.values, dtype=float)[inside]
    kept, off = thinned(times, values, most)
    return {
        "samples": len(times),
        "off": off,
        "times": packed_doubles(times[kept]),
        "values": packed_doubles(values[kept]),
    }


def _packed(run: Trajectory, one: Quantity, start: float, end: float, most: int) -> dict[str, Any]:
    said = QuantityName.parse(one.name)
    unit = printed_unit(one.units)
    bracket = f" [{unit}]" if unit else ""
    group, text = "others", f"{one.name}{bracket}"
    if said.variable in run.data.data_vars:
        meaning = str(run.data[said.variable].attrs.get("long_name", said.variable)).partition(" (")[0]
        group, text = "of the whole", f"{meaning}{bracket}"
        if said.labels:
            group, text = text, f"{', '.join(said.labels)}: {text}"
    about = {"name": one.name, "group": group, "text": text, "unit": unit}
    return {**about, **_drawn(one, start, end, most)}
