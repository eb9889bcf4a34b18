"""Distributed load: strips of the bore and sectors of the flanges."""

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from hinge_shapes import antenna_hinge
from scipy.integrate import quad

from antenna_pin.contact import BrownMcPhee, Goldsmith, Hertz, Johnson, KelvinVoigt, NoFriction, Tanh
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints import ClearanceJoint

SHAPE = antenna_hinge()
LINE = 2e10  # [N/m^2], force per length and depth of a linear line law
FOUNDATION = 1e13  # [N/m^3]
AREA = np.pi * (0.012**2 - 0.01**2)


def joint(strips=16, sectors=16, exponent=1.0, friction=None, backend="closed-form"):
    return ClearanceJoint(
        name="j",
        geometry=SHAPE,
        # Of half the bore, of a whole flange.
        radial=Hertz(stiffness=0.5 * LINE * SHAPE.bearing_length, exponent=exponent),
        axial=Hertz(stiffness=FOUNDATION * AREA, exponent=1.0),
        friction=friction or NoFriction(),
        backend=backend,
        load="distributed",
        strips=strips,
        sectors=sectors,
    )


def pose(x=0.0, y=0.0, z=0.0, tilt=(0.0, 0.0)):
    """Journal's centre [m] and rotation vector of its tilt [rad] as a configuration."""
    return np.array([x, y, z, *pin.Quaternion(pin.exp3(np.array([*tilt, 0.0]))).coeffs()])


REST = np.zeros(6)


def force(one, q, v=REST):
    return one.evaluate(q, v).generalized_force


def test_parallel_axes_give_the_line_load_in_closed_form():
    """Every strip at the same depth: force = modulus x length x depth, no torque."""
    depth = 3e-6
    f = force(joint(), pose(x=2e-4 + depth))
    assert f[0] == pytest.approx(-LINE * 0.05 * depth, rel=1e-9)  # 1e-16 m of 3e-6 m
    assert f[1:] == pytest.approx(np.zeros(5), abs=1e-12 * abs(f[0]))


def test_full_annulus_gives_the_foundation_in_closed_form():
    """Compression and tilt of a fully loaded annulus: k A depth and k I tilt."""
    depth, tilt = 5e-6, 1e-5
    f = force(joint(sectors=64), pose(z=-2e-4 - depth))
    assert f[2] == pytest.approx(FOUNDATION * AREA * depth, rel=1e-9)
    f = force(joint(sectors=64), pose(z=-2e-4 - depth, tilt=(tilt, 0.0)))
    second_moment = np.pi / 4 * (0.012**4 - 0.01**4)
    # Ring and annulus have the same second moment. The pressure follows the tilted flange, at this lever.
    follower = FOUNDATION * AREA * depth * (0.025 + 2e-4 + depth) * tilt
    assert f[3] == pytest.approx(-FOUNDATION * second_moment * tilt + follower, rel=1e-6)


@pytest.mark.parametrize(
    ("q", "order"),
    [
        # All strips loaded: midpoint rule on a smooth load.
        (pose(x=2.3e-4, tilt=(0.0, 5e-4)), 2.0),
        # The load ends inside the bearing, where it rises from nothing as depth^1.5: still of second order.
        (pose(x=1.9e-4, tilt=(0.0, 1.7e-3)), 2.0),
    ],
    ids=["full", "partial"],
)
def test_force_and_torque_converge_with_the_strips(q, order):
    exact = force(joint(strips=8192, exponent=1.5), q)
    counts = np.array([8, 16, 32, 64, 128, 256])
    for component in (0, 4):
        errors = [
            abs(force(joint(strips=int(n), exponent=1.5), q)[component] - exact[component]) for n in counts
        ]
        slope = -np.polyfit(np.log(counts), np.log(np.maximum(errors, 1e-13)), 1)[0]
        # A partial load's error scatters with where its end falls in a strip: half an order.
        assert slope > order - 0.5, (component, slope, errors)


@pytest.mark.parametrize("q", [{"x": 2.03e-4}, {"z": -2.04e-4}, {"x": 2.03e-4, "z": 2.02e-4}], ids=repr)
def test_wrench_is_continuous_in_tilt_through_zero(q):
    """Neither force nor torque jumps over a tilt of 2e-14 rad."""
    small = 1e-14
    before, after = (force(joint(), pose(**q, tilt=(s * small, 0.3 * s * small))) for s in (-1.0, 1.0))
    size = np.linalg.norm(before[:3])
    assert np.linalg.norm(after[:3] - before[:3]) < 1e-9 * size
    assert np.linalg.norm(after[3:] - before[3:]) < 1e-9 * size * 0.012


