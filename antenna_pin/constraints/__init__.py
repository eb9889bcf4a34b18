"""Closed loops, couplings and motions: what joints must satisfy besides the tree, and how it is held."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.constraints.assembly import (
        Mobility,
        directions,
        find_velocity,
        least_row,
        mobility,
        redundancies,
    )
    from antenna_pin.constraints.closure import CLOSURES, OPPOSITE, Anchor, Closure, ClosureKind, Holds
    from antenna_pin.constraints.coupling import Coupling, check_order, spread
    from antenna_pin.constraints.plan import DrivenJoint, Plan, make_plan, on_body
    from antenna_pin.constraints.restraints import motions_that_prescribe, rows_that_share
    from antenna_pin.constraints.search import Unclosed, find_configuration, worst_row
    from antenna_pin.constraints.solver import Constraints

__all__ = [
    "CLOSURES",
    "OPPOSITE",
    "Anchor",
    "Closure",
    "ClosureKind",
    "Constraints",
    "Coupling",
    "DrivenJoint",
    "Holds",
    "Mobility",
    "Plan",
    "Unclosed",
    "check_order",
    "directions",
    "find_configuration",
    "find_velocity",
    "least_row",
    "make_plan",
    "mobility",
    "motions_that_prescribe",
    "rows_that_share",
    "on_body",
    "redundancies",
    "spread",
    "worst_row",
]

loaded_when_used(
    __name__,
    {
        "assembly": "Mobility directions find_velocity least_row mobility redundancies",
        "closure": "Anchor CLOSURES Closure ClosureKind Holds OPPOSITE",
        "coupling": "Coupling check_order spread",
        "plan": "DrivenJoint Plan make_plan on_body",
        "restraints": "motions_that_prescribe rows_that_share",
        "search": "Unclosed find_configuration worst_row",
        "solver": "Constraints",
    },
)
