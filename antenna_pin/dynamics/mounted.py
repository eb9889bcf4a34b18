"""Joints on bearings, free in the tree, and preloads placed in the play of theirs."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Collection, Iterator, Mapping, Sequence

from antenna_pin.base.roots import root_between
from antenna_pin.dynamics.held import HeldKind
from antenna_pin.elements import AxialPreload, Bearing, ForceElement
from antenna_pin.errors import InvalidParameterError, MechanismError
from antenna_pin.geometry import RevoluteClearance
from antenna_pin.joints import ClearanceJoint
from antenna_pin.mechanism import Mechanism

__all__ = ["bearings_in", "kinds_about_axis", "on_bearings", "with_preloads_placed"]

Families = Mapping[str, Mapping[str, ForceElement]]


def bearings_in(families: Families) -> Iterator[tuple[str, str, Bearing]]:
    """Yield family, name and bearing of all elements that act on a journal's whole pose."""
    for table, elements in families.items():
        for name, element in elements.items():
            if isinstance(element, Bearing):
                yield table, name, element


def on_bearings(
    mechanism: Mechanism, families: Families, with_play: Collection[str], held: Collection[str]
) -> tuple[str, ...]:
    """Return the names of the joints without play that bearings carry.

    Raises:
        MechanismError: One that is not free in the tree, is held by constraint, or moves in a plane only.
        InvalidParameterError: A preload at a joint without play.
    """
    found: dict[str, None] = {}
    for _, name, bearing in bearings_in(families):
        place, joint = f"bearing {name!r}", bearing.joint
        kind = mechanism.joint(joint).kind
        if joint in held:
            raise MechanismError(
                f"{place}: joint {joint!r} is held by constraint, and a bearing would carry nothing; take "
                "the constraint or the bearing away"
            )
        if joint not in with_play and not bearing.frees:
            rule = "one with play: a preload acts between a journal and its bearing"
            raise InvalidParameterError(place, "joint", rule, joint)
        if kind != "floating":
            raise MechanismError(
                f"{place}: joint {joint!r} must be free in the model, got {kind}; build the mechanism from "
                f"urdf.variant(joints={{{joint!r}: 'free'}})"
            )
        if joint not in with_play:
            found[joint] = None
    return tuple(found)


def kinds_about_axis(held: Mapping[str, HeldKind], carried: Collection[str]) -> dict[str, HeldKind]:
    """Return what joints are that are free in the tree and have an axis, but no play, by name.

    Args:
        held: What those are held to that are held by constraint, by name.
        carried: Those on bearings.
    """
    found: dict[str, HeldKind] = {**held}
    for name in carried:
        found[name] = "revolute"
    return {name: kind for name, kind in found.items() if kind != "spherical"}


def with_preloads_placed(
    families: dict[str, dict[str, ForceElement]], clearances: Sequence[ClearanceJoint]
) -> dict[str, dict[str, ForceElement]]:
    """Return elements with preloads that know where in their joint's play their force is given."""
    with_play = {joint.name: joint for joint in clearances}
    placed = {table: dict(elements) for table, elements in families.items()}
    for table, name, one in bearings_in(families):
        if isinstance(one, AxialPreload) and one.position is None and one.joint in with_play:
            position = _position(f"bearing {name!r}", one, with_play[one.joint])
            placed[table][name] = dataclasses.replace(one, position=position)
    return placed


def _position(place: str, preload: AxialPreload, joint: ClearanceJoint) -> float:
    """Return where along the bearing's axis a preload's force is given [m]."""
    if preload.given_at == "centred":
        return 0.0
    if not isinstance(joint.geometry, RevoluteClearance) or joint.axial is None:
        rule = f"centred, for joint {joint.name!r} has no flanges; or give position"
        raise InvalidParameterError(place, "given_at", rule, preload.given_at)
    way = joint.geometry.axial_clearance
    if preload.given_at == "rest":
        way += _depth(place, preload, joint)
    return math.copysign(way, preload.force)


def _depth(place: str, preload: AxialPreload, joint: ClearanceJoint) -> float:
    """Return how deep a flange is pressed on by a preload [m]."""
    law, force = joint.axial, abs(preload.force)
    assert law is not None
    places = zip(joint.depth_limits, joint.geometry.contact_places, strict=True)
    most = min(limit for limit, of in places if of.kind == "axial")
    if not law.elastic_force(most) > force:
        rule = f"below {law.elastic_force(most):g} N, at which the flange is pressed in by {most:g} m"
        raise InvalidParameterError(place, "force", rule, preload.force)
    return root_between(lambda depth: law.elastic_force(depth) - force, 0.0, most, absolute=1e-20)
