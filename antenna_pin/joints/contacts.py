"""Contacts of a joint with play in one state, for people."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["JointContacts"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class JointContacts:
    """Contacts of a clearance joint in one state; arrays per contact are in bearing axes.

    Attributes:
        gap: (contacts,) [m].
        normal: From the bearing into the journal, (contacts, 3).
        point: Point of the force, from the bearing's centre, (contacts, 3) [m]: the deepest point, except for
            a flange that presses flat under point load.
        rate: Penetration rate at the contact's point, (contacts,) [m/s].
        slip: Tangential velocity of the journal over the bearing, (contacts, 3) [m/s].
        normal_force: (contacts,) [N].
        friction_force: On the journal, (contacts, 3) [N].
        generalized_force: On the joint, in the child's axes, linear part first: (6,) or (3,) if planar [N, N
            m].
    """

    gap: Array
    normal: Array
    point: Array
    rate: Array
    slip: Array
    normal_force: Array
    friction_force: Array
    generalized_force: Array
