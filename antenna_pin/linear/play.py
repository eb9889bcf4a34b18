"""The state that a system is linearised about, and what is taken of it: joints with play, joints held."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.brief import brief
from antenna_pin.base.records import CONTACT, memory_records
from antenna_pin.dynamics import BASE, System, Workspace, assemble, joints_held
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.linear.loaded import press
from antenna_pin.mechanism import JointSlot

__all__ = ["At", "Play", "prepared"]

Array = NDArray[np.float64]

Play = Literal["ideal", "free", "contact"]
"""What a joint with play is taken as: what it is ideally, free in its play, or as it touches in the state."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class At:
    """A state, and what of it is linearised.

    Attributes:
        system: The system.
        time: Of the state [s].
        y: The state [q, v, x].
        memory: Contact memory: what touches.
        play: What each joint with play is taken as, by name.
        loads: Forces on journals that press them into contact, in bearing axes, by joint, (3,) [N].
        hold: Names of joints that do not move; ``base`` is a free base.
        rest: Whether nothing moves, and what would set it moving is held in balance.
        adjusted: Numbers of drives and springs that events have changed: (place, value).
    """

    __repr__ = brief

    system: System
    time: float
    y: Array
    memory: NDArray[Any]
    play: Mapping[str, Play]
    loads: Mapping[str, Array]
    hold: tuple[str, ...] = ()
    rest: bool = True
    adjusted: tuple[tuple[str, float], ...] = ()

    @property
    def v(self) -> Array:
        """Velocity, (nv,)."""
        nq = self.system.model.nq
        return self.y[nq : nq + self.system.model.nv]

    @property
    def q(self) -> Array:
        """Configuration, (nq,)."""
        return self.y[: self.system.model.nq]

    def allowed(self) -> Array:
        """Return the directions of what is not held, constraints aside, orthonormal, (nv, k)."""
        nv = self.system.model.nv
        parts = [] if BASE in self.hold else [np.eye(nv)[:, self.system.mechanism.base_v]]
        joints = {joint.name: joint for joint in self.system.clearances}
        held = joints_held(self.system, self.adjusted)
        for name, slot in self.system.mechanism.joints.items():
            if name in self.hold or name in held:
                continue
            own = np.eye(nv)[:, slot.v]
            if self.play.get(name) == "ideal":
                own = own @ ideal_directions(slot, joints[name], self.q)
            parts.append(own)
        return np.hstack(parts) if parts else np.zeros((nv, 0))


def ideal_directions(slot: JointSlot, joint: ClearanceJoint, q: Array) -> Array:
    """Return how a joint with play would move as an ideal one, where its journal is, (nv of it, k).

    The child turns about its own axis, slides along it, or turns about its ball's centre: with the velocity
    of these directions it stays on the ideal joint's way however far it goes.
    """
    motion = joint.geometry.motion
    if joint.planar:
        return np.eye(3)[:, 2:]
    if motion is None:
        return np.eye(6)[:, 3:]
    found = np.zeros((6, 1))
    if motion == "turn":
        found[3:, 0] = slot.axis
    else:
        found[:3, 0] = slot.axis
    return found


