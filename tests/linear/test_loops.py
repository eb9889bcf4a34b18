"""Closed loops: modes against the closed form of one coordinate."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from antenna_pin import System, build_system, load_scenario
from antenna_pin.dynamics import JointSpring, PointSpring
from antenna_pin.scenario.assemble import initial_state
from antenna_pin.studies.linear import modes

TAU = 2.0 * np.pi
ANGLE = 0.7
# Crank and rod [m]; a string from the slider to a wall, and a spring at the crank that balances it.
R, L, WALL = 0.05, 0.12, 0.4
STRING, FREE_LENGTH, SPRING = 4000.0, 0.05, 90.0


def slider(phi: float) -> tuple[float, float, float, float, float]:
    """Rod's inclination and its derivative, the slider's position and its derivatives, over the angle."""
    beta = np.arcsin(-R * np.sin(phi) / L)
    rate = -R * np.cos(phi) / (L * np.cos(beta))
    bend = (R / L * np.sin(phi) + np.sin(beta) * rate**2) / np.cos(beta)
    x = R * np.cos(phi) + L * np.cos(beta)
    first = -R * np.sin(phi) - L * np.sin(beta) * rate
    second = -R * np.cos(phi) - L * np.cos(beta) * rate**2 - L * np.sin(beta) * bend
    return rate, beta, x, first, second


def sprung(case: str, damping: float = 0.0) -> tuple[System, np.ndarray, float]:
    """A slider-crank in balance between string and spring; and its stiffness over the crank's angle."""
    scenario = load_scenario("slider_crank", case=case, overrides={"drives.crank.position": ANGLE})
    driven = build_system(scenario)
    q, _ = initial_state(scenario, driven)
    _, _, x, first, second = slider(ANGLE)
    tension = STRING * (WALL - x - FREE_LENGTH)
    rest = ANGLE - tension * first / SPRING
    springs: dict[str, Any] = {
        "string": PointSpring(
            first=("world", (WALL, 0, 0)),
            second=("slider", (0, 0, 0)),
            free_length=FREE_LENGTH,
            stiffness=STRING,
        ),
        "crank": JointSpring(joint="crank", stiffness=SPRING, rest_angle=rest, damping=damping),
    }
    closures = {name: one for name, one in driven.closures.items() if name not in driven.held}
    system = System(driven.mechanism, springs=springs, held=driven.held, closures=closures)
    return system, q, STRING * first**2 - tension * second + SPRING


def inertia(phi: float) -> float:
    """Inertia over the crank's angle: masses and their places are the model's."""
    rate, beta, _, first, _ = slider(phi)
    x = -R * np.sin(phi) - 0.06 * rate * np.sin(beta)
    z = R * np.cos(phi) + 0.06 * rate * np.cos(beta)
    crank, rod = 1e-4 + 0.3 * 0.025**2, 0.21 * (x**2 + z**2) + 2.5e-4 * rate**2
    return crank + rod + 0.14 * first**2


@pytest.mark.parametrize("case", ["ideal", "ideal-constraint"])
def test_slider_crank_about_an_equilibrium(case: str):
    """w^2 = V'' / m of the one coordinate that the loop leaves.

    Of V'' the tension times the slider's curvature is geometric: what carries the load turns.
    """
    system, q, stiffness = sprung(case, damping=0.02)
    found = modes(system, q=q)
    expected = np.sqrt(stiffness / inertia(ANGLE))
    assert found.frequency * TAU == pytest.approx([expected], rel=1e-10, abs=0.0)
    assert found.damping_ratio == pytest.approx([0.02 / (2 * expected * inertia(ANGLE))], rel=1e-9)
    assert found.notes == ()
    # The geometric part counts: a tenth of the stiffness and more.
    _, _, x, _, second = slider(ANGLE)
    assert abs(STRING * (WALL - x - FREE_LENGTH) * second) > 0.1 * stiffness


def test_a_turning_loop():
    """About a steady turn: m q'' + m' q'^2 / 2 + V' = 0, linear about an instant with its acceleration."""
    system, q, _ = sprung("ideal")
    rate = 30.0
    v = np.zeros(system.model.nv)
    from antenna_pin.dynamics import assembled

    slot = system.mechanism.joint("crank")
    v[slot.v] = rate
    q, v = assembled(system, q, v, held=["crank"])
    found = modes(system, q=q, v=v, moving=True).linearisation

    def acceleration(phi: float, speed: float) -> float:
        h = 1e-4
        m = [inertia(phi + k * h) for k in (-2, -1, 1, 2)]
        slope = (m[0] - 8 * m[1] + 8 * m[2] - m[3]) / (12 * h)
        _, _, x, first, _ = slider(phi)
        torque = STRING * (WALL - x - FREE_LENGTH) * first - SPRING * (phi - rest)
        return (torque - 0.5 * slope * speed**2) / inertia(phi)

    rest = system.springs["crank"].rest_angle
    h = 1e-3
    by_angle = (acceleration(ANGLE + h, rate) - acceleration(ANGLE - h, rate)) / (2 * h)
    by_speed = (acceleration(ANGLE, rate + 1.0) - acceleration(ANGLE, rate - 1.0)) / 2.0
    # The coordinate is s = g phi~, g the tangent's part along N, which turns: s'' = g phi~'' + 2 g' phi~' ...
    along = [found.directions[:, 0] @ tangent(ANGLE + k * h) for k in (-1, 0, 1)]
    g = along[1]
    first, second = (along[2] - along[0]) / (2 * h), (along[2] - 2 * g + along[0]) / h**2
    drift, bend = first * rate / g, (second * rate**2 + first * acceleration(ANGLE, rate)) / g
    matrix = found.state_matrix
    assert matrix[0] == pytest.approx([0.0, 1.0], abs=1e-12)
    assert matrix[1, 1] == pytest.approx(by_speed + 2 * drift, rel=1e-5)
    assert matrix[1, 0] == pytest.approx(by_angle - by_speed * drift - 2 * drift**2 + bend, rel=1e-5)


def tangent(phi: float) -> np.ndarray:
    """Rates of crank, crank pin and pin over that of the crank."""
    beta_rate = slider(phi)[0]
    return np.array([1.0, beta_rate - 1.0, -beta_rate])
