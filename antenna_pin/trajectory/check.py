"""Check of a file's content against the schema of results."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, get_args
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, AllowInfNan, BaseModel, Field, TypeAdapter, ValidationError, create_model

from antenna_pin.base.units import shown
from antenna_pin.trajectory.columns import Breach, ColumnRule
from antenna_pin.trajectory.outcome import REACHED_END
from antenna_pin.trajectory.quantities import RUN, left_out_of
from antenna_pin.trajectory.read import contact_kinds, is_lean, json_in, names_along
from antenna_pin.trajectory.schema import COORDINATES, DIMENSIONS, TIME, variables_of

if TYPE_CHECKING:
    import xarray as xr


def _closure_kind(kind: str) -> str:
    """Refuse a kind of closure that there is not."""
    from antenna_pin.scenario.closures import ClosureKind  # a room that most results do not need

    known = get_args(ClosureKind)
    if kind not in known:
        raise ValueError(f"should be one of {', '.join(known)}")
    return kind


def _placed(seven: list[float]) -> list[float]:
    """Refuse a placement whose quaternion is none."""
    if abs(math.hypot(*seven[3:]) - 1.0) > _UNIT:
        raise ValueError("its quaternion should be of length 1")
    return seven


_UNIT = 1e-6  # as of the quaternions of a configuration
_Number = Annotated[float, AllowInfNan(True)]
_Finite = Annotated[float, AllowInfNan(False)]
_Three = Annotated[list[_Finite], Field(min_length=3, max_length=3)]
_Seven = Annotated[list[_Finite], Field(min_length=7, max_length=7), AfterValidator(_placed)]


def _entry(**fields: Any) -> type[BaseModel]:
    """Return a model of an entry from types or (type, default), by key."""
    pairs: dict[str, Any] = {
        key: one if isinstance(one, tuple) else (one, ...) for key, one in fields.items()
    }
    return create_model("Entry", **pairs)


# Results of earlier versions have no tolerances.
_CONSERVATION = {
    name: (_Number | None, None) if name.endswith("tolerance") else _Number | None
    for name, one in RUN.items()
    if one.source == "conservation"
}
_SCALES = Literal["gross work of the drives", "largest kinetic energy", "largest stored energy"]


class _Law(BaseModel):
    law: str
    parameters: dict[str, tuple[_Number, str]]
    dissipation: _Law | None = None


_CONTACT = _entry(kind=str, end=str, normal_law=_Law, depth_limit=_Number, limited_by=str)


class JsonAttribute(NamedTuple):
    """Attribute of a result that is text with JSON."""

    content: Any  # its type
    dim: str = ""  # dimension along which the names of its entries are
    bodies: tuple[str, ...] = ()  # keys of an entry for links and joints of the URDF
    required: bool = False


def _entries(dim: str, *bodies: str, required: bool = False, **fields: Any) -> JsonAttribute:
    return JsonAttribute(dict[str, _entry(**fields)], dim, bodies, required)  # type: ignore[misc]


#: Attributes that are text with JSON, by name.
JSON_ATTRIBUTES: dict[str, JsonAttribute] = {
    "conservation": JsonAttribute(_entry(**_CONSERVATION, energy_scale_of=_SCALES), required=True),
    "mechanism": JsonAttribute(
        _entry(
            base=Literal["free", "fixed"],
            gravity=_Three,
            allow_impossible_inertia=list[str],
            package_path=(list[str], []),
            impossible_inertia=(list[str], []),
        ),
        required=True,
    ),
    "versions": JsonAttribute(dict[str, str]),
    "clearance_joints": _entries(
        "clearance_joint",
        "bearing_body",
        "journal_body",
        required=True,
        kind=str,
        dimensions=dict[str, _Finite],
        bearing_on=Literal["parent", "child"],
        bearing_body=str,
        bearing_placement=_Seven,
        journal_body=str,
        journal_placement=_Seven,
        contacts=dict[str, _CONTACT],  # type: ignore[valid-type]
        friction_law=_Law,
        approach_speed_floor=_Number,
        backend=str,
        load=Literal["point", "distributed"],
    ),
    "drives": _entries("drive", "joint", required=True, joint=str, slides=bool, motion=bool),
    "elements": _entries(
        "element", kind=str, joint=str | None, slides=bool, modes=list[str], numbers=dict[str, _Number]
    ),
    "joint_friction": _entries(
        "", "joint", joint=str, slides=bool, damping=_Number, friction=_Number, regularisation_speed=_Number
    ),
    "point_springs": _entries(
        "point_spring",
        "first_body",
        "second_body",
        first_body=str,
        first_point=_Three,
        second_body=str,
        second_point=_Three,
    ),
    "forces": _entries("force", kind=str, numbers=dict[str, _Number]),
    "force_places": _entries("force_place", "link", force=str, link=str, point=_Three),
    "elastic_parts": _entries(
        "elastic_part",
        "hub",
        "body",
        hub=str,
        body=str,
        slides=bool,
        frequency=_Number,
        damping_ratio=_Number,
        moved=_Number,
    ),
    "closures": _entries(
        "closure",
        "first_body",
        "second_body",
        kind=Annotated[str, AfterValidator(_closure_kind)],
        equations=int,
        axis=bool,
        first_body=str,
        first_placement=_Seven,
        second_body=str,
        second_placement=_Seven,
    ),
    "couplings": _entries(
        "coupling",
        "follower",
        "leader",
        follower=str,
        leader=str,
        multiplier=_Number,
        offset=_Number,
        slides=bool,
        leader_slides=bool,
        second=(str | None, None),
        second_multiplier=(_Number, 1.0),
        second_slides=(bool, False),
    ),
    "constraints": JsonAttribute(dict[str, Any]),
    "left_out": JsonAttribute(list[str]),
    "assumed": JsonAttribute(list[str]),
}


def problem_of_json(name: str, text: object) -> str:
    """Return the first fault of an attribute's text; empty without any."""
    try:
        _adapter(name).validate_python(json.loads(text) if isinstance(text, str) else text)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(map(str, first["loc"]))
        return f"{place + ': ' if place else ''}{first['msg']}"
    except (ValueError, RecursionError) as error:
        return str(error)
    return ""


