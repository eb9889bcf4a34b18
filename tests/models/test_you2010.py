"""The satellite of You, Pan and Zhao 2010: its table, its motion by other equations, and its first impact."""

import importlib
import json
import math
import runpy
import sys
import tomllib
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from antenna_pin import build_system, load_scenario, models_path, simulate
from antenna_pin.analysis import joint_loads
from antenna_pin.contact import hertz_stiffness
from antenna_pin.errors import MechanismError, NotSimulatedWarning
from antenna_pin.scenario.assemble import urdf_variant

ROOT = Path(__file__).resolve().parents[2]
FOLDER = models_path() / "you2010"
CASES = tomllib.loads((FOLDER / "scenario.toml").read_text())["cases"]
CLOSED_FORM = "clearance.joint2.geometry=closed-form"

# Table 1: mass and moments; the body's printed Ixx of 1000 is impossible.
TABLE_1 = {
    "body": (1000.0, (100.0, 100.0, 100.0)),
    "shaft1": (10.0, (1.0, 1.0, 0.1)),
    "shaft2": (50.0, (0.5, 5.0, 5.0)),
}
PLAY, RESTITUTION = 0.5e-3, 0.95
INTERNAL, EXTERNAL = 5.418e10, 8.676e9  # N/m^1.5


def scenario(case, *overrides):
    return load_scenario("you2010", case=case, overrides=[CLOSED_FORM, *overrides])


# --- the numbers of the paper ------------------------------------------------------------------------------


@pytest.mark.parametrize("case", ["planar", "gimbal"])
@pytest.mark.parametrize("link", TABLE_1)
def test_masses_and_inertias_are_those_of_table_1(case, link):
    mass, moments = TABLE_1[link]
    inertial = urdf_variant(scenario(case)).link(link).inertial
    assert inertial.mass == mass
    assert inertial.inertia.tolist() == np.diag(moments).tolist()


@pytest.mark.parametrize(
    ("case", "joint1", "joint2", "axis2", "centres"),
    [
        ("ideal", (0.5, 0, 0), (1.5, 0, 0), (0, 0, 1), ((0, 0, 0), (1, 0, 0), (2, 0, 0))),
        ("gimbal-ideal", (0, 0, 0.5), (0, 0, 1.5), (0, -1, 0), ((0, 0, 0), (0, 0, 1), (0.5, 0, 1.5))),
    ],
)
def test_the_layout(case, joint1, joint2, axis2, centres):
    """a = b = 0.5 m: every mass centre is half a metre from its joints, along the arm or up it."""
    system = build_system(scenario(case))
    mechanism, data = system.mechanism, system.model.createData()
    pin.framesForwardKinematics(system.model, data, system.neutral())
    for name, place in (("joint1", joint1), ("joint2", joint2)):
        assert np.allclose(data.oMi[mechanism.joint(name).joint_id].translation, place, atol=1e-15)
    placement = data.oMi[mechanism.joint("joint2").joint_id]
    assert np.allclose(placement.rotation @ mechanism.joint("joint2").axis, axis2, atol=1e-15)
    for link, centre in zip(TABLE_1, centres, strict=True):
        origin = urdf_variant(scenario(case)).link(link).inertial.origin
        local = np.zeros(3) if origin is None else origin[:3, 3]
        assert np.allclose(data.oMf[mechanism.frame(link)].act(local), centre, atol=1e-15)


def test_the_joint_has_the_paper_s_play_and_materials():
    """Stiffness of equation (11) with R1 R2 / (R1 - R2), and as printed with the sum."""
    spec = scenario("planar").clearance["joint2"]
    assert spec.radial_play == pytest.approx(PLAY, rel=1e-12)
    (joint,) = build_system(scenario("planar")).clearances
    (printed,) = build_system(scenario("planar-external")).clearances
    h = [(1 - nu**2) / (math.pi * young) for young, nu in ((166e9, 0.28), (177e9, 0.29))]
    for law, radius in (
        (joint.radial, 10e-3 * 9.5e-3 / (10e-3 - 9.5e-3)),
        (printed.radial, 10e-3 * 9.5e-3 / (10e-3 + 9.5e-3)),
    ):
        # The printed form is given to four digits in the scenario.
        assert law.stiffness == pytest.approx(4 * math.sqrt(radius) / (3 * math.pi * sum(h)), rel=1e-4)
    steel = [scenario("planar").material(name) for name in ("bearing", "journal")]
    assert joint.radial.stiffness == pytest.approx(hertz_stiffness(10e-3, 9.5e-3, *steel), rel=1e-12)
    assert joint.radial.stiffness == pytest.approx(INTERNAL, rel=1e-4)
    assert printed.radial.stiffness == EXTERNAL
    assert (joint.friction.coefficient_of_friction, joint.radial.restitution) == (0.25, RESTITUTION)


