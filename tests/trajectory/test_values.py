"""What a result is made of are values: nobody changes one that somebody else has."""

import dataclasses
import importlib
import pkgutil

import pytest

import antenna_pin.trajectory
from antenna_pin.trajectory import Touch

# A dataset in parts before xarray has it, and all that it is made of: each filled by who made it.
FILLED = {"Content", "Unlabelled"}
CLASSES = {
    name: one
    for module in pkgutil.iter_modules(antenna_pin.trajectory.__path__, "antenna_pin.trajectory.")
    for name, one in vars(importlib.import_module(module.name)).items()
    if isinstance(one, type) and dataclasses.is_dataclass(one) and one.__module__ == module.name
}


@pytest.mark.parametrize("name", CLASSES)
def test_nothing_of_a_result_is_set_anew(name):
    cls = CLASSES[name]
    blank = object.__new__(cls)
    field = dataclasses.fields(cls)[0].name
    if name in FILLED:
        setattr(blank, field, None)
        return
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(blank, field, None)


def touch(**changes):
    numbers = {"onset": 0.1, "release": 0.3, "approach_rate": 1.0, "rebound_rate": 0.8, "peak_effort": 50.0}
    rest = {"impulse": 1.8, "loss": 0.2}
    return Touch(**{"stop": "stops.hinge", "side": "upper", **numbers, **rest, **changes})


def test_a_touch_is_a_value():
    """Equal where all its numbers are, in a set once; named one by one, as nine of them would be mixed up."""
    assert {touch(), touch()} == {touch()} != {touch(loss=0.3)}
    assert touch().ended and not touch(release=float("nan")).ended
    with pytest.raises(TypeError):
        Touch(*dataclasses.astuple(touch()))
