"""Figure and report of a periodic solution, as its own."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal, cast

import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable
from antenna_pin.errors import InvalidParameterError
from antenna_pin.nonlinear import Orbit, orbit_table
from antenna_pin.plot import figure_multipliers
from antenna_pin.report import Report, report
from antenna_pin.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plotted", "reported"]


def _table(orbit: Orbit) -> xr.Dataset:
    if orbit.system is None:
        raise InvalidParameterError("orbit", "system", "that of its flow, which names its numbers", None)
    return orbit_table(orbit, orbit.system, orbit.scenario)


@takes()
def plotted(orbit: Orbit, *, width: Literal["column", "page"] = "column") -> Figure:
    """Return Floquet multipliers in the complex plane, with the unit circle.

    Args:
        orbit: The orbit.
        width: "column" (88 mm) or "page" (180 mm).
    """
    return figure_multipliers(_table(orbit), width=width)


@takes()
def reported(
    orbit: Orbit, path: str | os.PathLike[str] | None = None, *, beside: Any = (), **options: Any
) -> Report:
    """Return a report on the orbit, which shows itself in a notebook, and write it if a path is given.

    Args:
        orbit: The orbit.
        path: ``NAME.html``.
        beside: Runs and other findings in it, one or several.
        **options: Further ones of :func:`antenna_pin.report.report`: ``title``, ``figures``, ...

    Raises:
        OutputError: It cannot be written there.
    """
    if path is not None:
        check_writable(path, ".html")
    one = isinstance(beside, Trajectory | xr.Dataset) or not isinstance(beside, Iterable)
    several = [beside] if one else list(beside)
    made = report(cast("Any", [*several, _table(orbit)]), **options)
    if path is not None:
        made.save(path)
    return made
