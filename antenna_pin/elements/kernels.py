"""All kinds of force elements, compiled: dispatch by the number of the kind.

The chain ``if kind == ...`` is made from the registry when a caller is compiled, and compiled into it: who
finds its kernels compiled loads the elements that it has, not all. A number that no kind has gives
not-a-number, never a silent zero.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any

from antenna_pin.base.records import Floats, Pose
from antenna_pin.compiled.decorators import composed, composed_later
from antenna_pin.elements import registry
from antenna_pin.elements.desk_kernels import Desk
from antenna_pin.elements.hook_kernels import JournalPlace, Loaded, Motion, Own, Powered


@functools.cache
def _kinds() -> list[tuple[int, Any]]:
    return [(registry.kind_of(element), element.compiled()) for element in registry.ELEMENTS]


def _chain(name: str, last: Callable[..., Any]) -> Any:
    """Return a function that dispatches to the kind's own ``name``.

    Its arguments are a kind's number, and those of the kernel.

    Kinds without one, and numbers that are no kind's, go on to ``last``.
    """

    def dispatcher() -> Any:
        chain = composed(last)
        for kind, module in reversed(_kinds()):
            own = getattr(module, name, None)
            if own is not None:
                chain = _branch(kind, own, chain)
        return chain

    return composed_later(dispatcher)


def _branch(kind: int, own: Any, rest: Any) -> Any:
    def branch(number: int, *arguments: Any) -> Any:
        if number == kind:
            return own(*arguments)
        return rest(number, *arguments)

    return composed(branch)


def _no_kind(kind: int, *arguments: Any) -> float:
    return math.nan


def _nothing(kind: int, *arguments: Any) -> float:
    return 0.0


def _no_rates(kind: int, words: Floats, at: int, *arguments: Any) -> None:
    return None


def _no_reference(kind: int, words: Floats, at: int, t: float) -> tuple[float, float]:
    return math.nan, math.nan


def _no_deflection(kind: int, *arguments: Any) -> tuple[float, float, float, float]:
    return math.nan, math.nan, math.nan, math.nan


def _no_motion(kind: int, words: Floats, at: int, t: float) -> tuple[float, float, float]:
    return math.nan, math.nan, math.nan


def _never(kind: int, words: Floats, at: int, k: int, motion: Loaded) -> tuple[float, float]:
    return 1.0, 0.0


def _not_held(kind: int, words: Floats, at: int) -> tuple[bool, float]:
    return False, 0.0


def _bears_nothing(kind: int, words: Floats, at: int) -> tuple[float, float, float, float]:
    return 0.0, 0.0, 0.0, 0.0


def _not_told(kind: int, words: Floats, at: int, burden: float) -> None:
    return None


def _no_mode(kind: int, words: Floats, at: int) -> int:
    return 0


def _not_acting(kind: int, words: Floats, at: int, t: float, desk: Desk) -> None:
    desk[1][0].force[0] = math.nan


def _no_press(kind: int, words: Floats, at: int, pose: Pose) -> float:
    return math.nan


def _no_place(
    kind: int, words: Floats, at: int, place: JournalPlace
) -> tuple[float, float, float, float, float, float]:
    return math.nan, math.nan, math.nan, math.nan, math.nan, math.nan


effort = _chain("effort", _no_kind)
write_rates = _chain("write_rates", _no_rates)
stored = _chain("stored", _nothing)


def _effort(kind: int, words: Floats, at: int, motion: Motion, own: Own) -> float:
    t, angle, rate = motion
    return float(effort(kind, words, at, t, angle, rate))


def _write_rates(kind: int, words: Floats, at: int, motion: Powered, own: Own, rates: Floats, x: int) -> None:
    angle, rate, power = motion
    write_rates(kind, words, at, angle, rate, power, rates, x)


def _stored(kind: int, words: Floats, at: int, angle: float, own: Own) -> float:
    return float(stored(kind, words, at, angle))


# Of all, those with states of their own among them.
effort_of = _chain("effort_of", _effort)
write_rates_of = _chain("write_rates_of", _write_rates)
stored_of = _chain("stored_of", _stored)
kink = _chain("kink", _no_kind)


def _kink(kind: int, words: Floats, at: int, k: int, motion: Motion, own: Own) -> float:
    t, angle, rate = motion
    return float(kink(kind, words, at, t, angle, rate))


kink_of = _chain("kink_of", _kink)
reference = _chain("reference", _no_reference)
motion = _chain("motion", _no_motion)
# Of those with modes.
switch = _chain("switch", _never)
hold = _chain("hold", _not_held)
mode = _chain("mode", _no_mode)
# Of dry friction.
grip = _chain("grip", _nothing)
bearing = _chain("bearing", _bears_nothing)
rub = _chain("rub", _nothing)
bear = _chain("bear", _not_told)
# Of those between two joints.
between = _chain("between", _no_deflection)
dissipation = _chain("dissipation", _no_kind)
drag = _chain("drag", _nothing)
# Of those that act on a journal's whole pose.
press = _chain("press", _no_press)
journal_energy = _chain("journal_energy", _no_kind)
coordinates = _chain("coordinates", _no_place)
# Of those between points.
tension = _chain("tension", _no_kind)
loss = _chain("loss", _no_kind)
# Of those on links.
act = _chain("act", _not_acting)
