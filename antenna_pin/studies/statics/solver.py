"""Newton's method on the constraints for poses in balance, with friction that sticks or slips."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.readable import number
from antenna_pin.dynamics import JointMotion, kernels
from antenna_pin.dynamics.mode_kernels import grip_of
from antenna_pin.elements import Change, RigidStop, kind_of
from antenna_pin.elements.limits import FREE, LOWER, UPPER
from antenna_pin.errors import MechanismError
from antenna_pin.studies.statics.balance import Balance, Free

Array = NDArray[np.float64]

# Force out of balance over the largest force: sought, and accepted where round-off leaves no better.
_SOUGHT, _ACCEPTED = 1e-14, 1e-9
# Rounds of Newton steps and of steps along the forces between them; how many of each; and how many Newton
# steps may be cut to what is trusted.
_ROUNDS, _NEWTONS, _DRIFTS, _CUTS = 40, 40, 8, 6
# Steps nearly as long as is trusted after which a joint is taken to move on without end; and a displacement
# over what is trusted by a round of steps that leads nowhere.
_FAR, _LONG, _STILL = 48, 0.9, 1e-6
# Round-off of the stiffness, over the largest.
_EPS = 4.0 * float(np.finfo(float).eps)
# Share of the force out of balance that no step balances, above which the stiffness is singular.
_UNSOLVED = 1e-3
# Singular values of the stiffness below this, over the largest, are none.
_SINGULAR = 1e-12
# Rounds without a better balance after which round-off is reached, and of a balance below which one will do.
_PATIENCE, _ROUND_OFF = 6, 1e-11
# Residual over that before a step, below which the stiffness is used again.
_GAIN = 1e-2
# Round-off of a stop's position [rad] ([m]), and of a friction's load over its grip.
_AT_STOP, _SLACK = 1e-12, 1e-9
# Share of the largest force as which one counts that is less: its round-off is that of the largest.
_LEAST = 1e-2


class NotBalancedError(MechanismError):
    """No pose in balance was found."""


@dataclass(frozen=True, slots=True, eq=False)
class Rest:
    """A pose in balance.

    Attributes:
        y: The state [q, v, x], with v = 0.
        residual: Largest force out of balance over the largest force [-].
        free: Free directions in the pose.
        stiffness: Minus the derivative of forces along the free directions, (nv, k).
    """

    y: Array
    residual: float
    free: Free
    stiffness: Array


def balanced(balance: Balance, y: Array, where: str) -> Rest:
    """Return the pose in balance next to a state, with the set friction.

    Newton's method may pass larger residuals, as a journal that rolls along its bore requires. If it fails,
    as with a journal in flight, pseudo-transient continuation follows: steps along the forces, of the trusted
    length.

    Args:
        balance: The mechanism.
        y: State at which the search begins; loops are closed first.
        where: The pose, for the message.

    Raises:
        NotBalancedError: No pose is found.
    """
    first = here = _pose(balance, balance.projected(y.copy()))
    damping, far = 1.0, 0
    found = _newton(balance, here)
    for _ in range(_ROUNDS):
        if found is not None or far > _FAR:
            break
        start = here
        for _ in range(_DRIFTS):
            before = here
            here, damping = _drift(balance, here, damping)
            if here.residual <= _ACCEPTED:
                break
            far += _farthest(balance, before, here, coarse=True) > _LONG
        if _farthest(balance, start, here) < _STILL:
            break
        found = _newton(balance, here)
    if found is None:
        raise NotBalancedError(
            f"statics: {where}: forces must come into balance, got {_left(balance, first, here)}; start "
            "nearer to an equilibrium (initial.joints), take smaller steps, or hold a joint "
            "that nothing holds"
        )
    stiffness = balance.stiffness(found.y, found.free)
    balance.forces(found.y)
    return Rest(found.y, found.residual, found.free, stiffness)


class _Pose(NamedTuple):
    """A pose with its forces out of balance."""

    y: Array
    force: Array  # (nv,)
    free: Free
    residual: float  # over the largest force


def _pose(balance: Balance, y: Array) -> _Pose:
    force = balance.forces(y)
    size = balance.sizes(y)
    free = balance.free(y)
    return _Pose(y, force, free, _residual(balance, free, force, size))


def _left(balance: Balance, start: _Pose, here: _Pose) -> str:
    """Return the largest force out of balance, as text.

    That on joints at the start, or without any that on journals in their play where the search ended.
    """
    pushed = np.zeros(len(here.force))
    for pose, play in ((start, False), (here, True)):
        for k, way in enumerate(pose.free.directions.T):
            if balance.in_play(pose.free, k) == play:
                own = int(np.argmax(np.abs(way / balance.reach)))
                pushed[own] = max(pushed[own], abs(float(way @ pose.force / way[own])))
        if (pushed * balance.reach).max(initial=0.0) > balance.nothing * balance.length:
            break
    worst = int(np.argmax(pushed * balance.reach))
    name = balance.system.names_v[worst]
    joint, _, axis = name.rpartition(".")
    unit = ("N" if axis[0] == "v" else "N m") if joint in balance.system.mechanism.joints else ""
    unit = unit or ("N" if balance.system.slides(name) else "N m")
    return f"{number(float(pushed[worst]))} {unit} at {name} that nothing balances"


def _newton(balance: Balance, start: _Pose) -> _Pose | None:
    """Return the pose in balance by Newton's method, or None if it fails."""
    here = best = start
    patience, cut, renewed = _PATIENCE, 0, True
    for _ in range(_NEWTONS):
        if here.residual <= _SOUGHT:
            return here
        if renewed:  # where the last step gained much, the stiffness before it does once more
            free = here.free
            directions = free.directions
            reduced = directions.T @ balance.stiffness(here.y, free)
        right = directions.T @ here.force
        step: Array = np.linalg.lstsq(reduced, right, rcond=_SINGULAR)[0].astype(float)
        if np.linalg.norm(reduced @ step - right) > _UNSOLVED * np.linalg.norm(right):
            break
        longest = _longest(free, step)
        cut += longest > 1.0
        if cut > _CUTS:
            break
        moved = _moved(balance, here, step / max(1.0, longest), directions)
        if moved is None:
            break
        renewed = moved.residual > _GAIN * here.residual
        here = moved
        if here.residual < 0.5 * best.residual:
            best, patience = here, _PATIENCE
        else:
            best = here if here.residual < best.residual else best
            patience -= 1
            if best.residual <= _ROUND_OFF or (patience == 0 and best.residual <= _ACCEPTED):
                break
    return best if best.residual <= _ACCEPTED else None


