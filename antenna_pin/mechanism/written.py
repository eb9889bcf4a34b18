"""Unchanged URDF of a file: names, tree, joint types, and parts without meaning.

Its mechanics is judged only in what is made of it: before, a joint can be locked, an inertia given.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from antenna_pin.base.changes import JointChange, JointVariant, LinkChange
from antenna_pin.mechanism import reading, urdf_xml
from antenna_pin.mechanism.reading import text_of
from antenna_pin.mechanism.urdf import Urdf
from antenna_pin.mechanism.urdf_xml import broken_numbers

# Kinds that a line names; the command that lists all is named behind.
_NAMED = 4

# Lines of a file that are named, of each kind.
_LINES = 10


class WrittenJoint(NamedTuple):
    """A joint of a file: type, which may be invalid, and its links."""

    type: str
    parent: str
    child: str


class PassedOver(NamedTuple):
    """Parts of a file without meaning for the mechanics: kind, and lines."""

    what: str
    lines: tuple[int, ...]

    def text(self) -> str:
        """Return count, kind and lines as text."""
        lines = list(dict.fromkeys(self.lines))
        numbers = ", ".join(map(str, lines[:_LINES])) + (", ..." if len(lines) > _LINES else "")
        return f"{len(self.lines)} {self.what}, line{'s' * (len(lines) > 1)} {numbers}"


class _Outline(NamedTuple):
    links: tuple[str, ...]
    joints: dict[str, WrittenJoint]
    friction: dict[str, dict[str, float]]
    left_out: tuple[str, ...]
    passed_over: tuple[PassedOver, ...]


@lru_cache(maxsize=64)
def _outline(text: str, where: str) -> _Outline:
    robot = urdf_xml.read(text, where)
    joints = {
        str(joint.get("name")): WrittenJoint(
            joint.get("type", ""), joint.find("parent").get("link"), joint.find("child").get("link")
        )
        for joint in robot.findall("joint")
    }
    links = tuple(str(link.get("name")) for link in robot.findall("link"))
    friction = reading.friction_of(robot)
    left_out = (*reading.left_out(robot, where), *broken_numbers(robot, where))
    found = reading.clean(robot, Path(where).stem).passed_over
    passed = tuple(PassedOver(what, tuple(lines)) for what, lines in sorted(found.items()))
    return _Outline(links, joints, friction, left_out, passed)


class _VariantKey(NamedTuple):
    """Identity of a variant: equal for equal readings, each number to its last digit."""

    said: str
    changed: tuple[Any, ...]
    more: dict[str, Any]

    def __hash__(self) -> int:
        return hash(self.said)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _VariantKey) and self.said == other.said


@lru_cache(maxsize=4)  # what is tried over and over differs in play, laws, drives; a URDF may be large
def _variant(key: _VariantKey) -> Urdf:
    return Urdf.changed_from(*key.changed, **key.more)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class WrittenUrdf:
    """A URDF with known names and tree, its mechanics not yet checked.

    Attributes:
        text: The XML as it is in the file.
        where: Its name in messages, such as its file name.
        folder: Where relative mesh file names start; None if that is unknown.
        package_path: Where packages of ``package://`` are looked for first.
        allow_impossible_inertia: Links whose inertia may break the triangle rule.
        links: Names of its links.
        joints: Its joints by name.
        joint_friction: As of :class:`antenna_pin.mechanism.Urdf`.
        not_simulated: As of :class:`antenna_pin.mechanism.Urdf`.
        passed_over: What of it means nothing to the mechanics, by kind.
    """

    text: str
    where: str
    folder: Path | None = None
    package_path: tuple[Path, ...] = ()
    allow_impossible_inertia: tuple[str, ...] = ()
    links: tuple[str, ...] = field(init=False, repr=False)
    joints: dict[str, WrittenJoint] = field(init=False, repr=False)
    joint_friction: dict[str, dict[str, float]] = field(init=False, repr=False)
    not_simulated: tuple[str, ...] = field(init=False, repr=False)
    passed_over: tuple[PassedOver, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Read the outline."""
        outline = _outline(self.text, self.where)
        for name, value in (
            ("links", outline.links),
            ("joints", dict(outline.joints)),
            ("joint_friction", {joint: dict(given) for joint, given in outline.friction.items()}),
            ("not_simulated", outline.left_out),
            ("passed_over", outline.passed_over),
        ):
            object.__setattr__(self, name, value)

    @classmethod
    def load(
        cls,
        path: str | Path,
        allow_impossible_inertia: Iterable[str] = (),
        package_path: Iterable[str | Path] = (),
    ) -> WrittenUrdf:
        """Read a file; arguments as of :meth:`antenna_pin.mechanism.Urdf.load`."""
        return cls(
            text=text_of(path),
            where=Path(path).name,
            folder=Path(path).parent.absolute(),
            package_path=tuple(map(Path, package_path)),
            allow_impossible_inertia=tuple(allow_impossible_inertia),
        )

    def variant(
        self,
        joints: Mapping[str, JointVariant] | None = None,
        links: Mapping[str, LinkChange] | None = None,
        origins: Mapping[str, JointChange] | None = None,
    ) -> Urdf:
        """Return the changed and checked mechanism: :meth:`antenna_pin.mechanism.Urdf.variant`."""
        more = {
            "folder": self.folder,
            "package_path": self.package_path,
            "allow_impossible_inertia": self.allow_impossible_inertia,
        }
        changed = self.text, self.where, joints, links, origins
        return _variant(_VariantKey(repr((changed, more)), changed, more))

    def said_of_passed_over(self) -> str | None:
        """Return one line on what was passed over, None if nothing was."""
        if not self.passed_over:
            return None
        kinds = sorted(self.passed_over, key=lambda kind: -len(kind.lines))
        count = sum(len(kind.lines) for kind in kinds)
        things = "thing that means" if count == 1 else "things that mean"
        named = ", ".join(f"{len(kind.lines)} {kind.what}" for kind in kinds[:_NAMED])
        more = f" and {len(kinds) - _NAMED} kinds more" if len(kinds) > _NAMED else ""
        return (
            f"{self.where}: passed over {count} {things} nothing to the mechanics ({named}{more}); "
            "`antenna-pin urdf FILE --check` lists them"
        )
