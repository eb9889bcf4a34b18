r"""What a shaken base does to small motions: it enters as an acceleration.

With N the directions that are left and g the direction in which a motion of the base moves all, positions are
:math:`N s + g u`, and

.. math:: \tilde M \ddot s + \tilde C \dot s + \tilde K s = -N^T (M g \ddot u + C g \dot u + K g u)

of which, for an acceleration of one that swings, :math:`u = -1 / \omega^2`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.analysis import QuantityName
from antenna_pin.dynamics import System, Workspace
from antenna_pin.elements import Shake
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.linear.linearisation import Linearisation

__all__ = ["LINK", "Shaking", "link_row", "shaking", "shakes_in"]

Array = NDArray[np.float64]

#: What an acceleration of a link is called, as among the quantities of a run.
LINK = "body_acceleration"
_AXES = ("x", "y", "z")


class Shaking(NamedTuple):
    """A motion of the base as a source of small motions.

    Attributes:
        linear: The equations.
        way: g, what all velocities are of the motion's, (nv,).
    """

    linear: Linearisation
    way: Array

    def enters(self, omega: float) -> NDArray[np.complex128]:
        """Return what drives the linear system for an acceleration of one at an angular frequency [rad/s]."""
        linear = self.linear
        mass, damping, stiffness = (one @ self.way for one in linear.beside)
        force = -mass + 1j * damping / omega + stiffness / omega**2
        found = np.zeros(linear.input_matrix.shape[0], dtype=complex)
        k = len(linear.mass)
        found[k : 2 * k] = np.linalg.solve(linear.mass, force)
        return found

    def passes(self, rows: Array, omega: float) -> Array:
        """Return what the motion adds to outputs by itself, (outputs,)."""
        return np.asarray(-(rows @ self.way) / omega**2)


def shakes_in(system: System) -> dict[str, Shake]:
    """Return the motions of a system's shaken base by name."""
    return {name: drive for name, drive in system.drives.items() if isinstance(drive, Shake)}


def shaking(linear: Linearisation, name: str) -> Shaking:
    """Return a motion of the base, by name, as a source.

    Raises:
        InvalidParameterError: The state moves.
    """
    at, system = linear.at, linear.system
    if not at.rest:
        rule = "a drive for a state that moves; of a state at rest it may be the base's motion"
        raise InvalidParameterError("response", "source", rule, f"shake.{name}")
    workspace = Workspace(system)
    constraints = workspace.constraints
    assert constraints is not None
    workspace.prepare_motions(at.time, at.y)
    constraints.residuals(at.time, at.y, workspace.program)
    jacobian = np.array(constraints.jacobian)
    own = np.zeros(system.model.nv)
    own[system.mechanism.joint(shakes_in(system)[name].joint).v] = 1.0
    row = [motion.name for motion in system.motions].index(name)
    wanted = np.zeros(len(jacobian))
    wanted[row] = float(jacobian[row] @ own)
    way = own + np.linalg.pinv(jacobian, rcond=1e-9) @ (wanted - jacobian @ own)
    return Shaking(linear, way)


def link_row(linear: Linearisation, name: str) -> tuple[str, Array]:
    """Return the name in full and the row of a link's displacement along a world axis, (nv,).

    Args:
        linear: The equations.
        name: ``body_acceleration[LINK].x`` (y, z).

    Raises:
        AntennaPinError: There is no such link or axis.
    """
    wanted, at = QuantityName.parse(name), linear.at
    link, axis = (*wanted.labels, "", "")[:2]
    if len(wanted.labels) != 2 or axis not in _AXES or wanted.size:
        raise InvalidParameterError("response", "target", f"written as {LINK}[LINK].x, y or z", name)
    known = [one.name for one in at.system.mechanism.urdf.robot.links]
    if link not in known:
        raise UnknownNameError("response", "link", link, known)
    model = at.system.model
    data = model.createData()
    pin.computeJointJacobians(model, data, at.q)
    pin.updateFramePlacements(model, data)
    reference = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    jacobian = pin.getFrameJacobian(model, data, at.system.mechanism.frame(link), reference)
    return f"{LINK}[{link}].{axis}", np.array(jacobian).reshape(6, model.nv)[_AXES.index(axis)]
