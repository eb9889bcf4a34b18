"""Frequency responses: from torques, base forces or shaking to angles, links, the boresight."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from antenna_pin.analysis import Antenna, QuantityName
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import slope
from antenna_pin.dynamics import JointMotion, System, Workspace
from antenna_pin.elements import ConstantDrive, Motion, Shake
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.studies.linear.linearisation import Linearisation
from antenna_pin.studies.linear.modal_analysis import COMPONENTS, Modes
from antenna_pin.studies.linear.operating_point import At

# --- what a shaken base does to small motions: it enters as an acceleration ---
#
# With N the directions that are left and g the direction in which a motion of the base moves all, positions
# are :math:`N s + g u`, and
#
# .. math:: \tilde M \ddot s + \tilde C \dot s + \tilde K s = -N^T (M g \ddot u + C g \dot u + K g u)
#
# of which, for an acceleration of one that swings, :math:`u = -1 / \omega^2`.

#: What an acceleration of a link is called, as among the quantities of a run.
_LINK = "body_acceleration"
_AXES = ("x", "y", "z")


class _Shaking(NamedTuple):
    """Motion of the base as a source of small motions."""

    linear: Linearisation  # the equations
    way: Array  # g, ratio of all velocities to the motion's, (nv,)

    def enters(self, omega: float) -> NDArray[np.complex128]:
        """Return the input of the linear system for unit acceleration at an angular frequency [rad/s]."""
        linear = self.linear
        mass, damping, stiffness = (one @ self.way for one in linear.beside)
        force = -mass + 1j * damping / omega + stiffness / omega**2
        found = np.zeros(linear.input_matrix.shape[0], dtype=complex)
        k = len(linear.mass)
        found[k : 2 * k] = np.linalg.solve(linear.mass, force)
        return found

    def passes(self, rows: Array, omega: float) -> Array:
        """Return the motion's direct contribution to outputs, (outputs,)."""
        return np.asarray(-(rows @ self.way) / omega**2)


def _base_motions(system: System) -> dict[str, Shake]:
    """Return the motions of a system's shaken base by name."""
    return {name: drive for name, drive in system.drives.items() if isinstance(drive, Shake)}


def _base_motion(linear: Linearisation, name: str) -> _Shaking:
    """Return a motion of the base, by name, as a source."""
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
    own[system.mechanism.joint(_base_motions(system)[name].joint).v] = 1.0
    row = [motion.name for motion in system.motions].index(name)
    wanted = np.zeros(len(jacobian))
    wanted[row] = float(jacobian[row] @ own)
    way = own + np.linalg.pinv(jacobian, rcond=1e-9) @ (wanted - jacobian @ own)
    return _Shaking(linear, way)


def _link_row(linear: Linearisation, name: str) -> tuple[str, Array]:
    """Return full name and row of a link's displacement along a world axis, (nv,)."""
    wanted, at = QuantityName.parse(name), linear.at
    link, axis = (*wanted.labels, "", "")[:2]
    if len(wanted.labels) != 2 or axis not in _AXES or wanted.size:
        raise InvalidParameterError("response", "target", f"written as {_LINK}[LINK].x, y or z", name)
    known = [one.name for one in at.system.mechanism.urdf.robot.links]
    if link not in known:
        raise UnknownNameError("response", "link", link, known)
    model = at.system.model
    data = model.createData()
    pin.computeJointJacobians(model, data, at.q)
    pin.updateFramePlacements(model, data)
    reference = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    jacobian = pin.getFrameJacobian(model, data, at.system.mechanism.frame(link), reference)
    return f"{_LINK}[{link}].{axis}", np.array(jacobian).reshape(6, model.nv)[_AXES.index(axis)]


#: The target that the antenna's pointing is, as two turns.
BORESIGHT = "boresight"

_BASE_FORCES = {f"base.{name}": k for k, name in enumerate(("fx", "fy", "fz", "mx", "my", "mz"))}
_BASE_MOTIONS = {f"base.{name}": k for k, name in enumerate(COMPONENTS)}
# Regular points, and around each resonance in half widths of its peak, of which there are at most so many.
_POINTS, _NEAR, _PEAKS = 600, np.linspace(-8.0, 8.0, 33), 40
_LEAST_WIDTH = 1e-4
# How far beyond the vibrations the default range goes, and how far above the slowest it ends at most.
_BELOW, _BEYOND, _DECADES = 0.2, 3.0, 3.0


