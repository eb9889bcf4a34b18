"""The arrays that the derivative of a system's rates is computed with, part by part."""

from __future__ import annotations

from typing import NamedTuple

from numpy.typing import NDArray

from antenna_pin.base.records import Floats, Ints, Memory, Pose, Records
from antenna_pin.compiled.by_address import by_address
from antenna_pin.constraints.layout_kernels import Closure, Coupled
from antenna_pin.constraints.tangent_kernels import Tie
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.integrate.word_kernels import Words
from antenna_pin.joints.tangent_room_kernels import LawWords, Part
from antenna_pin.mechanism.room_kernels import BodyRoom
from antenna_pin.mechanism.spatial_kernels import Change
from antenna_pin.mechanism.tree_kernels import Body, Place


@by_address
class Shifts(NamedTuple):
    """Derivatives of system numbers over parameters and over stored numbers of elements."""

    program: Words  # which words of the program, :class:`antenna_pin.integrate.word_kernels.Words`
    tree: Words  # which of the bodies' numbers, likewise
    flat: Floats  # the bodies' numbers, flat, the tree's own
    bodies: NDArray[Body]  # by how much each body's change, BODY, (numbers, bodies)
    gravity: Floats  # by how much gravity does, (numbers, 3) [m/s^2]
    heavy: Ints  # whether the tree, gravity or a constraint changes, (numbers,)
    closures: NDArray[Closure]  # by how much closures' own numbers change, CLOSURE, (numbers, closures)
    couplings: NDArray[Coupled]  # those of couplings, COUPLED, (numbers, couplings)
    motions: Ints  # whether motions change, (numbers,)
    lacks: Floats  # how what accelerations lack does, scratch, (numbers, kinds, width)
    acts: Ints  # what of each part changes, 0 if nothing, then of elements on links, (parts + 1, numbers)
    steps: Floats  # first steps of differences, (numbers,)
    rules: LawWords  # numbers of contacts' laws that change
    laws: Floats  # derivatives of what laws say over these, scratch, (contacts, words, kinds, said)
    forces: Floats  # of the forces that the motion takes, with their sign turned, scratch, (numbers, nv)


@by_address
class RowRoom(NamedTuple):
    """Arrays for the derivatives of constraint rows."""

    ties: Records[Tie]  # what closures are, TIE, (closures,)
    bias: Floats  # generalized force of gravity and velocities, scratch, (nv,)
    force: Floats  # multipliers, (rows,)
    force_change: Floats  # how they change, scratch, (rows,)
    # how what accelerations lack changes, of the first kind, and by how much others differ from that,
    # scratch, (kinds, width)
    lacks: Floats
    speeds: Floats  # how rates of motions change, scratch, (motions,)
    twist: Floats  # scratch, (4,)
    wanted: Floats  # accelerations of motions, scratch, (motions,)
    trial: Floats  # their differences, how they bend, and the middle, scratch, (kinds + 2, motions)
    jerks: Floats  # those over time, (kinds, motions)
    column: Floats  # those over one number, scratch, (kinds, motions)


@by_address
class TangentRoom(NamedTuple):
    """Arrays for the parts of a derivative."""

    numbers: Numbers  # the system; its contact memory and program are those of the moment
    parts: Records[Part]  # what acts at joints, PART, (parts,)
    links_x: Ints  # where in x what elements on links integrate begins, (1,)
    weights: Floats  # of differences at 1, 2, ... steps, of each kind, (kinds, points)
    layout: Ints  # of the manifold
    bristles: Ints  # their places in x, (bristles,)
    bristle_of: Ints  # which bristle each place of x is, -1 if none, (nx,)
    units: Floats  # of ways, rates and bristles, (2 nv + bristles,)
    below: Ints  # the freedom next below each one, (nv,)
    asks: Ints  # what is asked for, scratch, (2,)
    state: Floats  # the state, and where it is displaced, (1, size)
    step: Floats  # of ways, scratch, (nv,)
    tau: Floats  # generalized force, scratch, (nv,)
    rates: Floats  # of velocities and of x, scratch, (nv + nx,)
    drift: Floats  # rates of x of the state itself, (nx,)
    poses: Records[Pose]  # POSE, (3,): of a journal as it is, its changes, and displaced
    remembered: Records[Memory]  # MEMORY, scratch, (1,)
    freedoms: Floats  # one freedom of a factor, scratch, (nv,)
    looked: Floats  # what is looked at, scratch, (values,)
    change: Floats  # how that of a contact changes, scratch, (kinds, LOOKED)
    shapes: Floats  # by how much its dimensions do, and these displaced, scratch, (2, CANDIDATE)
    wrench: Floats  # how the force and moment of a joint's contacts do, scratch, (kinds, 6)
    carried: Floats  # what these do along freedoms as the joint's frames change, scratch, (6,)
    trial: Floats  # its differences, how it bends, and the middle, scratch, (kinds + 2, values)
    column: Floats  # those that are kept, (kinds, values)
    middle: Floats  # what a law says undisplaced, scratch, (values,)
    sides: Floats  # what an element sees of its joints, scratch, (2, ROWS, MOST)
    over: Ints  # over which numbers of a displacement its law is differentiated, scratch, (slots,)
    of_law: Floats  # its derivatives, scratch, (slots, kinds, values)
    asked: Floats  # what laws are asked with, scratch
    said: Floats  # what they say, scratch
    laws: Floats  # derivatives of that, (contacts of a joint, asked, kinds, said)
    # PLACE, (bodies + 1,), the tree's own; those that constraints write, if there are any
    places: Records[Place]
    room: Records[BodyRoom]  # ROOM, likewise
    mass: Floats  # factors of the mass matrix, of a tree without constraints, (nv, nv)
    lanes: Floats  # right-hand sides, scratch, (nv, LANES)
    acceleration: Floats  # (nv,)
    bodies: Records[Change]  # CHANGE, (bodies + 1,), the last the ground
    body: Records[Change]  # CHANGE, scratch, (1,)
    first_number: Ints  # where in a displacement numbers of the system begin, (1,)
    seen: Ints  # which of them a joint sees, scratch, (numbers,)
    shifts: Shifts  # how these numbers go
    rows: RowRoom  # what constraints are differentiated with
