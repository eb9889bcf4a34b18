"""What stands before an element on links, and where it writes what it does: records of its block.

Behind an element's own numbers stand one ``WHOLE``, a ``LINK`` for each link, a ``JOINT`` for each joint and
a ``STATE`` for each number of its own. Before it acts, all that it sees is written there; its kernel

- ``act(words, at, t, desk)``, with its record at ``words[at:]``, ``desk = (whole, links, joints, states)``,

writes its forces, energy and rates beside it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from antenna_pin.base.records import layout, words_of
from antenna_pin.compiled.decorators import inlined

#: How many links, joints and states; whether the first link takes the reaction of all others; whether it
#: puts nothing in (its work is what it stores and loses); the time [s]; and what it tells: energy stored [J],
#: power lost [W], a function that passes zero where its forces have a kink.
WHOLE = layout(
    ("links", "i8"),
    ("joints", "i8"),
    ("states", "i8"),
    ("internal", "i8"),
    ("passive", "i8"),
    ("time", "f8"),
    ("energy", "f8"),
    ("loss", "f8"),
    ("kink", "f8"),
)

#: A link and a point on it. Its body, the link's axes and the point in the body's frame [m], the body's mass
#: [kg] and its inertia about its mass centre in that frame [kg m^2]; what is seen, in world axes: the link's
#: axes, the point's place [m] and velocity [m/s], the spin [rad/s]; what is done: force at the point [N] and
#: torque [N m], in world axes.
LINK = layout(
    ("body", "i8"),
    ("axes", "f8", (3, 3)),
    ("point", "f8", (3,)),
    ("mass", "f8"),
    ("inertia", "f8", (3, 3)),
    ("rotation", "f8", (3, 3)),
    ("place", "f8", (3,)),
    ("velocity", "f8", (3,)),
    ("spin", "f8", (3,)),
    ("force", "f8", (3,)),
    ("torque", "f8", (3,)),
)

#: A joint: its head in programs; angle [rad] ([m]) and rate; the torque on the child [N m] ([N]).
HEAD_WORDS = 13
JOINT = layout(("head", "f8", (HEAD_WORDS,)), ("angle", "f8"), ("rate", "f8"), ("torque", "f8"))

#: A number that the element integrates, and its rate.
STATE = layout(("value", "f8"), ("rate", "f8"))

#: What is integrated of it, in x: work and gross work [J], losses [J], and of its forces on all links the
#: impulse [N s], the angular impulse about the world's origin and that about the mass centre of all [N m s].
BOOK = layout(
    ("work", "f8"),
    ("gross_work", "f8"),
    ("loss", "f8"),
    ("impulse", "f8", (3,)),
    ("angular_impulse", "f8", (3,)),
    ("central_impulse", "f8", (3,)),
)

WHOLE_WORDS: Any = np.int64(words_of(WHOLE))
LINK_WORDS: Any = np.int64(words_of(LINK))
SEEN_JOINT_WORDS: Any = np.int64(words_of(JOINT))
STATE_WORDS: Any = np.int64(words_of(STATE))
BOOK_WORDS: Any = np.int64(words_of(BOOK))


@inlined
def clear(desk: Any) -> None:
    """Let no force, torque, energy or rate stand on a desk."""
    whole, links, joints, states = desk
    whole[0].energy = 0.0
    whole[0].loss = 0.0
    whole[0].kink = 1.0
    for i in range(links.shape[0]):
        for k in range(3):
            links[i].force[k] = 0.0
            links[i].torque[k] = 0.0
    for i in range(joints.shape[0]):
        joints[i].torque = 0.0
    for i in range(states.shape[0]):
        states[i].rate = 0.0


@inlined
def turned(rotation: Any, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a vector of a link's axes in world axes."""
    return (
        rotation[0, 0] * x + rotation[0, 1] * y + rotation[0, 2] * z,
        rotation[1, 0] * x + rotation[1, 1] * y + rotation[1, 2] * z,
        rotation[2, 0] * x + rotation[2, 1] * y + rotation[2, 2] * z,
    )
