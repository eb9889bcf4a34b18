"""Figures 6 to 16 of You, Pan and Zhao (2010).

Journal of Astronautics 31(10), 2251-2258 (in Chinese).
"""

from __future__ import annotations

from functools import partial

from antenna_pin.show.plot.against_ideal import BaseQuantity
from antenna_pin.show.plot.motion import Quantity
from antenna_pin.show.plot.papers import _findings
from antenna_pin.show.plot.papers._figure import PaperFigure

_JOINT = "joint2"
_BOTH = ("ideal", "planar")


def _of_base(number: int, quantity: BaseQuantity, shows: str) -> PaperFigure:
    return PaperFigure(
        name=f"figure{number:02d}-base-{quantity.replace('_', '-')}",
        cases=_BOTH,
        shows=shows,
        figure=f"base_{quantity}",
        finding=partial(_findings.of_base, quantity=quantity),
    )


def _of_joints(number: int, quantity: Quantity, shows: str) -> PaperFigure:
    return PaperFigure(
        name=f"figure{number:02d}-shaft-{quantity}",
        cases=_BOTH,
        shows=shows,
        figure=f"joints_{quantity}",
        finding=partial(_findings.of_joints, quantity=quantity),
    )


FIGURES = (
    PaperFigure(
        name="figure06-eccentricity",
        cases=("planar",),
        shows="Eccentricity of the journal: severe impacts and large deformations at first, then weaker "
        "ones, contact and flight in turn.",
        figure="eccentricity",
        joint=_JOINT,
        finding=_findings.penetration,
    ),
    PaperFigure(
        name="figure07-impact-force",
        cases=_BOTH,
        shows="Force between journal and bearing: it fluctuates like the eccentricity, and is nearly 20 "
        "times the ideal joint's at most.",
        figure="joint_load",
        joint=_JOINT,
        # The first impacts; the largest force may come with the last swing.
        close_view=(0.0, 0.05),
        finding=partial(_findings.force_ratio, joint=_JOINT),
    ),
    _of_base(8, "position", "Position of the base: nearly that of the ideal joint."),
    _of_base(9, "velocity", "Velocity of the base: nearly that of the ideal joint."),
    _of_base(10, "acceleration", "Acceleration of the base: pulses from the impacts."),
    _of_base(11, "attitude", "Euler angles of the base: nearly those of the ideal joint."),
    _of_base(12, "angular_velocity", "Angular velocity of the base: nearly that of the ideal joint."),
    _of_base(13, "angular_acceleration", "Angular acceleration of the base: pulses from the impacts."),
    _of_joints(14, "angle", "Angles of both shafts: little changed for a short time, deviations that grow."),
    _of_joints(15, "rate", "Rates of both shafts: the same."),
    _of_joints(16, "acceleration", "Accelerations of both shafts: pulses from the impacts."),
)
