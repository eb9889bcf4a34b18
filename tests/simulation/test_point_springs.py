"""Springs and dampers between points in runs: closed forms, ledgers, events; loops in maximal coordinates."""

import dataclasses
import math

import numpy as np
import pytest
from maximal import Maximal
from maximal_parts import Side, Spring
from scipy.spatial.transform import Rotation
from single_loops import spatial_slider_crank

from antenna_pin import RunSettings, System, Urdf, build_mechanism, load_scenario, simulate
from antenna_pin.analysis import body_poses, joint_loads
from antenna_pin.dynamics import PointSpring
from antenna_pin.errors import AntennaPinError

TIGHT = RunSettings(rtol=1e-12, output_rate=50.0)

MASSES = """<robot name="masses">
  <link name="one"><inertial><origin xyz="0 0.1 0"/><mass value="3"/>
    <inertia ixx="0.2" iyy="0.3" izz="0.4" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="one"/><child link="two"/>
    <origin xyz="0.5 0.1 0"/><axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
  <link name="two"><inertial><mass value="2"/>
    <inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""
MASS = 3.0 * 2.0 / 5.0  # reduced [kg]


def two_masses(base="free", **numbers):
    """Two bodies on a guide; a spring from one's mass centre to the other's, 0.5 m + the guide's way."""
    mechanism = build_mechanism(Urdf.from_text(MASSES, "masses.urdf"), base)
    ends = {"first": ("one", (0.0, 0.1, 0.0)), "second": ("two", (0.0, 0.0, 0.0))}
    return System(mechanism, springs={"coil": PointSpring(**{**ends, **numbers})})


def damped(time, start, stiffness, damping):
    """A way that is let go, of the reduced mass."""
    decay = 0.5 * damping / MASS
    omega = math.sqrt(stiffness / MASS - decay**2)
    return start * np.exp(-decay * time) * (np.cos(omega * time) + decay / omega * np.sin(omega * time))


@pytest.mark.parametrize("damping", [0.0, 2.5])
def test_two_masses_swing_about_their_centre(damping):
    """The damped oscillator of their reduced mass; momentum is nobody's but theirs, and none."""
    system = two_masses(free_length=0.4, stiffness=40.0, damping=damping)
    q = system.neutral()
    q[system.mechanism.joint("slide").q] = 0.2
    run = simulate(system, duration=2.0, q=q, v=np.zeros(system.model.nv), settings=TIGHT)
    data = run.data
    stretch = damped(data["time"].values, 0.3, 40.0, damping)
    length = data["spring_length"].sel(point_spring="coil").values
    # The run's tolerance over some 2 pi of phase a second.
    np.testing.assert_allclose(length, 0.4 + stretch, rtol=0, atol=1e-11)
    tension = data["spring_tension"].sel(point_spring="coil").values
    if not damping:
        np.testing.assert_allclose(tension, 40.0 * stretch, rtol=0, atol=1e-9)
        np.testing.assert_allclose(data["spring_energy"], 20.0 * stretch**2, rtol=0, atol=1e-10)
    force = data["spring_force"].sel(point_spring="coil").values
    np.testing.assert_allclose(force, -tension[:, None] * [1.0, 0.0, 0.0], rtol=0, atol=1e-11)
    acceleration = data["slide_acceleration"].sel(sliding_joint="slide").values
    # Newton's law for the way, of the same state: round-off.
    np.testing.assert_allclose(MASS * acceleration, -tension, rtol=0, atol=1e-12)
    # Momentum: round-off of 2 kg m/s, over some hundred steps.
    assert np.abs(data["linear_momentum"]).max() < 1e-13
    assert np.abs(data["angular_momentum"]).max() < 1e-13
    lost = data["dissipation_damper"].sel(spring="coil").values
    stored = data["kinetic_energy"].values + data["spring_energy"].values
    np.testing.assert_allclose(stored + lost, 0.5 * 40.0 * 0.3**2, rtol=0, atol=1e-11)
    assert (lost[-1] > 1.0) == (damping > 0.0)
    assert data["total_damper_loss"].values == lost[-1]
    assert list(data["spring"].values) == list(data["point_spring"].values) == ["coil"]


def test_points_that_coincide_at_the_start():
    """A compressed spring there has no direction; one without free length has no need of one."""
    system = two_masses("fixed", free_length=0.1, stiffness=40.0)
    rule = r"spring 'coil': length at the start must be above zero, or its force has no direction; .* got 0 m"
    with pytest.raises(AntennaPinError, match=rule):
        simulate(system, duration=0.1, q=[-0.5], v=[0.0])
    system = two_masses("fixed", free_length=0.0, stiffness=40.0)
    assert (simulate(system, duration=0.1, q=[-0.5], v=[0.0]).data["slide_position"] == -0.5).all()


# --- in a loop ----------------------------------------------------------------------------------------------

SPRINGS = (
    Spring(first=Side("world", (0.1, -0.2, 0.3)), second=Side("rod", (-0.15, 0.02, 0.01)),
           length=0.15, stiffness=60.0, damping=0.8),
    Spring(first=Side("slider", (0.02, 0.0, 0.05)), second=Side("crank", (0.0, 0.01, 0.03)),
           length=0.3, stiffness=90.0),
)  # fmt: skip


def table(side):
    return f'{{ link = "{side.body}", point = {list(side.point)} }}'


