"""Joints with play in scenario files."""

import json
import math

import pytest
from scenario_files import DELETED, H

from antenna_pin import contact
from antenna_pin.scenario import IdealClearance, LawChange, LawSpec, PlanarClearance, Scenario


def test_the_laws_of_bore_and_flanges(folder):
    """In common, apart, changed; the unit of a stiffness follows the exponent of its law."""
    hinge = folder.load().clearance["hinge"]
    assert (
        hinge.normal
        == hinge.radial_law
        == LawSpec(law="lankarani-nikravesh", parameters={"restitution": 0.9})
    )
    assert hinge.axial == LawChange(parameters={"stiffness": 1e11})
    assert hinge.axial_law == LawSpec(
        law="lankarani-nikravesh", parameters={"restitution": 0.9, "stiffness": 1e11}
    )
    hinge = folder.load({H + "axial": {"law": "hertz"}, H + "normal.stiffness": 1e9}).clearance["hinge"]
    assert hinge.axial_law == LawSpec(law="hertz")
    changes = {
        H + "normal": DELETED,
        H + "axial": {"law": "hertz"},
        H + "radial": {"law": "hertz", "stiffness": 1},
    }
    hinge = folder.load(changes).clearance["hinge"]
    assert (hinge.radial_law.parameters, hinge.axial_law.parameters) == ({"stiffness": 1.0}, {})
    changes = {
        H + "normal.exponent": 2,
        H + "normal.stiffness": "1 N/mm**2",
        H + "axial": {"stiffness": "2 N/m**2"},
    }
    hinge = folder.load(changes).clearance["hinge"]
    assert hinge.radial_law.parameters["stiffness"] == 1e6
    assert hinge.axial_law.parameters == {"restitution": 0.9, "exponent": 2.0, "stiffness": 2.0}


JOHNSON = {"law": "johnson", "dissipation": "flores", "restitution": 0.8}


def test_a_dissipation_is_named_beside_an_elastic_law(folder):
    """Another one keeps the parameters that it knows; a case may change it."""
    scenario = folder.load({H + "normal": JOHNSON, H + "axial": DELETED})
    hinge = scenario.clearance["hinge"]
    assert hinge.normal == LawSpec(law="johnson", dissipation="flores", parameters={"restitution": 0.8})
    assert json.loads(scenario.model_dump_json())["clearance"]["hinge"]["normal"] == JOHNSON
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario

    def axial_law(change):
        changes = {H + "normal": JOHNSON, H + "axial": change, "cases": {}}
        return folder.load(changes).clearance["hinge"].axial_law

    assert axial_law({"dissipation": "tsuji", "effective_mass": "2 kg"}) == LawSpec(
        law="johnson", dissipation="tsuji", parameters={"restitution": 0.8, "effective_mass": 2.0}
    )
    assert axial_law({"dissipation": "kelvin-voigt", "damping": "3 N*s/m"}).parameters == {"damping": 3.0}
    assert axial_law({"restitution": 0.5}) == LawSpec(
        law="johnson", dissipation="flores", parameters={"restitution": 0.5}
    )
    assert axial_law({"law": "hertz"}) == LawSpec(law="hertz")
    changes = {
        H + "normal": JOHNSON,
        H + "axial": DELETED,
        "cases.elastic.clearance.hinge.normal": {"dissipation": "hu-guo"},
    }
    law = folder.load(changes, case="elastic").clearance["hinge"].radial_law
    assert law == LawSpec(law="johnson", dissipation="hu-guo", parameters={"restitution": 0.8})


def test_a_line_law_takes_dimensions_and_modulus_from_the_joint_or_is_given_them(folder):
    given = {"length": "20 mm", "modulus": "100 GPa", "journal_radius": "9 mm"}
    changes = {
        H + "normal": JOHNSON | given,
        H + "axial": DELETED,
        H + "journal_material": DELETED,
        "cases": {},
    }
    parameters = folder.load(changes).clearance["hinge"].normal.parameters
    assert parameters == {"restitution": 0.8, "length": 0.02, "modulus": 1e11, "journal_radius": 0.009}
    changes[H + "normal"] = JOHNSON
    message = "clearance.hinge.journal_material is missing; it decides the modulus, or give normal.modulus"
    assert folder.refusal(changes).startswith(message)


def test_materials_are_not_needed_where_the_stiffness_is_given(folder):
    changes = {
        H + "journal_material": DELETED,
        H + "bearing_material": DELETED,
        H + "normal.stiffness": "1e10 N/m**1.5",
    }
    missing = (
        "clearance.hinge.journal_material is missing; it decides the stiffness, or give normal.stiffness"
    )
    assert folder.refusal(changes) == f"{missing} (in case elastic)"
    hinge = folder.load(changes | {"cases.elastic": DELETED}).clearance["hinge"]
    assert (hinge.journal_material, hinge.radial_law.parameters["stiffness"]) == (None, 1e10)


@pytest.mark.parametrize("model", ["ideal", "constraint"])
def test_a_joint_without_play_needs_no_dimensions(folder, model):
    scenario = folder.load({"clearance.hinge": {"model": model}, "cases": {}})
    assert scenario.clearance["hinge"] == IdealClearance(model=model)
    full = folder.load({H + "model": model}).clearance["hinge"]
    assert (full.model, full.bearing_radius) == (model, 0.01)


def test_a_planar_joint_needs_no_flanges(folder):
    """And axial clearance may be zero."""
    planar = {
        "model": "planar",
        "bearing_radius": "10 mm",
        "journal_radius": "9.5 mm",
        "normal": {"law": "hertz", "stiffness": "1e10 N/m**1.5"},
    }
    joint = folder.load({"clearance.hinge": planar, "cases": {}}).clearance["hinge"]
    assert isinstance(joint, PlanarClearance)
    assert joint.radial_play == pytest.approx(0.0005, abs=1e-17)  # round-off of 10 mm
    assert math.isnan(joint.axial_play)
    assert folder.load({H + "axial_clearance": "0 mm"}).clearance["hinge"].axial_play == 0.0
    changes = {H + "axial_clearance": DELETED, H + "flange_distance": "50 mm"}
    assert folder.load(changes).clearance["hinge"].axial_play == 0.0


# A value that is fit for parameters of that name, which must agree with others.
FIT = {"journal_radius": 0.0098, "bearing_radius": 0.01, "dynamic": 0.4}


@pytest.mark.parametrize("family", ["NORMAL_LAWS", "FRICTION_LAWS"])
def test_every_law_of_the_registry_can_be_named(family):
    for name, law in getattr(contact, family).items():
        declared = contact.law_parameters(law)
        parameters = {
            key: f"1.5 {parameter.unit.replace('exponent', str(declared['exponent'].default))}"
            if "exponent" in parameter.unit
            else FIT.get(key, 0.5 + 0.1 * i)
            for i, (key, parameter) in enumerate(declared.items())
            if parameter.required
        }
        spec = LawSpec(law=name, parameters=parameters)
        assert spec.parameters.keys() == parameters.keys()
        assert isinstance(law(**spec.parameters), law)


def test_every_dissipation_of_the_registry_can_be_named():
    """With any number for each of its parameters."""
    for name, dissipation in contact.DISSIPATIONS.items():
        parameters = dict.fromkeys(contact.law_parameters(dissipation), 0.5)
        spec = LawSpec(law="hertz", dissipation=name, parameters={"stiffness": 1e9} | parameters)
        law = contact.make_normal_law(spec.law, spec.parameters, spec.dissipation)
        assert isinstance(law.parts.dissipation, dissipation)
