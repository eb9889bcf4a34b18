"""Fits and temperatures of scenarios: dimensions and preload by closed forms, interference, refusals."""

import json
import math

import pytest

from antenna_pin import load_scenario
from antenna_pin.elements import BallBearing
from antenna_pin.errors import AntennaPinError
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.assemble import (
    at_temperature,
    build_system,
    closing_temperature,
    joint_play,
    tolerance_chain,
)
from antenna_pin.scenario.assemble.temperature import axial_load

FIT = {"clearance.hinge.fit": "20 H7/g6", "materials.steel.expansion": 11.7e-6}
ALLOY = {**FIT, "clearance.hinge.journal_material": "aluminium-7075-t6"}


def pendulum(**changes):
    return load_scenario("pendulum", overrides={**FIT, **changes})


def test_a_fit_gives_the_radii_and_survives_json():
    joint = load_scenario(
        "pendulum", overrides={**FIT, "clearance.hinge.fit_hole": 1, "clearance.hinge.fit_shaft": -1}
    )
    again = Scenario.model_validate_json(joint.model_dump_json())
    for one in (joint, again):
        table = one.clearance["hinge"]
        # 20.021 mm and 19.980 mm, each rounded once more.
        assert (table.bearing_radius, table.journal_radius) == pytest.approx(
            (10.0105e-3, 9.990e-3), rel=1e-15
        )
    assert again.with_overrides({"clearance.hinge.fit": "20 H7/f7"}).clearance["hinge"].fit == "20 H7/f7"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"clearance.hinge.fit": "30 H7/p6"}, "fit must leave play, got '30 H7/p6' .* none at any size"),
        (
            {"clearance.hinge.fit": "20 H7/g6", "clearance.hinge.radial_clearance": "0.1 mm"},
            "radial_clearance must be left out with fit",
        ),
        (
            {
                "clearance.hinge.fit": "20 H7/g6",
                "temperature": "40 degC",
                "clearance.hinge.journal_radius": "9 mm",
            },
            "journal_radius must be left out with fit",
        ),
        ({"clearance.hinge.fit_hole": 0.5}, "fit_hole must be left out without fit"),
        (
            {"clearance.hinge.fit": "20 H7/g6", "clearance.hinge.fit_shaft": 2},
            "fit_shaft must be from -1 to 1",
        ),
        ({"temperature": "-300 degC"}, "temperature.all must be above absolute zero, got '-300 degC'"),
        (
            {"temperature.all": "20 degC", "temperature.reference": "-274 degC"},
            "temperature.reference must be above absolute zero",
        ),
        (
            {
                "temperature.tables.f": {
                    "key": "clearance.hinge.friction.static",
                    "temperature": ["-280 degC", "20 degC"],
                    "factor": [1, 2],
                }
            },
            r"temperature.tables.f.temperature(\[0\])? must be above absolute zero",
        ),
        ({"clearance.hinge.fit": "20 H7/x6"}, "of a letter among a b c"),
        ({"clearance.hing.fit": "20 H7/g6"}, "or did you mean clearance.hinge"),
        (
            {"temperature.tables.f": {"key": "duration", "temperature": [1, 2], "factor": [1]}},
            "factor must have 2 entries",
        ),
        ({"tolerances.play.dimensions.pin": {"nominal": 1}}, "plus is missing"),
        ({"tolerances.play.dimensions.pin": {"size": "20 H7", "plus": 1}}, "plus must be left out with size"),
    ],
)
def test_refusals_of_tables(changes, words):
    with pytest.raises(AntennaPinError, match=words) as error:
        load_scenario("pendulum", overrides=changes)
    assert "\n" not in str(error.value)


def test_a_fit_of_a_rectangular_slider_is_refused():
    with pytest.raises(AntennaPinError, match="fit must be left out where no hole and shaft leave the play"):
        load_scenario("slider", overrides={"clearance.slide.fit": "20 H7/g6"})


