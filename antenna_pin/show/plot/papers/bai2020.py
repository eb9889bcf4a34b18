"""Figures 7 to 13 of Bai and Zhao (2020), Int. J. Aerospace Engineering, 8846177.

The paper's second case, radial clearance without axial clearance, is ``case2-planar``; the model's README
gives the reason.
"""

from __future__ import annotations

from functools import partial

from antenna_pin.show.plot.papers import _findings
from antenna_pin.show.plot.papers._figure import PaperFigure

_JOINT = "elevation"
_FIRST = ("case1", "case2-planar", "case3")
_PLAY = ("case2-planar", "case3")
_GROWING = ("case3", "case4", "case5")
_AXIAL = ("case1", "case2-planar", "case3", "case4", "case5")


FIGURES = (
    PaperFigure(
        name="figure07-angle",
        cases=_FIRST,
        shows="Angle of the antenna, whole and zoomed: clearance makes it deviate from the ideal joint, "
        "axial clearance more so.",
        figure="motion_angle",
        joint=_JOINT,
        finding=partial(_findings.deviations, of=f"{_JOINT} angle"),
        agrees=partial(_findings.rising_deviations, of=f"{_JOINT} angle", cases=_PLAY),
    ),
    PaperFigure(
        name="figure08-rate",
        cases=_FIRST,
        shows="Its rate, whole and zoomed: shaky with clearance, and further from the ideal joint with axial "
        "clearance.",
        figure="motion_rate",
        joint=_JOINT,
        finding=partial(_findings.deviations, of=f"{_JOINT} rate"),
        agrees=partial(_findings.rising_deviations, of=f"{_JOINT} rate", cases=_PLAY),
    ),
    PaperFigure(
        name="figure09-acceleration",
        cases=_FIRST,
        shows="Its acceleration, whole and zoomed: peaks that rise sharply with axial clearance.",
        figure="motion_acceleration",
        joint=_JOINT,
        finding=partial(_findings.peak_accelerations, joint=_JOINT),
        agrees=partial(_findings.rising_accelerations, joint=_JOINT, cases=_PLAY),
    ),
    PaperFigure(
        name="figure10-contact-forces",
        cases=("case2-planar", "case3"),
        shows="Contact forces in the joint: impulses of high frequency with high peaks; with axial clearance "
        "much higher ones along the axis.",
        figure="contact_forces",
        joint=_JOINT,
        finding=_findings.contact_peaks,
        agrees=partial(_findings.higher_axial_peaks, case="case3", than="case2-planar"),
    ),
    PaperFigure(
        name="figure11-angle-axial-clearance",
        cases=_AXIAL,
        shows="Angle of the antenna for axial clearances of 0, 0.2, 0.3 and 0.4 mm, whole and zoomed.",
        figure="angle_between_runs",
        options={"base": "case3"},
        joint=_JOINT,
        finding=partial(_findings.deviations, of=f"{_JOINT} angle"),
        agrees=partial(_findings.rising_deviations, of=f"{_JOINT} angle", cases=_GROWING),
    ),
    PaperFigure(
        name="figure12-rate-axial-clearance",
        cases=_AXIAL,
        shows="Its rate for the same, whole and zoomed: the larger the axial clearance, the shakier.",
        figure="rate_between_runs",
        options={"base": "case3"},
        joint=_JOINT,
        finding=partial(_findings.deviations, of=f"{_JOINT} rate"),
        agrees=partial(_findings.rising_deviations, of=f"{_JOINT} rate", cases=_GROWING),
    ),
    PaperFigure(
        name="figure13-acceleration-axial-clearance",
        cases=_AXIAL,
        shows="Its acceleration for the same, (a) to (d): the larger the axial clearance, the higher the "
        "peaks.",
        figure="motion_acceleration",
        joint=_JOINT,
        finding=partial(_findings.peak_accelerations, joint=_JOINT),
        agrees=partial(_findings.rising_accelerations, joint=_JOINT, cases=_GROWING),
    ),
)
