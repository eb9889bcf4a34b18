"""Initial states of closed loops: assembled, and looked at for what cannot be."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number
from antenna_pin.dynamics.constraints import (
    OPPOSITE,
    Unclosed,
    directions,
    find_configuration,
    find_velocity,
    mobility,
    worst_row,
)
from antenna_pin.dynamics.coordinates import reach_of
from antenna_pin.dynamics.coupled import put_follower_rates
from antenna_pin.dynamics.system import System
from antenna_pin.dynamics.workspace import Workspace
from antenna_pin.elements import Motion, PrescribedMotion, Shake
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import JointSlot

# --- start of a mechanism on a shaken base ---


def start_with_base(system: System, y: NDArray[np.float64]) -> None:
    """Place the joints of a shaken base at the start of their motions, in place.

    All other positions and rates are relative to the base.
    """
    for drive in system.drives.values():
        if isinstance(drive, Shake):
            slot = system.mechanism.joint(drive.joint)
            y[slot.q], y[system.model.nq + slot.v.start], _ = drive.at(0.0)


# --- open loops: residuals, and motions that loops cannot follow ---

# Residual rate of open loops that is round-off, relative to a motion's rate.
_ROUND_OFF = 1e-12


def said_of_open(system: System, residuals: Any, length: float) -> str:
    """Return a description of open loops at the start, and a remedy."""
    speed = max(residuals.speed / length, residuals.spin)
    rates = {
        name: abs(drive.profile()(0.0)[1])
        for name, drive in system.drives.items()
        if isinstance(drive, Motion)
    }
    fastest = max(rates, key=rates.__getitem__, default="")
    if fastest and max(residuals.gap / length, residuals.turn) <= speed <= _ROUND_OFF * rates[fastest]:
        joint = system.drives[fastest].joint
        unit = "m/s" if system.slides(joint) else "rad/s"
        return (
            f"motion {fastest!r} is too fast: it moves joint {joint!r} by {number(rates[fastest])} "
            f"{unit} at t = 0, and its loops cannot be closed better than to the round-off of that, "
            f"{number(residuals.speed)} m/s, {number(residuals.spin)} rad/s; make it slower"
        )
    return (
        f"its loops are open: {number(residuals.gap)} m, {number(residuals.turn)} rad, "
        f"{number(residuals.speed)} m/s, {number(residuals.spin)} rad/s; close it by "
        "antenna_pin.dynamics.assembled"
    )


# --- motions before a run: limits of their joints, and jumps ---

# Times at which a motion is compared with its joint's limits.
_LOOKS = 1001


def check_limits(system: System, name: str, motion: Motion, begin: float, end: float) -> None:
    """Refuse a motion beyond its joint's URDF limits within a time span [s]."""
    limit = system.mechanism.urdf.joint(motion.joint).limit
    kind = system.mechanism.joint(motion.joint).kind
    if limit is None or limit.lower is None or limit.upper is None or kind == "continuous":
        return
    unit = "m" if kind == "prismatic" else "rad"
    profile = motion.profile()
    for t in np.linspace(begin, end, _LOOKS):
        position = profile(float(t))[0]
        if not limit.lower <= position <= limit.upper:
            raise MechanismError(
                f"motion {name!r}: joint {motion.joint!r} must stay from {number(limit.lower)} to "
                f"{number(limit.upper)} {unit} by its <limit>, got {number(position)} {unit} at t = "
                f"{number(float(t))} s; change the motion, or the limit in the URDF or by "
                f"mechanism.joints.{motion.joint}"
            )


