"""Rigs: small mechanisms whose motion is known in closed form, and the antenna in few words."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from antenna_pin import ErrorScales, RunSettings, System, Urdf, build_mechanism
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import PlanarClearance
from antenna_pin.run.simulation import checkpoint, loop, steps

# Scales beside which any step's error is small: steps are as long as they are asked to be.
ANY_ERROR = ErrorScales(
    **dict.fromkeys(
        ("position", "angle", "velocity", "angular_velocity", "clearance", "clearance_velocity"), 1e12
    )
)

IMPACT_URDF = """
<robot name="impact">
  <link name="ground"/>
  <link name="body">
    <inertial><origin xyz="0 0 0"/><mass value="{mass}"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="hole" type="continuous">
    <parent link="ground"/><child link="body"/><axis xyz="0 0 1"/>
  </joint>
</robot>
"""


@pytest.fixture
def impact_rig() -> Callable[..., System]:
    """A disc of mass m in a fixed round hole: along a diameter a ball between two walls."""

    def build(law: Any, mass: float = 2.0, play: float = 1e-3, **joint: Any) -> System:
        urdf = Urdf.from_text(IMPACT_URDF.format(mass=mass), "impact.urdf").variant(joints={"hole": "planar"})
        mechanism = build_mechanism(urdf, base="fixed")
        clearance = ClearanceJoint(
            name="hole",
            geometry=PlanarClearance(bearing_radius=0.01, journal_radius=0.01 - play),
            radial=law,
            **{"backend": "closed-form", "maximum_depth": 1e-2, **joint},
        )
        return System(mechanism, clearances=[clearance])

    return build


@pytest.fixture
def fixed_steps() -> Callable[..., RunSettings]:
    """Settings that make any method walk with equal steps (but for those that end at events)."""

    def build(method: str, step: float) -> RunSettings:
        return RunSettings(
            method=method,
            rtol=0.5,
            scales=ANY_ERROR,
            step=step,
            first_step=step,
            max_step=step,
            output_rate=10.0,
        )

    return build


@pytest.fixture
def small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a record go to the disk every few samples, and a run be looked at every few steps."""
    make_small(monkeypatch)


def make_small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Patch the parts of a record to be small; the caller says until when."""
    monkeypatch.setattr(checkpoint, "_PART", 40_000)
    monkeypatch.setattr(steps, "_BUDGET", 2)
    monkeypatch.setattr(loop, "_INTERVAL", -1.0)
