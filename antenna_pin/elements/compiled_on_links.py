"""Functions of a user's that Numba has compiled and that act on links: how kernels call them.

Kernels call a function by its address with a time and the place of a stretch of numbers
(:mod:`antenna_pin.elements.desk_kernels`); what stands there, records, is made here of how many there are.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from antenna_pin.errors import InvalidParameterError

__all__ = ["address_on_links", "wrench_on_links"]

#: Compiled functions, kept for as long as their addresses are in use anywhere.
_KEPT: list[Any] = []


def address_on_links(place: str, name: str, function: Any, sizes: tuple[int, int, int, int]) -> float:
    """Return where a compiled function stands that kernels call.

    Args:
        place: Whose it is, for the refusal.
        name: Which one, for the refusal.
        function: Compiled by ``numba.njit``.
        sizes: How many parameters, links, joints and states it is asked of.

    Raises:
        InvalidParameterError: Numba cannot compile it for these.
    """
    from numba.core.errors import NumbaError

    try:
        return float(_compiled(function, sizes).address)
    except NumbaError as error:
        first = next(line for line in str(error).splitlines() if line.strip())
        rule = "a compiled function of what an element on links sees"
        raise InvalidParameterError(
            place, name, rule, said=f"one of which Numba says: {first.strip()}"
        ) from None


@cache
def wrench_on_links(function: Any) -> Any:
    """Return a function that acts on one link by what a compiled one says of time, pose and twist."""
    import numpy as np
    from numba import njit

    @njit
    def act(t: float, p: Any, links: Any, joints: Any, states: Any, whole: Any) -> None:
        link = links[0]
        pose, twist = np.zeros((4, 4)), np.zeros(6)
        pose[3, 3] = 1.0
        for i in range(3):
            pose[i, 3] = link.place[i]
            twist[i], twist[3 + i] = link.velocity[i], link.spin[i]
            for k in range(3):
                pose[i, k] = link.rotation[i, k]
        six = function(t, pose, twist)
        for k in range(3):
            link.force[k], link.torque[k] = six[k], six[3 + k]

    return act


@cache
def _compiled(function: Any, sizes: tuple[int, int, int, int]) -> Any:
    """Return a function as kernels call it: of a time and a place, which gives 1 where it raises."""
    from numba import carray, cfunc, float64, njit

    from antenna_pin.base.records import words_of
    from antenna_pin.compiled.pointer import pointer
    from antenna_pin.elements.desk_kernels import JOINT, LINK, STATE, WHOLE

    numbers, links, joints, states = sizes
    first = numbers
    second = first + words_of(WHOLE)
    third = second + links * words_of(LINK)
    fourth = third + joints * words_of(JOINT)
    end = fourth + states * words_of(STATE)

    @njit
    def asked(t: float, all_: Any) -> None:
        function(
            t,
            all_[:first],
            all_[second:third].view(LINK),
            all_[third:fourth].view(JOINT),
            all_[fourth:end].view(STATE),
            all_[first:second].view(WHOLE)[0],
        )

    def wrapped(t: float, place: float, _: float) -> float:
        try:
            asked(t, carray(pointer(place), (end,)))
        except Exception:
            return 1.0
        return 0.0

    own: Callable[..., float] = wrapped
    compiled: Any = cfunc(float64(float64, float64, float64), error_model="numpy")(own)
    _KEPT.append(compiled)
    return compiled
