"""Runs in figures: label, samples, ideal or with play, blows of a joint."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeAlias, cast

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis import between_samples, spectrum
from antenna_pin.errors import AntennaPinError, FileFormatError, InvalidParameterError
from antenna_pin.show.plot._style import IDEAL, MANY, Array, distinct
from antenna_pin.trajectory import contacts_of, elements_of, names_along, series
from antenna_pin.trajectory.schema import VARIABLES


class Recorded(Protocol):
    """A run, or what has the data of one as a run has them."""

    @property
    def data(self) -> xr.Dataset:
        """The samples."""
        ...


Run: TypeAlias = Recorded | tuple[str, xr.Dataset | Recorded]
Runs: TypeAlias = Iterable[Run] | Run


@dataclass(frozen=True, slots=True, eq=False)
class LabelledRun:
    """Run in a figure."""

    label: str  # name in legends
    data: xr.Dataset  # samples, with the scenario among their attributes if it is known
    source: xr.Dataset  # dataset as given
    kept: NDArray[np.int_] | None = None  # indices of the samples in ``data``, if not all
    all: LabelledRun | None = None  # run with all samples, if ``data`` has not all

    @property
    def whole(self) -> LabelledRun:
        """The run with all its samples."""
        return self if self.all is None else self.all

    @property
    def many(self) -> bool:
        """Return whether lines of the run are drawn as pixels in a vector file."""
        return int(self.whole.data.sizes["time"]) > MANY

    @property
    def ideal(self) -> bool:
        """True where neither a joint nor a gear has play."""
        return self.data.sizes.get("contact", 0) == 0 and not _backlash(self.data)

    @property
    def legend(self) -> str:
        """The label as legends print it."""
        return f"{self.label} (ideal)" if self.ideal and "ideal" not in self.label else self.label

    @property
    def time(self) -> Array:
        """Sample times [s], (n,)."""
        return np.asarray(self.data["time"].values, dtype=float)

    @property
    def clearance_joints(self) -> list[str]:
        """Names of the joints with clearance."""
        return names_along(self.data, "clearance_joint")

    @property
    def joints(self) -> list[str]:
        """Names of the joints that turn about an axis."""
        return names_along(self.data, "joint")

    @property
    def sliding_joints(self) -> list[str]:
        """Names of the joints that slide along their axis."""
        return names_along(self.data, "sliding_joint")

    @property
    def contacts(self) -> list[str]:
        """Names of the contacts, such as ``elevation.radial+``."""
        return names_along(self.data, "contact")

    def contacts_of(self, joint: str, *, flanges: bool | None = None) -> list[str]:
        """Return the contacts of a joint: all, at flanges, or in the bore."""
        return contacts_of(self.data, joint, flanges=flanges)

    def values(self, name: str, **where: str) -> Array:
        """Return a variable as floats, at the labels given."""
        if name not in self.data:
            raise FileFormatError(f"run {self.label}: no variable {name!r}; is it an antenna_pin result?")
        picked = self.data[name].sel(where) if where else self.data[name]
        return np.asarray(picked.values, dtype=float)

    def unit(self, name: str) -> str:
        """Return the unit of a variable, by default the catalogue's."""
        return str(self.data[name].attrs.get("units", unit_of(name))) if name in self.data else unit_of(name)


def unit_of(variable: str, slides: bool = False) -> str:
    """Return the catalogue's unit of a variable, or of one that slides."""
    row = VARIABLES[variable]
    return row.sliding if slides and row.sliding else row.units


def _backlash(data: xr.Dataset) -> bool:
    """Return whether a gear has play: flanks touch at two deflections."""
    gears = [one["numbers"] for place, one in elements_of(data).items() if place.startswith("gears.")]
    return any(one["plus"] > one["minus"] for one in gears if {"plus", "minus"} <= set(one))


def samples_of(run: Run) -> xr.Dataset:
    """Return the samples of a run, however it was given."""
    given = run[1] if isinstance(run, tuple) else run
    return given if isinstance(given, xr.Dataset) else given.data


def labelled(runs: Runs) -> list[LabelledRun]:
    """Return runs with distinct labels; repeated labels get numbers.

    Raises:
        InvalidParameterError: There is no run, or none of two samples.
    """
    pair = isinstance(runs, tuple) and len(runs) == 2 and isinstance(runs[0], str)
    every = cast("Iterable[Run]", [runs] if pair or hasattr(runs, "data") else runs)
    result: list[LabelledRun] = []
    for number, run in enumerate(every, start=1):
        label, given = run if isinstance(run, tuple) else ("", run)
        data = series(samples_of(run), "figure")
        label = label or str(data.attrs.get("case") or "") or f"run {number}"
        source, scenario = data, getattr(given, "scenario", None)
        if scenario is not None and "scenario" not in data.attrs:  # a file has it there
            data = data.assign_attrs(scenario=scenario.model_dump_json())
        copies = sum(other.label == label or other.label.startswith(f"{label} (") for other in result)
        result.append(LabelledRun(f"{label} ({copies + 1})" if copies else label, data, source))
    if not result:
        raise InvalidParameterError("figure", "runs", "at least one run", "none")
    if all(run.time.size < 2 for run in result):
        ends = (f"{run.label} ({run.data.attrs.get('outcome', 'unknown outcome')})" for run in result)
        rule = "at least one run of two samples or more"
        raise InvalidParameterError("figure", "runs", rule, f"single samples from {', '.join(ends)}")
    return result


