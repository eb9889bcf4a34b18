"""Units of what a result holds: those that the names tell."""

import pytest
from value_classes import changeable

from antenna_pin.trajectory.schema import VARIABLES

#: By a word of the name, the last one that stands here. What is turned of joints that slide has a metre for a
#: radian, as is said there.
UNITS = {
    "acceleration": {"m/s^2", "rad/s^2"},
    "angle": {"rad"},
    "attitude": {"1"},
    "bend": {"1"},
    "contact": {"1"},
    "control": {"rad"},
    "controller": {"1"},
    "current": {"A"},
    "deflection": {"rad"},
    "depth": {"m"},
    "dissipated": {"J"},
    "dissipation": {"J"},
    "dwell": {"1"},
    "effort": {"N m"},
    "energy": {"J"},
    "force": {"N"},
    "gap": {"m"},
    "heat": {"J"},
    "impulse": {"N s", "N m s"},
    "length": {"m"},
    "loss": {"J"},
    "mass": {"kg"},
    "mode": {"1"},
    "moment": {"N m"},
    "momentum": {"N s", "N m s", "kg m/s", "kg m^2/s"},
    "place": {"m"},
    "point": {"m"},
    "position": {"m"},
    "rate": {"m/s", "rad/s"},
    "scenario": {"1"},
    "signal": {"1"},
    "speed": {"m/s"},
    "spin": {"rad/s"},
    "tension": {"N"},
    "ticks": {"1"},
    "tilt": {"rad", "1"},
    "time": {"s"},
    "torque": {"N m"},
    "touching": {"1"},
    "velocity": {"m/s", "rad/s"},
    "work": {"J"},
}
#: Whose units go with the joint: those of a configuration, of velocities and of accelerations.
OF_JOINTS = {"q", "v", "a"}


def word_of(name):
    """Return the last word of a name that has units."""
    if name.startswith("time_of_"):
        return "time"
    return next((word for word in reversed(name.split("_")) if word in UNITS), None)


@pytest.mark.parametrize("name", sorted(VARIABLES.keys() - OF_JOINTS))
def test_a_unit_is_that_of_the_name(name):
    assert VARIABLES[name].units in UNITS[word_of(name)]


def test_values_are_frozen():
    """They stay what they were checked to be, and take no attribute of a misspelt name."""
    assert changeable("trajectory") == {"Content", "Unlabelled"}  # to which is added while they are made
