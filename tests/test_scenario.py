"""Scenario files: what they say is carried exactly, what is wrong in them is refused in one line."""

import copy
import json
import math
import pickle
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import antenna_pin.scenario as scenario_package
from antenna_pin import contact
from antenna_pin.errors import AntennaPinError, InvalidParameterError, ScenarioError, UnknownNameError
from antenna_pin.scenario import (
    DRIVE_SPECS,
    SPRING_SPECS,
    ContactClearance,
    IdealClearance,
    InitialBaseSpec,
    IntegratorSpec,
    JointSpec,
    LawChange,
    LawSpec,
    LinkSpec,
    MechanismSpec,
    OrbitSpec,
    OutputSpec,
    PlanarClearance,
    PointingSpec,
    Scenario,
    ShapeSpec,
    list_scenarios,
    load_scenario,
    models_path,
)
from antenna_pin.scenario.merge import merge, read_overrides, toml_value

URDF = '<robot name="r"><link name="body"/></robot>\n'
TORQUE = "time,torque\n0,0\n0.5,1.25\n1,-1e-3\n"

# Every table occurs, with values that differ from the defaults.
FILE = {
    "format": 1,
    "title": "A test",
    "source": "none",
    "duration": "2 s",
    "mechanism": {
        "urdf": "body.urdf",
        "gravity": [0, 0, "-9.81 m/s**2"],
        "allow_impossible_inertia": ["body"],
        "links": {
            "body": {
                "mass": "1 t",
                "inertia": [1, 2, "3 kg*m**2"],
                "centre_of_mass": ["1 mm", 0, 0],
                "shapes": {"box": {"size": [1, "20 cm", 3]}, "rod": {"radius": "5 cm", "length": "1 m"}},
            }
        },
        "joints": {"azimuth": {"origin_xyz": [0, 0, 0.5], "origin_rpy": [0, 0, "90 deg"], "axis": [0, 0, 2]}},
    },
    "materials": {
        "alloy": {"young": "70 GPa", "poisson": 0.33, "density": "2700 kg/m**3", "source": "a book"}
    },
    "clearance": {
        "hinge": {
            "model": "contact",
            "bearing_radius": "10 mm",
            "radial_clearance": "0.2 mm",
            "bearing_length": "50 mm",
            "axial_clearance": "0.2 mm",
            "bearing_outer_radius": "12 mm",
            "flange_radius": "14 mm",
            "offset": "-1 mm",
            "geometry": "closed-form",
            "approach_speed_floor": "0.2 mm/s",
            "maximum_depth": "0.1 mm",
            "journal_material": "steel",
            "bearing_material": "alloy",
            "normal": {"law": "lankarani-nikravesh", "restitution": 0.9},
            "axial": {"stiffness": "1e11 N/m**1.5"},
            "friction": {"law": "tanh", "coefficient_of_friction": 0.1, "transition_speed": "1 mm/s"},
        }
    },
    "drives": {
        "azimuth": {"kind": "sine", "amplitude": "10 N*m", "frequency": "1 Hz", "phase": "90 deg"},
        "motor": {"joint": "hinge", "kind": "constant", "value": "4 N*m", "axis": "journal"},
        "slow": {"joint": "azimuth", "kind": "table", "file": "torque.csv", "interpolation": "cubic"},
    },
    "springs": {"azimuth": {"stiffness": "3 N*mm/rad", "damping": "1 N*m*s/rad", "rest_angle": "1 deg"}},
    "initial": {
        "joints": {
            "azimuth": {"position": "10 deg", "velocity": "1 rpm"},
            "hinge": {"angle": 0.1, "rate": 0.2, "journal_position": ["10 um", 0, 0]},
        },
        "base": {
            "position": [1, 2, "3 km"],
            "attitude": [0, 0, 0.6, 0.8],
            "angular_velocity": [0, 0, "1 rpm"],
        },
    },
    "integrator": {
        "method": "rk4",
        "rtol": 1e-7,
        "step": "20 us",
        "first_step": "1 us",
        "scales": {"angle": "1 mrad", "clearance": 0.5},
    },
    "output": {"rate": "2 kHz"},
    "pointing": {
        "body": "body",
        "boresight": [0, 0, -2],
        "up": [1, 0, 0.5],
        "commanded": "orbit",
        "direction": [0, 0.1, 1],
        "direction_up": [1, 0, 0],
        "orbit": {"altitude": "500 km", "normal": [0, 0, 2], "nadir": [-3, 0, 0]},
    },
    "cases": {
        "tight": {"description": "less play", "clearance": {"hinge": {"radial_clearance": "10 um"}}},
        "by-radius": {"clearance": {"hinge": {"journal_radius": "9.9 mm", "flange_distance": "50.1 mm"}}},
        "elastic": {"clearance": {"hinge": {"normal": {"replace": True, "law": "hertz"}}}},
    },
}
DELETED = object()


