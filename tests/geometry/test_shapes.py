"""Dimensions of a joint with play: what follows from them, and what is refused."""

import dataclasses
import math
import re

import numpy as np
import pytest
from hinge_shapes import antenna_hinge
from value_classes import dataclasses_of, documented_units

from antenna_pin.base.records import CONTACT
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry import (
    ContactPoint,
    CylindricalClearance,
    PlanarClearance,
    PrismaticClearance,
    RevoluteClearance,
    SphericalClearance,
    pose_of,
)
from antenna_pin.joints.geometry.revolute_kernels import bore_contact, flange_contact, nearest_on_ellipse

from .conftest import Coal

PLANAR = PlanarClearance(bearing_radius=0.010, journal_radius=0.0098)
BALL = SphericalClearance(socket_radius=0.010, ball_radius=0.0098)


def test_clearances_follow_from_dimensions(joint):
    shape = joint()
    assert shape.journal_radius == pytest.approx(0.0098, rel=1e-15, abs=0.0)  # round-off
    assert shape.flange_distance == pytest.approx(0.0504, rel=1e-15, abs=0.0)
    assert shape.radial_clearance == pytest.approx(
        2e-4, rel=1e-12, abs=0.0
    )  # round-off of a difference of lengths
    assert shape.axial_clearance == pytest.approx(2e-4, rel=1e-12, abs=0.0)
    assert PLANAR.radial_clearance == pytest.approx(2e-4, rel=1e-12, abs=0.0)


def test_names_and_number_of_contacts(joint):
    shape = joint()
    assert shape.contact_places == (("radial", "+"), ("radial", "-"), ("axial", "+"), ("axial", "-"))
    assert PLANAR.contact_places == (("radial", ""),)
    for one, number in ((shape, 4), (PLANAR, 1)):
        for geometry in (one, Coal(one)):
            assert len(geometry.contacts([0, 0, 0], [0, 0, 1])) == number


def test_depth_is_the_negative_part_of_the_gap():
    normal = point = np.zeros(3)
    assert ContactPoint(-2e-6, normal, point).depth == 2e-6
    assert ContactPoint(2e-6, normal, point).depth == 0.0


def test_only_the_direction_of_the_axis_counts(joint):
    shape = joint()
    for a, b in zip(
        shape.contacts([1e-4, 0, 0], [0.001, 0.002, 1.0]),
        shape.contacts([1e-4, 0, 0], [0.007, 0.014, 7.0]),
        strict=True,
    ):
        assert a.gap == pytest.approx(b.gap, abs=3e-17)  # round-off


@pytest.mark.parametrize("geometry", [PLANAR, Coal(PLANAR)], ids=["closed-form", "coal"])
def test_planar_joint_is_a_circle_in_a_circle(geometry):
    rng = np.random.default_rng(5)
    for _ in range(100):
        x, y = rng.uniform(-4e-4, 4e-4, 2)
        (contact,) = geometry.contacts([x, y, 0.0], [0, 0, 1])
        eccentricity = math.hypot(x, y)
        assert contact.gap == pytest.approx(2e-4 - eccentricity, abs=1e-17)  # round-off
        # Coal's normal is a difference of points of 1e-2 m over the journal's radius.
        assert contact.normal == pytest.approx([-x / eccentricity, -y / eccentricity, 0.0], abs=1e-13)
        assert contact.point == pytest.approx(
            [0.01 * x / eccentricity, 0.01 * y / eccentricity, 0.0], abs=1e-16
        )


@pytest.mark.parametrize("geometry", [BALL, Coal(BALL)], ids=["closed-form", "coal"])
def test_a_ball_in_a_socket_is_a_sphere_in_a_sphere(geometry):
    """However the ball is turned: what opens along the line of centres is the play less the eccentricity."""
    rng = np.random.default_rng(5)
    assert BALL.radial_clearance == pytest.approx(2e-4, rel=1e-12, abs=0.0)
    for _ in range(100):
        centre = rng.uniform(-4e-4, 4e-4, 3)
        (contact,) = geometry.contacts(centre, rng.normal(size=3))
        eccentricity = np.linalg.norm(centre)
        assert contact.gap == pytest.approx(2e-4 - eccentricity, abs=1e-17)  # round-off
        # As above.
        assert contact.normal == pytest.approx(-centre / eccentricity, abs=1e-13)
        assert contact.point == pytest.approx(0.01 * centre / eccentricity, abs=1e-16)


