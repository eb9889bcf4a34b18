"""A system in numbers, and the arrays that one run of it works on."""

from __future__ import annotations

from typing import NamedTuple

from antenna_pin.base.records import Contact, Floats, Ints, Memory, Pose, Records
from antenna_pin.compiled.by_address import by_address
from antenna_pin.dynamics.outside_kernels import Outside
from antenna_pin.mechanism.room_kernels import BodyRoom
from antenna_pin.mechanism.tree_kernels import Body, Place


@by_address
class Numbers(NamedTuple):
    """A system in numbers, and what one run works on.

    Attributes:
        program: Of its elements.
        work: Of :func:`antenna_pin.dynamics.kernels.evaluate`.
        tree: Its bodies, BODY.
        gravity: (3,) [m/s^2].
        room: Of the tree's dynamics, ROOM, (bodies + 1,).
        places: PLACE, (bodies + 1,), scratch.
        plan: Of the constraints, empty where there are none.
        held: Their work array.
        mass: Mass matrix, (nv, nv), scratch.
        bias: (nv,), scratch.
        step: (nv,), scratch.
        pose: POSE, (1,), scratch.
        table: A contact table, scratch.
        own: The contact table that the derivative writes.
        memory: The contact memory.
        rates: Derivatives, (2, nv + nx), scratch.
        force: Generalized force, (nv,), scratch.
        moved: A step's end before it was brought onto the constraints, (size,).
        flag: Whether it was moved, (1,).
        booked: Place in a state of the energy that this puts in.
        outside: What is asked outside.
    """

    program: Floats
    work: Floats
    tree: Records[Body]
    gravity: Floats
    room: Records[BodyRoom]
    places: Records[Place]
    plan: Floats
    held: Floats
    mass: Floats
    bias: Floats
    step: Floats
    pose: Records[Pose]
    table: Records[Contact]
    own: Records[Contact]
    memory: Records[Memory]
    rates: Floats
    force: Floats
    moved: Floats
    flag: Ints
    booked: int
    outside: Outside
