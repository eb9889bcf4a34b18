"""One bad input, and a sound mechanism and scenario to make bad ones of."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from robust.inputs import Change, Draft, Input
from robust.trials import Content

MECHANISM = """<?xml version="1.0"?>
<robot name="pair">
  <link name="stand">
    <inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="hinge" type="revolute">
    <parent link="stand"/><child link="bar"/><origin xyz="0 0 0" rpy="0 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <link name="bar">
    <inertial>
      <origin xyz="0 0 -0.2"/><mass value="2"/>
      <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual>
      <geometry><box size="0.1 0.1 0.4"/></geometry>
      <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
    </visual>
  </link>
</robot>
"""

SCENARIO = """format = 1
title = "A bar on a hinge with play"
duration = "1 ms"
default_case = "play"
[mechanism]
urdf = "pair.urdf"
[clearance.hinge]
model = "contact"
bearing_radius = "10 mm"
radial_clearance = "0.1 mm"
bearing_length = "50 mm"
axial_clearance = "0.1 mm"
bearing_outer_radius = "12 mm"
flange_radius = "14 mm"
journal_material = "steel"
bearing_material = "steel"
normal = { law = "lankarani-nikravesh", restitution = 0.8 }
friction = { law = "tanh", coefficient_of_friction = 0.1, transition_speed = "1 mm/s" }
[springs.hinge]
stiffness = "0.5 N*m/rad"
damping = "0.02 N*m*s/rad"
[drives.motor]
joint = "hinge"
kind = "table"
time = [0, 1, 2]
torque = [0, 1, 0]
[integrator]
rtol = 1e-8
[output]
rate = "1 kHz"
[cases.play]
description = "with play"
"""

#: Both, by the names of their files.
FILES: Mapping[str, Content] = {"pair.urdf": MECHANISM, "scenario.toml": SCENARIO}


@dataclass(frozen=True)
class Case:
    """One bad input."""

    room: str  # kind: ``urdf``, ``toml``, ``units``, ``options``, ``results``, ``python``
    name: str  # description
    says: str  # part of the line that must be said
    # Arguments of the command, or a call in Python, in the folder of the files.
    act: Sequence[str] | Callable[[], Any]
    files: Mapping[str, Content]  # contents by name, or functions that write them, in an empty folder

    @property
    def draft(self) -> Draft:
        """The input as a change that must be refused."""
        change = Change(self.name, lambda given: None, True, (self.says,) if self.says else ())
        return Draft((change,), lambda kept: Input(self.files, self.act, strict=True))


def changed(text: str, old: str, new: str) -> str:
    """Return a text with its first ``old`` replaced, which must be there."""
    if old not in text:
        raise ValueError(f"{old!r} is not in the text to be changed")
    return text.replace(old, new, 1)
