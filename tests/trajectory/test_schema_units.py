"""Units of what a result holds: those that the names tell."""

import pytest
from value_classes import changeable

from antenna_pin.trajectory.schema import VARIABLES

#: By the last word of a name. What is turned of joints that slide has a metre for a radian, as is said there.
UNITS = {
    "acceleration": {"m/s^2", "rad/s^2"},
    "angle": {"rad"},
    "current": {"A"},
    "deflection": {"rad"},
    "depth": {"m"},
    "energy": {"J"},
    "force": {"N"},
    "gap": {"m"},
    "heat": {"J"},
    "impulse": {"N s", "N m s"},
    "length": {"m"},
    "loss": {"J"},
    "mass": {"kg"},
    "moment": {"N m"},
    "momentum": {"N s", "N m s", "kg m/s", "kg m^2/s"},
    "position": {"m"},
    "rate": {"m/s", "rad/s"},
    "speed": {"m/s"},
    "tension": {"N"},
    "time": {"s"},
    "torque": {"N m"},
    "work": {"J"},
}
NAMED = [name for name in VARIABLES if name.split("_")[-1] in UNITS]


@pytest.mark.parametrize("name", NAMED)
def test_a_unit_is_that_of_the_name(name):
    assert VARIABLES[name].units in UNITS[name.split("_")[-1]]


def test_most_names_tell_their_units():
    assert len(NAMED) > 0.6 * len(VARIABLES)


def test_values_are_frozen():
    """They stay what they were checked to be, and take no attribute of a misspelt name."""
    assert changeable("trajectory") == {"Content", "Unlabelled"}  # to which is added while they are made
