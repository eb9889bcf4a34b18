"""Friction laws with bristles: they stick, slide steadily as they should, and stay in the tangent plane."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from antenna_pin.contact import Dahl, GonthierBristle, LuGre, kernels

LUGRE = LuGre(static=0.3, dynamic=0.2, stribeck_speed=1e-3, bristle_stiffness=1e5, bristle_damping=30.0)
GONTHIER = GonthierBristle(
    static=0.3, dynamic=0.2, stribeck_speed=1e-3, bristle_stiffness=1e5, bristle_damping=30.0, dwell_time=0.1
)
Z = np.array([0.0, 0.0, 1.0])


def evaluate(law, slip, state, normal=Z, load=1.0):
    """Friction force and rates of the state."""
    state = np.asarray(state, dtype=float)
    rates = np.full(law.states, math.nan)
    way, across = tuple(map(float, slip)), tuple(map(float, normal))
    force = kernels.bristle_force(law.code(), load, way, across, state, rates)
    return np.array(force), rates


def slide(law, slip, duration, state=None, rtol=1e-10):
    """The state after sliding with a given slip velocity (a function of time)."""
    start = np.zeros(law.states) if state is None else np.asarray(state, dtype=float)
    run = solve_ivp(
        lambda t, x: evaluate(law, slip(t), x)[1],
        (0.0, duration),
        start,
        method="Radau",
        rtol=rtol,
        atol=rtol * np.array(law.state_scales) * 1e-2,
        dense_output=True,
    )
    assert run.success
    return run


def test_is_a_law_with_memory(bristle_law):
    assert bristle_law.states == (4 if isinstance(bristle_law, GonthierBristle) else 3)
    assert all(scale > 0.0 for scale in bristle_law.state_scales)


def test_nothing_happens_at_rest(bristle_law):
    """No slip: the deflection stays and holds its force; the dwell state grows."""
    deflection = 0.3 * bristle_law.state_scales[0]
    state = [deflection, 0.0, *[0.0] * (bristle_law.states - 2)]
    force, rates = evaluate(bristle_law, (0, 0, 0), state, load=50.0)
    assert (rates[:3] == 0.0).all()
    assert force == pytest.approx([-50.0 * bristle_law.bristle_stiffness * deflection, 0.0, 0.0], rel=1e-14)
    if bristle_law.states == 4:
        assert rates[3] == pytest.approx(1.0 / bristle_law.dwell_time)


def test_friction_is_proportional_to_the_load_and_regular_as_it_vanishes(bristle_law):
    """The state does not know the load at all."""
    state = 0.2 * np.array(bristle_law.state_scales)
    slip = (2e-3, -1e-3, 0.0)
    one, rates = evaluate(bristle_law, slip, state, load=1.0)
    for load in (0.0, 1e-12, 700.0):
        force, same = evaluate(bristle_law, slip, state, load=load)
        assert force == pytest.approx(load * one, rel=1e-14, abs=0.0)
        assert (same == rates).all()


def test_presliding_is_elastic(bristle_law):
    """Moved by a thousandth of the largest deflection and back, the force is that of a spring."""
    scale = bristle_law.state_scales[0]
    speed = 1e-6
    period = 2e-3 * scale / speed
    run = slide(bristle_law, lambda t: (speed if t < 0.5 * period else -speed, 0.0, 0.0), 0.5 * period)
    deflection = run.y[0, -1]
    # To first order in deflection over its largest; nearly so where the bristle slides a little, too.
    assert deflection == pytest.approx(1e-3 * scale, rel=5e-3)


def test_steady_sliding_has_the_stated_coefficient(bristle_law):
    for speed in (3e-5, 2e-3, 0.2):
        # Many times what the bristle bends at most, and long against the dwell time.
        ways = 2e4 if getattr(bristle_law, "shape", 1.0) > 1.0 else 12.0
        duration = max(ways * bristle_law.state_scales[0] / speed, 3.0)
        end = slide(bristle_law, lambda t, v=speed: (0.6 * v, 0.8 * v, 0.0), duration, rtol=1e-7).y[:, -1]
        force, _ = evaluate(bristle_law, (0.6 * speed, 0.8 * speed, 0.0), end, load=80.0)
        expected = 80.0 * bristle_law.coefficient(speed)
        # exp(-12), or for Dahl's law with another shape 1 / 20000.
        assert np.linalg.norm(force) == pytest.approx(expected, rel=2e-4)
        assert force == pytest.approx(-expected * np.array([0.6, 0.8, 0.0]), abs=2e-4 * expected)


def test_steady_coefficients_in_closed_form():
    v = 7e-4
    level = 0.2 + 0.1 * math.exp(-((v / 1e-3) ** 2))
    law = LuGre(static=0.3, dynamic=0.2, stribeck_speed=1e-3, bristle_stiffness=1e5, viscous=0.5)
    assert law.coefficient(v) == pytest.approx(level + 0.5 * v, rel=1e-14)
    assert law.coefficient(0.0) == 0.3
    assert Dahl(coefficient_of_friction=0.25, bristle_stiffness=1e5).coefficient(v) == 0.25
    assert GONTHIER.coefficient(0.0) == pytest.approx(0.3, rel=1e-14)
    assert GONTHIER.coefficient(1.0) == pytest.approx(0.2, rel=1e-14)


def test_dahl_follows_its_closed_form():
    """From a straight bristle: sigma_0 z = mu (1 - exp(-sigma_0 x / mu)), whatever the speed."""
    law = Dahl(coefficient_of_friction=0.2, bristle_stiffness=1e5)
    for speed in (1e-5, 3e-2):
        way = 3e-6
        run = slide(law, lambda t, v=speed: (v, 0.0, 0.0), way / speed)
        expected = 0.2 / 1e5 * (1.0 - math.exp(-1e5 * way / 0.2))
        assert run.y[0, -1] == pytest.approx(expected, rel=1e-8)


def test_dahl_with_another_shape():
    """i = 2: sigma_0 z = mu s / (1 + s), s = sigma_0 x / mu."""
    law = Dahl(coefficient_of_friction=0.2, bristle_stiffness=1e5, shape=2.0)
    way = 3e-6
    run = slide(law, lambda t: (1e-4, 0.0, 0.0), way / 1e-4)
    s = 1e5 * way / 0.2
    assert run.y[0, -1] == pytest.approx(0.2 / 1e5 * s / (1.0 + s), rel=1e-8)


def test_a_load_below_break_away_is_held():
    """A mass pushed with less than half its break-away force moves by a deflection and stays: it sticks."""
    mass, load = 1.0, 100.0
    push = 0.1 * load

    def rates(_, x):
        force, of_state = evaluate(LUGRE, (x[1], 0.0, 0.0), x[2:], load=load)
        return [x[1], (push + force[0]) / mass, *of_state]

    run = solve_ivp(rates, (0.0, 0.05), [0.0, 0.0, 0.0, 0.0, 0.0], method="DOP853", rtol=1e-9, atol=1e-13)
    position, speed = run.y[0, -1], run.y[1, -1]
    assert abs(speed) < 1e-10
    # sigma_0 z = push / load, and a little way beyond that the bristle has slid.
    assert run.y[2, -1] == pytest.approx(0.1 / 1e5, rel=1e-5)
    assert 0.1 / 1e5 < position < 2.0 * 0.1 / 1e5


def test_static_friction_grows_with_the_dwell_time():
    """After rest of t the friction limit is mu_d + (mu_s - mu_d) (1 - exp(-t / tau))."""
    held = slide(GONTHIER, lambda t: (0.0, 0.0, 0.0), 0.05).y[:, -1]
    assert held[3] == pytest.approx(1.0 - math.exp(-0.5), rel=1e-8)
    bent = [1e-3, 0.0, 0.0, held[3]]  # far beyond what it can hold
    force, _ = evaluate(GONTHIER, (0.0, 0.0, 0.0), bent, load=10.0)
    assert -force[0] / 10.0 == pytest.approx(0.2 + 0.1 * held[3], rel=1e-8)


def test_dwell_is_forgotten_within_the_bristles_time():
    state = [0.0, 0.0, 0.0, 1.0]
    _, rates = evaluate(GONTHIER, (0.1, 0.0, 0.0), state)
    assert rates[3] == pytest.approx(-1e5 / 30.0, rel=1e-12)


def test_force_is_tangent_whatever_the_deflection(bristle_law):
    rng = np.random.default_rng(1)
    for _ in range(50):
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        slip = np.cross(normal, rng.normal(size=3)) * 1e-3
        state = np.array(bristle_law.state_scales) * rng.uniform(-1.0, 1.0, size=bristle_law.states)
        force, rates = evaluate(bristle_law, slip, state, normal, load=30.0)
        assert abs(force @ normal) < 1e-13 * 30.0
        # What is not tangent of the deflection fades, and never grows.
        assert (rates[:3] @ normal) * (state[:3] @ normal) <= 1e-25


def test_law_is_isotropic(bristle_law):
    """Turning slip, deflection and normal turns force and rates."""
    rng = np.random.default_rng(5)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    state = np.array(bristle_law.state_scales) * 0.4
    slip = np.array([1e-3, 2e-3, 0.0])
    force, rates = evaluate(bristle_law, slip, state)
    turned = np.concatenate([turn @ state[:3], state[3:]])
    other, other_rates = evaluate(bristle_law, turn @ slip, turned, turn @ Z)
    assert other == pytest.approx(turn @ force, rel=1e-12, abs=1e-15)
    assert other_rates[:3] == pytest.approx(turn @ rates[:3], rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("law", [LUGRE, GONTHIER, Dahl(coefficient_of_friction=0.2, bristle_stiffness=1e5)])
def test_a_cycle_takes_energy(law):
    """Back and forth over several times the largest deflection: friction has taken work at the end."""
    scale, rate = law.state_scales[0], 40.0
    amplitude = 5.0 * scale

    def slip(t):
        return (amplitude * rate * math.cos(rate * t), 0.0, 0.0)

    run = slide(law, slip, 4.0 * math.pi / rate, rtol=1e-8)
    times = np.linspace(0.0, 4.0 * math.pi / rate, 1001)
    power = [-evaluate(law, slip(t), run.sol(t))[0][0] * slip(t)[0] for t in times]
    work = np.trapezoid(power, times)
    # Two cycles of four amplitudes each, at the dynamic coefficient at least but for what reversal lets go.
    assert work > 0.6 * 8.0 * amplitude * 0.2
    # While a bristle springs back it gives energy; never more than it holds.
    stored = 0.5 * law.bristle_stiffness * scale**2
    total = np.concatenate([[0.0], np.cumsum(0.5 * (np.diff(times)) * (np.array(power)[1:] + power[:-1]))])
    assert (np.maximum.accumulate(total) - total).max() <= stored * (1.0 + 1e-3)


def test_refuses_what_is_no_law():
    with pytest.raises(ValueError, match=r"^LuGre: static must be at least dynamic = 0.2, got 0.1$"):
        LuGre(static=0.1, dynamic=0.2, stribeck_speed=1.0, bristle_stiffness=1.0)