def _drift(balance: Balance, here: _Pose, damping: float) -> tuple[_Pose, float]:
    """Return the pose after a step along the forces, and the damping of the next."""
    directions = here.free.directions
    reduced = directions.T @ balance.stiffness(here.y, here.free)
    right = directions.T @ here.force
    size = float(np.linalg.norm(right))
    values = np.linalg.eigvalsh(0.5 * (reduced + reduced.T))
    # Journals that float in their play are as soft as the round-off of stiff contacts.
    stiff = _EPS * float(np.abs(values).max(initial=0.0)) - 1.01 * float(values.min(initial=0.0))
    for _ in range(40):
        step = np.linalg.solve(reduced + (stiff + damping * size) * np.eye(len(right)), right)
        moved = _moved(balance, here, np.clip(step, -1.0, 1.0), directions)
        if moved is not None:
            break
        damping *= 4.0
    else:
        return here, damping
    factor = 0.5 if moved.residual < 2.0 * here.residual else 2.0
    return moved, min(max(factor * damping, 1e-9), 1e9)


def _farthest(balance: Balance, before: _Pose, here: _Pose, *, coarse: bool = False) -> float:
    """Return the largest displacement between two poses over what is trusted; ``coarse``: outside play."""
    way = pin.difference(balance.model, before.y[: balance.model.nq], here.y[: balance.model.nq])
    moved = np.abs(before.free.scale @ way)
    return float((moved[~before.free.fine] if coarse else moved).max(initial=0.0))


def _moved(balance: Balance, here: _Pose, step: Array, directions: Array) -> _Pose | None:
    """Return the pose after a step; None without closed loops or finite forces."""
    try:
        found = _pose(balance, balance.displaced(here.y, directions @ step))
    except MechanismError:
        return None
    return found if np.isfinite(found.force).all() else None


def _residual(balance: Balance, free: Free, force: Array, size: Array) -> float:
    """Return the largest force out of balance over the largest force."""
    if free.directions.shape[1] == 0:
        return 0.0
    ways = np.abs(free.directions)
    whole = (ways * size[:, None]).max(axis=0, initial=0.0)
    displacements = (ways * (balance.length / balance.reach)[:, None]).max(axis=0, initial=0.0)
    largest = float((size * balance.reach).max(initial=0.0)) / balance.length
    own = np.maximum(whole, max(balance.nothing, _LEAST * largest) * displacements)
    return float((np.abs(free.directions.T @ force) / own).max())


def _longest(free: Free, step: Array) -> float:
    """Return the longest part of a step, in trusted lengths."""
    moved = free.scale @ (free.directions @ step)
    return float(np.abs(moved).max(initial=0.0))


# --- friction that sticks, rigid stops ----------------------------------------------------------------------