@dataclass
class Folder:
    """A folder with a scenario file ``my.toml`` and the files it names, as the current folder."""

    path: Path

    def load(self, changes=(), case=None, overrides=(), file=FILE):
        """Write the file with the changes, given by dotted key, and load it."""
        document = copy.deepcopy(file)
        for dotted, value in dict(changes).items():
            table = document
            *outer, last = dotted.split(".")
            for key in outer:
                table = table.setdefault(key, {})
            if value is DELETED:
                del table[last]
            else:
                table[last] = value
        lines = [f"{key} = {toml_value(value)}" for key, value in document.items()]
        (self.path / "my.toml").write_text("\n".join(lines), encoding="utf-8")
        return load_scenario("my.toml", case, overrides)

    def refusal(self, changes=(), case=None, overrides=(), error=ScenarioError):
        """Return the message with which the file is refused, without the file's name."""
        with pytest.raises(AntennaPinError) as refused:
            self.load(changes, case, overrides)
        message = str(refused.value)
        assert type(refused.value) is error
        assert len(message.splitlines()) == 1
        assert message.startswith("my.toml: ")
        return message.removeprefix("my.toml: ")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "body.urdf").write_text(URDF, encoding="utf-8")
    (tmp_path / "torque.csv").write_text(TORQUE, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return Folder(tmp_path)


# --- what a file says ---


def test_values_are_in_si_units(folder):
    scenario = folder.load()
    assert (scenario.name, scenario.title, scenario.duration) == ("my", "A test", 2.0)
    assert (scenario.case, scenario.description, scenario.overrides) == (None, "", ())
    mechanism = scenario.mechanism
    assert mechanism.gravity == (0.0, 0.0, -9.81)
    assert mechanism.links["body"] == LinkSpec(
        mass=1000.0,
        inertia=(1.0, 2.0, 3.0),
        centre_of_mass=(0.001, 0.0, 0.0),
        shapes={"box": ShapeSpec(size=(1.0, 0.2, 3.0)), "rod": ShapeSpec(radius=0.05, length=1.0)},
    )
    assert mechanism.joints["azimuth"].origin_rpy == (0.0, 0.0, pytest.approx(math.pi / 2, rel=1e-15))
    hinge = scenario.clearance["hinge"]
    assert isinstance(hinge, ContactClearance)
    assert (hinge.bearing_radius, hinge.radial_play, hinge.axial_play) == (0.01, 0.0002, 0.0002)
    assert (hinge.journal_radius, hinge.flange_distance, hinge.offset) == (None, None, -0.001)
    assert hinge.friction.parameters == {"coefficient_of_friction": 0.1, "transition_speed": 0.001}
    assert scenario.drives["azimuth"].phase == pytest.approx(math.pi / 2, rel=1e-15)
    assert scenario.drives["motor"] == DRIVE_SPECS["constant"](
        joint="hinge", kind="constant", value=4.0, axis="journal", motion="rotation"
    )
    assert scenario.springs["azimuth"].stiffness == 0.003
    assert scenario.initial.joints["azimuth"].velocity == pytest.approx(2 * math.pi / 60, rel=1e-15)
    assert scenario.initial.base.position == (1.0, 2.0, 3000.0)
    assert scenario.integrator.scales.angle == 0.001
    assert scenario.output.rate == 2000.0
    assert scenario.pointing.orbit.altitude == 5e5


def test_files_are_carried_along(folder):
    scenario = folder.load()
    assert scenario.urdf_text == URDF
    assert scenario.folder == folder.path.resolve()
    assert scenario.urdf_path == folder.path.resolve() / "body.urdf"
    table = scenario.drives["slow"]
    assert (table.file, table.time, table.torque) == ("torque.csv", (0.0, 0.5, 1.0), (0.0, 1.25, -0.001))


def test_the_defaults_are_those_of_the_documentation(folder):
    file = {"duration": 1, "mechanism": {"urdf": "body.urdf"}}
    scenario = folder.load(file=file)
    assert scenario.format == 1
    assert scenario.mechanism == MechanismSpec(urdf="body.urdf", base="free", gravity=(0, 0, 0))
    integrator = scenario.integrator
    assert (integrator.method, integrator.rtol, integrator.first_step) == ("dormand-prince-853", 1e-8, None)
    assert (integrator.step, integrator.max_step, integrator.min_step) == (1e-5, 1e-2, 1e-14)
    assert integrator.scales.model_dump() == {
        "position": 1.0,
        "angle": 1.0,
        "velocity": 1.0,
        "angular_velocity": 1.0,
        "clearance": 1.0,
        "clearance_velocity": 0.01,
        "base": None,
    }
    assert scenario.output.rate == 1000.0
    assert scenario.pointing is None
    pointing = PointingSpec(body="dish", boresight=(0, 0, 1))
    assert (pointing.up, pointing.commanded, pointing.orbit) == (None, "ideal", None)
    orbit = OrbitSpec(period=5400)
    assert (orbit.normal, orbit.nadir) == ((0.0, 1.0, 0.0), (0.0, 0.0, -1.0))
    assert scenario.initial.base.attitude == (0.0, 0.0, 0.0, 1.0)
    drive = DRIVE_SPECS["sine"](joint="j", kind="sine", amplitude=1, frequency=1)
    assert (drive.phase, drive.axis) == (0.0, "bearing")
    joint = IdealClearance(model="ideal")
    assert (joint.geometry, joint.load, joint.offset, joint.approach_speed_floor) == (
        "coal",
        "point",
        0.0,
        1e-4,
    )
    assert (joint.maximum_depth, joint.friction) == (None, LawSpec(law="none"))


def test_drives_and_springs_act_at_the_joint_of_their_name(folder):
    scenario = folder.load()
    assert {name: drive.joint for name, drive in scenario.drives.items()} == {
        "azimuth": "azimuth",
        "motor": "hinge",
        "slow": "azimuth",
    }
    assert scenario.springs["azimuth"].joint == "azimuth"


def test_the_scenario_is_frozen(folder):
    scenario = folder.load()
    with pytest.raises(ValueError, match="frozen"):
        scenario.duration = 3.0
    with pytest.raises(ValueError, match="frozen"):
        scenario.clearance["hinge"].radial_clearance = 1.0


# --- JSON and copies ---


@pytest.mark.parametrize("case", [None, "tight", "by-radius", "elastic"])
def test_json_carries_everything_exactly(folder, case):
    scenario = folder.load(case=case, overrides=["title=Another", "duration=0.1 s"])
    for path in folder.path.iterdir():
        path.unlink()  # the result alone is enough
    again = Scenario.model_validate_json(scenario.model_dump_json())
    assert again == scenario
    assert again.model_dump_json() == scenario.model_dump_json()
    assert Scenario.model_validate(scenario.model_dump()) == scenario
    assert (again.case, again.overrides) == (
        case,
        ("title=Another", "duration=0.1 s"),
    ) or again.overrides == (
        'title="Another"',
        'duration="0.1 s"',
    )


@given(clearance=st.floats(1e-9, 9e-3), rtol=st.floats(1e-15, 0.99), gravity=st.floats(-1e6, 1e6))
def test_json_carries_every_digit(clearance, rtol, gravity):
    scenario = Scenario(
        duration=1.0,
        mechanism=MechanismSpec(urdf="x.urdf", gravity=(0.0, gravity, -gravity)),
        clearance={"a": IdealClearance(model="ideal", bearing_radius=0.01, radial_clearance=clearance)},
        integrator=IntegratorSpec(rtol=rtol),
        urdf_text=URDF,
    )
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario


def test_scenarios_travel_to_other_processes(folder):
    scenario = folder.load()
    assert pickle.loads(pickle.dumps(scenario)) == scenario
    assert copy.deepcopy(scenario) == scenario


def test_bad_json_is_refused_in_one_line():
    with pytest.raises(ScenarioError, match=r"^Scenario: is not JSON: .*$"):
        Scenario.model_validate_json("{")
    with pytest.raises(ScenarioError, match=r"^Scenario: duration is missing; give a time \[s\]$"):
        Scenario.model_validate_json('{"mechanism": {"urdf": "x"}, "urdf_text": ""}')
    with pytest.raises(ScenarioError, match=r"^Scenario: must be a table, got \[1\]$"):
        Scenario.model_validate([1])


def test_json_has_the_shape_of_a_file(folder):
    document = json.loads(folder.load().model_dump_json())
    assert document["clearance"]["hinge"]["normal"] == {"law": "lankarani-nikravesh", "restitution": 0.9}
    assert document["clearance"]["hinge"]["axial"] == {"stiffness": 1e11}


# --- cases ---


def test_a_case_is_laid_over_the_file(folder):
    scenario = folder.load(case="tight")
    assert (scenario.case, scenario.description) == ("tight", "less play")
    base = folder.load()
    assert scenario.clearance["hinge"] == base.clearance["hinge"].model_copy(
        update={"radial_clearance": 1e-5}
    )
    assert scenario.drives == base.drives


def test_a_case_removes_what_its_keys_exclude(folder):
    hinge = folder.load(case="by-radius").clearance["hinge"]
    assert (hinge.radial_clearance, hinge.journal_radius) == (None, 0.0099)
    assert (hinge.axial_clearance, hinge.flange_distance) == (None, 0.0501)
    # Differences of lengths about 10 mm, to round-off.
    assert hinge.radial_play == pytest.approx(1e-4, abs=1e-17)
    assert hinge.axial_play == pytest.approx(5e-5, abs=1e-17)


def test_a_table_may_replace_the_one_below(folder):
    assert folder.load(case="elastic").clearance["hinge"].normal == LawSpec(law="hertz")
    changes = {"cases.elastic.clearance.hinge.normal": {"law": "hertz"}}
    message = folder.refusal(changes, case="elastic")
    assert message == (
        "clearance.hinge.normal.restitution is unknown; law hertz takes stiffness, exponent "
        "(case elastic sets law: with replace = true beside it, the old keys go)"
    )


def test_a_case_may_replace_all_tables_of_a_kind(folder):
    scenario = folder.load({"cases.quiet": {"drives": {"replace": True}}}, case="quiet")
    assert scenario.drives == {}


def test_the_default_case_is_taken_unless_another_is_named(folder):
    changes = {"default_case": "tight"}
    assert folder.load(changes).case == "tight"
    assert folder.load(changes, case="elastic").case == "elastic"


def test_values_beside_the_case_are_told_by_their_place_in_the_case(folder):
    changes = {"cases.tight.clearance.hinge.radial_clearance": "10 us"}
    wanted = "cases.tight.clearance.hinge.radial_clearance must be a length [m], got '10 us' (time)"
    assert folder.refusal(changes, case="tight") == wanted
    assert folder.refusal(changes) == wanted  # though it is not the case to be run
    assert folder.refusal(changes, case="elastic") == wanted


@pytest.mark.parametrize("case", [None, "tight"])
def test_a_case_that_is_not_run_needs_no_files(folder, case):
    changes = {"cases.other": {"drives": {"slow": {"file": "of_tomorrow.csv"}}}}
    assert folder.load(changes, case=case).case == case
    message = folder.refusal(changes, case="other")
    assert message.startswith("cases.other.drives.slow.file must be an existing file, got 'of_tomorrow.csv'")


def test_what_overrides_complete_is_no_fault_of_a_case(folder):
    """A file may leave open what every run gives."""
    changes = {H + "radial_clearance": DELETED, "cases.by-radius": DELETED, "cases.tight": DELETED}
    changes["cases.flat"] = {"clearance": {"hinge": {"axial_clearance": 0}}}
    wanted = "clearance.hinge must have exactly one of radial_clearance and journal_radius, got neither"
    assert folder.refusal(changes) == wanted
    overrides = ["clearance.hinge.radial_clearance=0.1 mm"]
    assert folder.load(changes, overrides=overrides).clearance["hinge"].radial_clearance == 1e-4


def test_a_table_of_numbers_in_a_case_is_checked(folder):
    """In a case that is not to be run, too."""
    changes = {"cases.other": {"drives": {"slow": {"time": [0, 0, 1], "torque": [1, 2, 3]}}}}
    wanted = "cases.other.drives.slow.time[1] must be above the one before, 0.0, got 0.0"
    assert folder.refusal(changes) == folder.refusal(changes, case="other") == wanted
    both = {"cases.other": {"drives": {"slow": {"time": [0, 1], "file": "torque.csv"}}}}
    wanted = "cases.other.drives.slow must have either file, or time and torque, got both"
    assert folder.refusal(both) == folder.refusal(both, case="other") == wanted


# Names of what a table holds, to build tables of the kinds that are merged.
TABLES = st.recursive(
    st.integers() | st.text(max_size=3),
    lambda inner: st.dictionaries(st.sampled_from("abc"), inner, max_size=3),
    max_leaves=8,
)
DOCUMENTS = st.dictionaries(st.sampled_from("abc"), TABLES, max_size=3)


@given(base=DOCUMENTS)
def test_merging_nothing_changes_nothing(base):
    assert merge(base, {}) == base
    assert merge({}, base) == base
    assert merge(base, base) == base


@given(base=DOCUMENTS, over=DOCUMENTS, top=DOCUMENTS)
def test_merging_keeps_all_that_is_laid_over(base, over, top):
    before = copy.deepcopy((base, over))
    merged = merge(base, over)
    assert (base, over) == before
    assert merge(merged, over) == merged
    assert merged.keys() == base.keys() | over.keys()
    for key in base.keys() - over.keys():
        assert merged[key] == base[key]
    for key, value in over.items():
        if not isinstance(value, dict):
            assert merged[key] == value


def test_arrays_are_replaced_as_a_whole():
    assert merge({"a": {"b": [1, 2, 3], "c": 1}}, {"a": {"b": [4]}}) == {"a": {"b": [4], "c": 1}}


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
    overrides = ["clearance.hinge.radial_clearance=0.1 mm", "integrator.rtol=1e-9"]
    scenario = folder.load(case="tight", overrides=overrides)
    assert scenario.clearance["hinge"].radial_clearance == 1e-4
    assert scenario.integrator.rtol == 1e-9
    assert scenario.overrides == ('clearance.hinge.radial_clearance="0.1 mm"', "integrator.rtol=1e-09")
    assert folder.load(case="tight", overrides=scenario.overrides) == scenario


def test_an_override_removes_what_its_key_excludes(folder):
    hinge = folder.load(overrides=["clearance.hinge.journal_radius=9.9 mm"]).clearance["hinge"]
    assert (hinge.radial_clearance, hinge.journal_radius) == (None, 0.0099)
    both = ["clearance.hinge.journal_radius=9.9 mm", "clearance.hinge.radial_clearance=0.1 mm"]
    assert folder.refusal(overrides=both) == (
        "clearance.hinge must have exactly one of radial_clearance and journal_radius, got both "
        "(set by an override)"
    )


def test_an_override_may_replace_a_table(folder):
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
            "(an override sets kind: with replace = true beside it, the old keys go)",
        ),
        (
            "clearance.hing.geometry=coal",
            "clearance.hing.model is missing; give one of contact, planar, spherical, prismatic, ideal, "
            "constraint (or did you mean clearance.hinge?) (set by an override)",
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


def test_the_file_stands_in_the_message_as_it_was_named(folder):
    folder.load()
    (folder.path / "scenario.toml").write_text("duration = 1\n[mechanism]\nurdf = 3")
    for place, label in ((".", "scenario.toml"), ("./scenario.toml", "./scenario.toml")):
        with pytest.raises(ScenarioError) as refused:
            load_scenario(place)
        assert str(refused.value) == f"{label}: mechanism.urdf must be text, got 3"


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


def test_a_byte_order_mark_is_no_harm(folder):
    folder.load()
    (folder.path / "my.toml").write_bytes(b"\xef\xbb\xbf" + (folder.path / "my.toml").read_bytes())
    assert load_scenario("my.toml").title == "A test"


# --- refusals: place, rule, value seen, way out ---


@pytest.mark.parametrize("key", ["altitude", "period", "rate"])
def test_an_orbit_is_given_by_the_last_word(folder, key):
    """One of altitude, period and rate, set over the file, takes the place of the file's."""
    for below in ({}, {"pointing.orbit": {"period": "2 h"}}, {"pointing.orbit": {"rate": 0.001}}):
        orbit = folder.load(below, overrides={f"pointing.orbit.{key}": 3.0}).pointing.orbit
        given = {name: getattr(orbit, name) for name in ("altitude", "period", "rate")}
        assert given == {"altitude": None, "period": None, "rate": None} | {key: 3.0}


H = "clearance.hinge."
LN = "law lankarani-nikravesh takes stiffness, restitution, exponent"
WHOLE = "law lankarani-nikravesh brings its own; elastic laws are " + ", ".join(
    name for name in contact.NORMAL_LAWS if contact.is_elastic(name)
)
TOP = (
    "format, title, source, duration, mechanism, materials, clearance, flexible, closures, couplings, "
    "drives, springs, events, initial, integrator, output, pointing"
)

REFUSALS = [
    # top level
    ({"clearence": {}}, "clearence is unknown; did you mean clearance?"),
    ({"xyzzy": 1}, f"xyzzy is unknown; known here: {TOP}"),
    ({"urdf_text": "x"}, f"urdf_text is unknown; known here: {TOP}, default_case, cases"),
    ({"replace": True}, "replace must be true or false, and belongs in a table of a case or an override"),
    ({"format": 2}, "format must be 1, got 2"),
    ({"title": 3}, "title must be text, got 3"),
    ({"duration": DELETED}, "duration is missing; give a time [s]"),
    ({"duration": "1 m"}, "duration must be a time [s], got '1 m' (length)"),
    ({"duration": "-1 s"}, "duration must be positive, got '-1 s'"),
    ({"duration": 0}, "duration must be positive, got 0"),
    ({"duration": math.nan}, "duration must be a time [s], got nan (not finite)"),
    ({"duration": True}, "duration must be a time [s], got true"),
    ({"output": 3}, "output must be a table, got 3"),
    ({"output.rate": "1 ms"}, "output.rate must be a frequency [Hz], got '1 ms' (time)"),
    ({"output.rate": 0}, "output.rate must be positive, got 0"),
    # cases
    ({"default_case": 3}, "default_case must be text, got 3"),
    ({"cases": 3}, "cases must be a table, got 3"),
    ({"cases.tight": 3}, "cases.tight must be a table, got 3"),
    ({"cases.tight.description": 3}, "cases.tight.description must be text, got 3"),
    ({"cases.tight.clearanc": {}}, "cases.tight.clearanc is unknown; did you mean clearance?"),
    ({"cases.tight.name": "x"}, f"cases.tight.name is unknown; known here: {TOP}, default_case, cases"),
    (
        {"cases.tight.clearance.hing": {"geometry": "coal"}},
        "cases.tight.clearance.hing.model is missing; give one of contact, planar, spherical, prismatic, "
        "ideal, constraint (or did you mean clearance.hinge?)",
    ),
    (
        {"cases.tight.clearance.hinge.replace": "yes"},
        "cases.tight.clearance.hinge.replace must be true or false, and belongs in a table of a case "
        "or an override",
    ),
    # mechanism
    ({"mechanism": DELETED}, "mechanism is missing"),
    ({"mechanism.urdf": DELETED}, "mechanism.urdf is missing"),
    ({"mechanism.urdf": 3}, "mechanism.urdf must be text, got 3"),
    (
        {"mechanism.urdf": "bdy.urdf"},
        "mechanism.urdf must be an existing file, got 'bdy.urdf'; did you mean body.urdf?",
    ),
    ({"mechanism.urd": "x"}, "mechanism.urd is unknown; did you mean urdf?"),
    ({"mechanism.base": "floating"}, "mechanism.base must be 'free' or 'fixed', got 'floating'"),
    ({"mechanism.gravity": [0, 0]}, "mechanism.gravity must be an array of 3 numbers [m/s**2], got [0, 0]"),
    (
        {"mechanism.gravity": [0, 0, "9.81 m"]},
        "mechanism.gravity[2] must be an acceleration [m/s**2], got '9.81 m' (length)",
    ),
    (
        {"mechanism.allow_impossible_inertia": "body"},
        "mechanism.allow_impossible_inertia must be an array, got 'body'",
    ),
    (
        {"mechanism.allow_impossible_inertia": [3]},
        "mechanism.allow_impossible_inertia[0] must be text, got 3",
    ),
    ({"mechanism.links": [1]}, "mechanism.links must be a table, got [1]"),
    ({"mechanism.links.body": 3}, "mechanism.links.body must be a table, got 3"),
    ({"mechanism.links.body.mas": 1}, "mechanism.links.body.mas is unknown; did you mean mass?"),
    ({"mechanism.links.body.mass": "-1 kg"}, "mechanism.links.body.mass must be zero or more, got '-1 kg'"),
    (
        {"mechanism.links.body.inertia": [1, 2]},
        "mechanism.links.body.inertia must be an array of 3 or 6 numbers [kg*m**2], got [1, 2]",
    ),
    (
        {"mechanism.links.body.shapes.rod.radius": "1 N"},
        "mechanism.links.body.shapes.rod.radius must be a length [m], got '1 N' (force)",
    ),
    (
        {"mechanism.links.body.shapes.box.size": [1, 0, 1]},
        "mechanism.links.body.shapes.box.size must be positive, got [1.0, 0.0, 1.0]",
    ),
    (
        {"mechanism.joints.azimuth.axis": [0, 0, 0]},
        "mechanism.joints.azimuth.axis must be three finite numbers, not all zero, got [0.0, 0.0, 0.0]",
    ),
    (
        {"mechanism.joints.azimuth.kind": "lockd"},
        "mechanism.joints.azimuth.kind must be 'ideal', 'locked', 'free' or 'planar', got 'lockd'; "
        "did you mean locked?",
    ),
    (
        {"mechanism.joints.hinge.kind": "locked"},
        "mechanism.joints.hinge.kind must be left out: clearance.hinge.model decides it, got 'locked'",
    ),
    # materials
    (
        {"materials.alloy.young": "70 MN"},
        "materials.alloy.young must be a pressure [Pa], got '70 MN' (force)",
    ),
    ({"materials.alloy.young": DELETED}, "materials.alloy.young is missing; give a pressure [Pa]"),
    ({"materials.alloy.poisson": 0.7}, "materials.alloy.poisson must be above -1 and at most 0.5, got 0.7"),
    ({"materials.alloy.density": -1}, "materials.alloy.density must be positive, got -1"),
    ({"materials.alloy.yong": 1}, "materials.alloy.yong is unknown; did you mean young?"),
    # joints with play: keys, dimensions
    ({"clearance": 3}, "clearance must be a table, got 3"),
    ({"clearance.hinge": 3}, "clearance.hinge must be a table, got 3"),
    ({H + "clearence": 1}, "clearance.hinge.clearence is unknown; did you mean radial_clearance?"),
    (
        {H + "model": DELETED},
        "clearance.hinge.model is missing; give one of contact, planar, spherical, prismatic, ideal, "
        "constraint",
    ),
    (
        {H + "model": "contac"},
        "clearance.hinge.model must be one of contact, planar, spherical, prismatic, ideal, constraint, "
        "got 'contac'; did you mean contact?",
    ),
    (
        {H + "model": 3},
        "clearance.hinge.model must be one of contact, planar, spherical, prismatic, ideal, constraint, "
        "got 3",
    ),
    (
        {H + "radial_clearance": "0.2 N"},
        "clearance.hinge.radial_clearance must be a length [m], got '0.2 N' (force)",
    ),
    (
        {H + "radial_clearance": "0.2"},
        "clearance.hinge.radial_clearance must be a length [m], got '0.2' (no unit); write '0.2 m'",
    ),
    ({H + "radial_clearance": "-0.2 mm"}, "clearance.hinge.radial_clearance must be positive, got '-0.2 mm'"),
    ({H + "radial_clearance": 0}, "clearance.hinge.radial_clearance must be positive, got 0"),
    (
        {H + "radial_clearance": math.inf},
        "clearance.hinge.radial_clearance must be a length [m], got inf (not finite)",
    ),
    (
        {H + "radial_clearance": "20 mm"},
        "clearance.hinge.radial_clearance must be smaller than bearing_radius = 0.01 m, got 0.02 m",
    ),
    (
        {H + "radial_clearance": DELETED},
        "clearance.hinge must have exactly one of radial_clearance and journal_radius, got neither",
    ),
    (
        {H + "journal_radius": "9.8 mm"},
        "clearance.hinge must have exactly one of radial_clearance and journal_radius, got both",
    ),
    (
        {H + "radial_clearance": DELETED, H + "journal_radius": "11 mm"},
        "clearance.hinge.journal_radius must be smaller than bearing_radius = 0.01 m, got 0.011 m",
    ),
    ({H + "axial_clearance": "-1 um"}, "clearance.hinge.axial_clearance must be zero or more, got '-1 um'"),
    (
        {H + "axial_clearance": DELETED},
        "clearance.hinge must have exactly one of axial_clearance and flange_distance, got neither",
    ),
    (
        {H + "flange_distance": "54 mm"},
        "clearance.hinge must have exactly one of axial_clearance and flange_distance, got both",
    ),
    (
        {H + "axial_clearance": DELETED, H + "flange_distance": "40 mm"},
        "clearance.hinge.flange_distance must be at least bearing_length = 0.05 m, got 0.04 m",
    ),
    ({H + "bearing_radius": DELETED}, "clearance.hinge.bearing_radius is missing; give a length [m]"),
    ({H + "bearing_radius": "0 mm"}, "clearance.hinge.bearing_radius must be positive, got '0 mm'"),
    ({H + "bearing_length": DELETED}, "clearance.hinge.bearing_length is missing; give a length [m]"),
    (
        {H + "bearing_outer_radius": "10 mm"},
        "clearance.hinge.bearing_outer_radius must be larger than bearing_radius = 0.01 m, got 0.01 m",
    ),
    (
        {H + "flange_radius": "9 mm"},
        "clearance.hinge.flange_radius must be larger than bearing_radius = 0.01 m, got 0.009 m",
    ),
    ({H + "offset": "1 s"}, "clearance.hinge.offset must be a length [m], got '1 s' (time)"),
    ({H + "maximum_depth": "-1 mm"}, "clearance.hinge.maximum_depth must be positive, got '-1 mm'"),
    ({H + "approach_speed_floor": 0}, "clearance.hinge.approach_speed_floor must be positive, got 0"),
    (
        {H + "geometry": "coall"},
        "clearance.hinge.geometry must be 'coal' or 'closed-form', got 'coall'; did you mean coal?",
    ),
    ({H + "load": "line"}, "clearance.hinge.load must be 'point' or 'distributed', got 'line'"),
    (
        {H + "journal_material": DELETED},
        "clearance.hinge.journal_material is missing; it decides the stiffness, or give normal.stiffness",
    ),
    ({H + "journal_material": 3}, "clearance.hinge.journal_material must be text, got 3"),
    # laws
    (
        {H + "normal": DELETED, H + "axial": DELETED},
        "clearance.hinge.normal is missing; it names the law of the contact and its parameters",
    ),
    ({H + "normal": DELETED}, "clearance.hinge.axial.law is missing; there is no normal law to change"),
    ({H + "normal": 3}, "clearance.hinge.normal must be a table, got 3"),
    ({H + "axial": 3}, "clearance.hinge.axial must be a table, got 3"),
    (
        {H + "normal.law": DELETED},
        f"clearance.hinge.normal.law is missing; give one of {', '.join(contact.NORMAL_LAWS)}",
    ),
    (
        {H + "normal.dissipation": "flores"},
        f"clearance.hinge.normal.dissipation must be left out, for {WHOLE}",
    ),
    (
        {H + "normal": {"law": "johnson", "dissipation": 3}, H + "axial": DELETED},
        "clearance.hinge.normal.dissipation must be text, got 3",
    ),
    (
        {H + "normal": {"law": "johnson", "dissipation": "flores"}, H + "axial": DELETED},
        "clearance.hinge.normal.restitution is missing; law johnson with flores takes length, "
        "journal_radius, bearing_radius, modulus, restitution",
    ),
    (
        {H + "normal": {"law": "hertz", "dissipation": "flores", "restitution": 0}, H + "axial": DELETED},
        "clearance.hinge.normal.restitution must be above 0 (no finite damping of this form stops a body "
        "dead), got 0.0",
    ),
    (
        {H + "normal": {"law": "hertz", "dissipation": "tsuji", "restitution": 1, "effective_mas": 1}},
        "clearance.hinge.normal.effective_mas is unknown; did you mean effective_mass? law hertz with "
        "tsuji takes stiffness, exponent, restitution, effective_mass",
    ),
    (
        {H + "axial": {"dissipation": "flores"}},
        f"clearance.hinge.axial.dissipation must be left out, for {WHOLE}",
    ),
    (
        {H + "friction.dissipation": "flores"},
        "clearance.hinge.friction.dissipation is unknown; law tanh is a friction law and has no dissipation",
    ),
    ({H + "normal.law": 3}, "clearance.hinge.normal.law must be text, got 3"),
    ({H + "normal.restitution": 1.3}, "clearance.hinge.normal.restitution must be in [0, 1], got 1.3"),
    ({H + "normal.restitution": -0.1}, "clearance.hinge.normal.restitution must be in [0, 1], got -0.1"),
    (
        {H + "model": "ideal", H + "normal.restitution": 1.3},
        "clearance.hinge.normal.restitution must be in [0, 1], got 1.3",
    ),
    (
        {H + "normal.restitution": "0.9 m"},
        "clearance.hinge.normal.restitution must be a pure number, got '0.9 m' (length)",
    ),
    ({H + "normal.restitution": DELETED}, f"clearance.hinge.normal.restitution is missing; {LN}"),
    (
        {H + "normal.restitutoin": 1},
        f"clearance.hinge.normal.restitutoin is unknown; did you mean restitution? {LN}",
    ),
    ({H + "normal.xyz": 1}, f"clearance.hinge.normal.xyz is unknown; {LN}"),
    (
        {H + "normal.stiffness": "-1e9 N/m**1.5"},
        "clearance.hinge.normal.stiffness must be positive and finite, got -1000000000.0",
    ),
    (
        {H + "normal.stiffness": "1e9 N/m"},
        "clearance.hinge.normal.stiffness must be a stiffness [N/m**1.5], got '1e9 N/m' (stiffness)",
    ),
    (
        {H + "normal.exponent": "1.5 m"},
        "clearance.hinge.normal.exponent must be a pure number, got '1.5 m' (length)",
    ),
    ({H + "axial.restitution": 2}, "clearance.hinge.axial.restitution must be in [0, 1], got 2.0"),
    (
        {H + "axial.restitutio": 2},
        f"clearance.hinge.axial.restitutio is unknown; did you mean restitution? {LN}",
    ),
    (
        {H + "axial": {"exponent": 2}, H + "normal.stiffness": 1e9},
        "clearance.hinge.axial.stiffness is missing; another exponent changes the unit of the one in normal",
    ),
    (
        {H + "radial": {"law": "lankarani-nikravesh"}, H + "normal": {"law": "hertz"}},
        f"clearance.hinge.radial.restitution is missing; {LN}",
    ),
    (
        {H + "friction.transition_speed": DELETED},
        "clearance.hinge.friction.transition_speed is missing; law tanh takes "
        "coefficient_of_friction, transition_speed",
    ),
    (
        {H + "friction.transition_speed": "1 m"},
        "clearance.hinge.friction.transition_speed must be a speed [m/s], got '1 m' (length)",
    ),
    (
        {H + "friction.transition_speed": 0},
        "clearance.hinge.friction.transition_speed must be positive and finite, got 0.0",
    ),
    (
        {H + "friction": {"law": "none", "mu": 1}},
        "clearance.hinge.friction.mu is unknown; law none takes no parameters",
    ),
    # drives
    ({"drives.motor": 3}, "drives.motor must be a table, got 3"),
    (
        {"drives.motor.kind": DELETED},
        "drives.motor.kind is missing; give one of constant, sine, table, pd, motion, distance",
    ),
    (
        {"drives.motor.kind": "constat"},
        "drives.motor.kind must be one of constant, sine, table, pd, motion, distance, got 'constat'; "
        "did you mean constant?",
    ),
    ({"drives.motor.value": DELETED}, "drives.motor.value is missing; give a torque [N*m] or a force [N]"),
    (
        {"drives.motor.value": "1 W"},
        "drives.motor.value must be a torque [N*m] or a force [N], got '1 W' (power)",
    ),
    (
        {"drives.motor.amplitude": 1},
        "drives.motor.amplitude is unknown; known here: kind, joint, axis, on, value",
    ),
    ({"drives.motor.axis": "shaft"}, "drives.motor.axis must be 'bearing' or 'journal', got 'shaft'"),
    ({"drives.motor.joint": 3}, "drives.motor.joint must be text, got 3"),
    (
        {"drives.motor.motion": "translation"},
        "drives.motor.value must be for a sliding joint, as motion is, got '4 N*m' (turning)",
    ),
    (
        {"drives.azimuth.frequency": "60 rpm"},
        "drives.azimuth.frequency must be a frequency [Hz], got '60 rpm' (angular rate)",
    ),
    ({"drives.azimuth.frequency": 0}, "drives.azimuth.frequency must be positive, got 0"),
    ({"drives.azimuth.phase": "1 m"}, "drives.azimuth.phase must be an angle [rad], got '1 m' (length)"),
    (
        {"drives.azimuth.file": "x"},
        "drives.azimuth.file is unknown; known here: kind, joint, axis, on, amplitude, frequency, phase",
    ),
    ({"drives.slow.file": DELETED}, "drives.slow must have either file, or time and torque, got neither"),
    ({"drives.slow.time": [0, 1]}, "drives.slow must have either file, or time and torque, got both"),
    ({"drives.slow.file": 3}, "drives.slow.file must be text, got 3"),
    (
        {"drives.slow.file": "torqe.csv"},
        "drives.slow.file must be an existing file, got 'torqe.csv'; did you mean torque.csv?",
    ),
    (
        {"drives.slow.interpolation": "spline"},
        "drives.slow.interpolation must be 'linear' or 'cubic', got 'spline'",
    ),
    ({"drives.t": {"kind": "table", "time": [0, 1]}}, "drives.t.torque is missing; give an array of numbers"),
    (
        {"drives.t": {"kind": "table", "time": [0, 1], "torque": 3}},
        "drives.t.torque must be an array of numbers, got 3",
    ),
    (
        {"drives.t": {"kind": "table", "time": [0, 1], "torque": [1]}},
        "drives.t.torque must be as many numbers as time, 2, got 1",
    ),
    (
        {"drives.t": {"kind": "table", "time": [0], "torque": [1]}},
        "drives.t.time must be at least 2 numbers, got 1",
    ),
    (
        {"drives.t": {"kind": "table", "time": [0, 0], "torque": [1, 2]}},
        "drives.t.time[1] must be above the one before, 0.0, got 0.0",
    ),
    (
        {"drives.t": {"kind": "table", "time": [0, math.nan], "torque": [1, 2]}},
        "drives.t.time[1] must be a time [s], got nan (not finite)",
    ),
    # springs
    ({"springs.azimuth.stifness": 1}, "springs.azimuth.stifness is unknown; did you mean stiffness?"),
    ({"springs.azimuth.stiffness": -1}, "springs.azimuth.stiffness must be zero or more, got -1"),
    (
        {"springs.azimuth.stiffness": "1 N"},
        "springs.azimuth.stiffness must be a torsional stiffness [N*m/rad] or a stiffness [N/m], got "
        "'1 N' (force)",
    ),
    (
        {"springs.azimuth.damping": "1 N*s/m"},
        "springs.azimuth.damping must be for a turning joint, as stiffness is, got '1 N*s/m' (sliding)",
    ),
    (
        {"springs.azimuth": {"rest_angle": 1}},
        "springs.azimuth must have a stiffness or a damping above zero, got neither",
    ),
    # pointing
    ({"pointing.boresigth": [1, 0, 0]}, "pointing.boresigth is unknown; did you mean boresight?"),
    ({"pointing.boresight": DELETED}, "pointing.boresight is missing; give an array of 3 numbers"),
    (
        {"pointing.boresight": [0, 0, 0]},
        "pointing.boresight must be three finite numbers, not all zero, got [0.0, 0.0, 0.0]",
    ),
    (
        {"pointing.up": [0, 0, 1]},
        "pointing.up must not lie along boresight = [0.0, 0.0, -2.0], got [0.0, 0.0, 1.0]",
    ),
    (
        {"pointing.commanded": "ideel"},
        "pointing.commanded must be 'ideal', 'world' or 'orbit', got 'ideel'; did you mean ideal?",
    ),
    (
        {"pointing.commanded": "ideal"},
        'pointing.direction must be left out where commanded is "ideal", got [0.0, 0.1, 1.0]',
    ),
    (
        {"pointing.direction": DELETED},
        'pointing.direction is missing; give it where commanded is "orbit"',
    ),
    (
        {"pointing.direction_up": [0, -0.1, -1]},
        "pointing.direction_up must not lie along direction = [0.0, 0.1, 1.0], got [0.0, -0.1, -1.0]",
    ),
    ({"pointing.orbit": DELETED}, 'pointing.orbit is missing; give it where commanded is "orbit"'),
    (
        {"pointing.orbit.altitude": DELETED},
        "pointing.orbit must have one of altitude, period and rate, got none",
    ),
    (
        {"pointing.orbit": {"altitude": 1, "period": "90 min"}},
        "pointing.orbit must have one of altitude, period and rate, got altitude and period",
    ),
    ({"pointing.orbit.altitude": "-1 m"}, "pointing.orbit.altitude must be positive, got '-1 m'"),
    (
        {"pointing.orbit.nadir": [0, 0, 1]},
        "pointing.orbit.nadir must be perpendicular to normal = [0.0, 0.0, 2.0], got [0.0, 0.0, 1.0]",
    ),
    # initial state
    ({"initial.joint": {}}, "initial.joint is unknown; did you mean joints?"),
    (
        {"initial.joints.azimuth.position": "1 N"},
        "initial.joints.azimuth.position must be an angle [rad] or a length [m], got '1 N' (force)",
    ),
    (
        {"initial.joints.azimuth.velocity": "1 m/s"},
        "initial.joints.azimuth.velocity must be for a turning joint, as position is, got '1 m/s' (sliding)",
    ),
    (
        {"initial.joints.hinge.position": 1},
        "initial.joints.hinge must have at most one of position and angle, got both",
    ),
    (
        {"initial.joints.hinge.journal_position": [0, "1 rad", 0]},
        "initial.joints.hinge.journal_position[1] must be a length [m], got '1 rad' (angle)",
    ),
    (
        {"initial.base.attitude": [0, 0, 0, 2]},
        "initial.base.attitude must be a unit quaternion x, y, z, w, got [0.0, 0.0, 0.0, 2.0] of length 2",
    ),
    (
        {"initial.base.attitude": [0, 0, 1]},
        "initial.base.attitude must be an array of 4 numbers, got [0, 0, 1]",
    ),
    ({"mechanism.base": "fixed"}, 'initial.base must be left out where mechanism.base is "fixed"'),
    # integrator
    (
        {"integrator.method": "dormand-prince"},
        "integrator.method must be 'rk4', 'bogacki-shampine-32', 'dormand-prince-54', "
        "'dormand-prince-853' or 'radau5', "
        "got 'dormand-prince'; did you mean dormand-prince-54?",
    ),
    ({"integrator.rtol": 0}, "integrator.rtol must be between 0 and 1, got 0"),
    ({"integrator.rtol": 1e8}, "integrator.rtol must be between 0 and 1, got 100000000.0"),
    ({"integrator.rtol": "1e-8 m"}, "integrator.rtol must be a pure number, got '1e-8 m' (length)"),
    ({"integrator.step": "-1 s"}, "integrator.step must be positive, got '-1 s'"),
    ({"integrator.max_step": "10 m"}, "integrator.max_step must be a time [s], got '10 m' (length)"),
    ({"integrator.min_step": 1}, "integrator.min_step must be below max_step = 0.01 s, got 1 s"),
    (
        {"integrator.first_step": 1},
        "integrator.first_step must be from min_step = 1e-14 s to max_step = 0.01 s, got 1 s",
    ),
    ({"integrator.scales.angel": 1}, "integrator.scales.angel is unknown; did you mean angle?"),
    ({"integrator.scales.clearance": 0}, "integrator.scales.clearance must be positive, got 0"),
    (
        {"integrator.scales.clearance_velocity": "10 mm"},
        "integrator.scales.clearance_velocity must be a speed [m/s], got '10 mm' (length)",
    ),
]


@pytest.mark.parametrize(("changes", "message"), REFUSALS, ids=[message[:60] for _, message in REFUSALS])
def test_refusals(folder, changes, message):
    assert folder.refusal(changes) == message


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"default_case": "tigth"},
            "default_case: case 'tigth' is unknown; did you mean tight? known: by-radius,",
        ),
        (
            {H + "journal_material": "stel"},
            "clearance.hinge.journal_material: material 'stel' is unknown; did you mean steel? "
            "known: alloy, aluminium-2024-t3,",
        ),
        (
            {"cases.tight.clearance.hinge.bearing_material": "aloy"},
            "cases.tight.clearance.hinge.bearing_material: material 'aloy' is unknown; did you mean alloy?",
        ),
        (
            {H + "normal.law": "lankarani"},
            "clearance.hinge.normal.law: law 'lankarani' is unknown; did you mean "
            "lankarani-nikravesh? known: adams-impact,",
        ),
        (
            {H + "normal.law": "tanh"},
            "clearance.hinge.normal.law: law 'tanh' is unknown; known: adams-impact,",
        ),
        (
            {H + "normal": {"law": "hertz", "dissipation": "floras"}},
            "clearance.hinge.normal.dissipation: dissipation 'floras' is unknown; did you mean flores? "
            "known: adams-impact,",
        ),
        (
            {H + "axial.law": "hertzz"},
            "clearance.hinge.axial.law: law 'hertzz' is unknown; did you mean hertz?",
        ),
        (
            {H + "friction.law": "tan"},
            "clearance.hinge.friction.law: law 'tan' is unknown; did you mean tanh?",
        ),
        (
            {H + "friction.law": "hertz"},
            "clearance.hinge.friction.law: law 'hertz' is unknown; known: ambrosio,",
        ),
    ],
)
def test_unknown_names(folder, changes, message):
    assert folder.refusal(changes, error=UnknownNameError).startswith(message)


