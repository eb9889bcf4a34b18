"""Force elements: drives, a controller, springs and dampers at joints, springs between points."""

from antenna_pin.elements.ball_bearing import BallBearing
from antenna_pin.elements.bearing import AxialPreload, Bearing, StiffnessBearing, moved
from antenna_pin.elements.between_points import BetweenPoints, Point
from antenna_pin.elements.constant import ConstantDrive
from antenna_pin.elements.element import GROSS_WORK, LOSS, WORK, About, Drive, Element, ForceElement, Integral
from antenna_pin.elements.given import CallableDrive
from antenna_pin.elements.joint_friction import JointFriction
from antenna_pin.elements.modal import Change, Met, Modal
from antenna_pin.elements.pd import PDController
from antenna_pin.elements.point_spring import PointSpring
from antenna_pin.elements.prescribed import CallableMotion, DistanceMotion, Motion, PrescribedMotion
from antenna_pin.elements.registry import DRIVES, ELEMENTS, FAMILIES, SPRINGS, Family, kind_of
from antenna_pin.elements.rigid_latch import RigidLatch
from antenna_pin.elements.rigid_stop import RigidStop
from antenna_pin.elements.sine import SineDrive
from antenna_pin.elements.spring import JointSpring
from antenna_pin.elements.tabulated import TableDrive

__all__ = [
    "DRIVES",
    "ELEMENTS",
    "FAMILIES",
    "GROSS_WORK",
    "LOSS",
    "SPRINGS",
    "WORK",
    "About",
    "AxialPreload",
    "BallBearing",
    "Bearing",
    "BetweenPoints",
    "CallableDrive",
    "CallableMotion",
    "Change",
    "ConstantDrive",
    "DistanceMotion",
    "Drive",
    "Element",
    "Family",
    "ForceElement",
    "Integral",
    "JointFriction",
    "JointSpring",
    "Met",
    "Modal",
    "Motion",
    "PDController",
    "Point",
    "PointSpring",
    "PrescribedMotion",
    "RigidLatch",
    "RigidStop",
    "SineDrive",
    "StiffnessBearing",
    "TableDrive",
    "kind_of",
    "moved",
]
