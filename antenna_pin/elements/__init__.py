"""Force elements: drives, a controller, springs and dampers at joints, springs between points."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.elements.angle_table import Outside, TableSpring
    from antenna_pin.elements.ball_bearing import BallBearing
    from antenna_pin.elements.bearing import AxialPreload, Bearing, StiffnessBearing, moved
    from antenna_pin.elements.belt import Belt, Cable
    from antenna_pin.elements.between_joints import BetweenJoints
    from antenna_pin.elements.between_points import BetweenPoints
    from antenna_pin.elements.bouc_wen import BoucWen
    from antenna_pin.elements.bristle_friction import (
        BristleFriction,
        DahlFriction,
        GonthierFriction,
        LuGreFriction,
    )
    from antenna_pin.elements.capture import Capture
    from antenna_pin.elements.composed_courses import Sum, Table
    from antenna_pin.elements.constant import ConstantDrive
    from antenna_pin.elements.constant_spring import ConstantSpring
    from antenna_pin.elements.courses import Chirp, Constant, Polynomial, Ramp, Sine, Sines
    from antenna_pin.elements.element import (
        GROSS_WORK,
        LOSS,
        WORK,
        About,
        Drive,
        Element,
        ForceElement,
        Integral,
    )
    from antenna_pin.elements.given import CallableDrive
    from antenna_pin.elements.given_links import Acts, CallableElement, CallableForce
    from antenna_pin.elements.gravity_gradient import GravityGradient
    from antenna_pin.elements.harness import HarnessSpring
    from antenna_pin.elements.joint_friction import JointFriction
    from antenna_pin.elements.latch import Latch
    from antenna_pin.elements.limits import Limits
    from antenna_pin.elements.maxwell_slip import MaxwellSlip
    from antenna_pin.elements.mesh import Gear, Rack, Spline
    from antenna_pin.elements.modal import Change, Met, Modal, ModalElement
    from antenna_pin.elements.motor import Motor
    from antenna_pin.elements.on_links import AtPoint, OnLinks
    from antenna_pin.elements.outside_force import OutsideForce
    from antenna_pin.elements.pd import PDController
    from antenna_pin.elements.point import Point
    from antenna_pin.elements.point_spring import PointSpring
    from antenna_pin.elements.prescribed import CallableMotion, DistanceMotion, Motion, PrescribedMotion
    from antenna_pin.elements.random_shake import RandomShake, band_power, density_at
    from antenna_pin.elements.reference import Reference
    from antenna_pin.elements.reference_registry import REFERENCES
    from antenna_pin.elements.registry import (
        DRIVES,
        ELEMENTS,
        FAMILIES,
        GEARS,
        SHAKES,
        SPRINGS,
        Family,
        kind_of,
    )
    from antenna_pin.elements.rigid_latch import RigidLatch
    from antenna_pin.elements.rigid_stop import RigidStop
    from antenna_pin.elements.shake import Shake, SineShake, SweepShake
    from antenna_pin.elements.shaken_table import TableShake
    from antenna_pin.elements.sine import SineDrive
    from antenna_pin.elements.slews import RestToRest, SCurve, Slew, Trapezoid
    from antenna_pin.elements.spring import JointSpring
    from antenna_pin.elements.sticking_friction import StickingFriction
    from antenna_pin.elements.stop import EndStop
    from antenna_pin.elements.swept_pieces import SweptPiece, sines_of
    from antenna_pin.elements.tabulated import TableDrive
    from antenna_pin.elements.thruster import Thruster
    from antenna_pin.elements.together import check_together

__all__ = [
    "Trapezoid",
    "Slew",
    "SCurve",
    "RestToRest",
    "Reference",
    "Table",
    "Sum",
    "Sines",
    "Sine",
    "Ramp",
    "Polynomial",
    "Constant",
    "Chirp",
    "REFERENCES",
    "DRIVES",
    "ELEMENTS",
    "FAMILIES",
    "GEARS",
    "GROSS_WORK",
    "LOSS",
    "SHAKES",
    "SPRINGS",
    "WORK",
    "About",
    "Acts",
    "AtPoint",
    "AxialPreload",
    "BallBearing",
    "Bearing",
    "Belt",
    "BetweenJoints",
    "BetweenPoints",
    "BoucWen",
    "BristleFriction",
    "Cable",
    "CallableDrive",
    "CallableElement",
    "CallableForce",
    "CallableMotion",
    "Capture",
    "Change",
    "ConstantDrive",
    "ConstantSpring",
    "DahlFriction",
    "DistanceMotion",
    "Drive",
    "Element",
    "EndStop",
    "Family",
    "ForceElement",
    "Gear",
    "GonthierFriction",
    "GravityGradient",
    "HarnessSpring",
    "Integral",
    "JointFriction",
    "JointSpring",
    "Latch",
    "Limits",
    "LuGreFriction",
    "MaxwellSlip",
    "Met",
    "Modal",
    "ModalElement",
    "Motion",
    "OnLinks",
    "Motor",
    "Outside",
    "OutsideForce",
    "PDController",
    "Point",
    "PointSpring",
    "PrescribedMotion",
    "Rack",
    "RandomShake",
    "RigidLatch",
    "RigidStop",
    "Shake",
    "SineDrive",
    "SineShake",
    "Spline",
    "StickingFriction",
    "StiffnessBearing",
    "SweepShake",
    "SweptPiece",
    "TableDrive",
    "TableShake",
    "TableSpring",
    "band_power",
    "Thruster",
    "check_together",
    "density_at",
    "kind_of",
    "moved",
    "sines_of",
]

loaded_when_used(
    __name__,
    {
        "angle_table": "Outside TableSpring",
        "ball_bearing": "BallBearing",
        "bearing": "AxialPreload Bearing StiffnessBearing moved",
        "belt": "Belt Cable",
        "between_joints": "BetweenJoints",
        "between_points": "BetweenPoints",
        "bouc_wen": "BoucWen",
        "bristle_friction": "BristleFriction DahlFriction GonthierFriction LuGreFriction",
        "capture": "Capture",
        "composed_courses": "Sum Table",
        "constant": "ConstantDrive",
        "constant_spring": "ConstantSpring",
        "courses": "Chirp Constant Polynomial Ramp Sine Sines",
        "element": "About Drive Element ForceElement GROSS_WORK Integral LOSS WORK",
        "given": "CallableDrive",
        "given_links": "Acts CallableElement CallableForce",
        "gravity_gradient": "GravityGradient",
        "harness": "HarnessSpring",
        "joint_friction": "JointFriction",
        "latch": "Latch",
        "limits": "Limits",
        "maxwell_slip": "MaxwellSlip",
        "mesh": "Gear Rack Spline",
        "modal": "Change Met Modal ModalElement",
        "motor": "Motor",
        "on_links": "AtPoint OnLinks",
        "outside_force": "OutsideForce",
        "pd": "PDController",
        "point": "Point",
        "point_spring": "PointSpring",
        "prescribed": "CallableMotion DistanceMotion Motion PrescribedMotion",
        "random_shake": "RandomShake band_power density_at",
        "reference": "Reference",
        "reference_registry": "REFERENCES",
        "registry": "DRIVES ELEMENTS FAMILIES Family GEARS SHAKES SPRINGS kind_of",
        "rigid_latch": "RigidLatch",
        "rigid_stop": "RigidStop",
        "shake": "Shake SineShake SweepShake",
        "shaken_table": "TableShake",
        "sine": "SineDrive",
        "slews": "RestToRest SCurve Slew Trapezoid",
        "spring": "JointSpring",
        "sticking_friction": "StickingFriction",
        "stop": "EndStop",
        "swept_pieces": "SweptPiece sines_of",
        "tabulated": "TableDrive",
        "thruster": "Thruster",
        "together": "check_together",
    },
)
