"""Pinocchio model of a URDF, with joints and bodies by name."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal, NamedTuple, cast

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.capacity import check_fits
from antenna_pin.base.readable import brief
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.mechanism.edits import plane_names
from antenna_pin.mechanism.frames import Matrix3, Vector3, frame_aligning_z
from antenna_pin.mechanism.inertia import (
    Impossible,
    RigidGroup,
    check_regular,
    idle_with,
    impossible_inertia,
    is_regular_everywhere,
    rigid_groups,
    said_of_idle,
)
from antenna_pin.mechanism.urdf import Urdf

# --- size of a mechanism ------------------------------------------------------------------------------------

# What a run needs over the cube of the degrees of freedom [bytes]: Pinocchio's Data has four tensors of that
# size (second derivatives, which nobody asks for), and there are up to three of it at a time.
_PINOCCHIO = 3 * 4 * 8


@takes()
def check_size(where: str, freedoms: int, way_out: str = "leave joints out or lock some") -> None:
    """Refuse a number of degrees of freedom that would not fit into memory."""
    more = "as Pinocchio's buffers grow with the cube of that number"
    check_fits(where, f"{freedoms} degrees of freedom", _PINOCCHIO * freedoms**3, f"{way_out}, {more}")


# --- model --------------------------------------------------------------------------------------------------

Base = Literal["free", "fixed"]

JointKind = Literal["revolute", "continuous", "prismatic", "floating", "planar", "spherical"]
"""As URDF calls them; ``spherical`` is for models that do not come from one.

