"""What the attributes of a result hold that are text with JSON, and what of it is not as it must be."""

from __future__ import annotations

import json
import math
from functools import cache
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, AllowInfNan, BaseModel, Field, TypeAdapter, ValidationError

__all__ = ["JSON_ATTRIBUTES", "problem_of_json"]


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


class _Conservation(BaseModel):
    energy_error: _Number | None
    gross_work: _Number | None
    energy_scale: _Number | None
    energy_scale_of: Literal["gross work of the drives", "largest kinetic energy", "largest stored energy"]
    energy_error_relative: _Number | None
    energy_tolerance: _Number | None = None  # of results before there was one
    linear_momentum_drift: _Number | None
    linear_momentum_scale: _Number | None
    linear_momentum_drift_relative: _Number | None
    linear_momentum_tolerance: _Number | None = None
    angular_momentum_drift: _Number | None
    angular_momentum_scale: _Number | None
    angular_momentum_drift_relative: _Number | None
    angular_momentum_tolerance: _Number | None = None


class _Mechanism(BaseModel):
    base: Literal["free", "fixed"]
    gravity: _Three
    allow_impossible_inertia: list[str]
    package_path: list[str] = Field(default_factory=list)
    impossible_inertia: list[str] = Field(default_factory=list)


class _Law(BaseModel):
    law: str
    parameters: dict[str, tuple[_Number, str]]
    dissipation: _Law | None = None


class _Contact(BaseModel):
    kind: str
    end: str
    normal_law: _Law
    depth_limit: _Number
    limited_by: str


class _Joint(BaseModel):
    kind: str
    dimensions: dict[str, _Finite]
    bearing_on: Literal["parent", "child"]
    bearing_body: str
    bearing_placement: _Seven
    journal_body: str
    journal_placement: _Seven
    contacts: dict[str, _Contact]
    friction_law: _Law
    approach_speed_floor: _Number
    backend: str
    load: Literal["point", "distributed"]


class _Drive(BaseModel):
    joint: str
    slides: bool
    motion: bool


class _Element(BaseModel):
    kind: str
    joint: str | None
    slides: bool
    modes: list[str]
    numbers: dict[str, _Number]


class _JointFriction(BaseModel):
    joint: str
    slides: bool
    damping: _Number
    friction: _Number
    regularisation_speed: _Number


class _PointSpring(BaseModel):
    first_body: str
    first_point: _Three
    second_body: str
    second_point: _Three


class _Force(BaseModel):
    kind: str
    numbers: dict[str, _Number]


class _ForcePlace(BaseModel):
    force: str
    link: str
    point: _Three


class _ElasticPart(BaseModel):
    hub: str
    body: str
    slides: bool
    frequency: _Number
    damping_ratio: _Number
    moved: _Number


class _Closure(BaseModel):
    kind: Annotated[str, AfterValidator(_closure_kind)]
    equations: int
    axis: bool
    first_body: str
    first_placement: _Seven
    second_body: str
    second_placement: _Seven


class _Coupling(BaseModel):
    follower: str
    leader: str
    multiplier: _Number
    offset: _Number
    slides: bool
    leader_slides: bool
    second: str | None = None
    second_multiplier: _Number = 1.0
    second_slides: bool = False


#: Attributes that are text with JSON: what is in it, and along which dimension its names are.
JSON_ATTRIBUTES: dict[str, tuple[Any, str]] = {
    "conservation": (_Conservation, ""),
    "mechanism": (_Mechanism, ""),
    "versions": (dict[str, str], ""),
    "clearance_joints": (dict[str, _Joint], "clearance_joint"),
    "drives": (dict[str, _Drive], "drive"),
    "elements": (dict[str, _Element], "element"),
    "joint_friction": (dict[str, _JointFriction], ""),
    "point_springs": (dict[str, _PointSpring], "point_spring"),
    "forces": (dict[str, _Force], "force"),
    "force_places": (dict[str, _ForcePlace], "force_place"),
    "elastic_parts": (dict[str, _ElasticPart], "elastic_part"),
    "closures": (dict[str, _Closure], "closure"),
    "couplings": (dict[str, _Coupling], "coupling"),
    "constraints": (dict[str, Any], ""),
    "left_out": (list[str], ""),
    "assumed": (list[str], ""),
}


def problem_of_json(name: str, text: object) -> str:
    """Return what of an attribute's text is not as it must be, in words; empty if all is."""
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
    return TypeAdapter(JSON_ATTRIBUTES[name][0])
