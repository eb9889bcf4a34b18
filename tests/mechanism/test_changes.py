"""Overrides of links and joints refuse what is no property of a body or place of a joint."""

import math

import pytest

from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism import JointChange, LinkChange, ShapeChange


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: LinkChange(mass=-1.0), "LinkChange: mass must be zero or more, and finite, got -1.0"),
        (lambda: LinkChange(mass=math.nan), "LinkChange: mass must be zero or more, and finite, got nan"),
        (lambda: LinkChange(mass="3 m"), "LinkChange: mass must be a mass [kg], got '3 m' (length)"),
        (
            lambda: LinkChange(inertia=(1.0, 2.0)),
            "LinkChange: inertia must be 3 or 6 finite numbers, got (1.0, 2.0)",
        ),
        (lambda: LinkChange(inertia=5.0), "LinkChange: inertia must be 3 or 6 finite numbers, got 5.0"),
        (
            lambda: LinkChange(centre_of_mass=(0.0, math.inf, 0.0)),
            "LinkChange: centre_of_mass must be 3 finite numbers, got (0.0, inf, 0.0)",
        ),
        (lambda: ShapeChange(radius=-1.0), "ShapeChange: radius must be positive and finite, got -1.0"),
        (
            lambda: ShapeChange(size=(1.0, 0.0, 1.0)),
            "ShapeChange: size must be 3 positive numbers, got (1.0, 0.0, 1.0)",
        ),
        (
            lambda: JointChange(axis=(0.0, 0.0, 0.0)),
            "JointChange: axis must be three finite numbers, not all zero, got [0.0, 0.0, 0.0]",
        ),
        (
            lambda: JointChange(origin_xyz=(0.0, 0.0)),
            "JointChange: origin_xyz must be 3 finite numbers, got (0.0, 0.0)",
        ),
        (
            lambda: JointChange(origin_rpy=("a", 0, 0)),
            "JointChange: origin_rpy[0] must be an angle [rad], got 'a'; write a number and its unit: "
            "'1 rad'",
        ),
    ],
)
def test_refusals(make, message):
    with pytest.raises(InvalidParameterError) as caught:
        make()
    assert str(caught.value) == message


def test_sequences_of_any_kind_are_kept_as_tuples_of_floats():
    change = LinkChange(inertia=[1, 2, 2], centre_of_mass=[0, 0, 1])
    assert change.inertia == (1.0, 2.0, 2.0)
    assert change.centre_of_mass == (0.0, 0.0, 1.0)