Sizes (nq, nv): revolute and prismatic (1, 1); continuous (2, 1) with q = (cos, sin); floating (7, 6) with
q = (x, y, z, quaternion xyzw); planar (4, 3) with q = (x, y, cos, sin)."""

#: The name of what does not move, wherever a link is named.
WORLD = "world"

# What Pinocchio calls the joint of a free base.
_ROOT_JOINT = "root_joint"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class JointSlot:
    """Place of a moving joint in the state, and direction of its axis.

    Two frames are distinguished. The *URDF frame* is the joint's frame in the ideal URDF; the *joint frame*
    is Pinocchio's, which ``q``, ``v`` and ``tau`` refer to. They differ by ``frame_rotation`` at a planar
    joint and are the same at others.

    Attributes:
        name: The URDF joint.
        kind: What it is in this variant.
        joint_id: Index in Pinocchio's lists of joints.
        q: Its part of the configuration.
        v: Its part of the generalized velocity and force.
        axis: (3,) unit, in the URDF frame [-]. Of a floating joint: the axis it had as a hinge.
        frame_rotation: (3, 3), the joint frame's axes in the URDF frame [-]: ``frame_aligning_z(axis)`` at a
            hinge made planar, whose joint frame has z along the axis; the identity at others.
    """

    name: str
    kind: JointKind
    joint_id: int
    q: slice
    v: slice
    axis: Vector3
    frame_rotation: Matrix3

    @property
    def slides(self) -> bool:
        """Return whether it slides along its axis, and that alone."""
        return self.kind == "prismatic"

    @property
    def turns(self) -> bool:
        """Return whether it turns about its axis, and that alone."""
        return self.kind in ("revolute", "continuous")

    @property
    def has_one_axis(self) -> bool:
        """Return whether it has one degree of freedom, along or about its axis."""
        return self.slides or self.turns

    @property
    def ways(self) -> slice:
        """Its translations among the generalized velocities; they come before its turns."""
        count = {"floating": 3, "planar": 2, "prismatic": 1}.get(self.kind, 0)
        return slice(self.v.start, self.v.start + count)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Mechanism:
    """A Pinocchio model of a URDF variant.

    Do not alter the model; each run has its own ``pin.Data``. Links joined by fixed joints are one
    body, whose inertia Pinocchio sums up at the joint that moves it; every link keeps a frame of its own (see
    :meth:`frame`).

    Attributes:
        name: Name of the URDF's robot.
        model: ``pin.Model``, gravity set.
        urdf: The variant it was built from.
        base: ``free`` (six degrees of freedom first in ``q`` and ``v``, named root_joint in the model) or
            ``fixed``.
        joints: The moving joints in the model's order, without the free base.
        base_body: Name of the body that is the base.
        bodies: Names of the moving bodies in the model's order, so body ``i`` is moved by joint ``i + 1``; a
            free base comes first. A body bears the name of its first link that has an inertial.
        impossible: Impossible moments of inertia of acting bodies, one line of text a body.
        negative: The first of them with a negative moment, or "".
        regular_everywhere: Whether every body has inertia of its own, so that no pose has to be tried.
    """

    __repr__ = brief

    name: str
    model: Any
    urdf: Urdf
    base: Base
    joints: dict[str, JointSlot]
    base_body: str
    bodies: tuple[str, ...]
    impossible: tuple[str, ...] = ()
    negative: str = ""
    regular_everywhere: bool = False

    def joint(self, name: str) -> JointSlot:
        """Return a moving joint by name."""
        try:
            return self.joints[name]
        except KeyError:
            raise UnknownNameError(f"mechanism {self.name!r}", "moving joint", name, self.joints) from None

    def frame(self, link: str) -> int:
        """Return the index of a link's frame in the model.

        The joint ``frames[index].parentJoint`` moves it, and ``frames[index].placement`` is its place in that
        joint's frame, also for links that fixed joints make part of another body.
        """
        self.urdf.link(link)
        return int(self.model.getFrameId(link, pin.FrameType.BODY))

    def check_regular(self, ties: NDArray[np.float64]) -> None:
        """Refuse a mechanism with a joint that can move without any inertia in every pose.

        Args:
            ties: Rows of couplings, ties v = 0, (k, nv).

        Raises:
            MechanismError: It names the joint.
        """
        if self.regular_everywhere:
            return
        moved = _moved(self.urdf, rigid_groups(self.urdf.robot))
        check_regular(self.model, self.urdf.where, moved, _ROOT_JOINT, ties, negative=self.negative)

    def check_pose(self, q: NDArray[np.float64], where: str, ties: NDArray[np.float64] | None = None) -> None:
        """Refuse a configuration in which a joint can move without any inertia.

        This concerns bodies without full inertia (a point, a rod, a frame) on several joints.

        Args:
            q: Configuration (nq,).
            where: Beginning of messages.
            ties: Rows of couplings, ties v = 0, (k, nv); None for those of the URDF.

        Raises:
            MechanismError: It names the joint.
        """
        if self.regular_everywhere:
            return
        idle = idle_with(self.model, q, _ties_of(self) if ties is None else ties)
        if idle is not None:
            moved = _moved(self.urdf, rigid_groups(self.urdf.robot))
            said = said_of_idle(self.model, idle, moved, _ROOT_JOINT)
            raise MechanismError(f"{where}: in this pose {said}; or choose another pose")

    @property
    def base_q(self) -> slice:
        """Free base in ``q``: position [m] and quaternion xyzw; empty if fixed."""
        return slice(0, 7 if self.base == "free" else 0)

    @property
    def base_v(self) -> slice:
        """Free base in ``v``: its twist in its own axes [m/s, rad/s]; empty if fixed."""
        return slice(0, 6 if self.base == "free" else 0)


@takes(gravity="m/s**2")
def build_mechanism(
    urdf: Urdf,
    base: Base = "free",
    gravity: Sequence[float] = (0.0, 0.0, 0.0),
    armature: Mapping[str, float] = MappingProxyType({}),
    *,
    regular: bool = True,
) -> Mechanism:
    """Build the Pinocchio model of a URDF.

    A root link called ``world`` is on a fixed base, and is the world wherever a place is named.

    Args:
        urdf: The variant to build.
        base: ``free`` lets the root link float in the world, ``fixed`` holds it there.
        gravity: (3,) in world axes [m/s^2].
        armature: Moment of inertia that a joint feels by its rate alone [kg*m^2], by the names of revolute
            and continuous joints: ratio^2 times that of a motor's rotor. Its carrier takes no reaction.
        regular: Whether a joint that can move without any inertia in every pose is refused here; where
            couplings are added to those of the URDF, use :meth:`Mechanism.check_regular`.
    """
    if base not in ("free", "fixed"):
        raise InvalidParameterError("build_mechanism", "base", "'free' or 'fixed'", base)
    acceleration = np.array(gravity, dtype=np.float64)
    if acceleration.shape != (3,) or not np.all(np.isfinite(acceleration)):
        raise InvalidParameterError("build_mechanism", "gravity", "three finite numbers [m/s^2]", gravity)
    read = _read(urdf, base)
    model = read.model.copy()
    model.gravity = pin.Motion(acceleration, np.zeros(3))
    moving = list(model.names)[1:]
    joints = {name: _slot(model, urdf, name) for name in moving if name != _ROOT_JOINT}
    _put_armature(model, joints, armature)
    made = Mechanism(
        name=urdf.name,
        model=model,
        urdf=urdf,
        base=base,
        joints=joints,
        base_body=read.base_body,
        bodies=tuple(read.moved[name].name for name in moving),
        impossible=tuple(one.said for one in read.impossible),
        negative=next((one.said for one in read.impossible if one.negative), ""),
        regular_everywhere=read.regular_everywhere,
    )
    if regular:
        made.check_regular(_ties_of(made))
    return made


def _ties_of(mechanism: Mechanism) -> NDArray[np.float64]:
    """Return the rate constraints by the URDF's couplings, (k, nv)."""
    rows = []
    for name, mimic in mechanism.urdf.mimics.items():
        row = np.zeros(mechanism.model.nv)
        for joint, factor in ((name, 1.0), (mimic["leader"], -mimic["multiplier"])):
            if joint in mechanism.joints:
                row[mechanism.joints[joint].v.start] += factor
        rows.append(row)
    return np.array(rows).reshape(-1, mechanism.model.nv)


