"""Force elements: drives, a controller, springs and dampers at joints, springs between points."""

from antenna_pin.elements.angle_table import Outside, TableSpring
from antenna_pin.elements.ball_bearing import BallBearing
from antenna_pin.elements.bearing import AxialPreload, Bearing, StiffnessBearing, moved
from antenna_pin.elements.belt import Belt, Cable
from antenna_pin.elements.between_joints import BetweenJoints
from antenna_pin.elements.between_points import BetweenPoints, Point
from antenna_pin.elements.bouc_wen import BoucWen
from antenna_pin.elements.capture import Capture
from antenna_pin.elements.constant import ConstantDrive
from antenna_pin.elements.constant_spring import ConstantSpring
from antenna_pin.elements.element import GROSS_WORK, LOSS, WORK, About, Drive, Element, ForceElement, Integral
from antenna_pin.elements.given import CallableDrive
from antenna_pin.elements.harness import HarnessSpring
from antenna_pin.elements.joint_friction import JointFriction
from antenna_pin.elements.latch import Latch
from antenna_pin.elements.limits import Limits
from antenna_pin.elements.maxwell_slip import MaxwellSlip
from antenna_pin.elements.mesh import Gear, Spline
from antenna_pin.elements.modal import Change, Met, Modal
from antenna_pin.elements.motor import Motor
from antenna_pin.elements.pd import PDController
from antenna_pin.elements.point_spring import PointSpring
from antenna_pin.elements.prescribed import CallableMotion, DistanceMotion, Motion, PrescribedMotion
from antenna_pin.elements.registry import (
    DRIVES,
    ELEMENTS,
    FAMILIES,
    GEARS,
    SPRINGS,
    Family,
    kind_of,
)
from antenna_pin.elements.rigid_latch import RigidLatch
from antenna_pin.elements.rigid_stop import RigidStop
from antenna_pin.elements.sine import SineDrive
from antenna_pin.elements.spring import JointSpring
from antenna_pin.elements.sticking_friction import StickingFriction
from antenna_pin.elements.stop import EndStop
from antenna_pin.elements.tabulated import TableDrive
from antenna_pin.elements.together import check_together

__all__ = [
    "DRIVES",
    "ELEMENTS",
    "FAMILIES",
    "GEARS",
    "GROSS_WORK",
    "LOSS",
    "SPRINGS",
    "WORK",
    "About",
    "AxialPreload",
    "BallBearing",
    "Bearing",
    "Belt",
    "BetweenJoints",
    "BetweenPoints",
    "BoucWen",
    "Cable",
    "CallableDrive",
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
    "HarnessSpring",
    "Integral",
    "JointFriction",
    "JointSpring",
    "Latch",
    "Limits",
    "MaxwellSlip",
    "Met",
    "Modal",
    "Motion",
    "Motor",
    "Outside",
    "PDController",
    "Point",
    "PointSpring",
    "PrescribedMotion",
    "RigidLatch",
    "RigidStop",
    "SineDrive",
    "Spline",
    "StickingFriction",
    "StiffnessBearing",
    "TableDrive",
    "TableSpring",
    "check_together",
    "kind_of",
    "moved",
]
