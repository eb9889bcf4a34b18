"""Friction laws of the slip speed: they oppose slip, keep to their limits and are as smooth as they say."""

import math
import re

import numpy as np
import pytest
from numba import njit

from antenna_pin.contact import (
    Ambrosio,
    BengisuAkay,
    BrownMcPhee,
    Coulomb,
    CustomFriction,
    FrictionLaw,
    Hertz,
    LinearFriction,
    NoFriction,
    Stribeck,
    Tanh,
    Threlfall,
    VelocityBased,
    kernels,
)
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import PlanarClearance

SPEEDS = np.concatenate([[0.0], np.geomspace(1e-9, 1e2, 200)])
BAI_ZHAO = VelocityBased(static=0.15, dynamic=0.10, static_speed=0.1, dynamic_speed=1.0)
LOAD = 37.0

# Those that have a kink, and where; the others are continuous with their slope.
KINKS = {
    Ambrosio: ("lower_speed", "upper_speed"),
    LinearFriction: ("regularisation_speed",),
    Threlfall: ("transition_speed",),
    BengisuAkay: ("static_speed",),
}


def dry_limit(law):
    """The largest coefficient a law may reach, but for its viscous part."""
    return max((getattr(law, n, 0.0) for n in ("static", "dynamic", "coefficient_of_friction")), default=0.0)


def viscous(law, speed):
    """The viscous part of a law's coefficient under the load [-]."""
    if isinstance(law, BrownMcPhee):
        return law.viscous * speed * math.tanh(4.0 * LOAD / law.transition_force) / LOAD
    return getattr(law, "viscous", 0.0) * speed


def force_of(law, normal_force, slip):
    return np.array(kernels.friction_force(law.code(), normal_force, *map(float, slip)))


def slope(law, speed, step):
    """One-sided derivative of the coefficient, second order."""
    f = [law.coefficient(speed + k * step, LOAD) for k in range(3)]
    return (-3.0 * f[0] + 4.0 * f[1] - f[2]) / (2.0 * step)


def test_is_a_friction_law_without_memory(friction_law):
    assert isinstance(friction_law, FrictionLaw)
    assert friction_law.states == 0 and friction_law.state_scales == ()


def test_coefficient_lies_between_zero_and_its_limit(friction_law):
    values = np.array([friction_law.coefficient(v, LOAD) for v in SPEEDS])
    excess = np.array([viscous(friction_law, v) for v in SPEEDS])
    assert (values >= 0.0).all()
    assert (values - excess <= dry_limit(friction_law) * (1.0 + 1e-12)).all()  # round-off of the difference
    assert values[0] == 0.0


def test_coefficient_is_continuous(friction_law):
    """A refinement of the speeds shrinks the largest jump in proportion."""
    jumps = []
    for count in (500, 5000):
        speeds = np.geomspace(1e-6, 10.0, count)
        jumps.append(np.abs(np.diff([friction_law.coefficient(v, LOAD) for v in speeds])).max())
    assert jumps[1] <= 0.11 * jumps[0]  # 0.1, and what the kinks of the ramps make of it


def test_slope_is_continuous_but_for_the_named_kinks(friction_law):
    """One-sided slopes agree at the speeds where a law changes its formula, and elsewhere."""
    kinks = KINKS.get(type(friction_law), ())
    named = [n for n in dir(type(friction_law)) if n.endswith("_speed")]
    for speed in [getattr(friction_law, n) for n in named if n not in kinks] + [3e-4, 0.017, 0.4]:
        h = 1e-4 * speed
        left, right = slope(friction_law, speed, -h), slope(friction_law, speed, h)
        scale = (
            friction_law.coefficient(speed, LOAD) / speed
            + friction_law.coefficient(2.0 * speed, LOAD) / speed
        )
        assert left == pytest.approx(right, abs=2e-5 * scale + 1e-12)  # truncation, h^2
    for name in kinks:
        speed = getattr(friction_law, name)
        h = 1e-5 * speed
        assert abs(slope(friction_law, speed, -h) - slope(friction_law, speed, h)) > 1e-3


def test_opposes_slip_in_every_direction(friction_law):
    rng = np.random.default_rng(7)
    for _ in range(200):
        slip = rng.normal(size=3) * 10.0 ** rng.uniform(-6, 1)
        speed = np.linalg.norm(slip)
        expected = -friction_law.coefficient(speed, LOAD) * LOAD * slip / speed
        # Round-off of the speed, to which a ramp of slope mu / (v_1 - v_0) is sensitive.
        assert force_of(friction_law, LOAD, slip) == pytest.approx(expected, rel=1e-12, abs=1e-14)