def test_a_bore_grows_and_the_play_with_it():
    """c = R_i (1 + a_b dT) - R_j (1 + a_j dT), of one material and of two; lengths likewise."""
    rise = 60.0
    for changes, journal in ((FIT, 11.7e-6), (ALLOY, 23.4e-6)):
        cold = load_scenario("pendulum", overrides=changes)
        hot = at_temperature(cold.with_overrides({"temperature": "80 degC"})).clearance["hinge"]
        before = cold.clearance["hinge"]
        bore, pin = 1.0 + 11.7e-6 * rise, 1.0 + journal * rise
        expected = before.bearing_radius * bore - before.journal_radius * pin
        assert hot.radial_play == pytest.approx(expected, abs=1e-17)  # round-off of radii, 2e-18 each
        sizes, old = hot.sizes(), before.sizes()
        assert sizes["bearing_length"] == pytest.approx(old["bearing_length"] * bore, rel=1e-14)
        assert sizes["flange_distance"] == pytest.approx(old["flange_distance"] * pin, rel=1e-14)
        assert sizes["flange_radius"] == pytest.approx(old["flange_radius"] * pin, rel=1e-14)
        assert hot.fit is None


def test_an_interference_is_refused_with_its_temperature():
    scenario = load_scenario("pendulum", overrides={**ALLOY, "temperature": "180 degC"})
    # 12 um over 10 mm times the difference of expansions, but for 1e-3 of the radii.
    gone = 20.0 + 12e-6 / (0.00999325 * 23.4e-6 - 0.01000525 * 11.7e-6)
    assert closing_temperature(scenario, "hinge") - 273.15 == pytest.approx(gone, rel=1e-9)
    with pytest.raises(
        AntennaPinError, match=rf"interference of .* at 180 degC; the play is gone from {gone:.6g} degC on"
    ):
        build_system(scenario)


@pytest.mark.parametrize(
    ("model", "name"),
    [("planar", "hinge"), ("spherical", "hinge"), ("cylindrical", "slide"), ("prismatic", "slide")],
)
def test_every_kind_of_play_grows(model, name):
    case = {"planar": "pendulum", "spherical": "pendulum"}.get(model, "slider")
    changes = {f"clearance.{name}.model": model, "temperature": "120 degC"}
    cold = load_scenario(
        case, overrides={k: v for k, v in changes.items() if k != "temperature"} | sizes_of(model)
    )
    hot = at_temperature(
        cold.with_overrides({"temperature": "120 degC", "materials.steel.expansion": 11.7e-6})
    )
    before, after = cold.clearance[name].sizes(), hot.clearance[name].sizes()
    factor = 1.0 + 11.7e-6 * 100.0
    for key, value in before.items():
        assert after[key] == pytest.approx(value * (1.0 if key == "roll" else factor), rel=1e-14), key


def sizes_of(model):
    if model != "cylindrical":
        return {}
    return {"clearance.slide.bearing_radius": "10 mm", "clearance.slide.radial_clearance": "0.1 mm"}


def test_numbers_follow_their_tables():
    """Friction falls by half over 100 K; Young's modulus by 5 %, and with it the stiffness of the contact."""
    tables = {
        "temperature.all": "60 degC",
        "temperature.tables.restitution": {
            "key": "clearance.hinge.normal.restitution",
            "temperature": ["0 degC", "100 degC"],
            "factor": [1.0, 0.5],
        },
        "temperature.tables.young": {
            "key": "materials.steel.young",
            "temperature": ["20 degC", "120 degC"],
            "value": ["200 GPa", "190 GPa"],
        },
    }
    cold = pendulum()
    hot = at_temperature(pendulum(**tables))
    first = cold.clearance["hinge"].normal.parameters["restitution"]
    assert hot.clearance["hinge"].normal.parameters["restitution"] == pytest.approx(0.7 * first, rel=1e-12)
    assert hot.material("steel").young == pytest.approx(196e9, rel=1e-12)
    short = {"temperature.tables.young": tables["temperature.tables.young"] | {"temperature": [293, 300]}}
    with pytest.raises(
        AntennaPinError, match="tables.young: must reach 60 degC, got 19.85 degC to 26.85 degC"
    ):
        at_temperature(pendulum(**{**tables, **short}))