def test_an_unknown_case_names_the_known_ones(folder):
    message = folder.refusal(case="tigth", error=UnknownNameError)
    assert message == "case 'tigth' is unknown; did you mean tight? known: by-radius, elastic, tight"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: the header must be time,torque, got an empty file"),
        ("0,1\n1,2\n", "line 1: the header must be time,torque, got '0,1'"),
        ("time;torque\n0;1\n", "line 1: the header must be time,torque, got 'time;torque'"),
        ("time,torque\n0,1\n", "line 2: must have at least 2 rows of numbers, got 1"),
        ("time,torque\n0,1\n1\n", "line 3: must have 2 values, got 1"),
        ("time,torque\n0,1\n1,2,3\n", "line 3: must have 2 values, got 3"),
        ("time,torque\n0,1\n1,x\n", "line 3: torque must be a finite number, got 'x'"),
        ("time,torque\n0,1\n\n# note\n1,nan\n", "line 5: torque must be a finite number, got 'nan'"),
        ("time,torque\n0,1\ninf,2\n", "line 3: time must be a finite number, got 'inf'"),
        ("time,torque\n0,1\n1,2\n1,3\n", "line 4: time must increase strictly, got 1.0 after 1.0"),
    ],
)
def test_bad_torque_tables_are_refused_with_file_and_line(folder, text, message):
    (folder.path / "bad.csv").write_text(text)
    assert folder.refusal({"drives.slow.file": "bad.csv"}) == f"drives.slow.file: bad.csv, {message}"


