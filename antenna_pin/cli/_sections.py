"""What the commands on sections share: where, of what, and how many points."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.cli._quantities import bare
from antenna_pin.errors import InvalidParameterError

if TYPE_CHECKING:
    from antenna_pin.nonlinear import Section


class Direction(StrEnum):
    """Which passages of a surface count."""

    RISING = "rising"
    FALLING = "falling"
    BOTH = "both"


SectionOption = Annotated[
    str,
    typer.Option(
        help="Where the motion is looked at: period (of its drives), period=DRIVE, period='0.5 s',"
        " angle.JOINT=VALUE, rate.JOINT=VALUE, gap.CONTACT=VALUE or force.CONTACT=VALUE."
    ),
]
DirectionOption = Annotated[Direction, typer.Option(help="Which passages of a surface count.")]
PhaseOption = Annotated[
    float, typer.Option(help="Part of the period at which it is looked at, from 0 to below 1.")
]
QuantityOption = Annotated[
    list[str],
    typer.Option("--quantity", "-q", metavar="NAME", help="What is noted, as 'v[hinge]'. May be repeated."),
]
CountOption = Annotated[int, typer.Option(metavar="N", help="Points to keep, 32 or more.")]
TransientOption = Annotated[
    int | None,
    typer.Option(metavar="N", help="Points to cut before them; until they have settled if left out."),
]
MostOption = Annotated[
    int | None,
    typer.Option(metavar="N", help="Points after which to stop cutting; 20 times those kept if left out."),
]
ToleranceOption = Annotated[
    float, typer.Option(help="A drift below this part of a quantity's largest amount is none.")
]


def section_from(text: str, direction: Direction, phase: float) -> Section:
    """Return the section that the options say."""
    from antenna_pin.nonlinear import section_of

    return section_of(text, direction.value, phase)


def values_from(text: str) -> list[Any]:
    """Return the values of a parameter: ``FIRST:LAST:COUNT``, or a list with commas."""
    import numpy as np

    from antenna_pin.units import any_quantity

    place, rule = "bifurcation", "FIRST:LAST:COUNT as '0 mm:0.9 mm:10', or values with commas between"
    parts = [part.strip() for part in text.split(":")]
    if len(parts) == 1:
        found: list[Any] = [bare(part.strip()) for part in text.split(",") if part.strip()]
        if any(any_quantity(value) is None for value in found):
            raise InvalidParameterError(place, "--values", rule, text)
        return found
    ends = [any_quantity(bare(part)) for part in parts[:2]]
    if len(parts) != 3 or not parts[2].isdigit() or int(parts[2]) < 2 or None in ends:
        raise InvalidParameterError(place, "--values", f"{rule}, COUNT 2 or more", text)
    (first, one), (last, other) = (end for end in ends if end is not None)
    if one and other and one != other:
        raise InvalidParameterError(place, "--values", "of one unit from first to last", text)
    unit = one or other
    suffix = f" {unit}" if unit not in ("", "1") else ""
    numbers = np.linspace(first, last, int(parts[2])).tolist()
    return [f"{number!r}{suffix}" if suffix else number for number in numbers]
