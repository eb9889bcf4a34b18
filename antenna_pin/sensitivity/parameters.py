"""What results are differentiated by: numbers of a scenario, and how far each may go."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from antenna_pin.base.units import quantity
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.scenario import Scenario, number_of

__all__ = ["GrazeError", "Parameter", "SensitivityError", "parameters_of"]

# Tables of which no motion is a differentiable function: how it is computed, and what of it is kept.
_NOT_OF_THE_MOTION = ("duration", "integrator", "output", "format")


class SensitivityError(AntennaPinError, RuntimeError):
    """A result has no derivative that can be told; the message says which and why."""


class GrazeError(SensitivityError):
    """A contact or an event comes or goes with the smallest change of a parameter: there is no derivative.

    Attributes:
        time: When, about; NaN if that is not known [s].
    """

    def __init__(self, message: str, time: float = math.nan) -> None:
        """Compose it."""
        super().__init__(message)
        self.time = time


class Parameter(NamedTuple):
    """A number of a scenario that results are differentiated by.

    Attributes:
        key: Where it stands.
        value: In SI units.
        unit: Its SI unit; "" where that depends on what else stands there.
        scale: What counts as one of it, in the same unit: changes are small beside this.
    """

    key: str
    value: float
    unit: str
    scale: float


def parameters_of(
    scenario: Scenario, keys: Sequence[str] | Mapping[str, float | str | None], place: str
) -> tuple[Parameter, ...]:
    """Return the parameters at some keys of a scenario.

    Args:
        scenario: The scenario.
        keys: As in ``--set``, ``mechanism.gravity[2]`` for one number of an array; a mapping gives each its
            scale, a number or text with a unit, or None for the size of its value.
        place: Who asks, for messages.

    Raises:
        InvalidParameterError: Two are one, none is given, one has no scale, or motions are none of it.
        UnknownNameError: The scenario has no such number.
    """
    scales = dict(keys) if isinstance(keys, Mapping) else dict.fromkeys(keys)
    if not scales:
        raise InvalidParameterError(place, "keys", "one key of the scenario or more", said="none")
    if len(scales) < len(keys):
        twice = next(key for key in keys if list(keys).count(key) > 1)
        raise InvalidParameterError(place, "keys", "named once each", said=f"{twice} twice")
    found = []
    for key, scale in scales.items():
        if key.split(".")[0] in _NOT_OF_THE_MOTION:
            rule = f"of the mechanism, its loads or its start, not of {', '.join(_NOT_OF_THE_MOTION)}"
            raise InvalidParameterError(place, "key", rule, said=key)
        number = number_of(scenario, key, place)
        size = abs(number.value) if scale is None else quantity(scale, number.unit or "1", f"{place}: {key}")
        if not 0.0 < size < math.inf:
            rule = (
                f"given with its scale, positive, where its value is 0: {{{key!r}: 0.1}}, or {key}=0.1 "
                "on the command line"
            )
            raise InvalidParameterError(place, key, rule, said="0" if scale is None else f"{scale}")
        found.append(Parameter(key, number.value, number.unit, size))
    return tuple(found)
