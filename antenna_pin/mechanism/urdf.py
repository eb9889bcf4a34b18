"""A URDF that is a mechanism, and the variants of it that a scenario asks for.

yourdfpy reads the numbers. A variant is made on the XML itself rather than on yourdfpy's objects, because
their writer leaves out comments (a shipped model keeps the source of each number there), gazebo and
transmission tags and parts of joints; each variant is then read and checked again like any other file.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from antenna_pin.brief import brief
from antenna_pin.changes import JOINT_VARIANTS, JointChange, JointVariant, LinkChange
from antenna_pin.errors import MechanismError, UnknownNameError
from antenna_pin.files import replacing
from antenna_pin.flexible import MassProperties, SplitLink
from antenna_pin.mechanism import _checks, _edits, _meshes, _parts, _xml
from antenna_pin.mechanism.frames import Vector3

__all__ = ["Urdf"]


def _bytes(text: str) -> bytes:
    """Return a text as UTF-8; what no file can hold, half a letter, makes it XML that is not well-formed."""
    return text.encode("utf-8", "surrogatepass")


@lru_cache(maxsize=64)
def _written(text: str, where: str) -> str:
    """Return a URDF's text as this package writes it, its syntax checked."""
    return _xml.write(_xml.read(_bytes(text), where, "utf-8"))


@lru_cache(maxsize=64)  # every run of a study reads the same text again, some more than once
def _checked(text: str, where: str, allow_impossible_inertia: tuple[str, ...]) -> Any:
    """Return a checked URDF as yourdfpy's objects, which nobody changes."""
    _xml.read(_bytes(text), where, "utf-8")
    import yourdfpy  # which takes half a second, with all that it loads

    try:
        robot = yourdfpy.URDF.load(
            io.BytesIO(text.encode()), build_scene_graph=False, load_meshes=False
        ).robot
    except Exception as error:  # yourdfpy lets through whatever its converters raise
        raise MechanismError(f"{where}: yourdfpy cannot read this URDF: {error}") from error
    _checks.check(robot, where, allow_impossible_inertia)
    return robot


