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
    """How numbers of the system go with parameters, and with what elements keep: all of these by one name.

    Attributes:
        program: Which words of the program, :class:`antenna_pin.integrate.word_kernels.Words`.
        tree: Which of the bodies' numbers, likewise.
        flat: The bodies' numbers, flat, the tree's own.
        bodies: By how much each body's change, BODY, (numbers, bodies).
        gravity: By how much gravity does, (numbers, 3) [m/s^2].
        heavy: Whether the tree, gravity or a constraint changes, (numbers,).
        closures: By how much closures' own numbers change, CLOSURE, (numbers, closures).
        couplings: Those of couplings, COUPLED, (numbers, couplings).
        motions: Whether motions change, (numbers,).
        lacks: How what accelerations lack does, scratch, (numbers, kinds, width).
        acts: What of each part changes, 0 if nothing, then of elements on links, (parts + 1, numbers).
        steps: First steps of differences, (numbers,).
        rules: Numbers of contacts' laws that change.
        laws: Derivatives of what laws say over these, scratch, (contacts, words, kinds, said).
        forces: Of the forces that the motion takes, with their sign turned, scratch, (numbers, nv).
    """

    program: Words
    tree: Words
    flat: Floats
    bodies: NDArray[Body]
    gravity: Floats
    heavy: Ints
    closures: NDArray[Closure]
    couplings: NDArray[Coupled]
    motions: Ints
    lacks: Floats
    acts: Ints
    steps: Floats
    rules: LawWords
    laws: Floats
    forces: Floats


@by_address
class RowRoom(NamedTuple):
    """What rows of constraints are differentiated with.

    Attributes:
        ties: What closures are, TIE, (closures,).
        bias: Generalized force of gravity and velocities, scratch, (nv,).
        force: Multipliers, (rows,).
        force_change: How they change, scratch, (rows,).
        lacks: How what accelerations lack changes, of the first kind, and by how much others differ from
            that, scratch, (kinds, width).
        speeds: How rates of motions change, scratch, (motions,).
        twist: Scratch, (4,).
        wanted: Accelerations of motions, scratch, (motions,).
        trial: Their differences, how they bend, and the middle, scratch, (kinds + 2, motions).
        jerks: Those over time, (kinds, motions).
        column: Those over one number, scratch, (kinds, motions).
    """

    ties: Records[Tie]
    bias: Floats
    force: Floats
    force_change: Floats
    lacks: Floats
    speeds: Floats
    twist: Floats
    wanted: Floats
    trial: Floats
    jerks: Floats
    column: Floats


@by_address
class TangentRoom(NamedTuple):
    """What the parts of a derivative are computed with.

    Attributes:
        numbers: The system; its contact memory and program are those of the moment.
        parts: What acts at joints, PART, (parts,).
        links_x: Where in x what elements on links integrate begins, (1,).
        weights: Of differences at 1, 2, ... steps, of each kind, (kinds, points).
        layout: Of the manifold.
        bristles: Their places in x, (bristles,).
        bristle_of: Which bristle each place of x is, -1 if none, (nx,).
        units: Of ways, rates and bristles, (2 nv + bristles,).
        below: The freedom next below each one, (nv,).
        asks: What is asked for, scratch, (2,).
        state: The state, and where it is displaced, (1, size).
        step: Of ways, scratch, (nv,).
        tau: Generalized force, scratch, (nv,).
        rates: Of velocities and of x, scratch, (nv + nx,).
        drift: Rates of x of the state itself, (nx,).
        poses: POSE, (3,): of a journal as it is, its changes, and displaced.
        remembered: MEMORY, scratch, (1,).
        freedoms: One freedom of a factor, scratch, (nv,).
        looked: What is looked at, scratch, (values,).
        change: How that of a contact changes, scratch, (kinds, LOOKED).
        shapes: By how much its dimensions do, and these displaced, scratch, (2, CANDIDATE).
        wrench: How the force and moment of a joint's contacts do, scratch, (kinds, 6).
        carried: What these do along freedoms as the joint's frames change, scratch, (6,).
        trial: Its differences, how it bends, and the middle, scratch, (kinds + 2, values).
        column: Those that are kept, (kinds, values).
        middle: What a law says undisplaced, scratch, (values,).
        sides: What an element sees of its joints, scratch, (2, ROWS, MOST).
        over: Over which numbers of a displacement its law is differentiated, scratch, (slots,).
        of_law: Its derivatives, scratch, (slots, kinds, values).
        asked: What laws are asked with, scratch.
        said: What they say, scratch.
        laws: Derivatives of that, (contacts of a joint, asked, kinds, said).
        places: PLACE, (bodies + 1,), the tree's own; those that constraints write, if there are any.
        room: ROOM, likewise.
        mass: Factors of the mass matrix, of a tree without constraints, (nv, nv).
        lanes: Right-hand sides, scratch, (nv, LANES).
        acceleration: (nv,).
        bodies: CHANGE, (bodies + 1,), the last the ground.
        body: CHANGE, scratch, (1,).
        first_number: Where in a displacement numbers of the system begin, (1,).
        seen: Which of them a joint sees, scratch, (numbers,).
        shifts: How these numbers go.
        rows: What constraints are differentiated with.
    """

    numbers: Numbers
    parts: Records[Part]
    links_x: Ints
    weights: Floats
    layout: Ints
    bristles: Ints
    bristle_of: Ints
    units: Floats
    below: Ints
    asks: Ints
    state: Floats
    step: Floats
    tau: Floats
    rates: Floats
    drift: Floats
    poses: Records[Pose]
    remembered: Records[Memory]
    freedoms: Floats
    looked: Floats
    change: Floats
    shapes: Floats
    wrench: Floats
    carried: Floats
    trial: Floats
    column: Floats
    middle: Floats
    sides: Floats
    over: Ints
    of_law: Floats
    asked: Floats
    said: Floats
    laws: Floats
    places: Records[Place]
    room: Records[BodyRoom]
    mass: Floats
    lanes: Floats
    acceleration: Floats
    bodies: Records[Change]
    body: Records[Change]
    first_number: Ints
    seen: Ints
    shifts: Shifts
    rows: RowRoom
