"""Equilibria of a mechanism with their stability; statics in one call."""

from __future__ import annotations

import itertools
import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.base.arguments import takes
from antenna_pin.base.calculus import root_between
from antenna_pin.base.readable import brief
from antenna_pin.dynamics import JointMotion, System, assemble
from antenna_pin.errors import AntennaPinError, InvalidParameterError, MechanismError
from antenna_pin.scenario import Scenario
from antenna_pin.studies.statics.balance import Balance
from antenna_pin.studies.statics.path import Path
from antenna_pin.studies.statics.quasi_static import limits_of, travel
from antenna_pin.studies.statics.reading import (
    contacts_of,
    efforts_of,
    holding_of,
    positions_of,
    reactions_of,
    stiffness_of,
)
from antenna_pin.studies.statics.result import Equilibrium, QuasiStaticTravel
from antenna_pin.studies.statics.solver import NotBalancedError, Rest, rested
from antenna_pin.studies.statics.static_system import (
    StaticSystem,
    check_rate_independent,
    start_of,
    static_system,
)
from antenna_pin.studies.statics.torque_angle import TorqueAngleLoop, torque_angle_loop

Array = NDArray[np.float64]

# Two equilibria whose joints are as near are one [rad, or lengths of the mechanism].
_SAME = 1e-7
# Positions of a scan for changes of sign of the torque, and by how much it goes beyond ends [rad].
_SCAN = 73
# A coordinate that moves by less, of the largest, does not move.
_MOVES = 1e-9
# Starts in a row that lead nowhere, after which no further ones are tried.
_FAILURES = 4


@takes()
def equilibria(
    model: Scenario | System | str | os.PathLike[str],
    *,
    q: ArrayLike | None = None,
    hold: Sequence[str] = (),
    starts: int = 16,
    seed: int = 0,
) -> list[Equilibrium]:
    """Return the equilibria found for a mechanism, the nearest to its start first.

    Springs, gravity, stops, contacts and elements are as at the start, at t = 0, motions at rest where they
    are then, and a free base is held. Dry friction is off in the equilibria; where there is some each has the
    ends of its set, at which all of it acts one way in full. Hysteresis stands as at the start, and at ends
    as after a long way.

    A mechanism of one freedom (journals in their play aside) is scanned along it from limit to limit, or by a
    turn; others are searched from the start and from random poses. Of poses that no force moves, nor about
    them, the first is returned.

    Args:
        model: A scenario, its name or path, or a system.
        q: Configuration at which the search begins, (nq,); by default the start.
        hold: Names of joints that do not move.
        starts: Number of random poses.
        seed: Seed of the random poses.

    Raises:
        AntennaPinError: No equilibrium is found, nothing is free to move, or a name is unknown.
    """
    begin = start_of(model, q)
    static = static_system(begin.system, begin.state, hold=hold)
    balance = Balance(static, static.state_from(begin.state), 0.0)
    origin = balance.snapshot()
    found: list[tuple[float, Rest, Equilibrium]] = []
    first_error: AntennaPinError | None = None
    failures, any_forceless = 0, False
    check_rate_independent(static.system)
    _check_loops(balance)
    for y in _starts(balance, begin.system, begin.state, hold, starts, seed):
        balance.restore(origin)
        try:
            rest = rested(balance, y, "equilibrium", [])
        except NotBalancedError as error:
            first_error, failures = first_error or error, failures + 1
            if failures >= _FAILURES:
                break
            continue
        failures = 0
        forceless = rest.residual == 0.0 and not rest.stiffness.any()
        if forceless and any_forceless:  # each pose about them is an equilibrium
            continue
        any_forceless = any_forceless or forceless
        place = _coordinates(balance, rest.y)
        if any(np.abs(place - _coordinates(balance, one.y)).max(initial=0.0) < _SAME for _, one, _ in found):
            continue
        distance = float(np.abs(place - _coordinates(balance, origin[1])).max(initial=0.0))
        found.append((distance, rest, _with_ends(balance, rest, origin)))
    if not found:
        raise first_error or MechanismError("statics: nothing is free to move; hold fewer joints")
    return [one for _, _, one in sorted(found, key=lambda item: item[0])]


