"""What stops and latches of a run have met: touches of stops from onset to release, what latches captured.

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

__all__ = [
    "ModeChange",
    "Span",
    "Touch",
    "blow_counts",
    "blow_numbers",
    "elements_of",
    "latch_changes",
    "mesh_spans",
    "mesh_touches",
    "met_by_elements",
    "met_by_meshes",
    "mode_changes",
    "surfaces",
    "touches",
]


Array = NDArray[np.float64]

_OF = "change_"
_WORDS = {"stops": "stop", "latches": "latch", "gears": "gear"}


class ModeChange(NamedTuple):
    """A change of mode of an element.

    Attributes:
        element: The element's place, as ``stops.hinge``.
        what: What happened, such as ``lower: on``.
        time: When [s].
        angle: Of the joint then [rad] ([m]).
        rate: Before [rad/s] ([m/s]).
        rate_after: After [rad/s] ([m/s]).
        loss: Energy lost by it; of a release, since the onset [J].
        impulse: On the child by it; of a release, since the onset [N m s] ([N s]).
        energy: Of the joint's own motion before, of a latch [J]; NaN of others.
        peak_effort: Largest one of the touch that ends, or lasts from here to the end [N m] ([N]); else NaN.
    """

    element: str
    what: str
    time: float
    angle: float
    rate: float
    rate_after: float
    loss: float
    impulse: float
    energy: float
    peak_effort: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Touch:
    """A touch of a stop; a blow of a rigid one lasts no time.

    Attributes:
        stop: Place of the stop, as ``stops.hinge``, or of a gear.
        side: ``lower`` or ``upper``; of a gear ``plus`` or ``minus``.
        onset: First touch [s].
        release: Release [s]; NaN if it lasts to the end.
        approach_rate: Rate into the stop at the onset [rad/s] ([m/s]).
        rebound_rate: Rate out of it at the release [rad/s] ([m/s]); NaN if it lasts to the end.
        peak_effort: Largest torque [N m] ([N]); infinite in a blow. That of a rigid stop at rest, and of a
            result of an earlier version, is the largest of samples, NaN without these.
        impulse: Size of the integral of the torque [N m s] ([N s]); NaN if it lasts to the end.
        loss: Energy lost [J]; NaN if it lasts to the end.
    """

    stop: str
    side: str
    onset: float
    release: float
    approach_rate: float
    rebound_rate: float
    peak_effort: float
    impulse: float
    loss: float

    @property
    def ended(self) -> bool:
        """Whether it was released before the run's end."""
        return bool(np.isfinite(self.release))


