"""Rotors of motors."""

from __future__ import annotations

from antenna_pin.base.changes import Rotor
from antenna_pin.scenario._made import MadeSpec, reads

__all__ = ["RotorSpec"]


@reads(Rotor)
class RotorSpec(MadeSpec):
    """The rotor of a motor at a joint, geared to it: its inertia as the joint and what carries it feel it."""
