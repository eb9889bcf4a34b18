"""What a result has of the samples of a run, source by source, by the names that its schema has for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from antenna_pin.dynamics import bearing_loads
from antenna_pin.elements import Motion
from antenna_pin.simulation.bristles import of_bristles
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.motors import of_motors
from antenna_pin.simulation.seen import Seen

__all__ = ["SERIES", "SIZES", "TOTALS", "episodes_of", "sizes_of"]

Values = Mapping[str, Any]


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
        "element_effort": seen.found.done["effort"],
        "element_deflection": seen.found.done["deflection"],
        "element_energy": seen.found.done["energy"],
        "element_mode": seen.found.done["mode"].astype(np.int8),
        "spring_torque": seen.found.traced["effort"],
        "spring_length": stretch["length"],
        "spring_tension": stretch["tension"],
        "spring_force": stretch["force"],
        "applied_force": seen.found.applied["force"],
        "applied_torque": seen.found.applied["torque"],
        "force_energy": seen.found.kept,
        "closure_force": seen.found.closure[:, :, 0],
        "closure_moment": seen.found.closure[:, :, 1],
        "coupling_torque": seen.found.coupling,
    }


def _contact(seen: Seen) -> Values:
    contacts, pose = seen.found.contact, seen.found.pose
    axis = pose["axis"]
    return {
        **{name: contacts[name] for name in contacts.dtype.names or ()},
        "touching": seen.memories["touching"].astype(np.int8),
        "journal_position": pose["centre"],
        "journal_attitude": seen.attitudes,
        "journal_tilt": np.arctan2(np.hypot(axis[..., 0], axis[..., 1]), axis[..., 2]),
        "joint_force": pose["force"],
        "joint_torque": pose["moment"],
        "radial_scenario": seen.found.scenario[:, :, 0],
        "axial_scenario": seen.found.scenario[:, :, 1],
    }


def _bearing(seen: Seen) -> Values:
    loads = bearing_loads(seen.system, seen.states, seen.programs)
    return {f"bearing_{name}": loads[name] for name in loads.dtype.names or ()}


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


#: What is said with its last value, by the series that it is of.
TOTALS = {
    "final_angle": "motion_angle",
    "final_rate": "motion_rate",
    "final_position": "slide_position",
    "final_slide_rate": "slide_rate",
    "total_work": "drive_work",
    "total_gross_work": "drive_gross_work",
    "total_normal_loss": "dissipation_normal",
    "total_friction_loss": "dissipation_friction",
    "total_damper_loss": "dissipation_damper",
    "total_elastic_loss": "dissipation_elastic",
    "total_element_loss": "element_loss",
    "total_force_work": "force_work",
    "total_force_gross_work": "force_gross_work",
    "total_force_loss": "force_loss",
    "total_impulse": "force_impulse",
    "total_angular_impulse": "force_angular_impulse",
}


#: What is said with its largest size at a sample, by the series that it is of: of vectors their length.
SIZES = {
    "peak_effort": "drive_torque",
    "peak_closure_force": "closure_force",
    "peak_closure_moment": "closure_moment",
    "peak_coupling_torque": "coupling_torque",
    "peak_acceleration": "motion_acceleration",
    "peak_slide_acceleration": "slide_acceleration",
    "peak_deflection": "deflection",
    "peak_elastic_energy": "elastic_energy",
    "peak_bearing_force": "bearing_force",
    "peak_bearing_moment": "bearing_moment",
    "peak_applied_force": "applied_force",
    "peak_applied_torque": "applied_torque",
    "peak_energy_error": "energy_error",
}


def sizes_of(seen: Seen, values: Values) -> Values:
    """Return, of all that is said with its largest size in a run, the sizes at samples."""
    sizes = {
        name: np.linalg.norm(values[of], axis=2) if values[of].ndim == 3 else np.abs(values[of])
        for name, of in SIZES.items()
    }
    motions = [isinstance(drive, Motion) for drive in seen.system.drives.values()]
    sizes["peak_effort"] = sizes["peak_effort"][:, motions]
    return {**sizes, "peak_spin": seen.elastic.spin, "peak_residual": seen.found.residual}


def episodes_of(run: Run) -> Values:
    """Return what a run has kept of its contacts and events."""
    names = {
        "onset": "onset_time",
        "release": "release_time",
        **{
            name: name
            for name in ("approach_speed", "peak_force", "peak_time", "peak_depth", "impulse", "dissipated")
        },
        "effective_mass": "effective_mass",
    }
    episodes = run.episodes
    return {
        **{name: episodes[of].copy() for of, name in names.items()},
        "episode_contact": episodes["contact"].copy(),
        **_changes_of(run),
        "event_time": np.array([one.time for one in run.actions.happened], dtype=float),
        "event_energy": np.array([one.energy for one in run.actions.happened], dtype=float),
    }


def _changes_of(run: Run) -> Values:
    """Return the changes of mode that are recorded."""
    changed = [one for one in run.actions.modes.changed if one.time > run.after]
    names = {
        "change_time": "time",
        "change_angle": "angle",
        "change_rate": "rate",
        "change_rate_after": "rate_after",
        "change_loss": "loss",
        "change_impulse": "impulse",
        "change_energy": "energy",
    }
    return {name: np.array([getattr(one, of) for one in changed], dtype=float) for name, of in names.items()}


#: The series, by source: all variables of each.
SERIES: tuple[Callable[[Seen], Values], ...] = (
    _state,
    of_bristles,
    _derivative,
    of_motors,
    _contact,
    _bearing,
    _audit,
    _ledger,
    _motion,
)
