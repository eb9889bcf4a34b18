"""All kinds of force elements, compiled: dispatch by the number of the kind.

The chain ``if kind == ...`` is made from the registry when a caller is compiled, and compiled into it: who
finds its kernels compiled loads the elements that it has, not all. It makes of ``words`` and ``at``, the
program and the place of an element's numbers in it, the record that a kind's kernel takes, and the numbers
behind that. A number that no kind has gives not-a-number, never a silent zero.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any

from antenna_pin.base.records import Floats, place_of, words_of
from antenna_pin.compiled.decorators import composed, composed_later, record
from antenna_pin.elements import registry
from antenna_pin.elements.desk_kernels import Desk
from antenna_pin.elements.element import LOSS, Drive, Element, ForceElement, takes_tail
from antenna_pin.elements.hook_kernels import Motion, Own, Powered
from antenna_pin.elements.ledger_kernels import write_work

_Kind = type[ForceElement]


@functools.cache
def _kinds() -> list[tuple[int, _Kind]]:
    return [(registry.kind_of(element), element) for element in registry.ELEMENTS]


def _chain(
    name: str, last: Callable[..., Any], otherwise: Callable[[_Kind], Any] = lambda element: None
) -> Any:
    """Return a function that dispatches to the kind's own ``name``.

    Its arguments are a kind's number, program and place in it, and the further ones of the kernel.

    Args:
        name: Of the kernel.
        last: For kinds without one, and numbers that are no kind's; takes all arguments.
        otherwise: Function of program, place and these for a kind without one; None for ``last``.
    """

    def dispatcher() -> Any:
        lines = [f"def {name}(kind, words, at, *arguments):"]
        names: dict[str, Any] = {"__name__": __name__, "record": record}
        for kind, element in _kinds():
            own = element.hook(name)
            if own is not None:
                size = words_of(element.layout())
                tail = f"words[at + {size} :], " if takes_tail(own) else ""
                call = f"(record(words[at : at + {size}], layout_{kind}), {tail}*arguments)"
                names[f"layout_{kind}"] = element.layout()
            elif (plain := otherwise(element)) is not None:
                own, call = composed(plain), "(words, at, *arguments)"
            else:
                continue
            names[f"own_{kind}"] = own
            lines += [f"    if kind == {kind}:", f"        return own_{kind}{call}"]
        names["last"] = composed(last)
        lines.append("    return last(kind, words, at, *arguments)")
        exec("\n".join(lines), names)  # noqa: S102 - a chain of functions is compiled in twice the time
        return composed(names[name])

    return composed_later(dispatcher)


def _always(value: Any) -> Callable[..., Any]:
    """Return a function of a kind's number, program and place that returns a constant."""
    return lambda kind, *arguments: value


def _no_rates(kind: int, *arguments: Any) -> None:
    return None


def _no_action(kind: int, words: Floats, at: int, t: float, desk: Desk) -> None:
    desk[1][0].force[0] = math.nan


# --- kernels that kinds need not have -----------------------------------------------------------------------


def _effort_of_kind(element: _Kind) -> Any:
    """Return no effort of a kind at a joint that has none of its own."""
    if not issubclass(element, Element) or element.hook("effort_of"):
        return None
    return lambda words, at, t, angle, rate: 0.0


def _work(words: Floats, at: int, angle: float, rate: float, power: float, rates: Floats, x: int) -> None:
    write_work(power, rates, x)


def _no_loss(words: Floats, at: int, angle: float, rate: float, power: float, rates: Floats, x: int) -> None:
    rates[x] = 0.0


def _rates_of_kind(element: _Kind) -> Any:
    """Return the work that a drive at a joint puts in, or no loss."""
    if not issubclass(element, Element) or element.hook("write_rates_of") or element.hook("press"):
        return None
    return {Drive.integrals: _work, (LOSS,): _no_loss}.get(element.integrals)


def _mode_of_kind(element: _Kind) -> Any:
    """Return the mode of a kind whose record has one."""
    layout = element.layout()
    if "mode" not in (layout.names or ()):
        return None
    size = words_of(layout)
    return lambda words, at: int(record(words[at : at + size], layout).mode)


def _bearing_of_kind(element: _Kind) -> Any:
    """Return the ``load_numbers`` of a kind whose record has them."""
    layout = element.layout()
    if "load_numbers" not in (layout.names or ()):
        return None
    first = place_of(layout, "load_numbers")
    return lambda words, at: (
        words[at + first],
        words[at + first + 1],
        words[at + first + 2],
        words[at + first + 3],
    )


# --- all of them --------------------------------------------------------------------------------------------

effort = _chain("effort", _always(math.nan), _effort_of_kind)
write_rates = _chain("write_rates", _no_rates, _rates_of_kind)
stored = _chain("stored", _always(0.0))


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
kink = _chain("kink", _always(math.nan))


def _kink(kind: int, words: Floats, at: int, k: int, motion: Motion, own: Own) -> float:
    t, angle, rate = motion
    return float(kink(kind, words, at, t, angle, rate))


kink_of = _chain("kink_of", _kink)
reference = _chain("reference", _always((math.nan,) * 2))
motion = _chain("motion", _always((math.nan,) * 3))
# Of those with modes.
switch = _chain("switch", _always((1.0, 0.0)))
hold = _chain("hold", _always((False, 0.0)))
mode = _chain("mode", _always(0), _mode_of_kind)
# Of dry friction.
grip = _chain("grip", _always(0.0))
bearing = _chain("bearing", _always((0.0,) * 4), _bearing_of_kind)
rub = _chain("rub", _always(0.0))
bear = _chain("bear", _no_rates)
# Of those between two joints.
between = _chain("between", _always((math.nan,) * 4))
dissipation = _chain("dissipation", _always(math.nan))
drag = _chain("drag", _always(0.0))
# Of those that act on a journal's whole pose.
press = _chain("press", _always(math.nan))
journal_energy = _chain("journal_energy", _always(math.nan))
coordinates = _chain("coordinates", _always((math.nan,) * 6))
# Of those between points.
tension = _chain("tension", _always(math.nan))
loss = _chain("loss", _always(math.nan))
# Of those on links.
act = _chain("act", _no_action)
