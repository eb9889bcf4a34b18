"""A run in plain numbers: how it ended, counts, peaks, impulses, conservation."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from antenna_pin.trajectory.blows import blow_counts
from antenna_pin.trajectory.meshes import met_by_meshes
from antenna_pin.trajectory.quantities import GROUPS, entries_of, reduced
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
        "motion": entries_of(data, "joint"),
        "contacts": {},
    }
    result |= {
        key: entries_of(data, GROUPS[key].dim)
        for key in ("slides", "elastic_parts")
        if GROUPS[key].dim in data.sizes
    }
    if constraints:
        result["constraints"] = constraints
        result["closures"] = _closures(data)
        result["motions"] = _motions(data)
    if "coupling" in data.sizes:
        result["couplings"] = _couplings(data)
    result |= met_by_elements(data)
    if gears := met_by_meshes(data):
        result["gears"] = gears
    result |= {
        key: entries_of(data, GROUPS[key].dim)
        for key in ("controllers", "bearings", "forces")
        if GROUPS[key].dim in data.sizes
    }
    if "contact" not in data.sizes:
        return result
    index, end = data["episode_contact"].values, float(data.attrs["end_time"])
    result["contacts"] = {
        name: {
            one.key(): reduced(one, data, index == number, end)
            for one in GROUPS["contacts"].variables
            if one.key()
        }
        for number, name in enumerate(names_along(data, "contact"))
    }
    result["blows"] = {name: {"blows": count} for name, count in blow_counts(data).items()}
    return result


def _closures(data: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return what each closure joins and carried at most."""
    about, carried = json.loads(data.attrs["closures"]), entries_of(data, "closure")
    return {
        name: {"kind": one["kind"], "links": [one["first_body"], one["second_body"]], **carried[name]}
        for name, one in about.items()
    }


def _couplings(data: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return what each coupling joins, and its largest force where the follower slides, else torque."""
    about, carried = json.loads(data.attrs["couplings"]), entries_of(data, "coupling")
    return {
        name: {"joints": [one["follower"], one["leader"]], **carried[name]} for name, one in about.items()
    }


def _motions(data: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return what it took to hold each prescribed motion: a force where the joint slides, else a torque."""
    about, works = json.loads(data.attrs["drives"]), entries_of(data, "drive")
    return {
        name: {"joint": about[name]["joint"], **one, "work": works[name]["work"]}
        for name, one in entries_of(data, "motion").items()
    }
