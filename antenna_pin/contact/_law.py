"""What all laws share."""

from __future__ import annotations

from typing import Any, Self

from antenna_pin.arguments import fits, unknown_type
from antenna_pin.errors import InvalidParameterError
from antenna_pin.parameters import parameters_of

__all__ = ["Law"]


class Law:
    """Base of laws and dissipations: their parameters are numbers, in SI units."""

    __slots__ = ()

    def __new__(cls, *given: Any, **parameters: Any) -> Self:
        """Refuse what is no number, before a law asks for more."""
        declared = parameters_of(cls)
        for name, value in parameters.items():
            if name in declared and not fits(value, float):
                unit = "" if declared[name].unit == "1" else f" [{declared[name].unit}]"
                raise InvalidParameterError(cls.__name__, name, f"a number{unit}", said=unknown_type(value))
        return super().__new__(cls)