def test_the_printed_inertia_is_said_but_by_name():
    override = "mechanism.links.body.inertia=[1000, 100, 100]"
    with pytest.warns(NotSimulatedWarning, match="'body': the largest principal moment of inertia exceeds"):
        build_system(scenario("planar", override))
    with pytest.raises(MechanismError, match="the largest principal moment of inertia exceeds"):
        build_system(scenario("planar", override, "mechanism.strict=true"))
    body = build_system(scenario("printed-inertia")).model.inertias[1]
    assert np.diag(body.inertia).tolist() == [1000.0, 100.0, 100.0]


def test_the_printed_inertia_does_not_enter_planar_motion():
    """The body turns about z only: its Ixx multiplies zero."""
    runs = [simulate(scenario(case), duration=0.1) for case in ("planar", "printed-inertia")]
    assert runs[0].data.sizes["episode"] == runs[1].data.sizes["episode"] > 1
    np.testing.assert_allclose(runs[0].data["v"], runs[1].data["v"], rtol=0.0, atol=1e-12)


def test_shaft_1_upright_on_parallel_axes_would_spin_up():
    """The third reading of the text: both axes on one line, and nothing holds shaft 1 but its 0.1 kg m^2."""
    upright = (
        "mechanism.joints.joint1.origin_xyz=[0, 0, 0.5]",
        "mechanism.joints.joint2.origin_xyz=[0, 0, 1]",
        "mechanism.links.shaft1.centre_of_mass=[0, 0, 0.5]",
    )
    run = simulate(scenario("ideal", *upright), duration=0.01)
    # In the world; the body turns by -tau1 / 100.
    acceleration = run.data["motion_acceleration"].sel(joint="joint1")[0] - 5.0 / 100.0
    assert float(acceleration) == pytest.approx((5.0 - 10.0) / 0.1, rel=0.02)


def test_what_is_drawn_has_the_scenario_s_dimensions():
    for case in ("3d", "gimbal-3d"):
        spec, urdf = scenario(case).clearance["joint2"], urdf_variant(scenario(case))
        drawn = {
            shape.name: (shape.geometry.cylinder.radius, shape.geometry.cylinder.length)
            for link in ("shaft1", "shaft2")
            for shape in urdf.link(link).visuals
            if shape.geometry.cylinder
        }
        assert drawn["bearing"] == (spec.bearing_outer_radius, spec.bearing_length)
        faces = spec.bearing_length + 2 * spec.axial_play
        assert drawn["journal"] == pytest.approx((spec.bearing_radius - spec.radial_play, faces), abs=1e-12)
        assert drawn["flange_upper"][0] == spec.flange_radius
        for link in TABLE_1:
            named = {shape.name: shape for shape in urdf.link(link).visuals}
            for shape in urdf.link(link).collisions:  # each solid shape is drawn as it is
                assert shape.geometry == named[shape.name].geometry


def test_the_script_writes_the_mesh_that_is_shipped(tmp_path, monkeypatch):
    command = next(
        line for line in (FOLDER / "README.md").read_text().splitlines() if "make_dish.py --" in line
    )
    options = [*command.split("make_dish.py ")[1].strip("` ").split(" --out")[0].split()]
    monkeypatch.setattr(sys, "argv", ["make_dish.py", *options, "--out", str(tmp_path / "dish.obj")])
    runpy.run_path(str(ROOT / "scripts" / "make_dish.py"), run_name="__main__")
    assert (tmp_path / "dish.obj").read_bytes() == (FOLDER / "dish.obj").read_bytes()


def test_the_urdfs_say_where_each_number_comes_from():
    for name in ("antenna.urdf", "gimbal.urdf"):
        lines = (FOLDER / name).read_text().splitlines()
        numbers = [line for line in lines if any(tag in line for tag in ("<mass ", "<inertia ", "<axis "))]
        assert len(numbers) == 8
        assert all("<!-- Table" in line or "<!-- text" in line for line in numbers)


# --- the ideal satellite, by other equations ---------------------------------------------------------------

MASS = np.repeat([1000.0, 10.0, 50.0], 3).reshape(3, 3)
MASS[:, 2] = (100.0, 0.1, 5.0)
# Where each joint sits on the two bodies that it joins, from their mass centres, along their x [m].
ANCHORS = {0: (0, 0.5, 1, -0.5), 1: (1, 0.5, 2, -0.5)}


