"""The laws by name, and what parameters each takes.

A scenario file, the command line and the documentation all read the laws from here; a law enters by one line.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from antenna_pin.contact.friction import Ambrosio, NoFriction, Tanh, VelocityBased
from antenna_pin.contact.normal import Hertz, LankaraniNikravesh

__all__ = ["FRICTION_LAWS", "NORMAL_LAWS", "Parameter", "law_parameters"]


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter of a law.

    Attributes:
        unit: Its unit, "1" for a pure number; ``N/m**exponent`` depends on the law's own exponent.
        required: Whether the law has no default for it.
        default: The default, or None.
        doc: What it is.
    """

    unit: str
    required: bool
    default: float | None
    doc: str


NORMAL_LAWS: Mapping[str, type[Any]] = MappingProxyType(
    {"hertz": Hertz, "lankarani-nikravesh": LankaraniNikravesh}
)

FRICTION_LAWS: Mapping[str, type[Any]] = MappingProxyType(
    {"none": NoFriction, "velocity-based": VelocityBased, "ambrosio": Ambrosio, "tanh": Tanh}
)


def law_parameters(law: type[Any]) -> dict[str, Parameter]:
    """Return the parameters of a law class by name, with unit, default and meaning."""
    found = {}
    for item in dataclasses.fields(law):
        required = item.default is dataclasses.MISSING
        found[item.name] = Parameter(
            unit=item.metadata["unit"],
            required=required,
            default=None if required else float(item.default),  # type: ignore[arg-type]
            doc=item.metadata["doc"],
        )
    return found
