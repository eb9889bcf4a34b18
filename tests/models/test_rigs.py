"""The small rigs under models/: what their READMEs promise, in closed form."""

import json
import math
import tomllib

import numpy as np
import pytest
from scipy.optimize import brentq

from antenna_pin import AntennaPinError, build_system, load_scenario, models_path, simulate
from antenna_pin.contact import hertz_stiffness

RIGS = ("impact_pair", "pendulum", "slider", "spherical_pendulum")
CASES = [
    (rig, case)
    for rig in RIGS
    for case in tomllib.loads((models_path() / rig / "scenario.toml").read_text())["cases"]
]
GRAVITY = 9.80665


def closed_form(rig, case, *overrides, duration=None):
    """A run with the gaps in closed form."""
    scenario = load_scenario(rig, case=case, overrides=overrides)
    joints = [f"clearance.{name}.geometry=closed-form" for name in scenario.clearance]
    return simulate(load_scenario(rig, case=case, overrides=[*overrides, *joints]), duration=duration)


def conservation(run):
    return json.loads(run.data.attrs["conservation"])


# --- all of them -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("rig", "case"), CASES)
def test_coal_and_closed_form_run_alike(rig, case):
    """Backends that agree to 3e-12 m: the same contacts, the same bodies' motion over several impacts."""
    runs = [simulate(load_scenario(rig, case=case), duration=0.02), closed_form(rig, case, duration=0.02)]
    for run in runs:
        assert run.completed, run.message
        # Of the energy that moves: some mJ. The integration's tolerance, 1e-10, over some hundred steps.
        assert conservation(run)["energy_error"] < 1e-10
    # A bore without eccentricity has no direction of least gap: coal's search stops 2.5 pm above it.
    assert runs[0].data.attrs["gap_difference"] < 1e-11
    if "episode" in runs[0].data.sizes:
        assert runs[0].data.sizes["episode"] == runs[1].data.sizes["episode"]
        np.testing.assert_allclose(runs[0].data["onset_time"], runs[1].data["onset_time"], atol=1e-8)
    # Impacts carry a difference of picometres into the speeds; to the bodies' own, some 10 mm/s.
    np.testing.assert_allclose(runs[0].data["v"].values[-1], runs[1].data["v"].values[-1], atol=1e-6)


# --- impact pair -------------------------------------------------------------------------------------------


def delivered(chi):
    """Restitution of a force f(depth) (1 + chi rate / approach speed)."""
    return brentq(lambda c: chi * (1 + c) - math.log((1 + chi) / (1 - chi * c)), 1e-6, 1 - 1e-12)


def pair(case, asked, masses, exponent, stiffness):
    overrides = [
        f"clearance.bore.normal.restitution={asked}",
        f"clearance.bore.normal.exponent={exponent}",
        f"clearance.bore.normal.stiffness={stiffness}",
        f"mechanism.links.ring.mass={masses[0]}",
        f"mechanism.links.disc.mass={masses[1]}",
    ]
    # One impact: flight 1 ms, contact below 1 ms, and at least 2 ms back across the play.
    return closed_form("impact_pair", case, *overrides, duration=3e-3)


# Every case meets every exponent, every exponent all masses, in ever other company.
MASSES = ((3.0, 2.0), (0.5, 5.0), (200.0, 1.0))
POWERS = ((1.0, 1e8), (1.5, 1e11), (2.0, 1e14))


