"""A wheel on an axle in the ground, or a sled on a rail: one freedom, whose motions have closed forms."""

from __future__ import annotations

from antenna_pin import Urdf

#: Moment of inertia of the wheel about its axle [kg m^2].
INERTIA = 0.5

_TEXT = """<robot name="wheel">
  <link name="ground"/>
  <link name="wheel"><inertial><mass value="{mass}"/>
    <inertia ixx="{across}" iyy="{across}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="{joint}" type="{kind}"><parent link="ground"/><child link="wheel"/><axis xyz="0 0 1"/>
    {limit}</joint>
</robot>
"""


def wheel_text(
    kind: str = "continuous", mass: float = 1.0, inertia: float = INERTIA, joint: str = "axle"
) -> str:
    """Return its URDF.

    Args:
        kind: Of the joint; one that has limits has them far away.
        mass: Of the wheel [kg].
        inertia: Of the wheel about its axle [kg m^2].
        joint: Its name.
    """
    limit = "" if kind == "continuous" else '<limit lower="-99" upper="99" effort="9" velocity="9"/>'
    across = 0.6 * inertia
    return _TEXT.format(kind=kind, mass=mass, across=across, inertia=inertia, joint=joint, limit=limit)


def wheel_urdf(
    kind: str = "continuous", mass: float = 1.0, inertia: float = INERTIA, joint: str = "axle"
) -> Urdf:
    """Return its URDF, read; see :func:`wheel_text`."""
    return Urdf.from_text(wheel_text(kind, mass, inertia, joint), "wheel.urdf")