def test_a_torque_table_may_have_comments_and_blanks(folder):
    (folder.path / "good.csv").write_text("# from a test\n\n time , torque\r\n 0 , 1 \n1e0,-2.5\n")
    table = folder.load({"drives.slow.file": "good.csv"}).drives["slow"]
    assert (table.time, table.torque) == ((0.0, 1.0), (1.0, -2.5))


@pytest.mark.parametrize("name", ["body.urdf", "torque.csv"])
def test_files_that_are_no_text_are_refused(folder, name):
    (folder.path / name).write_bytes(b"\xff\xff")
    place = "mechanism.urdf" if name == "body.urdf" else "drives.slow.file"
    assert folder.refusal() == f"{place} must be UTF-8 text, got '{name}' (byte 0)"


def test_a_missing_file_is_looked_for_beside_the_scenario(folder):
    message = folder.refusal({"mechanism.urdf": "sub/x.urdf"})
    where = folder.path.resolve() / "sub"
    assert (
        message == f"mechanism.urdf must be an existing file, got 'sub/x.urdf'; it is looked for in {where}"
    )


def test_names_that_need_quotes_have_them_in_messages(folder):
    file = FILE | {"clearance": {"my hinge": {"model": "ideal", "bearing_radius": -1}}}
    with pytest.raises(
        ScenarioError, match=r'^my\.toml: clearance\."my hinge"\.bearing_radius must be positive'
    ):
        folder.load(file=file)