def bodies_apart(t, state, torques=(5.0, 10.0), joints=(0, 1)):
    """Accelerations of x, y and angle of the three bodies, and the joints' forces on the outer bodies.

    Newton and Euler for each body in the plane, the joints as constraints with multipliers.
    """
    x, v = state[:9].reshape(3, 3), state[9:].reshape(3, 3)
    along = np.stack([np.cos(x[:, 2]), np.sin(x[:, 2])], axis=1)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    force = np.zeros((3, 3))
    force[:, 2] = (-torques[0], torques[0] - torques[1], torques[1])
    jacobian, right = np.zeros((2 * len(joints), 3, 3)), np.zeros(2 * len(joints))
    for row, joint in enumerate(joints):
        inner, a, outer, b = ANCHORS[joint]
        rows = slice(2 * row, 2 * row + 2)
        for body, arm, sign in ((outer, b, 1.0), (inner, a, -1.0)):
            jacobian[rows, body, :2] = sign * np.eye(2)
            jacobian[rows, body, 2] = sign * arm * across[body]
            right[rows] += sign * arm * along[body] * v[body, 2] ** 2
    flat = jacobian.reshape(-1, 9)
    weighted = flat / MASS.ravel()
    free = force.ravel() / MASS.ravel()
    multipliers = np.linalg.solve(weighted @ flat.T, right - flat @ free)
    return (free + weighted.T @ multipliers).reshape(3, 3), multipliers.reshape(-1, 2)


def start():
    state = np.zeros(18)
    state[[0, 3, 6]] = (0.0, 1.0, 2.0)  # centres of body, shaft 1, shaft 2
    return state


@pytest.fixture(scope="module")
def ideal():
    return simulate(scenario("ideal"), duration=2.0)


def test_the_ideal_satellite_moves_as_by_newton_euler_and_multipliers(ideal):
    """Nine coordinates and four constraints by SciPy against Pinocchio's tree."""

    def rates(t, state):
        return np.concatenate([state[9:], bodies_apart(t, state)[0].ravel()])

    times = np.arange(0.0, 2.01, 0.25)
    found = solve_ivp(rates, (0.0, 2.0), start(), "DOP853", times, rtol=1e-11, atol=1e-13).y.T
    data = ideal.data.sel(time=times)
    angles = found[:, [2, 5, 8]]
    # Two integrations at 1e-8 and 1e-11 a step; the constraints drift by the latter.
    assert data["motion_angle"].values == pytest.approx(np.diff(angles, axis=1), abs=1e-7)
    assert data["base_position"].values[:, :2] == pytest.approx(found[:, :2], abs=1e-8)
    assert data["motion_rate"].values == pytest.approx(np.diff(found[:, [11, 14, 17]], axis=1), abs=1e-7)


@pytest.mark.parametrize(
    ("case", "impacts"), [("ideal", 0), ("planar", 10), ("gimbal-ideal", 0), ("gimbal", 5), ("gimbal-3d", 5)]
)
def test_the_mass_centre_stays_and_nothing_turns_about_it(case, impacts):
    """From rest, by torques between the bodies alone; the energy is what the motors put in."""
    run = simulate(scenario(case), duration=0.4)
    assert run.completed
    assert run.data.sizes.get("episode", 0) >= impacts
    kept = json.loads(run.data.attrs["conservation"])
    assert kept["linear_momentum_drift_relative"] < 1e-9  # some thousand steps at 1e-8
    assert kept["angular_momentum_drift_relative"] < 1e-9
    assert kept["energy_error_relative"] < 1e-7


def test_the_constraint_and_the_tree_agree(ideal):
    run = simulate(scenario("ideal-constraint"), duration=0.5)
    angles = ideal.data["motion_angle"].sel(time=run.data["time"]).values
    assert run.data["motion_angle"].values == pytest.approx(angles, abs=1e-9)


# --- the first impact --------------------------------------------------------------------------------------


def damped_over_elastic(restitution):
    """Largest force of an impact under Lankarani and Nikravesh's damping over that of Hertz alone.

    With u the speed over the approach speed, m v dv = -K d^1.5 (1 + chi u) dd gives
    d^2.5 = 2.5 m v0^2 / K * G(u), G the integral of s / (1 + chi s) from u to 1.
    """
    chi = 0.75 * (1.0 - restitution**2)

    def force(u):
        g = (1.0 - u) / chi - math.log((1.0 + chi) / (1.0 + chi * u)) / chi**2
        return (2.0 * g) ** 0.6 * (1.0 + chi * u)

    best = minimize_scalar(lambda u: -force(u), bounds=(0.0, 0.9), method="bounded")
    return -float(best.fun)


