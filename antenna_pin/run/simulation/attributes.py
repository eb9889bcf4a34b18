"""Attributes of a result: URDF, bearings and journals on links, laws, elements, constraints.

With them a reader needs neither the scenario nor its files, except meshes, and builds nothing: derived
parameters, such as a stiffness from materials and radii, are given as used.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.files import path_as_text
from antenna_pin.base.readable import number
from antenna_pin.contact import DISSIPATIONS, FRICTION_LAWS, NORMAL_LAWS, DampedContact
from antenna_pin.dynamics import System, constraint_counts, facts_of_couplings
from antenna_pin.dynamics.constraints import Anchor
from antenna_pin.elements import BetweenJoints, Element, JointFriction, Modal, Motion, Shake
from antenna_pin.joints import ClearanceJoint
from antenna_pin.mechanism import frame_aligning_z, quaternion
from antenna_pin.mechanism.flexible import Takes
from antenna_pin.run.simulation.constraints import SingularPosition

Array = NDArray[np.float64]

# By the full name of the class: none is loaded that is not used.
_NAMES = {
    place: name
    for names in (NORMAL_LAWS, DISSIPATIONS, FRICTION_LAWS)
    for name, place in names.places.items()
}


def mechanism_attributes(system: System) -> dict[str, str]:
    """Return the attributes of a dataset that describe the mechanism.

    ``urdf`` is the text of the simulated variant, ``urdf_folder`` the folder of its meshes (empty if
    unknown), ``mechanism`` base and gravity [m/s^2], ``clearance_joints`` :func:`carried_joints`.
    The other values are JSON by name: ``drives``; ``elements`` of further families by place, with ``numbers``
    that readers need (limits, a window), and of elements between two joints both ``joints``;
    ``point_springs`` and ``force_places`` with points in their links' frames [m]; ``forces``;
    ``elastic_parts`` with ``frequency`` [Hz] and ``damping_ratio`` [-] for a fixed hub, the ``moved`` mass
    [kg] or moment of inertia [kg m^2], and ``with``, the other parts that move the same shapes;
    ``joint_friction`` by the names among the springs. ``left_out`` and ``assumed`` are lines on parts of the
    URDF that are not simulated, and on assumptions.
    """
    mechanism = system.mechanism
    springs = {
        name: {
            "first_body": one.first[0],
            "first_point": one.first[1],
            "second_body": one.second[0],
            "second_point": one.second[1],
        }
        for name, one in system.point_springs.items()
    }
    packages = mechanism.urdf.package_path
    frictions = {
        name: {**dataclasses.asdict(one), "slides": system.slides(one.joint)}
        for name, one in system.springs.items()
        if isinstance(one, JointFriction)
    }
    return {
        "urdf": mechanism.urdf.to_xml(),
        "urdf_folder": "" if mechanism.urdf.folder is None else path_as_text(mechanism.urdf.folder),
        "mechanism": json.dumps(
            {
                "base": mechanism.base,
                "gravity": [float(g) for g in mechanism.model.gravity.linear],
                "allow_impossible_inertia": list(mechanism.urdf.allow_impossible_inertia),
            }
            | ({"package_path": list(map(str, packages))} if packages else {})
            | ({"impossible_inertia": list(mechanism.impossible)} if mechanism.impossible else {})
        ),
        "clearance_joints": json.dumps(carried_joints(system)),
        **({"elements": json.dumps(elements)} if (elements := _elements(system)) else {}),
        "drives": json.dumps({name: _drive(system, drive) for name, drive in system.drives.items()}),
        **({"point_springs": json.dumps(springs)} if springs else {}),
        **({"forces": json.dumps(forces)} if (forces := _forces(system)) else {}),
        **({"force_places": json.dumps(places)} if (places := _force_places(system)) else {}),
        **({"joint_friction": json.dumps(frictions)} if frictions else {}),
        **{
            name: json.dumps(lines)
            for name, lines in (("left_out", system.left_out), ("assumed", system.assumed))
            if lines
        },
        **({"elastic_parts": json.dumps(_elastic_parts(system))} if system.elastic else {}),
    }


def _elements(system: System) -> dict[str, dict[str, Any]]:
    """Return the descriptions of elements of further families, by place."""
    found = {}
    for table in system.others:
        for name, one in system.families[table].items():
            joint = one.acts_at
            between = one if isinstance(one, BetweenJoints) else None
            found[f"{table}.{name}"] = {
                "kind": type(one).__name__,
                "joint": joint,
                **({"joints": [between.input, between.output]} if between else {}),
                "slides": between.along if between else joint is not None and system.slides(joint),
                "modes": list(getattr(one, "modes", ())),
                "numbers": one.facts() if isinstance(one, Modal) else {},
            }
    return found


def _forces(system: System) -> dict[str, dict[str, Any]]:
    """Return the descriptions of forces, by name: class and numbers that readers need."""
    return {name: {"kind": type(one).__name__, "numbers": one.facts()} for name, one in system.forces.items()}


def _force_places(system: System) -> dict[str, dict[str, Any]]:
    """Return the points of application of forces, by name."""
    return {
        one.name: {"force": one.force, "link": one.link, "point": one.point} for one in system.force_places
    }


def _elastic_parts(system: System) -> dict[str, dict[str, Any]]:
    found = {}
    for name, part in system.elastic.items():
        joint = system.mechanism.urdf.joint(name)
        found[name] = {
            "hub": joint.parent,
            "body": joint.child,
            "slides": part.slides,
            "frequency": part.frequency,
            "damping_ratio": part.damping_ratio,
            "moved": part.moved,
        }
        if with_it := _moving_the_same(system, name):
            found[name]["with"] = with_it
    return found


def _moving_the_same(system: System, name: str) -> list[str]:
    """Return the later elastic parts that move a shape on the body of this part."""
    hub = system.mechanism.urdf.joint(name).parent
    same = [one for one in system.elastic if system.mechanism.urdf.joint(one).parent == hub]
    shapes = {part: _shapes(system, part) for part in same}
    before = set().union(*(shapes[one] for one in same[: same.index(name)]))
    own = shapes[name] - before
    return [one for one in same[same.index(name) + 1 :] if shapes[one] & own]


def _shapes(system: System, part: str) -> set[str]:
    return {drawn.shape for drawn in system.elastic[part].drawn if isinstance(drawn, Takes)}


def _drive(system: System, drive: Element) -> dict[str, Any]:
    about = {"joint": drive.joint, "slides": system.slides(drive.joint), "motion": isinstance(drive, Motion)}
    return about | ({"shakes": drive.carried()} if isinstance(drive, Shake) else {})


def carried_joints(system: System) -> dict[str, dict[str, Any]]:
    """Return the descriptions of the clearance joints, by name.

    Dimensions are in [m]; ``bearing_placement`` and ``journal_placement`` are seven numbers, position [m] and
    attitude (quaternion xyzw) in the frame of ``bearing_body`` and ``journal_body``. Each of the ``contacts``
    has its ``depth_limit`` [m], with the reason ``limited_by``. A law has its name, ``law``, and
    ``parameters`` as used, [value, unit] by name; with the dissipation of another law, ``dissipation``.
    """
    return {joint.name: _place(system, joint) | _laws(joint) for joint in system.clearances}


def _laws(joint: ClearanceJoint) -> dict[str, Any]:
    rows = zip(
        joint.contact_names,
        joint.geometry.contact_places,
        joint.normal_laws,
        joint.depth_limits,
        joint.limit_reasons,
        strict=True,
    )
    return {
        "contacts": {
            name: {
                "kind": kind,
                "end": end,
                "normal_law": _law(law),
                "depth_limit": limit,
                "limited_by": reason,
            }
            for name, (kind, end), law, limit, reason in rows
        },
        "friction_law": _law(joint.friction),
        "approach_speed_floor": joint.approach_speed_floor,
        "backend": joint.backend if isinstance(joint.backend, str) else type(joint.backend).__name__,
        "load": joint.load,
    }


def _law(law: Any) -> dict[str, Any]:
    """Return name and parameters of a law; of a law in Python the class's name."""
    if isinstance(law, DampedContact):
        return {**_law(law.elastic), "dissipation": _law(law.dissipation)}
    parameters = {}
    for item in dataclasses.fields(law) if dataclasses.is_dataclass(law) else ():
        value = getattr(law, item.name)
        if isinstance(value, int | float):
            unit = str(item.metadata.get("unit", "1"))
            if "exponent" in unit:
                unit = unit.replace("exponent", number(law.exponent, 6))
            parameters[item.name] = [float(value), unit]
    cls = type(law)
    name = _NAMES.get(f"{cls.__module__}.{cls.__qualname__}", cls.__name__)
    return {"law": name, "parameters": parameters}