# --- joints with play ---


def test_the_laws_of_bore_and_flanges(folder):
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


def test_another_law_at_the_flanges_takes_nothing_from_the_common_one(folder):
    hinge = folder.load({H + "axial": {"law": "hertz"}, H + "normal.stiffness": 1e9}).clearance["hinge"]
    assert hinge.axial_law == LawSpec(law="hertz")


def test_laws_may_be_given_apart_without_a_common_one(folder):
    changes = {
        H + "normal": DELETED,
        H + "axial": {"law": "hertz"},
        H + "radial": {"law": "hertz", "stiffness": 1},
    }
    hinge = folder.load(changes).clearance["hinge"]
    assert (hinge.radial_law.parameters, hinge.axial_law.parameters) == ({"stiffness": 1.0}, {})


def test_the_unit_of_a_stiffness_follows_the_exponent_of_its_law(folder):
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
    scenario = folder.load({H + "normal": JOHNSON, H + "axial": DELETED})
    hinge = scenario.clearance["hinge"]
    assert hinge.normal == LawSpec(law="johnson", dissipation="flores", parameters={"restitution": 0.8})
    assert json.loads(scenario.model_dump_json())["clearance"]["hinge"]["normal"] == JOHNSON
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario


def test_another_dissipation_keeps_the_parameters_that_it_knows(folder):
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


