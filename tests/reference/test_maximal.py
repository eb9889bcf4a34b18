"""The reference is itself right: closed forms, invariants, and the balance of every body."""

from functools import cache

import five_legs
import numpy as np
import pytest
from maximal import Maximal
from maximal_parts import WORLD, Body, Joint, Motion, Side, Spring
from scipy.spatial.transform import Rotation
from scipy.special import ellipj, ellipk
from single_loops import (
    GRAVITY,
    bricard,
    four_bar,
    spatial_slider,
    spatial_slider_crank,
)

RUNS = ("four_bar", "bricard", "spatial_slider_crank", "five_legs")


@cache
def history(name):
    """One second of each mechanism; tests share it."""
    times = np.linspace(0.0, 1.0, 17)
    if name == "five_legs":
        return five_legs.platform().run(times)
    loop = {"four_bar": four_bar, "bricard": bricard, "spatial_slider_crank": spatial_slider_crank}[name]()
    return loop.system.run(times, loop.start)


def test_a_physical_pendulum_swings_as_jacobi_says():
    """Angle by elliptic functions, pin force by Newton; both to what is left of rtol 1e-12 over a second."""
    mass, arm, moment, start = 1.3, 0.4, 0.05, 2.0
    body = Body(
        mass=mass, inertia=(0.1, moment, 0.2), centre=(0.0, 0.0, -arm),
        attitude=Rotation.from_rotvec([0.0, -start, 0.0]).as_matrix(),
    )  # fmt: skip
    pin = Joint("revolute", Side(WORLD, (0, 0, 0), (0, 1, 0)), Side("bob", (0, 0, 0), (0, 1, 0)))
    run = Maximal({"bob": body}, {"pin": pin}, gravity=(0, 0, -GRAVITY)).run(np.linspace(0.0, 1.0, 6))
    rate = np.sqrt(mass * GRAVITY * arm / (moment + mass * arm**2))
    k = np.sin(start / 2)
    sn = ellipj(rate * run.t + ellipk(k**2), k**2)[0]
    angle = 2.0 * np.arcsin(k * sn)
    swing = np.column_stack([np.sin(angle), 0.0 * angle, -np.cos(angle)])
    assert run.position("bob", (0, 0, -arm)) == pytest.approx(arm * swing, abs=1e-11)
    speed_2, acceleration = 2.0 * rate**2 * (np.cos(angle) - np.cos(start)), -(rate**2) * np.sin(angle)
    tangent = np.column_stack([np.cos(angle), 0.0 * angle, np.sin(angle)])
    force = mass * (arm * (acceleration[:, None] * tangent - speed_2[:, None] * swing) + [0, 0, GRAVITY])
    assert run.load("pin")[0] @ pin.first.frame.T == pytest.approx(force, abs=1e-9)


def test_a_spring_and_damper_between_points_make_an_oscillator():
    mass, stiffness, damping, length = 2.0, 50.0, 1.2, 0.7
    joints = {
        "guide": Joint("prismatic", Side(WORLD, (0, 0, 0), (1, 0, 0), (0, 1, 0)),
                       Side("block", (0, 0, 0.1), (1, 0, 0), (0, 1, 0)))
    }  # fmt: skip
    spring = Spring(
        first=Side(WORLD, (-length, 0, 0)), second=Side("block", (0, 0, 0.1)), length=length,
        stiffness=stiffness, damping=damping,
    )  # fmt: skip
    body = Body(mass=mass, inertia=(0.01, 0.02, 0.03), position=(0.2, 0, -0.1))
    run = Maximal({"block": body}, joints, springs=[spring]).run(np.linspace(0.0, 2.0, 6))
    pole = (-damping + 1j * np.sqrt(4 * mass * stiffness - damping**2)) / (2 * mass)
    x = 0.2 * (np.exp(pole * run.t) * (1.0 - 1.0 / (1.0 - np.conj(pole) / pole))).real * 2.0
    assert run.position("block", (0, 0, 0.1))[:, 0] == pytest.approx(x, abs=1e-11)


@pytest.mark.parametrize("name", RUNS[:3])
def test_energy_is_kept(name):
    """DOP853 at rtol 1e-12 leaves 3e-12 J of some joules; twice as fine leaves a tenth."""
    energy = history(name).energy()
    assert energy == pytest.approx(np.full(17, energy[0]), abs=1e-10)


@pytest.mark.parametrize("name", RUNS)
def test_loads_move_every_body_as_newton_and_euler_say(name):
    """Loads on each body, from both sides of its joints, against its accelerations: signs, points, axes."""
    run = history(name)
    system = run.system
    force = {b: np.zeros((17, 3)) for b in system.bodies}
    moment = {b: np.zeros((17, 3)) for b in system.bodies}  # about the mass centre
    for joint, sides in system.joints.items():
        axes = (
            sides.first.frame
            if sides.first.body == WORLD
            else run.rotation(sides.first.body) @ sides.first.frame
        )
        f, m = (np.einsum("...ij,...j", axes, load) for load in run.load(joint))
        if any(motion.joint == joint for motion in system.motions):  # prismatic, here
            f = f + run.drive(joint)[:, None] * axes[..., 2]
        second = sides.second
        point = second.point if second.body == WORLD else run.position(second.body, second.point)
        for side, sign in ((sides.first, -1.0), (second, 1.0)):
            if side.body != WORLD:
                arm = point - run.position(side.body, system.bodies[side.body].centre)
                force[side.body] += sign * f
                moment[side.body] += sign * (m + np.cross(arm, f))
    for k, (name_of_body, body) in enumerate(system.bodies.items()):
        R, w = run.rotation(name_of_body), run.spin(name_of_body)
        a = run.accelerations[:, k]
        inertia = R @ body.moments @ R.transpose(0, 2, 1)
        euler = np.einsum("kij,kj->ki", inertia, a[:, 3:]) + np.cross(w, np.einsum("kij,kj->ki", inertia, w))
        # round-off of some hundred newtons and of the solution for the multipliers
        assert force[name_of_body] == pytest.approx(body.mass * (a[:, :3] - system.gravity), abs=1e-9)
        assert moment[name_of_body] == pytest.approx(euler, abs=1e-9)


def test_a_driven_crank_moves_the_slider_and_does_the_work():
    """Position in closed form; work of the drive, by Gauss quadrature of its power, is the energy gained."""
    loop = spatial_slider_crank()
    motion = Motion(
        "pivot",
        lambda t: 4.0 * t + 0.3 * np.sin(5.0 * t),
        lambda t: 4.0 + 1.5 * np.cos(5.0 * t),
        lambda t: -7.5 * np.sin(5.0 * t),
    )
    nodes, weights = np.polynomial.legendre.leggauss(18)
    times = [0.0, *(0.25 + 0.25 * nodes), 0.5]
    run = loop.system.with_motions([motion]).run(times)
    slider = run.position("slider")[:, 0]
    assert slider == pytest.approx([spatial_slider(motion.position(t)) for t in times], abs=1e-14)
    power = run.drive("pivot") * [motion.velocity(t) for t in times]
    energy = run.energy()
    assert np.ptp(energy) > 0.1
    assert 0.25 * weights @ power[1:-1] == pytest.approx(energy[-1] - energy[0], abs=1e-11)
