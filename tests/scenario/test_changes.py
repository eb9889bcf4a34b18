"""What is set over a file, or changed in a scenario that is loaded."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenario_files import TABLES, URDF

from antenna_pin.errors import ScenarioError
from antenna_pin.scenario import Scenario
from antenna_pin.scenario.merge import read_overrides, toml_value

# --- overrides ---


@pytest.mark.parametrize(
    ("text", "keys", "value"),
    [
        ("integrator.rtol=1e-9", ("integrator", "rtol"), 1e-9),
        (" integrator.rtol = 1e-9 ", ("integrator", "rtol"), 1e-9),
        ("clearance.hinge.radial_clearance=0.1 mm", ("clearance", "hinge", "radial_clearance"), "0.1 mm"),
        ('clearance."my hinge".geometry=closed-form', ("clearance", "my hinge", "geometry"), "closed-form"),
        ("mechanism.gravity=[0, 0, -9.81]", ("mechanism", "gravity"), [0, 0, -9.81]),
        ('a={kind="constant", value=1}', ("a",), {"kind": "constant", "value": 1}),
        ("a.replace=true", ("a", "replace"), True),
        ('a="1"', ("a",), "1"),
        ("a=1", ("a",), 1),
        ("a=x=y", ("a",), "x=y"),
        ("a=", ("a",), ""),
        ("a=2026-01-01", ("a",), "2026-01-01"),
        ("a=1\nb=2", ("a",), "1\nb=2"),
    ],
)
def test_overrides_are_toml_or_plain_text(text, keys, value):
    tree, record = read_overrides([text])
    for key in keys:
        tree = tree[key]
    assert tree == value
    # What is recorded says the same again.
    assert read_overrides(record) == read_overrides([text])


def test_overrides_from_python():
    tree, record = read_overrides(
        {
            "integrator.rtol": np.float64(1e-9),
            "integrator": {"step": 1e-6},
            "mechanism.gravity": np.array([0.0, 0.0, -1.0]),
            "mechanism.urdf": Path("a") / "b.urdf",
            "output.rate": "1 kHz",
            "x": (1, True),
        }
    )
    assert tree == {
        "integrator": {"rtol": 1e-9, "step": 1e-6},
        "mechanism": {"gravity": [0.0, 0.0, -1.0], "urdf": "a/b.urdf"},
        "output": {"rate": "1 kHz"},
        "x": [1, True],
    }
    assert record[0] == "integrator.rtol=1e-09"
    assert read_overrides(record)[0] == tree
    assert read_overrides("a.b=1") == read_overrides(["a.b=1"])


@given(value=TABLES | st.lists(st.floats(allow_nan=False)) | st.booleans())
def test_values_are_written_as_toml(value):
    assert tomllib.loads(f"value = {toml_value(value)}") == {"value": value}


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["integrator.rtol"], "override 'integrator.rtol' must be KEY=VALUE, as in integrator.rtol=1e-9"),
        (["a..b=1"], "override 'a..b': its key must be keys joined by dots, as in integrator.rtol"),
        (["=1"], "override '': its key must be keys joined by dots"),
        (["my hinge.a=1"], "override 'my hinge.a': its key must be keys joined by dots"),
        (["a\nb=1"], "override 'a\\nb': its key must be keys joined by dots"),
        (["a=1", "a.b=2"], "override a.b: a is set to 1, which has no keys"),
        ({"a": None}, "override a must be a number, text, an array or a table, got None"),
        (["default_case=x"], "override default_case: choose a case, and set its values without default_case"),
        (["cases.a.duration=1"], "override cases: choose a case, and set its values without cases"),
    ],
)
def test_bad_overrides_are_refused(folder, overrides, message):
    with pytest.raises(ScenarioError) as refused:
        folder.load(overrides=overrides)
    assert str(refused.value).startswith(message)
    assert len(str(refused.value).splitlines()) == 1


def test_overrides_are_laid_over_the_case(folder):
    """They remove what their keys exclude, and may replace a table."""
    overrides = ["clearance.hinge.radial_clearance=0.1 mm", "integrator.rtol=1e-9"]
    scenario = folder.load(case="tight", overrides=overrides)
    assert scenario.clearance["hinge"].radial_clearance == 1e-4
    assert scenario.integrator.rtol == 1e-9
    assert scenario.overrides == ('clearance.hinge.radial_clearance="0.1 mm"', "integrator.rtol=1e-09")
    assert folder.load(case="tight", overrides=scenario.overrides) == scenario
    hinge = folder.load(overrides=["clearance.hinge.journal_radius=9.9 mm"]).clearance["hinge"]
    assert (hinge.radial_clearance, hinge.journal_radius) == (None, 0.0099)
    both = ["clearance.hinge.journal_radius=9.9 mm", "clearance.hinge.radial_clearance=0.1 mm"]
    assert folder.refusal(overrides=both) == (
        "clearance.hinge must have exactly one of radial_clearance and journal_radius, got both "
        "(set by an override)"
    )
    text = 'drives.azimuth={replace=true, kind="constant", value="1 N*m"}'
    assert folder.load(overrides=[text]).drives["azimuth"].value == 1.0
    apart = ["drives.azimuth.replace=true", "drives.azimuth.kind=constant", "drives.azimuth.value=1 N*m"]
    assert folder.load(overrides=apart).drives == folder.load(overrides=[text]).drives


def test_what_an_override_sets_is_told_as_such(folder):
    for text, message in (
        ("integrator.rtol=-1", "integrator.rtol must be between 0 and 1, got -1 (set by an override)"),
        ("integrator.rtoll=1", "integrator.rtoll is unknown; did you mean rtol? (set by an override)"),
        (
            "drives.motor.kind=sine",
            "drives.motor.value is unknown; known here: kind, joint, axis, on, amplitude, frequency, phase "
            "(an override sets kind: add replace = true to drop the old keys)",
        ),
        (
            "clearance.hing.geometry=coal",
            "clearance.hing.model is missing; give one of contact, planar, spherical, prismatic, "
            "cylindrical, ideal, constraint (or did you mean clearance.hinge?) (set by an override)",
        ),
    ):
        assert folder.refusal(overrides=[text]) == message


# --- changing a loaded scenario ---


def test_a_loaded_scenario_can_be_changed(folder):
    scenario = folder.load(case="tight")
    for path in folder.path.iterdir():
        path.unlink()  # nothing is read again
    changed = scenario.with_overrides({"clearance.hinge.journal_radius": "9.9 mm", "integrator.rtol": 1e-5})
    assert changed.clearance["hinge"].journal_radius == 0.0099
    assert changed.clearance["hinge"].radial_clearance is None
    assert changed.overrides == ('clearance.hinge.journal_radius="9.9 mm"', "integrator.rtol=1e-05")
    assert changed.drives == scenario.drives
    assert (changed.case, changed.urdf_text) == ("tight", URDF)
    assert scenario.with_overrides([]) == scenario
    again = Scenario.model_validate_json(scenario.model_dump_json()).with_overrides(changed.overrides)
    assert again == changed


def test_a_change_is_the_same_before_and_after_loading(folder):
    for overrides in (
        ["clearance.hinge.normal.restitution=0.5"],
        ["clearance.hinge.axial.stiffness=1e9 N/m**1.5", "drives.azimuth.amplitude=3 N"],
        ["clearance.hinge.model=ideal"],
        ['drives.slow={replace=true, kind="constant", value="3 N"}'],
    ):
        assert folder.load().with_overrides(overrides) == folder.load(overrides=overrides)


def test_a_change_may_name_other_files(folder):
    (folder.path / "other.urdf").write_text("<robot/>")
    (folder.path / "other.csv").write_text("time,torque\n0,1\n2,3\n")
    overrides = ["mechanism.urdf=other.urdf", "drives.slow.file=other.csv"]
    changed = folder.load().with_overrides(overrides)
    assert changed.urdf_text == "<robot/>"
    assert changed.drives["slow"].torque == (1.0, 3.0)
    numbers = folder.load().with_overrides({"drives.slow.torque": [1, 2, 3]}).drives["slow"]
    assert (numbers.file, numbers.time, numbers.torque) == (None, (0.0, 0.5, 1.0), (1.0, 2.0, 3.0))


def test_a_stiffness_is_not_taken_for_one_of_another_exponent(folder):
    """1e11 N/m^1.5 is not 1e11 N/m^2, whichever way the exponent changes."""
    message = "clearance.hinge.axial.stiffness must be a stiffness [N/m**2], got"
    overrides = ["clearance.hinge.normal.exponent=2"]
    assert folder.refusal(overrides=overrides).startswith(message)
    with pytest.raises(ScenarioError) as refused:
        folder.load().with_overrides(overrides)
    assert str(refused.value).startswith(f"scenario my: {message} '100000000000.0 N/m**1.5'")


def test_a_bad_change_is_refused(folder):
    scenario = folder.load()
    for overrides, message in (
        (["integrator.rtol=0"], "integrator.rtol must be between 0 and 1, got 0 (set by an override)"),
        (["name=x"], "name is unknown; known here: format, title,"),
        (
            {"drives.slow": {"file": "a.csv", "time": [0, 1]}},
            "drives.slow must have either file, or time and",
        ),
    ):
        with pytest.raises(ScenarioError) as refused:
            scenario.with_overrides(overrides)
        assert str(refused.value).startswith(f"scenario my: {message}")
