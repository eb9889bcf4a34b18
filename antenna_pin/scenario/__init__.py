"""Scenarios: validated data in SI units from a TOML file, nothing computed.

``load_scenario("bai2020", case="case3")`` returns a :class:`Scenario`. A file has a base and named cases that
are laid over it; values may be overridden from outside. A bare number is SI, text carries its unit.

The names below are loaded when first used: the classes that check the parts of a scenario take a while to be
made, and who only lists what there is needs none of them.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from antenna_pin.scenario._choices import COUPLING_SPECS
    from antenna_pin.scenario._made import MadeSpec
    from antenna_pin.scenario.clearance import (
        ClearanceSpec,
        ContactClearance,
        CylindricalClearance,
        IdealClearance,
        PlanarClearance,
        PrismaticClearance,
        SphericalClearance,
        TouchingSpec,
    )
    from antenna_pin.scenario.closures import AnchorSpec, ClosureSpec, LinkPlaceSpec, PlaceSpec
    from antenna_pin.scenario.controllers import (
        AttitudeSpec,
        BangBangSpec,
        ControllerSpec,
        PidSpec,
        SensorSpec,
        StateFeedbackSpec,
    )
    from antenna_pin.scenario.couplings import (
        AnyCoupling,
        CouplingSpec,
        DifferentialSpec,
        PlanetarySpec,
    )
    from antenna_pin.scenario.drives import (
        DRIVE_SPECS,
        FAMILY_SPECS,
        SPRING_SPECS,
        AllLinksSpec,
        AnySpring,
        AtPointSpec,
        DriveSpec,
        ElementSpec,
        JointsSpec,
        PointsSpec,
    )
    from antenna_pin.scenario.events import (
        AngleEvent,
        ChangeEvent,
        EventSpec,
        ForceEvent,
        GapEvent,
        RateEvent,
        TimeEvent,
    )
    from antenna_pin.scenario.flexible import FlexibleSpec, ModalDataSpec, ModeSpec, ModesSpec, PetalsSpec
    from antenna_pin.scenario.initial import InitialBaseSpec, InitialJointSpec, InitialSpec
    from antenna_pin.scenario.integrator import IntegratorSpec, OutputSpec, ScalesSpec, settings_key
    from antenna_pin.scenario.laws import LawChange, LawSpec
    from antenna_pin.scenario.load import load_scenario, scenario_named
    from antenna_pin.scenario.mechanism import JointSpec, LinkSpec, MaterialSpec, MechanismSpec, ShapeSpec
    from antenna_pin.scenario.numbers import Number, number_of, with_number
    from antenna_pin.scenario.pointing import OrbitSpec, PointingSpec
    from antenna_pin.scenario.references import REFERENCE_SPECS, ReferenceSpec
    from antenna_pin.scenario.rotors import RotorSpec
    from antenna_pin.scenario.scenario import Scenario
    from antenna_pin.scenario.shipped import (
        CaseSummary,
        ScenarioSummary,
        list_scenarios,
        models_path,
        scenario_cases,
        scenario_summary,
    )
    from antenna_pin.scenario.stops import joint_limits, moved_joints
    from antenna_pin.scenario.write import found_from, scenario_toml

_HOMES = {
    "AnchorSpec": "closures",
    "AngleEvent": "events",
    "ChangeEvent": "events",
    "CaseSummary": "shipped",
    "ClearanceSpec": "clearance",
    "TouchingSpec": "clearance",
    "ClosureSpec": "closures",
    "ContactClearance": "clearance",
    "AnyCoupling": "couplings",
    "COUPLING_SPECS": "_choices",
    "CouplingSpec": "couplings",
    "DifferentialSpec": "couplings",
    "PlanetarySpec": "couplings",
    "REFERENCE_SPECS": "references",
    "ReferenceSpec": "references",
    "RotorSpec": "rotors",
    "ControllerSpec": "controllers",
    "AttitudeSpec": "controllers",
    "BangBangSpec": "controllers",
    "StateFeedbackSpec": "controllers",
    "PidSpec": "controllers",
    "SensorSpec": "controllers",
    "DRIVE_SPECS": "drives",
    "FAMILY_SPECS": "drives",
    "SPRING_SPECS": "drives",
    "DriveSpec": "drives",
    "EventSpec": "events",
    "FlexibleSpec": "flexible",
    "ForceEvent": "events",
    "ElementSpec": "drives",
    "AllLinksSpec": "drives",
    "AtPointSpec": "drives",
    "JointsSpec": "drives",
    "GapEvent": "events",
    "IdealClearance": "clearance",
    "InitialBaseSpec": "initial",
    "InitialJointSpec": "initial",
    "InitialSpec": "initial",
    "IntegratorSpec": "integrator",
    "JointSpec": "mechanism",
    "LawChange": "laws",
    "LawSpec": "laws",
    "LinkSpec": "mechanism",
    "MadeSpec": "_made",
    "MaterialSpec": "mechanism",
    "ModalDataSpec": "flexible",
    "ModeSpec": "flexible",
    "ModesSpec": "flexible",
    "PetalsSpec": "flexible",
    "MechanismSpec": "mechanism",
    "OrbitSpec": "pointing",
    "OutputSpec": "integrator",
    "LinkPlaceSpec": "closures",
    "PlaceSpec": "closures",
    "PlanarClearance": "clearance",
    "PointsSpec": "drives",
    "PointingSpec": "pointing",
    "CylindricalClearance": "clearance",
    "PrismaticClearance": "clearance",
    "RateEvent": "events",
    "ScalesSpec": "integrator",
    "Scenario": "scenario",
    "ScenarioSummary": "shipped",
    "ShapeSpec": "mechanism",
    "SphericalClearance": "clearance",
    "AnySpring": "drives",
    "TimeEvent": "events",
    "Number": "numbers",
    "list_scenarios": "shipped",
    "number_of": "numbers",
    "with_number": "numbers",
    "load_scenario": "load",
    "scenario_named": "load",
    "joint_limits": "stops",
    "moved_joints": "stops",
    "models_path": "shipped",
    "scenario_cases": "shipped",
    "scenario_summary": "shipped",
    "found_from": "write",
    "scenario_toml": "write",
    "settings_key": "integrator",
}

__all__ = [
    "TouchingSpec",
    "DRIVE_SPECS",
    "FAMILY_SPECS",
    "REFERENCE_SPECS",
    "ReferenceSpec",
    "SPRING_SPECS",
    "AnchorSpec",
    "AngleEvent",
    "ChangeEvent",
    "CaseSummary",
    "ClearanceSpec",
    "ClosureSpec",
    "ContactClearance",
    "AnyCoupling",
    "COUPLING_SPECS",
    "CouplingSpec",
    "DifferentialSpec",
    "PlanetarySpec",
    "AttitudeSpec",
    "BangBangSpec",
    "ControllerSpec",
    "PidSpec",
    "StateFeedbackSpec",
    "RotorSpec",
    "SensorSpec",
    "DriveSpec",
    "EventSpec",
    "FlexibleSpec",
    "ForceEvent",
    "ElementSpec",
    "AllLinksSpec",
    "AtPointSpec",
    "JointsSpec",
    "GapEvent",
    "IdealClearance",
    "InitialBaseSpec",
    "InitialJointSpec",
    "InitialSpec",
    "IntegratorSpec",
    "JointSpec",
    "LawChange",
    "LawSpec",
    "LinkSpec",
    "MadeSpec",
    "MaterialSpec",
    "MechanismSpec",
    "ModalDataSpec",
    "Number",
    "number_of",
    "with_number",
    "ModeSpec",
    "ModesSpec",
    "OrbitSpec",
    "OutputSpec",
    "PetalsSpec",
    "PlanarClearance",
    "CylindricalClearance",
    "PrismaticClearance",
    "LinkPlaceSpec",
    "PlaceSpec",
    "PointsSpec",
    "PointingSpec",
    "RateEvent",
    "ScalesSpec",
    "Scenario",
    "ScenarioSummary",
    "ShapeSpec",
    "SphericalClearance",
    "AnySpring",
    "TimeEvent",
    "joint_limits",
    "moved_joints",
    "list_scenarios",
    "load_scenario",
    "scenario_named",
    "models_path",
    "scenario_cases",
    "scenario_summary",
    "found_from",
    "scenario_toml",
    "settings_key",
]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(f"antenna_pin.scenario.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'antenna_pin.scenario' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
