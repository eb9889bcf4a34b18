"""Is a file's content a result? All that readers take for granted, looked at once, when it is loaded."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from antenna_pin.base.units import shown
from antenna_pin.trajectory.json_attributes import JSON_ATTRIBUTES, problem_of_json
from antenna_pin.trajectory.numbers import problems_of_numbers
from antenna_pin.trajectory.read import is_lean, json_in, names_along
from antenna_pin.trajectory.schema import COORDINATES, DIMENSIONS, variables_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["problem_of"]


# Those of them that name links and joints of the URDF, and by which keys.
_BODIES = {
    "clearance_joints": ("bearing_body", "journal_body"),
    "drives": ("joint",),
    "joint_friction": ("joint",),
    "point_springs": ("first_body", "second_body"),
    "elastic_parts": ("hub", "body"),
    "force_places": ("link",),
    "closures": ("first_body", "second_body"),
    "couplings": ("follower", "leader"),
}
# Those that are plain text or numbers.
_PLAIN: dict[str, type] = {
    "title": str,
    "case": str,
    "outcome": str,
    "outcome_message": str,
    "counts": str,
    "scenario": str,
    "end": str,
    "urdf": str,
    "urdf_folder": str,
    "start": str,
    "form": str,
    "advice": str,
    "finished": str,
    "end_time": float,
    "gap_difference": float,
    "samples": float,
}
# Those of them that are one of some words.
_WORDS = {"form": ("full", "lean")}
# Those that a result may do without.
_OPTIONAL = {
    "elements",
    "assumed",
    "joint_friction",
    "left_out",
    "point_springs",
    "forces",
    "force_places",
    "elastic_parts",
    "closures",
    "couplings",
    "constraints",
    "start",
    "advice",
    "finished",
    "end",
    "versions",
}
# Variables that results of earlier versions lack.
_LATER = {"change_peak_effort", "change_peak_time", "peak_drive_effort", "time_of_peak_drive_effort"}
# Dimensions along which there may be nothing.
_MAY_BE_EMPTY = {"change", "configuration", "coordinate", "joint", "event", "episode", "tick"}
# Dimensions of labels that are always the same.
_FIXED = {"axis": ["x", "y", "z"], "quaternion": ["x", "y", "z", "w"]}


def problem_of(data: xr.Dataset) -> str | None:
    """Return what of a result a dataset lacks or has spoiled, in words; None if it is whole."""
    for problems in (_labels, _attributes, _places, _variables, problems_of_numbers):
        for problem in problems(data):
            return problem
    return None


def _labels(data: xr.Dataset) -> Iterator[str]:
    for dim, size in data.sizes.items():
        if dim not in DIMENSIONS:
            continue
        if size == 0 and dim not in _MAY_BE_EMPTY:
            yield "no samples" if dim == "time" else f"nothing along {dim!r}"
        if dim in ("time", "episode", "tick"):
            continue
        if dim not in data.variables:
            yield f"no variable {dim!r}"
        names = data[dim].values.tolist()
        if not all(isinstance(name, str) for name in names):
            yield f"labels in {dim!r} that are not text"
        if dim not in ("event", "change") and len(set(names)) < len(names):
            yield f"labels in {dim!r} that are there twice"
        if dim in _FIXED and names != _FIXED[str(dim)]:
            yield f"{dim!r} along which stand {shown(names)}, not {shown(_FIXED[str(dim)])}"
    for coordinate in COORDINATES:
        if coordinate.dim in data.sizes and coordinate.name not in data.variables:
            yield f"no variable {coordinate.name!r}"
    for inner, outer in (
        ("contact_joint", "clearance_joint"),
        ("controller", "drive"),
        ("motion", "drive"),
        ("motor", "drive"),
        ("traced_spring", "spring"),
        ("bristle", "element"),
        ("dwelling", "bristle"),
    ):
        unknown = set(names_along(data, inner)) - set(names_along(data, outer))
        if unknown:
            yield f"{min(unknown)!r} in {inner!r} but not in {outer!r}"


def _variables(data: xr.Dataset) -> Iterator[str]:
    free = json.loads(data.attrs["mechanism"])["base"] == "free"
    wanted = list(variables_of({str(dim) for dim in data.sizes}, free))
    names = [variable.name for variable in wanted]
    names += [] if is_lean(data) else ["time", "q"]
    for name in names:
        if name not in data.variables and name not in _LATER:
            yield f"no variable {name!r}"
    for variable in variables_of({str(dim) for dim in data.sizes}, free_base=True):
        if variable.name not in data.variables:
            continue
        found = data[variable.name]
        if found.dims != variable.dims:
            yield f"{variable.name!r} along {shown(found.dims)}, not {shown(variable.dims)}"
        if found.dtype.kind not in "fiub":
            yield f"no numbers in {variable.name!r}"
        units = found.attrs.get("units", variable.units)
        if units != variable.units:
            yield f"{variable.name!r} in {shown(units)}, not in {variable.units!r}"
    if not is_lean(data) and data["time"].dtype.kind not in "fiu":
        yield "no numbers in 'time'"


def _attributes(data: xr.Dataset) -> Iterator[str]:
    found = data.attrs
    needed = {name for name, (_, dim) in JSON_ATTRIBUTES.items() if dim in data.sizes}
    for name, kind in _PLAIN.items():
        value = found.get(name)
        if name not in found and name not in _OPTIONAL:
            yield f"no attribute {name!r}"
        elif name in found and not (isinstance(value, str) if kind is str else _is_number(value)):
            yield f"an attribute {name!r} that cannot be read"
        if name in found and name in _WORDS and value not in _WORDS[name]:
            yield f"{value!r} in the attribute {name!r}, which must be one of {shown(_WORDS[name])}"
    if found["scenario"] and not isinstance(json_in(found["scenario"]), dict):
        yield f"{shown(found['scenario'])} in the attribute 'scenario', which must be a table, as JSON"
    for name, (_, dim) in JSON_ATTRIBUTES.items():
        if name not in found:
            if name in needed or name not in _OPTIONAL:
                yield f"no attribute {name!r}"
            continue
        problem = problem_of_json(name, found[name])
        if problem:
            yield f"an attribute {name!r} that cannot be read ({problem})"
        if dim and set(json.loads(found[name])) != set(names_along(data, dim)):
            yield f"other names in the attribute {name!r} than in {dim!r}"


def _places(data: xr.Dataset) -> Iterator[str]:
    """Yield what stands on links and joints that the mechanism does not have."""
    try:
        robot = ElementTree.fromstring(data.attrs["urdf"])
    except ElementTree.ParseError as error:
        yield f"an attribute 'urdf' that cannot be read ({error})"
        return
    links = {"world", *(link.get("name") for link in robot.iter("link"))}
    joints = {joint.get("name") for joint in robot.iter("joint")}
    for name, keys in _BODIES.items():
        table = json.loads(data.attrs.get(name, "{}"))
        for entry, content in table.items():
            for key in keys:
                if content[key] not in (joints if key in ("joint", "follower", "leader") else links):
                    yield f"{key} {content[key]!r} of {entry!r} in the attribute {name!r}, not in its URDF"
    about = json.loads(data.attrs["clearance_joints"])
    told = {
        contact: [name, one["kind"], one["end"]]
        for name, joint in about.items()
        for contact, one in joint["contacts"].items()
    }
    labels = [names_along(data, name) for name in ("contact_joint", "contact_kind", "contact_end")]
    for contact, *found in zip(names_along(data, "contact"), *labels, strict=True):
        if told.get(contact) != found:
            yield f"{shown(found)} for {contact!r}, which must be {shown(told.get(contact))}"
    for name in about:
        if name not in joints:
            yield f"{name!r} in the attribute 'clearance_joints' but not in its URDF"


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and not value < 0.0
