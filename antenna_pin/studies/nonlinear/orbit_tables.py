"""Families of periodic orbits of a scenario, and orbits as datasets with their files."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.analysis import quantity
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.capacity import check_count
from antenna_pin.base.state import State
from antenna_pin.dynamics import System
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario import Scenario
from antenna_pin.studies.nonlinear.continuation import Branch
from antenna_pin.studies.nonlinear.flow import Flow, flow_of
from antenna_pin.studies.nonlinear.orbits import Orbit
from antenna_pin.studies.nonlinear.pseudo_arclength import SolutionFamily
from antenna_pin.studies.nonlinear.sections import Section, Stroboscope, drive_period
from antenna_pin.trajectory import open_table, table_attributes

# --- families of flows over a key of a scenario -------------------------------------------------------------

# Even samples of an orbit.
_SAMPLES = 400


@takes()
def family_of(
    scenario: Scenario,
    parameter: str,
    *,
    period: float | None = None,
    multiple: int = 1,
    rtol: float | None = None,
) -> SolutionFamily:
    """Return flow and period of a scenario's orbits for every value of a key.

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
def amplitudes(
    branch: Branch, family: SolutionFamily, quantities: Sequence[str]
) -> dict[str, tuple[Array, str]]:
    """Return half the range of quantities over a period of each orbit, and their units.

    Each orbit is run once more; between 400 even samples, and those at changes and peaks of contact, nothing
    is seen, so that half of a smooth range is short by some 1e-5 of it.

    Returns:
        By name: (points,) in the unit beside it.
    """
    found: dict[str, list[float]] = {name: [] for name in dict.fromkeys(quantities)}
    units = dict.fromkeys(found, "")
    for value, orbit in branch.points:
        flow, _ = family(value)
        run = flow.sampled(orbit.start, orbit.period, _SAMPLES)
        for name in found:
            one = quantity(run, name)
            found[name].append(0.5 * float(np.ptp(one.values)))
            units[name] = one.units
    return {name: (np.array(values), units[name]) for name, values in found.items()}


# --- datasets and their files -------------------------------------------------------------------------------

_STABILITY = {True: "stable", False: "unstable", None: "neutral"}
_ABOUT: dict[str, dict[str, str]] = {
    "period": {"units": "s", "long_name": "period"},
    "residual": {"units": "1", "long_name": "distance between the ends of a period, in error scales"},
    "doubt": {"units": "1", "long_name": "of the multipliers"},
    "neutral": {
        "units": "1",
        "long_name": "multipliers equal to 1 by the discrete state of lasting contacts and elements",
    },
    "stability": {"long_name": "whether neighbours come nearer: stable, unstable, neutral"},
    "onsets": {"units": "1", "long_name": "contacts that begin in a period"},
    "events": {"units": "1", "long_name": "events that happen in a period"},
    "start": {"units": "s", "long_name": "time of the section's state"},
    "state": {"long_name": "state at that time, to start from, as JSON"},
    "q": {"units": "m, rad or 1", "long_name": "configuration there, Pinocchio's order"},
    "v": {"units": "m/s or rad/s", "long_name": "generalized velocity there, body axes"},
    "multiplier_real": {"units": "1", "long_name": "Floquet multiplier, real part"},
    "multiplier_imaginary": {"units": "1", "long_name": "Floquet multiplier, imaginary part"},
    "exponent": {"units": "1/s", "long_name": "Floquet exponent, real part"},
}


def _columns(orbits: Sequence[Orbit]) -> dict[str, tuple[tuple[str, ...], Any, dict[str, str]]]:
    """Return the variables of orbits over ``point``; NaN for lacking multipliers."""
    most = max(len(one.multipliers) for one in orbits)

    def padded(rows: Sequence[Array]) -> Array:
        out = np.full((len(orbits), most), np.nan)
        for k, row in enumerate(rows):
            out[k, : len(row)] = row
        return out

    multipliers = [one.multipliers for one in orbits]
    values: dict[str, tuple[tuple[str, ...], Any]] = {
        "period": ((), [one.period for one in orbits]),
        "residual": ((), [one.residual for one in orbits]),
        "doubt": ((), [one.doubt for one in orbits]),
        "neutral": ((), [one.neutral for one in orbits]),
        "stability": ((), np.array([_STABILITY[one.stable] for one in orbits], dtype=object)),
        "onsets": ((), [one.onsets[0] for one in orbits]),
        "events": ((), [one.onsets[1] for one in orbits]),
        "start": ((), [one.start.time for one in orbits]),
        "state": ((), np.array([one.start.to_json() for one in orbits], dtype=object)),
        "q": (("configuration",), np.stack([one.start.q for one in orbits])),
        "v": (("coordinate",), np.stack([one.start.v for one in orbits])),
        "multiplier_real": (("multiplier",), padded([one.real for one in multipliers])),
        "multiplier_imaginary": (("multiplier",), padded([one.imag for one in multipliers])),
        "exponent": (("multiplier",), padded([one.exponents for one in orbits])),
    }
    return {name: (("point", *dims), of, _ABOUT[name]) for name, (dims, of) in values.items()}


def _labels(system: System, count: int) -> dict[str, Any]:
    configuration, coordinate = system.names_q, system.names_v
    ways, rates = ([_way(system, name) for name in names] for names in (configuration, coordinate))
    unit = {"long_name": "its unit"}
    return {
        "configuration": ("configuration", np.array(configuration, dtype=str)),
        "configuration_unit": ("configuration", np.array(ways, dtype=str), unit),
        "coordinate": ("coordinate", np.array(coordinate, dtype=str)),
        "coordinate_unit": ("coordinate", np.array([f"{way}/s" for way in rates], dtype=str), unit),
        "multiplier": ("multiplier", np.arange(1, count + 1), {"long_name": "the largest first"}),
    }