class _Output(NamedTuple):
    name: str
    unit: str
    row: Array  # derivative over the coordinates of velocities, (nv,)
    bends: bool = False  # whether its second derivative is the output


@takes()
def sources_of(modes: Modes) -> list[str]:
    """Return the possible sources: drives, motions of a shaken base, forces on a free base."""
    system = modes.linearisation.system
    found = [f"drives.{n}" for n, drive in system.drives.items() if not isinstance(drive, Motion)]
    found += [f"shake.{name}" for name in _base_motions(system)]
    return found + (list(_BASE_FORCES) if system.mechanism.base == "free" else [])


@takes()
def first_source(modes: Modes, label: str = "source") -> str:
    """Return the default source of a response.

    The label is the name of the option or argument in the message.

    Raises:
        InvalidParameterError: The mechanism has no source.
    """
    known = sources_of(modes)
    if not known:
        raise InvalidParameterError("modes", label, "a drive or a free base, and the system has neither", "")
    return known[0]


@takes()
def targets_of(modes: Modes) -> list[str]:
    """Return the possible targets: the boresight, joints with an axis, a free base.

    The acceleration of a link, ``body_acceleration[LINK].x`` (y, z), is a target everywhere.
    """
    system = modes.linearisation.system
    found = [BORESIGHT] if modes.scenario is not None and modes.scenario.pointing is not None else []
    ball = {joint.name for joint in system.clearances if joint.geometry.motion is None}
    held = {name for name, kind in system.held.items() if kind == "spherical"}
    with_play = {joint.name for joint in system.clearances} | {*system.held, *system.on_bearings}
    for name, slot in system.mechanism.joints.items():
        axis = slot.has_one_axis or name in with_play
        if axis and name not in ball | held:
            found.append(name)
    return found + (list(_BASE_MOTIONS) if system.mechanism.base == "free" else [])


@takes()
def frequency_response(
    modes: Modes,
    source: str,
    targets: str | Sequence[str] | None = None,
    frequencies: ArrayLike | None = None,
) -> xr.Dataset:
    """Return the steady damped response to a source, over its frequency.

    Args:
        modes: The modes.
        source: ``drives.NAME``, that drive's torque (force at a sliding joint), or ``base.fx`` to
            ``base.mz``, a force or moment at the base's origin along its axes; ``shake.NAME``, the
            acceleration of a shaken base (:func:`sources_of`).
        targets: ``boresight``, its turns about the antenna's cross and up axes; names of joints, their
            angles; ``base.x`` to ``base.rz``, displacements of the base's origin in its axes;
            ``body_acceleration[LINK].x`` (y, z), of a link's frame in world axes (:func:`targets_of`).
            By default the boresight, or without one the drive's own joint; of a shaken base all joints that
            swing.
        frequencies: Frequencies, rising and positive [Hz]; by default those of the modes and beyond, with
            points close together at resonances.

    Returns:
        ``response`` (frequency, target), complex, output over input, ``gain`` its magnitude and ``phase``
        [rad], with ``unit`` of each target. For a moving state it holds while the state hardly changes.

    Raises:
        AntennaPinError: A source or target is unknown, or frequencies are invalid.
    """
    linear = modes.linearisation
    known = sources_of(modes)
    if source not in known:
        drive = linear.system.drives.get(source.removeprefix("drives."))
        if isinstance(drive, Motion):
            raise InvalidParameterError(
                "response", "source", "a force or torque; this drive prescribes its joint's motion", source
            )
        raise UnknownNameError("response", "source", source, known)
    outputs = _outputs(modes, source, targets)
    grid = _grid(modes) if frequencies is None else _checked(frequencies)
    rows = np.array([one.row for one in outputs])
    matrix, k = linear.state_matrix, len(linear.mass)
    leaves = np.zeros((len(outputs), len(matrix)))
    leaves[:, :k] = rows @ linear.directions
    shaken, enters = None, np.zeros(len(matrix))
    if source.startswith("shake."):
        shaken = _base_motion(linear, source.removeprefix("shake."))
        unit = "m/s^2" if _base_motions(linear.system)[source.removeprefix("shake.")].slides else "rad/s^2"
    else:
        effort, unit = _effort(linear.at, source)
        enters = linear.input_matrix @ effort
    found = np.zeros((len(grid), len(outputs)), dtype=complex)
    bends = np.array([one.bends for one in outputs])
    for i, frequency in enumerate(grid):
        omega = 2.0 * np.pi * frequency
        by = enters if shaken is None else shaken.enters(omega)
        found[i] = leaves @ np.linalg.solve(1j * omega * np.eye(len(matrix)) - matrix, by)
        if shaken is not None:
            found[i] += shaken.passes(rows, omega)
        found[i, bends] *= -(omega**2)
    return xr.Dataset(
        {
            "response": (("frequency", "target"), found, {"long_name": f"over the input, {source}"}),
            "gain": (("frequency", "target"), np.abs(found), {"long_name": "magnitude of the response"}),
            "phase": (
                ("frequency", "target"),
                np.unwrap(np.angle(found), axis=0),
                {"units": "rad", "long_name": "phase of the response"},
            ),
        },
        coords={
            "frequency": ("frequency", grid, {"units": "Hz", "long_name": "frequency of the input"}),
            "target": [one.name for one in outputs],
            "unit": ("target", [f"{one.unit}/({unit})" for one in outputs]),
        },
        attrs={
            "title": modes.data.attrs["title"],
            "case": modes.data.attrs["case"],
            "source": source,
            "resonances": [float(f) for f in modes.frequency[modes.frequency > 0.0]],
        },
    )


