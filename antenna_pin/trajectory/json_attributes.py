"""Models of the attributes of a result that are text with JSON."""

from __future__ import annotations

import json
import math
from functools import cache
from typing import Annotated, Any, Literal, NamedTuple, get_args

from pydantic import AfterValidator, AllowInfNan, BaseModel, Field, TypeAdapter, ValidationError, create_model

from antenna_pin.trajectory.quantities import RUN


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