def _check_loops(balance: Balance) -> None:
    if balance.free(balance.projected(balance.y.copy())).directions.shape[1] == 0:
        raise MechanismError(
            "statics: something must be free to move to have an equilibrium, but closures, couplings, "
            "motions and held joints hold everything; hold fewer joints, or drive a joint through its "
            "travel (joint = NAME)"
        )


def _coordinates(balance: Balance, y: Array) -> Array:
    """Return numbers that identify a pose: relative positions, and rotations as matrices."""
    parts = [np.zeros(0)]
    for slot in balance.system.mechanism.joints.values():
        own = y[slot.q].astype(float)
        if slot.kind in ("floating", "spherical"):
            parts += [own[:-4] / balance.length, Rotation.from_quat(own[-4:]).as_matrix().ravel()]
        elif slot.kind == "planar":
            parts += [own[:2] / balance.length, own[2:]]
        else:
            parts.append(own / (balance.length if slot.slides else 1.0))
    return np.concatenate(parts)


# --- where searches begin -----------------------------------------------------------------------------------


def _starts(
    balance: Balance, system: System, y: Array, hold: Sequence[str], starts: int, seed: int
) -> Iterator[Array]:
    """Yield states from which equilibria are searched."""
    first = balance.projected(balance.static.state_from(y))
    yield first
    leading = _leading_joint(balance, first)
    if leading is not None:
        yield from _along(balance, system, y, leading, hold)
    if leading is None or starts > 0:
        yield from _random(balance, first, hold, starts if leading is None else 0, seed)


def _leading_joint(balance: Balance, y: Array) -> str | None:
    """Return the leading joint of a mechanism of one freedom; else None."""
    free = balance.free(y)
    coarse = [k for k in range(len(free.steps)) if not balance.in_play(free, k)]
    if len(coarse) != 1:
        return None
    moved = np.abs(free.directions[:, coarse[0]]) / balance.reach
    best, size = None, 0.0
    for name in balance.system.mechanism.joints:
        try:
            motion = JointMotion(balance.system, name)
        except MechanismError:
            continue
        v = balance.system.mechanism.joint(name).v
        rate = abs(float(balance.slope(motion, v, y) @ free.directions[:, coarse[0]]))
        rate /= balance.length if balance.system.slides(name) else 1.0
        if rate > size * (1.0 + _MOVES):
            best, size = name, rate
    return best if moved.max(initial=0.0) > 0.0 else None


def _along(balance: Balance, system: System, y: Array, joint: str, hold: Sequence[str]) -> Iterator[Array]:
    """Yield states near equilibria along the motion of a leading joint."""
    try:
        static = static_system(system, y, joint=joint, hold=hold)
        kept = {name: one for name, one in system.drives.items() if one.joint == joint}
        if kept:  # drives at the joint act in the equilibria
            return
        path = Path(_frictionless(static), y)
    except AntennaPinError:
        return
    lower, upper = limits_of(system, joint)
    here = path.position
    span = math.pi * (balance.length if path.sliding else 1.0)
    ends = [lower if math.isfinite(lower) else here - span, upper if math.isfinite(upper) else here + span]
    rows: dict[float, tuple[float, Array]] = {}
    start = path.balance.snapshot()
    for end in ends:
        path.balance.restore(start)
        path.forget()
        count = max(2, math.ceil(_SCAN * abs(end - here) / (ends[1] - ends[0] or 1.0)))
        for place in np.linspace(here, end, count):
            try:
                point = path.read(path.move(float(place), 1.0, "scan"))
            except AntennaPinError:
                break
            rows[float(place)] = (point.torque, point.rest.y.copy())
    places = sorted(rows)
    for a, b in itertools.pairwise(places):
        if rows[a][0] == 0.0 or (rows[a][0] < 0.0) != (rows[b][0] < 0.0):
            yield _refined(path, start, rows, a, b)
    for place in places[:1] + places[-1:]:
        yield balance.static.state_from(path.balance.static.state_of_original(rows[place][1]))


def _frictionless(static: StaticSystem) -> StaticSystem:
    return replace(static, contact_friction={}, play_friction={})


def _refined(path: Path, start: Any, rows: dict[float, tuple[float, Array]], a: float, b: float) -> Array:
    """Return the state of zero torque between two positions."""
    state: dict[float, Array] = {}

    def torque(place: float) -> float:
        path.balance.restore(start)
        path.balance.y = rows[a][1].copy()
        path.forget()
        point = path.read(path.move(place, 1.0, "scan"))
        state[place] = point.rest.y.copy()
        return point.torque

    try:
        root = root_between(torque, a, b, absolute=1e-10, ends=(rows[a][0], rows[b][0]))
        torque(root)
        y = state[root]
    except (AntennaPinError, ValueError):
        y = rows[a][1]
    return path.balance.static.state_of_original(y)


