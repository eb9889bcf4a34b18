"""Initial state of a scenario."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.dynamics import BASE, System, assemble, put_followers
from antenna_pin.elements import Motion
from antenna_pin.errors import MechanismError, ScenarioError
from antenna_pin.mechanism import JointSlot, Mechanism, frame_aligning_z
from antenna_pin.scenario import InitialBaseSpec, Scenario
from antenna_pin.scenario.assemble.places import check_known, check_motion, slides, where

Array = NDArray[np.float64]


@takes()
def initial_state(scenario: Scenario, system: System) -> tuple[Array, Array]:
    """Return the initial configuration and velocity of a scenario, (nq,) and (nv,).

    Where loops are closed or motions prescribed it is assembled
    (:func:`antenna_pin.dynamics.assembled`): what the scenario gives of a joint is held, unless it is a
    guess, all else is found.

    Raises:
        AntennaPinError: What is given cannot be.
    """
    q, v = guess_of(scenario, system)
    if system.plan is None:
        return q, v
    held_q, held_v = set(), set()
    if scenario.initial.base != InitialBaseSpec():
        held_q.add(BASE)
        held_v.add(BASE)
    for name, spec in scenario.initial.joints.items():
        if not spec.guess:
            if (spec.position, spec.angle) != (None, None):
                held_q.add(name)
            if (spec.velocity, spec.rate) != (None, None):
                held_v.add(name)
    y = system.state(q, v, initial_angles(scenario, system))
    try:
        assemble(system, y, held_q, held_v)
    except MechanismError as error:
        raise MechanismError(f"{scenario.name or 'scenario'}: {error}") from None
    nq = system.model.nq
    return y[:nq], y[nq : nq + system.model.nv]


@takes()
def initial_angles(scenario: Scenario, system: System) -> dict[str, float]:
    """Return the initial angles of continuous joints, with their whole turns [rad]."""
    known = _known_places(scenario, system)
    # What couplings tell of is found with the state.
    coupled = {name for one in system.couplings.values() for name in (one.follower, *one.leaders)}
    return {name: known.get(name, 0.0) for name in system.turn_x if name in known or name not in coupled}


def _known_places(scenario: Scenario, system: System) -> dict[str, float]:
    """Return the positions that the scenario gives of joints, or prescribes [rad] or [m]."""
    known = {
        name: _angle(spec)
        for name, spec in scenario.initial.joints.items()
        if (spec.position, spec.angle) != (None, None)
    }
    for drive in system.drives.values():
        if isinstance(drive, Motion):
            known[drive.joint] = drive.at(0.0)[0]
    return known


def _angle(spec: Any) -> float:
    """Return the angle [rad] or position [m] of a joint's initial state."""
    given = spec.angle if spec.angle is not None else spec.position
    return float(given or 0.0)


def guess_of(scenario: Scenario, system: System) -> tuple[Array, Array]:
    """Return the first guess of pose, (nq,), and velocity, (nv,); followers where led, loops open."""
    q, v = given_state(scenario, system.mechanism)
    put_followers(system.mechanism, system.couplings.values(), q, _known_places(scenario, system))
    return q, v


def given_state(scenario: Scenario, mechanism: Mechanism) -> tuple[Array, Array]:
    """Return the URDF's pose, (nq,), with what the scenario gives, and its velocity, (nv,)."""
    q, v = pin.neutral(mechanism.model), np.zeros(mechanism.model.nv)
    initial = scenario.initial
    if mechanism.base == "free":
        base = initial.base
        attitude = np.asarray(base.attitude, dtype=float)
        q[:3], q[3:7] = base.position, attitude / np.linalg.norm(attitude)
        v[:3], v[3:6] = base.velocity, base.angular_velocity
    check_known(scenario, initial.joints, "moving joint", mechanism.joints, "initial.joints")
    for name, spec in initial.joints.items():
        slot = mechanism.joint(name)
        check_motion(scenario, slot, spec.motion, "initial", "joints", name)
        if slot.kind in ("floating", "planar"):
            _place_journal(scenario, mechanism, slot, spec, q, v)
            if _bearing_on_child(scenario, slot):
                _invert(slot, q, v)
            continue
        for key in ("journal_position", "journal_tilt", "journal_velocity", "journal_angular_velocity"):
            vector = getattr(spec, key)
            if vector is not None and any(vector):
                raise ScenarioError(
                    f"{where(scenario, 'initial.joints', name, key)}: must be zero or left out at a joint "
                    f"without play, got {vector}"
                )
        angle = _angle(spec)
        rate = spec.velocity if spec.velocity is not None else spec.rate or 0.0
        q[slot.q] = (np.cos(angle), np.sin(angle)) if slot.kind == "continuous" else angle
        v[slot.v] = rate
    return q, v