def elements_of(data: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return what the elements of further families are, by place: ``joint``, ``slides``, ``modes``, ..."""
    found: dict[str, dict[str, Any]] = json.loads(data.attrs.get("elements", "{}"))
    return found


def mode_changes(data: xr.Dataset, family: str) -> Iterator[ModeChange]:
    """Yield the changes of mode of elements of a family in order of time."""
    if "change" not in data.sizes:
        return
    word = _WORDS[family]
    own = {
        f"{word} {name}": f"{family}.{name}"
        for place in names_along(data, "element")
        for table, _, name in [place.partition(".")]
        if table == family
    }
    count = data.sizes["change"]
    columns = [
        np.asarray(data[_OF + name].values if _OF + name in data else np.full(count, np.nan), dtype=float)
        for name in ModeChange._fields[2:]
    ]
    for k, label in enumerate(names_along(data, "change")):
        named = next((one for one in own if label.startswith(f"{one}: ")), None)
        if named is not None:
            values = (float(column[k]) for column in columns)
            yield ModeChange(own[named], label[len(named) + 2 :], *values)


def latch_changes(data: xr.Dataset) -> list[ModeChange]:
    """Return what latches captured, refused and let go, in order of time."""
    return list(mode_changes(data, "latches"))


def touches(data: xr.Dataset, family: str = "stops") -> list[Touch]:
    """Return the touches of stops, or of another family that has sides, in order of their onset."""
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
    """Return what stops and latches met, for a summary: by family, then by name."""
    about = elements_of(data)
    found: dict[str, dict[str, dict[str, Any]]] = {"stops": {}, "latches": {}}
    every, changes = touches(data), latch_changes(data)
    for place, one in about.items():
        family, _, name = place.partition(".")
        slides = one["slides"]
        if family == "stops":
            mine = [touch for touch in every if touch.stop == place]
            peaks = [touch.peak_effort for touch in mine if np.isfinite(touch.peak_effort)]
            found[family][name] = {
                "touches": len(mine),
                "fastest_touch": _most(touch.approach_rate for touch in mine),
                "peak_force" if slides else "peak_torque": max(peaks) if peaks else None,
                "largest_blow": _most(touch.impulse for touch in mine if np.isfinite(touch.impulse)),
            }
        elif family == "latches":
            own = [change for change in changes if change.element == place]
            captures = [change for change in own if change.what == "latched"]
            refused = [change for change in own if change.what == "refused"]
            found[family][name] = {
                "captures": len(captures),
                "refusals": len(refused),
                "largest_energy_refused": _most(change.energy for change in refused) if refused else None,
                "last_capture": captures[-1].time if captures else None,
                "let_go": sum(change.what == "let go" for change in own),
                "held_at_end": _is_held(data, place, own),
            }
        else:
            continue
        found[family][name]["element_loss"] = float(data["total_element_loss"].sel(element=place))
    return {family: named for family, named in found.items() if named}


def _is_held(data: xr.Dataset, place: str, changes: Sequence[ModeChange]) -> bool:
    """Return whether a latch holds at the end; in a lean result as far as its own changes say."""
    if not is_lean(data) and "element_mode" in data:
        number = int(data["element_mode"].sel(element=place).values[-1])
        return bool(elements_of(data)[place]["modes"][number] == "held")
    last = [change.what for change in changes if change.what in ("latched", "let go")][-1:]
    return last == ["latched"]


def _most(values: Iterable[float]) -> float:
    return max(values, default=0.0)


_BITS = {"plus": 1, "minus": 2}
_INTO, _OUT_OF = ("on", "taut"), ("off", "slack")


class Span(NamedTuple):
    """A time between two changes of what is in contact.

    Attributes:
        begin: [s].
        end: [s].
        plus: Whether the side of a positive deflection is in contact: a flank meshes, a strand is taut.
        minus: Likewise of a negative one.
    """

    begin: float
    end: float
    plus: bool
    minus: bool


def mesh_spans(data: xr.Dataset, place: str) -> list[Span]:
    """Return what is in contact of a gear, belt or cable, over the whole run.

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
    """Return the touches of gears, belts and cables in order of their onset; each has its place for a stop.

    Losses and impulses are known of touches of one side alone: where both strands were taut they are NaN.
    """
    return [
        replace(one, impulse=np.nan, loss=np.nan) if one.impulse == 0.0 else one
        for one in touches(data, "gears")
    ]


def met_by_meshes(data: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return what gears, belts and cables did, for a summary, by name."""
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
        located = [touch.peak_effort for touch in mine if np.isfinite(touch.peak_effort)]
        if located:
            peak = max(*located, peak or 0.0)
        own: dict[str, Any] = {"peak_force" if slides else "peak_torque": peak}
        if sides:
            spans = mesh_spans(data, place)
            own |= {
                "touches": len(mine),
                "fastest_touch": max((touch.approach_rate for touch in mine), default=0.0),
                "largest_blow": max((t.impulse for t in mine if np.isfinite(t.impulse)), default=None),
                "time_apart": _time(spans, 1) if spans else None,
            }
            if one["kind"] in ("Belt", "Cable") and spans:
                own["time_slack"] = _time(spans, len(sides))
        own["element_loss"] = float(data["total_element_loss"].sel(element=place))
        found[place.partition(".")[2]] = own
    return found


def _time(spans: list[Span], sides: int) -> float:
    """Return how long fewer sides were in contact than so many [s]."""
    return float(sum(span.end - span.begin for span in spans if span.plus + span.minus < sides))


# Of the run's time: instants closer than that are one, for times are no finer.
_SAME_INSTANT = 1e-12


def surfaces(data: xr.Dataset) -> NDArray[np.object_]:
    """Return the surfaces that each contact of a run is between, as ``joint.kind``, (contacts,)."""
    joints, kinds = contact_joints(data), contact_kinds(data)
    return np.array([f"{joint}.{kinds[name]}" for name, joint in joints.items()], dtype=object)


def blow_numbers(data: xr.Dataset) -> NDArray[np.int64]:
    """Return of each contact episode the number of the blow that it belongs to, in order of their begin.

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
    """Return how many blows there were between each two surfaces, as ``joint.kind``."""
    of = surfaces(data)
    index, numbers = np.asarray(data["episode_contact"].values, dtype=int), blow_numbers(data)
    return {str(name): len(set(numbers[of[index] == name].tolist())) for name in dict.fromkeys(of)}
