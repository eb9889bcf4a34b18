"""Scenarios are found; what the shipped one says."""

import subprocess
import sys
from pathlib import Path

import pytest

from antenna_pin.errors import ScenarioError, UnknownNameError
from antenna_pin.scenario import (
    ContactClearance,
    IdealClearance,
    LawSpec,
    Scenario,
    list_scenarios,
    load_scenario,
    models_path,
)

# --- finding scenarios ---


def test_a_scenario_is_found_by_file_and_by_folder(folder):
    scenario = folder.load()
    (folder.path / "my").mkdir()
    for name in ("my.toml", "body.urdf", "torque.csv"):
        target = "scenario.toml" if name == "my.toml" else name
        (folder.path / "my" / target).write_text((folder.path / name).read_text())
    for place in ("my", "my/", Path("my"), "my/scenario.toml", folder.path / "my"):
        assert load_scenario(place).name == "my"
    assert load_scenario(folder.path / "my.toml") == scenario


@pytest.mark.parametrize(
    ("place", "error", "message"),
    [
        ("bai2002", UnknownNameError, "'bai2002' is unknown; did you mean bai2020? known: bai2020"),
        ("no.toml", ScenarioError, "no.toml: no such file or folder; shipped scenarios: bai2020"),
        ("no/where", ScenarioError, "no/where: no such file or folder; shipped scenarios: bai2020"),
        (".", ScenarioError, ".: the folder has no scenario.toml; give one of its files: my.toml"),
    ],
)
def test_what_is_not_found_is_refused(folder, place, error, message):
    folder.load()
    with pytest.raises(error) as refused:
        load_scenario(place)
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"a = ", "is not TOML: Invalid value (at end of document)"),
        (b"a = 1\na = 2", "is not TOML: Cannot overwrite a value (at end of document)"),
        (b"\xff\xfe", "is not UTF-8 text (byte 0)"),
    ],
)
def test_what_is_no_toml_is_refused(folder, content, message):
    (folder.path / "my.toml").write_bytes(content)
    with pytest.raises(ScenarioError) as refused:
        load_scenario("my.toml")
    assert str(refused.value) == f"my.toml: {message}"


def test_names_of_files_in_messages_and_marks_in_front(folder):
    """A file stands in the message as it was named; a byte order mark is no harm."""
    folder.load()
    (folder.path / "my.toml").write_bytes(b"\xef\xbb\xbf" + (folder.path / "my.toml").read_bytes())
    assert load_scenario("my.toml").title == "A test"
    folder.load()
    (folder.path / "scenario.toml").write_text("duration = 1\n[mechanism]\nurdf = 3")
    for place, label in ((".", "scenario.toml"), ("./scenario.toml", "./scenario.toml")):
        with pytest.raises(ScenarioError) as refused:
            load_scenario(place)
        assert str(refused.value) == f"{label}: mechanism.urdf must be text, got 3"


# --- the shipped scenario ---


def test_shipped_scenarios_are_listed():
    """With their cases; the antenna runs case 3 by default."""
    (bai,) = [summary for summary in list_scenarios() if summary.name == "bai2020"]
    assert bai.title == "Dual-axis satellite antenna with a 3D revolute clearance joint"
    names = ["case1", "case1-constraint", "case2-planar", "case2-contact", "case3", "case4", "case5"]
    names += ["flexible", "flexible-ideal", "petals", "petals-ideal"]
    names += [f"nod-{frequency}hz" for frequency in (5, 10, 20, 35, 50)]
    assert [case.name for case in bai.cases] == names
    assert all(case.description for case in bai.cases)
    assert (models_path() / "bai2020" / "scenario.toml").is_file()
    assert load_scenario("bai2020").case == "case3"


@pytest.mark.parametrize("name", [summary.name for summary in list_scenarios()])
def test_every_case_of_every_shipped_scenario_loads(name):
    (summary,) = [one for one in list_scenarios() if one.name == name]
    for case in summary.cases:
        scenario = load_scenario(name, case.name)
        assert (scenario.name, scenario.case, scenario.description) == (name, *case)
        assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario


@pytest.mark.parametrize(
    ("case", "model", "axial_clearance"),
    [
        ("case1", IdealClearance, 2e-4),
        ("case1-constraint", IdealClearance, 2e-4),
        ("case2-contact", ContactClearance, 0.0),
        ("case3", ContactClearance, 2e-4),
        ("case5", ContactClearance, 4e-4),
    ],
)
def test_the_antenna_has_the_numbers_of_the_paper(case, model, axial_clearance):
    """Bai and Zhao (2020), Tables 2 to 4, exactly."""
    scenario = load_scenario("bai2020", case)
    joint = scenario.clearance["elevation"]
    assert isinstance(joint, model)
    assert joint.axial_clearance == axial_clearance
    assert (joint.bearing_radius, joint.radial_clearance, joint.bearing_length) == (0.01, 0.0002, 0.05)
    assert (joint.bearing_outer_radius, joint.flange_radius) == (0.012, 0.014)
    assert joint.normal == LawSpec(law="lankarani-nikravesh", parameters={"restitution": 0.9})
    assert joint.friction.parameters == {
        "static": 0.15,
        "dynamic": 0.1,
        "static_speed": 0.1,
        "dynamic_speed": 1.0,
    }
    assert scenario.duration == 5.0
    torques = {
        name: (drive.joint, drive.amplitude, drive.frequency) for name, drive in scenario.drives.items()
    }
    assert torques == {"azimuth": ("azimuth", 10.0, 1.0), "elevation": ("elevation", 4.0, 1.0)}
    assert scenario.mechanism.base == "free"
    steel = scenario.material("steel")
    assert (steel.young, steel.poisson) == (207e9, 0.3)


def test_a_shipped_name_goes_before_a_folder_of_that_name(folder):
    (folder.path / "bai2020").mkdir()
    assert load_scenario("bai2020").folder == (models_path() / "bai2020").resolve()
    with pytest.raises(ScenarioError, match=r"^bai2020: the folder has no scenario\.toml$"):
        load_scenario(Path("bai2020"))


def test_missing_models_are_told(monkeypatch, tmp_path):
    monkeypatch.setattr(
        "antenna_pin.scenario.shipped.__file__", str(tmp_path / "p" / "scenario" / "shipped.py")
    )
    with pytest.raises(
        ScenarioError, match=r"^the shipped models are missing: neither .*_models nor .*models is"
    ):
        models_path()
    (tmp_path / "models").mkdir(parents=True)
    assert models_path() == tmp_path / "models"  # a checkout
    (tmp_path / "p" / "_models").mkdir(parents=True)
    assert models_path() == tmp_path / "p" / "_models"  # an installed package


def test_listing_scenarios_imports_no_heavy_library():
    code = (
        "import sys, antenna_pin.scenario as s; s.list_scenarios();"
        "sys.exit(any(m in sys.modules for m in ('pint', 'numpy', 'numba', 'pinocchio')))"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