def _place_journal(
    scenario: Scenario, mechanism: Mechanism, slot: JointSlot, spec: Any, q: Array, v: Array
) -> None:
    """Write a journal's pose and twist, given in bearing axes, into q and v.

    Angle, position and rate are the joint's; with the bearing on the child the journal's are the opposite.
    """
    _refuse_twice(scenario, slot, spec)
    angle = _angle(spec)
    rate = spec.rate if spec.rate is not None else spec.velocity or 0.0
    if _bearing_on_child(scenario, slot):
        angle, rate = -angle, -rate
    along, about = (angle, rate), (0.0, 0.0)
    if not slides(scenario, slot):
        along, about = about, along
    position = np.array(spec.journal_position or (0.0, 0.0, 0.0)) + [0.0, 0.0, along[0]]
    tilt = np.array(spec.journal_tilt or (0.0, 0.0, 0.0))
    velocity = np.array(spec.journal_velocity or (0.0, 0.0, 0.0)) + [0.0, 0.0, along[1]]
    spin = np.array(spec.journal_angular_velocity or (0.0, 0.0, 0.0)) + [0.0, 0.0, about[1]]
    if slot.kind == "planar":
        if position[2] or tilt.any() or velocity[2] or spin[:2].any():
            raise ScenarioError(
                f"{where(scenario, 'initial.joints', slot.name)}: a planar joint must stay in its plane; "
                "give no axial position or velocity, no tilt and no rate of tilt"
            )
        cosine, sine = np.cos(angle), np.sin(angle)
        q[slot.q] = (position[0], position[1], cosine, sine)
        v[slot.v] = (
            cosine * velocity[0] + sine * velocity[1],
            -sine * velocity[0] + cosine * velocity[1],
            spin[2],
        )
        return
    axes = frame_aligning_z(slot.axis)
    offset = scenario.clearance[slot.name].offset if slot.name in scenario.clearance else 0.0
    centre = offset * slot.axis
    turn = axes @ pin.exp3(tilt) @ pin.exp3(np.array([0.0, 0.0, about[0]])) @ axes.T
    omega = turn.T @ axes @ spin
    q[slot.q] = [*(axes @ position + centre - turn @ centre), *pin.Quaternion(turn).coeffs()]
    v[slot.v] = [*(turn.T @ axes @ velocity - np.cross(omega, centre)), *omega]


def _refuse_twice(scenario: Scenario, slot: JointSlot, spec: Any) -> None:
    """Refuse a joint's coordinate given twice: by the joint and by its journal."""
    place, speed = ("position", "velocity") if slides(scenario, slot) else ("tilt", "angular_velocity")
    for keys, journal in ((("angle", "position"), place), (("rate", "velocity"), speed)):
        key = next((key for key in keys if getattr(spec, key) is not None), None)
        vector = getattr(spec, f"journal_{journal}")
        if key is not None and vector is not None and vector[2] != 0.0:
            raise ScenarioError(
                f"{where(scenario, 'initial.joints', slot.name, key)}: must be left out with "
                f"journal_{journal}[2], which sets the same motion, got {getattr(spec, key):g} and "
                f"{vector[2]:g}; leave out {key}, or make journal_{journal}[2] zero"
            )


def _bearing_on_child(scenario: Scenario, slot: JointSlot) -> bool:
    play = scenario.clearance.get(slot.name)
    return play is not None and play.bearing_on == "child"


def _invert(slot: JointSlot, q: Array, v: Array) -> None:
    """Invert a joint's pose and twist: from parent in child to child in parent."""
    if slot.kind == "planar":
        x, y, cosine, sine = q[slot.q]
        turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        pose = pin.SE3(turn, np.array([x, y, 0.0]))
        vx, vy, wz = v[slot.v]
        twist = -pose.act(pin.Motion(np.array([vx, vy, 0.0, 0.0, 0.0, wz])))
        q[slot.q] = (*pose.inverse().translation[:2], cosine, -sine)
        v[slot.v] = (*twist.linear[:2], twist.angular[2])
        return
    pose = pin.XYZQUATToSE3(q[slot.q])
    v[slot.v] = -pose.act(pin.Motion(v[slot.v])).vector
    q[slot.q] = pin.SE3ToXYZQUAT(pose.inverse())
