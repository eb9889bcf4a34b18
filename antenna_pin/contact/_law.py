"""What all laws share."""

from __future__ import annotations

from typing import Any, Self

from antenna_pin.base.arguments import fits, unknown_type
from antenna_pin.base.parameters import parameters_of
from antenna_pin.errors import InvalidParameterError

__all__ = ["Law"]


class Law:
    """Base of laws and dissipations: their parameters are numbers, in SI units."""

    __slots__ = ()

    def __new__(cls, *given: Any, **parameters: Any) -> Self:
        """Refuse what is no number, before a law asks for more."""
        declared = parameters_of(cls)
        for name, value in parameters.items():
            one = declared.get(name)
            if one is None or (value is None and not one.required and one.default is None):
                continue
            if not fits(value, float):
                unit = "" if one.unit == "1" else f" [{one.unit}]"
                raise InvalidParameterError(cls.__name__, name, f"a number{unit}", said=unknown_type(value))
        return super().__new__(cls)
