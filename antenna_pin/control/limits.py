"""What a command may be: limits of its size and of its rate."""

from __future__ import annotations

__all__ = ["limited"]


def limited(
    wished: float, before: float, step: float | None, bounds: tuple[float | None, float | None]
) -> float:
    """Return a command: what is wished, no further from the one before than a step, within bounds.

    Args:
        wished: What would be commanded without limits.
        before: The command before.
        step: By how much it may change; None for as much as it likes.
        bounds: The least and the largest; None for none.
    """
    found = wished
    if step is not None:
        found = min(max(found, before - step), before + step)
    lower, upper = bounds
    if lower is not None:
        found = max(found, lower)
    return found if upper is None else min(found, upper)
