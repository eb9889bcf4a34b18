r"""Contact scenarios of a revolute shape: the 16 pairs of radial and axial contact.

At a given tilt :math:`\theta` of the journal the bore's gaps depend on the two coordinates of the journal's
axis across itself only, the flanges' gaps on the one coordinate along it only. So bore and flanges choose
their scenarios independently of each other except for the tilt, and a pair is possible where the tilts of its
two scenarios have a value in common. The tilts of each are intervals, whose ends are in closed form (except
for one):

.. math::
    G(\theta) = R_i \cos\theta - \tfrac{L_i}{2} \sin\theta - R_j, \qquad
    A(\theta) = \tfrac{L_j}{2} - \tfrac{L_i}{2} \cos\theta - \rho \sin\theta

G is the gap at both ends of the bore with the journal centred: it bounds the mean of the two gaps in any
other place, since the distance to the rim of a convex section, the bore seen along the journal, is concave. A
is the gap at both flanges with the journal centred, :math:`A \pm u` if it is moved by u; rho is the radius of
the edge that counts, the smaller of bearing and flange, and where that is the flange's
:math:`A = \tfrac{L_j}{2} \cos\theta - \tfrac{L_i}{2} - \rho \sin\theta`. docs/theory/scenarios.md has the
derivation.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry import AxialScenario, RadialScenario, RevoluteClearance, pose_of
from antenna_pin.joints.geometry.revolute import revolute_scenario
from antenna_pin.joints.geometry.revolute_kernels import nearest_on_ellipse

# --- intervals of tilts -------------------------------------------------------------------------------------

#: A journal square to its bearing [rad].
UPRIGHT = 0.5 * math.pi


def milliradians(tilt: float) -> str:
    """Return a tilt [rad] as text in mrad, without the unit."""
    return f"{1e3 * tilt:.4g}"


@dataclass(frozen=True, slots=True)
class TiltRange:
    """An interval of tilts between the axes of journal and bearing."""

    low: float  # [rad]
    high: float  # [rad]
    open_low: bool = False  # whether ``low`` itself is left out
    open_high: bool = False  # whether ``high`` itself is left out

    @property
    def empty(self) -> bool:
        """True if the interval contains no tilt."""
        return self.low > self.high or (self.low == self.high and (self.open_low or self.open_high))

    def intersection(self, other: TiltRange) -> TiltRange:
        """Return the tilts that both hold."""
        low, high = max(self.low, other.low), min(self.high, other.high)
        sides = (self, other)
        return TiltRange(
            low,
            high,
            any(side.low == low and side.open_low for side in sides),
            any(side.high == high and side.open_high for side in sides),
        )

    @property
    def typical(self) -> float:
        """Lower end if it belongs to the interval, else the middle [rad]."""
        return 0.5 * (self.low + self.high) if self.open_low else self.low

    def __str__(self) -> str:
        """Return the interval in mrad."""
        if self.empty:
            return "none"
        if self.low == self.high:
            return milliradians(self.low)
        ends = "(" if self.open_low else "[", ")" if self.open_high else "]"
        high = "90 deg" if self.high == UPRIGHT else milliradians(self.high)
        return f"{ends[0]}{milliradians(self.low)}, {high}{ends[1]}"


# --- poses --------------------------------------------------------------------------------------------------

_RADIAL_WORDS = {
    RadialScenario.NONE: "a bore without contact",
    RadialScenario.ONE_POINT: "one point in the bore",
    RadialScenario.TWO_POINTS: "two points in the bore",
    RadialScenario.LINE: "a line in the bore",
}
_AXIAL_WORDS = {
    AxialScenario.NONE: "flanges without contact",
    AxialScenario.ONE_POINT: "one point at a flange",
    AxialScenario.TWO_POINTS: "a point at each flange",
    AxialScenario.SURFACE: "the whole face of a flange",
}


class JournalPose(NamedTuple):
    """Pose of a journal in its bearing."""

    p_HJ: NDArray[np.float64]  # journal centre from the bearing centre, bearing axes, (3,) [m]
    axis_J_H: NDArray[np.float64]  # direction of the journal's axis in bearing axes, (3,)


class AssembledJoint:
    """Tilts and poses of a shape at a largest penetration.

    Poses lean by the tilt towards x: the journal's axis is z_J = (sin, 0, cos). Across it, b = (cos, 0, -sin)
    lies in the plane of the tilt and y square to it. The bore seen along z_J is an ellipse with the semi-axes
    R_i along y and R_i cos(tilt) along b, and its ends' centres are (L_i / 2) sin(tilt) apart from its
    middle's, along b.
    """

    def __init__(self, shape: RevoluteClearance, penetration: float) -> None:
        """Take a shape and the largest depth at any contact [m], 0 for rigid parts."""
        self.shape = shape
        self.depth = penetration
        self.half = 0.5 * shape.bearing_length
        self.reach = 0.5 * shape.flange_distance
        self.covers = shape.flange_radius >= shape.bearing_outer_radius
        self.edge = min(shape.bearing_outer_radius, shape.flange_radius)

    # --- tilts ----------------------------------------------------------------------------------------------

    def bore_tilt(self, depth: float) -> float:
        """Return the tilt of the centred journal at G = -depth [rad].

        With t the tangent of half the tilt, (2 R_i - x) t^2 + L_i t - x = 0, x = C_r + depth.
        """
        x = self.shape.radial_clearance + depth
        t = x / (self.half + math.sqrt(self.half**2 + (2.0 * self.shape.bearing_radius - x) * x))
        return 2.0 * math.atan(t)

    def flange_tilt(self, depth: float) -> float:
        """Return the least tilt of the centred journal at A = -depth [rad].

        With t the tangent of half the tilt and x = C_a + depth, (L_i + x) t^2 - 2 rho t + x = 0 where the
        flanges cover the bearing, else ((L_j + L_i) / 2 - depth) t^2 + 2 rho t - x = 0. Infinite where no
        tilt does.
        """
        x = self.shape.axial_clearance + depth
        if self.covers:
            square = self.edge**2 - (2.0 * self.half + x) * x
        else:
            square = self.edge**2 + (self.reach + self.half - depth) * x
        if square < 0.0:
            return math.inf
        return 2.0 * math.atan(x / (self.edge + math.sqrt(square)))

    def line_tilt(self) -> float:
        """Return the largest tilt of a line contact within the depth [rad].

        The journal stands askew: aside along y, so that its axis crosses the bearing's at a distance. With a
        circle for the ellipse, ((L_i / 2) sin(tilt))^2 = 2 C_r depth + depth^2.
        """
        if self.depth == 0.0:
            return 0.0

        def spare(tilt: float) -> float:
            aside = self.aside(tilt, 0.0, 0.0)
            return self.bore_gap(tilt, aside, self.half * math.sin(tilt)) + self.depth

        high = self.bore_tilt(self.depth)
        if spare(high) > 0.0:
            return high
        return float(scipy.optimize.brentq(spare, 0.0, high, xtol=1e-15, rtol=1e-14))

    def radial_tilts(self) -> dict[RadialScenario, TiltRange]:
        """Return the tilts of each scenario of the bore."""
        free = self.bore_tilt(0.0)
        # One end pressed, the other free: the mean of both gaps is above -depth/2.
        return {
            RadialScenario.NONE: TiltRange(0.0, free, open_high=True),
            RadialScenario.ONE_POINT: TiltRange(0.0, self.bore_tilt(0.5 * self.depth), True, True),
            RadialScenario.TWO_POINTS: TiltRange(0.0, self.bore_tilt(self.depth), open_low=True),
            RadialScenario.LINE: TiltRange(0.0, self.line_tilt(), open_high=self.depth > 0.0),
        }

    def axial_tilts(self) -> dict[AxialScenario, TiltRange]:
        """Return the tilts of each scenario of the flanges."""
        both = self.flange_tilt(0.0)
        free = min(both, UPRIGHT)
        one = min(self.flange_tilt(0.5 * self.depth), UPRIGHT)
        if not self.covers:
            # Where the other flange leaves, this one is pressed whole: L_j cos(tilt) = L_i.
            one = min(one, math.acos(min(1.0, self.half / self.reach)))
        if math.isinf(both):
            two = TiltRange(math.inf, 0.0)
        elif self.depth == 0.0:
            two = TiltRange(both, both, open_low=both == 0.0)
        else:
            most = math.atan2(self.edge, self.half) if self.covers else UPRIGHT
            two = TiltRange(both, min(self.flange_tilt(self.depth), most), open_low=True)
        return {
            AxialScenario.NONE: TiltRange(0.0, free, open_high=True),
            AxialScenario.ONE_POINT: TiltRange(0.0, one, True, True),
            AxialScenario.TWO_POINTS: two,
            AxialScenario.SURFACE: TiltRange(0.0, math.asin(min(1.0, 0.5 * self.depth / self.edge))),
        }

    def reason(
        self, radial: RadialScenario, turned: TiltRange, axial: AxialScenario, leaned: TiltRange
    ) -> str:
        """Return the reason against a pair of scenarios."""
        if leaned.empty:
            if axial is AxialScenario.TWO_POINTS and self.shape.axial_clearance > 0.0:
                return "the flanges are too far apart to touch both at any tilt"
            if axial is AxialScenario.NONE:
                return "without axial play the flanges always touch"
            if self.depth > 0.0:
                return "without axial play a tilt presses both flanges"
            return "without axial play the axes are parallel, and the whole faces touch"
        return (
            f"tilts of {turned} mrad for {_RADIAL_WORDS[radial]}, of {leaned} mrad for {_AXIAL_WORDS[axial]}"
        )

    # --- poses ----------------------------------------------------------------------------------------------

    def bore_gap(self, tilt: float, aside: float, along: float) -> float:
        """Return the gap of a bearing's circle at (aside, along) from the journal's axis."""
        major = self.shape.bearing_radius
        minor = major * math.cos(tilt)
        x, y = nearest_on_ellipse(major, minor, aside, along)
        distance = math.hypot(x - aside, y - along)
        inside = (aside / major) ** 2 + (along / minor) ** 2 <= 1.0
        return (distance if inside else -distance) - self.shape.journal_radius

    def aside(self, tilt: float, along: float, depth: float) -> float:
        """Return the shift along y at a depth of the displaced circle [m]."""
        if self.bore_gap(tilt, 0.0, along) <= -depth:
            return 0.0
        # The gap falls from the middle to -R_j on the rim, which is nowhere farther off than R_i.
        rim = self.shape.bearing_radius
        return float(
            scipy.optimize.brentq(
                lambda x: self.bore_gap(tilt, x, along) + depth, 0.0, rim, xtol=1e-18, rtol=1e-15
            )
        )

    def across(self, tilt: float, radial: RadialScenario) -> tuple[float, float]:
        """Return the shift of the journal along y and b in a bore scenario [m]."""
        apart = self.half * math.sin(tilt)
        centred = self.shape.bearing_radius * math.cos(tilt) - apart - self.shape.journal_radius  # G
        if radial is RadialScenario.NONE:
            return 0.0, 0.0
        if radial is RadialScenario.ONE_POINT:
            depth = 0.5 * (max(0.0, -2.0 * centred) + min(self.depth, 2.0 * apart))
            return 0.0, centred + depth
        if radial is RadialScenario.TWO_POINTS:
            touching = self.aside(tilt, apart, 0.0)
            spare = self.bore_gap(tilt, touching, 0.0)
            return self.aside(tilt, apart, 0.5 * min(self.depth, spare)) if touching else 0.0, 0.0
        if self.depth == 0.0:
            return self.shape.radial_clearance, 0.0
        return 0.5 * (self.aside(tilt, 0.0, 0.0) + self.aside(tilt, apart, self.depth)), 0.0

    def flange_gap(self, tilt: float) -> float:
        """Gap at both flanges of the centred journal, A [m]."""
        outer, inner = (self.reach, self.half) if self.covers else (-self.half, -self.reach)
        return outer - inner * math.cos(tilt) - self.edge * math.sin(tilt)

    def along(self, tilt: float, axial: AxialScenario) -> float:
        """Return the shift u of the journal for flange gaps A +- u [m]."""
        gap = self.flange_gap(tilt)
        if axial in (AxialScenario.NONE, AxialScenario.TWO_POINTS):
            return 0.0
        whole = 2.0 * self.edge * math.sin(tilt)
        if axial is AxialScenario.SURFACE:
            return gap + 0.5 * (whole + self.depth)
        return gap + 0.5 * (max(0.0, -2.0 * gap) + min(self.depth, whole))

    def pose(self, tilt: float, radial: RadialScenario, axial: AxialScenario) -> JournalPose:
        """Return a pose of a pair at a common tilt."""
        aside, lean = self.across(tilt, radial)
        u = self.along(tilt, axial)
        sine, cosine = math.sin(tilt), math.cos(tilt)
        # Covering flanges measure u along the journal, small ones along the bearing.
        slide = u if self.covers else (u + lean * sine) / cosine
        centre = [lean * cosine + slide * sine, aside, slide * cosine - lean * sine]
        return JournalPose(np.array(centre), np.array([sine, 0.0, cosine]))


# --- scenarios that a shape allows --------------------------------------------------------------------------

#: Headings of :func:`scenario_rows`.
SCENARIO_COLUMNS = ("radial", "axial", "tilt [mrad]", "pose: centre [um], tilt [mrad]", "why not")


@dataclass(frozen=True, slots=True, eq=False)
class ScenarioPair:
    """Pair of radial and axial contact, with a pose or the reason against it."""

    radial: RadialScenario  # contact in the bore
    axial: AxialScenario  # contact at the flanges
    tilts: TiltRange  # tilts at which the pair occurs; empty if it is not possible
    pose: JournalPose | None  # one pose that shows it; None if it is not possible
    reason: str  # why it is not possible; empty if it is

    @property
    def possible(self) -> bool:
        """True if there is a pose."""
        return self.pose is not None


@takes()
def scenario_of(
    shape: RevoluteClearance, p_HJ: ArrayLike, axis_J_H: ArrayLike, tolerance: float = 0.0
) -> tuple[RadialScenario, AxialScenario]:
    """Return the contact scenario of a pose, a gap below ``tolerance`` counting as contact.

    With a tolerance of zero it is :meth:`RevoluteClearance.scenario`, which counts penetrations. Rigid parts
    do not penetrate: their contacts are gaps of zero to within a tolerance, and their scenario is that of a
    journal grown by it on all sides.

    Args:
        shape: The joint.
        p_HJ: Journal centre from the bearing centre, bearing axes, (3,) [m].
        axis_J_H: Direction of the journal's axis in bearing axes, (3,).
        tolerance: [m].
    """
    grown = shape.dimensions()
    grown["journal_radius"] += tolerance
    grown["half_distance"] -= tolerance
    radial, axial = revolute_scenario(grown, pose_of(p_HJ, axis_J_H))
    return RadialScenario(radial), AxialScenario(axial)


@takes()
def possible_scenarios(shape: RevoluteClearance, penetration: float = 0.0) -> tuple[ScenarioPair, ...]:
    """Return all 16 pairs of contact scenarios, each with a pose or a reason.

    Contact is a gap of zero between rigid parts, a gap from ``-penetration`` to zero between parts that may
    penetrate; no gap may be less. Poses are those of an assembled joint: its tilts run from zero to where the
    bore or the flanges stop it.

    Args:
        shape: The joint.
        penetration: Largest depth at any contact [m]; 0 for rigid parts.

    Returns:
        The pairs, radial scenarios first, in the order of their values.
    """
    if not 0.0 <= penetration < min(shape.journal_radius, 0.5 * shape.bearing_length):
        raise InvalidParameterError(
            "possible_scenarios", "penetration", "from 0 to below the journal's radius [m]", penetration
        )
    joint = AssembledJoint(shape, penetration)
    radial_tilts, axial_tilts = joint.radial_tilts(), joint.axial_tilts()
    pairs = []
    for radial in RadialScenario:
        for axial in AxialScenario:
            tilts = radial_tilts[radial].intersection(axial_tilts[axial])
            if tilts.empty:
                reason = joint.reason(radial, radial_tilts[radial], axial, axial_tilts[axial])
                pairs.append(ScenarioPair(radial, axial, tilts, None, reason))
            else:
                pose = joint.pose(tilts.typical, radial, axial)
                pairs.append(ScenarioPair(radial, axial, tilts, pose, ""))
    return tuple(pairs)


@takes()
def scenario_rows(pairs: Iterable[ScenarioPair]) -> list[tuple[str, ...]]:
    """Return pairs as rows of text under :data:`SCENARIO_COLUMNS`."""
    rows: list[tuple[str, ...]] = []
    for pair in pairs:
        shown = ""
        if pair.pose is not None:
            p_HJ, axis = pair.pose
            place = ", ".join(f"{1e6 * x:.5g}" for x in p_HJ + 0.0)
            shown = f"({place}), {milliradians(math.atan2(math.hypot(axis[0], axis[1]), axis[2]))}"
        names = (pair.radial.name.lower().replace("_", " "), pair.axial.name.lower().replace("_", " "))
        rows.append((*names, str(pair.tilts) if pair.possible else "-", shown or "-", pair.reason or "-"))
    return rows
