"""From the samples of a run to a result: all that its states imply, by the schema of results."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.dynamics import journal_attitudes, observed
from antenna_pin.elements import Motion
from antenna_pin.simulation.carried import mechanism_attributes
from antenna_pin.simulation.coordinates import coordinate_names
from antenna_pin.simulation.held import constraint_attributes
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.seen import Seen
from antenna_pin.trajectory.labelled import labelled

__all__ = ["dataset"]

Values = Mapping[str, Any]


def dataset(run: Run, title: str, case: str, versions: dict[str, str], *, lean: bool = False) -> xr.Dataset:
    """Return a finished run as a labelled dataset (docs/trajectory.md lists the variables).

    Args:
        run: The run.
        title: Of the scenario.
        case: Of the scenario.
        versions: Of the libraries.
        lean: Whether to leave out the series: a result of numbers and contact episodes only.
    """
    samples = run.samples
    times, states, memories = samples.times.copy(), samples.states.copy(), samples.memories.copy()
    found = observed(run.system, times, states, memories, samples.programs)
    seen = Seen(run, times, states, memories, found)
    values: dict[str, Any] = {}
    for source in _SOURCES:
        values |= source(seen)
    attributes = {
        "form": "lean" if lean else "full",
        "title": title,
        "case": case,
        "end_time": float(times[-1]),
        "samples": len(times),
        "versions": json.dumps(versions),
        "gap_difference": run.gap_difference,
        "conservation": json.dumps(_conservation(seen)),
        **mechanism_attributes(run.system),
        **constraint_attributes(run, states, found),
    }
    free = run.system.mechanism.base == "free"
    return labelled(values, _labels(seen), attributes, free_base=free, lean=lean)


def _labels(seen: Seen) -> dict[str, Any]:
    """Return the labels of all dimensions and coordinates that the system has."""
    system = seen.system
    configuration, velocity = coordinate_names(system)
    labels: dict[str, Any] = {
        "time": seen.times,
        "axis": ("x", "y", "z"),
        "configuration": configuration,
        "coordinate": velocity,
        "joint": seen.joints[0],
    }
    if system.mechanism.base == "free" or system.clearances:
        labels["quaternion"] = ("x", "y", "z", "w")
    places = [(j.name, *place) for j in system.clearances for place in j.geometry.contact_places]
    for name, found in (
        ("sliding_joint", seen.slides[0]),
        ("contact", system.contact_names),
        ("contact_joint", [joint for joint, _, _ in places]),
        ("contact_kind", [kind for _, kind, _ in places]),
        ("contact_end", [end for _, _, end in places]),
        ("clearance_joint", [joint.name for joint in system.clearances]),
        ("drive", list(system.drives)),
        ("controller", [name for name, drive in system.drives.items() if drive.tracks]),
        ("motion", [name for name, drive in system.drives.items() if isinstance(drive, Motion)]),
        ("spring", [name for name in system.springs if name not in system.elastic]),
        ("elastic_part", list(system.elastic)),
        ("point_spring", list(system.point_springs)),
        ("closure", list(system.closures)),
    ):
        if found:
            labels[name] = found
    if system.contact_names:
        labels["episode"] = len(seen.run.episodes)
    if seen.run.events:
        labels["event"] = [one.name for one in seen.run.happened]
    return labels


# --- the sources of the schema: all variables of each ---


def _state(seen: Seen) -> Values:
    q, v = seen.q, seen.v
    return {
        "q": q,
        "v": v,
        "base_position": q[:, :3],
        "base_attitude": q[:, 3:7],
        "base_velocity": v[:, :3],
        "base_angular_velocity": v[:, 3:6],
    }


def _derivative(seen: Seen) -> Values:
    effort = seen.found.effort
    stretch = seen.found.stretch
    tracking = effort[:, [drive.tracks for drive in seen.system.drives.values()]]
    return {
        "a": seen.found.acceleration,
        "drive_torque": effort["effort"],
        "control_reference": tracking["reference"],
        "control_error": tracking["error"],
        "spring_length": stretch["length"],
        "spring_tension": stretch["tension"],
        "spring_force": stretch["force"],
        "closure_force": seen.found.closure[:, :, 0],
        "closure_moment": seen.found.closure[:, :, 1],
    }


def _contact(seen: Seen) -> Values:
    contacts, pose = seen.found.contact, seen.found.pose
    axis = pose["axis"]
    return {
        **{name: contacts[name] for name in contacts.dtype.names or ()},
        "touching": seen.memories["touching"].astype(np.int8),
        "journal_position": pose["centre"],
        "journal_attitude": journal_attitudes(seen.system, seen.states),
        "journal_tilt": np.arctan2(np.hypot(axis[..., 0], axis[..., 1]), axis[..., 2]),
        "joint_force": pose["force"],
        "joint_torque": pose["moment"],
        "radial_scenario": seen.found.scenario[:, :, 0],
        "axial_scenario": seen.found.scenario[:, :, 1],
    }


def _ledger(seen: Seen) -> Values:
    return {**seen.ledger, "energy_error": seen.energy_error}


def _audit(seen: Seen) -> Values:
    audit = seen.found.audit
    return {
        "kinetic_energy": audit["kinetic"],
        "contact_energy": audit["contacts"],
        "spring_energy": seen.spring_energy,
        "elastic_energy": seen.elastic.energy,
        "gravity_energy": audit["gravity"],
        "linear_momentum": audit["linear"],
        "angular_momentum": audit["angular"],
        "momentum_scale": audit["linear_scale"],
        "angular_momentum_scale": audit["angular_scale"],
    }


def _motion(seen: Seen) -> Values:
    turning = seen.joints[1]
    sliding = seen.slides[1]
    return {
        "motion_angle": turning[:, :, 0].T,
        "motion_rate": turning[:, :, 1].T,
        "motion_acceleration": turning[:, :, 2].T,
        "slide_position": sliding[:, :, 0].T,
        "slide_rate": sliding[:, :, 1].T,
        "slide_acceleration": sliding[:, :, 2].T,
        "deflection": seen.elastic.motion[:, :, 0],
        "deflection_rate": seen.elastic.motion[:, :, 1],
        "deflection_acceleration": seen.elastic.motion[:, :, 2],
    }


def _summary(seen: Seen) -> Values:
    moved, total = _motion(seen), {name: series[-1] for name, series in seen.ledger.items()}
    drives = seen.system.drives.values()
    closure = np.linalg.norm(seen.found.closure, axis=3).max(axis=0)
    efforts = np.abs(seen.found.effort["effort"]).max(axis=0)
    return {
        "peak_effort": efforts[[isinstance(drive, Motion) for drive in drives]],
        "peak_closure_force": closure[:, 0],
        "peak_closure_moment": closure[:, 1],
        "final_angle": moved["motion_angle"][-1],
        "final_rate": moved["motion_rate"][-1],
        "peak_acceleration": np.abs(moved["motion_acceleration"]).max(axis=0),
        "final_position": moved["slide_position"][-1],
        "final_slide_rate": moved["slide_rate"][-1],
        "peak_slide_acceleration": np.abs(moved["slide_acceleration"]).max(axis=0),
        "total_work": total["drive_work"],
        "total_gross_work": total["drive_gross_work"],
        "total_normal_loss": total["dissipation_normal"],
        "total_friction_loss": total["dissipation_friction"],
        "total_damper_loss": total["dissipation_damper"],
        "peak_deflection": np.abs(seen.elastic.motion[:, :, 0]).max(axis=0),
        "peak_elastic_energy": seen.elastic.energy.max(axis=0),
        "total_elastic_loss": total["dissipation_elastic"],
        "peak_spin": seen.elastic.spin.max(axis=0),
    }


def _episodes(seen: Seen) -> Values:
    names = {
        "onset": "onset_time",
        "release": "release_time",
        **{
            name: name
            for name in ("approach_speed", "peak_force", "peak_time", "peak_depth", "impulse", "dissipated")
        },
        "effective_mass": "effective_mass",
    }
    episodes = seen.run.episodes
    return {
        **{name: episodes[of].copy() for of, name in names.items()},
        "episode_contact": episodes["contact"].copy(),
        "event_time": np.array([one.time for one in seen.run.happened], dtype=float),
        "event_energy": np.array([one.energy for one in seen.run.happened], dtype=float),
    }


_SOURCES: tuple[Callable[[Seen], Values], ...] = (
    _state,
    _derivative,
    _contact,
    _ledger,
    _audit,
    _motion,
    _summary,
    _episodes,
)


def _conservation(seen: Seen) -> dict[str, Any]:
    """Return how well what must be kept was kept, relative to scales that do not pass through zero."""
    system, audit = seen.system, seen.found.audit
    result: dict[str, Any] = {"energy_error": float(np.abs(seen.energy_error).max())}
    gross = float(seen.ledger["drive_gross_work"][-1].sum())
    result["gross_work"] = gross
    result["energy_error_relative"] = result["energy_error"] / gross if gross > 0.0 else None
    conserved = system.keeps_momentum
    for name in ("linear", "angular"):
        values = audit[name]
        scale = float(audit[f"{name}_scale"].max())
        drift = float(np.abs(values - values[0]).max())
        result[f"{name}_momentum_drift"] = drift if conserved else None
        result[f"{name}_momentum_scale"] = scale
        result[f"{name}_momentum_drift_relative"] = drift / scale if conserved and scale > 0.0 else None
    if not math.isfinite(result["energy_error"]):
        result["energy_error_relative"] = None
    return result
