r"""Which contact scenarios a joint's shape allows: the 16 pairs of radial and axial contact.

At a given tilt :math:`\theta` of the journal the bore's gaps depend on the two coordinates of the journal's
axis across itself only, the flanges' gaps on the one coordinate along it only. So bore and flanges choose
their scenarios independently of each other but for the tilt, and a pair is possible where the tilts of its
two scenarios have a value in common. The tilts of each are intervals, whose ends are in closed form (but for
one):

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

from numpy.typing import ArrayLike

from antenna_pin.analysis.assembled import AssembledJoint, JournalPose
from antenna_pin.analysis.tilts import TiltRange, milliradians
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.geometry import AxialScenario, RadialScenario, RevoluteClearance, pose_of
from antenna_pin.geometry.revolute import revolute_scenario

__all__ = [
    "SCENARIO_COLUMNS",
    "JournalPose",
    "ScenarioPair",
    "TiltRange",
    "possible_scenarios",
    "scenario_of",
    "scenario_rows",
]

#: Headings of :func:`scenario_rows`.
SCENARIO_COLUMNS = ("radial", "axial", "tilt [mrad]", "pose: centre [um], tilt [mrad]", "why not")


@dataclass(frozen=True, slots=True, eq=False)
class ScenarioPair:
    """A pair of radial and axial contact, with a pose that shows it or the reason why there is none.

    Attributes:
        radial: Contact in the bore.
        axial: Contact at the flanges.
        tilts: Tilts at which the pair occurs; empty if it is not possible.
        pose: One pose that shows it; None if it is not possible.
        reason: Why it is not possible; empty if it is.
    """

    radial: RadialScenario
    axial: AxialScenario
    tilts: TiltRange
    pose: JournalPose | None
    reason: str

    @property
    def possible(self) -> bool:
        """Whether a pose shows it."""
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
    """Return all 16 pairs of contact scenarios, each with a pose or with the reason why there is none.

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
