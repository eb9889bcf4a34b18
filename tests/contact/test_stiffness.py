"""Stiffness from materials and radii, and the sizes of force that follow for the antenna's joint."""

import math
import re

import pytest
from value_classes import check_refusals

from antenna_pin.contact import (
    MATERIALS,
    LankaraniNikravesh,
    Material,
    effective_modulus,
    hertz_stiffness,
    point_stiffness,
)
from antenna_pin.errors import InvalidParameterError

STEEL = Material(young=207e9, poisson=0.3)
R_I, R_J = 0.010, 0.0098


def external_stiffness():
    """With the radius R_i R_j / (R_i + R_j) that papers often print, which is that of two convex bodies."""
    return 4.0 / 3.0 * effective_modulus(STEEL, STEEL) * math.sqrt(R_I * R_J / (R_I + R_J))


def test_effective_modulus_of_steel_on_steel():
    assert effective_modulus(STEEL, STEEL) == pytest.approx(113.74e9, abs=0.005e9)  # five digits published
    assert effective_modulus(STEEL, STEEL) == pytest.approx(
        207e9 / (2 * (1 - 0.09)), rel=1e-15, abs=0.0
    )  # round-off


def test_effective_modulus_is_symmetric_and_below_the_softer():
    soft = Material(young=70e9, poisson=0.33)
    assert effective_modulus(STEEL, soft) == effective_modulus(soft, STEEL)
    assert effective_modulus(STEEL, soft) < 70e9 / (1 - 0.33**2)


def test_internal_contact_is_ten_times_stiffer_than_external():
    internal = hertz_stiffness(R_I, R_J, STEEL, STEEL)
    assert internal == pytest.approx(1.0615e11, rel=5e-5, abs=0.0)  # five digits published
    assert external_stiffness() == pytest.approx(1.067e10, rel=5e-4, abs=0.0)  # four digits
    # sqrt((R_i + R_j) / (R_i - R_j)) = sqrt(99)
    assert internal / external_stiffness() == pytest.approx(
        math.sqrt(99.0), rel=1e-13, abs=0.0
    )  # R_i - R_j cancels


@pytest.mark.parametrize(
    ("depth", "external", "internal"),
    [(0.1e-6, "0.337", "3.36"), (1e-6, "10.7", "106"), (5e-6, "119", "1187"), (20e-6, "954", "9495")],
)
def test_published_sizes_of_force(depth, external, internal):
    """Journal 9.8 mm in a bore of 10 mm, steel on steel: the Lankarani-Nikravesh columns, slowly loaded."""
    for stiffness, text in (
        (external_stiffness(), external),
        (hertz_stiffness(R_I, R_J, STEEL, STEEL), internal),
    ):
        law = LankaraniNikravesh(stiffness=stiffness, restitution=0.9)
        decimals = len(text.partition(".")[2])
        # To the rounding of the table.
        assert law.force(depth, 0.0, 1.0) == pytest.approx(float(text), abs=0.5000001 * 10.0**-decimals)


def test_stiffness_grows_without_bound_as_the_play_vanishes():
    """K goes as the square root of R_i R_j / clearance."""
    first, second = (hertz_stiffness(0.01, 0.01 - c, STEEL, STEEL) for c in (1e-6, 1e-8))
    assert second / first == pytest.approx(10.0, rel=1e-4, abs=0.0)  # R_j itself differs by a ten-thousandth


@pytest.mark.parametrize("journal", [0.01, 0.02, 0.0, -0.001, math.nan])
def test_refuses_a_journal_that_does_not_fit(journal):
    message = f"hertz_stiffness: journal_radius must be in (0, 0.01) [m], got {journal!r}"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        hertz_stiffness(0.01, journal, STEEL, STEEL)


@pytest.mark.parametrize("name", ["radius", "modulus"])
@pytest.mark.parametrize("value", [0.0, -1e-3])
def test_a_point_of_no_radius_or_modulus_has_no_stiffness(name, value):
    with pytest.raises(InvalidParameterError, match=f"point_stiffness: {name} must be positive"):
        point_stiffness(**{"radius": 0.01, "modulus": 1e11, name: value})


def test_refuses_what_is_no_material():
    check_refusals(STEEL)


def test_shipped_materials_say_where_they_come_from():
    assert MATERIALS["steel"].young == 207e9 and MATERIALS["steel"].poisson == 0.3
    assert all(material.source for material in MATERIALS.values())
