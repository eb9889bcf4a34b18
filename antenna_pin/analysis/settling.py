r"""Transition of a joint from impacts to lasting contact.

A joint has *settled* at the instant from which on its bore's contacts (a socket's, of a ball joint) are never
all apart for longer than a given time: :math:`t_s` is the onset of contact that ends the last such interval
longer than the longest gap allowed. It has not settled if one is still open when the run ends, or if what
remains of the run after :math:`t_s` is too short to decide. Times are those of the located onsets and
releases, not of samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike, choose, data_of, floats, sample_times, variable
from antenna_pin.analysis.closures import drives_of
from antenna_pin.analysis.impacts import impacts
from antenna_pin.analysis.sampled import straight_line
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.rules import AtLeastOne, NumberRule
from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory import contacts_of, names_along
from antenna_pin.trajectory.quantities import dataset_of

Kind = Literal["bore", "flanges", "any"]
_LEAST_IMPACTS = 5
_LEAST_R2 = 0.5  # of an exponential, for approach speeds to decay


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Settling:
    """Transition of a joint to lasting contact.

    ``curve`` has over ``window`` (with its middle, ``time``): ``contact_share`` [-], ``impacts`` begun, and
    their ``largest_approach_speed`` and ``mean_approach_speed`` [m/s] (NaN: no impact).
    """

    joint: str  # name of the clearance joint
    contacts: tuple[str, ...]  # its contacts that count
    time: float | None  # of settling [s]; None without it
    note: str  # reason why it did not settle; empty if it did
    longest_gap: float  # longest time without contact that counts as lasting contact [s]
    share_before: float  # share of the time in contact before settling, or of the whole run [-]
    share_after: float  # the same after settling [-]; NaN without it
    last_gap: float  # end of the last interval without contact, however short [s]; NaN without one
    decay_rate: float  # of ln speed at impacts over time [1/s]; NaN for fewer than 5 above the law's floor
    decay_r2: float  # coefficient of determination of that line [-]
    driven: bool  # true if a drive acts on the joint; it may turn the load, and end the contact
    curve: xr.Dataset

    @property
    def decays(self) -> bool | None:
        """True if approach speeds decay, with R2 of a half or more; None: too few."""
        if not np.isfinite(self.decay_r2):
            return None
        return self.decay_rate > 0.0 and self.decay_r2 >= _LEAST_R2


@takes()
def touching_intervals(run: RunLike, contacts: Sequence[str]) -> Array:
    """Return the disjoint intervals in which any of some contacts touches.

    Returns:
        Start and end of each, in order, (n, 2) [s]; the last end is the run's if it still touches then.
    """
    data = data_of(run)
    if not contacts:
        return np.zeros((0, 2))
    known = names_along(data, "contact")
    number = [known.index(choose("touching_intervals", "contact", name, known)[0]) for name in contacts]
    mine = np.isin(variable(data, "episode_contact", "touching_intervals").values, number)
    end = float(sample_times(data, "touching_intervals")[-1])
    onset = floats(data["onset_time"])[mine]
    release = floats(data["release_time"])[mine]
    release = np.where(np.isfinite(release), release, end)
    merged: list[list[float]] = []
    for k in np.argsort(onset, kind="stable"):
        if merged and onset[k] <= merged[-1][1]:
            merged[-1][1] = max(merged[-1][1], float(release[k]))
        else:
            merged.append([float(onset[k]), float(release[k])])
    return np.array(merged).reshape(-1, 2)


@takes(longest_gap="s", least_duration="s")
def settling(
    run: RunLike,
    joint: str | None = None,
    *,
    longest_gap: Annotated[float, NumberRule("zero or more", finite=False)] = 1e-3,
    least_duration: float | None = None,
    windows: AtLeastOne = 50,
    contacts: Kind = "bore",
) -> tuple[Settling, ...]:
    """Return the transition of each clearance joint to lasting contact.

    Args:
        run: A run, or its data.
        joint: Name of a clearance joint; all of them if left out.
        longest_gap: Longest time without contact that counts as lasting contact [s]; 0: it never parts again.
        least_duration: Time that must remain after settling [s]; if left out, a twentieth of the run, or ten
            longest gaps if they are longer.
        windows: Number of windows of the curve.
        contacts: Which count: those of the "bore" (or socket), of the "flanges", or "any".

    Returns:
        One per clearance joint; none if the run has no clearance joint.
    """
    if contacts not in ("bore", "flanges", "any"):
        raise InvalidParameterError("settling", "contacts", "'bore', 'flanges' or 'any'", contacts)
    data = data_of(run)
    result = []
    for name in choose("settling", "clearance joint", joint, names_along(data, "clearance_joint")):
        flanges = None if contacts == "any" else contacts == "flanges"
        own = tuple(contacts_of(data, name, flanges=flanges))
        result.append(_settling(data, name, own, longest_gap, least_duration, windows))
    return tuple(result)


def _settling(
    data: xr.Dataset,
    joint: str,
    contacts: tuple[str, ...],
    longest_gap: float,
    least_duration: float | None,
    windows: int,
) -> Settling:
    time = sample_times(data, "settling")
    start, end = float(time[0]), float(time[-1])
    least = max(0.05 * (end - start), 10.0 * longest_gap) if least_duration is None else least_duration
    touching = touching_intervals(data, contacts)
    gaps = np.column_stack(
        [np.concatenate([[start], touching[:, 1]]), np.concatenate([touching[:, 0], [end]])]
    )
    gaps = gaps[gaps[:, 1] > gaps[:, 0]]
    long = gaps[gaps[:, 1] - gaps[:, 0] > longest_gap]
    settled: float | None = float(long[-1, 1]) if long.size else start
    note = ""
    if end == start:
        settled, note = None, "one sample is no time to settle in"
    elif not touching.size:
        settled, note = None, "it never touches"
    elif long.size and long[-1, 1] == end:
        settled, note = None, f"it is apart for {1e3 * (end - long[-1, 0]):.3g} ms when the run ends"
    elif settled is not None and end - settled < least:
        left = f"only {1e3 * (end - settled):.3g} ms of {1e3 * least:.3g} ms needed to decide"
        settled, note = None, f"{left} remain after {settled:.4g} s"
    table = impacts(data, joint)
    table = table.isel(impact=np.flatnonzero(np.isin(table["contact"].values, contacts)))
    rate, fit = _decay(table)
    middle = end if settled is None else settled
    return Settling(
        joint=joint,
        contacts=contacts,
        time=settled,
        note=note,
        longest_gap=longest_gap,
        share_before=_share(touching, start, middle),
        share_after=float("nan") if settled is None else _share(touching, settled, end),
        last_gap=float(gaps[-1, 1]) if gaps.size else float("nan"),
        decay_rate=rate,
        decay_r2=fit,
        driven=any(drive["joint"] == joint for drive in drives_of(data).values()),
        curve=_curve(table, touching, np.linspace(start, end, windows + 1)),
    )


def _share(touching: Array, start: float, end: float) -> float:
    """Return the share of a span in contact; NaN of none."""
    if not end > start:
        return float("nan")
    inside = np.clip(touching, start, end)
    return float((inside[:, 1] - inside[:, 0]).sum() / (end - start))


def _decay(table: xr.Dataset) -> tuple[float, float]:
    """Return rate and coefficient of determination of exponentially falling approach speeds."""
    speed = table["approach_speed"].values
    counted = ~table["floored"].values & (speed > 0.0)
    x, y = table["onset"].values[counted], np.log(speed[counted])
    if x.size < _LEAST_IMPACTS or np.ptp(x) == 0.0 or np.ptp(y) == 0.0:
        return float("nan"), float("nan")
    slope, fit = straight_line(x, y)
    return -slope, fit


def _curve(table: xr.Dataset, touching: Array, edges: Array) -> xr.Dataset:
    count = edges.size - 1
    share = np.array([_share(touching, *edges[k : k + 2]) for k in range(count)])
    where = np.clip(np.searchsorted(edges, table["onset"].values, side="right") - 1, 0, count - 1)
    begun = np.bincount(where, minlength=count)
    largest, mean = np.full(count, np.nan), np.full(count, np.nan)
    for k in np.unique(where):
        speed = table["approach_speed"].values[where == k]
        largest[k], mean[k] = speed.max(), speed.mean()
    middle = 0.5 * (edges[1:] + edges[:-1])
    columns = {"contact_share": share, "impacts": begun}
    columns |= {"largest_approach_speed": largest, "mean_approach_speed": mean}
    coords = {"time": ("window", middle, {"units": "s", "long_name": "middle of the window"})}
    return dataset_of("settling curve", columns, coords)
