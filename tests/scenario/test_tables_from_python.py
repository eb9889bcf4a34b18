"""Drives, springs and initial states; tables made in Python."""

import math

import numpy as np
import pytest
from scenario_files import URDF

from antenna_pin import contact
from antenna_pin.errors import InvalidParameterError, ScenarioError, UnknownNameError
from antenna_pin.scenario import (
    DRIVE_SPECS,
    SPRING_SPECS,
    ContactClearance,
    InitialBaseSpec,
    IntegratorSpec,
    LawChange,
    LawSpec,
    MechanismSpec,
    OutputSpec,
    Scenario,
)

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


# --- from Python ---


def test_a_scenario_can_be_built_in_python(folder):
    """Tables of numbers may be arrays; it shows itself without its files."""
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
    drive = DRIVE_SPECS["table"](joint="j", kind="table", time=np.linspace(0, 1, 3), torque=np.arange(3))
    assert (drive.time, drive.torque) == ((0.0, 0.5, 1.0), (0.0, 1.0, 2.0))
    assert InitialBaseSpec(position=np.ones(3)).position == (1.0, 1.0, 1.0)
    text = repr(folder.load())
    assert "robot" not in text
    assert "1.25" not in text
    with pytest.raises(UnknownNameError, match=r"^LawSpec: law: law 'herz' is unknown; did you mean hertz\?"):
        LawSpec(law="herz")


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: IntegratorSpec(rtol=-1), "IntegratorSpec: rtol must be between 0 and 1, got -1"),
        (
            lambda: LawSpec(law="hertz", parameters={"stifness": 1}),
            "LawSpec: stifness is unknown; did you mean stiffness? law hertz takes stiffness, exponent",
        ),
        (lambda: LawSpec(parameters={}), "LawSpec: law is missing"),
        (
            lambda: LawChange(parameters={"stiffness": math.nan}),
            "LawChange: parameters.stiffness must be finite",
        ),
    ],
)
def test_errors_from_python_name_the_class(build, message):
    with pytest.raises(ScenarioError) as refused:
        build()
    assert str(refused.value).startswith(message)
    assert len(str(refused.value).splitlines()) == 1


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