def _place(system: System, joint: ClearanceJoint) -> dict[str, Any]:
    urdf = system.mechanism.urdf
    slot = system.mechanism.joint(joint.name)
    own = np.eye(4)
    if not joint.planar:
        own[:3, :3] = frame_aligning_z(slot.axis)
        own[:3, 3] = joint.offset * own[:3, 2]
    in_child, child = own, urdf.joint(joint.name).child
    links = {link.name: link for link in urdf.robot.links}
    # The massless link of a planar joint carries no shape: what is mounted on it is the joint's body there.
    mounts = [other for other in urdf.robot.joints if other.parent == child and other.type == "fixed"]
    if links[child].inertial is None and len(mounts) == 1:
        in_child, child = np.linalg.inv(urdf.placement(mounts[0].name)) @ own, mounts[0].child
    bearing = (urdf.joint(joint.name).parent, _seven(urdf.placement(joint.name) @ own))
    journal = (child, _seven(in_child))
    if joint.bearing_on == "child":
        bearing, journal = journal, bearing
    return {
        "kind": joint.geometry.kind,
        "dimensions": dataclasses.asdict(cast(Any, joint.geometry)),
        "bearing_on": joint.bearing_on,
        "bearing_body": bearing[0],
        "bearing_placement": bearing[1],
        "journal_body": journal[0],
        "journal_placement": journal[1],
    }