@pytest.mark.parametrize("geometry", [PLANAR, Coal(PLANAR)], ids=["closed-form", "coal"])
def test_planar_joint_at_its_centre_has_a_gap_and_some_normal(geometry):
    (contact,) = geometry.contacts([0, 0, 0], [0, 0, 1])
    assert contact.gap == pytest.approx(2e-4, abs=1e-17)  # round-off
    assert np.linalg.norm(contact.normal) == pytest.approx(1.0, rel=1e-15, abs=0.0)


def test_planar_joint_is_the_end_of_a_journal_that_does_not_tilt(joint):
    for x, y in ((1e-4, 5e-5), (-2.3e-4, 1e-4)):
        (flat,) = PLANAR.contacts([x, y, 0])
        for end in joint().contacts([x, y, 1e-5], [0, 0, 1])[:2]:
            assert end.gap == pytest.approx(flat.gap, abs=1e-17)  # round-off
            assert end.normal == pytest.approx(flat.normal, abs=1e-13)


GOOD = dict(
    bearing_radius=0.01,
    journal_radius=0.0098,
    bearing_length=0.05,
    flange_distance=0.0504,
    bearing_outer_radius=0.012,
    flange_radius=0.014,
)


@pytest.mark.parametrize("length", GOOD)
@pytest.mark.parametrize("value", [0.0, -0.01, math.nan, math.inf])
def test_refuses_what_is_no_length(length, value):
    message = f"RevoluteClearance: {length} must be positive and finite, got {value!r}"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        RevoluteClearance(**(GOOD | {length: value}))


