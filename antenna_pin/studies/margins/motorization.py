"""Motorization margin: driving over resisting torque, at each position of a travel."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, get_args

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from antenna_pin.analysis import ROUND_OFF
from antenna_pin.base.arguments import takes
from antenna_pin.base.units import quantity
from antenna_pin.dynamics import System
from antenna_pin.elements import (
    BoucWen,
    BristleFriction,
    ConstantDrive,
    HarnessSpring,
    JointFriction,
    MaxwellSlip,
    Motion,
    Motor,
    PDController,
    Shake,
    StickingFriction,
)
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.scenario import Scenario
from antenna_pin.studies.linear.modal_analysis import bodies_of
from antenna_pin.studies.margins.factors import FactorSet, Resistance, factor_set
from antenna_pin.studies.margins.result import MarginCase, MotorizationMargin
from antenna_pin.studies.margins.worst_case import Extremes, worst_cases
from antenna_pin.studies.statics.balance import Balance
from antenna_pin.studies.statics.path import Path, PathPoint
from antenna_pin.studies.statics.quasi_static import joint_to_drive, positions_along
from antenna_pin.studies.statics.static_system import Model, check_rate_independent, start_of, static_system

Array = NDArray[np.float64]

_ADDITIONAL = "additional.{}"
_BASE = "base acceleration"
_COGGING = "{} cogging"
_ELASTIC = "{} elastic"
# A rate below this, of the function's, is none.
_MOVES = 1e-12


@takes()
def margin(
    model: Scenario | System | str | os.PathLike[str],
    joint: str,
    *,
    travel: Sequence[float | str] | None = None,
    count: int = 61,
    factors: str | FactorSet | Mapping[str, Any] = "ecss-e-st-33-01c",
    by_measurement: Mapping[str, bool] | Sequence[str] = (),
    classes: Mapping[str, str] | None = None,
    additional: Mapping[str, float | str | Sequence[float]] | None = None,
    base_acceleration: ArrayLike | None = None,
    acceleration: float | str = 0.0,
    delivered_torque: float | str = 0.0,
    rate: float | str = 0.0,
    drives: Sequence[str] | None = None,
    available: Mapping[str, float | str] | None = None,
    hold: Sequence[str] = (),
    q: ArrayLike | None = None,
    cases: Mapping[str, Mapping[str, Any]] | None = None,
    ranges: Mapping[str, Sequence[Any]] | None = None,
    search: bool = False,
) -> MotorizationMargin:
    r"""Return the motorization margin of a function of one freedom over its travel.

    .. math:: T_{min} = m \sum_i f_i R_i + f_D T_D + T_L, \qquad
              \text{margin} = \frac{\sum_j a_j A_j}{T_{min}} - 1

    At each position the mechanism is in balance at vanishing rate, without kinetic energy, and the torque of
    each element is reduced to the joint by virtual work. Resistances count with the factors of their classes,
    drives with their own; assisting friction, hysteresis and harnesses do not count. Friction is that at
    breakaway, under the joint's own load at the needed torque; hysteresis is at its limit for the travel's
    sense.

    Classes: springs, stops and latches S; friction and gears F_R; Bouc-Wen's hysteresis (its elastic part is
    S) and Maxwell's H_Y; harnesses and forces on links H_A; a motor's cogging, by its largest, H_M; weight I.

    Args:
        model: A scenario, its name or path, or a system.
        joint: Joint of the function, or a drive, which means its joint.
        travel: First and last position, or all positions in one sense [rad] ([m]); by default the joint's
            limits. The function moves from the first to the last.
        count: Number of positions between the first and the last.
        factors: Name of a set, a set, or changes to one (:func:`factor_set`).
        by_measurement: Sources with measured values, as ``springs.harness``; or True or False by source.
        classes: Classes by source that differ from those above.
        additional: Resistances outside the model, by class: ``{"H_D": 0.02}``, one torque or one for each
            position [N*m] ([N]).
        base_acceleration: Acceleration of the base, linear and angular in its axes, (3,) or (6,) [m/s^2,
            rad/s^2]; its inertia torque resists with either sign.
        acceleration: Required acceleration of the function [rad/s^2] ([m/s^2]), for T_D.
        delivered_torque: T_L, to be delivered to a load [N*m] ([N]).
        rate: Rate of the joint, for the back-EMF of a motor [rad/s] ([m/s]).
        drives: Names of the actuating drives; by default all that move the joint.
        available: Available torques of drives at their own joints, by name [N*m] ([N]), if they do not follow
            from the drives.
        hold: Names of further joints that do not move.
        q: Configuration from which the joint is moved to its travel, (nq,); by default the start.
        cases: Overrides of scenario keys by name of the case: temperatures, gravity of a test.
        ranges: Least and greatest value of scenario keys: supplies, tolerances. All corners are evaluated, in
            each case.
        search: Whether the worst case is also searched within the ranges, for margins that are not monotone.

    Raises:
        AntennaPinError: A joint, drive, source or class is unknown, nothing drives, the travel is beyond the
            joint's limits, or a position has no equilibrium.
    """
    begin = start_of(model, q)
    options = _Options(
        joint=joint_to_drive(begin.system, joint),
        travel=travel,
        count=count,
        factors=factor_set(factors),
        by_measurement=by_measurement,
        classes=dict(classes or {}),
        additional=dict(additional or {}),
        base_acceleration=_six(base_acceleration),
        acceleration=acceleration,
        delivered_torque=delivered_torque,
        rate=rate,
        drives=drives,
        available=dict(available or {}),
        hold=tuple(hold),
    )
    table, notes = _table(begin, options)
    smallest, position = _smallest(table)
    evaluated = [MarginCase("nominal", {}, smallest, position, "nominal")]
    worst_scenario = begin.scenario
    if cases or ranges:
        if begin.scenario is None:
            rule = "left out for a system built in Python, which has no keys; give a scenario"
            raise InvalidParameterError("margin", "ranges" if ranges else "cases", rule, said="some")

        def margin_of(scenario: Scenario) -> tuple[float, float]:
            return _smallest(_table(start_of(scenario), options)[0])

        extremes = Extremes(begin.scenario, cases or {}, ranges or {})
        evaluated += worst_cases(extremes, margin_of, search=search)
        evaluated.sort(key=lambda one: one.margin)
        worst_scenario = extremes.scenario(evaluated[0])
    elif search:
        raise InvalidParameterError("margin", "search", "left out without ranges to search in", True)
    return MotorizationMargin(
        data=table,
        joint=options.joint,
        sliding=begin.system.slides(options.joint),
        factors=options.factors,
        smallest=smallest,
        position=position,
        cases=tuple(evaluated),
        worst_scenario=worst_scenario,
        notes=notes,
        scenario=begin.scenario,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Options:
    """Arguments of a margin that all its cases share."""

    joint: str
    travel: Sequence[float | str] | None
    count: int
    factors: FactorSet
    by_measurement: Mapping[str, bool] | Sequence[str]
    classes: dict[str, str]
    additional: dict[str, Any]
    base_acceleration: Array
    acceleration: float | str
    delivered_torque: float | str
    rate: float | str
    drives: Sequence[str] | None
    available: dict[str, float | str]
    hold: tuple[str, ...]


def _six(acceleration: ArrayLike | None) -> Array:
    """Return linear and angular acceleration, (6,)."""
    if acceleration is None:
        return np.zeros(6)
    given = np.asarray(acceleration, dtype=float)
    if given.shape not in ((3,), (6,)) or not np.isfinite(given).all():
        rule = "3 or 6 finite numbers [m/s^2, rad/s^2]"
        raise InvalidParameterError("margin", "base_acceleration", rule, given.tolist())
    return np.concatenate([given, np.zeros(6 - len(given))])


def _smallest(table: xr.Dataset) -> tuple[float, float]:
    """Return the smallest margin and its position."""
    k = int(np.argmin(table["margin"].values))
    return float(table["margin"].values[k]), float(table["position"].values[k])


# --- one case -----------------------------------------------------------------------------------------------


class _Source(NamedTuple):
    """Resistance or drive of one source at one position."""

    symbol: str
    torque: float  # positive drives
    actuates: float  # factor where it drives; 0: it does not count


def _table(begin: Model, options: _Options) -> tuple[xr.Dataset, tuple[str, ...]]:
    """Return the margin of one case over the travel, and notes."""
    system, joint = begin.system, options.joint
    places = _positions(begin, options)
    sense = 1.0 if places[-1] > places[0] else -1.0
    driving = _driving(begin, options)
    static = static_system(system, begin.state, joint=joint, hold=options.hold, without=driving)
    check_rate_independent(static.system)
    path = Path(static, begin.state, saturated=True)
    path.move(float(places[0]), sense, "start of the travel")
    _develop(path, sense)
    unit = "N" if path.sliding else "N*m"
    rows, inertias = [], []
    for n, place in enumerate(places):
        point = path.read(path.move(float(place), sense))
        inertias.append(path.inertia(point))
        rows.append(_sources(system, path, point, sense, options, n, len(places), driving))
    names = list(dict.fromkeys(name for row in rows for name in row))
    symbols = {name: row[name].symbol for row in rows for name in row}
    actuates = {name: row[name].actuates for row in rows for name in row}
    measured_sources = _sources_by_measurement(options, names)
    torque = np.array([[row[name].torque if name in row else 0.0 for name in names] for row in rows])
    torque[np.abs(torque) < ROUND_OFF * np.abs(torque).max(initial=0.0)] = 0.0
    resistance, drive = np.maximum(-torque, 0.0), np.maximum(torque, 0.0)
    by_measurement = np.array([name in measured_sources for name in names])
    factor = np.array(
        [
            options.factors.factor(symbols[name], bool(measured)) if symbols[name] else 1.0
            for name, measured in zip(names, by_measurement, strict=True)
        ]
    )
    own = np.array([actuates[name] for name in names])
    wanted = abs(quantity(options.acceleration, "m/s^2" if path.sliding else "rad/s^2", "acceleration"))
    inertia_torque = wanted * np.array(inertias)
    delivered = quantity(options.delivered_torque, unit, "delivered_torque")
    needed = resistance.sum(axis=1)
    minimum = (
        options.factors.motorization * (resistance @ factor)
        + options.factors.commanded * inertia_torque
        + delivered
    )
    actuation = drive @ own
    if not (actuation > 0.0).any():
        known = ", ".join(driving) or "none"
        raise MechanismError(
            f"margin: joint {joint!r}: something must drive the function along its travel, got nothing "
            f"(drives that move it: {known}); give available = {{DRIVE: TORQUE}}, reverse the travel, or add "
            "a drive or a spring"
        )
    with np.errstate(divide="ignore"):
        over = np.where(minimum > 0.0, actuation / np.where(minimum > 0.0, minimum, 1.0) - 1.0, np.inf)
    along = ("position",)
    variables: dict[str, Any] = {
        "margin": (along, over, {"units": "1", "long_name": "motorization margin"}),
        "actuation": (along, actuation, {"units": unit, "long_name": "factored actuation"}),
        "minimum_torque": (along, minimum, {"units": unit, "long_name": "minimum actuation, T_min"}),
        "needed_torque": (along, needed, {"units": unit, "long_name": "sum of resistances, unfactored"}),
        "commanded_torque": (along, inertia_torque, {"units": unit, "long_name": "T_D, unfactored"}),
        "resistance": ((*along, "source"), resistance, {"units": unit, "long_name": "resistance"}),
        "drive": ((*along, "source"), drive, {"units": unit, "long_name": "drive, unfactored"}),
        "symbol": (("source",), np.array([symbols[name] for name in names], dtype=str)),
        "resistance_factor": (("source",), factor, {"units": "1"}),
        "drive_factor": (("source",), own, {"units": "1"}),
        "by_measurement": (("source",), by_measurement),
    }
    coordinates = {
        "position": (
            "position",
            places,
            {"units": "m" if path.sliding else "rad", "long_name": joint},
        ),
        "source": names,
    }
    attributes = {
        "joint": joint,
        "factors": options.factors.name,
        "clause": options.factors.clause,
        "source": options.factors.source,
        "required": options.factors.required,
    }
    notes = [*static.notes]
    for place in path.balance.meshes:
        notes.append(f"{place} loses its share of what it has to transmit, T_L included")
    return xr.Dataset(variables, coords=coordinates, attrs=attributes), tuple(notes)


def _positions(begin: Model, options: _Options) -> Array:
    """Return the positions of the travel, (n,)."""
    travel = options.travel
    if travel is None:
        return positions_along(begin, options.joint, None, None, None, options.count)
    if len(travel) == 2:
        return positions_along(begin, options.joint, None, travel[0], travel[1], options.count)
    return positions_along(begin, options.joint, travel, None, None, options.count)


def _driving(begin: Model, options: _Options) -> list[str]:
    """Return the names of the drives that actuate the function."""
    system, joint = begin.system, options.joint
    every = {name: one for name, one in system.drives.items() if not isinstance(one, Shake)}
    for name in (*(options.drives or ()), *options.available):
        if name.removeprefix("drives.") not in every:
            raise UnknownNameError("margin", "drive", name, every)
    if options.drives is not None:
        return [name.removeprefix("drives.") for name in options.drives]
    motions = [name for name, one in every.items() if isinstance(one, Motion)]
    others = [name for name in every if name not in motions]
    tried = [others, [*others, *motions]] if motions else [others]
    for without in tried:
        static = static_system(system, begin.state, joint=joint, hold=options.hold, without=without)
        try:
            path = Path(static, begin.state)
            break
        except MechanismError:
            if without is tried[-1]:
                raise
    velocity = path.kinematic(path.balance.y)
    rates = {name: path.geared_rate_of(every[name].joint, velocity) for name in every}
    return [name for name in without if abs(rates[name]) > _MOVES]


def _develop(path: Path, sense: float) -> None:
    """Bring hysteresis and friction to their state after a long way."""
    balance = path.balance
    velocity = path.kinematic(balance.y)
    senses = {}
    for place in [one.place for one in balance.states] + list(balance.slipping):
        joint = str(balance.adjustments.elements[place].acts_at)
        rate = sense * path.rate_of(joint, velocity)
        senses[joint] = math.copysign(1.0, rate) if abs(rate) > _MOVES else 0.0
    balance.develop(senses)
    path.slip(sense)


def _sources_by_measurement(options: _Options, names: Sequence[str]) -> set[str]:
    """Return the sources whose value is measured."""
    given = options.by_measurement
    wanted = [name for name, on in given.items() if on] if isinstance(given, Mapping) else list(given)
    found = set()
    for name in (*wanted, *([*given] if isinstance(given, Mapping) else [])):
        own = [one for one in names if one == name or one.partition(".")[2] == name]
        own += [one for one in names if one in (_ELASTIC.format(name), _COGGING.format(name))]
        if not own:
            raise UnknownNameError("margin: by_measurement", "source", name, names)
        if name in wanted:
            found |= set(own)
    return found


def _sources(
    system: System,
    path: Path,
    point: PathPoint,
    sense: float,
    options: _Options,
    n: int,
    count: int,
    driving: Sequence[str],
) -> dict[str, _Source]:
    """Return resistances and drives at a position, by source."""
    factors, velocity = options.factors, sense * point.velocity
    found: dict[str, _Source] = {}
    for name, torque in point.components.items():
        symbol, actuates = _class_of(system, name, factors)
        element = _element(system, name)
        if isinstance(element, BoucWen):
            elastic = path.elastic(point, element) * sense
            found[_ELASTIC.format(name)] = _Source("S", elastic, factors.spring)
            torque -= elastic * sense
        found[name] = _Source(symbol, sense * torque, actuates)
    unit = "N" if path.sliding else "N*m"
    for name in driving:
        torque, cogging = _torque_of(system, path, name, sense, options)
        found[f"drives.{name}"] = _Source("", torque, factors.motor)
        if cogging:
            found[_COGGING.format(f"drives.{name}")] = _Source("H_M", -cogging, 0.0)
    for symbol, value in options.additional.items():
        if symbol not in get_args(Resistance):
            raise UnknownNameError("margin: additional", "class of resistance", symbol, get_args(Resistance))
        several = isinstance(value, Sequence | np.ndarray) and not isinstance(value, str)
        if several and len(value) != count:
            rule = f"one torque, or one for each of {count} positions"
            raise InvalidParameterError("margin", f"additional[{symbol!r}]", rule, said=f"{len(value)}")
        size = quantity(value[n] if several else value, unit, f"additional[{symbol!r}]")
        found[_ADDITIONAL.format(symbol)] = _Source(symbol, -abs(size), 0.0)
    if options.base_acceleration.any():
        coupling = bodies_of(path.balance.system, point.rest.y[: path.balance.model.nq]).coupling
        torque = float(velocity @ coupling @ options.base_acceleration)
        found[_BASE] = _Source("I", -abs(torque), 0.0)
    delivered = quantity(options.delivered_torque, unit, "delivered_torque")
    _add_gear_losses(path, found, point, sense, driving, delivered)
    for name, symbol in options.classes.items():
        if symbol not in get_args(Resistance):
            raise UnknownNameError("margin: classes", "class of resistance", symbol, get_args(Resistance))
        if name not in found:
            raise UnknownNameError("margin: classes", "source", name, found)
        found[name] = found[name]._replace(symbol=symbol)
    return found


def _add_gear_losses(
    path: Path,
    sources: dict[str, _Source],
    point: PathPoint,
    sense: float,
    driving: Sequence[str],
    delivered: float,
) -> None:
    """Replace friction of gears between drives and joint, which the travel unloads.

    A gear of efficiency eta loses (1 / eta - 1) R of a resistance R > 0 beyond it, seen from the drives; of
    one that drives, R < 0, it loses (1 - eta_back) of it.
    """
    balance = path.balance
    system = balance.static.original
    near = {place: _joints_at_input(system, place) for place in balance.meshes}
    transmitting = {
        place: one
        for place, one in balance.meshes.items()
        if path.joint not in near[place] and not near[place].isdisjoint(_joints_of(balance, driving))
    }
    losses: dict[str, float] = {}

    def loss(place: str) -> float:
        if place not in losses:
            rest = delivered
            for name, one in sources.items():
                joints = _acts_at(system, name)
                if one.symbol and name not in transmitting and not (joints and joints <= near[place]):
                    rest -= one.torque
            others = [other for other in transmitting if near[place] < near[other]]
            rest += sum(loss(other) for other in others)
            element: Any = transmitting[place].element
            share = 1.0 / element.efficiency - 1.0 if rest > 0.0 else 1.0 - element.efficiency_back
            losses[place] = share * abs(rest)
        return losses[place]

    for place in transmitting:
        unloaded = sense * float(balance.mesh_friction(point.rest.y, place) @ point.velocity)
        sources[place] = sources[place]._replace(torque=sources[place].torque - unloaded - loss(place))


def _joints_of(balance: Balance, drives: Sequence[str]) -> set[str]:
    return {str(balance.static.original.drives[name].joint) for name in drives}


def _acts_at(system: System, place: str) -> set[str]:
    """Return the joint at which a source acts; none of what acts on links."""
    joint = getattr(_element(system, place.split(" ")[0]), "joint", None)
    return set() if joint is None else {str(joint)}


def _joints_at_input(system: System, place: str) -> set[str]:
    """Return the joints on the input's side of a gear, by other gears and couplings."""
    gears: Mapping[str, Any] = system.families.get("gears", {})
    links = [{str(one.input), str(one.output)} for name, one in gears.items() if f"gears.{name}" != place]
    links += [{one.follower, leader} for one in system.couplings.values() for leader in one.leaders]
    near = {str(getattr(_element(system, place), "input"))}  # noqa: B009 - of whatever meshes
    for _ in links:
        near |= {joint for pair in links if not pair.isdisjoint(near) for joint in pair}
    return near


