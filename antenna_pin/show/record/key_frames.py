"""Key frames of a recording: samples at a regular rate, and every impact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis import body_twists
from antenna_pin.base.arguments import check_number

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# Largest turn of a body between two key frames [rad]; number of samples that determine its rate; quantile of
# the rates that counts, so that short spins after impacts do not.
_TURN, _SAMPLES, _SHARE = 0.1, 500, 0.99


@dataclass(frozen=True, slots=True, eq=False)
class Impacts:
    """Contact episodes within the span of a recording, by the time of their peak."""

    times: Array  # of the largest force, (episodes,) [s]
    peaks: Array  # largest normal force, (episodes,) [N]
    contacts: NDArray[np.int64]  # index of the contact, (episodes,)
    events: Array  # onsets, peaks and releases of the episodes, (3, episodes) [s]; NaN where a contact lasts

    def hardest(self, otherwise: float) -> float:
        """Return the time of the hardest peak [s], or another without impacts."""
        return float(self.times[np.argmax(self.peaks)]) if len(self.times) else otherwise

    def only(self, chosen: Indices) -> Impacts:
        """Return some of the episodes, by their indices, in order of time."""
        kept = np.sort(chosen)
        return Impacts(self.times[kept], self.peaks[kept], self.contacts[kept], self.events[:, kept])


@dataclass(frozen=True, slots=True, eq=False)
class KeyFrames:
    """Samples of a recording."""

    indices: Indices  # samples of the run, times strictly increasing, (frames,)
    rate: float  # regular frames per second [Hz]
    impacts: Impacts  # impacts with onset, peak and release among the samples
    left_out: int = 0  # number of weakest impacts left out to meet a limit


def impacts_of(data: xr.Dataset, start: float, end: float) -> Impacts:
    """Return episodes with their peak in a span [s], in order of time."""
    if "peak_time" not in data or not data.sizes.get("episode"):
        return Impacts(np.zeros(0), np.zeros(0), np.zeros(0, dtype=np.int64), np.zeros((3, 0)))
    times = np.asarray(data["peak_time"].values, dtype=float)
    order = np.argsort(times, kind="stable")
    order = order[(times[order] >= start) & (times[order] <= end)]
    onset, release = (np.asarray(data[name].values, dtype=float) for name in ("onset_time", "release_time"))
    return Impacts(
        times=times[order],
        peaks=np.asarray(data["peak_force"].values, dtype=float)[order],
        contacts=np.asarray(data["episode_contact"].values, dtype=np.int64)[order],
        events=np.array([onset[order], times[order], release[order]]),
    )


def rate_of_turns(data: xr.Dataset) -> float:
    """Return the frame rate at which bodies turn little between frames [Hz]."""
    samples = np.unique(np.linspace(0, data.sizes["time"] - 1, _SAMPLES).astype(int))
    spin = np.linalg.norm(body_twists(data, samples)["angular_velocity"].values, axis=-1)
    return float(np.quantile(spin, _SHARE, axis=0).max()) / _TURN


def key_frames(
    times: Array, impacts: Impacts, rate: float, start: float, end: float, most: int | None = None
) -> KeyFrames:
    """Choose the samples of a recording from ``start`` to ``end`` [s].

    They are the samples nearest to a regular rate [Hz], and those at every onset, peak and release of a
    contact. Where that is more than ``most``, first the rate is lowered, down to a quarter of ``most``; then
    impacts are left out, the weakest first. Times of samples do not decrease.
    """
    check_number("recording", "fps", rate, "positive", "1/s")
    low, high = np.searchsorted(times, start, "left"), np.searchsorted(times, end, "right")
    inside = times[low:high]
    # Of samples at one instant the first; times do not go back, so that they need not be sorted.
    first = np.flatnonzero(np.concatenate([np.ones(min(inside.size, 1), bool), inside[1:] > inside[:-1]]))
    distinct = inside[first]
    first += low
    events = _nearest(distinct, impacts.events)
    kept = _choose(distinct, events, rate)
    if most is None or len(kept) <= most:
        return KeyFrames(first[kept], rate, impacts)
    room = max(most - len(np.unique(events)), most // 4, 2)
    rate = min(rate, (room - 1) / float(distinct[-1] - distinct[0]))
    chosen = np.argsort(-impacts.peaks, kind="stable")
    if len(np.unique(events)) + room > most:
        chosen = chosen[: max(most - room, 0) // 3]
    kept = _choose(distinct, events[:, chosen], rate)
    return KeyFrames(first[kept], rate, impacts.only(chosen), len(impacts.times) - len(chosen))


def _nearest(times: Array, wanted: Array) -> Indices:
    """Return indices of the samples nearest to times, the last for NaN."""
    upper = np.clip(np.searchsorted(times, wanted), 1, max(len(times) - 1, 1))
    lower = upper - 1
    upper = np.minimum(upper, len(times) - 1)
    return np.where(np.abs(times[lower] - wanted) <= np.abs(times[upper] - wanted), lower, upper)


def _choose(times: Array, events: Indices, rate: float) -> Indices:
    count = int(np.ceil((times[-1] - times[0]) * rate)) + 1
    if count >= len(times):
        return np.arange(len(times))
    regular = _nearest(times, np.linspace(times[0], times[-1], max(count, 2)))
    return np.unique(np.concatenate([regular, events.ravel()]))
