"""Values are frozen once they are checked, made by name, and documented with their declared units."""

import pytest
from value_classes import by_position, changeable, undocumented_units

# Exceptions by room, each with its reason.
FROZEN = {
    "base": {"ToleranceChain"},  # keeps its distribution, once worked out
    "contact": set(),
    "elements": {"OverTime"},  # keeps what it has worked out
    "flexible": {"_Reader"},  # gathers while it reads
    "geometry": set(),
    "law_studies": set(),
    "live": set(),
    "record": set(),
    "report": set(),
    "sweep": set(),
    "trajectory": {"Content", "Unlabelled"},  # to which is added while they are made
}
BY_NAME = {
    "base": {"Parameter", "NumberRule", "Unit"},
    "contact": {"Alias"},  # has no parameters
    "control": {"BangBangState", "Measure", "PidState"},
    "elements": {"Integral", "OverTime"},  # have no parameters
    "geometry": set(),
}
UNITS = {
    "base": set(),
    "contact": {("Hertz", "stiffness", "N/m**exponent")},  # of the power that is another parameter
    "control": set(),
    "elements": {("Motor", "value", "1")},  # a voltage or a current
    "flexible": set(),
}


@pytest.mark.parametrize("room", FROZEN)
def test_values_are_frozen(room):
    """They stay what they were checked to be, and take no attribute of a misspelt name."""
    if room == "live":
        pytest.importorskip("bokeh", reason="the extra explore is not installed")
    assert changeable(room) == FROZEN[room]


@pytest.mark.parametrize("room", BY_NAME)
def test_values_are_made_by_name(room):
    """No two parameters can be swapped."""
    assert by_position(room) == BY_NAME[room]


@pytest.mark.parametrize("room", UNITS)
def test_documented_units_are_the_declared_ones(room):
    assert undocumented_units(room) == UNITS[room]
