"""Quasi-static travel: a joint moved through its positions without inertia."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.readable import number
from antenna_pin.base.rules import AtLeastTwo
from antenna_pin.base.units import quantity
from antenna_pin.dynamics import System
from antenna_pin.elements import Limits, RigidStop
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.scenario import Scenario, joint_limits
from antenna_pin.studies.statics.path import Path, PathPoint
from antenna_pin.studies.statics.reading import positions_of, reactions_of, sources_of, stiffness_of
from antenna_pin.studies.statics.result import QuasiStaticTravel
from antenna_pin.studies.statics.static_system import (
    Model,
    check_rate_independent,
    start_of,
    static_system,
)

Array = NDArray[np.float64]

COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")
_AT_LIMIT = 1e-9


@takes()
def travel(
    model: Scenario | System | str | os.PathLike[str],
    joint: str,
    positions: Sequence[float | str] | None = None,
    *,
    start: float | str | None = None,
    stop: float | str | None = None,
    count: int = 61,
    back: bool = True,
    hold: Sequence[str] = (),
    q: ArrayLike | None = None,
) -> QuasiStaticTravel:
    """Return the torque that a joint needs along its travel at vanishing rate, and back.

    Drives at the joint are off; all else acts as it does at the start, at t = 0. Dry friction acts in full
    against the motion; friction of other free joints sticks or slips as equilibrium requires. Hysteresis
    follows the displacement, from the state at the start of a run; dampers exert nothing.

    Args:
        model: A scenario, its name or path, or a system.
        joint: The joint, or a drive of it.
        positions: Positions of the joint [rad] ([m]), in one sense; instead of start, stop and count.
        start: First position [rad] ([m]); by default the joint's lower limit.
        stop: Last position [rad] ([m]); by default the joint's upper limit.
        count: Number of positions, evenly spaced.
        back: Whether the joint is moved back too.
        hold: Names of further joints that do not move.
        q: Configuration from which the joint is moved, (nq,); by default the start.

    Raises:
        AntennaPinError: The joint is unknown or held by something else, the travel is beyond its limits,
            or a position has no equilibrium.
    """
    begin = start_of(model, q)
    joint = joint_to_drive(begin.system, joint)
    places = positions_along(begin, joint, positions, start, stop, count)
    static = static_system(begin.system, begin.state, joint=joint, hold=hold)
    check_rate_independent(static.system)
    path = Path(static, begin.state)
    sense = 1.0 if places[-1] > places[0] else -1.0
    path.move(float(places[0]), sense, "start of the travel")
    ways = [(places, sense)] + ([(places[::-1], -sense)] if back else [])
    table = _Table(path, len(ways), len(places))
    for k, (order, direction) in enumerate(ways):
        for n, place in enumerate(order):
            point = path.read(path.move(float(place), direction))
            table.add(k, n if k == 0 else len(places) - 1 - n, point)
    return QuasiStaticTravel(
        table.dataset(places),
        table.states,
        joint,
        path.sliding,
        notes=static.notes,
        scenario=begin.scenario,
    )


def joint_to_drive(system: System, joint: str) -> str:
    """Return the joint of a name, which may be a drive's.

    Raises:
        UnknownNameError: No joint and no drive has the name.
    """
    if joint in system.mechanism.joints:
        return joint
    name = joint.removeprefix("drives.")
    if name in system.drives:
        return system.drives[name].joint
    raise UnknownNameError("statics", "joint or drive", joint, {*system.mechanism.joints, *system.drives})


def positions_along(
    begin: Model,
    joint: str,
    positions: Sequence[float | str] | None,
    start: float | str | None,
    stop: float | str | None,
    count: int,
) -> Array:
    """Return the positions of a travel, (n,) [rad] ([m]).

    Raises:
        InvalidParameterError: Positions are beyond the joint's limits, too few, or not in one sense.
    """
    system = begin.system
    unit = "m" if system.slides(joint) else "rad"
    lower, upper = limits_of(system, joint)
    if positions is not None:
        if start is not None or stop is not None:
            raise InvalidParameterError("statics", "positions", "omitted if start and stop are given", "both")
        places = np.array([quantity(one, unit, "positions") for one in positions])
    else:
        ends = []
        least, most = _stated_limits(begin, joint)
        for name, value, limit in (("start", start, max(lower, least)), ("stop", stop, min(upper, most))):
            if value is None and not np.isfinite(limit):
                rule = f"given: joint {joint!r} has no limit there"
                raise InvalidParameterError("statics", name, rule, said="none")
            ends.append(limit if value is None else quantity(value, unit, name))
        check_number("statics", "count", count, AtLeastTwo)
        places = np.linspace(ends[0], ends[1], count)
    steps = np.diff(places)
    if len(places) < 2 or not (np.all(steps > 0.0) or np.all(steps < 0.0)):
        rule = "two or more positions, in one sense"
        raise InvalidParameterError("statics", "travel", rule, said=f"{places.tolist()[:6]}")
    low, high = float(places.min()), float(places.max())
    if low < lower - _AT_LIMIT or high > upper + _AT_LIMIT:
        raise InvalidParameterError(
            "statics",
            "travel",
            f"within the limits of joint {joint!r}, {number(lower)} to {number(upper)} {unit}; change the "
            f"travel, or the limits by mechanism.joints.{joint} or its stop",
            said=f"{number(low)} to {number(high)} {unit}",
        )
    return places


def limits_of(system: System, joint: str) -> tuple[float, float]:
    """Return the limits of a joint by URDF and rigid stops; infinite without."""
    lower, upper = -np.inf, np.inf
    limit = system.mechanism.urdf.joint(joint).limit
    if limit is not None and system.mechanism.urdf.joint(joint).type not in ("continuous",):
        lower = -np.inf if limit.lower is None else float(limit.lower)
        upper = np.inf if limit.upper is None else float(limit.upper)
    for one in system.families.get("stops", {}).values():
        if isinstance(one, Limits) and isinstance(one, RigidStop) and one.joint == joint and one.on:
            lower, upper = max(lower, one.lowest), min(upper, one.highest)
    return lower, upper


def _stated_limits(begin: Model, joint: str) -> tuple[float, float]:
    """Return the limits stated by the URDF, of joints with play or on bearings too."""
    if begin.scenario is None:
        return -np.inf, np.inf
    change = begin.scenario.mechanism.joints.get(joint)
    own = (None, None) if change is None else (change.lower, change.upper)
    stated = joint_limits(begin.scenario.urdf_text).get(joint, (-np.inf, np.inf))
    lower, upper = (limit if new is None else new for new, limit in zip(own, stated, strict=True))
    return float(lower), float(upper)


class _Table:
    """Numbers of a travel, filled position by position."""

    def __init__(self, path: Path, ways: int, count: int) -> None:
        balance = path.balance
        self._path = path
        self._sources = sources_of(balance)
        self._joints = list(balance.system.mechanism.joints)
        self._placed = list(positions_of(balance, balance.y))
        reactions = reactions_of(balance, balance.y)
        self._reacting = list(reactions)
        shape = (ways, count)
        self._torque, self._residual, self._stiffness = np.zeros(shape), np.zeros(shape), np.zeros(shape)
        self._parts = np.zeros((*shape, len(self._sources)))
        self._positions = np.zeros((*shape, len(self._placed)))
        self._reactions = np.zeros((*shape, len(self._reacting), 6))
        self.states = np.zeros((*shape, len(balance.static.state_of_original(balance.y))))

    def add(self, way: int, at: int, point: PathPoint) -> None:
        """Write a position."""
        balance, y = self._path.balance, point.rest.y
        self._torque[way, at], self._residual[way, at] = point.torque, point.rest.residual
        self._parts[way, at] = [point.components[name] for name in self._sources]
        values, _ = stiffness_of(balance, point.rest)
        self._stiffness[way, at] = values[0] if len(values) else np.nan
        self._positions[way, at] = list(positions_of(balance, y).values())
        self._reactions[way, at] = list(reactions_of(balance, y).values())
        self.states[way, at] = balance.static.state_of_original(y)

    def dataset(self, places: Array) -> xr.Dataset:
        """Return the numbers with names and units."""
        unit, length = ("N", "m") if self._path.sliding else ("N*m", "rad")
        senses = ["out", "back"][: len(self._torque)]
        along = ("sense", "position")
        variables = {
            "torque": (along, self._torque, {"units": unit, "long_name": "needed at the joint"}),
            "component": (
                (*along, "source"),
                self._parts,
                {"units": unit, "long_name": "along the motion, by virtual work"},
            ),
            "joint_position": ((*along, "joint"), self._positions, {"long_name": "position, rad or m"}),
            "reaction": (
                (*along, "reacting", "component_axis"),
                self._reactions,
                {"units": "N, N*m", "long_name": "force and moment on the child, world axes"},
            ),
            "stiffness": (
                along,
                self._stiffness,
                {"units": "N*m/rad", "long_name": "least eigenvalue of the reduced tangent stiffness"},
            ),
            "residual": (along, self._residual, {"units": "1", "long_name": "force out of balance"}),
        }
        coordinates = {
            "sense": senses,
            "position": ("position", places, {"units": length, "long_name": self._path.joint}),
            "source": self._sources,
            "joint": self._placed,
            "reacting": self._reacting,
            "component_axis": list(COMPONENTS),
        }
        return xr.Dataset(variables, coords=coordinates, attrs={"joint": self._path.joint})
