"""The hinge of the antenna of Bai and Zhao (2020), which many tests put their load on."""

from antenna_pin.joints.geometry import RevoluteClearance

DIMENSIONS = dict(
    bearing_radius=0.010,
    radial_clearance=0.0002,
    bearing_length=0.050,
    axial_clearance=0.0002,
    bearing_outer_radius=0.012,
    flange_radius=0.014,
)


def antenna_hinge(**changes):
    """Return its shape [m], with changes."""
    return RevoluteClearance.from_clearances(**(DIMENSIONS | changes))
