"""Is a run's start one that a system can have?"""

from __future__ import annotations

import numpy as np

from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.base.state import State, breach_of_state
from antenna_pin.dynamics import System, Workspace, acting_in, check_begins, check_restraints, first_modes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.geometry import RevoluteClearance
from antenna_pin.joints.pose_kernels import place_journal

__all__ = ["check_lengths", "check_sizes", "check_spans", "check_start"]


def check_sizes(system: System, state: State, place: str = "simulate", name: str = "start") -> None:
    """Refuse a state that no run leaves, or that is not one of this system.

    Args:
        system: The system.
        state: To go on from.
        place: Function that is passed it, for the message.
        name: Of its argument.
    """
    if not isinstance(state, State):
        raise InvalidParameterError(place, name, "a State", type(state).__name__)
    breach = breach_of_state(state)
    if breach is not None:
        raise InvalidParameterError(place, f"{name}.{breach.place}", breach.rule, breach.value)
    sizes = {"q": system.model.nq, "v": system.model.nv, "x": system.manifold.nx}
    sizes |= {"memory": len(system.contact_names)}
    for part, size in sizes.items():
        found = len(getattr(state, part))
        if found != size:
            rule = f"that of a run of this system, {size} long"
            raise InvalidParameterError(place, f"{name}.{part}", rule, found)


def check_start(system: System, y: np.ndarray) -> None:
    """Refuse an initial pose that the parts cannot have, or in which a joint moves without any inertia."""
    system.check_pose(y[: system.model.nq], "initial pose")
    first_modes(system, y)
    check_begins(system, y)
    check_restraints(system, y)
    table = np.zeros(system.rows, CONTACT)
    Workspace(system).locate(y, table)
    for joint in system.clearances:
        if isinstance(joint.geometry, RevoluteClearance):
            pose = np.zeros(1, POSE)
            place_journal(system.program, system.clearance_blocks[joint.name], y, system.model.nq, pose)
            axis = pose["axis"][0]
            if axis[2] < 0.0:
                raise InvalidParameterError(
                    "initial pose",
                    f"tilt of {joint.name}",
                    "below 90 deg; for a journal put in the other way round turn the axis in the URDF",
                    f"{np.degrees(np.arctan2(np.hypot(*axis[:2]), axis[2])):.6g} deg",
                )
    limits = [limit for joint in system.clearances for limit in joint.depth_limits]
    reasons = [reason for joint in system.clearances for reason in joint.limit_reasons]
    for name, row, limit, reason in zip(system.contact_names, table, limits, reasons, strict=False):
        if not -row.gap <= limit:
            rule = f"maximum_depth = {limit:g} m" if reason == "maximum_depth" else f"{limit:g} m ({reason})"
            raise InvalidParameterError(
                "initial pose",
                f"penetration of {name}",
                f"at most {rule}; start with the journal inside its clearance",
                float(f"{-row.gap:.6g}"),
            )


def check_lengths(system: System, y: np.ndarray) -> None:
    """Refuse a start in which a spring between points that coincide has no direction."""
    if not system.point_springs:
        return
    workspace = Workspace(system)
    for (name, spring), length in zip(system.point_springs.items(), workspace.lengths(y), strict=True):
        spring.check_length(f"spring {name!r}", length)


def check_spans(system: System, begin: float, end: float) -> None:
    """Refuse a run that goes beyond the times that an element knows of."""
    for one in acting_in(system):
        one.element.check_span(one.label, begin, end)