def check_jumps(system: System, name: str, motion: Motion, begin: float, end: float) -> None:
    """Refuse a motion along a discontinuous reference within a run [s]."""
    if not isinstance(motion, PrescribedMotion):
        return
    unit = "m" if system.slides(motion.joint) else "rad"
    for one in motion.jumps:
        if one.again:
            size = f"{number(one.rate)} {unit}/s" if one.rate else f"{number(one.value)} {unit}"
            raise MechanismError(
                f"motion {name!r}: its reference must be without jumps that come again for ever, got one of "
                f"{size} every {number(one.again)} s; join the table's points by interpolation = 'smooth', "
                "or write them down without periodic"
            )
        if not begin < one.time <= end or not (one.value or motion.rate_jumps == "refused"):
            continue
        what, size, way = (
            ("position", f"{number(one.value)} {unit}", "use a pd drive instead")
            if one.value
            else ("rate", f"{number(one.rate)} {unit}/s", "take rate_jumps = 'impulse'")
        )
        raise MechanismError(
            f"motion {name!r}: the {what} of its reference must not jump within the run, got {size} at t = "
            f"{number(one.time)} s; {way}, or a reference that is smooth there"
        )


Array = NDArray[np.float64]

#: Name of a free base among held joints.
BASE = "base"

# Distance from a start of the states in which the rank is examined, by largest component [rad or m].
_BESIDE = 1e-3
# Residual up to which a state given in Python counts as closed: it may have been written with few digits.
_GIVEN = 1e-6
# Angle between axes that counts as rounding of digits [rad].
_INEXACT = 1e-3
# Largest number of steps of a motion's course.
_FOLLOWED = 5000


@takes()
def assembled(
    system: System,
    q: ArrayLike,
    v: ArrayLike | None = None,
    *,
    held: Collection[str] = (),
    angles: Mapping[str, float] | None = None,
) -> tuple[Array, Array]:
    """Return a nearby configuration and velocity that close loops and follow motions.

    Journals keep their pose and velocity in their bearings, except for the freedoms of their joints. A free
    base stays if no closure holds it to the world, and keeps its velocity if possible. Velocities of joints
    that no equation connects to a held or prescribed rate stay; followers follow their leaders; in loops the
    velocity is the nearest in kinetic energy.

    Args:
        system: The system.
        q: First guess, (nq,).
        v: Likewise, (nv,); zero if not given.
        held: Names of joints whose position and velocity stay; ``base`` is that of a free base.
        angles: As for :meth:`System.state`.

    Returns:
        Configuration (nq,) and velocity (nv,), with residuals below 1e-12.

    Raises:
        MechanismError: There is none; the message names the violated constraint.
    """
    y = system.state(q, np.zeros(system.model.nv) if v is None else v, angles)
    for name in held:
        if name != BASE:
            system.mechanism.joint(name)
    assemble(system, y, held, held)
    nq = system.model.nq
    return y[:nq], y[nq : nq + system.model.nv]


def assemble(system: System, y: Array, held_q: Collection[str], held_v: Collection[str]) -> None:
    """Apply :func:`assembled` to a state [q, v, x], in place.

    Args:
        system: The system.
        y: The state.
        held_q: Names of joints whose position stays.
        held_v: Names of joints whose velocity stays.
    """
    if system.plan is None or system.plan.count == 0:  # elements hold their joints at their present positions
        return
    workspace = Workspace(system)
    constraints = workspace.constraints
    assert constraints is not None
    for drive in system.drives.values():
        if isinstance(drive, Motion) and drive.joint in system.turn_x:  # whole turns are those of the motion
            y[system.model.nq + system.model.nv + system.turn_x[drive.joint]] = drive.at(0.0)[0]
    start_with_base(system, y)
    workspace.prepare_motions(0.0, y)
    program = workspace.program
    free = _free(system, y, held_q)
    reach = reach_of(system.mechanism, constraints.plan.length)
    unclosed = find_configuration(constraints, y, program, free, workspace.retract, reach)
    if unclosed is not None:
        raise MechanismError(_not_closed(system, unclosed, held_q))
    system.turn_on(y)
    system.check_pose(y[: system.model.nq], "initial pose")
    _write_follower_rates(system, y, held_v)
    trial = y.copy()
    unclosed = find_velocity(constraints, trial, program, _free(system, y, {*held_v, BASE}))
    if unclosed is not None:  # a free base moves only if necessary
        trial = y.copy()
        unclosed = find_velocity(constraints, trial, program, _free(system, y, held_v))
    y[:] = trial
    if unclosed is not None:
        unit = "rad/s" if unclosed.turns else "m/s"
        raise MechanismError(
            f"initial velocities: contradict {unclosed.row}, which lacks {number(unclosed.residual)} {unit}; "
            f"{_let_go(held_v)}"
        )
    _check_singular(system, workspace, y)


