"""From the samples of a run to labelled arrays: all that a state implies, with units."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.dynamics import System, Workspace, audit
from antenna_pin.dynamics import _kernels as _dynamics
from antenna_pin.geometry import AxialScenario, RadialScenario, RevoluteClearance
from antenna_pin.geometry import _kernels as _geometry
from antenna_pin.geometry.shapes import TABLE_WIDTH
from antenna_pin.joints import _kernels as _joint
from antenna_pin.mechanism import frame_aligning_z, quaternions
from antenna_pin.simulation.loop import Run
from antenna_pin.simulation.places import mechanism_attributes

__all__ = ["dataset"]

Array = NDArray[np.float64]

_AXES = ("x", "y", "z")
_DOF_NAMES = {
    "floating": ("x", "y", "z", "qx", "qy", "qz", "qw"),
    "planar": ("x", "y", "cos", "sin"),
    "continuous": ("cos", "sin"),
    "spherical": ("qx", "qy", "qz", "qw"),
}
_RATE_NAMES = {
    "floating": ("vx", "vy", "vz", "wx", "wy", "wz"),
    "planar": ("vx", "vy", "wz"),
    "spherical": ("wx", "wy", "wz"),
}


class _Table:
    """Variables of a dataset in the making: name -> (dims, values, units, long name)."""

    def __init__(self) -> None:
        self.variables: dict[str, tuple[tuple[str, ...], Any, dict[str, Any]]] = {}

    def add(
        self, name: str, dims: tuple[str, ...], values: Any, units: str, meaning: str, **more: Any
    ) -> None:
        self.variables[name] = (dims, values, {"units": units, "long_name": meaning, **more})


def _coordinate_names(system: System) -> tuple[list[str], list[str]]:
    configuration, velocity = [], []
    if system.mechanism.base == "free":
        configuration += [f"base.{name}" for name in _DOF_NAMES["floating"]]
        velocity += [f"base.{name}" for name in _RATE_NAMES["floating"]]
    for slot in system.mechanism.joints.values():
        for target, names in ((configuration, _DOF_NAMES), (velocity, _RATE_NAMES)):
            parts = names.get(slot.kind)
            target += [slot.name] if parts is None else [f"{slot.name}.{part}" for part in parts]
    return configuration, velocity


class _Observer:
    """Evaluates the system at every sample and keeps what the file needs."""

    def __init__(self, run: Run) -> None:
        system = run.system
        self.run = run
        self.system = system
        self.n = len(run.samples.times)
        self.times = np.array(run.samples.times)
        self.states = np.array(run.samples.states)
        contacts, joints = len(system.contact_names), len(system.clearances)
        drives = len(system.drives)
        self.a = np.zeros((self.n, system.model.nv))
        self.tables = np.zeros((self.n, contacts, TABLE_WIDTH))
        self.poses = np.zeros((self.n, joints, _joint.POSE_BUFFER))
        self.scenarios = np.zeros((self.n, joints, 2), dtype=np.int8)
        self.wrenches = np.zeros((self.n, joints, 6))
        self.efforts = np.zeros((self.n, drives))
        self.energies = np.zeros((self.n, 4))
        self.linear = np.zeros((self.n, 3))
        self.angular = np.zeros((self.n, 3))
        self.momentum_scales = np.zeros((self.n, 2))
        self._observe()

    def _observe(self) -> None:
        system = self.system
        workspace = Workspace(system)
        rates = np.zeros(system.model.nv + system.manifold.nx)
        y = np.zeros(system.manifold.size)
        nq = system.model.nq
        scratch = np.zeros((5, TABLE_WIDTH))
        derivative = workspace.bind(y, rates)
        blocks = [system.clearance_blocks[joint.name] for joint in system.clearances]
        for i in range(self.n):
            y[:] = self.states[i]
            workspace.memory[:] = self.run.samples.memories[i]
            workspace.program[:] = self.run.samples.programs[i]
            workspace.measure(y)
            derivative(self.times[i])
            self.a[i] = rates[: system.model.nv]
            self.tables[i] = workspace.table[: len(system.contact_names)]
            found = audit(workspace, y)
            self.energies[i] = (found.kinetic, found.contacts, found.springs, found.gravity)
            self.linear[i], self.angular[i] = found.linear, found.angular
            self.momentum_scales[i] = (found.linear_scale, found.angular_scale)
            for k, block in enumerate(system.drive_blocks.values()):
                self.efforts[i, k] = _dynamics.drive_effort(workspace.program, block, self.times[i])
            for k, joint in enumerate(system.clearances):
                pose = self.poses[i, k]
                _joint.journal_state(system.program, blocks[k], y, nq, pose)
                row = int(system.program[blocks[k] + _joint.FIRST_CONTACT])
                _joint.wrench_on_journal(
                    system.program, blocks[k], pose, workspace.table, row, self.wrenches[i, k]
                )
                if isinstance(joint.geometry, RevoluteClearance):
                    shape, at = joint.geometry.shape(), _joint.centre_and_axis(pose)
                    _geometry.revolute_contacts(shape, *at, scratch, 0)
                    self.scenarios[i, k] = _geometry.contact_scenario(shape, *at, scratch, 0, 4)
                else:
                    self.scenarios[i, k, 0] = workspace.table[row, 0] < 0.0

    def motion(self) -> tuple[list[str], Array, Array, Array]:
        """Return names, angles, rates and accelerations of the joints that turn; angles with whole turns."""
        system = self.system
        nq, nv = system.model.nq, system.model.nv
        names, angles, rates, accelerations = [], [], [], []
        velocities = self.states[:, nq : nq + nv]
        for slot in system.mechanism.joints.values():
            block = system.clearance_blocks.get(slot.name, -1)
            if block >= 0 and system.program[block] == _joint.SPHERICAL:
                continue
            if block >= 0:
                angle, rate, acceleration = self._clearance_motion(block, slot.v.start, slot.kind == "planar")
            elif slot.kind in ("revolute", "continuous"):
                q = self.states[:, slot.q]
                angle = q[:, 0]
                if slot.kind == "continuous":
                    turned = self.states[:, nq + nv + system.turn_x[slot.name]]
                    pairs = zip(np.arctan2(q[:, 1], q[:, 0]), turned, strict=True)
                    angle = np.array([_joint.unwrapped(one, near) for one, near in pairs])
                rate = velocities[:, slot.v.start]
                acceleration = self.a[:, slot.v.start]
            else:
                continue
            names.append(slot.name)
            angles.append(angle)
            rates.append(rate)
            accelerations.append(acceleration)
        stacked = [
            np.array(values).reshape(len(names), self.n).T for values in (angles, rates, accelerations)
        ]
        return names, stacked[0], stacked[1], stacked[2]

    def _clearance_motion(self, block: int, start: int, planar: bool) -> tuple[Array, Array, Array]:
        program = self.system.program
        nq = self.system.model.nq
        axes = program[block + _joint.AXES : block + _joint.AXES + 9].reshape(3, 3)
        angle, rate, acceleration = np.zeros(self.n), np.zeros(self.n), np.zeros(self.n)
        for i, y in enumerate(self.states):
            angle[i], gx, gy = _joint.motion_angle(program, block, y, nq + self.system.model.nv)
            if planar:
                rate[i], acceleration[i] = y[nq + start + 2], self.a[i, start + 2]
                continue
            w = axes.T @ y[nq + start + 3 : nq + start + 6]
            alpha = axes.T @ self.a[i, start + 3 : start + 6]
            rate[i] = gx * w[0] + gy * w[1] + w[2]
            # The rate's own derivative; that of g is a product of tilt rates, taken exactly from its
            # definition.
            dg = _tilt_rate(program, block, y, w)
            acceleration[i] = gx * alpha[0] + gy * alpha[1] + alpha[2] + dg[0] * w[0] + dg[1] * w[1]
        return angle, rate, acceleration


def _tilt_rate(program: Array, block: int, y: Array, w: Array) -> tuple[float, float]:
    """Return the rates of gx and gy of the motion angle for the angular velocity w in journal axes [1/s]."""
    i = int(program[block + 3]) + 3
    axes = program[block + _joint.AXES : block + _joint.AXES + 9].reshape(3, 3)
    x, q, z = axes.T @ y[i : i + 3]
    s = y[i + 3]
    # Quaternion kinematics in body axes.
    ds = -0.5 * (x * w[0] + q * w[1] + z * w[2])
    dx = 0.5 * (s * w[0] + q * w[2] - z * w[1])
    dq = 0.5 * (s * w[1] + z * w[0] - x * w[2])
    dz = 0.5 * (s * w[2] + x * w[1] - q * w[0])
    square = z * z + s * s
    if square == 0.0:
        return 0.0, 0.0
    change = 2.0 * (z * dz + s * ds) / square
    gx, gy = (z * x - s * q) / square, (s * x + z * q) / square
    return (
        (dz * x + z * dx - ds * q - s * dq) / square - gx * change,
        (ds * x + s * dx + dz * q + z * dq) / square - gy * change,
    )


def dataset(run: Run, title: str, case: str, versions: dict[str, str]) -> xr.Dataset:
    """Return a finished run as a labelled dataset (docs/trajectory.md lists the variables)."""
    seen = _Observer(run)
    table = _Table()
    _add_state(table, seen)
    _add_contacts(table, seen)
    error = _add_ledger(table, seen)
    coords = _coordinates(seen)
    joints = seen.motion()
    coords["joint"] = ("joint", np.array(joints[0], dtype=object) if joints[0] else np.zeros(0, dtype="<U1"))
    for values, name, units, meaning in zip(
        joints[1:],
        ("motion_angle", "motion_rate", "motion_acceleration"),
        ("rad", "rad/s", "rad/s^2"),
        ("rotation about the joint's axis", "its rate", "its acceleration"),
        strict=True,
    ):
        table.add(name, ("time", "joint"), values, units, meaning)
    _add_slides(table, coords, seen)
    _add_episodes(table, run)
    _add_events(table, coords, run)
    attributes = {
        "title": title,
        "case": case,
        "versions": json.dumps(versions),
        "gap_difference": run.gap_difference,
        "conservation": json.dumps(_conservation(seen, error)),
        **mechanism_attributes(run.system),
    }
    return xr.Dataset(table.variables, coords=coords, attrs=attributes)


def _add_slides(table: _Table, coords: dict[str, Any], seen: _Observer) -> None:
    """Add the motion of joints that slide, if there are any."""
    system = seen.system
    slots = [slot for slot in system.mechanism.joints.values() if slot.kind == "prismatic"]
    if not slots:
        return
    coords["sliding_joint"] = ("sliding_joint", np.array([slot.name for slot in slots], dtype=object))
    along_q, along_v = [slot.q.start for slot in slots], np.array([slot.v.start for slot in slots])
    dims = ("time", "sliding_joint")
    table.add("slide_position", dims, seen.states[:, along_q], "m", "way along the joint's axis")
    table.add("slide_rate", dims, seen.states[:, system.model.nq + along_v], "m/s", "its rate")
    table.add("slide_acceleration", dims, seen.a[:, along_v], "m/s^2", "its acceleration")


def _coordinates(seen: _Observer) -> dict[str, Any]:
    system = seen.system
    configuration, velocity = _coordinate_names(system)
    coords: dict[str, Any] = {
        "time": ("time", seen.times, {"units": "s", "long_name": "time"}),
        "axis": ("axis", np.array(_AXES, dtype=object)),
        "configuration": ("configuration", np.array(configuration, dtype=object)),
        "coordinate": ("coordinate", np.array(velocity, dtype=object)),
    }
    if system.mechanism.base == "free" or system.clearances:
        coords["quaternion"] = ("quaternion", np.array(["x", "y", "z", "w"], dtype=object))
    for dim, names in (
        ("contact", system.contact_names),
        ("clearance_joint", [joint.name for joint in system.clearances]),
        ("drive", list(system.drives)),
        ("spring", list(system.springs)),
    ):
        if names:
            coords[dim] = (dim, np.array(names, dtype=object))
    return coords


def _add_state(table: _Table, seen: _Observer) -> None:
    system = seen.system
    nq, nv = system.model.nq, system.model.nv
    q, v = seen.states[:, :nq], seen.states[:, nq : nq + nv]
    table.add("q", ("time", "configuration"), q, "m, rad or 1", "configuration, Pinocchio's order")
    table.add("v", ("time", "coordinate"), v, "m/s or rad/s", "generalized velocity, body axes")
    table.add("a", ("time", "coordinate"), seen.a, "m/s^2 or rad/s^2", "generalized acceleration, body axes")
    if system.mechanism.base == "free":
        table.add("base_position", ("time", "axis"), q[:, :3], "m", "base in the world")
        table.add("base_attitude", ("time", "quaternion"), q[:, 3:7], "1", "base in the world, quaternion")
        table.add("base_velocity", ("time", "axis"), v[:, :3], "m/s", "base, in its own axes")
        table.add("base_angular_velocity", ("time", "axis"), v[:, 3:6], "rad/s", "base, in its own axes")
    if system.drives:
        table.add(
            "drive_torque",
            ("time", "drive"),
            seen.efforts,
            "N m",
            "torque of the drive (a force [N] if it slides)",
        )


def _add_contacts(table: _Table, seen: _Observer) -> None:
    system = seen.system
    if not system.contact_names:
        return
    rows = seen.tables
    gaps = rows[:, :, 0]
    per_contact = ("time", "contact")
    touching = np.array(seen.run.samples.memories)[:, :, _joint.TOUCHING].astype(np.int8)
    normal = np.maximum(rows[:, :, _joint.FORCE], 0.0)
    friction = rows[:, :, _joint.FRICTION : _joint.FRICTION + 3]
    table.add("gap", per_contact, gaps, "m", "distance of the surfaces, negative in contact")
    table.add("depth", per_contact, np.maximum(-gaps, 0.0), "m", "penetration depth")
    table.add(
        "depth_rate", per_contact, rows[:, :, _joint.RATE], "m/s", "rate of penetration, positive closing"
    )
    slip = np.linalg.norm(rows[:, :, _joint.SLIP : _joint.SLIP + 3], axis=2)
    table.add("slip_speed", per_contact, slip, "m/s", "tangential speed of the journal over the bearing")
    table.add("normal_force", per_contact, normal, "N", "normal force on the journal")
    table.add("friction_force", per_contact, np.linalg.norm(friction, axis=2), "N", "friction on the journal")
    forces = normal[:, :, None] * rows[:, :, 1:4] + friction
    vector = (*per_contact, "axis")
    table.add("contact_force", vector, forces, "N", "force on the journal, bearing axes")
    table.add("contact_point", vector, rows[:, :, 4:7], "m", "candidate contact, from the bearing's centre")
    table.add("touching", per_contact, touching, "1", "whether the contact touches")
    joint = ("time", "clearance_joint")
    table.add(
        "journal_position", (*joint, "axis"), seen.poses[:, :, :3], "m", "journal's centre in the bearing"
    )
    table.add(
        "journal_attitude",
        (*joint, "quaternion"),
        _attitudes(system, seen.poses),
        "1",
        "journal in the bearing, quaternion",
    )
    tilt = np.arctan2(np.hypot(seen.poses[:, :, 3], seen.poses[:, :, 4]), seen.poses[:, :, 5])
    table.add("journal_tilt", joint, tilt, "rad", "angle between the axes of journal and bearing")
    table.add("joint_force", (*joint, "axis"), seen.wrenches[:, :, :3], "N", "contact force on the journal")
    table.add(
        "joint_torque",
        (*joint, "axis"),
        seen.wrenches[:, :, 3:],
        "N m",
        "contact torque about the journal's centre",
    )
    for k, (name, kinds) in enumerate(
        (("radial_scenario", RadialScenario), ("axial_scenario", AxialScenario))
    ):
        table.add(
            name,
            joint,
            seen.scenarios[:, :, k],
            "1",
            f"contact scenario, {name.split('_')[0]}",
            flag_values=np.array([kind.value for kind in kinds], dtype=np.int8),
            flag_meanings=" ".join(kind.name.lower() for kind in kinds),
        )


def _attitudes(system: System, poses: Array) -> Array:
    """Return the attitudes of the journals' frames in their bearings', (n, joints, 4)."""
    samples = poses.shape[0]
    result = np.zeros((samples, len(system.clearances), 4))
    for k, joint in enumerate(system.clearances):
        of_child = poses[:, k, 6:15].reshape(samples, 3, 3)
        axes = np.eye(3) if joint.planar else frame_aligning_z(system.mechanism.joint(joint.name).axis)
        result[:, k] = quaternions(of_child @ axes)
    return result


def _add_ledger(table: _Table, seen: _Observer) -> Array:
    """Add energies, works, losses and momenta; return the error of the energy balance [J]."""
    system = seen.system
    x = seen.states[:, system.model.nq + system.model.nv :]
    since = x - x[0]  # a run that goes on from another has its own ledger
    for k, (name, meaning) in enumerate(
        (
            ("kinetic_energy", "kinetic energy"),
            ("contact_energy", "energy stored in contacts"),
            ("spring_energy", "energy stored in joint springs"),
            ("gravity_energy", "potential energy of gravity"),
        )
    ):
        table.add(name, ("time",), seen.energies[:, k], "J", meaning)
    stored = seen.energies.sum(axis=1)
    error = stored - stored[0]
    for happening in seen.run.happened:
        error[seen.times >= happening.time] -= happening.energy
    if system.drives:
        work = since[:, system.work_x]
        error -= work.sum(axis=1)
        table.add("drive_work", ("time", "drive"), work, "J", "work of the drive since the start")
        table.add(
            "drive_gross_work",
            ("time", "drive"),
            since[:, system.gross_work_x],
            "J",
            "integral of |power| of the drive",
        )
    if system.contact_names:
        for name, index, meaning in (
            ("dissipation_normal", system.lost_normal_x, "energy lost to normal contact"),
            ("dissipation_friction", system.lost_friction_x, "energy lost to friction"),
        ):
            table.add(name, ("time", "contact"), since[:, index], "J", meaning)
            error += since[:, index].sum(axis=1)
        table.add(
            "normal_impulse",
            ("time", "contact"),
            since[:, system.impulse_x],
            "N s",
            "integral of normal force",
        )
    if system.springs:
        table.add(
            "dissipation_damper",
            ("time", "spring"),
            since[:, system.damper_x],
            "J",
            "energy lost in the damper",
        )
        error += since[:, system.damper_x].sum(axis=1)
    table.add("energy_error", ("time",), error, "J", "stored - start - work of drives + losses")
    table.add("linear_momentum", ("time", "axis"), seen.linear, "kg m/s", "of the whole, world axes")
    table.add(
        "angular_momentum",
        ("time", "axis"),
        seen.angular,
        "kg m^2/s",
        "of the whole about its mass centre, world axes",
    )
    table.add(
        "momentum_scale",
        ("time",),
        seen.momentum_scales[:, 0],
        "kg m/s",
        "summed magnitudes, bodies without the base",
    )
    table.add(
        "angular_momentum_scale",
        ("time",),
        seen.momentum_scales[:, 1],
        "kg m^2/s",
        "summed magnitudes about the mass centre, bodies without the base",
    )
    return np.asarray(error)


def _add_episodes(table: _Table, run: Run) -> None:
    if not run.system.contact_names:
        return
    episodes = run.episodes
    for name, values, units, meaning in (
        ("onset_time", [e.onset for e in episodes], "s", "start of the contact"),
        ("release_time", [e.release for e in episodes], "s", "end of the contact; NaN: still touching"),
        ("approach_speed", [e.approach_speed for e in episodes], "m/s", "depth rate at onset, floored"),
        ("peak_force", [e.peak_force for e in episodes], "N", "largest normal force, of the dense output"),
        ("peak_time", [e.peak_time for e in episodes], "s", "when the force was largest"),
        ("peak_depth", [e.peak_depth for e in episodes], "m", "largest depth, of the dense output"),
        ("impulse", [e.impulse for e in episodes], "N s", "integral of the normal force"),
        ("dissipated", [e.dissipated for e in episodes], "J", "energy lost, normal and friction"),
        (
            "effective_mass",
            [e.effective_mass for e in episodes],
            "kg",
            "(n^T M^-1 n)^-1 at onset, along the normal",
        ),
    ):
        table.add(name, ("episode",), np.array(values, dtype=float), units, meaning)
    index = np.array([e.contact for e in episodes], dtype=np.int64)
    table.add("episode_contact", ("episode",), index, "1", "index of the contact")


def _add_events(table: _Table, coords: dict[str, Any], run: Run) -> None:
    """Add what happened of the user's events, if any were looked for."""
    if not run.events:
        return
    happened = run.happened
    names = np.array([one.name for one in happened], dtype=object if happened else "<U1")
    coords["event"] = ("event", names, {"long_name": "events that happened, by name"})
    table.add("event_time", ("event",), np.array([h.time for h in happened]), "s", "when the event happened")
    energies = np.array([h.energy for h in happened])
    table.add("event_energy", ("event",), energies, "J", "energy that the event's action brought in")


def _conservation(seen: _Observer, error: Array) -> dict[str, Any]:
    """Return how well what must be kept was kept, relative to scales that do not pass through zero."""
    system = seen.system
    result: dict[str, Any] = {"energy_error": float(np.abs(error).max())}
    works = seen.states[:, system.model.nq + system.model.nv + system.gross_work_x]
    gross = float((works[-1] - works[0]).sum())
    result["gross_work"] = gross
    result["energy_error_relative"] = result["energy_error"] / gross if gross > 0.0 else None
    conserved = system.mechanism.base == "free" and not np.any(system.model.gravity.linear)
    for k, (name, values) in enumerate((("linear", seen.linear), ("angular", seen.angular))):
        scale = float(seen.momentum_scales[:, k].max())
        drift = float(np.abs(values - values[0]).max())
        result[f"{name}_momentum_drift"] = drift if conserved else None
        result[f"{name}_momentum_scale"] = scale
        result[f"{name}_momentum_drift_relative"] = drift / scale if conserved and scale > 0.0 else None
    if not math.isfinite(result["energy_error"]):
        result["energy_error_relative"] = None
    return result
