"""What drives integrate, compiled."""

from __future__ import annotations

from typing import Any

from antenna_pin._compile import inlined


@inlined
def write_work(words: Any, at: int, rate: float, power: float, rates: Any, x: int) -> None:
    """Work and gross work of a drive: what it puts in, and the integral of its size."""
    rates[x] = power
    rates[x + 1] = abs(power)
