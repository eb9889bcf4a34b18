"""Records of the block of an element on links: motions, forces, states.

Behind an element's own numbers stand one ``WHOLE``, a ``LINK`` for each link, a ``JOINT`` for each joint and
a ``STATE`` for each number of its own. Before it acts, all that it sees is written there; its kernel

- ``act(element, t, desk)``, with its record and ``desk = (whole, links, joints, states)``,

writes its forces, energy and rates beside it.
"""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np

from antenna_pin.base.records import Floats, Matrix3, Record, Records, Triple, Vector3, layout, words_of
from antenna_pin.compiled.decorators import inlined


class LinkElementRecord(Record):
    """An element on links as a whole: its sizes, and what it reports."""

    links: int  # how many
    joints: int  # how many
    states: int  # how many numbers it integrates
    internal: int  # 1: the first link takes the reaction of all others
    passive: int  # 1: it puts nothing in, its work is what it stores and loses
    time: float  # [s]
    energy: float  # stored [J]; written by the element
    loss: float  # power [W]; written by the element
    kink: float  # passes zero where the forces have a kink; written by the element


WHOLE = layout(LinkElementRecord)


class LinkRecord(Record):
    """A link with a point: its motion, and the forces on it, world axes."""

    body: int  # index; -1: the world
    axes: Matrix3  # of the link, in the body's frame
    point: Vector3  # in the body's frame [m]
    mass: float  # of the body [kg]
    inertia: Matrix3  # of the body about its mass centre, in its frame [kg m^2]
    rotation: Matrix3  # the link's axes in the world
    place: Vector3  # of the point in the world [m]
    velocity: Vector3  # of the point [m/s]
    spin: Vector3  # angular velocity [rad/s]
    force: Vector3  # at the point [N]; written by the element
    torque: Vector3  # [N m]; written by the element


LINK = layout(LinkRecord)

#: Length of an element's head in programs (``dynamics.kernels.ELEMENT``).
HEAD_WORDS = 13


class DeskJoint(Record):
    """A joint that an element on links acts at."""

    head: Annotated[Floats, HEAD_WORDS]  # its element head (``dynamics.kernels.ELEMENT``)
    angle: float  # [rad] ([m])
    rate: float  # [rad/s] ([m/s])
    torque: float  # [N m] ([N]); written by the element


JOINT = layout(DeskJoint)


class DeskState(Record):
    """A number that the element integrates."""

    value: float  # in the element's own unit
    rate: float  # that unit per second; written by the element


STATE = layout(DeskState)


class LinksBook(Record):
    """Integrals of an element on links, in x."""

    work: float  # [J]
    gross_work: float  # [J]
    loss: float  # [J]
    impulse: Vector3  # of its forces on all links [N s]
    angular_impulse: Vector3  # about the world's origin [N m s]
    central_impulse: Vector3  # about the mass centre of all [N m s]


BOOK = layout(LinksBook)

WHOLE_WORDS: Any = np.int64(words_of(WHOLE))
LINK_WORDS: Any = np.int64(words_of(LINK))
SEEN_JOINT_WORDS: Any = np.int64(words_of(JOINT))
STATE_WORDS: Any = np.int64(words_of(STATE))
BOOK_WORDS: Any = np.int64(words_of(BOOK))

#: Of one element on links: itself (1,), its links, joints and states.
Desk = tuple[Records[LinkElementRecord], Records[LinkRecord], Records[DeskJoint], Records[DeskState]]


@inlined
def clear(desk: Desk) -> None:
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
def turned(rotation: Floats, x: float, y: float, z: float) -> Triple:
    """Return a vector of a link's axes in world axes."""
    return (
        rotation[0, 0] * x + rotation[0, 1] * y + rotation[0, 2] * z,
        rotation[1, 0] * x + rotation[1, 1] * y + rotation[1, 2] * z,
        rotation[2, 0] * x + rotation[2, 1] * y + rotation[2, 2] * z,
    )
