"""Configurations of a mechanism: the space of each joint, and which of their numbers are of length one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import unknown_type
from antenna_pin.base.parameters import beyond
from antenna_pin.errors import InvalidParameterError, MechanismError
from antenna_pin.mechanism import Mechanism

__all__ = ["make_unit", "numbers", "spaces"]

_SPACES = {
    "JointModelFreeFlyer": "rigid",
    "JointModelSpherical": "rotation",
    "JointModelPlanar": "plane",
}

# How far from 1 the length of a quaternion may be and still be taken for round-off.
_UNIT_TOLERANCE = 1e-6


def spaces(model: Any) -> tuple[str, ...]:
    """Return the configuration space of each joint of a Pinocchio model."""
    kinds = []
    for joint in list(model.joints)[1:]:
        name = joint.shortname()
        if name in _SPACES:
            kinds.append(_SPACES[name])
        elif (joint.nq, joint.nv) == (1, 1):
            kinds.append("vector")
        elif (joint.nq, joint.nv) == (2, 1):
            kinds.append("circle")
        else:
            raise MechanismError(
                f"joint {model.names[joint.id]!r}: {name} has no place in the state space; use revolute, "
                "continuous, prismatic, planar, floating or spherical joints"
            )
    return tuple(kinds)


def numbers(given: ArrayLike, count: int, name: str, unit: str) -> NDArray[np.float64]:
    """Return a copy of the numbers of a state, or refuse what is not finite or further than a double tells.

    Args:
        given: What is given.
        count: How many there must be.
        name: What they are called.
        unit: SI unit of the largest [-].
    """
    try:
        found = np.array(given, dtype=float)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.shape == (count,) and np.isfinite(found).all():
        rule = beyond(found.tolist(), unit)
    else:
        rule = "finite" if count == 1 else f"{count} finite numbers"
    if rule:
        raise InvalidParameterError("System", name, rule, said=unknown_type(given))
    return found


def make_unit(mechanism: Mechanism, configuration: NDArray[np.float64]) -> None:
    """Make quaternions, and cosines and sines, of a configuration unit, in place.

    Args:
        mechanism: Whose it is.
        configuration: (nq,).

    Raises:
        InvalidParameterError: One is further from it than round-off.
    """
    for name, place in _unit_parts(mechanism):
        length = float(np.linalg.norm(configuration[place]))
        if not abs(length - 1.0) <= _UNIT_TOLERANCE:
            what = "quaternion" if place.stop - place.start == 4 else "cosine and sine"
            raise InvalidParameterError(
                f"q[{place.start}:{place.stop}]",
                f"{what} of {name}",
                f"of length 1 to {_UNIT_TOLERANCE:g}; divide it by its length",
                length,
            )
        configuration[place] /= length


def _unit_parts(mechanism: Mechanism) -> Iterator[tuple[str, slice]]:
    """Yield what of q must be of length one: name of the joint, place in q."""
    if mechanism.base == "free":
        yield "the base", slice(3, 7)
    inside = {
        "floating": slice(3, 7),
        "planar": slice(2, 4),
        "continuous": slice(0, 2),
        "spherical": slice(0, 4),
    }
    for slot in mechanism.joints.values():
        if slot.kind in inside:
            part, start = inside[slot.kind], slot.q.start
            yield f"joint {slot.name!r}", slice(start + part.start, start + part.stop)
