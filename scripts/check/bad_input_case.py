"""What a bad input is: files, what is done with them, and what must be said of it."""

from __future__ import annotations

import contextlib
import io
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from antenna_pin import AntennaPinError
from antenna_pin.cli import app

__all__ = ["LINE", "MECHANISM", "SCENARIO", "Case", "changed", "problem_of"]

#: Most letters that a refusal may have.
LINE = 1200

REFUSED = 2

MECHANISM = """<?xml version="1.0"?>
<robot name="pair">
  <link name="stand">
    <inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="hinge" type="revolute">
    <parent link="stand"/>
    <child link="bar"/>
    <origin xyz="0 0 0" rpy="0 0 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <link name="bar">
    <inertial>
      <origin xyz="0 0 -0.2"/>
      <mass value="2"/>
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


@dataclass(frozen=True)
class Case:
    """One bad input.

    Attributes:
        room: Of which kind it is: ``urdf``, ``toml``, ``units``, ``options``, ``results``, ``python``.
        name: What is wrong.
        says: A part of the line that must be said.
        act: Arguments of the command, or what is called in Python, with the folder as the current one.
        files: Contents by name, or what writes them, in an empty folder.
    """

    room: str
    name: str
    says: str
    act: Sequence[str] | Callable[[], Any]
    files: Mapping[str, str | bytes | Callable[[Path], Any]] = field(default_factory=dict)


def changed(text: str, old: str, new: str) -> str:
    """Return a text with its first ``old`` replaced, which must be there."""
    if old not in text:
        raise ValueError(f"{old!r} is not in the text to be changed")
    return text.replace(old, new, 1)


def problem_of(case: Case, folder: Path) -> str | None:
    """Return how a case is not refused as it must be; None if it is.

    Args:
        case: What to try.
        folder: An empty one, to work in.
    """
    for name, content in case.files.items():
        path = folder / name
        if callable(content):
            content(path)
        else:
            path.write_bytes(content.encode() if isinstance(content, str) else content)
    before = os.getcwd()
    os.chdir(folder)
    try:
        return _refused_call(case) if callable(case.act) else _refused_command(case, case.act)
    except BaseException as error:
        return f"{type(error).__name__}: {error}"
    finally:
        os.chdir(before)


def _refused_command(case: Case, arguments: Sequence[str]) -> str | None:
    out, err = io.StringIO(), io.StringIO()
    code: Any = 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            app(list(arguments), prog_name="antenna-pin")
        except SystemExit as ended:
            code = ended.code
    said = err.getvalue()
    if code != REFUSED:
        return f"exit code {code}, said {(said or out.getvalue())[-300:]!r}"
    return _fault_of_lines(case, said.removesuffix("\n"))


def _refused_call(case: Case) -> str | None:
    assert callable(case.act)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            got = case.act()
    except AntennaPinError as error:
        return _fault_of_lines(case, str(error))
    return f"returned {type(got).__name__}"


def _fault_of_lines(case: Case, said: str) -> str | None:
    if len(said.splitlines()) != 1 or not said.isprintable():
        return f"not one plain line: {said[:300]!r}"
    if len(said) > LINE:
        return f"a line of {len(said)} letters: {said[:200]!r}"
    if case.says not in said:
        return f"does not say {case.says!r}: {said[:300]!r}"
    return None
