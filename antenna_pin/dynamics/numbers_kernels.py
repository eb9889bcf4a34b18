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
    """A system in numbers, and what one run works on."""

    program: Floats  # program of the elements
    work: Floats  # of :func:`antenna_pin.dynamics.kernels.evaluate`
    tree: Records[Body]  # bodies, BODY
    gravity: Floats  # (3,) [m/s^2]
    room: Records[BodyRoom]  # arrays for the tree's dynamics, ROOM, (bodies + 1,)
    places: Records[Place]  # PLACE, (bodies + 1,), scratch
    plan: Floats  # constraints, empty where there are none
    held: Floats  # work array of the constraints
    mass: Floats  # mass matrix, (nv, nv), scratch
    bias: Floats  # (nv,), scratch
    step: Floats  # (nv,), scratch
    pose: Records[Pose]  # POSE, (1,), scratch
    table: Records[Contact]  # A contact table, scratch
    own: Records[Contact]  # contact table of the derivative
    memory: Records[Memory]  # the contact memory
    rates: Floats  # derivatives, (2, nv + nx), scratch
    force: Floats  # generalized force, (nv,), scratch
    moved: Floats  # A step's end before it was brought onto the constraints, (size,)
    flag: Ints  # whether it was moved, (1,)
    booked: int  # place in a state of the correction's energy
    outside: Outside  # callbacks
