"""The arrays that the derivative of a system's rates is computed with, part by part."""

from __future__ import annotations

from typing import NamedTuple

from numpy.typing import NDArray

from antenna_pin.base.records import Floats, Ints, Memory, Pose, Records
from antenna_pin.compiled.by_address import by_address
from antenna_pin.dynamics.constraints.layout_kernels import ClosureRecord, Coupled
from antenna_pin.dynamics.constraints.tangent_kernels import Tie
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.integrate.difference_kernels import Words
from antenna_pin.joints.tangent_room_kernels import LawWords, Part
from antenna_pin.mechanism.room_kernels import BodyRoom
from antenna_pin.mechanism.spatial_kernels import BodyChange
from antenna_pin.mechanism.tree_kernels import Body, Place


@by_address
class Shifts(NamedTuple):
    """Derivatives of system numbers over parameters and over stored numbers of elements."""

    program: Words  # changed words of the program, :class:`antenna_pin.integrate.difference_kernels.Words`
    tree: Words  # changed words of the bodies
    flat: Floats  # the tree's own bodies, flat
    bodies: NDArray[Body]  # changes of bodies, BODY, (numbers, bodies)
    gravity: Floats  # changes of gravity, (numbers, 3) [m/s^2]
    heavy: Ints  # flags of changes of tree, gravity or constraints, (numbers,)
    closures: NDArray[ClosureRecord]  # changes of closures, CLOSURE, (numbers, closures)
    couplings: NDArray[Coupled]  # changes of couplings, COUPLED, (numbers, couplings)
    motions: Ints  # flags of changes of motions, (numbers,)
    lacks: Floats  # changes of biases of accelerations, scratch, (numbers, kinds, width)
    acts: Ints  # dependence of each part, last of elements on links, (parts + 1, numbers)
    steps: Floats  # first steps of differences, (numbers,)
    rules: LawWords  # changed words of contacts' laws
    laws: Floats  # derivatives of laws over these, scratch, (contacts, words, kinds, outputs)
    forces: Floats  # constraint forces, sign reversed, scratch, (numbers, nv)


@by_address
class RowRoom(NamedTuple):
    """Arrays for the derivatives of constraint rows."""

    ties: Records[Tie]  # closures in the state, TIE, (closures,)
    bias: Floats  # generalized force of gravity and velocities, scratch, (nv,)
    force: Floats  # multipliers, (rows,)
    force_change: Floats  # their changes, scratch, (rows,)
    # how what accelerations lack changes, of the first kind, and by how much others differ from that,
    # scratch, (kinds, width)
    lacks: Floats
    speeds: Floats  # changes of rates of motions, scratch, (motions,)
    twist: Floats  # scratch, (4,)
    wanted: Floats  # accelerations of motions, scratch, (motions,)
    trial: Floats  # differences of these, curvature and middle, scratch, (kinds + 2, motions)
    jerks: Floats  # derivatives of these over time, (kinds, motions)
    column: Floats  # derivatives of these over one number, scratch, (kinds, motions)


@by_address
class TangentRoom(NamedTuple):
    """Arrays for the parts of a derivative."""

    numbers: Numbers  # the system, with the present contact memory and program
    parts: Records[Part]  # elements and contacts at joints, PART, (parts,)
    links_x: Ints  # start in x of the integrals of elements on links, (1,)
    weights: Floats  # weights of differences at 1, 2, ... steps, by kind, (kinds, points)
    layout: Ints  # layout of the manifold
    bristles: Ints  # places of bristles in x, (bristles,)
    bristle_of: Ints  # index of the bristle at each place of x, -1 for none, (nx,)
    units: Floats  # units of positions, rates and bristles, (2 nv + bristles,)
    below: Ints  # next lower freedom of each one, (nv,)
    asks: Ints  # requested outputs, scratch, (2,)
    state: Floats  # the state, displaced in place, (1, size)
    step: Floats  # tangent step, scratch, (nv,)
    tau: Floats  # generalized force, scratch, (nv,)
    rates: Floats  # rates of velocities and x, scratch, (nv + nx,)
    drift: Floats  # rates of x in the unperturbed state, (nx,)
    poses: Records[Pose]  # pose of a journal, its changes, and the displaced pose, POSE, (3,)
    remembered: Records[Memory]  # contact memory, MEMORY, scratch, (1,)
    freedoms: Floats  # one freedom of a factor, scratch, (nv,)
    looked: Floats  # values under differentiation, scratch, (values,)
    change: Floats  # derivatives of a contact's values, scratch, (kinds, LOOKED)
    shapes: Floats  # changes of a contact's dimensions, and displaced dimensions, scratch, (2, CANDIDATE)
    wrench: Floats  # changes of force and moment of a joint's contacts, scratch, (kinds, 6)
    carried: Floats  # changes of their action with the joint's frames, scratch, (6,)
    trial: Floats  # differences of values, curvature and middle, scratch, (kinds + 2, values)
    column: Floats  # accepted differences, (kinds, values)
    middle: Floats  # output of a law without displacement, scratch, (values,)
    sides: Floats  # inputs of an element from its joints, scratch, (2, ROWS, MOST)
    over: Ints  # numbers over which its law is differentiated, scratch, (slots,)
    of_law: Floats  # derivatives of its law, scratch, (slots, kinds, values)
    asked: Floats  # inputs of laws, scratch
    said: Floats  # outputs of laws, scratch
    laws: Floats  # derivatives of outputs, (contacts of a joint, inputs, kinds, outputs)
    # PLACE, (bodies + 1,), the tree's own; those that constraints write, if there are any
    places: Records[Place]
    room: Records[BodyRoom]  # ROOM, likewise
    mass: Floats  # factors of the mass matrix, of a tree without constraints, (nv, nv)
    lanes: Floats  # right-hand sides, scratch, (nv, LANES)
    acceleration: Floats  # (nv,)
    bodies: Records[BodyChange]  # CHANGE, (bodies + 1,), the last the ground
    body: Records[BodyChange]  # CHANGE, scratch, (1,)
    first_number: Ints  # start of system numbers in a displacement, (1,)
    seen: Ints  # flags of numbers that affect a joint, scratch, (numbers,)
    shifts: Shifts  # derivatives of system numbers
    rows: RowRoom  # arrays for rows of constraints