@pytest.mark.parametrize("length", GOOD)
def test_refuses_a_length_whose_square_is_no_number(length):
    with pytest.raises(
        ValueError, match=rf"^RevoluteClearance: {length} must be at most 1e\+100 in size, got 1e\+200$"
    ):
        RevoluteClearance(**(GOOD | {length: 1e200}))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"journal_radius": 0.01},
            "RevoluteClearance: journal_radius must be below bearing_radius = 0.01 m, got 0.01",
        ),
        (
            {"journal_radius": 0.02},
            "RevoluteClearance: journal_radius must be below bearing_radius = 0.01 m, got 0.02",
        ),
        (
            {"flange_distance": 0.0497},
            "RevoluteClearance: flange_distance must be at least bearing_length = 0.05 m, or for a hard "
            "preload less by at most 0.02 bearing_radius, got 0.0497",
        ),
        (
            {"bearing_outer_radius": 0.01},
            "RevoluteClearance: bearing_outer_radius must be above bearing_radius = 0.01 m, got 0.01",
        ),
        (
            {"flange_radius": 0.0099},
            "RevoluteClearance: flange_radius must be above bearing_radius = 0.01 m, got 0.0099",
        ),
    ],
)
def test_refuses_what_does_not_fit_together(change, message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        RevoluteClearance(**(GOOD | change))


def test_axial_clearance_of_zero_is_allowed(joint):
    assert joint(axial_clearance=0.0).axial_clearance == 0.0
    RevoluteClearance(**(GOOD | {"flange_distance": 0.05 * (1.0 - 1e-13)}))  # zero but for round-off


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            {"bearing_radius": 0.01, "journal_radius": 0.011},
            "PlanarClearance: journal_radius must be below bearing_radius = 0.01 m, got 0.011",
        ),
        (
            {"bearing_radius": -0.01, "journal_radius": 0.011},
            "PlanarClearance: bearing_radius must be positive and finite, got -0.01",
        ),
        (
            {"bearing_radius": 0.01, "journal_radius": math.nan},
            "PlanarClearance: journal_radius must be positive and finite, got nan",
        ),
    ],
)
def test_refuses_what_is_no_planar_joint(given, message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        PlanarClearance(**given)


def test_refuses_what_is_no_pose(joint):
    shape = joint()
    rule = re.escape("contacts: pose must be three finite numbers, and a vector (3,) or rotation (3, 3)")
    for geometry in (shape, Coal(shape), PLANAR, Coal(PLANAR)):
        for centre in ([0, 0], [0, 0, math.nan]):
            with pytest.raises(ValueError, match=f"^{rule}, got "):
                geometry.contacts(centre, [0, 0, 1])
        with pytest.raises(
            ValueError, match="^contacts: attitude must be three finite numbers, not all zero, got "
        ):
            geometry.contacts([0, 0, 0], [0, 0, 0])


def test_kernels_equal_their_python(joint, pose_maker):
    """In the last bits; poses with both local minima included."""
    kernel = nearest_on_ellipse
    if not hasattr(kernel, "py_func"):
        pytest.skip("compilation is switched off")
    for shape in (joint(), joint(flange_radius=0.011)):
        flat = shape.dimensions()[0]
        for p, z in zip(*pose_maker(200, 9, 0.4, 1e-3, 1e-3), strict=True):
            compiled, plain = np.zeros(4, CONTACT), np.zeros(4, CONTACT)
            pose = pose_of(p, z)[0]
            for row, side in enumerate((1.0, -1.0)):
                bore_contact(flat, side, pose, compiled[row])
                bore_contact.py_func(flat, side, pose, plain[row])
                flange_contact(flat, side, pose, compiled[2 + row])
                flange_contact.py_func(flat, side, pose, plain[2 + row])
            # Round-off of angles near a second minimum; the gaps do not feel it.
            for name, tolerance in (("gap", 1e-16), ("normal", 1e-12), ("point", 1e-12)):
                assert compiled[name] == pytest.approx(plain[name], abs=tolerance)
    rng = np.random.default_rng(1)
    for major, ratio, x, y in rng.uniform([1e-3, 0.1, -2e-2, -2e-2], [1e-2, 1.0, 2e-2, 2e-2], (500, 4)):
        arguments = (major, ratio * major, x, y)
        assert kernel(*arguments) == pytest.approx(kernel.py_func(*arguments), abs=1e-15)  # round-off


SHAPES = (
    antenna_hinge(),
    PLANAR,
    SphericalClearance(socket_radius=0.010, ball_radius=0.0098),
    CylindricalClearance(
        bearing_radius=0.010,
        journal_radius=0.0098,
        slider_length=0.08,
        guide_length=0.06,
        key_width=0.004,
        keyway_width=0.0041,
        key_reach=0.012,
    ),
    PrismaticClearance(
        guide_width=0.0303,
        guide_height=0.0204,
        slider_width=0.03,
        slider_height=0.02,
        slider_length=0.08,
        corner_radius=0.0005,
        roll=0.2,
        guide_length=0.06,
    ),
)


def test_every_shape_has_an_example():
    assert set(map(type, SHAPES)) == set(dataclasses_of("geometry"))


@pytest.mark.parametrize("shape", SHAPES, ids=lambda one: type(one).__name__)
def test_each_dimension_is_read_from_text_with_a_unit_of_its_kind(shape):
    """A length or an angle, as the docstring says; text with a unit of the other kind is refused."""
    units = documented_units(type(shape))
    for one in dataclasses.fields(shape):
        value, (unit, *_) = getattr(shape, one.name), units[one.name]
        assert dataclasses.replace(shape, **{one.name: f"{value!r} {unit}"}) == shape
        with pytest.raises(InvalidParameterError, match=one.name):
            dataclasses.replace(shape, **{one.name: f"{value!r} {({'m', 'rad'} - {unit}).pop()}"})
