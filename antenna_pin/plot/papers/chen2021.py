"""Figures 5 to 8 of Chen and Cui (2021), J. Harbin Institute of Technology (New Series) 28(3), 61-78.

The paper draws two to four periods after fifty of them; these begin at the start, and their numbers are of
the second half of the run. ``--duration 110s`` goes as far as the paper's.
"""

from __future__ import annotations

from functools import partial

from antenna_pin.plot.bodies import BodyQuantity
from antenna_pin.plot.papers import _findings
from antenna_pin.plot.papers._figure import PaperFigure

__all__ = ["FIGURES"]

_JOINT = "s2"
_TWO = ("ideal", "friction-005", "friction-010")
_THREE = ("friction-005", "friction-010", "friction-015")


def _of_platform(number: int, quantity: BodyQuantity, name: str, shows: str) -> PaperFigure:
    return PaperFigure(
        number=number,
        name=f"figure{number:02d}-platform-{name}",
        cases=_TWO,
        shows=shows,
        figure=f"body_{quantity}",
        joint=_JOINT,
        finding=partial(_findings.of_body, quantity=quantity, joint=_JOINT),
    )


FIGURES = (
    _of_platform(
        5,
        "position",
        "displacement",
        "Displacement of the platform's centre, ideal and with friction 0.05 and 0.10: 0.1 mm off along X, "
        "the same for both; Y and Z coincide but for slight deviations.",
    ),
    _of_platform(
        6,
        "velocity",
        "velocity",
        "Its velocity: both coincide with the ideal one in Y and Z; in X they lie around it, 0.05 slightly "
        "further.",
    ),
    _of_platform(
        7,
        "acceleration",
        "acceleration",
        "Its acceleration: vibration of high frequency about the ideal one, more of it with friction 0.05 "
        "than with 0.10.",
    ),
    PaperFigure(
        number=8,
        name="figure08-contact-force",
        cases=_THREE,
        shows="Contact force at s2 for friction 0.05, 0.10 and 0.15 over four periods: vibration of high "
        "frequency on a curve like a sine; 115.4 to 162.7 N, 127.9 to 152.8 N and 122.5 to 160.1 N.",
        figure="steady_force",
        joint=_JOINT,
        finding=partial(_findings.steady_forces, joint=_JOINT),
    ),
)