class Plant(NamedTuple):
    """Linear system from the effort of a drive to the position of a joint."""

    matrix: Array  # A, (n, n)
    input: Array  # B, (n,), for 1 N m (1 N) of the drive
    angle: Array  # row of the joint's angle [rad] (way [m]), (n,)
    rate: Array  # row of the joint's rate, (n,)


@takes()
def plant_of(modes: Modes, drive: str, joint: str) -> Plant:
    """Return the linear system between a drive's effort and a joint.

    Raises:
        UnknownNameError: The drive or joint is unknown.
    """
    linear, source = modes.linearisation, f"drives.{drive}"
    if source not in sources_of(modes):
        raise UnknownNameError("response", "source", source, sources_of(modes))
    if joint not in targets_of(modes):
        raise UnknownNameError("response", "target", joint, targets_of(modes))
    effort, _ = _effort(linear.at, source)
    row = _joint(linear.at, joint).row @ linear.directions
    matrix, k = linear.state_matrix, len(linear.mass)
    angle = np.zeros(len(matrix))
    angle[:k] = row
    return Plant(matrix, linear.input_matrix @ effort, angle, np.asarray(angle @ matrix))


def _effort(at: At, source: str) -> tuple[Array, str]:
    """Return the generalized force of one unit of a source, (nv,), and the unit."""
    nv = at.system.model.nv
    if source in _BASE_FORCES:
        k = _BASE_FORCES[source]
        return np.eye(nv)[k], "N" if k < 3 else "N m"
    drive: Any = at.system.drives[source.removeprefix("drives.")]
    unit = ConstantDrive(joint=drive.joint, value=1.0, axis=drive.axis)
    # Only the drive acts: what bearings carry counts as held, for all that it takes is an axis.
    held = {**at.system.held, **at.system.free_with_axis}
    alone = System(at.system.mechanism, clearances=at.system.clearances, held=held, drives={"unit": unit})
    workspace = Workspace(alone)
    y = alone.state(at.q, np.zeros(nv))
    workspace.apply_elements(at.time, y, np.zeros(nv + alone.manifold.nx))
    return np.array(workspace.tau), "N" if _slides(at.system, drive.joint) else "N m"


def _slides(system: System, joint: str) -> bool:
    return system.slides(joint) or system.held.get(joint) == "prismatic"


