"""Blows of a joint as figures draw them: which peaks are marked, and a close view of the strongest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from antenna_pin.plot._runs import LabelledRun
from antenna_pin.plot._style import MANY, PEAK, Array, distinct, few_ticks, prefixed

__all__ = ["Blow", "draw_blow", "episodes_of", "sharp", "strongest_blow"]

#: A peak that is wider at half its height than so many samples is smooth: the line shows it by itself.
_SMOOTH = 10.0
# A blow is in view while its force is more than this share of its peak.
_SEEN = 0.03
# No more of a blow is in view than this on either side of its peak, over its width at half the height.
_LONGEST = 4.0
# What is seen before and behind a blow, over its length.
_MARGIN = 0.6


@dataclass(frozen=True, slots=True)
class Blow:
    """The strongest blow of a joint in a run.

    Attributes:
        contact: Name of the contact that takes most.
        time: Of the largest force [s].
        force: That force [N].
        window: What of the run shows it [s].
        touching: Names of the contacts that exert a force in the window.
    """

    contact: str
    time: float
    force: float
    window: tuple[float, float]
    touching: tuple[str, ...]


def episodes_of(run: LabelledRun, contacts: list[str]) -> NDArray[np.bool_]:
    """Return which contact episodes of a run are of some contacts, (episodes,)."""
    if run.data.sizes.get("episode", 0) == 0:
        return np.zeros(0, dtype=bool)
    index = run.values("episode_contact").astype(int)
    return np.isin(index, [run.contacts.index(name) for name in contacts])


def sharp(run: LabelledRun, curve: LabelledRun) -> NDArray[np.bool_]:
    """Return which contact episodes have a peak that a line over the whole run hides, (episodes,).

    A lasting contact's smooth maximum, at half its height wider than ten samples, needs no mark: the line
    shows it.

    Args:
        run: All of it.
        curve: As its lines are drawn.
    """
    if run.data.sizes.get("episode", 0) == 0:
        return np.zeros(0, dtype=bool)
    peak, at = run.values("peak_force"), run.values("peak_time")
    found = np.isfinite(peak) & np.isfinite(at)
    if "normal_force" not in curve.data:
        return found
    index = run.values("episode_contact").astype(int)
    time, force = curve.time, curve.values("normal_force")
    half = 0.5 * _SMOOTH * float(np.median(np.diff(run.time[:MANY])))
    for contact in np.unique(index[found]):
        mine = np.flatnonzero(found & (index == contact))
        found[mine] = _narrow(time, force[:, contact], at[mine], half, 0.5 * peak[mine])
    return found


def _narrow(time: Array, force: Array, at: Array, half: float, level: Array) -> NDArray[np.bool_]:
    """Return whether a force is below a level somewhere within half a width before and behind an instant."""
    first = np.searchsorted(time, at - half)
    middle = np.searchsorted(time, at)
    last = np.searchsorted(time, at + half, side="right")
    sides = zip(first, middle, last, level, strict=True)
    return np.array(
        [
            force[a:b].min(initial=np.inf) < limit and force[b:c].min(initial=np.inf) < limit
            for a, b, c, limit in sides
        ],
        dtype=bool,
    )


def strongest_blow(run: LabelledRun, curve: LabelledRun, joint: str) -> Blow | None:
    """Return the blow with the largest normal force of one contact of a joint; None if it took none.

    Args:
        run: All of it.
        curve: As its lines are drawn.
        joint: The joint with play.
    """
    names = run.contacts_of(joint)
    blows = np.flatnonzero(episodes_of(run, names) & sharp(run, curve)) if names else np.empty(0, int)
    if not blows.size or "normal_force" not in curve.data:
        return None
    peaks = run.values("peak_force")[blows]
    hardest = blows[int(np.argmax(peaks))]
    contact = run.contacts[int(run.values("episode_contact")[hardest])]
    at, peak = float(run.values("peak_time")[hardest]), float(peaks.max())
    time, force = curve.time, curve.values("normal_force", contact=contact)
    width = np.subtract(*_above(time, force, at, 0.5 * peak)[::-1])
    start, end = _above(time, force, at, _SEEN * peak)
    start, end = max(start, at - _LONGEST * width), min(end, at + _LONGEST * width)
    if not end > start:  # the force was not sampled while it lasted
        return None
    room = _MARGIN * (end - start)
    window = max(start - room, float(time[0])), min(end + room, float(time[-1]))
    seen = (time >= window[0]) & (time <= window[1])
    touching = tuple(name for name in names if np.any(curve.values("normal_force", contact=name)[seen] > 0.0))
    return Blow(contact, at, peak, window, touching)


def _above(time: Array, force: Array, at: float, level: float) -> tuple[float, float]:
    """Return from when to when a force is above a level without a break around an instant [s]."""
    middle = int(np.searchsorted(time, at))
    low = np.flatnonzero(force < level)
    before, behind = low[low < middle], low[low > middle]
    first = int(before[-1]) if before.size else 0
    last = int(behind[0]) if behind.size else time.size - 1
    return float(time[first]), float(time[last])


def draw_blow(axes: Axes, curve: LabelledRun, blow: Blow, names: dict[str, str]) -> None:
    """Draw normal forces of the contacts in a blow, over the time from its peak on.

    Args:
        axes: Where.
        curve: Of the run, as its lines are drawn.
        blow: What is in view.
        names: What contacts are called in the legend.
    """
    seen = np.flatnonzero((curve.time >= blow.window[0]) & (curve.time <= blow.window[1]))
    seen = np.arange(max(seen[0] - 1, 0), min(seen[-1] + 2, curve.time.size))
    factor, unit = prefixed("s", blow.window[1] - blow.window[0])
    scale, printed = prefixed("N", blow.force)
    time = factor * (curve.time[seen] - blow.time)
    for number, name in enumerate(names):
        if name not in blow.touching:
            continue
        force = scale * curve.values("normal_force", contact=name)[seen]
        look = {**distinct(number), "linewidth": 1.0}
        axes.plot(time, force, label=names[name], **look)
    axes.plot(0.0, scale * blow.force, ".", markersize=4.0, color=PEAK, markeredgewidth=0.0, zorder=4)
    axes.set_xlim(*(factor * (edge - blow.time) for edge in blow.window))
    axes.set_ylim(bottom=0.0)
    few_ticks(axes, 5)
    axes.set_xlabel(f"time from {blow.time:.6g} s on [{unit}]")
    axes.set_ylabel(f"normal force [{printed}]")
