"""The laws of Liu et al. 2013 and the measured pin joint, against its table and numbers found before."""

import math

import numpy as np
import pytest

from antenna_pin.analysis.law_studies import LIU_2013, LIU_2013_STEEL
from antenna_pin.contact import LiuConformal, LiuPinJoint, LiuPinJointCorrected, effective_modulus

MODULUS = effective_modulus(LIU_2013_STEEL, LIU_2013_STEEL)
MILLIMETRE = 1e-3


def law_at(cls, point, *, journal=None, bearing=None):
    """A law with one of the radii given, one millimetre long."""
    r_j = journal if journal is not None else bearing - point.clearance
    return cls(length=MILLIMETRE, modulus=MODULUS, journal_radius=r_j, bearing_radius=r_j + point.clearance)


def errors(cls, **radius):
    """Of the load over the measured one, per cent, one for each row."""
    loads = [law_at(cls, point, **radius).elastic_force(point.depth) for point in LIU_2013]
    return [100.0 * (load / point.load - 1.0) for load, point in zip(loads, LIU_2013, strict=True)]


def test_the_table_is_the_papers():
    assert len(LIU_2013) == 11
    assert [p.clearance for p in LIU_2013] == pytest.approx([67e-6] * 4 + [94e-6] * 4 + [104e-6] * 3)
    assert MODULUS == pytest.approx(113187e6, rel=1e-5)
    # Its own columns of errors: means of 55.2 and 31.8 %.
    for column, mean in (("hertz", 55.2), ("conformal", 31.8)):
        found = np.mean([abs(getattr(p, column) / p.load - 1.0) for p in LIU_2013])
        assert 100.0 * found == pytest.approx(mean, abs=0.06)


def test_equation_14_gives_the_conformal_column_with_radii_of_nine_tenths():
    residual = [
        100.0 * (law_at(LiuConformal, p, bearing=0.912e-3).elastic_force(p.depth) / p.conformal - 1.0)
        for p in LIU_2013
    ]
    expected = [0.7, 0.5, 0.5, 0.5, 0.3, -0.7, -0.5, -0.4, 0.3, -0.7, -0.4]
    assert residual == pytest.approx(expected, abs=0.08)  # rounding of the column, and of 0.912


def test_what_radius_each_row_of_the_conformal_column_has():
    """R_i R_j / dR [mm] of each row, by inverting (14)."""
    radii = [(0.75 * p.conformal / (MODULUS * p.depth**1.5)) ** 2 * 1e3 for p in LIU_2013]
    expected = [11.35, 11.40, 11.39, 11.39, 7.89, 8.06, 8.02, 8.01, 7.05, 7.18, 7.15]
    assert radii == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize(
    ("cls", "radius", "expected", "mean"),
    [
        (
            LiuPinJoint,
            {"bearing": 0.912e-3},
            [11.5, 34.5, 25.6, 24.0, 26.9, 52.0, 16.2, 16.5, -29.7, -18.5, 0.9],
            23.3,
        ),
        (
            LiuPinJoint,
            {"journal": 5e-3},
            [9.3, 31.3, 22.4, 20.6, 23.5, 47.2, 12.2, 12.3, -31.5, -21.0, -2.7],
            21.3,
        ),
        (
            LiuPinJoint,
            {"journal": 8e-3},
            [9.2, 31.1, 22.1, 20.3, 23.2, 46.8, 11.9, 11.9, -31.7, -21.2, -2.9],
            21.1,
        ),
        (
            LiuPinJoint,
            {"journal": 1e3},
            [8.9, 30.7, 21.7, 19.9, 22.8, 46.2, 11.4, 11.4, -31.9, -21.5, -3.4],
            20.9,
        ),
        (
            LiuPinJointCorrected,
            {"journal": 8e-3},
            [-8.0, 9.8, 3.0, 2.7, 4.2, 23.0, -6.2, -5.6, -41.5, -33.5, -18.7],
            14.2,
        ),
    ],
)
def test_equation_28_and_its_correction(cls, radius, expected, mean):
    """To the rounding of a table computed before."""
    found = errors(cls, **radius)
    assert found == pytest.approx(expected, abs=0.06)
    assert np.mean(np.abs(found)) == pytest.approx(mean, abs=0.06)


def test_docstring_formula_of_equation_28():
    r_j, r_i, depth = 5e-3, 5.094e-3, 2e-5
    law = LiuPinJoint(length=0.02, modulus=MODULUS, journal_radius=r_j, bearing_radius=r_i)
    s = depth + r_i - r_j
    a = math.sqrt(r_i**2 - 0.25 * ((r_i**2 - r_j**2) / s + s) ** 2)
    expected = math.pi * 2.0 * MODULUS * 0.02 * depth / 4.0 / (2.0 * math.log(4.0 * r_j / a) - 1.0)
    assert law.elastic_force(depth) == pytest.approx(expected, rel=1e-9, abs=0.0)  # a^2 cancels as written
    assert law.half_width(depth) == pytest.approx(a, rel=1e-9, abs=0.0)


@pytest.mark.parametrize("cls", [LiuPinJoint, LiuPinJointCorrected])
def test_the_contact_is_as_wide_as_the_pin_at_the_limit(cls):
    law = cls(length=0.02, modulus=MODULUS, journal_radius=5e-3, bearing_radius=5.094e-3)
    assert law.half_width(law.depth_limit) == pytest.approx(5e-3, rel=1e-12)
    assert law.half_width(0.5 * law.depth_limit) < 5e-3
    with pytest.raises(ValueError, match="depth must be at most depth_limit"):
        law.half_width(1.01 * law.depth_limit)


def test_half_the_depth_makes_the_contact_narrower_and_the_joint_softer():
    one, other = (
        cls(length=0.02, modulus=MODULUS, journal_radius=5e-3, bearing_radius=5.094e-3)
        for cls in (LiuPinJoint, LiuPinJointCorrected)
    )
    for depth in (1e-6, 1e-5, 1e-4):
        assert other.half_width(depth) < one.half_width(depth)
        assert other.elastic_force(depth) < one.elastic_force(depth)