def _seven(placement: NDArray[np.float64]) -> list[float]:
    return [*placement[:3, 3].tolist(), *quaternion(placement[:3, :3]).tolist()]


# --- constraints --------------------------------------------------------------------------------------------

# Of positions, angles and their rates, in the order of ``Observed.residual``.
_RESIDUALS = ("position_residual", "angle_residual", "velocity_residual", "rate_residual")


def constraint_attributes(
    system: System, start: Array, end: Array, residual: Array, passed: Sequence[SingularPosition]
) -> dict[str, str]:
    """Return the attributes of a dataset that describe its constraints; none without constraints.

    ``closures`` (JSON) has of each closure its links and the frames there, position [m] and attitude
    (quaternion xyzw), and whether it has an ``axis``, z of the placements; ``couplings`` (JSON) joints and
    numbers of each coupling. ``constraints`` (JSON) has :func:`antenna_pin.dynamics.constraint_counts`, the
    largest residuals at samples [m, rad, m/s, rad/s], the energy that corrections of the state after each
    step put in [J], and the singular positions passed: ``time`` [s] and ``share``, the rest of the least
    independent equation there.

    Args:
        system: System of the run.
        start: [q, v, x] at the first sample.
        end: [q, v, x] at the last sample.
        residual: The largest at samples, (4,), as of ``Observed.residual``.
        passed: The singular positions.
    """
    if system.plan is None:
        return {}
    booked = system.model.nq + system.model.nv + system.projection_x[0]
    put_in = end[booked] - start[booked]
    couplings = facts_of_couplings(system.mechanism, system.couplings)
    return {
        "closures": json.dumps(
            {
                name: {
                    "kind": one.kind,
                    "equations": one.holds.rows,
                    "axis": one.holds.axis,
                    **_side("first", one.first),
                    **_side("second", one.second),
                }
                for name, one in system.closures.items()
            }
        ),
        **({"couplings": json.dumps(couplings)} if couplings else {}),
        "constraints": json.dumps(
            {
                **constraint_counts(system, start),
                **dict(zip(_RESIDUALS, residual.tolist(), strict=True)),
                "projection_energy": float(put_in),
                "singular": [one._asdict() for one in passed],
            }
        ),
    }


def _side(name: str, anchor: Anchor) -> dict[str, Any]:
    return {
        f"{name}_body": anchor.link,
        f"{name}_placement": [*map(float, anchor.origin), *quaternion(anchor.rotation).tolist()],
    }