def rested(balance: Balance, y: Array, where: str, undetermined: list[str]) -> Rest:
    """Return the pose in balance, with rigid stops and frictions that stick in consistent states.

    Args:
        balance: The mechanism.
        y: State at which the search begins.
        where: The pose, for messages.
        undetermined: Places of dry friction at joints that the driven joint does not determine: they stick,
            or slip as far as balance requires.
    """
    seen: set[tuple[object, ...]] = set()
    for _ in range(4 * (1 + len(undetermined) + len(balance.rigid)) ** 2):
        _seat(balance, y)
        found = balanced(balance, y, where)
        wrong = _wrong_stops(balance, found.y)
        wrong = wrong or _wrong_frictions(balance, found.y, undetermined)
        if not wrong:
            return found
        state = tuple(sorted((place, str(balance.senses[place])) for place in balance.senses))
        stops = tuple(balance.adjustments.elements[place].mode for place in balance.rigid)  # type: ignore[attr-defined]
        if (state, stops) in seen:
            wrong = wrong[:1]
        seen.add((state, stops))
        for place, change in wrong:
            if isinstance(change, Change):
                balance.adjustments.change(place, change)
            else:
                balance.set_sense(place, change)
        y = found.y
    raise NotBalancedError(
        f"statics: {where}: frictions and stops must come to rest together, got none that do; hold a joint, "
        "or take friction off one"
    )


def _seat(balance: Balance, y: Array) -> None:
    """Put joints beyond a rigid stop back onto it."""
    for place, one in balance.rigid.items():
        stop = balance.adjustments.elements[place]
        assert isinstance(stop, RigidStop)
        if stop.mode != FREE:
            continue
        angle = balance.met(one, y).angle
        if angle < stop.lowest - _AT_STOP or angle > stop.highest + _AT_STOP:
            balance.adjustments.change(place, Change(LOWER if angle < stop.lowest else UPPER))


def _wrong_stops(balance: Balance, y: Array) -> list[tuple[str, Change | float | None]]:
    """Return the changes of rigid stops that would pull, or are passed."""
    found: list[tuple[str, Change | float | None]] = []
    for place, one in balance.rigid.items():
        stop = balance.adjustments.elements[place]
        assert isinstance(stop, RigidStop)
        if stop.mode == FREE:
            angle = balance.met(one, y).angle
            if angle < stop.lowest - _AT_STOP:
                found.append((place, Change(LOWER)))
            elif angle > stop.highest + _AT_STOP:
                found.append((place, Change(UPPER)))
        elif balance.load(place) * (1.0 if stop.mode == LOWER else -1.0) < 0.0:
            found.append((place, Change(FREE)))
    return found


def _wrong_frictions(
    balance: Balance, y: Array, undetermined: list[str]
) -> list[tuple[str, Change | float | None]]:
    """Return new senses of frictions beyond their limits, or slipping the wrong way."""
    found: list[tuple[str, Change | float | None]] = []
    nq = balance.model.nq
    for place in undetermined:
        one, sense = balance.frictions[place], balance.senses[place]
        if sense is None:
            first = one.block + int(kernels.PARAMETERS)
            grip = float(grip_of(kind_of(type(one.element)), balance.program, first))
            load = balance.load(place)
            if abs(load) > grip * (1.0 + _SLACK):
                found.append((place, -math.copysign(1.0, load)))
            continue
        before = float(kernels.joint_motion(balance.program, one.block, balance.y, nq)[0])
        after = float(kernels.joint_motion(balance.program, one.block, y, nq)[0])
        if sense * (after - before) < 0.0:
            found.append((place, None))
    return found


def settled_senses(balance: Balance, y: Array, velocity: Array) -> list[str]:
    """Set the senses of dry friction of a motion; return undetermined places.

    Args:
        balance: The mechanism.
        y: The state.
        velocity: Direction of the motion, (nv,), with free joints at rest; no joint sticks.
    """
    free = balance.free(y)
    moved = np.abs(free.scale @ free.directions)  # of each coordinate by what is free
    undetermined = []
    for place, one in balance.frictions.items():
        at = balance.system.mechanism.joint(str(one.element.acts_at)).v.start
        if moved[at].max(initial=0.0) > 1e-9:
            undetermined.append(place)
            if not balance.senses[place]:
                balance.set_sense(place, None)
            continue
        rate = float(velocity[at])
        size = float(np.abs(velocity / balance.reach).max(initial=0.0))
        balance.set_sense(place, math.copysign(1.0, rate) if abs(rate) > 1e-12 * size else 0.0)
    for place, (motion, v, _) in balance.play_motions.items():
        rate = float(balance.slope(motion, v, y) @ velocity)
        balance.senses[place] = math.copysign(1.0, rate) if rate else 0.0
    for place, one in balance.meshes.items():
        name = str(getattr(one.element, "input", ""))
        motion, v = JointMotion(balance.system, name), balance.system.mechanism.joint(name).v
        rate = float(balance.slope(motion, v, y) @ velocity)
        balance.senses[place] = math.copysign(1.0, rate) if abs(rate) > 1e-12 else 0.0
    return undetermined
