"""Callbacks of compiled code through function pointers: Pinocchio, coal, functions in Python.

An address of zero means that the kernel in place computes the result itself. Addresses are those
of functions in Python, or of machine code (:mod:`antenna_pin.compiled.native`). Arguments and
results are in arrays that both sides share. A failed call leaves its status in ``failed``; from
there on nothing is called, and the results of the step are void. The caller of the step reads the status.
"""

from __future__ import annotations

from typing import NamedTuple

from antenna_pin.base.records import Floats, Record, Records, layout
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.calls import call_back
from antenna_pin.compiled.decorators import inlined

# Status of a callback: valid; a function of the user's has no valid result here, though it may elsewhere; or
# the run must end.
ANSWERED = 0
REFUSED = 1
RAISED = 2


class CallbackRecord(Record):
    """Addresses of callbacks, 0 where the kernel's own code serves, and their arguments and answers."""

    elements: int  # before elements are evaluated, at a time and state
    motions: int  # the same, for constraints only
    acceleration: int  # for accelerations under ``effort``
    terms: int  # for mass matrix and bias
    tree: int  # object of machine code for ``acceleration`` and ``terms``; 0: they are Python's
    queried: int  # 1: machine code evaluates coal's distances
    gaps: int  # for gaps measured by a backend
    forces: int  # for forces of laws at these gaps, of one ``contact`` or of all
    step: int  # of the loop: for a whole trial step of a size [s]
    lack: int  # of the loop: for the correction of the trial step size [s]
    touching: int  # 1: elements are called only while a contact touches
    contact: int  # contact whose forces are requested; -1: all
    new: int  # 1: the start of the step is new
    failed: int  # status of a callback that failed
    answer: float  # all flags in one number


ASKED = layout(CallbackRecord)


@by_address
class Outside(NamedTuple):
    """Questions and answers."""

    asked: Records[CallbackRecord]  # requests of callbacks, ASKED, (1,)
    state: Floats  # state of a request, [q, v, x], (size,)
    effort: Floats  # generalized force of a request for accelerations, (nv,)
    acceleration: Floats  # resulting accelerations, (nv,)


@inlined
def ask(outside: Outside, address: int, t: float) -> None:
    """Ask what stands at an address, unless something could not be answered before."""
    asked = outside.asked[0]
    if asked.failed == ANSWERED:
        status = call_back(address, t, asked.tree)
        if status != ANSWERED:
            asked.failed = status


@inlined
def ask_at(outside: Outside, address: int, t: float, y: Floats) -> None:
    """Ask at a time [s] and state."""
    for k in range(outside.state.shape[0]):
        outside.state[k] = y[k]
    ask(outside, address, t)


@inlined
def has_failed(outside: Outside) -> bool:
    """Return whether a callback failed."""
    return bool(outside.asked[0].failed != ANSWERED)
