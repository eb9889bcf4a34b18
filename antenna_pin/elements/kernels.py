"""Hooks of all kinds of force elements, called by the number of the kind.

A call goes through a row of slots, one for each kind; the kernel of a kind is made and compiled when a run
first calls it. It makes of ``words`` and ``at``, the program and the place of an element's numbers in it, the
record that the kind's own hook takes, and the numbers behind that. A number that no kind has gives
not-a-number, never a silent zero.
"""

from __future__ import annotations

import functools
import inspect
import math
import sys
from collections.abc import Callable
from typing import Any

from antenna_pin.base.records import place_of, words_of
from antenna_pin.compiled.decorators import ByKind, kernel, record
from antenna_pin.elements import registry
from antenna_pin.elements.element import LOSS, Drive, Element, ForceElement, takes_tail
from antenna_pin.elements.hook_kernels import Hooks
from antenna_pin.elements.ledger_kernels import write_work

_Kind = type[ForceElement]
#: Value of a kind without a hook, as a statement of a kernel; None: that of numbers that are no kind's.
_Default = Callable[[_Kind], str | None]


def _mode(element: object) -> int:
    """Return the mode of an element, 0 without any."""
    raise NotImplementedError  # only its annotation is used


def _row(name: str, last: str, default: _Default = lambda element: None, plain: str = "") -> ByKind:
    """Return the kernels of all kinds that call the kind's own ``name``.

    Their arguments are a kind's number, program and place in it, and those of the hook behind the element.

    Args:
        name: Name of the hook.
        last: Statement for kinds without one, and numbers that are no kind's.
        default: Statement for a kind without one; None for ``last``.
        plain: Name and arguments of the hook that kinds without states have in its place.
    """
    like = getattr(Hooks, name, _mode)
    parameters = [one for one in inspect.signature(like).parameters if one not in ("self", "element")]
    head = f"def {name}({', '.join(['words', 'at', *parameters])}):\n    "
    cast = "float" if like.__annotations__["return"] == "float" else ""  # a kind's own needs no annotation

    def of_kind(number: int) -> Any:
        element: Any = registry.element_of(number)
        if element is None:
            return _kernel(name, head + last)
        namer = next(base for base in element.__mro__ if "kernels" in vars(base))
        for one in (f"{name}({', '.join(parameters)})", plain):
            hook = element.hook(called := one.partition("(")[0])
            if hook is not None:
                tail = f"words[at + {words_of(element.layout())} :], " if takes_tail(hook) else ""
                call = one.replace(f"{called}(", f"hook({_own(element)}, {tail}")
                return _kernel(name, f"{head}return {cast}({call})", namer, hook)
        if (statement := default(element)) is not None:
            return _kernel(name, head + statement, element)
        return _kernel(name, head + last)

    return ByKind(f"{__name__}:{name}", like, of_kind)


def _own(element: _Kind) -> str:
    """Return the expression of an element's record."""
    return f"record(words[at : at + {words_of(element.layout())}], layout)"


@functools.cache
def _kernel(name: str, text: str, owner: _Kind | None = None, hook: Callable[..., Any] | None = None) -> Any:
    """Return the kernel of a text, stored with the file of its class."""
    names: dict[str, Any] = {
        "record": record,
        "write_work": write_work,
        "nan": math.nan,
        "hook": hook,
        "__name__": __name__,
    }
    path, own = __file__, ""
    if owner is not None:
        path, own = str(sys.modules[owner.__module__].__file__), f".{owner.__name__}"
        names |= {"layout": owner.layout(), "__name__": owner.__module__}
    exec(compile(text, path, "exec"), names)  # noqa: S102 - a kernel has a fixed number of arguments
    names[name].__qualname__ += own
    return kernel(names[name])


# --- kinds without a hook -----------------------------------------------------------------------------------


def _no_effort(element: _Kind) -> str | None:
    """Return no effort of a kind at a joint that has none of its own."""
    return "return 0.0" if issubclass(element, Element) and not element.hook("effort_of") else None


def _rates(element: _Kind) -> str | None:
    """Return the work that a drive at a joint puts in, or no loss."""
    if not issubclass(element, Element) or element.hook("press"):
        return None
    works = "write_work(motion[2], rates, x)"
    return {Drive.integrals: works, (LOSS,): "rates[x] = 0.0"}.get(element.integrals)


def _mode_of(element: _Kind) -> str | None:
    """Return the mode of a kind whose record has one."""
    return f"return int({_own(element)}.mode)" if "mode" in (element.layout().names or ()) else None


def _bearing(element: _Kind) -> str | None:
    """Return the ``load_numbers`` of a kind whose record has them."""
    if "load_numbers" not in (element.layout().names or ()):
        return None
    first = place_of(element.layout(), "load_numbers")
    return f"return {', '.join(f'words[at + {first + k}]' for k in range(4))}"


# --- all of them --------------------------------------------------------------------------------------------

effort = _row("effort", "return nan", _no_effort)
# Of all, those with states of their own among them.
effort_of = _row("effort_of", "return nan", _no_effort, "effort(motion[0], motion[1], motion[2])")
write_rates_of = _row(
    "write_rates_of", "return None", _rates, "write_rates(motion[0], motion[1], motion[2], rates, x)"
)
stored = _row("stored", "return 0.0")
stored_of = _row("stored_of", "return 0.0", plain="stored(angle)")
kink_of = _row("kink_of", "return nan", plain="kink(motion[0], motion[1], motion[2])")
reference = _row("reference", "return nan, nan")
motion = _row("motion", "return nan, nan, nan")
# Of those with modes.
switch = _row("switch", "return 1.0, 0.0")
hold = _row("hold", "return False, 0.0")
mode = _row("mode", "return 0", _mode_of)
# Of dry friction.
grip = _row("grip", "return 0.0")
bearing = _row("bearing", "return 0.0, 0.0, 0.0, 0.0", _bearing)
rub = _row("rub", "return 0.0")
bear = _row("bear", "return None")
# Of those between two joints.
between = _row("between", "return nan, nan, nan, nan")
dissipation = _row("dissipation", "return nan")
drag = _row("drag", "return 0.0")
# Of those that act on a journal's whole pose.
press = _row("press", "return nan")
journal_energy = _row("journal_energy", "return nan")
coordinates = _row("coordinates", "return nan, nan, nan, nan, nan, nan")
# Of those between points.
tension = _row("tension", "return nan")
loss = _row("loss", "return nan")
# Of those on links.
act = _row("act", "desk[1][0].force[0] = nan")
