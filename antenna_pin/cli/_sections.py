"""What the commands on sections share: where, of what, and how many points."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from antenna_pin.nonlinear import Section


class Direction(StrEnum):
    """Which passages of a surface count."""

    RISING = "rising"
    FALLING = "falling"
    BOTH = "both"


SECTION = typer.Option(
    help="Where the motion is looked at: period (of its drives), period=DRIVE, period='0.5 s',"
    " angle.JOINT=VALUE, rate.JOINT=VALUE, gap.CONTACT=VALUE or force.CONTACT=VALUE."
)
DIRECTION = typer.Option(help="Which passages of a surface count.")
PHASE = typer.Option(help="Part of the period at which it is looked at, from 0 to below 1.")
QUANTITY = typer.Option(
    "--quantity", "-q", metavar="NAME", help="What is noted, as 'v[hinge]'. May be repeated."
)
COUNT = typer.Option(metavar="N", help="Points to keep, 32 or more.")
TOLERANCE = typer.Option(help="A drift below this part of a quantity's largest amount is none.")

SectionOption = Annotated[str, SECTION]
DirectionOption = Annotated[Direction, DIRECTION]
PhaseOption = Annotated[float, PHASE]
QuantityOption = Annotated[list[str], QUANTITY]
CountOption = Annotated[int, COUNT]
ToleranceOption = Annotated[float, TOLERANCE]
TransientOption = Annotated[
    int | None,
    typer.Option(metavar="N", help="Points to cut before them; until they have settled if left out."),
]
MostOption = Annotated[
    int | None,
    typer.Option(metavar="N", help="Points after which to stop cutting; 20 times those kept if left out."),
]


def section_from(text: str, direction: Direction, phase: float) -> Section:
    """Return the section that the options say."""
    from antenna_pin.nonlinear import section_of

    return section_of(text, direction.value, phase)