def test_a_case_changes_the_dissipation(folder):
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
    planar = {
        "model": "planar",
        "bearing_radius": "10 mm",
        "journal_radius": "9.5 mm",
        "normal": {"law": "hertz", "stiffness": "1e10 N/m**1.5"},
    }
    joint = folder.load({"clearance.hinge": planar, "cases": {}}).clearance["hinge"]
    assert isinstance(joint, PlanarClearance)
    assert joint.radial_play == pytest.approx(0.0005, abs=1e-17)  # round-off of 10 mm


def test_zero_axial_clearance_is_allowed(folder):
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
    for name, dissipation in contact.DISSIPATIONS.items():
        parameters = dict.fromkeys(contact.law_parameters(dissipation), 0.5)
        spec = LawSpec(law="hertz", dissipation=name, parameters={"stiffness": 1e9} | parameters)
        law = contact.make_normal_law(spec.law, spec.parameters, spec.dissipation)
        assert isinstance(law.parts.dissipation, dissipation)


# --- drives, springs, initial state ---


@pytest.mark.parametrize(
    ("spec", "table", "motion"),
    [
        (DRIVE_SPECS["constant"], {"joint": "j", "kind": "constant", "value": 1.0}, None),
        (DRIVE_SPECS["constant"], {"joint": "j", "kind": "constant", "value": "1 N*m"}, "rotation"),
        (DRIVE_SPECS["constant"], {"joint": "j", "kind": "constant", "value": "1 N"}, "translation"),
        (
            DRIVE_SPECS["sine"],
            {"joint": "j", "kind": "sine", "amplitude": "2 kN", "frequency": 1},
            "translation",
        ),
        (SPRING_SPECS["spring"], {"joint": "j", "stiffness": "2 N/mm", "rest_angle": "1 mm"}, "translation"),
        (SPRING_SPECS["spring"], {"joint": "j", "stiffness": 1, "damping": "1 N*m*s/rad"}, "rotation"),
        (DRIVE_SPECS["table"], {"joint": "j", "kind": "table", "time": [0, 1], "torque": [1, 2]}, None),
    ],
)
def test_units_tell_a_turning_joint_from_a_sliding_one(spec, table, motion):
    assert spec(**table).motion == motion


