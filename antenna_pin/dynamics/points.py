"""Springs between points as blocks of a system's program, and what there is to see of them in a state."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.constraints import Anchor, on_body
from antenna_pin.dynamics import kernels
from antenna_pin.dynamics import point_kernels as _points
from antenna_pin.elements import BetweenPoints, kind_of
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import Mechanism

__all__ = ["point_spring_block"]

Array = NDArray[np.float64]


def point_spring_block(mechanism: Mechanism, place: str, spring: BetweenPoints, x: int) -> Array:
    """Return the block of a spring between points.

    Args:
        mechanism: The mechanism.
        place: What it is, for a refusal.
        spring: The spring.
        x: Where in x its loss goes.

    Raises:
        UnknownNameError: A link that there is not.
        MechanismError: Both ends are on one body.
    """
    sides = np.zeros(2, dtype=_points.SIDE)
    for side, (link, point) in zip(sides, (spring.first, spring.second), strict=True):
        anchor = Anchor(link=link, rotation=np.eye(3), origin=np.array(point))
        side["body"], frame = on_body(mechanism, place, anchor)
        side["point"] = frame[:3, 3]
    if sides["body"][0] == sides["body"][1]:
        body = int(sides["body"][0])
        said = "the world" if body < 0 else f"body {mechanism.bodies[body]!r}"
        raise MechanismError(
            f"{place}: its links {spring.first[0]!r} and {spring.second[0]!r} are one body, {said}, and it "
            "would do nothing; name links between which a joint moves"
        )
    words = spring.words_of_kernel()
    block = np.concatenate([np.zeros(kernels.PARAMETERS), words, sides.view(np.float64)])
    head = block[: kernels.PARAMETERS].view(kernels.ELEMENT)
    head["kind"], head["length"], head["x"] = kind_of(type(spring)), len(block), x
    head["on"] = spring.acts
    return block
