"""A run in plain numbers: how it ended, counts, peaks, impulses, conservation."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from antenna_pin.trajectory.blows import blow_counts
from antenna_pin.trajectory.meshes import met_by_meshes
from antenna_pin.trajectory.read import names_along
from antenna_pin.trajectory.touches import met_by_elements

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["summary_of"]


def summary_of(data: xr.Dataset, ended: Mapping[str, Any], constraints: Mapping[str, Any]) -> dict[str, Any]:
    """Return a run in plain numbers (SI units).

    Args:
        data: Of the run.
        ended: Its ``outcome``, ``message`` and ``counts``.
        constraints: What holds it; {} if nothing.
    """
    title = data.attrs.get("title", "")
    result: dict[str, Any] = {
        "title": title,
        "case": data.attrs.get("case", ""),
        "outcome": ended["outcome"],
        "message": ended["message"],
        "time": float(data.attrs["end_time"]),
        "samples": int(data.attrs["samples"]),
        "counts": ended["counts"],
        "conservation": json.loads(data.attrs["conservation"]),
        "gap_difference": float(data.attrs["gap_difference"]),
        "motion": _by_label(data, "joint", _MOTION),
        "contacts": {},
    }
    if "sliding_joint" in data.sizes:
        result["slides"] = _by_label(data, "sliding_joint", _SLIDES)
    if "elastic_part" in data.sizes:
        result["elastic_parts"] = _elastic_parts(data)
    if constraints:
        result["constraints"] = constraints
        result["closures"] = _closures(data)
        result["motions"] = _motions(data)
    if "coupling" in data.sizes:
        result["couplings"] = _couplings(data)
    result |= met_by_elements(data)
    if gears := met_by_meshes(data):
        result["gears"] = gears
    if "sampled" in data.sizes:
        result["controllers"] = _by_label(data, "sampled", _CONTROLLERS)
    if "bearing" in data.sizes:
        result["bearings"] = _by_label(data, "bearing", _BEARINGS)
    if "force" in data.sizes:
        result["forces"] = _forces(data)
    if "contact" not in data.sizes:
        return result
    index = data["episode_contact"].values
    for number, name in enumerate(data["contact"].values):
        mine = index == number
        peaks = data["peak_force"].values[mine]
        result["contacts"][str(name)] = {
            "episodes": int(mine.sum()),
            "peak_force": float(peaks.max()) if mine.any() else 0.0,
            "peak_depth": float(data["peak_depth"].values[mine].max()) if mine.any() else 0.0,
            "largest_approach_speed": (
                float(data["approach_speed"].values[mine].max()) if mine.any() else 0.0
            ),
            "impulse": float(data["impulse"].values[mine].sum()),
            "dissipated": float(data["dissipated"].values[mine].sum()),
        }
    result["blows"] = {name: {"blows": count} for name, count in blow_counts(data).items()}
    return result


# Entries of a summary by their variables.
_MOTION = {"angle": "final_angle", "rate": "final_rate", "peak_acceleration": "peak_acceleration"}
_BEARINGS = {"peak_force": "peak_bearing_force", "peak_moment": "peak_bearing_moment"}
_CONTROLLERS = {"ticks": "ticks", "saturated": "saturated_ticks"}
_SLIDES = {
    "position": "final_position",
    "slide_rate": "final_slide_rate",
    "peak_slide_acceleration": "peak_slide_acceleration",
}


def _elastic_parts(data: xr.Dataset) -> dict[str, dict[str, float]]:
    """Return how far each elastic part went, [m] if it slides, else [rad], and the energy that it took."""
    about = json.loads(data.attrs["elastic_parts"])
    return {
        name: {
            "peak_shift" if one["slides"] else "peak_deflection": float(data["peak_deflection"].values[k]),
            "peak_elastic_energy": float(data["peak_elastic_energy"].values[k]),
            "elastic_loss": float(data["total_elastic_loss"].values[k]),
        }
        for k, (name, one) in enumerate(about.items())
    }


def _forces(data: xr.Dataset) -> dict[str, dict[str, float]]:
    """Return impulse, angular impulse about the world's origin, by their sizes, and work of each force."""
    return {
        str(name): {
            "impulse": math.hypot(*data["total_impulse"].values[k].tolist()),
            "angular_impulse": math.hypot(*data["total_angular_impulse"].values[k].tolist()),
            "work": float(data["total_force_work"].values[k]),
        }
        for k, name in enumerate(data["force"].values)
    }


def _closures(data: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return what each closure joins and carried at most."""
    about = json.loads(data.attrs["closures"])
    return {
        name: {
            "kind": one["kind"],
            "links": [one["first_body"], one["second_body"]],
            "peak_force": float(data["peak_closure_force"].sel(closure=name)),
            "peak_moment": float(data["peak_closure_moment"].sel(closure=name)),
        }
        for name, one in about.items()
    }


def _couplings(data: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return what each coupling joins, and its largest force where the follower slides, else torque."""
    about = json.loads(data.attrs["couplings"])
    return {
        name: {
            "joints": [one["follower"], one["leader"]],
            "peak_force" if one["slides"] else "peak_torque": float(
                data["peak_coupling_torque"].sel(coupling=name)
            ),
        }
        for name, one in about.items()
    }


def _motions(data: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return what it took to hold each prescribed motion: a force where the joint slides, else a torque."""
    about = json.loads(data.attrs["drives"])
    return {
        name: {
            "joint": about[name]["joint"],
            "peak_force" if about[name]["slides"] else "peak_torque": float(
                data["peak_effort"].sel(motion=name)
            ),
            "work": float(data["total_work"].sel(drive=name)),
        }
        for name in names_along(data, "motion")
    }


def _by_label(data: xr.Dataset, dim: str, entries: Mapping[str, str]) -> dict[str, dict[str, float]]:
    """Return the values of variables along one dimension, by label."""
    return {
        str(name): {entry: float(data[variable].values[k]) for entry, variable in entries.items()}
        for k, name in enumerate(data[dim].values)
    }
