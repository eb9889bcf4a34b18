"""How the constraints of a system lie in flat numbers: declared once, read by name.

``plan`` does not change during a run: ``PLAN``, then the tree's bodies, then a ``CLOSURE`` for each
closure, a ``DRIVEN`` for each motion, a ``COUPLED`` for each coupling, a ``DRIVEN`` for each element that may
hold its joint; rows of these are the last. ``work`` is what a run works on: a
``PLACE`` for each body, one for scratch and those of a closure's two frames, then numbers whose starts the
plan's head names.
"""

from __future__ import annotations

from typing import Any

from antenna_pin.base.records import layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.mechanism.tree_kernels import BODY, PLACE

#: Head of a plan. Sizes: bodies, closures, motions, couplings, elements that may hold, all rows, these in
#: whole lanes (``width``; zeros fill the last), nq and nv, this in whole lanes (``span``). Length by which
#: turns count against ways [m]. Where in a work array the following start. By the rows' own numbers: J^T,
#: (nv, width); what accelerations lack, residuals of position and of velocity, multipliers, and the share
#: that was left of each row, each (width,). By the places of the rows in the order in which they are made
#: orthogonal: what is left of L^-1 J^T behind the directions, (width / LANES, nv, LANES); the directions,
#: (rows, span); the triangle R without its diagonal, (rows, width), and that one's ``inverses``; the squares
#: of the lengths that are left, by what these count, and which rows stand there, each (width,). L with
#: inverses on the diagonal, (nv, nv); where its rows begin, (nv,); numbers for scratch, (2, max(span,
#: width)); ``FOUND``; room of friction by load, 0 where no joint has such, first in it what elements on
#: links do to each body, force and moment about its origin, (bodies, 6); gravity [m/s^2].
PLAN = layout(
    ("bodies", "i8"),
    ("closures", "i8"),
    ("motions", "i8"),
    ("couplings", "i8"),
    ("holds", "i8"),
    ("rows", "i8"),
    ("width", "i8"),
    ("nq", "i8"),
    ("nv", "i8"),
    ("span", "i8"),
    ("length", "f8"),
    ("jacobian", "i8"),
    ("lack", "i8"),
    ("gap", "i8"),
    ("speed", "i8"),
    ("force", "i8"),
    ("shares", "i8"),
    ("reduced", "i8"),
    ("directions", "i8"),
    ("triangle", "i8"),
    ("inverses", "i8"),
    ("squares", "i8"),
    ("weights", "i8"),
    ("order", "i8"),
    ("root", "i8"),
    ("first", "i8"),
    ("scratch", "i8"),
    ("found", "i8"),
    ("loaded", "i8"),
    ("gravity", "f8", (3,)),
)
PLAN_WORDS = words_of(PLAN)

#: A closure: indices of its two bodies (-1: the world), its first row and how many it has, which
#: axes of the first frame its translations and turns are held along and about (0 or 1), whether it holds two
#: axes at right angles, and all turns; the frames in their bodies: rotation and origin [m].
CLOSURE = layout(
    ("first", "i8"),
    ("second", "i8"),
    ("row", "i8"),
    ("rows", "i8"),
    ("along", "i8", (3,)),
    ("about", "i8", (3,)),
    ("square", "i8"),
    ("attitude", "i8"),
    ("first_rotation", "f8", (3, 3)),
    ("first_origin", "f8", (3,)),
    ("second_rotation", "f8", (3, 3)),
    ("second_origin", "f8", (3,)),
)
CLOSURE_WORDS = words_of(CLOSURE)

#: A motion: its row, starts of its joint's q and v, whether the joint slides, place of its turned angle in x
#: (-1: an angle that is known itself), the kind of its element, where in the program the element's own record
#: begins, and where in x its works are; of a joint that does more than turn about its axis, as one with play,
#: how it moves (PLANE or RIGID, else 0) and axes of which z is the joint's, in the joint's frame (columns).
DRIVEN = layout(
    ("row", "i8"),
    ("q", "i8"),
    ("v", "i8"),
    ("slides", "i8"),
    ("turn", "i8"),
    ("kind", "i8"),
    ("words", "i8"),
    ("x", "i8"),
    ("moves", "i8"),
    ("axes", "f8", (3, 3)),
)
DRIVEN_WORDS = words_of(DRIVEN)

