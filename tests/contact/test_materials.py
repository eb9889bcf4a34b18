"""The shipped materials and pairs: plausible, sourced, and found by name."""

import math

import pytest

from antenna_pin.contact import MATERIAL_PAIRS, MATERIALS, MaterialPair, material_pairs


@pytest.mark.parametrize("name", MATERIALS)
def test_materials_are_plausible_and_sourced(name):
    material = MATERIALS[name]
    assert material.source
    assert 1e8 < material.young < 1e12
    assert 0.2 < material.poisson < 0.5
    assert 500.0 < material.density < 2e4


def test_steel_is_as_it_was():
    assert (MATERIALS["steel"].young, MATERIALS["steel"].poisson) == (207e9, 0.3)


def test_pairs_are_of_known_materials_and_sourced():
    for pair in MATERIAL_PAIRS:
        assert pair.first in MATERIALS and pair.second in MATERIALS
        assert pair.condition and pair.source
        given = [x for x in (pair.restitution, pair.static, pair.dynamic) if not math.isnan(x)]
        assert given and all(0.0 <= x < 5.0 for x in given)


def test_pairs_are_found_in_either_order():
    assert material_pairs("steel", "bronze") == material_pairs("bronze", "steel") != ()
    assert len(material_pairs("steel-52100", "steel-52100")) == 2  # dry, and with a film
    assert material_pairs("steel", "steel")[0].restitution == 0.9
    assert material_pairs("steel", "nylon-66") == ()


def test_tables_are_read_only():
    with pytest.raises(TypeError):
        MATERIALS["steel"] = None


@pytest.mark.parametrize(("name", "value"), [("restitution", 1.2), ("static", -0.1), ("dynamic", -0.1)])
def test_refuses_what_is_no_pair(name, value):
    with pytest.raises(ValueError, match=f"^MaterialPair: {name} must be"):
        MaterialPair(first="a", second="b", condition="c", source="d", **{name: value})
