"""Approach speed of a contact whose onset no run has seen."""

from __future__ import annotations

#: Approach speed [m/s] ([rad/s]) of a contact without an onset. Laws that divide by it come down to their
#: elastic part, to the last bit; it is finite, so that its logarithm and differences are too.
NO_APPROACH = 1e100

#: Depth up to which a contact is at its onset [m] ([rad]): a hundredth of an atom, more than poses round off.
AT_SURFACE = 1e-12


def approach_speed_in_contact(depth: float, rate: float, floor: float) -> float:
    """Return the approach speed of a contact that touches without an onset.

    A run starts there, or the contact is switched on.

    At the surface the contact begins there, with the present rate. Deeper in, its onset lies before all that
    is known, so that no speed can scale a damping: the contact presses out by its elastic force alone.

    Args:
        depth: Penetration depth [m] ([rad]).
        rate: Its rate [m/s] ([rad/s]).
        floor: Least approach speed that a law is passed [m/s] ([rad/s]).
    """
    return NO_APPROACH if depth > AT_SURFACE else max(rate, floor)