class _Model(NamedTuple):
    """Parts of a URDF that are read once.

    Attributes:
        model: Pinocchio's, to be copied.
        base_body: Name of the body of the root link.
        moved: The links that each joint moves as one body, by the joint's name.
        impossible: Bodies with inertia that no body can have.
        regular_everywhere: Whether no pose has a joint that moves without inertia, as far as is plain.
    """

    model: Any
    base_body: str
    moved: Mapping[str, RigidGroup]
    impossible: tuple[Impossible, ...]
    regular_everywhere: bool


@functools.lru_cache(maxsize=4)  # of variants that are made once and used by many systems
def _read(urdf: Urdf, base: Base) -> _Model:
    """Return a URDF's checked Pinocchio model, without gravity and armature."""
    groups = rigid_groups(urdf.robot)
    try:
        model = pin.buildModelFromXML(
            urdf.simulated, *((pin.JointModelFreeFlyer(),) if base == "free" else ())
        )
    except ValueError as error:
        raise MechanismError(
            f"{urdf.where}: Pinocchio cannot read this URDF: {' '.join(str(error).split())}"
        ) from error
    _check_world(model, urdf)
    if model.nv == 0:
        raise MechanismError(f"{urdf.where}: nothing moves: the base is fixed and so is every joint")
    check_size(urdf.where, model.nv)
    _check_mass(model, urdf)
    found = (
        impossible_inertia(group, urdf.allow_impossible_inertia, urdf.rounding)
        for first, group in groups.items()
        if base == "free" or first != urdf.root
    )
    impossible = tuple(one for one in found if one is not None)
    return _Model(
        model, groups[urdf.root].name, _moved(urdf, groups), impossible, is_regular_everywhere(model)
    )


def _put_armature(model: Any, joints: Mapping[str, JointSlot], armature: Mapping[str, float]) -> None:
    """Set the inertia that joints feel by their own rates alone."""
    given = np.zeros(model.nv)
    for name, inertia in armature.items():
        slot = joints.get(name)
        if slot is None or not slot.turns:
            turning = ", ".join(one for one, own in joints.items() if own.turns)
            rule = f"at a joint that turns, without play ({turning or 'there is none'})"
            raise InvalidParameterError("build_mechanism", "armature", rule, name)
        if not 0.0 <= inertia < math.inf:
            rule = "zero or more and finite [kg*m^2]"
            raise InvalidParameterError("build_mechanism", f"armature[{name!r}]", rule, inertia)
        given[slot.v] = inertia
    model.armature = given


def _moved(urdf: Urdf, groups: Mapping[str, RigidGroup]) -> dict[str, RigidGroup]:
    """Return the links that each joint moves as one body, by the joint's name."""
    return {j.name: groups[j.child] for j in urdf.robot.joints if j.child in groups} | {
        _ROOT_JOINT: groups[urdf.root]
    }


def _slot(model: Any, urdf: Urdf, name: str) -> JointSlot:
    joint_id = int(model.getJointId(name))
    q, v = int(model.idx_qs[joint_id]), int(model.idx_vs[joint_id])
    kind = cast(JointKind, urdf.joint(name).type)
    axis, rotation = urdf.axis(name), np.eye(3)
    link, mount = plane_names(name)
    if kind == "planar" and any(j.name == mount and j.parent == link for j in urdf.robot.joints):
        axis = urdf.axis(mount)  # written in the axes of the frame as it was
        rotation = frame_aligning_z(axis)
    for array in (axis, rotation):
        array.setflags(write=False)
    return JointSlot(
        name=name,
        kind=kind,
        joint_id=joint_id,
        q=slice(q, q + int(model.nqs[joint_id])),
        v=slice(v, v + int(model.nvs[joint_id])),
        axis=axis,
        frame_rotation=rotation,
    )


def _check_world(model: Any, urdf: Urdf) -> None:
    """Refuse a link called ``world`` that moves or is displaced from the world."""
    if all(link.name != WORLD for link in urdf.robot.links):
        return
    frame = model.frames[model.getFrameId(WORLD, pin.FrameType.BODY)]
    if frame.parentJoint == 0 and frame.placement.isIdentity():
        return
    got, out = ("a free base", "take base = 'fixed', or ") if urdf.root == WORLD else ("another link", "")
    raise MechanismError(
        f"{urdf.where}: link {WORLD!r} must be the root on a fixed base, for its name means what does not "
        f"move, got {got}; {out}rename it"
    )


def _check_mass(model: Any, urdf: Urdf) -> None:
    """Check the total mass: Pinocchio's parser drops inertials that it cannot read."""
    mass = sum(inertia.mass for inertia in model.inertias)
    expected = sum(link.inertial.mass for link in urdf.robot.links if link.inertial is not None)
    if not abs(mass - expected) <= 1e-12 * expected:  # round-off of a sum
        raise MechanismError(
            f"{urdf.where}: Pinocchio reads a total mass of {mass:g} kg, the URDF has {expected:g} kg"
        )