@pytest.mark.parametrize(
    ("case", "asked", "exponent", "stiffness", "masses"),
    [
        (case, (0.4, 0.9)[(k + n) % 2], *power, MASSES[(k + n) % 3])
        for k, case in enumerate(["planar", "contact", "flange", "spherical"])
        for n, power in enumerate(POWERS)
    ],
)
def test_two_free_bodies_part_with_the_law_s_restitution(case, asked, exponent, stiffness, masses):
    """Whatever the masses, the stiffness and the exponent; depth, loss and momentum in closed form too."""
    run = pair(case, asked, masses, exponent, stiffness)
    chi = 0.75 * (1.0 - asked**2)
    restitution = delivered(chi)
    data = run.data
    first, last = (
        data["v"].values[k][data["coordinate"].str.startswith("bore.v").values] for k in (0, -1)
    )  # of the disc relative to the ring, in the ring's axes
    assert np.linalg.norm(first) == pytest.approx(0.1, rel=1e-12)
    # Integration at 1e-10 a step, some twenty steps.
    assert last == pytest.approx(-restitution * first, abs=1e-7 * restitution * 0.1)

    reduced = masses[0] * masses[1] / sum(masses)
    energy = 0.5 * reduced * 0.1**2
    lost = data["dissipation_normal"].values[-1].sum()
    assert lost == pytest.approx(energy * (1.0 - restitution**2), rel=1e-7)

    contacts = data.sizes["episode"]
    assert contacts == (2 if case == "contact" else 1)  # both ends of the bore, each with half the mass
    share = contacts * stiffness
    factor = 1.0 / chi - math.log(1.0 + chi) / chi**2
    depth = ((exponent + 1.0) * reduced * 0.1**2 / share * factor) ** (1.0 / (exponent + 1.0))
    assert data["peak_depth"].values == pytest.approx(np.full(contacts, depth), rel=1e-6)

    kept = conservation(run)
    assert kept["linear_momentum_drift"] < 1e-12 * masses[1] * 0.1  # round-off
    assert kept["angular_momentum_drift"] < 1e-12 * masses[1] * 0.1 * 0.01


def test_five_impacts_shrink_as_a_power():
    run = closed_form("impact_pair", "planar")
    speeds = run.data["approach_speed"].values
    assert speeds == pytest.approx(0.1 * delivered(0.75 * (1 - 0.7**2)) ** np.arange(5), rel=1e-7)


# --- pendulum ----------------------------------------------------------------------------------------------

BAR = 1.872 * GRAVITY  # weight [N]


def stiffness_of(rig, joint):
    """K that follows from materials and radii: (4/3) E* sqrt(R_i R_j / (R_i - R_j)) [N/m^1.5]."""
    scenario = load_scenario(rig)
    spec = scenario.clearance[joint]
    young, poisson = scenario.materials["steel"].young, scenario.materials["steel"].poisson
    modulus = young / (2.0 * (1.0 - poisson**2))
    ball = spec.bearing_radius - spec.radial_play
    expected = 4.0 / 3.0 * modulus * math.sqrt(spec.bearing_radius * ball / spec.radial_play)
    steel = scenario.material("steel")
    assert hertz_stiffness(spec.bearing_radius, ball, steel, steel) == pytest.approx(expected, rel=1e-12)
    return expected


def at_rest(run, weights, stiffness, tolerance=1e-6):
    """Assert that each touching contact carries its weight at the law's depth."""
    force, depth = (run.data[name].values[-1] for name in ("normal_force", "depth"))
    touching = run.data["touching"].values[-1] != 0
    assert np.count_nonzero(touching) == len(weights)
    assert force[touching] == pytest.approx(weights, rel=tolerance)
    expected = (np.asarray(weights) / stiffness) ** (2.0 / 3.0)
    assert depth[touching] == pytest.approx(expected, rel=tolerance)
    assert not force[~touching].any()
    assert run.data["friction_force"].values[-1] == pytest.approx(0.0, abs=1e-3 * max(weights))


@pytest.mark.parametrize("backend", ["coal", "closed-form"])
@pytest.mark.parametrize(("case", "contacts"), [("planar-rest", 1), ("rest", 2)])
def test_a_pendulum_laid_into_its_bore_sinks_to_the_static_depth(case, contacts, backend):
    """One contact carries the weight, or two ends half of it each: the mass centre is midway."""
    scenario = load_scenario("pendulum", case=case, overrides=[f"clearance.hinge.geometry={backend}"])
    run = simulate(scenario)
    at_rest(run, [BAR / contacts] * contacts, stiffness_of("pendulum", "hinge"))
    assert run.data["joint_force"].values[-1, 0] == pytest.approx([0.0, -BAR, 0.0], abs=1e-6 * BAR)


def test_a_planar_pendulum_let_go_at_ten_degrees_comes_to_rest():
    """Through a drop, bounces and a swing: the angle falls as exp(-6 t), and its square is in the load."""
    run = closed_form("pendulum", "planar")
    assert run.data.sizes["episode"] > 5
    at_rest(run, [BAR], stiffness_of("pendulum", "hinge"))
    assert float(run.data["motion_angle"].values[-1, 0]) == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("backend", ["coal", "closed-form"])
