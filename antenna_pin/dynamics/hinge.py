"""An ideal revolute joint closed by Pinocchio's constrained dynamics over a 6-DOF free joint.

Pinocchio has no closure of five degrees of freedom; two point contacts (CONTACT_3D) whose anchors lie on the
axis hold the same five, with one equation too many (the distance between the anchors), which the proximal
solver tolerates.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.errors import InvalidParameterError, MechanismError
from antenna_pin.mechanism import JointSlot, Mechanism

__all__ = ["Hinge", "constrained_acceleration", "hinge_slot"]

Array = NDArray[np.float64]

# The accuracy test of the proximal solver rarely stops it, and five iterations reach round-off.
_ITERATIONS = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class Hinge:
    r"""A floating joint held to a revolute joint by constraint.

    Attributes:
        joint: The URDF joint, made free in the variant.
        spread: Distance of each of the two anchors from the joint's origin, along the axis [m].
        proximal: mu of the proximal solver [-].
        stabilisation: omega of critically damped Baumgarte stabilisation,
            :math:`\ddot c = -2 \omega \dot c - \omega^2 c` [1/s]; 0 leaves the acceleration untouched and the
            drift to the integrator's accuracy.
    """

    joint: str
    spread: float = 0.1
    proximal: float = 1e-8
    stabilisation: float = 0.0

    def __post_init__(self) -> None:
        """Check the values."""
        for name in ("spread", "proximal"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise InvalidParameterError(self, name, "positive and finite")
        if not 0.0 <= self.stabilisation < math.inf:
            raise InvalidParameterError(self, "stabilisation", "zero or more, and finite")


def hinge_slot(mechanism: Mechanism, hinge: Hinge) -> JointSlot:
    """Return the slot of a hinge's joint, checked to be free."""
    slot = mechanism.joint(hinge.joint)
    if slot.kind != "floating":
        raise MechanismError(
            f"hinge {hinge.joint!r}: the joint must be floating to be held by constraint, got {slot.kind}"
        )
    return slot


def constrained_acceleration(
    mechanism: Mechanism, data: Any, hinges: Sequence[Hinge]
) -> Callable[[Array, Array, Array], Array]:
    """Return ``(q, v, tau) -> acceleration`` of the tree under the hinges' constraints.

    Args:
        mechanism: Its joints named by the hinges must be floating.
        data: ``pin.Data`` of the run.
        hinges: The joints to hold.
    """
    model = mechanism.model
    models = pin.StdVec_RigidConstraintModel()
    for hinge in hinges:
        slot = hinge_slot(mechanism, hinge)
        parent = int(model.parents[slot.joint_id])
        placement = model.jointPlacements[slot.joint_id]
        for sign in (1.0, -1.0):
            anchor = pin.SE3(np.eye(3), sign * hinge.spread * slot.axis)
            constraint = pin.RigidConstraintModel(
                pin.ContactType.CONTACT_3D,
                model,
                parent,
                placement * anchor,
                slot.joint_id,
                anchor,
                pin.LOCAL,
            )
            omega = hinge.stabilisation
            if omega > 0.0:
                constraint.setBaumgarteCorrectorParameters(
                    pin.BaumgarteCorrectorParameters(omega**2, 2.0 * omega)
                )
            models.append(constraint)
    datas = pin.StdVec_RigidConstraintData()
    for constraint in models:
        datas.append(constraint.createData())
    settings = pin.ProximalSettings(1e-14, min(h.proximal for h in hinges), _ITERATIONS)
    pin.initConstraintDynamics(model, data, models, datas)

    def acceleration(q: Array, v: Array, tau: Array) -> Array:
        result: Array = pin.constraintDynamics(model, data, q, v, tau, models, datas, settings)
        return result

    return acceleration
