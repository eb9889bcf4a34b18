"""The slider-crank: closed forms of the ideal mechanism by Newton and Euler, and its runs against them."""

import json
import math
import tomllib
from dataclasses import dataclass

import numpy as np
import pytest
from closure_force import force_of_closure

from antenna_pin import load_scenario, models_path, simulate
from antenna_pin.analysis import body_motion, joint_loads
from antenna_pin.contact import hertz_stiffness, point_stiffness
from antenna_pin.mechanism import Urdf, build_mechanism

FOLDER = models_path() / "slider_crank"
SCENARIO = tomllib.loads((FOLDER / "scenario.toml").read_text())
CLOSED_FORM = "clearance.pin.geometry=closed-form"
SPEED = 5000.0 * 2.0 * math.pi / 60.0  # rad/s

CRANK, ROD = 0.05, 0.12
CRANK_MASS, ROD_MASS, SLIDER_MASS = 0.30, 0.21, 0.14
CRANK_INERTIA, ROD_INERTIA = 1.0e-4, 2.5e-4  # about the mass centres, which are in the middle
GRAVITY = 0.0


@dataclass(frozen=True)
class Motion:
    """What happens at one or more crank angles; vectors along x and z, moments from x to z.

    Attributes:
        position: Of the slider [m].
        velocity: [m/s].
        acceleration: [m/s^2].
        rod_angle: Of the rod below x [rad].
        rod_rate: [rad/s].
        pin_force: Of the rod on the slider [N], (2, ...).
        crank_pin_force: Of the crank on the rod [N], (2, ...).
        guide_force: Of the guide on the slider, along z [N].
        moment: On the crank [N m].
        energy: Kinetic and of gravity [J].
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    rod_angle: np.ndarray
    rod_rate: np.ndarray
    pin_force: np.ndarray
    crank_pin_force: np.ndarray
    guide_force: np.ndarray
    moment: np.ndarray
    energy: np.ndarray


def _cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def closed_form(angle, speed):
    """Return the motion and its forces at crank angles [rad] and a speed [rad/s], by Newton and Euler.

    With the rod's angle below x, sin(phi) = r sin(theta) / l, and its derivatives.
    """
    r, l, w, g = CRANK, ROD, speed, GRAVITY  # noqa: E741 - as in every textbook
    sin, cos = np.sin(angle), np.cos(angle)
    phi = np.arcsin(r * sin / l)
    sphi, cphi = np.sin(phi), np.cos(phi)
    phi_1 = r * w * cos / (l * cphi)
    phi_2 = (phi_1**2 * sphi - r * w**2 * sin / l) / cphi
    x_2 = -r * w**2 * cos - l * (phi_2 * sphi + phi_1**2 * cphi)

    to_rod = 0.5 * l * np.array([cphi, -sphi])  # from the crank pin to the rod's mass centre
    rod_velocity = r * w * np.array([-sin, cos]) - 0.5 * l * phi_1 * np.array([sphi, cphi])
    rod_acceleration = -r * w**2 * np.array([cos, sin]) - 0.5 * l * (
        phi_2 * np.array([sphi, cphi]) + phi_1**2 * np.array([cphi, -sphi])
    )
    weight = np.array([np.zeros_like(angle), -g * np.ones_like(angle)])
    rod_needs = ROD_MASS * (rod_acceleration - weight)
    along = SLIDER_MASS * x_2
    # Moments on the rod about the crank pin; its angular acceleration from x to z is -phi_2.
    across = -((_cross(to_rod, rod_needs) - ROD_INERTIA * phi_2) / l + sphi * along) / cphi
    pin = np.array([along, across])
    crank_pin = rod_needs + pin
    crank_end = r * np.array([cos, sin])
    moment = _cross(crank_end, crank_pin) + 0.5 * r * cos * CRANK_MASS * g
    x_1 = -r * w * sin - l * phi_1 * sphi
    energy = (
        0.5 * (CRANK_INERTIA + CRANK_MASS * 0.25 * r**2) * w**2
        + 0.5 * ROD_MASS * np.sum(rod_velocity**2, axis=0)
        + 0.5 * ROD_INERTIA * phi_1**2
        + 0.5 * SLIDER_MASS * x_1**2
        + g * (0.5 * CRANK_MASS + 0.5 * ROD_MASS) * r * sin
    )
    return Motion(
        position=r * cos + l * cphi,
        velocity=x_1,
        acceleration=x_2,
        rod_angle=phi,
        rod_rate=phi_1,
        pin_force=pin,
        crank_pin_force=crank_pin,
        guide_force=SLIDER_MASS * g - across,
        moment=moment,
        energy=energy,
    )


# --- the closed form itself --------------------------------------------------------------------------------


def test_the_closed_form_is_consistent():
    """Rates are derivatives, and the crank's power is the rate of the energy: a check of all forces."""
    step = 1e-5
    angle = np.linspace(0.0, 2.0 * math.pi, 97)
    at, before, after = (closed_form(angle + d, SPEED) for d in (0.0, -step, step))
    for of, rate in (
        (lambda m: m.position, at.velocity),
        (lambda m: m.velocity, at.acceleration),
        (lambda m: m.rod_angle, at.rod_rate),
        (lambda m: m.energy, at.moment * SPEED),
    ):
        found = (of(after) - of(before)) / (2.0 * step) * SPEED
        # Central differences: truncation step^2 and round-off eps / step, both of some 1e-10.
        assert found == pytest.approx(rate, abs=1e-9 * np.abs(rate).max())


# --- the URDF ----------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def mechanism():
    urdf = Urdf.from_text((FOLDER / "slider_crank.urdf").read_text(), "slider_crank.urdf")
    return build_mechanism(urdf, "fixed", (0.0, 0.0, -GRAVITY))


