"""Quantities of a run by name: the same numbers as in the result, or one line that says why not."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import QuantityName, body_motion, quantities, quantity, signals
from antenna_pin.errors import InvalidParameterError, UnknownNameError


@pytest.fixture(scope="module")
def antenna():
    overrides = ["clearance.elevation.geometry=closed-form"]
    return simulate(load_scenario("bai2020", case="case3", overrides=overrides), duration=0.03)


@pytest.fixture(scope="module")
def platform():
    return simulate(load_scenario("chen2021"), duration=1e-4)


NUMBERS = {
    "kinetic_energy": "J",
    "motion_angle[elevation]": "rad",
    "v[base.vx]": "m/s",
    "a[elevation.wz]": "rad/s^2",
    "v[azimuth]": "rad/s",
    "q[base.qw]": "1",
    "joint_force[elevation].x": "N",
    " contact_force[ elevation.radial+ , z ]": "N",
    "base_attitude.w": "1",
    "drive_torque[azimuth]": "N m",
    "touching[elevation.axial-]": "1",
}


@pytest.mark.parametrize("name", NUMBERS)
def test_a_number_is_that_of_the_result(antenna, name):
    found, parts = quantity(antenna, name), QuantityName.parse(name)
    array = antenna.data[parts.variable]
    expected = array.sel(dict(zip(array.dims[1:], parts.labels, strict=True)))
    assert np.array_equal(found.values, expected.values)
    assert np.array_equal(found.time, antenna.data["time"].values)
    assert found.units == NUMBERS[name]
    assert quantity(antenna, found.name).name == found.name  # a name written in full reads as itself
    assert found.name in quantities(antenna)


def test_the_only_label_of_a_dimension_may_be_left_out(antenna):
    force = antenna.data["joint_force"].sel(clearance_joint="elevation", axis="y")
    assert np.array_equal(quantity(antenna, "joint_force.y").values, force.values)


def test_lengths_and_sizes(antenna):
    force = antenna.data["joint_force"].values[:, 0, :]
    length = np.sqrt((force**2).sum(axis=1))
    assert np.allclose(quantity(antenna, "|joint_force[elevation]|").values, length, rtol=1e-14, atol=0.0)
    assert quantity(antenna, "| joint_force |").name == "|joint_force[elevation]|"
    assert np.array_equal(quantity(antenna, "|joint_force.y|").values, np.abs(force[:, 1]))
    assert np.array_equal(quantity(antenna, "|elevation force y|").values, np.abs(force[:, 1]))
    assert length.max() > 0.0 and force[:, 1].min() < 0.0


@pytest.mark.slow
def test_every_listed_name_is_one(antenna, platform):
    for run in (antenna, platform):
        listed = quantities(run)
        assert set(signals(run)) < set(listed)
        for name, units in listed.items():
            found = quantity(run, name)
            assert found.units == units, name
            assert found.values.shape == found.time.shape
            assert found.label.startswith(name)
            assert " or " not in units, name


def test_what_slides_has_metres_and_newtons(platform):
    assert quantity(platform, "slide_rate[leg1]").units == quantity(platform, "v[leg1]").units == "m/s"
    assert quantity(platform, "drive_torque[leg1]").units == "N"
    assert quantity(platform, "a[tilt1]").units == "rad/s^2"


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("motion_angel[elevation]", "variable 'motion_angel' is unknown; did you mean motion_angle?"),
        ("motion_angle[elevatoin]", "joint 'elevatoin' is unknown; did you mean elevation?"),
        ("joint_force[elevation].u", "axis 'u' is unknown; known: x, y, z"),
        ("joint_force[hinge].x", "clearance joint 'hinge' is unknown"),
        (
            "motion_angle",
            "must be that of one number, such as motion_angle[azimuth], motion_angle[elevation], as",
        ),
        ("joint_force", "must be that of one number, such as joint_force[elevation].x"),
        (
            "kinetic_energy[x]",
            "must be that of one number, such as kinetic_energy, as kinetic_energy is over time",
        ),
        ("peak_force", "name 'peak_force' is unknown"),  # not over time
        ("elevation force", "did you mean elevation force"),
        ("", "name '' is unknown"),
        ("a]b[", "name 'a]b[' is unknown"),
    ],
)
def test_what_is_none_is_refused_in_one_line(antenna, name, said):
    with pytest.raises(InvalidParameterError if "must be" in said else UnknownNameError) as refused:
        quantity(antenna, name)
    message = str(refused.value)
    assert said in message
    assert "\n" not in message and len(message) < 400


def test_names_have_parts():
    assert QuantityName.parse("|contact_force[a.b+, x]|") == QuantityName(
        "contact_force", ("a.b+", "x"), True
    )
    assert QuantityName.parse("base_position.z") == QuantityName("base_position", ("z",))
    assert QuantityName.parse("s2 force x") == QuantityName("s2 force x")


def test_the_motion_of_any_link_is_that_of_its_frame_in_the_world(antenna):
    motion = body_motion(antenna, "reflector")
    for variable in ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration"):
        for k, axis in enumerate("xyz"):
            found = quantity(antenna, f"body_{variable}[reflector].{axis}")
            assert np.array_equal(found.values, motion[variable].values[:, k])
            assert found.units == motion[variable].attrs["units"]
    speed = quantity(antenna, "|body_velocity[reflector]|").values
    assert np.allclose(speed, np.linalg.norm(motion["velocity"].values, axis=1), rtol=1e-14)
    with pytest.raises(UnknownNameError, match=r"body 'mirror'.*reflector"):
        quantity(antenna, "body_velocity[mirror].x")


@pytest.mark.parametrize("side", ["parent", "child"])
def test_the_velocity_of_a_journal_is_the_rate_of_its_place_in_the_bearing(side):
    # Also with the bearing on the child, which turns, so that the velocity is not that of the joint's twist.
    changes = ["clearance.elevation.geometry=closed-form", f"clearance.elevation.bearing_on={side}"]
    changes += ["output.rate='200 kHz'", "initial.joints.azimuth.rate='1 rad/s'"]
    run = simulate(load_scenario("bai2020", case="case3", overrides=changes), duration=2e-3)
    place = run.data["journal_position"].values[:, 0]
    for k, axis in enumerate("xyz"):
        found = quantity(run, f"journal_velocity[elevation].{axis}")
        assert found.units == "m/s"
        # Simpson's rule over pairs of steps of 5 us: its error is h^5/90 of a fourth derivative, which
        # oscillations of the contact at 2 kHz make (2 pi 2 kHz)^4 of a velocity of a few mm/s.
        v, t = found.values, found.time
        inner = np.flatnonzero(np.isclose(t[2:] - t[1:-1], t[1:-1] - t[:-2], rtol=1e-6))
        h = t[inner + 1] - t[inner]
        by_rule = h / 3.0 * (v[inner] + 4.0 * v[inner + 1] + v[inner + 2])
        assert np.allclose(place[inner + 2, k] - place[inner, k], by_rule, rtol=0.0, atol=1e-13)