def first_impact(stiffness, force, play=PLAY):
    """Peak force [N]: crossing the play under the ideal joint's force, then Hertz with damping.

    Centred parts at rest gain force times play. The journal's speed and mass do not matter apart.
    """
    return damped_over_elastic(RESTITUTION) * stiffness**0.4 * (2.5 * force * play) ** 0.6


@pytest.mark.parametrize(("case", "stiffness"), [("planar", INTERNAL), ("planar-external", EXTERNAL)])
def test_the_first_impact_is_that_of_hertz_after_crossing_the_play(case, stiffness):
    run = simulate(scenario(case), duration=0.04)
    first = run.data.isel(episode=0)
    apart, _ = bodies_apart(0.0, start(), joints=(0,))
    _, held = bodies_apart(0.0, start())
    # Joint 2 open: its two anchors part across the arm.
    acceleration = (apart[2, 1] - 0.5 * apart[2, 2]) - (apart[1, 1] + 0.5 * apart[1, 2])
    assert held[1, 0] == pytest.approx(0.0, abs=1e-12)
    force = abs(held[1, 1])
    # While they cross, the shafts turn by 1e-3 rad and by v^2 a centripetal acceleration of 2e-3 of the other
    # grows: second order in the direction, 1e-3 and below in the path.
    speed = math.sqrt(2.0 * abs(acceleration) * PLAY)
    assert float(first["approach_speed"]) == pytest.approx(speed, rel=1e-3)
    assert float(first["onset_time"]) == pytest.approx(speed / abs(acceleration), rel=1e-3)
    expected = first_impact(stiffness, force)
    # The load goes on working over the depth, 1 and 2 % of the play. Friction at the bore's surface, 10 mm
    # beside the centre, acts back on the normal motion by 0.4 %.
    expected *= (1.0 + float(first["peak_depth"]) / PLAY) ** 0.6
    assert float(first["peak_force"]) == pytest.approx(expected, rel=4e-3)


@pytest.mark.parametrize(("case", "ideal"), [("planar", "ideal"), ("gimbal", "gimbal-ideal")])
def test_the_bench_s_estimate_holds_in_both_layouts(case, ideal, monkeypatch):
    """Its ideal force is that of inverse dynamics, and the first impact follows."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "bench"))
    estimate = importlib.import_module("first_impact").first_impact
    system = build_system(scenario(case))
    expected = estimate(system, PLAY, system.clearances[0].radial.stiffness, RESTITUTION)
    held = simulate(scenario(ideal), duration=0.001)
    load = joint_loads(held)["force"].sel(moving_joint="joint2")[0].values
    axis = np.array([0.0, 0.0, 1.0] if case == "planar" else [0.0, -1.0, 0.0])
    # Bearing axes at zero angles are the world's but for a turn: compare what is across the axis.
    across = np.linalg.norm(load - (load @ axis) * axis)
    assert np.linalg.norm(expected.ideal_force) == pytest.approx(across, rel=1e-9)
    first = simulate(scenario(case), duration=0.04).data.isel(episode=0)
    assert float(first["approach_speed"]) == pytest.approx(expected.approach_speed, rel=1e-3)
    assert float(first["peak_force"]) == pytest.approx(expected.peak_force, rel=4e-3)  # friction, as above


# --- the joint in space ------------------------------------------------------------------------------------


def test_the_joint_in_space_with_half_the_stiffness_at_each_end_moves_as_the_planar_one():
    """By symmetry both ends of the bore meet the journal at once, each with half the force."""
    planar = simulate(scenario("planar"), duration=0.2)
    space = simulate(scenario("3d", f"clearance.joint2.normal.stiffness={INTERNAL / 2}"), duration=0.2)
    onsets = planar.data["onset_time"].values
    assert len(onsets) > 3
    for end in (0, 1):
        one = space.data.isel(episode=space.data["episode_contact"].values == end)
        # K is given to four digits; a few impacts, each doubling or so what differs before it.
        np.testing.assert_allclose(one["onset_time"], onsets, rtol=1e-4)
        np.testing.assert_allclose(2 * one["peak_force"], planar.data["peak_force"], rtol=2e-3)
    assert float(np.abs(space.data["journal_tilt"]).max()) < 1e-9
    assert set(np.unique(space.data["episode_contact"])) == {0, 1}  # no flange


def test_off_the_plane_of_the_mass_centres_it_tilts():
    """The two ends then take unequal shares; without the offset the tilt stays round-off."""
    run = simulate(scenario("3d-offset"), duration=0.3)
    assert float(np.abs(run.data["journal_tilt"]).max()) > 1e-5
    kept = json.loads(run.data.attrs["conservation"])
    assert kept["angular_momentum_drift_relative"] < 1e-8  # some thousand steps at 1e-8
    assert kept["energy_error_relative"] < 1e-6