LAWS = {
    "point law": Hertz(stiffness=1e11),
    "line law": Johnson(length=0.025, journal_radius=0.0098, bearing_radius=0.01, modulus=1.1e11),
    # The length stands in the logarithm, too.
    "goldsmith": Goldsmith(length=0.025, journal_radius=0.0098, bearing_radius=0.01, modulus=1.1e11),
    # Damping beside the spring, and friction that is no multiple of the normal force.
    "damper": KelvinVoigt(stiffness=1e9, damping=1e3),
}
VISCOUS = BrownMcPhee(static=0.2, dynamic=0.1, transition_speed=0.01, viscous=5.0, transition_force=20.0)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("friction", [NoFriction(), VISCOUS], ids=["", "friction"])
@pytest.mark.parametrize("backend", ["closed-form", "coal"])
def test_parallel_axes_bear_the_point_load_whatever_the_number_of_shares(law, friction, backend):
    """At zero tilt all strips and sectors are as deep as the ends and the rim are."""
    # Pressed into the bore, sliding along it; then on a flange, sliding across.
    for q, v in (
        (pose(x=2.01e-4), [0.01, 0.0, 0.02, 0.0, 0.0, 0.0]),
        (pose(z=-2.01e-4), [0.02, 0.0, -0.01, 0.0, 0.0, 0.0]),
    ):
        made = dataclasses.replace(joint(), radial=law, axial=Hertz(stiffness=1e9), friction=friction)
        point = dataclasses.replace(made, load="point", backend=backend).evaluate(q, v)
        for strips, sectors in ((2, 3), (16, 16), (64, 40)):
            shared = dataclasses.replace(made, strips=strips, sectors=sectors, backend=backend)
            found = shared.evaluate(q, v)
            size = np.linalg.norm(point.generalized_force)
            assert size > 0.5
            # Round-off: depths of 1e-6 m are differences of 1e-2 m.
            assert found.normal_force == pytest.approx(point.normal_force, rel=1e-9)
            assert found.generalized_force == pytest.approx(point.generalized_force, abs=1e-9 * size)
            assert shared.stored_energy(q) == pytest.approx(
                dataclasses.replace(shared, load="point").stored_energy(q), rel=1e-9, abs=0.0
            )


@pytest.mark.parametrize("exponent", [1.0, 1.5])
@pytest.mark.parametrize("part", [0.02, 0.3, 0.9, 1.1, 3.0])
def test_a_flange_is_as_stiff_whichever_way_it_tilts(part, exponent):
    """The force of an annulus pressed in part or in whole does not know the tilt's direction.

    Against the integral over the ring by SciPy, where 16 sectors are within 2e-4 of it.
    """
    one = dataclasses.replace(joint(), axial=Hertz(stiffness=1e9, exponent=exponent))
    tilt, ring = 1e-3, np.sqrt(0.5 * (0.01**2 + 0.012**2))
    depth = 2.0 * ring * np.sin(tilt) * part  # of the ring's deepest point

    def found(direction):
        q = pose(tilt=(tilt * np.cos(direction), tilt * np.sin(direction)))
        # Of the -z flange: the depth of the ring's deepest point is affine in the height.
        here = [one.evaluate(_at(q, z), REST).gap[3] for z in (0.0, 1e-4)]
        z = 1e-4 * (-depth - here[0]) / (here[1] - here[0])
        state = one.evaluate(_at(q, z), REST)
        assert state.gap[3] == pytest.approx(-depth, abs=1e-16)
        return state.normal_force[3]

    forces = [found(direction) for direction in np.linspace(0.1, 0.1 + 2.0 * np.pi, 24)]
    # Depths of 1e-6 m and more are differences of lengths of 1e-2 m.
    assert np.ptp(forces) < 1e-9 * np.mean(forces)
    amplitude = 2.0 * ring * np.sin(tilt)
    edge = 2.0 * np.arcsin(min(1.0, np.sqrt(depth / amplitude)))
    expected, _ = quad(
        lambda phi: max(depth - amplitude * np.sin(phi / 2) ** 2, 0.0) ** exponent, 0.0, edge, epsabs=0.0
    )
    assert np.mean(forces) == pytest.approx(1e9 * expected / np.pi, rel=2e-4)