def _random(balance: Balance, y: Array, hold: Sequence[str], starts: int, seed: int) -> Iterator[Array]:
    """Yield random poses with closed loops."""
    random = np.random.default_rng(seed)
    system = balance.system
    for _ in range(starts):
        moved = y.copy()
        for name, slot in system.mechanism.joints.items():
            if name in hold or name in balance.system.held:
                continue
            if slot.has_one_axis:
                lower, upper = limits_of(system, name)
                span = math.pi * (balance.length if slot.slides else 1.0)
                low = lower if math.isfinite(lower) else -span
                high = upper if math.isfinite(upper) else span
                place = float(random.uniform(low, high))
                moved[slot.q] = (math.cos(place), math.sin(place)) if slot.kind == "continuous" else place
            elif any(name == one.name and one.geometry.motion == "turn" for one in system.clearances):
                step = np.zeros(system.model.nv)
                step[slot.v.stop - 3 : slot.v.stop] = random.uniform(-math.pi, math.pi) * (
                    slot.axis if slot.kind == "floating" else np.array([0.0, 0.0, 1.0])
                )
                balance.workspace.retract(moved, step)
        system.turn_on(moved)
        try:
            assemble(system, moved, (), ())
            nq, nv = system.model.nq, system.model.nv
            moved[nq : nq + nv] = 0.0
            yield balance.projected(moved)
        except AntennaPinError:
            continue


# --- equilibria with the ends of their sets -----------------------------------------------------------------


def _with_ends(balance: Balance, rest: Rest, origin: tuple[Any, ...]) -> Equilibrium:
    """Return an equilibrium with the ends of its set."""
    middle = _reading(balance, rest, "none")
    hysteretic = bool(
        balance.frictions
        or balance.states
        or balance.slipping
        or balance.play_motions
        or balance.static.contact_friction
    )
    if not hysteretic or rest.free.directions.shape[1] == 0:
        return middle
    ends: list[Equilibrium] = []
    velocity = _softest(balance, rest)
    words: tuple[tuple[Literal["forward", "backward"], float], ...] = (("backward", -1.0), ("forward", 1.0))
    for word, sense in words:
        balance.restore(origin)
        balance.y = rest.y.copy()
        balance.saturated = True
        _act(balance, rest.y, sense * velocity)
        try:
            end = rested(balance, rest.y, f"end of a set of equilibria, {word}", [])
            ends.append(_reading(balance, end, word))
        except NotBalancedError:
            pass
        finally:
            balance.saturated = False
    balance.restore(origin)
    return replace(middle, ends=tuple(ends))


def _softest(balance: Balance, rest: Rest) -> Array:
    """Return the direction of least stiffness that moves joints, (nv,)."""
    directions = rest.free.directions
    keep = [k for k in range(directions.shape[1]) if not balance.in_play(rest.free, k)]
    directions = directions[:, keep] if keep else directions
    stiffness = rest.stiffness[:, keep] if keep else rest.stiffness
    _, triangle = np.linalg.qr(directions / balance.reach[:, None])
    inverse = np.linalg.inv(triangle)
    reduced = inverse.T @ (directions.T @ stiffness) @ inverse
    values, vectors = np.linalg.eigh(0.5 * (reduced + reduced.T))
    velocity = directions @ inverse @ vectors[:, int(np.argmin(values))]
    largest = int(np.argmax(np.abs(velocity / balance.reach)))
    return np.asarray(velocity * math.copysign(1.0, velocity[largest]))


def _act(balance: Balance, y: Array, velocity: Array) -> None:
    """Let friction and hysteresis act in full against a motion."""
    mechanism = balance.system.mechanism
    rates: dict[str, float] = {}
    for name in mechanism.joints:
        try:
            motion = JointMotion(balance.system, name)
        except MechanismError:
            continue
        rates[name] = float(balance.slope(motion, mechanism.joint(name).v, y) @ velocity)
    largest = max(map(abs, rates.values()), default=0.0)
    senses = {
        name: math.copysign(1.0, rate) if abs(rate) > _MOVES * largest else 0.0
        for name, rate in rates.items()
    }
    for place, one in balance.frictions.items():
        balance.set_sense(place, senses.get(str(one.element.acts_at), 0.0))
    for place, (joint, _) in balance.static.play_friction.items():
        balance.senses[place] = senses.get(joint, 0.0)
    balance.develop(senses)
    balance.velocity = velocity if balance.static.contact_friction else balance.velocity