#: A coupling: its row, whether its follower slides, multiplier and offset, by what the row is multiplied so
#: that its larger number is the one that a motion's row has; the mass that its row is given [kg]
#: (``factor_kernels.brace``), zero where the tree needs none; of follower and leader, in this order, the
#: starts of q and v, and the place of the turned angle in x (-1: none). A leader that does not move has a
#: multiplier of zero and the follower's places.
COUPLED = layout(
    ("row", "i8"),
    ("slides", "i8"),
    ("multiplier", "f8"),
    ("second", "f8"),
    ("offset", "f8"),
    ("scale", "f8"),
    ("brace", "f8"),
    ("q", "i8", (3,)),
    ("v", "i8", (3,)),
    ("turn", "i8", (3,)),
)
COUPLED_WORDS = words_of(COUPLED)

#: What solving finds: rank; the least of what was left of a row counted as independent, and the most of one
#: that was not, over its scale [-]; largest residual in ways [m], turns [rad] and their rates.
FOUND = layout(
    ("rank", "i8"),
    ("least", "f8"),
    ("most", "f8"),
    ("gap", "f8"),
    ("turn", "f8"),
    ("speed", "f8"),
    ("spin", "f8"),
)
FOUND_WORDS = words_of(FOUND)

BODY_WORDS = words_of(BODY)
PLACE_WORDS = words_of(PLACE)


@inlined
def plan_of(plan: Any) -> Any:
    """Return the head of a plan."""
    return record(plan[:PLAN_WORDS], PLAN)


@inlined
def body_at(plan: Any, b: int) -> Any:
    """Return a body of the tree."""
    at = PLAN_WORDS + BODY_WORDS * b
    return record(plan[at : at + BODY_WORDS], BODY)


@inlined
def closure_at(plan: Any, c: int) -> Any:
    """Return a closure."""
    at = PLAN_WORDS + BODY_WORDS * plan_of(plan).bodies + CLOSURE_WORDS * c
    return record(plan[at : at + CLOSURE_WORDS], CLOSURE)


@inlined
def driven_at(plan: Any, m: int) -> Any:
    """Return a motion."""
    head = plan_of(plan)
    at = PLAN_WORDS + BODY_WORDS * head.bodies + CLOSURE_WORDS * head.closures + DRIVEN_WORDS * m
    return record(plan[at : at + DRIVEN_WORDS], DRIVEN)


@inlined
def coupled_at(plan: Any, k: int) -> Any:
    """Return a coupling."""
    head = plan_of(plan)
    at = PLAN_WORDS + BODY_WORDS * head.bodies + CLOSURE_WORDS * head.closures
    at += DRIVEN_WORDS * head.motions + COUPLED_WORDS * k
    return record(plan[at : at + COUPLED_WORDS], COUPLED)


@inlined
def hold_at(plan: Any, k: int) -> Any:
    """Return an element that may hold its joint."""
    head = plan_of(plan)
    at = PLAN_WORDS + BODY_WORDS * head.bodies + CLOSURE_WORDS * head.closures
    at += DRIVEN_WORDS * (head.motions + k) + COUPLED_WORDS * head.couplings
    return record(plan[at : at + DRIVEN_WORDS], DRIVEN)


@inlined
def place_at(work: Any, b: int) -> Any:
    """Return where a body is."""
    return record(work[PLACE_WORDS * b : PLACE_WORDS * (b + 1)], PLACE)


@inlined
def applied_in(plan: Any) -> tuple[int, int]:
    """Return from where to where elements on links act on bodies, 6 words each; nowhere if none asks."""
    head = plan_of(plan)
    return head.loaded, head.loaded + (6 * head.bodies if head.loaded != 0 else 0)


@inlined
def found_in(plan: Any, work: Any) -> Any:
    """Return what solving found."""
    at = plan_of(plan).found
    return record(work[at : at + FOUND_WORDS], FOUND)
