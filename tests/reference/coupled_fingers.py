"""Two fingers of which one mimics the other, and a rack that a scenario couples to them."""

from pathlib import Path

_LINK = (
    '<link name="{0}"><visual><geometry><box size="0.1 0.02 0.02"/></geometry></visual>'
    '<inertial><origin xyz="0 0 -0.05"/><mass value="0.2"/>'
    '<inertia ixx="4e-4" iyy="4e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
_JOINT = (
    '<joint name="{0}" type="{1}"><parent link="palm"/><child link="{0}_tip"/><origin xyz="{2} 0 0"/>'
    '<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/>{3}</joint>'
)
_SCENARIO = """
title = "Two fingers on a rack"
duration = "0.1 s"
[mechanism]
urdf = "fingers.urdf"
base = "fixed"
gravity = [0, 0, -9.81]
[couplings.rack]
leader = "thumb"
multiplier = "10 mm/rad"
[initial.joints.thumb]
position = "60 deg"
"""


def write_coupled_fingers(folder: Path) -> Path:
    """Write URDF and scenario into a folder, made if missing; return the scenario's path."""
    folder.mkdir(exist_ok=True)
    mimic = '<mimic joint="thumb" multiplier="-1" offset="0.1"/>'
    joints = (
        ("thumb", "revolute", 0, ""),
        ("finger", "revolute", 0.1, mimic),
        ("rack", "prismatic", 0.2, ""),
    )
    parts = [_LINK.format("palm")]
    parts += [_JOINT.format(*row) + _LINK.format(f"{row[0]}_tip") for row in joints]
    (folder / "fingers.urdf").write_text(f'<robot name="fingers">{"".join(parts)}</robot>')
    path = folder / "fingers.toml"
    path.write_text(_SCENARIO)
    return path