def test_the_preload_of_a_pair_follows_the_housing():
    """Back-to-back rows share half of the difference of lengths; a rigid contact angle gives K x^1.5."""
    scenario = load_scenario("reaction_wheel")
    (table,) = scenario.families["bearings"].values()
    name = "shaft.1"  # which stands in quotes
    scenario = scenario.model_copy(update={"bearings": {name: table}})
    made = table.build()
    assert isinstance(made, BallBearing)
    hot = scenario.with_overrides(
        {
            "temperature.all": "60 degC",
            f'temperature.bearings."{name}".shaft_material': "steel-440c",
            f'temperature.bearings."{name}".housing_material': "aluminium-7075-t6",
        }
    )
    after = at_temperature(hot).families["bearings"][name].build().preload
    pressed = 0.5 * made.spread * 40.0 * (23.4e-6 - 10.2e-6)
    sense = {"back-to-back": 1.0, "face-to-face": -1.0}[made.arrangement]
    assert after == pytest.approx(axial_load(made, sense * pressed), rel=1e-9)
    # To first order by the axial stiffness of a row at the preload, half that of the pair.
    slope = 0.5 * made.stiffness[2, 2]
    small = axial_load(made, 1e-10) - axial_load(made, 0.0)
    assert small == pytest.approx(slope * 1e-10, rel=1e-3) and axial_load(made, 0.0) == pytest.approx(
        made.preload
    )


def test_a_run_says_its_temperature_and_carries_the_play_used():
    system = build_system(load_scenario("pendulum", overrides={**ALLOY, "temperature": "80 degC"}))
    assert system.assumed[0].startswith("hinge: radial play 12")
    assert "at 20 degC is" in system.assumed[0] and "bearing at 80 degC" in system.assumed[0]
    play = system.clearances[0].geometry.radial_clearance
    assert play == pytest.approx(4.9931625e-6, rel=1e-9)


def test_a_chain_of_a_scenario_grows_with_its_materials():
    """A pin of aluminium in a housing of steel: 50.3 and 50 mm."""
    chain = {
        "dimensions": {
            "pin": {
                "nominal": "50.3 mm",
                "plus": "0.05 mm",
                "minus": "-0.05 mm",
                "material": "aluminium-7075-t6",
            },
            "bush": {
                "nominal": "50 mm",
                "plus": 0,
                "minus": "-0.1 mm",
                "coefficient": -1,
                "material": "steel",
            },
        }
    }
    scenario = pendulum(**{"tolerances.end_play": json.loads(json.dumps(chain)), "temperature": "120 degC"})
    found = tolerance_chain(scenario, "end_play")
    assert found.nominal == pytest.approx(0.0503 * (1 + 23.4e-4) - 0.05 * (1 + 11.7e-4), rel=1e-12)
    assert math.isclose(found.tolerance, 1e-4 * (1 + 23.4e-4) + 1e-4 * (1 + 11.7e-4), rel_tol=1e-12)


@pytest.mark.parametrize(
    ("side", "part", "sign"), [("parent", "bar", -1), ("child", "bar", 1), ("child", "stand", -1)]
)
def test_the_part_that_has_the_bearing_grows_the_bore(side, part, sign):
    """80 K of steel on 9.9 mm of journal, or on 10 mm of bore, whichever link carries it."""
    changes = {
        "materials.steel.expansion": 11.7e-6,
        "clearance.hinge.bearing_on": side,
        "temperature": {"all": "20 degC", "parts": {part: "100 degC"}},
    }
    play = joint_play(load_scenario("pendulum", overrides=changes), "hinge").radial
    radius = 0.01 if sign > 0 else 0.0099
    assert play - 1e-4 == pytest.approx(sign * 80.0 * 11.7e-6 * radius, rel=1e-9)
