"""A sled on a rail, pushed by forces whose way has a closed form, with requirements on it."""

import pytest

URDF = """<robot name="sled">
  <link name="rail"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="rail"/><child link="sled"/><axis xyz="1 0 0"/>
    <limit lower="-100" upper="100" effort="100" velocity="100"/></joint>
  <link name="sled"><inertial><mass value="2"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>
"""

SCENARIO = """format = 1
title = "Sled"
duration = "1 s"
[mechanism]
urdf = "sled.urdf"
base = "fixed"
[drives.push]
kind = "constant"
joint = "slide"
value = "4 N"
[drives.swing]
kind = "sine"
joint = "slide"
amplitude = "2 N"
frequency = "0.2 Hz"
[output]
rate = "200 Hz"
"""

REQUIREMENTS = """format = 1
title = "Sled goes far, but not too far"
scenario = "sled.toml"
[uncertain.push]
key = "drives.push.value"
between = ["3 N", "5 N"]
[uncertain.frequency]
key = "drives.swing.frequency"
between = ["0.05 Hz", "1.5 Hz"]
"""


@pytest.fixture
def sled(tmp_path):
    """Return a function that writes the requirements of a test beside the sled, and returns their file."""
    (tmp_path / "sled.urdf").write_text(URDF)
    (tmp_path / "sled.toml").write_text(SCENARIO)

    def written(text, head=REQUIREMENTS):
        path = tmp_path / "sled.requirements.toml"
        path.write_text(head + text)
        return path

    return written
