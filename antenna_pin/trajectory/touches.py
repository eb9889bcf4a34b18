"""Touches of stops and gears, changes of latches, and blows of joints.

It is read from the run's changes of mode, the torque in a touch too; of a rigid stop at rest from samples.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.trajectory.read import contact_joints, contact_kinds, is_lean, names_along

if TYPE_CHECKING:
    import xarray as xr


class ModeChange(NamedTuple):
    """Change of mode of an element."""

    element: str  # its place, as ``stops.hinge``
    what: str  # such as ``lower: on``
    time: float  # [s]
    angle: float  # of the joint then [rad] ([m])
    rate: float  # before [rad/s] ([m/s])
    rate_after: float  # [rad/s] ([m/s])
    loss: float  # energy lost; of a release, since the onset [J]
    impulse: float  # on the child; of a release, since the onset [N m s] ([N s])
    energy: float  # of the joint's own motion before, of a latch [J]; NaN of others
    peak_effort: float  # of the touch that ends, or lasts from here to the end [N m] ([N]); else NaN


@dataclass(frozen=True, slots=True, kw_only=True)
class Touch:
    """Touch of a stop; a blow of a rigid one lasts no time.

    Numbers at or up to the release are NaN of a touch that lasts to the end. The peak effort is infinite in a
    blow; of a rigid stop at rest, and in a result of an earlier version, it is that of samples, else NaN.
    """

    stop: str  # its place, as ``stops.hinge``, or that of a gear
    side: str  # ``lower`` or ``upper``; of a gear ``plus`` or ``minus``
    onset: float  # first touch [s]
    release: float  # [s]
    approach_rate: float  # into the stop at the onset [rad/s] ([m/s])
    rebound_rate: float  # out of it at the release [rad/s] ([m/s])
    peak_effort: float  # largest torque [N m] ([N])
    impulse: float  # size of the integral of the torque [N m s] ([N s])
    loss: float  # energy lost [J]

    @property
    def ended(self) -> bool:
        """True if the touch was released before the run's end."""
        return bool(np.isfinite(self.release))


