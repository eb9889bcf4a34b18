"""The reference is itself right: closed forms, invariants, and the balance of every body."""

from functools import cache
from math import radians

import five_legs
import numpy as np
import pytest
from maximal import Maximal
from maximal_parts import WORLD, Body, Joint, Motion, Side, Spring
from scipy.spatial.transform import Rotation
from scipy.special import ellipj, ellipk
from single_loops import (
    BRICARD_AXES,
    COUPLER,
    CRANK,
    CRANK_RATE,
    GRAVITY,
    ROCKER,
    bricard,
    four_bar,
    four_bar_angles,
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


def plane_angles(run, body):
    """Angle of a body's x from the world's x towards z, no jumps [rad]."""
    x = run.rotation(body)[:, :, 0]
    return np.unwrap(np.arctan2(x[:, 2], x[:, 0]))


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


@pytest.mark.parametrize("name", RUNS)
def test_ranks(name):
    """Rows, rank and mobility that are known of each; the next smaller singular value is round-off."""
    rows, rank = {
        "four_bar": (20, 17),
        "bricard": (30, 29),
        "spatial_slider_crank": (17, 17),
        "five_legs": (66, 66),
    }[name]
    run = history(name)
    for t, y in zip(run.t[::4], run.states[::4], strict=True):
        assert (run.system.rows, run.system.rank(t, y)) == (rows, rank)
        values = run.system.singular_values(t, y)
        assert np.all(values[rank:] < 1e-14 * values[0])
        assert values[rank - 1] > 1e-5 * values[0]


def test_freedoms_of_the_five_legs():
    """Five without drives; three with drives and without the ball s2; none with both."""
    states = history("five_legs").states
    for system, rows, mobility in (
        (five_legs.platform(), 66, 0),
        (five_legs.platform(driven=False), 61, 5),
        (five_legs.platform(without=("s2",)), 63, 3),
    ):
        assert system.rows == rows
        assert system.mobility(0.0, states[0]) == mobility


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


def test_the_four_bar_keeps_its_shape_and_its_crank_the_rate_that_energy_gives():
    """Angles by intersecting circles; the rate by influence coefficients and the energy at the start."""
    run = history("four_bar")
    crank = plane_angles(run, "crank")
    angles = np.array([four_bar_angles(a) for a in crank])
    for k, body in enumerate(("coupler", "rocker")):
        assert np.angle(np.exp(1j * (plane_angles(run, body) - angles[:, k]))) == pytest.approx(
            0.0, abs=1e-13
        )
    inertia, potential = [], []
    for a, (b, c) in zip(crank, angles, strict=True):
        ea, eb, ec = np.exp(1j * np.array([a, b, c]))  # CRANK ea + COUPLER eb = GROUND + ROCKER ec
        loop = np.array([[(COUPLER * 1j * eb).real, -(ROCKER * 1j * ec).real],
                         [(COUPLER * 1j * eb).imag, -(ROCKER * 1j * ec).imag]])  # fmt: skip
        db, dc = np.linalg.solve(loop, [-(CRANK * 1j * ea).real, -(CRANK * 1j * ea).imag])
        total, height = 0.0, 0.0
        for (name, body), e, rate in zip(run.system.bodies.items(), (ea, eb, ec), (1.0, db, dc), strict=True):
            arm = complex(body.centre[0], body.centre[2]) * e
            at = {"crank": 0.0, "coupler": CRANK * ea, "rocker": 0.0}[name]
            speed = 1j * arm * rate + (1j * CRANK * ea if name == "coupler" else 0.0)
            total += body.mass * abs(speed) ** 2 + body.moments[1, 1] * rate**2
            height += body.mass * GRAVITY * (at + arm).imag
        inertia.append(total)
        potential.append(height)
    inertia, potential = np.array(inertia), np.array(potential)
    rate = np.sqrt((inertia[0] * CRANK_RATE**2 + 2.0 * (potential[0] - potential)) / inertia)
    assert -run.spin("crank")[:, 1] == pytest.approx(rate, abs=1e-9)  # energy to 3e-12 J over 1e-3 kg m^2
    assert np.ptp(crank) > 2.0 * np.pi  # it did go round


def test_bricards_angles_obey_his_relation():
    """sin p + sin q + sin p sin q = 0 for neighbours' angles from the cube; every second one is the same."""
    run = history("bricard")
    rotations = [np.broadcast_to(np.eye(3), (17, 3, 3))]
    rotations += [run.rotation(f"bar_{k}") for k in range(1, 6)] + rotations
    angles = np.array(
        [
            Rotation.from_matrix(a.transpose(0, 2, 1) @ b).as_rotvec() @ axis
            for a, b, axis in zip(rotations[:-1], rotations[1:], BRICARD_AXES, strict=True)
        ]
    )
    p, q = angles[:2]
    assert np.tile([p, q], (3, 1)) == pytest.approx(angles, abs=1e-13)
    assert np.sin(p) + np.sin(q) + np.sin(p) * np.sin(q) == pytest.approx(0.0, abs=1e-13)
    assert p[-1] > radians(55.0)


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


def test_the_platform_is_where_its_path_is():
    """In closed form: integration has nothing to add, and projection leaves round-off."""
    run = history("five_legs")
    path = np.array([five_legs.path(t) for t in run.t])
    assert run.position("platform") == pytest.approx(path[:, 0], abs=1e-13)
    assert run.velocity("platform") == pytest.approx(path[:, 1], abs=1e-13)
    assert run.acceleration("platform") == pytest.approx(path[:, 2], abs=1e-11)
    assert run.rotation("platform") == pytest.approx(np.tile(np.eye(3), (17, 1, 1)), abs=1e-13)