def _at(q, z):
    return np.array([q[0], q[1], z, *q[3:]])


def test_line_of_action_of_a_loaded_edge_tends_to_the_points():
    """As the loaded length shrinks its centre of pressure moves to the bearing's end circle."""
    one = joint(strips=4096, exponent=1.5)
    tilt = 6e-3
    distances, expected = [], []
    axis = pin.exp3(np.array([0.0, tilt, 0.0]))[:, 2]
    for depth in (4e-6, 2e-6, 1e-6):
        # At the +z end the journal leans out by tilt L/2: there its gap is C_r - x - tilt L / 2.
        x = 2e-4 - tilt * 0.025 + depth
        f = force(one, pose(x=x, tilt=(0.0, tilt)))
        arm = f[4] / f[0]  # torque about the centre = z x force
        # Along the journal the edge lies higher by the tilt of the lever to the bore's side.
        distances.append(0.025 + (0.01 - x) * tilt - arm)
        # A load growing as depth^1.5 from nothing over the length depth / tilt acts 2/7 of it from the edge.
        expected.append(SHAPE.contacts([x, 0.0, 0.0], axis)[0].depth / tilt * 2 / 7)
    # Strips of 12 um against loaded lengths of 190 to 690 um.
    assert distances == pytest.approx(expected, rel=0.015, abs=0.0)


@pytest.mark.parametrize("seed", range(5))
def test_force_derives_from_the_energy(seed):
    """Elastic strips: the power of the generalized force is minus the rate of the stored energy."""
    rng = np.random.default_rng(seed)
    one = joint()
    q = pose(*(2.1e-4 * rng.standard_normal(2)), -2.2e-4, tilt=2e-3 * rng.standard_normal(2))
    v = np.concatenate([1e-3 * rng.standard_normal(3), 0.1 * rng.standard_normal(3)])

    def energy(t):
        placement = pin.XYZQUATToSE3(q) * pin.exp6(pin.Motion(v * t))
        here = one.evaluate(pin.SE3ToXYZQUAT(placement), v)
        assert (here.gap[2:] < 0.0).any() or (here.gap[:2] < 0.0).any()
        return one.stored_energy(pin.SE3ToXYZQUAT(placement))

    h = 1e-6
    rate = (energy(-2 * h) - 8 * energy(-h) + 8 * energy(h) - energy(2 * h)) / (12 * h)
    # Fourth-order differences of about 0.1 J: round-off 1e-17 / 1e-6, kinks where a strip comes in.
    assert force(one, q, v) @ v == pytest.approx(-rate, rel=1e-5, abs=1e-8)


@pytest.mark.parametrize("seed", range(8))
def test_coal_loads_the_same_strips_and_sectors(seed):
    rng = np.random.default_rng(seed)
    q = pose(
        *(2e-4 * rng.standard_normal(2)), 2.1e-4 * rng.choice([-1, 1]), tilt=3e-3 * rng.standard_normal(2)
    )
    v = np.concatenate([1e-3 * rng.standard_normal(3), 0.1 * rng.standard_normal(3)])
    friction = Tanh(coefficient_of_friction=0.2, transition_speed=1e-3)
    closed, coal = (joint(friction=friction, backend=b) for b in ("closed-form", "coal"))
    expected = force(closed, q, v)
    # 1e-17 m of depths of micrometres, normals to 1e-10.
    assert force(coal, q, v) == pytest.approx(expected, rel=1e-8, abs=1e-9 * np.abs(expected).max())
    assert coal.evaluate(q, v).gap == pytest.approx(closed.evaluate(q, v).gap, abs=1e-12)


@pytest.mark.parametrize(
    ("change", "part"),
    [
        ({"strips": 7}, "strips must be an even number of 2 or more, got 7"),
        ({"sectors": 2}, "sectors must be 3 or more, got 2"),
        ({"load": "line"}, "load must be point or distributed, got 'line'"),
    ],
)
def test_refusals(change, part):
    with pytest.raises(InvalidParameterError, match="joint 'j'") as caught:
        dataclasses.replace(joint(), **change)
    assert part in str(caught.value)