def _element(system: System, place: str) -> Any:
    table, _, name = place.partition(".")
    return system.families.get(table, {}).get(name)


def _class_of(system: System, place: str, factors: FactorSet) -> tuple[str, float]:
    """Return the class of a source, and its factor when it drives."""
    if place == "gravity":
        return "I", factors.inertia
    element = _element(system, place)
    if place.startswith("clearance."):
        return ("F_R", 0.0) if place.endswith(".friction") else ("S", factors.spring)
    if isinstance(element, StickingFriction | BristleFriction | JointFriction) or place.startswith("gears."):
        return "F_R", 0.0
    if isinstance(element, BoucWen | MaxwellSlip):
        return "H_Y", 0.0
    if isinstance(element, HarnessSpring) or place.startswith("forces."):
        return "H_A", 0.0
    if place.startswith("drives."):
        return "H_A", factors.motor
    return "S", factors.spring


def _torque_of(system: System, path: Path, name: str, sense: float, options: _Options) -> tuple[float, float]:
    """Return a drive's torque and its largest cogging, reduced to the function's joint."""
    drive: Any = system.drives[name]
    ratio = path.geared_rate_of(drive.joint, math.copysign(1.0, sense) * path.kinematic(path.balance.y))
    unit = "N" if system.slides(drive.joint) else "N*m"
    known = options.available.get(name, options.available.get(f"drives.{name}"))
    cogging = abs(drive.ratio * drive.cogging * ratio) if isinstance(drive, Motor) else 0.0
    if known is not None:
        return abs(quantity(known, unit, f"available[{name!r}]") * ratio), cogging
    if isinstance(drive, Motor):
        speed = quantity(options.rate, "m/s" if path.sliding else "rad/s", "rate")
        return _motor_torque(name, drive, abs(speed * ratio)) * abs(ratio), cogging
    if isinstance(drive, ConstantDrive):
        return float(drive.value) * ratio, 0.0
    if isinstance(drive, PDController) and drive.limit is not None:
        return abs(drive.limit * ratio), 0.0
    rule = f"given for drive {name!r}, whose torque is not known of itself: available = {{{name!r}: TORQUE}}"
    raise InvalidParameterError("margin", "available", rule, said="none")


def _motor_torque(name: str, motor: Motor, speed: float) -> float:
    """Return the torque of a motor at its joint, without cogging."""
    back = abs((motor.torque_constant if motor.back_emf is None else motor.back_emf) * motor.ratio * speed)
    voltage = math.inf if motor.voltage_limit is None else motor.voltage_limit
    current = math.inf if motor.current_limit is None else motor.current_limit
    if motor.mode == "voltage" and motor.value:
        voltage = min(voltage, abs(motor.value))
    elif motor.mode == "current" and motor.value:
        current = min(current, abs(motor.value))
    largest = min(current, max(voltage - back, 0.0) / motor.resistance)
    if not math.isfinite(largest):
        rule = f"given for motor {name!r}, which has neither a command nor a limit"
        raise InvalidParameterError("margin", "available", rule, said="none")
    return abs(motor.ratio) * motor.torque_constant * largest