def _write_follower_rates(system: System, y: Array, held_joints: Collection[str]) -> None:
    """Write the rates of followers of prescribed leaders, and of leaders of prescribed followers."""
    nq, nv = system.model.nq, system.model.nv
    slots = system.mechanism.joints
    v = y[nq : nq + nv]
    known = {
        name: float(v[slot.v][0]) for name, slot in slots.items() if name in held_joints or v[slot.v].any()
    }
    known |= {one.joint: one.at(0.0)[1] for one in system.drives.values() if isinstance(one, Motion)}
    put_follower_rates(system.mechanism, system.couplings.values(), v, known)


def _let_go(held_joints: Collection[str]) -> str:
    if not held_joints:
        return "check the closures' points and axes"
    return f"let joints be found (guess = true) of those held: {', '.join(sorted(held_joints))}"


def _not_closed(system: System, unclosed: Unclosed, held_joints: Collection[str]) -> str:
    unit = "rad" if unclosed.turns else "m"
    exact = ""
    if unclosed.turns and unclosed.residual < _INEXACT:
        exact = " (angles must be exact: 1.5707963267948966, not 1.5708)"
    if unclosed.turns and unclosed.residual > OPPOSITE:
        exact = "; its axes point opposite ways: turn one of them"
    return (
        f"initial state: the loops cannot be closed: {unclosed.row} lacks {number(unclosed.residual)} {unit} "
        f"at best; {_let_go(held_joints)}, or check the dimensions{exact}"
    )


def _free(system: System, y: Array, held_joints: Collection[str]) -> Array:
    """Return the generalized directions in which an initial state may be changed, (nv, k)."""
    nv = system.model.nv
    play = {joint.name: joint for joint in system.clearances}
    columns: list[Array] = []
    if system.mechanism.base == "free" and system.closed_to_world and BASE not in held_joints:
        columns.append(np.eye(nv)[:, :6])
    for name, slot in system.mechanism.joints.items():
        if name in held_joints:
            continue
        own = np.eye(nv)[:, slot.v]
        if name not in play:
            columns.append(own)
            continue
        columns.append(own @ _free_of_play(slot, play[name].geometry.motion, y))
    return np.hstack(columns) if columns else np.zeros((nv, 0))


def _free_of_play(slot: JointSlot, motion: str | None, y: Array) -> Array:
    """Return the free directions of a joint with play, (nv of it, k)."""
    if slot.kind == "planar":
        return np.eye(3)[:, 2:]
    if motion is None:  # a ball in a socket
        return np.eye(6)[:, 3:]
    free = np.zeros((6, 1))
    if motion == "turn":
        free[3:, 0] = slot.axis
    else:
        vector, real = y[slot.q][3:6], y[slot.q][6]
        # bearing's axis in the child's frame
        free[:3, 0] = slot.axis - 2.0 * np.cross(vector, real * slot.axis - np.cross(vector, slot.axis))
    return free


def check_closed(system: System, y: Array) -> None:
    """Refuse a state with open loops, and close small residuals of omitted digits.

    Args:
        system: The system.
        y: State [q, v, x], at time zero.
    """
    if system.plan is None:
        return
    workspace = Workspace(system)
    assert (constraints := workspace.constraints) is not None
    workspace.prepare_motions(0.0, y)
    found = constraints.residuals(0.0, y, workspace.program)
    length = constraints.plan.length
    open_by = max(found.gap / length, found.turn, found.speed / length, found.spin)
    if not open_by <= _GIVEN:
        raise MechanismError(f"initial state: {said_of_open(system, found, length)}")
    workspace.hold(0.0, y, workspace.program)


