"""URDF of a mechanism, and its variants for a scenario.

A variant is made on the XML itself, so that comments (a shipped model keeps the source of each number there),
gazebo and transmission tags stay; each variant is then read and checked again like any other file.
"""

from __future__ import annotations

import filecmp
import os
import shutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import Any, TypeVar
from urllib.parse import unquote

import numpy as np
import numpy.typing as npt

from antenna_pin.base.arguments import takes
from antenna_pin.base.changes import JointChange, JointVariant, LinkChange
from antenna_pin.base.directions import unit
from antenna_pin.base.files import replacing
from antenna_pin.base.readable import brief
from antenna_pin.errors import MechanismError, OutputError, UnknownNameError
from antenna_pin.mechanism import edits, reading, urdf_xml
from antenna_pin.mechanism.flexible import MassProperties, SplitLink
from antenna_pin.mechanism.frames import Vector3
from antenna_pin.mechanism.robot import Joint, Link, Robot

_Element = TypeVar("_Element", Link, Joint)


@takes()
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Urdf:
    """A URDF checked as a mechanism: one tree of possible bodies.

    It consists of its text alone, so writing and reading it again gives the same mechanism. At
    construction it refuses XML that is not well-formed; missing, repeated or unknown names; loops and several
    roots; negative masses; impossible inertias, of links that fixed joints make one body
    together; zero axes. Joints that move nothing with inertia are refused by
    :func:`antenna_pin.mechanism.build_mechanism`, since that depends on the base and on all joints. Elements
    without mechanical meaning are not checked (:class:`antenna_pin.mechanism.WrittenUrdf` counts them).

    A planar joint moves in the plane normal to its axis. Where that is not z of its frame, the frame is
    turned as that of a hinge made planar is (:meth:`variant`): in what is read of the text, and in what is
    written.

    Limits of joints are not simulated. Damping and friction of joints with an axis are
    (:attr:`joint_friction`), those of others are not (:attr:`not_simulated`).

    Attributes:
        text: The XML.
        where: Its name in messages, such as its file name.
        folder: Where relative mesh file names start; None if that is unknown.
        package_path: Where packages of ``package://`` are looked for first.
        allow_impossible_inertia: Links whose body's inertia may break the triangle rule.
        robot: Its numbers, read-only; visual shapes are read when requested.
        simulated: Bodies and joints, the part passed to Pinocchio's parser.
        unbounded: Revolute and prismatic joints without bounds, because they have no ``<limit>`` or because
            it leaves none.
        rounding: By link with an inertia, how much of the triangle rule its written digits leave [kg m^2].
        points: Links with a mass and no ``<inertia>``, point masses at their inertial's origin.
        unlimited: Continuous joints whose ``<limit>`` states bounds, and those: they have none.
        undrawn: Link of each visual shape that cannot be drawn, and why.
    """

    __repr__ = brief

    text: str
    where: str
    folder: Path | None = None
    package_path: tuple[Path, ...] = ()
    allow_impossible_inertia: tuple[str, ...] = ()
    robot: Robot = field(init=False, repr=False)
    simulated: str = field(init=False, repr=False)
    unbounded: tuple[str, ...] = field(init=False, repr=False)
    rounding: Mapping[str, float] = field(init=False, repr=False)
    points: tuple[str, ...] = field(init=False, repr=False)
    unlimited: tuple[tuple[str, str], ...] = field(init=False, repr=False)
    undrawn: tuple[tuple[str, str], ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Read and check."""
        object.__setattr__(self, "allow_impossible_inertia", tuple(map(str, self.allow_impossible_inertia)))
        found = reading.checked(self.text, self.where, self.allow_impossible_inertia)
        for name, value in (
            ("robot", found.robot),
            ("simulated", found.simulated),
            ("unbounded", tuple(found.findings.unbounded)),
            ("rounding", found.findings.rounding),
            ("points", tuple(found.findings.points)),
            ("unlimited", tuple(found.findings.unlimited)),
            ("undrawn", tuple(found.findings.undrawn)),
        ):
            object.__setattr__(self, name, value)

    @classmethod
    def load(
        cls,
        path: str | Path,
        allow_impossible_inertia: Iterable[str] = (),
        package_path: Iterable[str | Path] = (),
    ) -> Urdf:
        """Read a URDF file; meshes are not read.

        Args:
            path: The file.
            allow_impossible_inertia: Names of links whose inertia may break the triangle rule.
            package_path: Folders with packages of ``package://``.
        """
        path = Path(path)
        return cls.from_text(
            reading.text_of(path), path.name, allow_impossible_inertia, path.parent.absolute(), package_path
        )

    @classmethod
    def from_text(
        cls,
        text: str,
        where: str,
        allow_impossible_inertia: Iterable[str] = (),
        folder: str | Path | None = None,
        package_path: Iterable[str | Path] = (),
    ) -> Urdf:
        """Read a URDF from its text.

        Args:
            text: The XML.
            where: Its name in messages.
            allow_impossible_inertia: Names of links whose inertia may break the triangle rule.
            folder: Where relative mesh file names start.
            package_path: Folders with packages of ``package://``.
        """
        try:
            return cls(
                text=reading.written(text, where),
                where=where,
                folder=None if folder is None else Path(folder),
                package_path=tuple(map(Path, package_path)),
                allow_impossible_inertia=tuple(allow_impossible_inertia),
            )
        except MechanismError:
            reading.judged(
                urdf_xml.read(text, where), where
            )  # once more, for the line that it has in the file
            raise

    @classmethod
    def changed_from(
        cls,
        text: str,
        where: str,
        joints: Mapping[str, JointVariant] | None = None,
        links: Mapping[str, LinkChange] | None = None,
        origins: Mapping[str, JointChange] | None = None,
        **more: Any,
    ) -> Urdf:
        """Return the changed mechanism of a text (:meth:`variant`), checked after the changes."""
        changes = joints, links, origins
        if not any(changes):
            return cls.from_text(text, where, **more)
        try:
            return cls(text=urdf_xml.write(edits.edited(text, where, *changes)), where=where, **more)
        except MechanismError:
            reading.judged(edits.edited(text, where, *changes), where)  # once more, as in from_text
            raise

    @property
    def name(self) -> str:
        """Name of the robot element."""
        return str(self.robot.name)

    @property
    def root(self) -> str:
        """Name of the link that is nobody's child."""
        return reading.root_link(self.robot)

    @property
    def not_simulated(self) -> tuple[str, ...]:
        """Lines about damping or friction of joints without an axis; empty is good."""
        return reading.left_out(urdf_xml.parsed(self.text), self.where)

    @property
    def joint_friction(self) -> dict[str, dict[str, float]]:
        """Numbers of ``<dynamics>`` of joints with an axis, by name: ``damping`` and ``friction`` above 0.

        Of one that turns [N*m*s/rad] and [N*m], of one that slides [N*s/m] and [N]; fields of
        :class:`antenna_pin.elements.JointFriction`.
        """
        return reading.friction_of(urdf_xml.parsed(self.text))

    @property
    def mimics(self) -> dict[str, dict[str, Any]]:
        """Numbers of ``<mimic>`` of moving joints, by name: ``leader``, ``multiplier`` and ``offset``.

        Fields of :class:`antenna_pin.dynamics.constraints.Coupling`, in SI units. One of a fixed joint is no
        matter.
        """
        return {
            joint.name: dict(zip(("leader", "multiplier", "offset"), joint.mimic, strict=True))
            for joint in self.robot.joints
            if joint.mimic is not None and joint.type != "fixed"
        }

    def link(self, name: str) -> Link:
        """Return a link, not to be changed."""
        return self._element("link", self.robot.links, name)

    def joint(self, name: str) -> Joint:
        """Return a joint, not to be changed."""
        return self._element("joint", self.robot.joints, name)

    def axis(self, joint: str) -> Vector3:
        """Return a joint's unit axis (3,) in its own frame [-]; x by default."""
        return unit(self.joint(joint).axis)

    def placement(self, joint: str) -> npt.NDArray[np.float64]:
        """Return the (4, 4) placement of a joint's frame in its parent link [-, m]."""
        origin = self.joint(joint).origin
        return np.eye(4) if origin is None else origin.copy()

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
        - ``locked`` makes it ``fixed``, at its zero position, without its ``<mimic>``.
        - ``planar`` lets a hinge move in the plane normal to its axis and turn about it. The joint frame is
          turned to have ``z`` along the axis, since Pinocchio takes no other; a massless link
          ``<joint>_plane`` and the fixed joint ``<joint>_plane_mount`` turn back, so the child link's frame
          does not change.

        Args:
            joints: New kinds of joints, by name.
            links: New inertial properties and shapes, by link.
            origins: New places, axes and bounds of joints, applied before ``joints``.
        """
        return self.changed_from(
            self.text,
            self.where,
            joints,
            links,
            origins,
            folder=self.folder,
            package_path=self.package_path,
            allow_impossible_inertia=self.allow_impossible_inertia,
        )

    def mass_properties(self, link: str) -> MassProperties:
        """Return mass, mass centre and inertia of a link in its own frame.

        Raises:
            MechanismError: It has no inertial.
        """
        inertial = self.link(link).inertial
        if inertial is None:
            raise MechanismError(f"{self.where}: link {link!r} must have an <inertial>, got none")
        placement = np.eye(4) if inertial.origin is None else inertial.origin
        turn = placement[:3, :3]
        inertia = turn @ inertial.inertia @ turn.T
        return MassProperties.of(inertial.mass, placement[:3, 3], inertia)

    def with_parts(self, link: str, split: SplitLink) -> Urdf:
        """Return a copy with a link as hub and elastic parts on joints.

        The parts' joints bear the parts' names, their links ``<part>_body``. URDF has no springs: that of
        each joint stands in a comment.
        """
        self.link(link)
        robot = urdf_xml.parsed(self.text)
        edits.add_parts(robot, link, split, self.where)
        return replace(self, text=urdf_xml.write(robot))

    def mesh_file(self, filename: str) -> Path | None:
        """Return the existing file of a mesh."""
        return mesh_file(filename, self.folder, self.package_path)

    def to_xml(self) -> str:
        """Return the XML; mesh file names are as they were written."""
        return self.text

    def write(self, path: str | Path, *, copy_meshes: bool = False) -> tuple[Path, ...]:
        """Write the XML to a file, complete or not at all.

        In another folder an existing mesh file is named by its path relative to that
        folder, so that other tools find it; or it is copied there, and the folder can be moved.

        Args:
            path: The file, replaced if it exists.
            copy_meshes: Whether to copy the mesh files into the folder, with the materials and images that
                Wavefront files name. Existing files there must be identical.

        Returns:
            The files written: the URDF, then the copies.
        """
        path = Path(path)
        text, copies = self._seen_from(path.parent, copy_meshes)
        with replacing(path) as partial:
            partial.write_text(text, encoding="utf-8")
            copy_all(copies)
        return path, *copies

    def _seen_from(self, folder: Path, copy_meshes: bool) -> tuple[str, dict[Path, Path]]:
        """Return the XML with mesh names for ``folder``, and sources of copies by targets."""
        start = self.folder
        copies: dict[Path, Path] = {}
        robot = urdf_xml.read(self.text, self.where)
        edits.turn_planes(robot, self.where)  # for readers that do not look at their axes
        if copy_meshes:
            filenames = [mesh.get("filename") for mesh in edits.meshes(robot)]
            names, copies = planned_copies(folder, start, filenames, self.where, self.package_path)
            edits.relocate_meshes(robot, names.__getitem__)
        elif start is not None and start.resolve() != folder.resolve():
            edits.relocate_meshes(robot, lambda filename: name_from(folder, start, filename))
        return urdf_xml.write(robot), copies

    def _element(self, kind: str, elements: Iterable[_Element], name: str) -> _Element:
        for element in elements:
            if element.name == name:
                return element
        raise UnknownNameError(self.where, kind, name, (element.name for element in elements))


# --- meshes -------------------------------------------------------------------------------------------------


# Variables that list folders with packages; with those of the last a package is below share/.
_VARIABLES = ("ROS_PACKAGE_PATH", "GAZEBO_MODEL_PATH", "AMENT_PREFIX_PATH")
_SCHEMES = ("package://", "model://")


def mesh_file(filename: str, folder: Path | None, package_path: Iterable[Path] = ()) -> Path | None:
    """Return the file that a mesh is in, None if it is not there.

    ``package://NAME/rest`` is ``NAME/rest`` below a folder of ``package_path``, of ROS_PACKAGE_PATH or
    GAZEBO_MODEL_PATH, below ``share`` of one of AMENT_PREFIX_PATH, or in a folder above the URDF; a folder
    that is itself called NAME is the package. The first that has the file is taken.

    Args:
        filename: As it stands in the URDF.
        folder: Where relative names start; None if that is unknown.
        package_path: Folders to look in first.
    """
    for scheme in _SCHEMES:
        if filename.startswith(scheme):
            name, _, rest = filename.removeprefix(scheme).partition("/")
            candidates = _in_packages(name, rest, folder, package_path)
            return next((path for path in candidates if path.is_file()), None)
    if filename.startswith("file://"):
        path = Path(filename.removeprefix("file://"))
        path = path if path.is_file() else Path(unquote(str(path)))
    elif "://" in filename:
        return None
    else:
        path = Path(filename)
    if not path.is_absolute():
        if folder is None:
            return None
        path = folder / path
    return path if path.is_file() else None


def _in_packages(name: str, rest: str, folder: Path | None, package_path: Iterable[Path]) -> Iterator[Path]:
    roots = list(package_path)
    for variable in _VARIABLES:
        below = "share" if variable.startswith("AMENT") else ""
        roots += [Path(part, below) for part in os.environ.get(variable, "").split(os.pathsep) if part]
    if folder is not None:
        roots += [folder, *folder.parents]
    for root in roots:
        yield root / name / rest
        if root.name == name:
            yield root / rest


# --- meshes of a written URDF -------------------------------------------------------------------------------

# What a Wavefront material file calls the images it uses.
_IMAGE_KEYS = ("map_", "bump", "disp", "decal", "refl", "norm")


def name_from(folder: Path, start: Path, filename: str) -> str:
    """Return a mesh's name in ``folder``; unchanged if missing or in a package."""
    mesh = None if "://" in filename else mesh_file(filename, start)
    if mesh is None:
        return filename
    source = mesh.resolve()
    try:
        return Path(os.path.relpath(source, folder.resolve())).as_posix()
    except ValueError:
        return source.as_posix()


def planned_copies(
    folder: Path,
    start: Path | None,
    filenames: Iterable[str],
    where: str,
    package_path: Iterable[Path] = (),
) -> tuple[dict[str, str], dict[Path, Path]]:
    """Return the names of meshes after copying to ``folder``, and the files to copy.

    A name that leads down from ``start`` is kept; of any other the last part is. Materials and images that a
    Wavefront mesh names go with it.

    Returns:
        New name of each mesh, and source of each copy, by its target.

    Raises:
        MechanismError: A mesh is not a file.
        OutputError: Two files would become one, or would replace another file.
    """
    names: dict[str, str] = {}
    copies: dict[Path, Path] = {}
    for filename in dict.fromkeys(filenames):
        source = mesh_file(filename, start, package_path)
        if source is None:
            raise MechanismError(
                f"{where}: mesh {filename!r} must be a file to be copied; put it there, or copy nothing"
            )
        names[filename] = name = _kept_name(filename)
        for path, below in [(source, PurePosixPath(name)), *_companions(source, PurePosixPath(name).parent)]:
            target = folder / below
            before = copies.setdefault(target, path)
            if not filecmp.cmp(before, path, shallow=False):
                raise OutputError(f"{target}: {before} and {path} would both be copied here; rename one")
            if target.exists() and not (target.is_file() and filecmp.cmp(target, path, shallow=False)):
                raise OutputError(f"{target}: differs from {path}, whose copy goes there; write elsewhere")
    return names, {target: path for target, path in copies.items() if not target.exists()}


def copy_all(copies: dict[Path, Path]) -> None:
    """Copy files, each complete or not at all; sources by targets."""
    for target, source in copies.items():
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"{target}: its folder cannot be created: {error.strerror}") from error
        with replacing(target) as partial:
            shutil.copyfile(source, partial)


def _kept_name(filename: str) -> str:
    path = PurePosixPath(filename.partition("://")[2] or filename)
    return path.name if path.is_absolute() or ".." in path.parts else path.as_posix()


def _companions(source: Path, below: PurePosixPath) -> list[tuple[Path, PurePosixPath]]:
    """Return the files that a Wavefront mesh or material names beside or below itself."""
    suffix = source.suffix.lower()
    if suffix not in (".obj", ".mtl"):
        return []
    found: dict[str, None] = {}
    for line in source.read_text(encoding="utf-8", errors="replace").splitlines():
        key, _, rest = line.strip().partition(" ")
        if suffix == ".obj" and key == "mtllib":
            found.update(dict.fromkeys((rest.strip(), *rest.split())))
        elif suffix == ".mtl" and key.lower().startswith(_IMAGE_KEYS) and rest.split():
            found.update(dict.fromkeys((rest.strip(), rest.split()[-1])))
    files = []
    for name in found:
        path = PurePosixPath(name)
        if name and _kept_name(name) == path.as_posix() and (source.parent / path).is_file():
            files.append((source.parent / path, below / path))
            if suffix == ".obj":
                files += _companions(source.parent / path, (below / path).parent)
    return files