def test_a_pendulum_in_space_comes_to_rest_on_both_ends(backend):
    """Nothing holds it along the axis: where it stops the ends share the weight as a lever says."""
    overrides = [f"clearance.hinge.geometry={backend}"]
    run = simulate(load_scenario("pendulum", case="contact", overrides=overrides))
    assert run.data.sizes["episode"] > 20
    # The mass centre is in the journal's middle plane, z off that of the bearing.
    z = float(run.data["journal_position"].values[-1, 0, 2])
    assert abs(z) < 1e-4
    ends = BAR * np.array([0.5 + z / 0.050, 0.5 - z / 0.050])
    at_rest(run, ends, stiffness_of("pendulum", "hinge"))


@pytest.mark.parametrize("case", ["contact", "planar"])
def test_a_pendulum_loses_what_its_dampers_and_contacts_take(case):
    """All of the drop from ten degrees is gone in the end: gravity's loss is the sum of the sinks."""
    run = closed_form("pendulum", case)
    data = run.data
    fallen = float(data["gravity_energy"].values[0] - data["gravity_energy"].values[-1])
    lost = sum(
        float(data[name].values[-1].sum())
        for name in ("dissipation_normal", "dissipation_friction", "dissipation_damper")
    )
    left = float(data["kinetic_energy"].values[-1] + data["contact_energy"].values[-1])
    # It drops from an angle of 10 degrees and by the play (and the static depth).
    height = 0.2 * (1.0 - math.cos(math.radians(10.0))) + 1e-4
    assert fallen == pytest.approx(BAR * height, rel=1e-3)
    assert fallen == pytest.approx(lost + left, rel=1e-8)
    assert left < 1e-3 * fallen


# --- spherical pendulum ------------------------------------------------------------------------------------

LINK = 2.0 * GRAVITY


@pytest.mark.parametrize("backend", ["coal", "closed-form"])
def test_balls_laid_into_their_sockets_sink_to_the_static_depth(backend):
    """The upper joint carries both bars, the lower one a bar."""
    overrides = [f"clearance.{joint}.geometry={backend}" for joint in ("upper", "lower")]
    run = simulate(load_scenario("spherical_pendulum", case="rest", overrides=overrides))
    at_rest(run, [2.0 * LINK, LINK], stiffness_of("spherical_pendulum", "upper"))
    forces = run.data["joint_force"].values[-1]
    assert forces == pytest.approx(np.array([[0, 0, 2.0 * LINK], [0, 0, LINK]]), abs=1e-6 * LINK)


def test_a_double_pendulum_comes_to_rest():
    """Through drops, bounces and six seconds of swinging that friction in the sockets takes."""
    run = closed_form("spherical_pendulum", "swing")
    assert run.data.sizes["episode"] > 10
    at_rest(run, [2.0 * LINK, LINK], stiffness_of("spherical_pendulum", "upper"))
    # Hanging straight again, to what is left of the swinging.
    assert run.data["journal_position"].values[-1, :, :2] == pytest.approx(np.zeros((2, 2)), abs=1e-7)


def test_a_spatial_swing_keeps_its_energy_ledger():
    run = closed_form("spherical_pendulum", "spatial")
    data = run.data
    start = float((data["kinetic_energy"] + data["gravity_energy"]).values[0])
    lost = float((data["dissipation_normal"] + data["dissipation_friction"]).values[-1].sum())
    assert lost > 0.01
    stored = sum(
        float(data[name].values[-1]) for name in ("kinetic_energy", "gravity_energy", "contact_energy")
    )
    assert start == pytest.approx(stored + lost, abs=1e-9 * lost + 1e-10)
    # Losses only ever grow: contacts give nothing back (in sum with friction at every contact).
    for name in ("dissipation_normal", "dissipation_friction"):
        assert np.diff(data[name].values, axis=0).min() > -1e-12


@pytest.mark.parametrize("backend", ["coal", "closed-form"])
def test_a_floating_double_pendulum_keeps_its_momenta(backend):
    overrides = [f"clearance.{joint}.geometry={backend}" for joint in ("upper", "lower")]
    run = simulate(load_scenario("spherical_pendulum", case="floating", overrides=overrides), duration=0.5)
    assert run.data.sizes["episode"] > 20
    kept = conservation(run)
    assert kept["linear_momentum_drift_relative"] < 1e-11
    assert kept["angular_momentum_drift_relative"] < 1e-11
    assert kept["energy_error"] < 1e-9 * float(run.data["kinetic_energy"].values[0])
    momentum = run.data["linear_momentum"].values
    assert np.linalg.norm(momentum[0]) > 0.01
    lost = float((run.data["dissipation_normal"] + run.data["dissipation_friction"]).values[-1].sum())
    fallen = float((run.data["kinetic_energy"] + run.data["contact_energy"]).diff("time").sum())
    assert lost == pytest.approx(-fallen, rel=1e-7)


