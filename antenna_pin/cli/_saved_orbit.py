"""Orbits that were saved, to be looked at again or to go on from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from antenna_pin.cli._common import refuse

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.base.state import State
    from antenna_pin.scenario import Scenario

__all__ = ["AtOption", "begun_from", "is_saved", "saved_branch"]

AtOption = Annotated[
    int | None,
    typer.Option("--at", metavar="N", help="Which orbit of a saved branch to begin with; the first is 1."),
]


def is_saved(name: str) -> bool:
    """Whether a name is that of a file of an orbit or a branch, rather than of a scenario."""
    return name.endswith(".nc")


def saved_branch(name: str) -> xr.Dataset | None:
    """Return the branch of a file; None if it holds an orbit.

    Raises:
        FileFormatError: It is not there, or of something else.
    """
    from antenna_pin.nonlinear import open_branch
    from antenna_pin.trajectory import FORMATS, format_of

    if Path(name).is_file() and format_of(name) == FORMATS["orbit"]:
        return None
    return open_branch(name)


def begun_from(name: str, at: int | None, settings: list[str] | None) -> tuple[Scenario, State]:
    """Return the scenario of a saved orbit, with the changes of the command line, and the orbit's start.

    Raises:
        AntennaPinError: The file is not there, is of something else, or what is changed cannot be.
    """
    from antenna_pin.base.state import State
    from antenna_pin.nonlinear import open_orbit
    from antenna_pin.scenario import Scenario

    table = saved_branch(name)
    changes: dict[str, object] = {}
    if table is None:
        if at is not None:
            refuse(f"{name}: is one orbit; --at is of branches")
        table = open_orbit(name)
    else:
        count = table.sizes["point"]
        if at is None or not 1 <= at <= count:
            got = "none" if at is None else str(at)
            refuse(f"{name}: --at must be from 1 to {count}, the orbits of the branch, got {got}")
        table = table.isel(point=at - 1)
        changes[str(table.attrs["parameter"])] = float(table["value"])
    if not table.attrs["scenario"]:
        refuse(f"{name}: is of a system built in Python; go on there, from State.from_json of its state")
    known = Scenario.model_validate_json(table.attrs["scenario"])
    if changes:
        known = known.with_overrides(changes)
    if settings:
        known = known.with_overrides(settings)
    return known, State.from_json(str(table["state"].item()))