def _outputs(modes: Modes, source: str, targets: str | Sequence[str] | None) -> list[_Output]:
    system = modes.linearisation.system
    known = targets_of(modes)
    if targets is None:
        drive = system.drives.get(source.removeprefix("drives."))
        shaken = (
            {one.joint for one in _base_motions(system).values()} if source.startswith("shake.") else set()
        )
        others = [name for name in known if name not in shaken]
        if shaken and BORESIGHT not in known:
            targets = others
        else:
            targets = BORESIGHT if BORESIGHT in known or drive is None else drive.joint
    found: list[_Output] = []
    for name in [targets] if isinstance(targets, str) else list(targets):
        if name.startswith(_LINK):
            full, row = _link_row(modes.linearisation, name)
            found.append(_Output(full, "m/s^2", row, True))
            continue
        if name not in known:
            raise UnknownNameError("response", "target", name, known)
        if name == BORESIGHT:
            found += _boresight(modes)
        elif name in _BASE_MOTIONS:
            k = _BASE_MOTIONS[name]
            found.append(_Output(name, "m" if k < 3 else "rad", np.eye(system.model.nv)[k]))
        else:
            found.append(_joint(modes.linearisation.at, name))
    return found


def _joint(at: At, name: str) -> _Output:
    system = at.system
    motion = JointMotion(system, name)
    slot = system.mechanism.joint(name)
    row = np.zeros(system.model.nv)
    for k in range(slot.v.start, slot.v.stop):
        e = np.eye(system.model.nv)[k]

        def angle(s: float, e: Array = e) -> Array:
            y = at.y.copy()
            y[: system.model.nq] = pin.integrate(system.model, at.q, s * e)
            return np.array([motion(y)[0]])

        row[k] = slope(angle).value[0]
    return _Output(name, "m" if _slides(system, name) else "rad", row)


def _boresight(modes: Modes) -> list[_Output]:
    """Return the rotations of the looking body about the antenna's cross and up axes."""
    at = modes.linearisation.at
    assert modes.scenario is not None and modes.scenario.pointing is not None
    spec = modes.scenario.pointing
    antenna = Antenna(body=spec.body, boresight=spec.boresight, up=spec.up)
    model = at.system.model
    data = model.createData()
    frame = at.system.mechanism.frame(antenna.body)
    pin.computeJointJacobians(model, data, at.q)
    pin.updateFramePlacements(model, data)
    own = np.array(pin.getFrameJacobian(model, data, frame, pin.ReferenceFrame.LOCAL)).reshape(6, model.nv)
    turns = antenna.axes.as_matrix().T @ own[3:]
    return [_Output(f"{BORESIGHT} {name}", "rad", turns[k]) for k, name in ((1, "cross"), (2, "up"))]


def _grid(modes: Modes) -> Array:
    """Return frequencies from below the slowest vibration to beyond the fastest, close at resonances [Hz]."""
    some = modes.frequency > 0.0
    resonances = modes.frequency[some]
    if len(resonances) == 0:
        return np.geomspace(0.01, 100.0, _POINTS)
    low = _BELOW * float(resonances.min())
    high = min(_BEYOND * float(resonances.max()), low * 10.0**_DECADES)
    grids = [np.geomspace(low, high, _POINTS)]
    for frequency, ratio in zip(resonances[:_PEAKS], modes.damping_ratio[some][:_PEAKS], strict=True):
        width = max(ratio if np.isfinite(ratio) else 0.0, _LEAST_WIDTH)
        if width < 0.1:
            grids.append(frequency * (1.0 + width * _NEAR))
    grid = np.unique(np.concatenate(grids))
    return np.asarray(grid[(grid >= low) & (grid <= high)])


def _checked(frequencies: ArrayLike) -> Array:
    grid = np.atleast_1d(np.asarray(frequencies, dtype=float))
    if (
        grid.ndim != 1
        or not np.isfinite(grid).all()
        or not (grid > 0.0).all()
        or (np.diff(grid) <= 0.0).any()
    ):
        raise InvalidParameterError("response", "frequencies", "positive and rising [Hz]", frequencies)
    return grid
