"""Result of a run in at most nine lines."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from antenna_pin.analysis.round_off import is_round_off
from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number, readable
from antenna_pin.joints.geometry.registry import LOOKS
from antenna_pin.trajectory import Trajectory, contact_joints, is_lean, names_along

# Joints with play that have a line of their own: the others share one.
_JOINTS = 3
# Lines in all, of which the joints have what the others leave.
_LINES = 9
# Less time than this, of compiling, is nothing to tell of [s].
_COMPILED = 0.1
# Relative error up to which a balance closes, in results that do not say what their tolerance explains [-].
_CLOSED = 1e-3
# Angles and ways smaller than round-off of these are none.
_SCALES = {"rad": 1.0, "m": 1.0}


class Line(NamedTuple):
    """Line about one part of a run."""

    about: str  # subject, such as the name of a joint
    text: str  # parts with "; " between them, the most important ones first


class Answer(NamedTuple):
    """Result of a run in a few lines."""

    title: str  # of the scenario
    ended: str  # outcome, times and steps
    lines: tuple[Line, ...]  # at most nine


@takes()
def answer(run: Trajectory) -> Answer:
    """Return blows, peaks, losses, pointing errors and balances of a run.

    A lean run has no displacements of journals.
    """
    data, summary = run.data, run.summary()
    case = f"case {summary['case']}" if summary["case"] else ""
    title = ", ".join(filter(None, (str(summary["title"]), case)))
    counts, simulated = run.counts, readable(summary["time"], "s")
    took = f"{number(counts.wall_seconds, 3)}\N{NO-BREAK SPACE}s"
    if counts.compile_seconds >= _COMPILED:
        took += f" (and {number(counts.compile_seconds, 3)}\N{NO-BREAK SPACE}s compiling, once)"
    outcome = summary["outcome"].lower().replace("_", " ")
    ended = f"{outcome}, {simulated} simulated in {took}, {counts.accepted:,} steps"
    hits = [_Hit.of(data, summary, name) for name in names_along(data, "clearance_joint")]
    others = [*_elements(summary), *_closures(summary), *_carried(summary), *_pointing(run)]
    if not hits:  # else the blows are what happened
        others = [*_moved(summary), *others]
    others = [*others[: _LINES - 1 - min(len(hits), 1)], _books(data, summary)]
    lines = (*_of_hits(hits, max(min(_JOINTS, _LINES - len(others) - 1), 0)), *others)
    return Answer(title or "a system built in Python", ended, lines)


def _of_hits(hits: Sequence[_Hit], most: int = _JOINTS) -> Iterator[Line]:
    """Yield lines on joints with play, the largest force first, the last ones together."""
    told = sorted(hits, key=lambda hit: -hit.force)
    own = most if len(told) > most + 1 else len(told)
    for hit in told[:own]:
        yield Line(hit.joint, hit.words)
    if others := told[own:]:
        blows, lost = sum(hit.blows for hit in others), sum(hit.lost for hit in others)
        text = f"{_counted(blows, 'blow')}, at most {readable(others[0].force, 'N')}; {_lost(lost)}"
        yield Line(f"{len(others)} other joints with play", text)


class _Hit(NamedTuple):
    """Blows, largest force and loss of a joint with play."""

    joint: str
    blows: int
    force: float
    lost: float
    words: str

    @classmethod
    def of(cls, data: xr.Dataset, summary: Mapping[str, Any], joint: str) -> _Hit:
        """Return the blows of a joint."""
        owners = list(contact_joints(data).values())
        contacts = [k for k, owner in enumerate(owners) if owner == joint]
        counts = summary["blows"].items()  # by surface, as ``joint.kind``
        blows = sum(one["blows"] for name, one in counts if name.rpartition(".")[0] == joint)
        mine = np.isin(data["episode_contact"].values, contacts)
        losses = (data[name].values[contacts] for name in ("total_normal_loss", "total_friction_loss"))
        lost = float(sum(one.sum() for one in losses))
        if not mine.any():
            return cls(joint, 0, 0.0, lost, f"no contact{_apart(data, joint)}")
        forces = data["peak_force"].values[mine]
        force, depth = float(forces.max()), float(data["peak_depth"].values[mine].max())
        when = float(data["peak_time"].values[mine][int(forces.argmax())])
        at = f" at {readable(when, 's', 6)}" if np.isfinite(when) else ""
        text = (
            f"{_counted(blows, 'blow')}, at most {readable(force, 'N')}{at}, {readable(depth, 'm', 3)} deep"
        )
        return cls(joint, blows, force, lost, f"{text}; {_lost(lost)}{_apart(data, joint)}")


@np.errstate(over="ignore")  # of a journal that has flown off
def _apart(data: xr.Dataset, joint: str) -> str:
    """Return the displacement of a journal from the ideal joint, as text."""
    if is_lean(data) or "journal_position" not in data:
        return ""
    place = names_along(data, "clearance_joint").index(joint)
    part = LOOKS[json.loads(data.attrs["clearance_joints"])[joint]["kind"]].picture
    way = np.asarray(data["journal_position"].values[:, place, :], dtype=float)
    # Along a guide a slider is to move, and a ball is to turn.
    across = float(np.linalg.norm(way if part == "ball" else way[:, :2], axis=-1).max())
    said = [] if _is_nothing(across, "m") else [f"{readable(across, 'm', 3)} off"]
    along = float(np.abs(way[:, 2]).max()) if part == "journal" else 0.0
    if not _is_nothing(along, "m"):
        said = [f"{one} radially" for one in said] + [f"{readable(along, 'm', 3)} axially"]
    if "journal_tilt" in data and part != "ball":
        tilt = float(np.abs(data["journal_tilt"].values[:, place]).max())
        said += [] if _is_nothing(tilt, "rad") else [f"{readable(tilt, 'rad', 3)} askew"]
    return f"; {part} up to {', '.join(said)}" if said else ""


def _is_nothing(size: float, unit: str) -> bool:
    return size == 0.0 or is_round_off(size, unit, _SCALES)


def _judged(value: float, unit: str, scales: Mapping[str, float] = _SCALES) -> str:
    """Return a quantity as text, ≈ 0 where it is round-off."""
    nearly = is_round_off(value, unit, scales)
    return f"≈\N{NO-BREAK SPACE}0\N{NO-BREAK SPACE}{unit}" if nearly else readable(value, unit)


def _elements(summary: Mapping[str, Any]) -> Iterator[Line]:
    """Yield lines on stops, latches, gears and controllers."""
    stops = summary.get("stops", {})
    if stops:
        touches = sum(one["touches"] for one in stops.values())
        name, hardest = max(stops.items(), key=lambda item: item[1]["fastest_touch"])
        unit = "m/s" if "peak_force" in hardest else "rad/s"
        text = _counted(touches, "touch", "touches")
        if touches:
            text += f", fastest {readable(hardest['fastest_touch'], unit)} at {name}"
            text += f"; {_lost(sum(one['element_loss'] for one in stops.values()))}"
        yield Line("stops", text)
    latches = summary.get("latches", {})
    if latches:
        holding = {name: one["last_capture"] for name, one in latches.items() if one["held_at_end"]}
        refused = sum(one["refusals"] for one in latches.values())
        text = f"{len(holding)} of {len(latches)} latched at the end"
        if caught := {name: time for name, time in holding.items() if time is not None}:
            last = max(caught, key=lambda name: caught[name])
            text += f", the last ({last}) at {readable(caught[last], 's', 6)}"
        if released := [name for name, one in latches.items() if one["captures"] and name not in holding]:
            text += f"; released: {', '.join(released)}"
        energies = [one["largest_energy_refused"] for one in latches.values() if one["refusals"]]
        if refused:
            text += f"; {_counted(refused, 'refusal')}, at most {readable(max(energies), 'J')}"
        yield Line("latches", text)

    gears = summary.get("gears", {})
    if gears:
        # A lean result does not have them.
        known = {name: one.get("peak_torque", one.get("peak_force")) for name, one in gears.items()}
        peaks = {name: peak for name, peak in known.items() if peak is not None}
        touches = sum(one.get("touches", 0) for one in gears.values())
        apart = [one["time_apart"] for one in gears.values() if one.get("time_apart") is not None]
        text = _counted(touches, "touch", "touches")
        if peaks:
            name = max(peaks, key=lambda one: peaks[one])
            unit = "N m" if "peak_torque" in gears[name] else "N"
            text += f", at most {readable(peaks[name], unit)} at {name}"
        yield Line("gears", text + (f"; apart for {readable(max(apart), 's')}" if apart else ""))
    controllers = summary.get("controllers", {})
    if controllers:
        asked = sum(int(one["ticks"]) for one in controllers.values())
        held = sum(int(one["saturated"]) for one in controllers.values())
        text = f"asked {asked} times" + (f", limited {held} times" if held else "")
        yield Line("controllers", text)


def _closures(summary: Mapping[str, Any]) -> Iterator[Line]:
    """Yield a line on the loads and residuals of closures."""
    closures = summary.get("closures", {})
    if closures:
        name = max(closures, key=lambda one: closures[one]["peak_force"])
        force = readable(closures[name]["peak_force"], "N")
        held = readable(summary["constraints"]["position_residual"], "m", 2)
        yield Line("closures", f"at most {force}, at {name}; held to {held}")


def _carried(summary: Mapping[str, Any]) -> Iterator[Line]:
    """Yield lines on motions, bearings, flexible parts and external forces."""
    for key, about, units in (
        ("motions", "motions", {"peak_force": "N", "peak_torque": "N m"}),
        ("bearings", "bearings", {"peak_force": "N", "peak_moment": "N m"}),
        ("elastic_parts", "flexible", {"peak_deflection": "rad", "peak_shift": "m"}),
        ("forces", "forces", {"impulse": "N s"}),
    ):
        named = summary.get(key, {})
        said = []
        for entry, unit in units.items():
            values = {name: one[entry] for name, one in named.items() if one.get(entry)}
            if values:
                name = max(values, key=lambda one: values[one])
                said.append(f"{readable(values[name], unit)}{f' at {name}' if len(named) > 1 else ''}")
        if said:
            yield Line(about, f"at most {', '.join(said)}")


def _moved(summary: Mapping[str, Any]) -> Iterator[Line]:
    """Yield lines on final positions and the largest acceleration of joints."""
    for key, place, unit, peak, of_peak in (
        ("motion", "angle", "rad", "peak_acceleration", "rad/s^2"),
        ("slides", "position", "m", "peak_slide_acceleration", "m/s^2"),
    ):
        named = summary.get(key, {})
        if not named:
            continue
        shown = [f"{name} {_judged(one[place], unit)}" for name, one in list(named.items())[:_JOINTS]]
        left = f" ({len(named) - _JOINTS} more)" if len(named) > _JOINTS else ""
        fastest = max(named, key=lambda one: named[one][peak])
        text = f"{', '.join(shown)}{left} at the end"
        text += f"; acceleration at most {readable(named[fastest][peak], of_peak)}"
        yield Line(
            "joints" if key == "motion" else "slides", text + (f" at {fastest}" if len(named) > 1 else "")
        )


def _pointing(run: Trajectory) -> Iterator[Line]:
    """Yield a line on pointing errors, where the scenario commands a direction."""
    data = run.data
    if is_lean(data) or not _is_commanded(run):
        return
    # Rotations by SciPy, and the mechanism: longer to load than all else here.
    from antenna_pin.analysis.pointing import pointing_error

    error = pointing_error(run)["half_cone"].values
    when = float(data["time"].values[int(error.argmax())])
    rms = readable(float(np.sqrt(np.mean(error**2))), "rad", 3)
    most = readable(float(error.max()), "rad", 3)
    yield Line("pointing", f"off by at most {most} at {readable(when, 's', 6)}, rms of samples {rms}")


def _is_commanded(run: Trajectory) -> bool:
    """Return whether the scenario commands a pointing direction."""
    if run.scenario is not None:
        return run.scenario.pointing is not None and run.scenario.pointing.commanded != "ideal"
    text = str(run.data.attrs.get("scenario") or "{}")
    return bool(((json.loads(text) or {}).get("pointing") or {}).get("commanded", "ideal") != "ideal")


def _books(data: xr.Dataset, summary: Mapping[str, Any]) -> Line:
    """Return a line on works and the balances of energy and momentum."""
    kept = summary["conservation"]
    done, gross = "", kept["gross_work"]
    if gross:
        works = {"drives": "total_work", "forces": "total_force_work"}
        each = [
            f"{who} did {_judged(float(data[name].values.sum()), 'J', {'J': gross})}"
            for who, name in works.items()
            if name in data
        ]
        done = ", ".join(each) + "; " if each else ""
    closes = "balance is off by" if _is_open(kept, "energy", "error") else "balance closes to"
    text = f"{done}{closes} {readable(kept['energy_error'], 'J', 2)}"
    if kept["energy_error_relative"] is not None:
        text += f", {number(kept['energy_error_relative'], 2)} of the {kept['energy_scale_of']}"
    drifts = [kept[f"{name}_momentum_drift_relative"] for name in ("linear", "angular")]
    if all(one is not None for one in drifts):
        linear, angular = (number(one, 2) for one in drifts)
        is_open = any(_is_open(kept, f"{name}_momentum", "drift") for name in ("linear", "angular"))
        text += f"; momentum {'off by' if is_open else 'kept to'} {linear} (linear), {angular} (angular)"
    return Line("energy", text)


def _is_open(balance: Mapping[str, Any], what: str, of: str) -> bool:
    """Return whether an error exceeds its tolerance, or a thousandth without one."""
    tolerance, relative = balance.get(f"{what}_tolerance"), balance[f"{what}_{of}_relative"]
    if tolerance is None:
        return relative is not None and not relative <= _CLOSED
    return not balance[f"{what}_{of}"] <= tolerance


def _counted(count: int, one: str, many: str = "") -> str:
    return f"{count} {one if count == 1 else many or one + 's'}"


def _lost(energy: float) -> str:
    return f"{readable(energy, 'J', 3)} lost"
