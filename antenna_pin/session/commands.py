"""What a session commands: the numbers of elements, by the elements' names or by place."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, MutableMapping

from antenna_pin.base.parameters import holds, parameters_of
from antenna_pin.base.units import quantity
from antenna_pin.dynamics import System, acting_in
from antenna_pin.elements import Element
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.session.numbers import slides
from antenna_pin.simulation.loop import Run

__all__ = ["Commands", "in_si"]


def in_si(run: Run, place: str, value: float | str | bool) -> float | bool:
    """Return what a number of an element is to be in SI units.

    Args:
        run: Whose element.
        place: Of the number; one that there is not is for who sets it to refuse.
        value: A number, or text with a unit.

    Raises:
        AntennaPinError: It is no such number.
    """
    if not isinstance(value, str):
        if not isinstance(value, bool) and not holds(value, ""):
            raise InvalidParameterError("set", place, "a finite number, or text with a unit", value)
        return value
    element, _, key = place.rpartition(".")
    for one in acting_in(run.system):
        if one.place == element and key in (known := parameters_of(type(one.element))):
            joint = one.element.acts_at if isinstance(one.element, Element) else None
            slid = joint is not None and slides(run, joint)
            unit = known[key].sliding if slid and known[key].sliding else known[key].unit
            return quantity(value, unit, f"set: {place}")
    return math.nan


class Commands(MutableMapping[str, float]):
    """The numbers that elements are commanded by, by the elements' names.

    Of two elements of one name in two tables both stand under theirs with the table: ``drives.motor``.

    Args:
        system: What is commanded.
        read: Returns a number, by its place.
        write: Changes one.
    """

    def __init__(
        self,
        system: System,
        read: Callable[[str], float],
        write: Callable[[str, float | str], None],
    ) -> None:
        """Find them."""
        self._read, self._write = read, write
        found = [one for one in acting_in(system) if one.element.commanded]
        names = [one.name for one in found]
        self._places = {
            one.name if names.count(one.name) == 1 else one.place: f"{one.place}.{one.element.commanded}"
            for one in found
        }

    def place(self, name: str) -> str:
        """Return the place of what is commanded, such as ``drives.motor.value``.

        Raises:
            UnknownNameError: Nothing of that name can be commanded.
        """
        if name not in self._places:
            raise UnknownNameError("session", "element to command", name, self._places)
        return self._places[name]

    def __getitem__(self, name: str) -> float:
        """Return what is commanded now."""
        return self._read(self.place(name))

    def __setitem__(self, name: str, value: float | str) -> None:
        """Command it from now on."""
        self._write(self.place(name), value)

    def __delitem__(self, name: str) -> None:
        """Refuse: what is commanded stays."""
        raise InvalidParameterError("session", "command", "set, not removed", name)

    def __contains__(self, name: object) -> bool:
        """Whether something of this name can be commanded."""
        return name in self._places

    def __iter__(self) -> Iterator[str]:
        """Name what can be commanded."""
        return iter(self._places)

    def __len__(self) -> int:
        """How much can be commanded."""
        return len(self._places)

    def __repr__(self) -> str:
        """Return what is commanded."""
        return repr(dict(self))
