"""A mechanism that nothing about is convenient, and the shipped antenna."""

from pathlib import Path

import pytest

from antenna_pin.mechanism import Urdf

# Turned frames everywhere, oblique axes not of unit length, products of inertia, inertial frames with
# their own rpy, two branches, a frame without inertial and a tip welded on. Numbers read in wrong axes show.
CROOKED = """<?xml version="1.0"?>
<robot name="crooked">
  <!-- the hull -->
  <link name="hull">
    <inertial>
      <origin xyz="0.1 -0.2 0.05" rpy="0.3 -0.4 0.5"/>
      <mass value="50"/> <!-- weighed -->
      <inertia ixx="5" iyy="6" izz="7" ixy="0.1" ixz="-0.2" iyz="0.3"/>
    </inertial>
  </link>
  <joint name="swivel" type="continuous">
    <parent link="hull"/>
    <child link="arm"/>
    <origin xyz="0.2 0.3 0.4" rpy="0.5 -1.2 2.0"/>
    <axis xyz="1 2 -2"/> <!-- drawn -->
  </joint>
  <link name="arm">
    <inertial>
      <origin xyz="0 0.3 0.1" rpy="1 0.2 0"/>
      <mass value="3"/>
      <inertia ixx="0.2" iyy="0.05" izz="0.21" ixy="0.01" ixz="0" iyz="-0.02"/>
    </inertial>
    <visual name="rod">
      <geometry><cylinder radius="0.02" length="0.6"/></geometry>
    </visual>
    <collision name="rod">
      <geometry><cylinder radius="0.02" length="0.6"/></geometry>
    </collision>
    <visual name="case">
      <geometry><box size="0.1 0.2 0.3"/></geometry>
    </visual>
  </link>
  <joint name="wrist" type="revolute">
    <parent link="arm"/>
    <child link="hand"/>
    <origin xyz="0 0.6 0" rpy="-0.7 1.1 0.4"/>
    <axis xyz="-0.3 0.1 -0.9"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/>
  </joint>
  <link name="hand">
    <inertial>
      <origin xyz="0.05 0.1 0"/>
      <mass value="1.5"/>
      <inertia ixx="0.03" iyy="0.02" izz="0.04" ixy="0" ixz="0" iyz="0.001"/>
    </inertial>
  </link>
  <joint name="weld" type="fixed">
    <parent link="hand"/>
    <child link="tip"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.1 0.2 0.3"/>
  </joint>
  <link name="tip">
    <inertial>
      <origin xyz="0 0 0.02" rpy="0 0 0.4"/>
      <mass value="0.4"/>
      <inertia ixx="0.004" iyy="0.005" izz="0.002" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <joint name="camera_mount" type="fixed">
    <parent link="tip"/>
    <child link="camera"/>
    <origin xyz="0 0 0.1" rpy="0 1.5707963267948966 0"/>
  </joint>
  <link name="camera"/>
  <joint name="slide" type="prismatic">
    <parent link="hull"/>
    <child link="weight"/>
    <origin xyz="-0.3 0 0" rpy="0 0.8 0"/>
    <axis xyz="0 1 1"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/>
  </joint>
  <link name="weight">
    <inertial>
      <mass value="2"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <gazebo reference="hull"><kept_for_other_tools/></gazebo>
</robot>
"""


@pytest.fixture
def crooked_text() -> str:
    return CROOKED


@pytest.fixture
def crooked() -> Urdf:
    return Urdf.from_text(CROOKED, "crooked.urdf")


@pytest.fixture
def antenna_path() -> Path:
    return Path(__file__).resolve().parents[2] / "models" / "bai2020" / "antenna.urdf"


@pytest.fixture
def antenna(antenna_path: Path) -> Urdf:
    return Urdf.load(antenna_path)