@cache
def _adapter(name: str) -> TypeAdapter[Any]:
    return TypeAdapter(JSON_ATTRIBUTES[name].content)


_ROWS = 65536  # that are looked at at once
# What sums may be off by: of their own largest number, for the dense output of an integral, and of the
# largest in their unit, for round-off.
_OWN, _OTHER = 1e-2, 1e-9
# What a run has come to is finite, however it ended; what follows from that need not be.
_ALWAYS = {"time", "q", "v"}
_PARTS = ({"qx", "qy", "qz", "qw"}, {"cos", "sin"})
_DIRECTION = ColumnRule(unit=True)


def problems_of_numbers(data: xr.Dataset) -> Iterator[str]:
    """Yield impossible numbers of a result: column, place, value and rule."""
    if "episode" in data.sizes:
        index = data["episode_contact"].values
        if index.dtype.kind not in "iu" or (index < 0).any() or (index >= data.sizes["contact"]).any():
            yield "numbers in 'episode_contact' that are of no contact"
            return
    columns = [("time", TIME)] if not is_lean(data) else []
    columns += [
        (one.name, one.rule) for one in variables_of({str(dim) for dim in data.sizes}, free_base=True)
    ]
    at_end = data.attrs["outcome"] in {one.name for one in REACHED_END}
    for name, rule in columns:
        if name not in data.variables:
            continue
        finite = at_end or name in _ALWAYS
        problems = list(_in_column(data, name, rule, finite, slice(None)))
        if problems and rule.passive:  # which contacts it binds is looked up where that matters
            problems = list(_in_column(data, name, rule, finite, _dissipative(data, name)))
        yield from problems
    if not is_lean(data):
        time = data["time"].values
        if len(time) > 1 and time[-1] == time[0]:
            yield f"all {len(time)} samples of 'time' at one instant, {time[0]:g} s"
        for place, part in _directions(data):
            yield from _in_column(data, "q", _DIRECTION, True, part, f"{place!r} of 'q'")


def _in_column(
    data: xr.Dataset, name: str, rule: ColumnRule, finite: bool, part: Any, title: str = ""
) -> Iterator[str]:
    """Yield the first breach in a variable, or in a part of its last dimension."""
    variable, before = data.variables[name], None
    along = variable.dims[0] == "time"
    for first in range(0, max(variable.shape[0], 1) if along else 1, _ROWS):
        rows = slice(first, first + _ROWS) if along else slice(None)
        values = variable[rows].values if along else variable.values
        values = values[..., part] if not isinstance(part, slice) else values
        other = data.variables[rule.beside][rows].values if rule.beside in data.variables else None
        breach = rule.breach(
            values, before=before, other=other, slack=lambda: _slack(data, name), finite=finite
        )
        if breach is not None:
            yield f"{_place(data, name, first, breach, title)}, which must be {rule.words}"
            return
        before = values[-1] if values.size else before


def _place(data: xr.Dataset, name: str, start: int, breach: Breach, title: str) -> str:
    dim, row = str(data[name].dims[0]), start + breach.row
    at = f"{dim} {row}"
    if dim == "time":
        at = f"sample {row} (t = {float(data['time'].variable[row]):.9g} s)"
    return f"{breach.value} in {title or repr(name)} at {at}"


def _slack(data: xr.Dataset, name: str) -> float:
    """Return the tolerance of a sum's bounds: round-off of it and its terms."""
    units = data.variables[name].attrs.get("units")
    columns = data.variables.items()
    alike = [
        one for one, column in columns if column.dtype.kind == "f" and column.attrs.get("units") == units
    ]
    return _OWN * _largest(data, name) + _OTHER * max(_largest(data, str(one)) for one in alike)


