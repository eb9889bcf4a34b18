"""Torque-angle loops against closed forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from antenna_pin import AntennaPinError, System, load_scenario
from antenna_pin.dynamics import JointSpring
from antenna_pin.elements import BoucWen, StickingFriction
from antenna_pin.studies.statics import torque_angle_loop


def test_area_of_a_bouc_wen_loop(bar: Callable[..., Any]):
    """After D z_0 of linear unloading z goes to 1 by exponentials: the loop's area is their integral."""
    alpha, k, d = 0.1, 2.0, 0.05
    spring = BoucWen(joint="hinge", alpha=alpha, stiffness=k, yield_angle=d)
    found = torque_angle_loop(System(bar(), springs={"wen": spring}), "hinge", 0.29)
    loaded = 0.5 * (found.angle[found.cycle == 1].max() - found.angle[found.cycle == 1].min())
    top = 1.0 - np.exp(-(2.0 * loaded - d) / d)  # of z, from which it comes down by d z_0 to zero
    yielding = 2.0 * loaded - d * top
    area = 2.0 * (1.0 - alpha) * k * d * (yielding - d * top - 0.5 * d * top**2)
    assert top == pytest.approx(1.0, abs=1e-9)  # so that the first loading is forgotten
    # Lobatto's rule with five points over steps of an eighth of the amplitude.
    assert found.area == pytest.approx(area, rel=1e-8)
    # Both branches pass zero torque once.
    angle = found.angle[found.cycle == 1]
    torque = found.torque[found.cycle == 1]
    assert np.abs(torque).max() == pytest.approx(0.29, rel=1e-12)
    assert found.hysteresis == pytest.approx(np.ptp(angle[np.abs(torque) < 1e-12]), rel=1e-9)


def test_dry_friction_beside_a_spring(bar: Callable[..., Any]):
    """A parallelogram: width 2 T / k, area 4 T (A - T) / k, and the lost motion of twice the friction."""
    k, t, amplitude = 3.0, 0.02, 0.12
    system = System(
        bar(),
        springs={"k": JointSpring(joint="hinge", stiffness=k)},
        elements={"frictions": {"dry": StickingFriction(joint="hinge", coulomb=t)}},
    )
    found = torque_angle_loop(system, "hinge", amplitude)
    # A torque is located to 1e-13 of the amplitude.
    assert found.stiffness == pytest.approx(k, rel=1e-11)
    assert found.friction == pytest.approx(t, rel=1e-9)
    assert found.hysteresis == pytest.approx(2.0 * t / k, rel=1e-10)
    assert found.area == pytest.approx(4.0 * t * (amplitude - t) / k, rel=1e-10)
    assert found.small_torque == pytest.approx(2.0 * t, rel=1e-9)
    assert found.lost_motion == pytest.approx(2.0 * t / k, rel=1e-9)
    assert found.dead_band == 0.0
    with pytest.raises(AntennaPinError, match="amplitude must be above the friction of joint 'hinge'"):
        torque_angle_loop(system, "hinge", 0.5 * t)


def test_gear_with_play():
    """The dish behind a gear of 1 mrad play, its motor held: all of it is lost motion and dead band."""
    found = torque_angle_loop(load_scenario("pointing_gear"), "dish", 0.1, hold=["motor"])
    assert found.stiffness == pytest.approx(1000.0, rel=1e-9)
    for measure in (found.lost_motion, found.hysteresis, found.dead_band):
        assert measure == pytest.approx(1e-3, rel=1e-9)
    assert found.area == pytest.approx(0.0, abs=1e-15)
    with pytest.raises(AntennaPinError, match="one that something resists: joint 'dish' moves on"):
        torque_angle_loop(
            load_scenario("pointing_gear", overrides={"drives.controller.on": False}), "dish", 0.1
        )
