"""Modes of elements, as kernels for calls from Python.

The chains of kinds are parts of kernels only.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import kernel
from antenna_pin.elements import kernels as elements


@kernel
def is_held(kind: int, p: Floats, at: int) -> bool:
    """Return whether an element holds its joint, by its parameters at a word."""
    return bool(elements.hold(kind, p, at)[0])


@kernel
def mode_of(kind: int, p: Floats, at: int) -> int:
    """Return the mode of an element, by its parameters at a word."""
    return int(elements.mode(kind, p, at))


@kernel
def grip_of(kind: int, p: Floats, at: int) -> float:
    """Return the torque [N m] (force [N]) at which dry friction slips."""
    return float(elements.grip(kind, p, at))
