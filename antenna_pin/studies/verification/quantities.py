"""Catalogue of the quantities that requirements bound."""

from __future__ import annotations

from itertools import chain

from antenna_pin.analysis import own_number
from antenna_pin.errors import UnknownNameError
from antenna_pin.scenario.requirements import RequirementSpec
from antenna_pin.studies.verification.design_quantities import design_quantities
from antenna_pin.studies.verification.quantity import Case, VerifiedQuantity
from antenna_pin.studies.verification.run_quantities import run_quantities


def _own(case: Case, spec: RequirementSpec) -> float:
    return own_number(spec.quantity, case.sources.get(spec.quantity, ""), spec.quantity, case.run)


def _all() -> dict[str, VerifiedQuantity]:
    found: dict[str, VerifiedQuantity] = {}
    for one in chain(run_quantities(), design_quantities()):
        found.setdefault(one.name, one)
    return found


#: Quantities of requirements by name.
QUANTITIES: dict[str, VerifiedQuantity] = _all()


def quantity_of(spec: RequirementSpec, place: str) -> VerifiedQuantity:
    """Return the quantity of a requirement.

    Args:
        spec: The requirement.
        place: Place of the requirement, for messages.

    Raises:
        UnknownNameError: The quantity is unknown.
        ScenarioError: A key is given that the quantity does not take.
    """
    if ":" in spec.quantity:
        found = VerifiedQuantity(
            spec.quantity, spec.units, f"function {spec.quantity}", "functional", "", _own, ("units",)
        )
    elif spec.quantity in QUANTITIES:
        found = QUANTITIES[spec.quantity]
    else:
        raise UnknownNameError(f"{place}.quantity", "quantity", spec.quantity, QUANTITIES)
    found.refuse_options(place, spec)
    return found