def test_tables_of_numbers_may_be_arrays():
    drive = DRIVE_SPECS["table"](joint="j", kind="table", time=np.linspace(0, 1, 3), torque=np.arange(3))
    assert (drive.time, drive.torque) == ((0.0, 0.5, 1.0), (0.0, 1.0, 2.0))
    assert InitialBaseSpec(position=np.ones(3)).position == (1.0, 1.0, 1.0)


# --- from Python ---


def test_a_scenario_can_be_built_in_python(folder):
    scenario = Scenario(
        duration="1 s",
        mechanism=MechanismSpec(urdf="body.urdf"),
        clearance={
            "hinge": ContactClearance(
                model="contact",
                bearing_radius="10 mm",
                radial_clearance=2e-4,
                bearing_length=0.05,
                axial_clearance=0,
                bearing_outer_radius=0.012,
                flange_radius=0.014,
                normal=LawSpec(law="hertz", parameters={"stiffness": 1e11}),
            )
        },
        drives={"hinge": {"kind": "constant", "value": 1}},
        output=OutputSpec(rate="1 kHz"),
        urdf_text=URDF,
    )
    assert scenario.clearance["hinge"].radial_law.parameters == {"stiffness": 1e11}
    assert scenario.drives["hinge"].joint == "hinge"
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: IntegratorSpec(rtol=-1), "IntegratorSpec: rtol must be between 0 and 1, got -1"),
        (lambda: OutputSpec(rat=1), "OutputSpec: rat is unknown; did you mean rate?"),
        (lambda: JointSpec(axis=(0, 0)), "JointSpec: axis must be an array of 3 numbers, got [0, 0]"),
        (
            lambda: SPRING_SPECS["spring"](joint="j"),
            "JointSpringSpec: must have a stiffness or a damping above zero, got neither",
        ),
        (
            lambda: LawSpec(law="hertz", parameters={"stifness": 1}),
            "LawSpec: stifness is unknown; did you mean stiffness? law hertz takes stiffness, exponent",
        ),
        (
            lambda: LawSpec(law="hertz", stiffness="1 N"),
            "LawSpec: stiffness must be a stiffness [N/m**1.5], got",
        ),
        (lambda: LawSpec(parameters={}), "LawSpec: law is missing"),
        (
            lambda: LawChange(parameters={"stiffness": math.nan}),
            "LawChange: parameters.stiffness must be finite",
        ),
        (
            lambda: Scenario(duration=1, mechanism={"urdf": "x", "base": "fre"}, urdf_text=""),
            "Scenario: mechanism.base must be 'free' or 'fixed', got 'fre'; did you mean free?",
        ),
    ],
)
def test_errors_from_python_name_the_class(build, message):
    with pytest.raises(ScenarioError) as refused:
        build()
    assert str(refused.value).startswith(message)
    assert len(str(refused.value).splitlines()) == 1