def _largest(data: xr.Dataset, name: str) -> float:
    values = np.abs(data.variables[name].values)
    return float(values.max(initial=0.0, where=np.isfinite(values)))


def _dissipative(data: xr.Dataset, name: str) -> NDArray[np.intp]:
    """Return the columns of a lost energy that are sure not to decrease.

    Not those under a law of a user's, nor those at flanges, where the point that a force acts at moves along
    with the depth. Nor friction with bristles: some of its dampers put energy in, and what bristles hold by a
    load counts as lost until they give it back.
    """
    if data[name].dims[-1] == "element":
        bristles = set(names_along(data, "bristle"))
        return np.flatnonzero([one not in bristles for one in names_along(data, "element")])
    from antenna_pin.contact import (
        FRICTION_LAWS,
        NORMAL_LAWS,
    )  # a room that results without contacts do not need

    about, kinds, sure = json.loads(data.attrs["clearance_joints"]), contact_kinds(data), []
    joints = names_along(data, "contact_joint")
    for joint, contact in zip(joints, names_along(data, "contact"), strict=True):
        one = about[joint]
        laws = {law["normal_law"]["law"] for law in one["contacts"].values()}
        known = laws <= set(NORMAL_LAWS) and one["friction_law"]["law"] in FRICTION_LAWS
        sure.append(known and kinds[contact] != "axial")
    if data[name].dims[-1] == "episode":
        return np.flatnonzero(np.array(sure, dtype=bool)[data["episode_contact"].values])
    return np.flatnonzero(sure)


def _directions(data: xr.Dataset) -> Iterator[tuple[str, list[int]]]:
    """Yield owners and indices of unit vectors within q."""
    joints = {one.get("name") for one in ElementTree.fromstring(data.attrs["urdf"]).iter("joint")}
    owners: dict[str, dict[str, int]] = {}
    for place, label in enumerate(names_along(data, "configuration")):
        owner, _, part = label.rpartition(".")
        if label not in joints:
            owners.setdefault(owner, {})[part] = place
    for owner, parts in owners.items():
        for names in _PARTS:
            if names <= set(parts):
                yield owner, sorted(parts[one] for one in names)


# Attributes that are plain text or numbers, some of which a result may lack, and the words that one may be.
_TEXTS = ("title", "case", "outcome", "outcome_message", "counts", "scenario", "end", "urdf", "urdf_folder")
_PLAIN: dict[str, type] = {
    **dict.fromkeys((*_TEXTS, "start", "form", "kept", "advice", "finished"), str),
    **dict.fromkeys(("end_time", "gap_difference", "samples"), float),
}
_OPTIONAL = {"start", "kept", "advice", "finished", "end"}
_WORDS = {"form": ("full", "lean")}
# Variables that results of earlier versions lack.
_LATER = {"change_peak_effort", "change_peak_time", "peak_drive_effort", "time_of_peak_drive_effort"}
# Dimensions along which there may be nothing.
_MAY_BE_EMPTY = {"change", "configuration", "coordinate", "joint", "event", "episode", "tick"}
# Dimensions of labels that are always the same.
_FIXED = {"axis": ["x", "y", "z"], "quaternion": ["x", "y", "z", "w"]}


def problem_of(data: xr.Dataset) -> str | None:
    """Return the first fault of a dataset as a result; None without any."""
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
    lacking = _LATER | left_out_of(data)
    for name in names:
        if name not in data.variables and name not in lacking:
            yield f"no variable {name!r}"
    for variable in variables_of({str(dim) for dim in data.sizes}, free_base=True):
        if variable.name not in data.variables:
            continue
        found = data.variables[variable.name]
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
    for name, (_, dim, _, required) in JSON_ATTRIBUTES.items():
        if name not in found:
            if required or dim in data.sizes:
                yield f"no attribute {name!r}"
            continue
        problem = problem_of_json(name, found[name])
        if problem:
            yield f"an attribute {name!r} that cannot be read ({problem})"
        if dim and set(json.loads(found[name])) != set(names_along(data, dim)):
            yield f"other names in the attribute {name!r} than in {dim!r}"


def _places(data: xr.Dataset) -> Iterator[str]:
    """Yield entries with unknown links, joints and contacts."""
    try:
        robot = ElementTree.fromstring(data.attrs["urdf"])
    except ElementTree.ParseError as error:
        yield f"an attribute 'urdf' that cannot be read ({error})"
        return
    links = {"world", *(link.get("name") for link in robot.iter("link"))}
    joints = {joint.get("name") for joint in robot.iter("joint")}
    for name, attribute in JSON_ATTRIBUTES.items():
        table = json.loads(data.attrs.get(name, "{}")) if attribute.bodies else {}
        for entry, content in table.items():
            for key in attribute.bodies:
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
