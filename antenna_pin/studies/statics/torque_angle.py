"""Torque-angle loop of a joint: stiffness, lost motion, dead band, hysteresis."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.calculus import root_between
from antenna_pin.base.readable import brief, number, readable
from antenna_pin.base.rules import AtLeastOne
from antenna_pin.base.units import quantity, shown
from antenna_pin.dynamics import System
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario import Scenario
from antenna_pin.studies.statics.path import Path
from antenna_pin.studies.statics.quasi_static import joint_to_drive
from antenna_pin.studies.statics.static_system import check_rate_independent, start_of, static_system

Array = NDArray[np.float64]

DEFINITIONS: Mapping[str, str] = MappingProxyType(
    {
        "stiffness": "mean slope of the loaded branches, from half of the amplitude on",
        "lost_motion": "angle between the two senses of a small torque, each applied and taken back to zero",
        "dead_band": "part of a branch with less than a twentieth of the stiffness",
        "hysteresis": "width of the loop at zero torque",
        "area": "area of the loop, lost in a cycle",
        "friction": "half of the torque between the two branches at zero mean angle",
    }
)
"""Definitions of the measures of a loop, by name."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class TorqueAngleLoop:
    """Quasi-static loop of torque over angle.

    Attributes:
        angle: Angle of the joint from the start, along the path, (n,) [rad] ([m]).
        torque: Torque on the joint's child, (n,) [N*m] ([N]).
        cycle: Cycle of each point, 0 for the first loading, (n,).
        joint: The joint's name.
        sliding: Whether the joint is prismatic.
        amplitude: Largest torque either way [N*m] ([N]).
        small_torque: Torque by which the lost motion is determined [N*m] ([N]).
        stiffness: Mean slope of the loaded branches from half of the amplitude on [N*m/rad] ([N/m]).
        stiffness_up: The same of the branch under positive torque.
        stiffness_down: The same of the branch under negative torque.
        lost_motion: Angle between the two senses of the small torque, each taken back to zero [rad] ([m]).
        dead_band: Part of a branch with less than a twentieth of the stiffness [rad] ([m]).
        hysteresis: Width of the last loop at zero torque [rad] ([m]).
        area: Area of the last loop [J].
        friction: Half of the torque between the branches in the middle of the last loop [N*m] ([N]).
        residual: Largest force out of balance over the largest force [-].
        notes: Assumptions and limits, in sentences.
        scenario: Of the mechanism; None for a system built in Python.
    """

    __repr__ = brief

    angle: Array
    torque: Array
    cycle: NDArray[np.int64]
    joint: str
    sliding: bool
    amplitude: float
    small_torque: float
    stiffness: float
    stiffness_up: float
    stiffness_down: float
    lost_motion: float
    dead_band: float
    hysteresis: float
    area: float
    friction: float
    residual: float
    notes: tuple[str, ...] = ()
    scenario: Scenario | None = None

    @property
    def data(self) -> xr.Dataset:
        """Angle, torque and cycle of each point, and the measures in words."""
        unit, length = ("N", "m") if self.sliding else ("N*m", "rad")
        words = [
            f"stiffness {readable(self.stiffness, 'N/m' if self.sliding else 'N m/rad')}",
            *(
                f"{name.replace('_', ' ')} {readable(getattr(self, name), length)}"
                for name in ("lost_motion", "dead_band", "hysteresis")
            ),
            f"area {readable(self.area, 'J')}",
        ]
        return xr.Dataset(
            {
                "angle": ("point", self.angle, {"units": length}),
                "torque": ("point", self.torque, {"units": unit}),
                "cycle": ("point", self.cycle),
            },
            attrs={"joint": self.joint, "measures": words},
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the loop in plain numbers, with the definition of each measure."""
        measures = {
            name: {"value": getattr(self, name), "definition": DEFINITIONS[name]} for name in DEFINITIONS
        }
        return {
            "joint": self.joint,
            "unit": "N" if self.sliding else "N*m",
            "amplitude": self.amplitude,
            "small_torque": self.small_torque,
            **measures,
            "angle": self.angle.tolist(),
            "torque": self.torque.tolist(),
            "cycle": self.cycle.tolist(),
            "residual": self.residual,
            "notes": list(self.notes),
        }


# --- the loop -----------------------------------------------------------------------------------------------

# Of the amplitude: change of the torque in a step, departure from a straight line, and what ends a branch.
_CHANGE, _BEND, _LOCATED = 0.125, 0.02, 1e-13
# First, least and longest step of the angle [rad, or lengths of the mechanism]; steps of a branch.
_FIRST, _LEAST, _LONGEST, _STEPS = 1e-5, 1e-13, 0.05, 4000
# How far a joint goes that nothing resists [rad, or lengths of the mechanism].
_FARTHEST = math.pi
# Share of the stiffness below which there is none; small torque over friction, and over the amplitude.
_NO_STIFFNESS, _OVER_FRICTION, _SMALL = 0.05, 2.0, 0.03
# Nodes and weights of Lobatto's rule with five points on [0, 1].
_NODES = 0.5 + 0.5 * np.array([-1.0, -math.sqrt(3.0 / 7.0), 0.0, math.sqrt(3.0 / 7.0), 1.0])
_WEIGHTS = 0.5 * np.array([1.0 / 10.0, 49.0 / 90.0, 32.0 / 45.0, 49.0 / 90.0, 1.0 / 10.0])


@takes()
def torque_angle_loop(
    model: Scenario | System | str | os.PathLike[str],
    joint: str,
    amplitude: float | str,
    *,
    cycles: AtLeastOne = 1,
    small_torque: float | str | None = None,
    hold: Sequence[str] = (),
    q: ArrayLike | None = None,
) -> TorqueAngleLoop:
    """Return the quasi-static torque-angle loop of a joint about the start position.

    The torque on the joint's child rises from the start to the amplitude, falls to its opposite and rises
    again, ``cycles`` times; measures are those of the last cycle. All else acts as at the start; for the
    stiffness of a whole drive train hold its other end (``hold``). ``DEFINITIONS`` defines the measures; the
    dead band is as fine as the points of the loop.

    Args:
        model: A scenario, its name or path, or a system.
        joint: The joint, or a drive of it.
        amplitude: Largest torque either way [N*m] ([N]).
        cycles: Number of cycles after the first loading.
        small_torque: Torque that determines the lost motion [N*m] ([N]); by default twice the friction,
            or 3 % of the amplitude without friction.
        hold: Names of further joints that do not move.
        q: Configuration from which the joint is moved, (nq,); by default the start.

    Raises:
        AntennaPinError: The joint is unknown, friction holds the amplitude or nothing resists it, or a
            position has no equilibrium.
    """
    begin = start_of(model, q)
    joint = joint_to_drive(begin.system, joint)
    unit = "N" if begin.system.slides(joint) else "N*m"
    size = quantity(amplitude, unit, "amplitude")
    check_number("statics", "amplitude", size, "positive", text=shown(amplitude))
    static = static_system(begin.system, begin.state, joint=joint, hold=hold)
    check_rate_independent(static.system)
    march = _March(Path(static, begin.state), size)
    first = march.path.position
    march.to(1.0, (0.5 * size, size))
    pieces = [march.take()]
    for _ in range(cycles):
        march.to(-1.0, (0.5 * size, 0.0, -0.5 * size, -size))
        down = march.take()
        march.to(1.0, (-0.5 * size, 0.0, 0.5 * size, size))
        up = march.take()
        pieces += [down, up]
    ends = float(up.angle[-1]), float(down.angle[-1])
    if ends[0] == ends[1]:
        rule = f"above the friction of joint {joint!r}, which holds it"
        raise InvalidParameterError("statics", "amplitude", rule, said=f"{number(size)} {unit}")
    stiffness = [
        0.5 * size / abs(float(one.angle[-1]) - _angle_at(one, 0.5 * level))
        if float(one.angle[-1]) != _angle_at(one, 0.5 * level)
        else math.inf
        for one, level in ((up, size), (down, -size))
    ]
    mean = 2.0 / (1.0 / stiffness[0] + 1.0 / stiffness[1])
    middle = 0.5 * (ends[0] + ends[1])
    friction = 0.5 * max(_torque_at(up, middle) - _torque_at(down, middle), 0.0)
    if friction < 1e-9 * size:
        friction = 0.0
    little = (
        min(_OVER_FRICTION * friction, size)
        if small_torque is None and friction > 0.0
        else _SMALL * size
        if small_torque is None
        else quantity(small_torque, unit, "small_torque")
    )
    if not 0.0 < little <= size:
        rule = f"positive, and at most the amplitude, {number(size)} {unit}"
        raise InvalidParameterError("statics", "small_torque", rule, small_torque)
    hysteresis = abs(_angle_at(down, 0.0) - _angle_at(up, 0.0))
    area = up.work + down.work
    if abs(area) < 1e-13 * size * abs(ends[0] - ends[1]):
        area = 0.0  # round-off of the work either way
    residual = max(one.residual for one in pieces)
    lost_motion = march.lost_motion(little)
    return TorqueAngleLoop(
        angle=np.concatenate([one.angle for one in pieces]) - first,
        torque=np.concatenate([one.torque for one in pieces]),
        cycle=np.concatenate([np.full(len(one.angle), (k + 1) // 2) for k, one in enumerate(pieces)]),
        joint=joint,
        sliding=march.path.sliding,
        amplitude=size,
        small_torque=little,
        stiffness=mean,
        stiffness_up=stiffness[0],
        stiffness_down=stiffness[1],
        lost_motion=lost_motion,
        dead_band=max(_dead_band(one, mean) for one in (up, down)),
        hysteresis=hysteresis,
        area=area,
        friction=friction,
        residual=residual,
        notes=static.notes,
        scenario=begin.scenario,
    )


class _LoopBranch(NamedTuple):
    """Points of a branch of a loop."""

    angle: Array  # (n,)
    torque: Array  # (n,)
    work: float  # integral of the torque over the angle
    residual: float


class _March:
    """A joint moved until its torque has reached a level."""

    def __init__(self, path: Path, amplitude: float) -> None:
        self.path, self._size = path, amplitude
        self._unit = path.balance.length if path.sliding else 1.0
        self._step = _FIRST * self._unit
        self._origin = path.position
        self._angles: list[float] = []
        self._torques: list[float] = []
        self._work = self._residual = 0.0

    def take(self) -> _LoopBranch:
        """Return the points since the last time."""
        found = _LoopBranch(np.array(self._angles), np.array(self._torques), self._work, self._residual)
        self._angles, self._torques, self._work = [], [], 0.0
        return found

    def to(self, sense: float, levels: Sequence[float]) -> None:
        """Move on in a sense until the torque has passed some levels, one after another."""
        torque = self._at(self.path.position, sense)
        self._note(torque)
        for level in levels:
            for _ in range(_STEPS):
                if sense * (level - torque) <= _LOCATED * self._size:
                    break
                torque = self._advance(sense, torque, level)
            else:
                raise self._free(sense)

    def lost_motion(self, small: float) -> float:
        """Return the angle between both senses of a small torque, each taken back to zero."""
        ends = []
        for sense in (1.0, -1.0, 1.0):
            self.to(sense, (sense * small,))
            self.to(-sense, (0.0,))
            ends.append(self.path.position)
        self.take()
        return abs(ends[2] - ends[1])

    def _at(self, place: float, sense: float) -> float:
        found = self.path.read(self.path.move(place, sense))
        self._residual = max(self._residual, found.rest.residual)
        return found.torque

    def _note(self, torque: float) -> None:
        self._angles.append(self.path.position)
        self._torques.append(torque)

    def _advance(self, sense: float, torque: float, level: float) -> float:
        """Make one step, at most to a level; return the torque there."""
        start = self.path.position
        if abs(start - self._origin) > _FARTHEST * self._unit:
            raise self._free(sense)
        before = self.path.snapshot()
        torques = self._torques_over(start, sense, self._step)
        values = [torque, *torques]
        bend = max(
            abs(values[k] - values[0] - (values[-1] - values[0]) * _NODES[k]) for k in range(1, len(values))
        )
        rough = abs(values[-1] - torque) > _CHANGE * self._size or bend > _BEND * self._size
        if rough and self._step > _LEAST * self._unit:
            self.path.restore(before)
            self._step *= 0.5
            return torque
        if sense * (values[-1] - level) >= -_LOCATED * self._size:
            self.path.restore(before)
            length = self._located(start, sense, torque, level, values[-1], before)
            torques = self._torques_over(start, sense, length)
            values = [torque, *torques]
            self._add(start, sense, length, values)
            return level
        self._add(start, sense, self._step, values)
        calm = abs(values[-1] - torque) < 0.5 * _CHANGE * self._size and bend < 0.25 * _BEND * self._size
        if calm:
            self._step = min(2.0 * self._step, _LONGEST * self._unit)
        return values[-1]

    def _torques_over(self, start: float, sense: float, length: float) -> list[float]:
        return [self._at(start + sense * length * float(node), sense) for node in _NODES[1:]]

    def _add(self, start: float, sense: float, length: float, values: Sequence[float]) -> None:
        self._angles += [start + sense * length * float(node) for node in _NODES[1:]]
        self._torques += values[1:]
        self._work += sense * length * float(_WEIGHTS @ np.array(values))

    def _located(
        self, start: float, sense: float, torque: float, level: float, reached: float, before: object
    ) -> float:
        """Return the length of the step to a level of the torque."""
        slack = _LOCATED * self._size

        def beyond(length: float) -> float:
            self.path.restore(before)
            if length == 0.0:
                return sense * (torque - level) + slack
            found = sense * (self._at(start + sense * length, sense) - level) + slack
            return 0.0 if abs(found - slack) < slack else found

        ends = sense * (torque - level) + slack, sense * (reached - level) + slack
        found = self._step
        if ends[1] > 2.0 * slack:
            found = root_between(beyond, 0.0, self._step, absolute=1e-18 * self._unit, ends=ends)
        if beyond(found) == 0.0:  # a torque that stays where it is, as in play: where that begins
            low = 0.0
            while found - low > 1e-15 * self._unit + 4e-16 * found:
                middle = 0.5 * (low + found)
                if middle in (low, found):
                    break
                low, found = (middle, found) if beyond(middle) < 0.0 else (low, middle)
        self.path.restore(before)
        return found

    def _free(self, sense: float) -> InvalidParameterError:
        unit = "N" if self.path.sliding else "N*m"
        rule = (
            f"one that something resists: joint {self.path.joint!r} moves on without end; hold the other end "
            "(hold), or take a smaller one"
        )
        return InvalidParameterError(
            "statics", "amplitude", rule, said=f"{number(sense * self._size)} {unit}"
        )


def _angle_at(branch: _LoopBranch, torque: float) -> float:
    """Return the angle at which a branch passes a torque."""
    values = branch.torque - torque
    near = np.flatnonzero(np.abs(values) <= 1e-12 * float(np.abs(branch.torque).max()))
    if len(near):
        return float(branch.angle[near[0]])  # where it comes to it, of a branch that stays there
    passed = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    if not len(passed):
        return float(branch.angle[0])  # the torque jumped over it where the branch begins
    k = int(passed[-1])
    share = values[k] / (values[k] - values[k + 1])
    return float(branch.angle[k] + share * (branch.angle[k + 1] - branch.angle[k]))


def _torque_at(branch: _LoopBranch, angle: float) -> float:
    """Return the torque of a branch at an angle."""
    order = np.argsort(branch.angle, kind="stable")
    return float(np.interp(angle, branch.angle[order], branch.torque[order]))


def _dead_band(branch: _LoopBranch, stiffness: float) -> float:
    """Return the part of a branch with less than a twentieth of the stiffness."""
    way, change = np.abs(np.diff(branch.angle)), np.abs(np.diff(branch.torque))
    return float(way[change < _NO_STIFFNESS * stiffness * way].sum())