def check_motions(system: System, y: Array, begin: float, end: float) -> None:
    """Refuse motions that exceed joint limits, jump, or conflict with the loops.

    Conflicts are examined only if no other joint is free to move.

    Args:
        system: The system.
        y: State [q, v, x] at the time ``begin``, closed.
        begin: Start of the run [s].
        end: Its end [s].
    """
    for name, drive in system.drives.items():
        if isinstance(drive, Motion):
            check_limits(system, name, drive, begin, end)
            check_jumps(system, name, drive, begin, end)
    if system.motions and not system.clearances:
        workspace = Workspace(system)
        assert workspace.constraints is not None
        workspace.prepare_motions(begin, y)
        if mobility(workspace.constraints, begin, y, workspace.program).left == 0:
            _check_reach(system, workspace, y.copy(), begin, end)


def _check_reach(system: System, workspace: Workspace, y: Array, begin: float, end: float) -> None:
    """Follow the motions through the run, in steps that no joint turns far in."""
    constraints = workspace.constraints
    assert constraints is not None
    nq, nv = system.model.nq, system.model.nv
    t = begin
    for _ in range(_FOLLOWED):
        if t >= end:
            return
        fastest = float(np.abs(y[nq : nq + nv]).max())
        h = min(end - t, (end - begin) / 50.0, 0.1 / fastest if fastest > 0.0 else np.inf)
        while True:
            trial = y.copy()
            workspace.retract(trial, h * y[nq : nq + nv])
            workspace.prepare_motions(t + h, trial)
            if constraints.project(t + h, trial, workspace.program, workspace.retract):
                break
            h *= 0.5
            if h < 1e-9 * (end - begin):
                for one in system.motions:  # the function itself reports a missing value there
                    system.drives[one.name].at(t + 2.0 * h)  # type: ignore[attr-defined]
                raise MechanismError(
                    f"motions: out of reach from t = {number(t)} s on: {worst_row(constraints)} cannot be "
                    "closed there; change the motion or the dimensions"
                )
        y, t = trial, t + h
        system.turn_on(y)


def _check_singular(system: System, workspace: Workspace, y: Array) -> None:
    """Refuse overdetermined motions, and a start with a locally reduced rank."""
    constraints = workspace.constraints
    assert constraints is not None
    program = workspace.program
    reach = reach_of(system.mechanism, constraints.plan.length)
    held = "closures and couplings" if constraints.plan.couplings else "closures"
    here = mobility(constraints, 0.0, y, program)
    for motions in (True, False):
        ways = directions(constraints, y, program, motions=motions)
        if ways.shape[1] == 0:
            continue
        way = ways @ np.random.default_rng(4711).normal(size=ways.shape[1])
        trial = y.copy()
        workspace.retract(trial, way * (_BESIDE / float(np.abs(way).max())))
        if motions or not constraints.plan.motions:
            given = np.eye(len(way)), workspace.retract, reach
            if find_configuration(constraints, trial, program, *given) is not None:
                continue
        there = mobility(constraints, 0.0, trial, program)
        if there.closed_rank > here.closed_rank or there.rank > here.rank:
            raise MechanismError(
                f"initial state: a singular position: {here.rank} of {here.closed + here.driven} equations "
                f"of {held} and motions are independent here and {there.rank} beside it, so the motion of "
                f"the loops is not unique; start away from it"
            )
    if here.rank < here.closed_rank + here.driven:
        names = ", ".join(map(repr, constraints.plan.motions))
        places = held if constraints.plan.couplings else "closures' points and axes"
        raise MechanismError(
            f"motions {names}: the {held} leave {here.free} freedoms, and {here.driven} motions prescribe "
            f"{here.rank - here.closed_rank} of them independently; remove motions, or check the "
            f"{places}"
        )
