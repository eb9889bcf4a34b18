"""A URDF as the readers behind see it: without what does not count, its numbers judged."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from antenna_pin.base.files import decoded
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import _checks, _plain, _source, _vary, _xml
from antenna_pin.mechanism._robot import Robot, robot_of

__all__ = ["Reading", "checked", "judged", "text_of", "written"]


class Reading(NamedTuple):
    """A text as the readers behind see it."""

    robot: Robot
    simulated: str  # for Pinocchio's parser
    findings: _plain.Findings


def text_of(path: str | Path) -> str:
    """Return the text of a URDF file, whatever its encoding.

    Raises:
        MechanismError: It cannot be read.
    """
    try:
        return decoded(Path(path).read_bytes())
    except OSError as error:
        raise MechanismError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise MechanismError(f"{path}: must be XML, got no text (byte {error.start})") from error


@lru_cache(maxsize=64)
def written(text: str, where: str) -> str:
    """Return a URDF's text as this package writes it."""
    return _source.write(_xml.read(text, where))


@lru_cache(maxsize=64)  # every run of a study reads the same text again, some more than once
def checked(text: str, where: str, allow_impossible_inertia: tuple[str, ...]) -> Reading:
    """Return a checked URDF in numbers, which nobody changes, and as Pinocchio reads it."""
    clean, findings = judged(_xml.read(text, where), where)
    robot = robot_of(clean, _source.write(clean), where)
    _checks.check(robot, where, allow_impossible_inertia)
    return Reading(robot, _plain.for_pinocchio(clean), findings)


def judged(robot: Any, where: str) -> tuple[Any, _plain.Findings]:
    """Return a root element without what does not count, and what that was; refuse what is no number."""
    findings = _plain.clean(robot, Path(where).stem)
    _xml.judge(robot, where)
    _vary.turn_planes(robot, where)
    return robot, findings