def test_friction_vanishes_with_the_load(friction_law):
    slip = np.array([0.3, -0.1, 0.0])
    assert (force_of(friction_law, 0.0, slip) == 0.0).all()
    small, smaller = (np.linalg.norm(force_of(friction_law, load, slip)) for load in (1e-6, 1e-9))
    assert smaller == pytest.approx(1e-3 * small, rel=1e-6)  # (F / F_nt)^2
    if not isinstance(friction_law, BrownMcPhee):
        assert friction_law.coefficient(0.2) == friction_law.coefficient(0.2, LOAD)


def test_no_force_at_rest(friction_law):
    assert (force_of(friction_law, 100.0, np.zeros(3)) == 0.0).all()


def test_no_friction_is_none():
    assert all(NoFriction().coefficient(v) == 0.0 for v in SPEEDS)


@pytest.mark.parametrize(
    ("speed", "coefficient"),
    [
        (0.1 - 1e-15, 0.150),
        (0.1, 0.150),
        (0.3, 0.1437),
        (0.55, 0.125),
        (0.8, 0.1063),
        (1.0, 0.100),
        (1.5, 0.100),
    ],
)
def test_corrected_velocity_based_law_in_numbers(speed, coefficient):
    """At the speeds of Bai and Zhao, whose printed law jumps at both ends and rises in between."""
    # The table is rounded to four digits.
    assert BAI_ZHAO.coefficient(speed) == pytest.approx(coefficient, abs=5.1e-5)


# --- docstring formulas ---


def test_docstring_formula_of_the_velocity_based_law():
    law = VelocityBased(static=0.3, dynamic=0.2, static_speed=0.01, dynamic_speed=0.5)
    y, x = 0.004 / 0.01, (0.5 - 0.3) / (0.5 - 0.01)
    assert law.coefficient(0.004) == pytest.approx(0.3 * y * (3 - y * y) / 2, rel=1e-15, abs=0.0)  # round-off
    assert law.coefficient(0.3) == pytest.approx(0.2 + 0.1 * x * x * (3 - 2 * x), rel=1e-15, abs=0.0)
    assert law.coefficient(0.7) == 0.2


def test_ambrosio_ramps_between_its_speeds():
    law = Ambrosio(coefficient_of_friction=0.2, lower_speed=0.01, upper_speed=0.03)
    assert law.coefficient(0.01) == 0.0
    assert law.coefficient(0.005) == 0.0
    assert law.coefficient(0.015) == pytest.approx(0.05, rel=1e-14, abs=0.0)  # round-off
    assert law.coefficient(0.03) == pytest.approx(0.2, rel=1e-15, abs=0.0)
    assert law.coefficient(3.0) == pytest.approx(0.2, rel=1e-15, abs=0.0)


def test_ambrosio_may_start_at_rest():
    law = Ambrosio(coefficient_of_friction=0.2, lower_speed=0.0, upper_speed=0.1)
    assert law.coefficient(0.05) == pytest.approx(0.1, rel=1e-15, abs=0.0)  # round-off
    assert (force_of(law, 1.0, np.zeros(3)) == 0.0).all()


def test_tanh_is_a_hyperbolic_tangent_at_every_speed():
    """Also where the kernel switches to a series, at 1e-4 of the transition speed."""
    law = Tanh(coefficient_of_friction=0.2, transition_speed=0.02)
    for speed in SPEEDS:
        # Round-off; the series leaves out 2/15 y^4 < 2e-17.
        assert law.coefficient(speed) == pytest.approx(0.2 * math.tanh(speed / 0.02), rel=5e-16, abs=0.0)


