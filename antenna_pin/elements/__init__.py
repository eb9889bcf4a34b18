"""Force elements: drives, a controller, springs and dampers at joints, springs between points."""

from antenna_pin._lazy import only_public
from antenna_pin.elements.angle_table import Outside, TableSpring
from antenna_pin.elements.ball_bearing import BallBearing
from antenna_pin.elements.bearing import AxialPreload, Bearing, StiffnessBearing, moved
from antenna_pin.elements.belt import Belt, Cable
from antenna_pin.elements.between_joints import BetweenJoints
from antenna_pin.elements.between_points import BetweenPoints
from antenna_pin.elements.bouc_wen import BoucWen
from antenna_pin.elements.capture import Capture
from antenna_pin.elements.composed_courses import Sum, Table
from antenna_pin.elements.constant import ConstantDrive
from antenna_pin.elements.constant_spring import ConstantSpring
from antenna_pin.elements.courses import Chirp, Constant, Polynomial, Ramp, Sine, Sines
from antenna_pin.elements.element import GROSS_WORK, LOSS, WORK, About, Drive, Element, ForceElement, Integral
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
    "Cable",
    "CallableDrive",
    "CallableElement",
    "CallableForce",
    "CallableMotion",
    "Capture",
    "Change",
    "ConstantDrive",
    "ConstantSpring",
    "DistanceMotion",
    "Drive",
    "Element",
    "EndStop",
    "Family",
    "ForceElement",
    "Gear",
    "GravityGradient",
    "HarnessSpring",
    "Integral",
    "JointFriction",
    "JointSpring",
    "Latch",
    "Limits",
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

only_public(__name__)