def test_unknown_laws_from_python():
    with pytest.raises(UnknownNameError, match=r"^LawSpec: law: law 'herz' is unknown; did you mean hertz\?"):
        LawSpec(law="herz")


def test_materials_are_the_scenarios_own_or_shipped(folder):
    scenario = folder.load()
    assert scenario.material("alloy") == contact.Material(
        young=70e9, poisson=0.33, density=2700.0, source="a book"
    )
    assert scenario.material("steel") is contact.MATERIALS["steel"]
    own = folder.load({"materials.steel": {"young": 1, "poisson": 0}})
    assert own.material("steel").young == 1.0
    with pytest.raises(UnknownNameError, match=r"material 'stel' is unknown; did you mean steel\?"):
        scenario.material("stel")


def test_what_a_scenario_accepts_its_laws_accept(folder):
    """The rules for parameters are the laws' own: what passed here builds there."""
    hinge = folder.load().clearance["hinge"]
    for spec in (hinge.radial_law, hinge.axial_law):
        contact.NORMAL_LAWS[spec.law](**({"stiffness": 1.0} | spec.parameters))
    contact.FRICTION_LAWS[hinge.friction.law](**hinge.friction.parameters)
    with pytest.raises(InvalidParameterError):
        contact.NORMAL_LAWS["lankarani-nikravesh"](stiffness=1.0, restitution=1.3)


def test_a_scenario_shows_itself_without_its_files(folder):
    text = repr(folder.load())
    assert "robot" not in text
    assert "1.25" not in text


# --- the shipped scenario ---


def test_shipped_scenarios_are_listed():
    (bai,) = [summary for summary in list_scenarios() if summary.name == "bai2020"]
    assert bai.title == "Dual-axis satellite antenna with a 3D revolute clearance joint"
    names = ["case1", "case1-constraint", "case2-planar", "case2-contact", "case3", "case4", "case5"]
    names += ["flexible", "flexible-ideal", "petals", "petals-ideal"]
    names += [f"nod-{frequency}hz" for frequency in (5, 10, 20, 35, 50)]
    assert [case.name for case in bai.cases] == names
    assert all(case.description for case in bai.cases)
    assert (models_path() / "bai2020" / "scenario.toml").is_file()


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
        ("case2-planar", PlanarClearance, 2e-4),
        ("case2-contact", ContactClearance, 0.0),
        ("case3", ContactClearance, 2e-4),
        ("case4", ContactClearance, 3e-4),
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


def test_the_antenna_runs_case_3_by_default():
    assert load_scenario("bai2020").case == "case3"


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


def test_public_names_exist():
    for name in scenario_package.__all__:
        assert hasattr(scenario_package, name)