def test_a_hinge_may_be_made_a_ball_joint():
    """Written as continuous (impact_pair) or as floating (here): the same joint in the end."""
    system = build_system(load_scenario("impact_pair", case="spherical"))
    other = build_system(load_scenario("spherical_pendulum", case="rest"))
    assert system.mechanism.joint("bore").kind == other.mechanism.joint("upper").kind == "floating"
    assert system.contact_names == ("bore.spherical",)
    assert other.contact_names == ("upper.spherical", "lower.spherical")


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("clearance.upper.socket_radius=0.01", "clearance.upper.socket_radius is unknown"),
        (
            "clearance.upper.load=distributed",
            "load must be point where the joint is not one of journal, bore and flanges",
        ),
        ("springs.upper.damping=0.1", "joint 'upper' is spherical and has no axis to act about"),
        ("clearance.upper.model=planar", "must be revolute or continuous in the URDF, got floating"),
    ],
)
def test_what_a_ball_joint_cannot_have_is_refused(override, said):
    with pytest.raises(AntennaPinError, match=said):
        build_system(load_scenario("spherical_pendulum", case="rest", overrides=[override]))


# --- slider ------------------------------------------------------------------------------------------------


WEIGHT, CORNERS, AHEAD = 1.248 * GRAVITY, 0.096, 0.010


def test_a_slider_rests_on_four_corners():
    """Statics: the corners in front and behind share the weight by lever; each depth is Hertz' of a ball."""
    run = closed_form("slider", "rest")
    last = run.data.isel(time=-1)
    loaded = last["touching"].values != 0
    ends = last["contact_end"].values[loaded]
    assert sorted(ends) == ["+x+y+z", "+x+y-z", "+x-y+z", "+x-y-z"]
    modulus = 207e9 / (1.0 - 0.3**2) / 2.0
    stiffness = 4.0 / 3.0 * modulus * math.sqrt(0.002)
    for end, force, depth in zip(
        ends, last["normal_force"].values[loaded], last["depth"].values[loaded], strict=True
    ):
        share = 0.25 + (0.5 if end.endswith("+z") else -0.5) * AHEAD / CORNERS
        # What is left of the motion after 0.1 s; the tilt of 2e-6 rad moves the levers by less than 1e-6.
        assert force == pytest.approx(share * WEIGHT, rel=1e-6)
        assert depth == pytest.approx((share * WEIGHT / stiffness) ** (2.0 / 3.0), rel=1e-6)


def test_a_driven_slider_accelerates_against_friction():
    for case, resistance in (("driven", 0.1 * WEIGHT), ("ideal", 0.0)):
        run = closed_form("slider", case)
        late = run.data["slide_acceleration"].values[run.data["time"].values > 0.4, 0]
        # At 0.9 m/s tanh is one to round-off; the last bounces have died away to 1e-8 of the acceleration.
        assert late == pytest.approx(np.full(late.size, (4.0 - resistance) / 1.248), rel=1e-7)
        assert conservation(run)["energy_error"] < 1e-10


def test_a_slider_weighs_on_both_walls_of_a_rolled_guide():
    """Turned by 30 degrees about its axis, its floor and its side share the weight as cosine and sine."""
    # The guide turns with its slider: the section's x now points to 30 degrees off the vertical.
    run = closed_form(
        "slider",
        "rest",
        "clearance.slide.roll=30 deg",
        "initial.joints.slide.journal_position=[1e-7, -1e-7, 0]",
        duration=0.3,
    )
    last = run.data.isel(time=-1)
    by_wall = {
        wall: sum(
            float(force)
            for force, end in zip(last["normal_force"].values, last["contact_end"].values, strict=True)
            if end.startswith(wall)
        )
        for wall in ("+x", "-x", "+y", "-y")
    }
    assert by_wall["-x"] == by_wall["+y"] == 0.0
    # Of the sinking's motion after 0.3 s.
    assert by_wall["+x"] == pytest.approx(WEIGHT * math.cos(math.radians(30.0)), rel=1e-6)
    assert by_wall["-y"] == pytest.approx(WEIGHT * math.sin(math.radians(30.0)), rel=1e-6)