def _dynamics(joint: Any) -> dict[str, float]:
    given = joint.dynamics
    numbers = {} if given is None else {"damping": given.damping, "friction": given.friction}
    return {name: float(value) for name, value in numbers.items() if value is not None and float(value)}


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Urdf:
    """A URDF that was checked to be a mechanism: one tree of bodies that can exist.

    It is its text and nothing else, so writing it and reading it again gives the same mechanism. At
    construction it refuses XML that is not well-formed; missing, repeated or unknown names; loops and several
    roots; negative masses; inertias that no body can have, of links that fixed joints make one body
    together; axes of no length. What moves without inertia
    :func:`antenna_pin.mechanism.build_mechanism` refuses, for it hangs on the base and on all joints.

    Limits of joints are not simulated. Damping and friction of joints with an axis are
    (:attr:`joint_friction`), those of others are not (:attr:`not_simulated`).

    Attributes:
        text: The XML.
        where: What messages call it, such as its file name.
        folder: Where relative mesh file names start; None if that is unknown.
        allow_impossible_inertia: Links whose body's inertia may break the triangle rule.
        robot: The same as yourdfpy's objects (``yourdfpy.Robot``), to be read only.
    """

    __repr__ = brief

    text: str
    where: str
    folder: Path | None = None
    allow_impossible_inertia: tuple[str, ...] = ()
    robot: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Read and check."""
        robot = _checked(self.text, self.where, self.allow_impossible_inertia)
        object.__setattr__(self, "robot", robot)

    @classmethod
    def load(cls, path: str | Path, allow_impossible_inertia: Iterable[str] = ()) -> Urdf:
        """Read a URDF file; meshes are not read.

        Args:
            path: The file.
            allow_impossible_inertia: Names of links whose inertia may break the triangle rule.
        """
        path = Path(path)
        try:
            data = path.read_bytes()
        except OSError as error:
            raise MechanismError(f"{path}: cannot be read: {error.strerror}") from error
        text = _xml.write(_xml.read(data, path.name))
        return cls.from_text(text, path.name, allow_impossible_inertia, path.parent.absolute())

    @classmethod
    def from_text(
        cls,
        text: str,
        where: str,
        allow_impossible_inertia: Iterable[str] = (),
        folder: str | Path | None = None,
    ) -> Urdf:
        """Read a URDF from its text.

        Args:
            text: The XML.
            where: What messages call it.
            allow_impossible_inertia: Names of links whose inertia may break the triangle rule.
            folder: Where relative mesh file names start.
        """
        return cls(
            text=_written(text, where),
            where=where,
            folder=None if folder is None else Path(folder),
            allow_impossible_inertia=tuple(allow_impossible_inertia),
        )

    @property
    def name(self) -> str:
        """Name of the robot element."""
        return str(self.robot.name)

    @property
    def root(self) -> str:
        """Name of the link that is nobody's child."""
        return _checks.root_link(self.robot)

    @property
    def not_simulated(self) -> tuple[str, ...]:
        """One line for each joint's damping or friction that has no axis to act about; empty is good."""
        return tuple(
            f"{self.where}: joint {joint.name!r}: <dynamics> {name}={value:g} is not simulated, for the "
            f"joint is {joint.type} and has no axis; take it out"
            for joint in self.robot.joints
            if joint.type in ("floating", "planar")
            for name, value in _dynamics(joint).items()
        )

    @property
    def joint_friction(self) -> dict[str, dict[str, float]]:
        """What ``<dynamics>`` says of joints with an axis, by name: ``damping`` and ``friction`` above 0.

        Of one that turns [N*m*s/rad] and [N*m], of one that slides [N*s/m] and [N]; fields of
        :class:`antenna_pin.elements.JointFriction`.
        """
        found = {
            joint.name: _dynamics(joint)
            for joint in self.robot.joints
            if joint.type in ("revolute", "continuous", "prismatic")
        }
        return {name: numbers for name, numbers in found.items() if numbers}

    @property
    def mimics(self) -> dict[str, dict[str, Any]]:
        """What ``<mimic>`` says of joints that move, by name: ``leader``, ``multiplier`` and ``offset``.

        Fields of :class:`antenna_pin.constraints.Coupling`, in SI units. One of a fixed joint is no matter.
        """
        return {
            joint.name: {
                "leader": joint.mimic.joint,
                "multiplier": 1.0 if joint.mimic.multiplier is None else float(joint.mimic.multiplier),
                "offset": 0.0 if joint.mimic.offset is None else float(joint.mimic.offset),
            }
            for joint in self.robot.joints
            if joint.mimic is not None and joint.type != "fixed"
        }

    def link(self, name: str) -> Any:
        """Return a link as yourdfpy's object (``yourdfpy.Link``), to be read only."""
        return self._named("link", self.robot.links, name)

    def joint(self, name: str) -> Any:
        """Return a joint as yourdfpy's object (``yourdfpy.Joint``), to be read only."""
        return self._named("joint", self.robot.joints, name)

    def axis(self, joint: str) -> Vector3:
        """Return the unit axis (3,) of a joint in its own frame [-]; URDF's x where the file says nothing."""
        axis = np.asarray(self.joint(joint).axis, dtype=np.float64)
        axis = axis / np.abs(axis).max()  # first, so that no length overflows or underflows
        return np.asarray(axis / np.linalg.norm(axis))

    def placement(self, joint: str) -> npt.NDArray[np.float64]:
        """Return the (4, 4) placement of a joint's frame in its parent link [-, m]."""
        origin = self.joint(joint).origin
        return np.eye(4) if origin is None else np.array(origin, dtype=np.float64)

    def variant(
        self,
        joints: Mapping[str, JointVariant] | None = None,
        links: Mapping[str, LinkChange] | None = None,
        origins: Mapping[str, JointChange] | None = None,
    ) -> Urdf:
        """Return a changed copy, checked like any URDF.

        Link frames stay where they are: in the centred pose every body of a variant is where it is in the
        ideal mechanism.

        - ``ideal`` keeps the joint as it is written.
        - ``free`` makes a hinge ``floating``, six degrees of freedom. Its ``<axis>`` stays, as the bearing's.
        - ``locked`` makes it ``fixed``, at its zero position; what it mimics does not matter any more.
        - ``planar`` lets a hinge move in the plane normal to its axis and turn about it. The joint frame is
          turned to have ``z`` along the axis, since Pinocchio takes no other; a massless link
          ``<joint>_plane`` and the fixed joint ``<joint>_plane_mount`` turn back, so the child link's frame
          does not change.

        Args:
            joints: What to make of joints, by name.
            links: New inertial properties and shapes, by link.
            origins: New places and axes of joints, applied before ``joints``.
        """
        robot = _xml.parsed(self.text.encode(), "utf-8")
        for name, link_change in (links or {}).items():
            self.link(name)
            _edits.change_link(robot, name, link_change, self.where)
        for name, joint_change in (origins or {}).items():
            self.joint(name)
            _edits.change_joint(robot, name, joint_change, self.where)
        moved = replace(self, text=_xml.write(robot))
        for name, kind in (joints or {}).items():
            self.joint(name)
            if kind not in JOINT_VARIANTS:
                raise UnknownNameError(f"{self.where}: joint {name!r}", "kind", str(kind), JOINT_VARIANTS)
            _edits.vary_joint(robot, name, kind, moved.axis(name), moved.placement(name)[:3, :3], self.where)
        return replace(self, text=_xml.write(robot))

    def mass_properties(self, link: str) -> MassProperties:
        """Return mass, mass centre and inertia of a link in its own frame.

        Raises:
            MechanismError: It has no inertial.
        """
        inertial = self.link(link).inertial
        if inertial is None:
            raise MechanismError(f"{self.where}: link {link!r} must have an <inertial>, got none")
        placement = np.eye(4) if inertial.origin is None else np.asarray(inertial.origin, dtype=float)
        turn = placement[:3, :3]
        inertia = turn @ np.asarray(inertial.inertia, dtype=float) @ turn.T
        return MassProperties.of(inertial.mass, placement[:3, 3], inertia)

    def with_parts(self, link: str, split: SplitLink) -> Urdf:
        """Return a copy in which a link is a hub with elastic parts, each a link on a joint of its own.

        The parts' joints bear the parts' names, their links ``<part>_body``. URDF has no springs: that of
        each joint stands in a comment.

        Args:
            link: Name of the link.
            split: Its hub and parts.
        """
        self.link(link)
        robot = _xml.parsed(self.text.encode(), "utf-8")
        _parts.add_parts(robot, link, split, self.where)
        return replace(self, text=_xml.write(robot))

    def to_xml(self) -> str:
        """Return the XML; mesh file names are as they were written."""
        return self.text

    def write(self, path: str | Path, *, copy_meshes: bool = False) -> tuple[Path, ...]:
        """Write the XML to a file, complete or not at all.

        Where the file goes to another folder, a mesh file that exists is named by its path relative to that
        folder, so that other tools find it; or it is copied there, and the folder can be moved.

        Args:
            path: The file, replaced if it exists.
            copy_meshes: Whether to copy the mesh files beside it, with the materials and images that
                Wavefront files name. What stands there already must be the same.

        Returns:
            The files written: the URDF, then the copies.
        """
        path = Path(path)
        text, copies = self._seen_from(path.parent, copy_meshes)
        with replacing(path) as partial:
            partial.write_text(text, encoding="utf-8")
            _meshes.copy_all(copies)
        return path, *copies

    def _seen_from(self, folder: Path, copy_meshes: bool) -> tuple[str, dict[Path, Path]]:
        """Return the XML with meshes named as in ``folder``, and sources of copies by their targets."""
        start = self.folder
        copies: dict[Path, Path] = {}
        robot = _xml.read(self.text.encode(), self.where, "utf-8")
        if copy_meshes:
            filenames = [mesh.get("filename") for mesh in robot.iter("mesh")]
            names, copies = _meshes.planned_copies(folder, start, filenames, self.where)
            _edits.relocate_meshes(robot, names.__getitem__)
        elif start is None or start.resolve() == folder.resolve():
            return self.text, copies
        else:
            _edits.relocate_meshes(robot, lambda filename: _meshes.name_from(folder, start, filename))
        return _xml.write(robot), copies

    def _named(self, kind: str, elements: list[Any], name: str) -> Any:
        for element in elements:
            if element.name == name:
                return element
        raise UnknownNameError(self.where, kind, name, (element.name for element in elements))