# --- runs --------------------------------------------------------------------------------------------------

CASES = list(SCENARIO["cases"])


def scenario(case, *overrides):
    return load_scenario("slider_crank", case=case, overrides=[CLOSED_FORM, *overrides])


@pytest.mark.parametrize("case", CASES)
def test_every_case_starts_closed_and_with_the_ideal_velocity(case):
    """Journal centred, residuals to 1e-12, and no speed of the journal in its bearing."""
    run = simulate(scenario(case), duration=2e-5)
    assert run.completed, run.message
    held = run.constraints
    for name in ("position_residual", "angle_residual"):
        assert held[name] < 1e-10
    for name in ("velocity_residual", "rate_residual"):
        assert held[name] < 1e-9
    m = closed_form(np.array(0.0), float(run.data["motion_rate"].sel(joint="crank")[0]))
    rates = run.data["motion_rate"].isel(time=0)
    # Assembly ends at residuals of 1e-12, at speeds of some 1e3 rad/s round-off.
    assert float(rates.sel(joint="crank_pin")) == pytest.approx(-float(rates.sel(joint="crank")) - m.rod_rate)
    if "clearance_joint" in run.data.dims:
        assert np.abs(run.data["journal_position"].values[0]).max() < 1e-12


def test_freedoms():
    """The guide holds five motions: of three hinges in a plane two are to be held, of a bore in space all."""
    for case, rank, left in (("ideal", 2, 0), ("planar", 2, 2), ("3d", 5, 2)):
        held = simulate(scenario(case), duration=1e-6).constraints
        assert held["closure_equations"] == 5
        assert held["closure_rank"] == rank
        assert held["freedoms_left"] == left


@pytest.mark.parametrize("case", ["ideal", "ideal-constraint"])
def test_the_ideal_mechanism_is_the_closed_form(case):
    """Slider, crank moment, and all forces of joints and guide, over two turns."""
    run = simulate(scenario(case))
    assert run.completed
    m = closed_form(SPEED * run.data["time"].values, SPEED)
    slider, loads = body_motion(run, "slider"), joint_loads(run)["force"]
    still = np.zeros_like(m.position)

    def agree(found, expected, tolerance=1e-9):
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=tolerance * np.abs(expected).max())

    agree(slider["position"], np.stack([m.position, still, still], axis=1))
    agree(slider["velocity"], np.stack([m.velocity, still, still], axis=1))
    agree(slider["acceleration"], np.stack([m.acceleration, still, still], axis=1))
    agree(run.data["drive_torque"].sel(drive="crank"), m.moment)
    for joint, force in (("pin", m.pin_force), ("crank_pin", m.crank_pin_force)):
        agree(loads.sel(moving_joint=joint), np.stack([force[0], still, force[1]], axis=1))
    agree(force_of_closure(run, "guide"), np.stack([still, still, m.guide_force], axis=1))
    # The weight of the rod is carried in its plane, and nothing turns the slider: of 1e3 N at 0.1 m.
    assert np.abs(run.data["closure_moment"].sel(closure="guide")).max() < 1e-10
    # The drive's work is what the mechanism's energy changes by, along the whole run.
    agree(run.data["drive_work"].sel(drive="crank"), m.energy - m.energy[0])


@pytest.mark.parametrize(
    ("case", "stiffness"),
    [
        ("planar", 6.61e10),
        ("clearance-200um", 1.06e11),
        ("clearance-100um", 1.51e11),
        ("clearance-50um", 2.14e11),
        ("clearance-10um", 4.79e11),
    ],
)
def test_the_stiffness_is_that_of_each_clearance(case, stiffness):
    """4/3 E* sqrt(R_i R_j / (R_i - R_j)), with the README's three digits; 6.61e10 is the literature's."""
    given = scenario(case)
    spec, steel = given.clearance["pin"], given.material("steel")
    ball = 0.010 - spec.radial_play
    found = hertz_stiffness(0.010, ball, steel, steel)
    modulus = 207e9 / (2.0 * (1.0 - 0.3**2))
    assert found == pytest.approx(4.0 / 3.0 * modulus * math.sqrt(0.010 * ball / spec.radial_play), rel=1e-12)
    assert found == pytest.approx(stiffness, rel=5e-3)
    assert point_stiffness(spec.shape().contact_radius, modulus) == pytest.approx(found, rel=1e-12)


@pytest.mark.parametrize("case", ["planar", "flores", "friction", "bearing-on-rod", "3d", "fast"])
def test_a_quarter_turn_with_clearance(case):
    """Impacts are located, the slider stays within the play of the ideal one, and the ledger closes."""
    speed = 2.0 * SPEED if case == "fast" else SPEED
    run = simulate(scenario(case), duration=3e-3 * SPEED / speed)
    data = run.data
    assert run.completed
    assert data.sizes["episode"] > 3
    m = closed_form(speed * data["time"].values, speed)
    apart = body_motion(run, "slider")["position"].values[:, 0] - m.position
    # Along x the pin's play counts in full, and what the rod's end moves across does so by tan(phi) < 0.46.
    # The parts are pressed into each other by up to 10 um, and by 0.15 mm at twice the speed.
    deep = 0.15e-3 if case == "fast" else 1e-5
    assert np.abs(apart).max() < 0.5e-3 * (1.0 + CRANK / math.sqrt(ROD**2 - CRANK**2)) + deep
    assert np.abs(apart).max() > 0.2e-3
    kept = json.loads(data.attrs["conservation"])
    # Of the energy that goes through the drive, some 20 J.
    assert kept["energy_error"] < 1e-9 * kept["gross_work"]
