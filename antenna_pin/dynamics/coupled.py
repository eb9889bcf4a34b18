"""Couplings of a system, from URDF and scenario, and default positions by them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics.constraints import Coupling, check_order, spread
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.mechanism import Mechanism

Array = NDArray[np.float64]

_ONE_AXIS = ("revolute", "continuous", "prismatic")


def couplings_of(
    mechanism: Mechanism, couplings: Mapping[str, Coupling], closure_names: Collection[str]
) -> dict[str, Coupling]:
    """Return the couplings by name: the URDF's by their followers, then those given.

    Raises:
        UnknownNameError: An unknown joint.
        MechanismError: A joint without one axis, or couplings that form a cycle.
        InvalidParameterError: A name of one of the URDF's couplings, or of a closure.
    """
    where, found = mechanism.urdf.where, {}
    for name, numbers in mechanism.urdf.mimics.items():
        place = f"{where}: <mimic> of joint {name!r}"
        if numbers["leader"] == name:
            raise MechanismError(f"{place}: must name another joint, got its own; remove it")
        found[name] = Coupling(follower=name, **numbers)
        _check(
            mechanism, place, found[name], "take the <mimic> out by mimic = false in its [mechanism.joints]"
        )
    for name, coupling in couplings.items():
        if name in found or name in closure_names:
            rule = "of another name than a joint with <mimic>, or a closure"
            raise InvalidParameterError("System", f"couplings[{name!r}]", rule, name)
        found[name] = coupling
        _check(mechanism, f"coupling {name!r}", coupling, "couple other joints")
    check_order(found)
    return found


def _check(mechanism: Mechanism, place: str, coupling: Coupling, way_out: str) -> None:
    written = {joint.name: joint.type for joint in mechanism.urdf.robot.joints}
    for role in ("follower", "leader", "second"):
        joint = getattr(coupling, role)
        if joint is None:
            continue
        if joint not in written:
            raise UnknownNameError(place, "joint", joint, written)
        kind = mechanism.joints[joint].kind if joint in mechanism.joints else "fixed"
        if kind in _ONE_AXIS or (kind == "fixed" and role != "follower"):
            continue
        rule = "joint without play can follow another" if role == "follower" else "joint can be followed"
        raise MechanismError(
            f"{place}: {role} {joint!r} is {kind} here, and only a revolute, continuous or prismatic {rule}; "
            f"{way_out}"
        )


def facts_of_couplings(mechanism: Mechanism, couplings: Mapping[str, Coupling]) -> dict[str, dict[str, Any]]:
    """Return, by coupling, its joints and numbers, and which of them slide."""
    sliding = {name for name, slot in mechanism.joints.items() if slot.slides}
    return {
        name: {
            **dataclasses.asdict(one),
            "slides": one.follower in sliding,
            "leader_slides": one.leader in sliding,
            "second_slides": one.second in sliding,
        }
        for name, one in couplings.items()
    }


def put_followers(
    mechanism: Mechanism, couplings: Collection[Coupling], q: Array, known: Mapping[str, float] | None = None
) -> None:
    """Set coupled joints in a configuration, in place.

    Args:
        mechanism: The mechanism.
        couplings: Couplings without cycles.
        q: Configuration, (nq,).
        known: Given positions of joints [rad] ([m]), which stay; if none of connected joints is known, the
            first leader is at zero.
    """
    for name, place in _coupled(mechanism, couplings, dict(known or {})):
        slot = mechanism.joint(name)
        q[slot.q] = (math.cos(place), math.sin(place)) if slot.kind == "continuous" else place


def put_follower_rates(
    mechanism: Mechanism, couplings: Collection[Coupling], v: Array, known: Mapping[str, float]
) -> None:
    """Write the rates that couplings imply into a velocity, in place.

    Known rates of joints stay [rad/s] ([m/s]); other leaders are at rest.
    """
    rated = [dataclasses.replace(one, offset=0.0) for one in couplings]
    for name, rate in _coupled(mechanism, rated, dict(known)):
        v[mechanism.joint(name).v] = rate


def _coupled(
    mechanism: Mechanism, couplings: Collection[Coupling], places: dict[str, float]
) -> Iterator[tuple[str, float]]:
    """Yield the joints that couplings determine from the known ones, with their positions (or rates)."""
    fixed = {name for one in couplings for name in one.leaders} - set(mechanism.joints)
    for one, forward in spread(couplings, {*places, *fixed}):
        second = places.get(one.second or "", 0.0)
        if forward:
            name, place = one.follower, one.led(places.get(one.leader, 0.0), second)
        else:
            name, place = one.leader, one.leading(places[one.follower], second)
        places[name] = place
        yield name, place


def fit_turns(
    mechanism: Mechanism,
    couplings: Collection[Coupling],
    y: Array,
    turn_x: Mapping[str, int],
    given_joints: Collection[str],
) -> None:
    """Set the whole turns of unlimited joints by couplings in a state, in place.

    Turned angles of y, at ``turn_x``, are correct except for whole turns, which ``given_joints`` joints keep.
    """
    x = y[mechanism.model.nq + mechanism.model.nv :]

    def place(name: str) -> float:
        if name not in mechanism.joints:
            return 0.0
        return float(x[turn_x[name]] if name in turn_x else y[mechanism.joint(name).q][0])

    exact = {name for one in couplings for name in (one.follower, *one.leaders) if name not in turn_x}
    for one, forward in spread(couplings, {*given_joints, *exact}):
        name = one.follower if forward else one.leader
        second = place(one.second or "")
        wanted = one.led(place(one.leader), second) if forward else one.leading(place(one.follower), second)
        x[turn_x[name]] += math.tau * round((wanted - place(name)) / math.tau)