def too_short(runs: Sequence[LabelledRun]) -> str:
    """Return a note naming the runs that are too short to be lines, or nothing."""
    names = [run.label for run in runs if run.time.size < 2]
    return f"not drawn, one sample only: {', '.join(names)}" if names else ""


def long_enough(runs: Sequence[LabelledRun]) -> list[LabelledRun]:
    """Return the runs that hold two samples or more."""
    return [run for run in runs if run.time.size > 1]


def with_reference(runs: Runs, ideal: Run | None) -> tuple[list[LabelledRun], LabelledRun | None]:
    """Return the runs and the reference: the given run, else the first ideal one."""
    every = labelled(runs)
    reference = labelled([ideal])[0] if ideal is not None else next((r for r in every if r.ideal), None)
    if reference is not None and ideal is not None:
        same = next((run for run in every if run.source is reference.source), None)
        if same is None:
            every.insert(0, reference)
        else:
            reference = same
    return every, reference if reference is not None and reference.time.size > 1 else None


def smooth(run: LabelledRun, joint: str) -> LabelledRun:
    """Return a run of few samples with a joint's motion between them (``between_samples``)."""
    if not 2 <= run.time.size <= MANY:
        return run
    return replace(run, data=between_samples(run.data, joint))


def styles(runs: Sequence[LabelledRun], reference: LabelledRun | None) -> list[dict[str, Any]]:
    """Return the looks of lines, the reference black and dashed."""
    numbers = itertools.count()
    return [IDEAL if run is reference else {**distinct(next(numbers)), "linewidth": 0.7} for run in runs]


def spectrum_of(run: LabelledRun, values: Array) -> xr.Dataset:
    """Return a spectrum in windows of half a run, or in one window."""
    try:
        return spectrum(run.time, values, segment=0.5 * float(run.time[-1] - run.time[0]))
    except AntennaPinError:
        return spectrum(run.time, values)


def left_out(runs: Sequence[LabelledRun], drawn: Sequence[LabelledRun], why: str) -> str:
    """Return a note on runs left out for a reason, or nothing."""
    shown = {run.label for run in drawn}
    names = [run.label for run in runs if run.label not in shown and run.time.size > 1]
    return f"not drawn, {why}: {', '.join(names)}" if names else ""


# --- blows: which peaks are marked, and the strongest ---

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
    """Strongest blow of a joint in a run."""

    contact: str  # contact with the largest force
    time: float  # time of that force [s]
    force: float  # that force [N]
    window: tuple[float, float]  # span of its close view [s]
    touching: tuple[str, ...]  # contacts that exert a force in the window


def episodes_of(run: LabelledRun, contacts: list[str]) -> NDArray[np.bool_]:
    """Return which contact episodes of a run are of some contacts, (episodes,)."""
    if run.data.sizes.get("episode", 0) == 0:
        return np.zeros(0, dtype=bool)
    index = run.values("episode_contact").astype(int)
    return np.isin(index, [run.contacts.index(name) for name in contacts])


def sharp(run: LabelledRun, curve: LabelledRun) -> NDArray[np.bool_]:
    """Return a mask of episodes whose peak is narrower than a line shows, (episodes,).

    A lasting contact's smooth maximum, at half its height wider than ten samples of the run, needs no mark.
    Forces are those of ``curve``, the run as its lines are drawn.
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
    """Return a mask of peaks with forces below a level on both sides."""
    first = np.searchsorted(time, at - half)
    middle = np.searchsorted(time, at)
    last = np.searchsorted(time, at + half, side="right")
    sides = zip(first, middle, last, level, strict=True)
    before_and_behind = ((force[a:b], force[b:c], limit) for a, b, c, limit in sides)
    lows = [max(one.min(initial=np.inf) for one in both) < limit for *both, limit in before_and_behind]
    return np.array(lows, dtype=bool)


def strongest_blow(run: LabelledRun, curve: LabelledRun, joint: str) -> Blow | None:
    """Return the blow with the largest normal force in a joint, or None."""
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
    """Return the span around a time in which a force stays above a level [s]."""
    middle = int(np.searchsorted(time, at))
    low = np.flatnonzero(force < level)
    before, behind = low[low < middle], low[low > middle]
    first = int(before[-1]) if before.size else 0
    last = int(behind[0]) if behind.size else time.size - 1
    return float(time[first]), float(time[last])
