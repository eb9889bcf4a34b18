"""Figures 5 to 16 of Chen and Cui (2021).

J. Harbin Institute of Technology (New Series) 28(3), 61-78.
Of Figures 5 to 8 the paper draws two to four periods after fifty of them; these begin at the start, and their
numbers are of the second half of the run. ``--duration 110s`` goes as far as the paper's. Figures 9 to 16
are of settled motions, sampled once a period of the drives.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from antenna_pin.analysis import Verdict
from antenna_pin.show.plot.against_ideal import BodyQuantity
from antenna_pin.show.plot.papers import _findings
from antenna_pin.show.plot.papers._figure import AttractorFigure, Diagram, DiagramFigure, PaperFigure

_JOINT = "s2"
_TWO = ("ideal", "friction-005", "friction-010")
_THREE = ("friction-005", "friction-010", "friction-015")


def _of_platform(number: int, quantity: BodyQuantity, name: str, shows: str) -> PaperFigure:
    return PaperFigure(
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
        name="figure08-contact-force",
        cases=_THREE,
        shows="Contact force at s2 for friction 0.05, 0.10 and 0.15 over four periods: vibration of high "
        "frequency on a curve like a sine; 115.4 to 162.7 N, 127.9 to 152.8 N and 122.5 to 160.1 N.",
        figure="steady_force",
        joint=_JOINT,
        finding=partial(_findings.steady_forces, joint=_JOINT),
    ),
)

_FRICTIONS = {value: f"friction {value}" for value in ("0.01", "0.05", "0.10")}
_CLEARANCES = {f"15.{part} mm": f"clearance 0.{part} mm" for part in ("30", "42", "67")}
_PLATFORM = tuple(f"body_velocity[platform].{axis}" for axis in "xyz")
_BALL = tuple(f"journal_velocity[{_JOINT}].{axis}" for axis in "xyz")
_ONE, _QUASI, _CHAOS = "period 1", "quasi-periodic", "chaotic"

_OVER_FRICTION = Diagram(name="chen2021/friction", label="coefficient of friction")
_OVER_CLEARANCE = Diagram(name="chen2021/clearance", label="clearance", zero=15e-3)  # the ball's radius


def _mostly_single(values: Sequence[float], verdicts: Sequence[Verdict]) -> bool:
    """Return whether motion is single-period above the smaller half of values."""
    other = [value for value, one in zip(values, verdicts, strict=True) if one != _ONE]
    middle = 0.5 * (values[0] + values[-1]) if values else 0.0
    return len(other) < 0.5 * len(values) and all(value < middle for value in other)


def _chaotic_then_quasi(values: Sequence[float], verdicts: Sequence[Verdict]) -> bool:
    """Return whether no motion has a period; few points decide nothing else."""
    return bool(values) and not any(one.startswith("period") for one in verdicts)


def _single(values: Sequence[float], verdicts: Sequence[Verdict]) -> bool:
    return bool(values) and all(one == _ONE for one in verdicts)


ATTRACTORS: tuple[AttractorFigure | DiagramFigure, ...] = (
    AttractorFigure(
        name="figure09-platform-friction",
        over=_OVER_FRICTION,
        values=_FRICTIONS,
        x="body_position[platform].z",
        y=_PLATFORM[2],
        shows="Phase trajectory and Poincare map of the platform along Z: a ring of some width and points "
        "over some length with friction 0.01, quasi-periodic; one line and one point with 0.05 and 0.10, "
        "period 1.",
        there=dict(zip(_FRICTIONS, (_QUASI, _ONE, _ONE), strict=True)),
    ),
    DiagramFigure(
        name="figure10-platform-over-friction",
        diagram=_OVER_FRICTION,
        quantities=_PLATFORM,
        shows="Velocity of the platform over friction 0.01 to 0.20: single-period mostly, quasi-periodic "
        "where friction is small.",
        agrees=_mostly_single,
    ),
    AttractorFigure(
        name="figure11-ball-friction",
        over=_OVER_FRICTION,
        values=_FRICTIONS,
        x=f"journal_position[{_JOINT}].y",
        y=_BALL[1],
        shows="Phase trajectory and Poincare map of the ball in its socket along Y: entangled rings and "
        "scattered points with friction 0.01, chaotic; a wide ring and a line of points with 0.05, a "
        "narrower and shorter one with 0.10, quasi-periodic both.",
        there=dict(zip(_FRICTIONS, (_CHAOS, _QUASI, _QUASI), strict=True)),
    ),
    DiagramFigure(
        name="figure12-ball-over-friction",
        diagram=_OVER_FRICTION,
        quantities=_BALL,
        shows="Velocity of the ball in its socket over friction 0.01 to 0.20: chaotic from 0.010 to 0.022, "
        "quasi-periodic above, most stable near 0.07 and 0.10.",
        agrees=_chaotic_then_quasi,
    ),
    AttractorFigure(
        name="figure13-platform-clearance",
        over=_OVER_CLEARANCE,
        values=_CLEARANCES,
        x="body_position[platform].z",
        y=_PLATFORM[2],
        shows="Phase trajectory and Poincare map of the platform along Z for three clearances: one line like "
        "an ellipse, one point; period 1 for all.",
        there=dict.fromkeys(_CLEARANCES, _ONE),
    ),
    DiagramFigure(
        name="figure14-platform-over-clearance",
        diagram=_OVER_CLEARANCE,
        quantities=_PLATFORM,
        shows="Velocity of the platform over clearances of 0 to 0.9 mm: one point at each, period 1.",
        agrees=_single,
    ),
    AttractorFigure(
        name="figure15-ball-clearance",
        over=_OVER_CLEARANCE,
        values=_CLEARANCES,
        x=f"journal_position[{_JOINT}].y",
        y=_BALL[1],
        shows="Phase trajectory and Poincare map of the ball in its socket along Y for three clearances: "
        "wavy rings, points along a line; quasi-periodic all three, the more agitated the larger the "
        "clearance.",
        there=dict.fromkeys(_CLEARANCES, _QUASI),
    ),
    DiagramFigure(
        name="figure16-ball-over-clearance",
        diagram=_OVER_CLEARANCE,
        quantities=_BALL,
        shows="Velocity of the ball in its socket over clearances of 0 to 0.9 mm: mostly quasi-periodic, "
        "nowhere chaotic; the range of velocities is larger at 0.42 mm and largest at 0.67 mm.",
        agrees=_chaotic_then_quasi,
    ),
)