@takes()
def prepared(
    system: System,
    y: Array,
    *,
    time: float = 0.0,
    memory: ArrayLike | None = None,
    play: Play | Mapping[str, Play] | None = None,
    load: ArrayLike | Mapping[str, ArrayLike] | None = None,
    approach_speed: float | None = None,
    hold: Sequence[str] = (),
    moving: bool = False,
    adjusted: tuple[tuple[str, float], ...] = (),
) -> At:
    """Return a state with what is taken of it, checked; journals that have a load are pressed into contact.

    Args:
        system: The system.
        y: The state [q, v, x].
        time: Of the state [s].
        memory: Contact memory, (contacts, 3); contacts with a gap of zero or less touch if not given.
        play: What joints with play are taken as, one for all or by name; those that are not named are ideal,
            but in contact if they have a load.
        load: Force on the journal in bearing axes, (3,) [N]; by joint if there are several with play.
        approach_speed: That contacts under a load remember [m/s]; their joint's floor if not given.
        hold: Names of joints that do not move; ``base`` is a free base.
        moving: Whether velocities and accelerations of the state count.
        adjusted: Numbers of drives and springs that events have changed.

    Raises:
        AntennaPinError: A name that there is not, a load that presses nothing, a contact that touches not.
    """
    y = y.copy()
    names = [joint.name for joint in system.clearances]
    loads = _loads(names, load)
    taken = _taken(names, play, loads)
    _check_hold(system, hold)
    nq, nv = system.model.nq, system.model.nv
    if not moving:
        y[nq : nq + nv] = 0.0
    workspace = Workspace(system)
    records = workspace.first_memory(y) if memory is None else memory_records(memory).copy()
    for joint in system.clearances:
        rows = _rows_of(system, joint)
        if joint.name in loads:
            press(system, joint, y, loads[joint.name], approach_speed, records)
        elif taken[joint.name] != "contact":
            records["touching"][rows] = 0.0
        else:
            _check_touching(system, joint, y, records, rows)
    if loads and system.plan is not None:
        # Journals that have moved open loops that were closed.
        try:
            assemble(system, y, list(loads), list(loads))
        except MechanismError as error:
            raise MechanismError(f"modes: the journals under their loads: {error}") from None
        if not moving:
            y[nq : nq + nv] = 0.0
    return At(
        system=system,
        time=time,
        y=y,
        memory=records,
        play=taken,
        loads=loads,
        hold=tuple(hold),
        rest=not moving,
        adjusted=adjusted,
    )


def _loads(names: Sequence[str], load: ArrayLike | Mapping[str, ArrayLike] | None) -> dict[str, Array]:
    if load is None:
        return {}
    if not isinstance(load, Mapping):
        if len(names) != 1:
            known = ", ".join(names) or "none"
            raise InvalidParameterError(
                "modes", "load", f"given by joint, {{name: (x, y, z)}}; with play: {known}", load
            )
        load = {names[0]: load}
    found = {}
    for name, given in load.items():
        if name not in names:
            raise UnknownNameError("modes: load", "joint with play", name, names)
        force = np.array(given, dtype=float)
        if force.shape != (3,) or not np.isfinite(force).all() or not force.any():
            raise InvalidParameterError(
                "modes", f"load of {name}", "three finite numbers [N], not all 0", np.asarray(given).tolist()
            )
        found[name] = force
    return found


def _taken(
    names: Sequence[str], play: Play | Mapping[str, Play] | None, loads: Mapping[str, Array]
) -> dict[str, Play]:
    given: dict[str, Play] = {}
    if isinstance(play, Mapping):
        given = dict(play)
    elif play is not None:
        given = dict.fromkeys(names, play)
    for name, kind in given.items():
        if name not in names:
            raise UnknownNameError("modes: play", "joint with play", name, names)
        if kind not in get_args(Play):
            raise InvalidParameterError("modes", f"play of {name}", "ideal, free or contact", kind)
        if kind != "contact" and name in loads:
            raise InvalidParameterError(
                "modes", f"play of {name}", "contact, or left out, as the joint has a load", kind
            )
    return {name: given.get(name, "contact" if name in loads else "ideal") for name in names}


def _check_hold(system: System, hold: Sequence[str]) -> None:
    known = [*system.mechanism.joints]
    if system.mechanism.base == "free":
        known.append(BASE)
    for name in hold:
        if name not in known:
            raise UnknownNameError("modes: hold", "joint", name, known)


def _rows_of(system: System, joint: ClearanceJoint) -> list[int]:
    block = system.clearance_blocks[joint.name]
    return [row for row, of in enumerate(system.block_of_contact) if of == block]


def _check_touching(
    system: System, joint: ClearanceJoint, y: Array, memory: NDArray[Any], rows: Sequence[int]
) -> None:
    table = np.zeros(system.rows, CONTACT)
    Workspace(system).locate(y, table)
    if not any(memory["touching"][row] and table["gap"][row] < 0.0 for row in rows):
        raise MechanismError(
            f"modes: joint {joint.name!r}: must touch somewhere to be taken in contact, got a journal in "
            "free flight; give a load that presses it, a state in which it touches, or take it as ideal or "
            "free"
        )
