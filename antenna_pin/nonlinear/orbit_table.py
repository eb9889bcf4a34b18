"""Periodic solutions and branches of them as labelled datasets, and their files."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.dynamics import System
from antenna_pin.nonlinear.continuation import Branch
from antenna_pin.nonlinear.orbits import Orbit
from antenna_pin.scenario import Scenario
from antenna_pin.trajectory import open_table, table_attributes

__all__ = ["branch_table", "open_branch", "open_orbit", "orbit_table"]

Array = NDArray[np.float64]

_STABILITY = {True: "stable", False: "unstable", None: "neutral"}
_ABOUT: dict[str, dict[str, str]] = {
    "period": {"units": "s", "long_name": "period"},
    "residual": {"units": "1", "long_name": "distance between the ends of a period, in error scales"},
    "doubt": {"units": "1", "long_name": "of the multipliers"},
    "neutral": {
        "units": "1",
        "long_name": "multipliers that are 1 for what lasting contacts and elements keep",
    },
    "stability": {"long_name": "whether neighbours come nearer: stable, unstable, neutral"},
    "onsets": {"units": "1", "long_name": "contacts that begin in a period"},
    "events": {"units": "1", "long_name": "events that happen in a period"},
    "start": {"units": "s", "long_name": "time of the state that it is told by"},
    "state": {"long_name": "that state, to go on from, as JSON"},
    "q": {"units": "m, rad or 1", "long_name": "configuration there, Pinocchio's order"},
    "v": {"units": "m/s or rad/s", "long_name": "generalized velocity there, body axes"},
    "multiplier_real": {"units": "1", "long_name": "Floquet multiplier, real part"},
    "multiplier_imaginary": {"units": "1", "long_name": "Floquet multiplier, imaginary part"},
    "exponent": {"units": "1/s", "long_name": "Floquet exponent, real part"},
}


def _columns(orbits: Sequence[Orbit]) -> dict[str, tuple[tuple[str, ...], Any, dict[str, str]]]:
    """Return the variables of orbits over ``point``; NaN where one has fewer multipliers than others."""
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
    """Return the unit of the way of a number of q or v."""
    if name in system.mechanism.joints:
        return "m" if system.mechanism.joints[name].kind == "prismatic" else "rad"
    part = name.rpartition(".")[2]
    return "m" if part in ("x", "y", "z", "vx", "vy", "vz") else "rad" if part in ("wx", "wy", "wz") else "1"


@takes()
def orbit_table(orbit: Orbit, system: System, scenario: Scenario | None = None) -> xr.Dataset:
    """Return a periodic solution as a dataset, which :func:`antenna_pin.nonlinear.save_table` writes.

    Args:
        orbit: The orbit.
        system: Of the flow that it is of: it names the numbers.
        scenario: What that was made from; None for a system built in Python.

    Returns:
        ``period`` [s], ``residual`` and ``doubt`` [-], ``neutral``, how many multipliers are 1 for what
        lasting contacts remember and are not among the others, ``stability`` (stable, unstable, neutral),
        ``onsets`` and ``events`` in a period [-], ``start`` [s] and ``state``, to go on from
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
        table_attributes("orbit", scenario),
        free_period=int(orbit.free_period),
        iterations=orbit.iterations,
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

    Args:
        branch: The branch.
        system: Of any of its flows: it names the numbers.
        parameter: What was changed.
        units: Its unit.
        scenario: What the parameter is laid over; None for systems built in Python.
        amplitudes: Half of the range over a period of quantities, (points,), and their units, by name.

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
    """Return a periodic solution from its file, as ``antenna-pin orbit --out`` writes it.

    Returns:
        See :func:`orbit_table`.

    Raises:
        FileFormatError: It is none, or damaged.
    """
    return open_table(path, "orbit")


@takes()
def open_branch(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return a branch of periodic solutions from its file, as ``antenna-pin orbit --over --out`` writes it.

    Returns:
        See :func:`branch_table`.

    Raises:
        FileFormatError: It is none, or damaged.
    """
    return open_table(path, "branch")
