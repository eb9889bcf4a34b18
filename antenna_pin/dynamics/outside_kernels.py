"""What compiled code asks outside: Pinocchio, coal, functions in Python, each by an address.

Where an address is zero there is nothing to be asked: the kernel that is there answers. Questions and answers
stand in arrays that both sides know. A question that could not be answered leaves its status in ``failed``:
from there on nothing is asked, and what has been computed counts for nothing. Whoever made the step reads it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from antenna_pin.base.records import layout
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.calls import call_back
from antenna_pin.compiled.decorators import inlined

# What comes of a question: an answer; a function of the user's has none here, though it may elsewhere; or
# something that ends the run.
ANSWERED = 0
REFUSED = 1
RAISED = 2

#: Addresses of what is asked: before elements are evaluated, ``elements`` (gaps, laws and drives in Python)
#: at a time and state; for the constraints' sake only ``motions``; the ``acceleration`` under ``effort``;
#: mass matrix and bias, ``terms``; gaps that a backend measures, ``gaps``, and then laws' ``forces`` on them,
#: of one ``contact`` or of all (-1). Of the loop: a whole trial ``step`` of a size [s], and how much longer
#: the trial is to be, the ``lack`` [s]. Then whether elements are asked only while a contact is ``touching``;
#: that contact; whether the start of the step is ``new``; a ``failed`` question's status; an ``answer`` in
#: one number.
ASKED = layout(
    ("elements", "i8"),
    ("motions", "i8"),
    ("acceleration", "i8"),
    ("terms", "i8"),
    ("gaps", "i8"),
    ("forces", "i8"),
    ("step", "i8"),
    ("lack", "i8"),
    ("touching", "i8"),
    ("contact", "i8"),
    ("new", "i8"),
    ("failed", "i8"),
    ("answer", "f8"),
)


@by_address
class Outside(NamedTuple):
    """Questions and answers.

    Attributes:
        asked: ASKED, (1,).
        state: At which is asked, [q, v, x], (size,).
        effort: Generalized force under which accelerations are asked for, (nv,).
        acceleration: The answer to that, (nv,).
    """

    asked: Any
    state: Any
    effort: Any
    acceleration: Any


@inlined
def ask(outside: Any, address: int, t: float) -> None:
    """Ask what stands at an address, unless something could not be answered before."""
    asked = outside.asked[0]
    if asked.failed == ANSWERED:
        status = call_back(address, t)
        if status != ANSWERED:
            asked.failed = status


@inlined
def ask_at(outside: Any, address: int, t: float, y: Any) -> None:
    """Ask at a time [s] and state."""
    for k in range(outside.state.shape[0]):
        outside.state[k] = y[k]
    ask(outside, address, t)


@inlined
def has_failed(outside: Any) -> bool:
    """Whether something could not be answered."""
    return bool(outside.asked[0].failed != ANSWERED)
