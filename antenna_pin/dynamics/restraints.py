"""Elements that hold a joint which motions move: found by rank, before a run and as they come to hold."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from antenna_pin.constraints import motions_that_prescribe
from antenna_pin.dynamics.acting import acting_in
from antenna_pin.dynamics.adjust import Adjustments
from antenna_pin.dynamics.system import System
from antenna_pin.dynamics.workspace import Workspace
from antenna_pin.elements import Modal
from antenna_pin.errors import MechanismError

__all__ = ["NotFollowedError", "check_restraint", "check_restraints", "is_rigid", "prescribing"]

Array = NDArray[np.float64]


class NotFollowedError(MechanismError):
    """A motion cannot be followed: what it asks for is what no mechanism does, or its joint is held."""


def prescribing(
    workspace: Workspace, adjustments: Adjustments, t: float, y: Array, at: int, holds: Collection[str] = ()
) -> tuple[str, ...]:
    """Return the motions that prescribe the rate of a joint; none if it is free, or fixed without them.

    Args:
        workspace: The system.
        adjustments: Its elements as they are.
        t: Time [s].
        y: State [q, v, x].
        at: Place of the joint in v.
        holds: Places of elements that count too, where they hold their joints.
    """
    constraints = workspace.constraints
    if constraints is None or not constraints.plan.motions:
        return ()
    workspace.prepare_motions(t, y)
    constraints.residuals(t, y, workspace.program)
    held = [k for k, name in enumerate(constraints.plan.holds) if name in holds and adjustments.holds(name)]
    return motions_that_prescribe(constraints, at, held)


def check_restraint(
    workspace: Workspace,
    adjustments: Adjustments,
    t: float,
    y: Array,
    place: str,
    holds: Collection[str] = (),
) -> None:
    """Refuse an element that is to hold its joint, against any load, where motions move it.

    Args:
        workspace: The system.
        adjustments: Its elements as they are.
        t: Time [s].
        y: State [q, v, x].
        place: Of the element.
        holds: Places of other elements that count too, where they hold their joints.

    Raises:
        NotFollowedError: Motions move its joint.
    """
    system = workspace.system
    one = next((one for one in acting_in(system) if one.place == place), None)
    if one is None or not system.motions or not is_rigid(one.element):
        return
    joint = str(one.element.acts_at)
    at = system.mechanism.joint(joint).v.start
    motions = prescribing(workspace, adjustments, t, y, at, [name for name in holds if name != place])
    if motions:
        drives = f"drive{'s' if len(motions) > 1 else ''} {', '.join(map(repr, motions))}"
        raise NotFollowedError(
            f"{one.label}: its joint {joint!r} is held to a motion by {drives}; take one of them away, have "
            "a pd drive follow the reference, or take an element that gives way"
        )


def check_restraints(system: System, y: Array, t: float = 0.0) -> None:
    """Refuse stops and latches without give at joints that motions move, in a first state [q, v, x].

    Raises:
        NotFollowedError: There is one.
    """
    rigid = [one for one in acting_in(system) if is_rigid(one.element) and one.element.acts]
    if not rigid or not system.motions:
        return
    workspace = Workspace(system)
    adjustments = Adjustments(system, workspace.program)
    for one in rigid:
        check_restraint(workspace, adjustments, t, y, one.place)


def is_rigid(element: object) -> bool:
    """Return whether an element may hold its joint against any load."""
    return isinstance(element, Modal) and element.holds and not element.together