@pytest.fixture(scope="module")
def loop(tmp_path_factory):
    """The spatial slider-crank with two springs, by the package and in maximal coordinates."""
    made = spatial_slider_crank()
    system = Maximal(made.system.bodies, made.system.joints, springs=SPRINGS, gravity=made.system.gravity)
    folder = tmp_path_factory.mktemp("sprung")
    (folder / "loop.urdf").write_text(made.urdf)
    springs = "".join(
        f"[springs.s{k}]\nfirst = {table(one.first)}\nsecond = {table(one.second)}\n"
        f"free_length = {one.length}\nstiffness = {one.stiffness}\ndamping = {one.damping}\n"
        for k, one in enumerate(SPRINGS)
    )
    (folder / "scenario.toml").write_text(made.scenario + springs)
    run = simulate(load_scenario(folder / "scenario.toml"), duration=0.5)
    return dataclasses.replace(made, system=system), run, system.run(run.data["time"].values, made.start)


def test_springs_in_a_loop_do_as_in_maximal_coordinates(loop):
    """Both integrate to 1e-12 relative; over half a second 1e-9 is left at most in either."""
    _, run, reference = loop
    poses = body_poses(run)
    for body in reference.system.bodies:
        at = {"body": body}
        turn = Rotation.from_quat(poses["attitude"].sel(at).values).as_matrix()
        np.testing.assert_allclose(poses["position"].sel(at), reference.position(body), atol=1e-8, rtol=0)
        np.testing.assert_allclose(turn, reference.rotation(body), atol=1e-8, rtol=0)
    assert np.ptp(reference.position("slider"), axis=0).max() > 0.05
    data = run.data
    stored = data["kinetic_energy"] + data["gravity_energy"] + data["spring_energy"]
    energy = reference.energy()
    np.testing.assert_allclose(stored - stored[0], energy - energy[0], rtol=0, atol=1e-8)
    assert data["energy_error"].values == pytest.approx(0.0, abs=1e-10)
    assert data["dissipation_damper"].values[-1, 0] > 1e-2
    assert list(data["spring"].values) == ["s0", "s1"]


def test_joints_of_a_loop_carry_what_springs_leave_them(loop):
    """Loads of every joint of the tree and of the closure, springs taken out of what moves the bodies."""
    made, run, reference = loop
    loads = joint_loads(run)
    assert list(loads["moving_joint"].values) == ["guide", "pivot", "ball", "cross"]
    for name, joint in made.system.joints.items():
        first = joint.first.body
        turn = np.eye(3) if first == "world" else reference.rotation(first)
        force, moment = (
            (turn @ joint.first.frame @ part[..., None])[..., 0] for part in reference.load(name)
        )
        size = np.abs(force).max()
        # Reactions follow from a motion that agrees to 1e-8 or better.
        np.testing.assert_allclose(loads["force"].sel(moving_joint=name), force, rtol=0, atol=1e-8 * size)
        np.testing.assert_allclose(loads["torque"].sel(moving_joint=name), moment, rtol=0, atol=1e-8 * size)


# --- in a scenario ------------------------------------------------------------------------------------------

SCENARIO = """
format = 1
duration = "0.2 s"
[mechanism]
urdf = "masses.urdf"
base = "free"
[springs.coil]
first = { frame = "one" }
second = { link = "two", point = ["0 mm", 0, 0] }
free_length = "40 cm"
stiffness = "2 N/mm"
[events.cut]
kind = "time"
time = "0.1 s"
action = "set"
set = "springs.coil.free_length"
to = "30 cm"
"""


@pytest.fixture
def written(tmp_path):
    (tmp_path / "masses.urdf").write_text(MASSES)
    (tmp_path / "scenario.toml").write_text(SCENARIO)

    def load(*overrides):
        return load_scenario(tmp_path / "scenario.toml", overrides=overrides)

    return load


def test_a_scenario_says_where_its_springs_are(written):
    run = simulate(written())
    again = simulate(written("springs.coil.first={link = 'one', point = [0, 0, 0], replace = true}"))
    assert np.array_equal(run.data["q"].values, again.data["q"].values)
    coil = run.scenario.springs["coil"]
    assert (coil.free_length, coil.stiffness, coil.damping) == (0.4, 2000.0, 0.0)
    assert run.data["event_energy"].values[0] != 0.0
    assert type(run.scenario).model_validate_json(run.scenario.model_dump_json()) == run.scenario
    assert coil.build().words().replace("\N{NO-BREAK SPACE}", " ") == (
        "from one to two, free length 0.4 m, stiffness 2000 N/m"
    )


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("springs.coil.joint=slide", "springs.coil.joint must be left out with first and second; a spring"),
        (
            "springs.coil.stiffness=0",
            "springs.coil must have a stiffness or a damping above zero, got neither",
        ),
        (
            "springs.coil.first.frame=oen",
            "springs.coil.first.frame: frame 'oen' is unknown; did you mean one?",
        ),
        ("springs.coil.second.link=one", "spring 'coil': its links 'one' and 'one' are one body, body 'one'"),
        ("springs.coil.first.point=[0, 0, 0]", "springs.coil.first.point must be left out with frame"),
        (
            "springs.coil.second={frame = 'one', replace = true}",
            "springs.coil.second.frame must be on another",
        ),
    ],
)
def test_what_is_refused_says_where(written, override, message):
    with pytest.raises(AntennaPinError) as caught:
        simulate(written(override))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