def _way(system: System, name: str) -> str:
    """Return the unit of a number of q, or of an integrated number of v."""
    if name in system.mechanism.joints:
        return "m" if system.mechanism.joints[name].slides else "rad"
    part = name.rpartition(".")[2]
    return "m" if part in ("x", "y", "z", "vx", "vy", "vz") else "rad" if part in ("wx", "wy", "wz") else "1"


@takes()
def orbit_table(orbit: Orbit, system: System, scenario: Scenario | None = None) -> xr.Dataset:
    """Return a periodic solution as a dataset, which :func:`antenna_pin.studies.nonlinear.save_table` writes.

    Returns:
        ``period`` [s], ``residual`` and ``doubt`` [-], ``neutral``, how many multipliers are 1 for what
        lasting contacts remember and are not among the others, ``stability`` (stable, unstable, neutral),
        ``onsets`` and ``events`` in a period [-], ``start`` [s] and ``state``, to continue from
        (:meth:`antenna_pin.base.state.State.from_json`); ``q`` over ``configuration`` and ``v`` over
        ``coordinate``, in that state; over ``multiplier``: ``multiplier_real``, ``multiplier_imaginary`` [-]
        and ``exponent`` [1/s]; ``tangent`` [-] over ``to`` and ``from``, names of its coordinates. Attributes
        ``free_period`` (0, 1) and ``iterations``.
    """
    found = xr.Dataset(_columns([orbit]), coords=_labels(system, len(orbit.multipliers))).isel(point=0)
    names = np.array(orbit.names, dtype=str)
    words = {"units": "1", "long_name": "derivative of the map over a period, in error scales"}
    tangent = xr.DataArray(orbit.tangent, {"to": names, "from": names}, ("to", "from"), attrs=words)
    return found.assign(tangent=tangent).assign_attrs(
        table_attributes("orbit", scenario), free_period=int(orbit.free_period), iterations=orbit.iterations
    )


@takes()
def branch_table(
    branch: Branch,
    system: System,
    parameter: str,
    units: str,
    scenario: Scenario | None = None,
    amplitudes: Mapping[str, tuple[Array, str]] | None = None,
) -> xr.Dataset:
    """Return a branch of periodic solutions as a dataset, which :func:`save_table` writes.

    The parameter has ``units``; amplitudes are those of :func:`amplitudes`.

    Returns:
        Over ``point``, which has the ``value`` of the parameter: what :func:`orbit_table` has of an orbit,
        without its tangent. Over ``bifurcation``: ``kind`` (fold, branch-point, flip, neimark-sacker,
        grazing), ``at`` and
        ``at_doubt`` in the unit of the parameter, and ``after``, the number of the point that it comes after,
        from 0 on. ``amplitude`` over ``quantity`` and ``point``, and ``amplitude_unit``, where amplitudes are
        given. Attributes ``parameter`` and ``message``, why it ends.
    """
    orbits = [point.orbit for point in branch.points]
    most = max(len(one.multipliers) for one in orbits)
    over = {"units": units, "long_name": parameter}
    found = branch.bifurcations
    kinds = np.array([one.kind for one in found], dtype=object)
    at = np.array([one.value for one in found], dtype=float)
    doubts = np.array([one.doubt for one in found], dtype=float)
    after = np.array([one.after for one in found], dtype=np.int64)
    columns = _columns(orbits) | {
        "kind": (("bifurcation",), kinds, {"long_name": "what happens to the branch"}),
        "at": (("bifurcation",), at, over),
        "at_doubt": (
            ("bifurcation",),
            doubts,
            {"units": units, "long_name": "half of where it is known to be"},
        ),
        "after": (("bifurcation",), after, {"units": "1", "long_name": "number of the point before it"}),
    }
    labels = _labels(system, most)
    if amplitudes:
        words = {"long_name": "half of the range over a period"}
        columns["amplitude"] = (
            ("quantity", "point"),
            np.stack([one[0] for one in amplitudes.values()]),
            words,
        )
        each = np.array([one[1] for one in amplitudes.values()], dtype=object)
        columns["amplitude_unit"] = (("quantity",), each, {"long_name": "unit of the amplitude"})
        labels["quantity"] = ("quantity", np.array(list(amplitudes), dtype=str))
    labels["value"] = ("point", np.array([point.value for point in branch.points]), over)
    about = {"parameter": parameter, "message": branch.message}
    return xr.Dataset(columns, coords=labels, attrs=table_attributes("branch", scenario) | about)


@takes()
def open_orbit(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return an :func:`orbit_table` from a file of ``antenna-pin orbit --out``."""
    return open_table(path, "orbit")


@takes()
def open_branch(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return a :func:`branch_table` from a file of ``antenna-pin orbit --over``."""
    return open_table(path, "branch")


# --- branches in a Poincaré section -------------------------------------------------------------------------

# Share of a period within which a time counts as the orbit's start [-].
_SAME = 1e-9


@takes()
def orbits_in_section(branch: xr.Dataset, section: Section, quantities: Sequence[str]) -> xr.Dataset:
    """Return a branch of periodic solutions with its points in a section.

    Each orbit continues from its start to the times of the stroboscope within its period: one of n periods
    of the drive has n points.

    Args:
        branch: Of :func:`antenna_pin.studies.nonlinear.branch_table`, of a scenario.
        section: The stroboscope of the diagram.
        quantities: By the names of :func:`antenna_pin.analysis.quantity`.

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
            seen = flow.probe(there, span)
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
    """Return the times of a stroboscope within a span from a start [s]."""
    first = int(np.ceil((start / period - section.phase) - _SAME))
    count = max(1, round(span / period))
    return [max((section.phase + first + k) * period, start) for k in range(count)]