def elements_of(data: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return the elements of further families by place: ``joint``, ``slides``, ``modes``, ..."""
    found: dict[str, dict[str, Any]] = json.loads(data.attrs.get("elements", "{}"))
    return found


def mode_changes(data: xr.Dataset, family: str) -> Iterator[ModeChange]:
    """Yield the changes of mode of elements of a family in order of time."""
    if "change" not in data.sizes:
        return
    word = {"stops": "stop", "latches": "latch", "gears": "gear"}[family]
    places = [place.partition(".") for place in names_along(data, "element")]
    own = {f"{word} {name}": f"{family}.{name}" for table, _, name in places if table == family}
    nothing = np.full(data.sizes["change"], np.nan)
    columns = [
        np.asarray(data[f"change_{name}"].values if f"change_{name}" in data else nothing, dtype=float)
        for name in ModeChange._fields[2:]
    ]
    for k, label in enumerate(names_along(data, "change")):
        named = next((one for one in own if label.startswith(f"{one}: ")), None)
        if named is not None:
            values = (float(column[k]) for column in columns)
            yield ModeChange(own[named], label[len(named) + 2 :], *values)


def latch_changes(data: xr.Dataset) -> list[ModeChange]:
    """Return captures, refusals and releases of latches, in order of time."""
    return list(mode_changes(data, "latches"))


def touches(data: xr.Dataset, family: str = "stops") -> list[Touch]:
    """Return the touches of stops or gears, in order of their onset."""
    found: list[Touch] = []
    open_: dict[tuple[str, str], ModeChange] = {}
    for change in mode_changes(data, family):
        side, _, what = change.what.partition(": ")
        own = change.element, side
        if what in ("on", "rests", "taut"):
            open_[own] = change
        elif what == "bounces":
            found.append(_touch(data, change, change))
        elif what in ("off", "left", "slack") and own in open_:
            found.append(_touch(data, open_.pop(own), change))
    found += [_touch(data, change, None) for change in open_.values()]
    return sorted(found, key=lambda one: one.onset)


def _touch(data: xr.Dataset, begin: ModeChange, end: ModeChange | None) -> Touch:
    side, _, what = begin.what.partition(": ")
    into = -1.0 if side in ("lower", "minus") else 1.0
    blow = what == "bounces"
    rests = what == "rests"
    loss, impulse, rebound, release = (np.nan,) * 4
    if end is not None:
        loss, impulse = end.loss + (begin.loss if rests else 0.0), abs(end.impulse)
        rebound, release = -into * (end.rate_after if blow else end.rate), end.time
    elif rests:
        loss = begin.loss
    if rests:
        impulse = abs(begin.impulse)
    return Touch(
        stop=begin.element,
        side=side,
        onset=begin.time,
        release=release,
        approach_rate=into * begin.rate,
        rebound_rate=rebound + 0.0,
        peak_effort=np.inf if blow or (rests and begin.impulse) else _peak(data, begin, end),
        impulse=impulse,
        loss=loss,
    )


def _peak(data: xr.Dataset, begin: ModeChange, end: ModeChange | None) -> float:
    """Return the largest torque of a touch: as recorded, or of its samples."""
    recorded = (begin if end is None else end).peak_effort
    if np.isfinite(recorded):
        return recorded
    if is_lean(data) or "element_effort" not in data:
        return float("nan")
    time = np.asarray(data["time"].values, dtype=float)
    first = int(np.searchsorted(time, begin.time, side="left"))
    last = time.size if end is None else int(np.searchsorted(time, end.time, side="right"))
    effort = data["element_effort"].sel(element=begin.element).isel(time=slice(first, last))
    return float(np.abs(effort.values).max(initial=0.0))


def met_by_elements(data: xr.Dataset) -> dict[str, dict[str, dict[str, Any]]]:
    """Return numbers of stops and latches for a summary, by family and name."""
    about = elements_of(data)
    found: dict[str, dict[str, dict[str, Any]]] = {"stops": {}, "latches": {}}
    every, changes = touches(data), latch_changes(data)
    for place, one in about.items():
        family, _, name = place.partition(".")
        slides = one["slides"]
        if family == "stops":
            mine = [touch for touch in every if touch.stop == place]
            found[family][name] = {
                "touches": len(mine),
                "fastest_touch": max((touch.approach_rate for touch in mine), default=0.0),
                "peak_force" if slides else "peak_torque": _largest(mine, "peak_effort"),
                "largest_blow": _largest(mine, "impulse") or 0.0,
            }
        elif family == "latches":
            own = [change for change in changes if change.element == place]
            captures = [change for change in own if change.what == "latched"]
            refused = [change for change in own if change.what == "refused"]
            found[family][name] = {
                "captures": len(captures),
                "refusals": len(refused),
                "largest_energy_refused": max((change.energy for change in refused), default=None),
                "last_capture": captures[-1].time if captures else None,
                "let_go": sum(change.what == "let go" for change in own),
                "held_at_end": _is_held(data, place, own),
            }
        else:
            continue
        found[family][name]["element_loss"] = float(data["total_element_loss"].sel(element=place))
    return {family: named for family, named in found.items() if named}


def _is_held(data: xr.Dataset, place: str, changes: Sequence[ModeChange]) -> bool:
    """Return whether a latch is engaged at the end."""
    if not is_lean(data) and "element_mode" in data:
        number = int(data["element_mode"].sel(element=place).values[-1])
        return bool(elements_of(data)[place]["modes"][number] == "held")
    last = [change.what for change in changes if change.what in ("latched", "let go")][-1:]
    return last == ["latched"]


def _largest(own: Iterable[Touch], name: str) -> float | None:
    """Return the largest finite number of some touches; None if there is none."""
    values = (getattr(one, name) for one in own)
    return max((value for value in values if np.isfinite(value)), default=None)


_BITS = {"plus": 1, "minus": 2}
_INTO, _OUT_OF = ("on", "taut"), ("off", "slack")


class Span(NamedTuple):
    """Time between two changes of contact."""

    begin: float  # [s]
    end: float  # [s]
    plus: bool  # side of a positive deflection in contact: a flank meshes, a strand is taut
    minus: bool  # likewise of a negative one


def mesh_spans(data: xr.Dataset, place: str) -> list[Span]:
    """Return the sides in contact of a gear, belt or cable over the run.

    Args:
        data: Of a run.
        place: Of the element, as ``gears.drive``.

    Returns:
        One after the other; none of a run that is saved without samples, which tell how it began.
    """
    if is_lean(data) or "element_mode" not in data:
        return []
    bits = int(data["element_mode"].sel(element=place).values[0])
    found, begin = [], float(data["time"].values[0])
    for change in mode_changes(data, "gears"):
        if change.element != place:
            continue
        side, _, what = change.what.partition(": ")
        if what not in (*_INTO, *_OUT_OF):
            continue
        found.append(Span(begin, change.time, bool(bits & 1), bool(bits & 2)))
        begin = change.time
        bits = bits | _BITS[side] if what in _INTO else bits & ~_BITS[side]
    found.append(Span(begin, float(data.attrs["end_time"]), bool(bits & 1), bool(bits & 2)))
    return [one for one in found if one.end > one.begin]


def mesh_touches(data: xr.Dataset) -> list[Touch]:
    """Return the touches of gears, belts and cables, in order of their onset.

    Losses and impulses are known of touches of one side alone: where both strands were taut they are NaN.
    """
    return [
        replace(one, impulse=np.nan, loss=np.nan) if one.impulse == 0.0 else one
        for one in touches(data, "gears")
    ]


def met_by_meshes(data: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return numbers of gears, belts and cables for a summary, by name."""
    found: dict[str, dict[str, Any]] = {}
    every = mesh_touches(data)
    for place, one in elements_of(data).items():
        if not place.startswith("gears."):
            continue
        slides, sides = one["slides"], [side for side in _BITS if side in one["numbers"]]
        peak = None
        if not is_lean(data) and "element_effort" in data:
            peak = float(np.abs(data["element_effort"].sel(element=place).values).max(initial=0.0))
        mine = [touch for touch in every if touch.stop == place]
        if (located := _largest(mine, "peak_effort")) is not None:
            peak = max(located, peak or 0.0)
        own: dict[str, Any] = {"peak_force" if slides else "peak_torque": peak}
        if sides:
            spans = mesh_spans(data, place)
            own |= {
                "touches": len(mine),
                "fastest_touch": max((touch.approach_rate for touch in mine), default=0.0),
                "largest_blow": _largest(mine, "impulse"),
                "time_apart": _time(spans, 1) if spans else None,
            }
            if one["kind"] in ("Belt", "Cable") and spans:
                own["time_slack"] = _time(spans, len(sides))
        own["element_loss"] = float(data["total_element_loss"].sel(element=place))
        found[place.partition(".")[2]] = own
    return found


def _time(spans: list[Span], sides: int) -> float:
    """Return the time with fewer sides in contact than a number [s]."""
    return float(sum(span.end - span.begin for span in spans if span.plus + span.minus < sides))


# Of the run's time: instants closer than that are one, for times are no finer.
_SAME_INSTANT = 1e-12


def surfaces(data: xr.Dataset) -> NDArray[np.object_]:
    """Return the surfaces that each contact of a run is between, as ``joint.kind``, (contacts,)."""
    joints, kinds = contact_joints(data), contact_kinds(data)
    return np.array([f"{joint}.{kinds[name]}" for name, joint in joints.items()], dtype=object)


def blow_numbers(data: xr.Dataset) -> NDArray[np.int64]:
    """Return the number of the blow of each contact episode, in order of begin.

    Args:
        data: Of a run with contacts.
    """
    onset = np.asarray(data["onset_time"].values, dtype=float)
    release = np.asarray(data["release_time"].values, dtype=float)
    release = np.where(np.isfinite(release), release, np.inf)
    of = surfaces(data)[np.asarray(data["episode_contact"].values, dtype=int)]
    same = _SAME_INSTANT * max(1.0, float(data.attrs["end_time"]))
    numbers, begun = np.zeros(onset.size, dtype=np.int64), 0
    last: dict[str, tuple[int, float]] = {}
    for k in np.argsort(onset, kind="stable").tolist():
        number, until = last.get(of[k], (-1, -np.inf))
        if onset[k] > until + same:
            number, begun = begun, begun + 1
            until = release[k]
        numbers[k], last[of[k]] = number, (number, max(until, release[k]))
    return numbers


def blow_counts(data: xr.Dataset) -> dict[str, int]:
    """Return the number of blows of each pair of surfaces, as ``joint.kind``."""
    of = surfaces(data)
    index, numbers = np.asarray(data["episode_contact"].values, dtype=int), blow_numbers(data)
    return {str(name): len(set(numbers[of[index] == name].tolist())) for name in dict.fromkeys(of)}
