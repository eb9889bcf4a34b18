"""Where the periodic solutions of a branch pass a section: what lies over a bifurcation diagram."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis import quantity
from antenna_pin.base.arguments import takes
from antenna_pin.base.state import State
from antenna_pin.errors import InvalidParameterError
from antenna_pin.nonlinear.flow import flow_of
from antenna_pin.nonlinear.surfaces import Section, Stroboscope
from antenna_pin.scenario import Scenario

__all__ = ["orbits_in_section"]

Array = NDArray[np.float64]

# Share of a period within which an instant is the start of the orbit itself [-].
_SAME = 1e-9


@takes()
def orbits_in_section(branch: xr.Dataset, section: Section, quantities: Sequence[str]) -> xr.Dataset:
    """Return a branch of periodic solutions with its points in a section, as a bifurcation diagram has them.

    Each orbit goes on from its start to the instants of the stroboscope within its period: one of n periods
    of the drive has n points.

    Args:
        branch: Of :func:`antenna_pin.nonlinear.branch_table`, of a scenario.
        section: The stroboscope of the diagram.
        quantities: By the names that :func:`antenna_pin.analysis.quantity` knows.

    Returns:
        The branch, and each quantity over ``point`` and ``pass``, with its unit; attribute ``quantities``.

    Raises:
        InvalidParameterError: The section is a surface, which an orbit may pass any number of times, or the
            branch is of a system built in Python.
    """
    if not isinstance(section, Stroboscope):
        rule = "one of a period (a surface is passed any number of times)"
        raise InvalidParameterError("orbits_in_section", "section", rule, section.words)
    if not branch.attrs["scenario"]:
        rule = "one of a scenario, not of a system built in Python"
        raise InvalidParameterError("orbits_in_section", "branch", rule, str(branch.attrs["parameter"]))
    known = Scenario.model_validate_json(branch.attrs["scenario"])
    parameter = str(branch.attrs["parameter"])
    rows: list[dict[str, list[float]]] = []
    about: dict[str, tuple[str, str]] = {}
    for number in range(branch.sizes["point"]):
        one = branch.isel(point=number)
        scenario = known.with_overrides({parameter: float(one["value"])})
        flow, _ = flow_of(scenario)
        start, span = State.from_json(str(one["state"].item())), float(one["period"])
        row: dict[str, list[float]] = {name: [] for name in quantities}
        for instant in _instants(section, section.period_in(scenario), start.time, span):
            ahead = instant - start.time
            there = flow.after(start, ahead) if ahead > _SAME * span else start
            seen = flow.glance(there, span)
            for name in quantities:
                found = quantity(seen, name)
                row[name].append(float(found.values[0]))
                about[name] = found.units, found.meaning
        rows.append(row)
    most = max(len(values) for row in rows for values in row.values())
    columns = {}
    for name in quantities:
        points = np.full((len(rows), most), np.nan)
        for k, row in enumerate(rows):
            points[k, : len(row[name])] = row[name]
        unit, meaning = about[name]
        columns[name] = (("point", "pass"), points, {"units": unit, "long_name": meaning})
    return branch.assign(columns).assign_attrs(quantities=json.dumps(list(quantities)))


def _instants(section: Stroboscope, period: float, start: float, span: float) -> list[float]:
    """Return the instants of a stroboscope from a start on, before the span is over [s]."""
    first = int(np.ceil((start / period - section.phase) - _SAME))
    count = max(1, round(span / period))
    return [max((section.phase + first + k) * period, start) for k in range(count)]