def test_docstring_formulas_of_the_others():
    v = 0.013
    for law, expected in (
        (
            Coulomb(coefficient_of_friction=0.2, regularisation_speed=0.004),
            0.2 * v / math.sqrt(v**2 + 0.004**2),
        ),
        (LinearFriction(coefficient_of_friction=0.2, regularisation_speed=0.02), 0.2 * v / 0.02),
        (LinearFriction(coefficient_of_friction=0.2, regularisation_speed=0.01), 0.2),
        (
            Stribeck(
                static=0.3, dynamic=0.2, stribeck_speed=0.02, transition_speed=0.01, viscous=0.4, shape=0.5
            ),
            (0.2 + 0.1 * math.exp(-((v / 0.02) ** 0.5))) * math.tanh(v / 0.01) + 0.4 * v,
        ),
        (Threlfall(coefficient_of_friction=0.2, transition_speed=0.02), 0.2 * (1 - math.exp(-3 * v / 0.02))),
        (Threlfall(coefficient_of_friction=0.2, transition_speed=0.01), 0.2 * (1 - math.exp(-3))),
        (
            BengisuAkay(static=0.3, dynamic=0.2, static_speed=0.02, decay=5.0),
            0.3 - 0.3 / 0.02**2 * (v - 0.02) ** 2,
        ),
        (
            BengisuAkay(static=0.3, dynamic=0.2, static_speed=0.01, decay=5.0),
            0.2 + 0.1 * math.exp(-5 * (v - 0.01)),
        ),
    ):
        assert law.coefficient(v) == pytest.approx(expected, rel=1e-13, abs=0.0)  # round-off


def test_docstring_formula_of_brown_and_mcphee():
    law = BrownMcPhee(static=0.3, dynamic=0.2, transition_speed=0.01, viscous=5.0, transition_force=20.0)
    for v in (1e-9, 0.004, 0.01, 0.3):
        for load in (0.3, 12.0, 500.0):
            y = v / 0.01
            dry = 0.2 * math.tanh(4 * y) + 0.1 * y / (0.25 * y**2 + 0.75) ** 2
            expected = load * dry + 5.0 * v * math.tanh(4 * load / 20.0)
            assert law.coefficient(v, load) * load == pytest.approx(expected, rel=1e-13, abs=0.0)  # round-off
            assert -force_of(law, load, (v, 0, 0))[0] == pytest.approx(expected, rel=1e-13, abs=0.0)
    # Without a load it is the dry coefficient; its peak is at v_t.
    assert law.coefficient(0.01) == pytest.approx(0.2 * math.tanh(4.0) + 0.1, rel=1e-13, abs=0.0)
    around = [law.coefficient(0.01 * (1 + k)) for k in (-0.1, 0.0, 0.1)]
    assert around[1] > around[0] and around[1] > around[2]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: VelocityBased(static=0.1, dynamic=0.1, static_speed=0.1, dynamic_speed=0.1),
            "VelocityBased: dynamic_speed must be above static_speed = 0.1, got 0.1",
        ),
        (
            lambda: Ambrosio(coefficient_of_friction=0.1, upper_speed=1e-5),
            "Ambrosio: upper_speed must be above lower_speed = 0.0001, got 1e-05",
        ),
        (
            lambda: Stribeck(static=0.1, dynamic=0.2, stribeck_speed=0.1),
            "Stribeck: static must be at least dynamic = 0.2, got 0.1",
        ),
        (
            lambda: Stribeck(static=0.3, dynamic=0.2, stribeck_speed=0.1, transition_speed=0.2),
            "Stribeck: transition_speed must be below stribeck_speed = 0.1, got 0.2",
        ),
    ],
)
def test_refuses_what_is_no_law(make, message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        make()


def test_a_users_own_law_is_a_law():
    law = CustomFriction(coefficient=lambda speed: 0.1 * min(1.0, speed / 1e-6))
    assert isinstance(law, FrictionLaw)
    assert law.coefficient(3.0) == 0.1


@pytest.mark.parametrize(
    "coefficient",
    [
        lambda speed: 0.1,
        lambda speed: 0.1 if speed > 0.0 else 0.0,
        njit(lambda speed: 0.3 - 0.1 * math.tanh(speed)),
    ],
)
def test_refuses_a_law_that_jumps_where_the_slip_turns_round(coefficient):
    """Steps would become shorter for ever; a law of one's own as a class is refused by its joint."""
    with pytest.raises(ValueError, match="coefficient must be a function that tends to 0 with the speed"):
        CustomFriction(coefficient=coefficient)

    class Mine:
        def coefficient(self, speed):
            return coefficient(speed)

    shape = PlanarClearance(bearing_radius=5.05e-3, journal_radius=5e-3)
    with pytest.raises(ValueError, match="joint 'pin': Mine: coefficient must be"):
        ClearanceJoint(name="pin", geometry=shape, radial=Hertz(stiffness=1e8), friction=Mine())
