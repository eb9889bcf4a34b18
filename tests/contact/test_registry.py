"""The laws by name: what scenario files, the command line and the documentation read."""

import dataclasses

import pytest

import antenna_pin.contact
from antenna_pin.contact import FRICTION_LAWS, NORMAL_LAWS, Hertz, Parameter, VelocityBased, law_parameters

LAWS = {**NORMAL_LAWS, **FRICTION_LAWS}


def test_names_of_the_laws():
    assert {"hertz", "lankarani-nikravesh"} <= set(NORMAL_LAWS)
    assert {"none", "velocity-based", "ambrosio", "tanh"} <= set(FRICTION_LAWS)
    assert not set(NORMAL_LAWS) & set(FRICTION_LAWS)
    assert all(name == name.lower() and "_" not in name for name in LAWS)


def test_registries_are_read_only():
    with pytest.raises(TypeError):
        NORMAL_LAWS["hertz"] = Hertz
    with pytest.raises(TypeError):
        FRICTION_LAWS["hertz"] = Hertz


@pytest.mark.parametrize("name", LAWS)
def test_every_parameter_has_unit_and_meaning(name):
    parameters = law_parameters(LAWS[name])
    assert set(parameters) == {f.name for f in dataclasses.fields(LAWS[name])}
    for parameter in parameters.values():
        assert parameter.unit and parameter.doc
        assert parameter.required == (parameter.default is None)


def test_unit_of_a_stiffness_follows_its_exponent():
    parameters = law_parameters(Hertz)
    assert parameters["stiffness"].unit == "N/m**exponent"
    assert parameters["exponent"] == Parameter("1", False, 1.5, parameters["exponent"].doc)
    assert law_parameters(VelocityBased)["static_speed"].unit == "m/s"


def test_public_names_exist():
    for name in antenna_pin.contact.__all__:
        assert getattr(antenna_pin.contact, name) is not None
