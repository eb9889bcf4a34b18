"""A scenario over one of its keys as a family of flows, and how large its orbits are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antenna_pin.analysis import quantity
from antenna_pin.base.arguments import takes
from antenna_pin.base.capacity import check_count
from antenna_pin.nonlinear.continuation import Branch, Family
from antenna_pin.nonlinear.flow import Flow, flow_of
from antenna_pin.nonlinear.surfaces import drive_period
from antenna_pin.scenario import Scenario

__all__ = ["amplitudes", "family_of"]

Array = NDArray[np.float64]

# Samples of an orbit, besides those at changes and peaks of contact.
_SAMPLES = 400


@takes()
def family_of(
    scenario: Scenario,
    parameter: str,
    *,
    period: float | None = None,
    multiple: int = 1,
    rtol: float | None = None,
) -> Family:
    """Return the flow of a scenario and the period of its orbits, for every value of one of its keys.

    Args:
        scenario: What the parameter is laid over.
        parameter: Key of the scenario, with dots, as in ``--set``; a number, in SI units.
        period: Of the drives [s]; what :func:`drive_period` says at each value if left out.
        multiple: Periods in which an orbit closes [-].
        rtol: See :func:`flow_of` [-].

    Raises:
        InvalidParameterError: The multiple is less than 1.
    """
    check_count("branch", "multiple", multiple)

    def at(value: float) -> tuple[Flow, float]:
        changed = scenario.with_overrides({parameter: value})
        flow, _ = flow_of(changed, rtol=rtol)
        return flow, multiple * (drive_period(changed) if period is None else period)

    return at


@takes()
def amplitudes(branch: Branch, family: Family, quantities: Sequence[str]) -> dict[str, tuple[Array, str]]:
    """Return half of the range of quantities over a period of each orbit of a branch, and their units.

    Each orbit is run once more; between 400 even samples, and those at changes and peaks of contact, nothing
    is seen, so that half of a smooth range is short by some 1e-5 of it.

    Args:
        branch: The branch.
        family: That it is of.
        quantities: By the names that :func:`antenna_pin.analysis.quantity` knows.

    Returns:
        By name: (points,) in the unit beside it.
    """
    found: dict[str, list[float]] = {name: [] for name in dict.fromkeys(quantities)}
    units = dict.fromkeys(found, "")
    for value, orbit in branch.points:
        flow, _ = family(value)
        run = flow.seen(orbit.start, orbit.period, _SAMPLES)
        for name in found:
            one = quantity(run, name)
            found[name].append(0.5 * float(np.ptp(one.values)))
            units[name] = one.units
    return {name: (np.array(values), units[name]) for name, values in found.items()}
