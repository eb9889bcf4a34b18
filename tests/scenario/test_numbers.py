"""Single numbers of a scenario by key, with names that stand in quotes."""

import pytest

from antenna_pin import load_scenario
from antenna_pin.errors import UnknownNameError
from antenna_pin.scenario.merge import key_of, key_parts
from antenna_pin.scenario.numbers import number_of, with_number

KEY = 'springs."a.b c".stiffness'
LAW = 'clearance."a.b c".normal.stiffness'


@pytest.fixture
def scenario(tmp_path):
    text = """
format = 1
duration = "1 s"
mechanism.urdf = "a.urdf"
[springs."a.b c"]
stiffness = "2 N*m/rad"
[clearance."a.b c"]
model = "contact"
bearing_radius = "5 mm"
bearing_length = "40 mm"
radial_clearance = "50 um"
normal = {law = "lankarani-nikravesh", stiffness = "1e9 N/m^1.5", exponent = 1.5, restitution = 0.9}
"""
    (tmp_path / "a.urdf").write_text('<robot name="a"/>')
    (tmp_path / "scenario.toml").write_text(text)
    return load_scenario(tmp_path / "scenario.toml")


def test_a_name_in_quotes_is_one_part_of_a_key(scenario):
    assert number_of(scenario, KEY, "test")[:2] == (KEY, 2.0)
    assert with_number(scenario, KEY, 3.0).springs["a.b c"].stiffness == 3.0
    assert number_of(with_number(scenario, LAW, 2e9), LAW, "test").value == 2e9


def test_an_unknown_key_names_those_beside_it_as_they_are_written(scenario):
    with pytest.raises(UnknownNameError, match=r'did you mean springs\."a\.b c"\.stiffness\?'):
        number_of(scenario, 'springs."a.b c".stifness', "test")
    with pytest.raises(UnknownNameError, match=r'known: springs\."a\.b c"$'):
        number_of(scenario, "springs.a.stiffness", "test")


@pytest.mark.parametrize("parts", [["a"], ["a", "b-c", "1"], ["a.b", "c"], ["", 'x"y', "ü"]])
def test_parts_of_a_key_come_back(parts):
    assert key_parts(key_of(parts)) == parts
