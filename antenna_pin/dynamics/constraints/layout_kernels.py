"""Layout of a system's constraints in flat numbers.

``plan`` is constant during a run: ``PLAN``, then the tree's bodies, then a ``CLOSURE`` for each closure, a
``DRIVEN`` for each motion, a ``COUPLED`` for each coupling, a ``DRIVEN`` for each element that may hold its
joint, whose rows are the last. ``work`` has a ``PLACE`` for each body, one for scratch and those of a
closure's two frames, then arrays whose starts are in the plan's head.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats, Indices3, Matrix3, Record, Vector3, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.mechanism.tree_kernels import BODY, PLACE, Body, Place


class PlanRecord(Record):
    """Head of a plan: sizes, and the starts of its arrays in a work array."""

    bodies: int  # number of bodies
    closures: int  # number of closures
    motions: int  # number of motions
    couplings: int  # number of couplings
    holds: int  # number of elements that may hold
    rows: int  # number of all rows
    width: int  # rows in whole lanes; zeros fill the last
    nq: int  # size of q
    nv: int  # size of v
    span: int  # nv in whole lanes
    length: float  # length of 1 rad [m]
    jacobian: int  # J^T by row, (nv, width)
    lack: int  # right sides of accelerations, (width,)
    gap: int  # residuals of position, (width,)
    speed: int  # residuals of velocity, (width,)
    force: int  # multipliers, (width,)
    shares: int  # remaining share of each row, (width,)
    reduced: int  # rest of L^-1 J^T after the directions, in order, (width / LANES, nv, LANES)
    directions: int  # orthogonal directions, in order, (rows, span)
    triangle: int  # R without its diagonal, in order, (rows, width)
    inverses: int  # inverses of R's diagonal, (width,)
    squares: int  # squares of the remaining lengths, (width,)
    weights: int  # scale factors, (width,)
    order: int  # numbers of the rows there, (width,)
    root: int  # L with inverses on the diagonal, (nv, nv)
    first: int  # first columns of its rows, (nv,)
    scratch: int  # scratch, (2, max(span, width))
    found: int  # FOUND
    loaded: int  # arrays for friction by load, efforts on bodies first, (bodies, 6); 0: no such joint
    gravity: Vector3  # gravity [m/s^2]


PLAN = layout(PlanRecord)
PLAN_WORDS = words_of(PLAN)


class ClosureRecord(Record):
    """A closure of a loop between two bodies."""

    first: int  # index of a body; -1: the world
    second: int  # index of a body; -1: the world
    row: int  # first of its rows
    rows: int  # number of its rows
    along: Indices3  # axes of the first frame along which translations are held, 0 or 1
    about: Indices3  # axes of the first frame about which rotation is blocked, 0 or 1
    square: int  # 1: holds two axes at right angles
    attitude: int  # 1: blocks all rotations
    first_rotation: Matrix3  # frame in the first body
    first_origin: Vector3  # [m]
    second_rotation: Matrix3  # frame in the second body
    second_origin: Vector3  # [m]


CLOSURE = layout(ClosureRecord)
CLOSURE_WORDS = words_of(CLOSURE)


class Driven(Record):
    """A prescribed motion of a joint."""

    row: int  # its row
    q: int  # start of the joint's slice of q
    v: int  # start of the joint's slice of v
    slides: int  # 1: prismatic
    turn: int  # place of the turned angle in x; -1: the angle has limits
    kind: int  # kind of its element
    words: int  # start of the element's own record in the program
    x: int  # start of its works in x
    moves: int  # PLANE or RIGID of a joint with more freedoms than its axis, else 0
    axes: Matrix3  # rotation whose z is the joint's axis, in the joint's frame (columns)


DRIVEN = layout(Driven)
DRIVEN_WORDS = words_of(DRIVEN)


class Coupled(Record):
    """A coupling: follower, leader and second leader, in this order in ``q``, ``v``, ``turn``."""

    row: int  # its row
    slides: int  # 1: the follower slides
    multiplier: float  # multiplier of the leader's angle
    second: float  # multiplier of the second leader's
    offset: float  # offset [rad] ([m])
    scale: float  # scale of the row, so that its larger number is that of a motion's row
    brace: float  # mass of the row (``factor_kernels.brace``) [kg]; 0: none needed
    q: Indices3  # starts of the joints' slices of q
    v: Indices3  # starts of the joints' slices of v
    turn: Indices3  # places of the turned angles in x; -1: none


COUPLED = layout(Coupled)
COUPLED_WORDS = words_of(COUPLED)


class ConstraintSolution(Record):
    """The outcome of solving for the constraints."""

    rank: int  # rank of the rows
    least: float  # least remainder of an independent row, over its scale
    most: float  # largest remainder of a dependent row, over its scale
    gap: float  # largest residual [m]
    turn: float  # largest residual [rad]
    speed: float  # largest residual [m/s]
    spin: float  # largest residual [rad/s]


FOUND = layout(ConstraintSolution)
FOUND_WORDS = words_of(FOUND)

BODY_WORDS = words_of(BODY)
PLACE_WORDS = words_of(PLACE)


@inlined
def plan_of(plan: Floats) -> PlanRecord:
    """Return the head of a plan."""
    return record(plan[:PLAN_WORDS], PLAN)


@inlined
def body_at(plan: Floats, b: int) -> Body:
    """Return a body of the tree."""
    at = PLAN_WORDS + BODY_WORDS * b
    return record(plan[at : at + BODY_WORDS], BODY)


@inlined
def closure_at(plan: Floats, c: int) -> ClosureRecord:
    """Return a closure."""
    at = PLAN_WORDS + BODY_WORDS * plan_of(plan).bodies + CLOSURE_WORDS * c
    return record(plan[at : at + CLOSURE_WORDS], CLOSURE)


@inlined
def driven_at(plan: Floats, m: int) -> Driven:
    """Return a motion."""
    head = plan_of(plan)
    at = PLAN_WORDS + BODY_WORDS * head.bodies + CLOSURE_WORDS * head.closures + DRIVEN_WORDS * m
    return record(plan[at : at + DRIVEN_WORDS], DRIVEN)


@inlined
def coupled_at(plan: Floats, k: int) -> Coupled:
    """Return a coupling."""
    head = plan_of(plan)
    at = PLAN_WORDS + BODY_WORDS * head.bodies + CLOSURE_WORDS * head.closures
    at += DRIVEN_WORDS * head.motions + COUPLED_WORDS * k
    return record(plan[at : at + COUPLED_WORDS], COUPLED)


@inlined
def hold_at(plan: Floats, k: int) -> Driven:
    """Return an element that may hold its joint."""
    head = plan_of(plan)
    at = PLAN_WORDS + BODY_WORDS * head.bodies + CLOSURE_WORDS * head.closures
    at += DRIVEN_WORDS * (head.motions + k) + COUPLED_WORDS * head.couplings
    return record(plan[at : at + DRIVEN_WORDS], DRIVEN)


@inlined
def place_at(work: Floats, b: int) -> Place:
    """Return where a body is."""
    return record(work[PLACE_WORDS * b : PLACE_WORDS * (b + 1)], PLACE)


@inlined
def applied_in(plan: Floats) -> tuple[int, int]:
    """Return the range of the forces on bodies of elements on links, 6 words each."""
    head = plan_of(plan)
    return head.loaded, head.loaded + (6 * head.bodies if head.loaded != 0 else 0)


@inlined
def found_in(plan: Floats, work: Floats) -> ConstraintSolution:
    """Return what solving found."""
    at = plan_of(plan).found
    return record(work[at : at + FOUND_WORDS], FOUND)