def _reading(balance: Balance, rest: Rest, friction: Literal["none", "forward", "backward"]) -> Equilibrium:
    values, stability = stiffness_of(balance, rest)
    positions = positions_of(balance, rest.y)
    return Equilibrium(
        state=balance.static.state_of_original(rest.y),
        positions=positions,
        units={name: "m" if balance.system.slides(name) else "rad" for name in positions},
        length=balance.length,
        efforts=efforts_of(balance, rest.y),
        holding=holding_of(balance, rest.y),
        reactions=reactions_of(balance, rest.y),
        contacts=contacts_of(balance, rest.y),
        stiffness=values,
        stability=stability,
        residual=rest.residual,
        friction=friction,
    )


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Statics:
    """Statics of a mechanism.

    Attributes:
        equilibria: Equilibria, that next to the start first; () for a named joint.
        travel: Quasi-static travel of the joint; None without.
        loop: Torque-angle loop of the joint; None without.
    """

    __repr__ = brief

    equilibria: tuple[Equilibrium, ...] = ()
    travel: QuasiStaticTravel | None = None
    loop: TorqueAngleLoop | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return what was found in plain numbers."""
        found: dict[str, Any] = {}
        if self.equilibria:
            found["equilibria"] = [one.to_dict() for one in self.equilibria]
        for name, one in (("travel", self.travel), ("loop", self.loop)):
            if one is not None:
                found[name] = one.to_dict()
        return found


@takes()
def statics(
    model: Scenario | System | str | os.PathLike[str],
    joint: str | None = None,
    *,
    start: float | str | None = None,
    stop: float | str | None = None,
    count: int = 61,
    back: bool = True,
    loop: float | str | None = None,
    small_torque: float | str | None = None,
    hold: Sequence[str] = (),
    q: ArrayLike | None = None,
    starts: int = 16,
    seed: int = 0,
) -> Statics:
    """Return equilibria, or of a joint its quasi-static travel and its torque-angle loop.

    As ``antenna-pin statics``: equilibria without a joint; with one its travel, or with ``loop`` its
    torque-angle loop; both where ends of the travel are given too. Each is what :func:`equilibria`,
    :func:`travel` and :func:`torque_angle_loop` return.

    Args:
        model: A scenario, its name or path, or a system.
        joint: The joint, or a drive, which means the joint that it moves; none for equilibria.
        start: First position [rad] ([m]); the joint's lower limit if left out.
        stop: Last position [rad] ([m]); the joint's upper limit if left out.
        count: Number of positions, evenly spaced.
        back: Whether the joint is moved back too.
        loop: Amplitude of a torque-angle loop [N*m] ([N]).
        small_torque: Torque that determines the lost motion [N*m] ([N]).
        hold: Names of further joints that do not move.
        q: Configuration from which all begins, (nq,); the start if left out.
        starts: Number of random poses from which equilibria are searched.
        seed: Of these.

    Raises:
        AntennaPinError: What needs a joint without one, or as the functions above.
    """
    options = {"start": start, "stop": stop, "loop": loop}
    given = [name for name, value in options.items() if value is not None]
    if joint is None:
        if given:
            raise InvalidParameterError(
                "statics", given[0], "given with a joint", said=str(options[given[0]])
            )
        return Statics(equilibria=tuple(equilibria(model, q=q, hold=hold, starts=starts, seed=seed)))
    if small_torque is not None and loop is None:
        rule = "given with loop, the amplitude of a torque-angle loop"
        raise InvalidParameterError("statics", "small_torque", rule, said=str(small_torque))
    way = cycle = None
    if loop is None or start is not None or stop is not None:
        way = travel(model, joint, start=start, stop=stop, count=count, back=back, hold=hold, q=q)
    if loop is not None:
        cycle = torque_angle_loop(model, joint, loop, small_torque=small_torque, hold=hold, q=q)
    return Statics(travel=way, loop=cycle)
