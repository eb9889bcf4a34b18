"""Are the numbers of a result what its schema says that they may be? Looked at once, when it is loaded."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from antenna_pin.trajectory.columns import Breach, Rule
from antenna_pin.trajectory.outcome import REACHED_END
from antenna_pin.trajectory.read import contact_kinds, is_lean, names_along
from antenna_pin.trajectory.schema import TIME, variables_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["problems_of_numbers"]

_ROWS = 65536  # that are looked at at once
# What sums may be off by: of their own largest number, for the dense output of an integral, and of the
# largest in their unit, for round-off.
_OWN, _OTHER = 1e-2, 1e-9
# What a run has come to is finite, however it ended; what follows from that need not be.
_ALWAYS = {"time", "q", "v"}
_PARTS = ({"qx", "qy", "qz", "qw"}, {"cos", "sin"})
_DIRECTION = Rule(unit=True)


def problems_of_numbers(data: xr.Dataset) -> Iterator[str]:
    """Yield what of a result's numbers cannot be, in words: column, place, value and rule."""
    if "episode" in data.sizes:
        index = data["episode_contact"].values
        if index.dtype.kind not in "iu" or (index < 0).any() or (index >= data.sizes["contact"]).any():
            yield "numbers in 'episode_contact' that are of no contact"
            return
    columns = [("time", TIME)] if not is_lean(data) else []
    columns += [
        (one.name, one.rule) for one in variables_of({str(dim) for dim in data.sizes}, free_base=True)
    ]
    at_end = data.attrs["outcome"] in {one.name for one in REACHED_END}
    for name, rule in columns:
        if name not in data.variables:
            continue
        finite = at_end or name in _ALWAYS
        problems = list(_in_column(data, name, rule, finite, slice(None)))
        if problems and rule.passive:  # which contacts it binds is looked up where that matters
            problems = list(_in_column(data, name, rule, finite, _kept(data, name)))
        yield from problems
    if not is_lean(data):
        time = data["time"].values
        if len(time) > 1 and time[-1] == time[0]:
            yield f"all {len(time)} samples of 'time' at one instant, {time[0]:g} s"
        for place, part in _directions(data):
            yield from _in_column(data, "q", _DIRECTION, True, part, f"{place!r} of 'q'")


def _in_column(
    data: xr.Dataset, name: str, rule: Rule, finite: bool, part: Any, said: str = ""
) -> Iterator[str]:
    """Yield what is wrong first in a column, or in some of its columns (``part`` of its last dimension)."""
    variable, before = data[name].variable, None
    along = variable.dims[0] == "time"
    for first in range(0, max(variable.shape[0], 1) if along else 1, _ROWS):
        rows = slice(first, first + _ROWS) if along else slice(None)
        values = variable[rows].values if along else variable.values
        values = values[..., part] if not isinstance(part, slice) else values
        other = data[rule.beside].variable[rows].values if rule.beside in data.variables else None
        breach = rule.breach(
            values, before=before, other=other, slack=lambda: _slack(data, name), finite=finite
        )
        if breach is not None:
            yield f"{_told(data, name, first, breach, said)}, which must be {rule.words}"
            return
        before = values[-1] if values.size else before


def _told(data: xr.Dataset, name: str, first: int, breach: Breach, said: str) -> str:
    dim, row = str(data[name].dims[0]), first + breach.row
    at = f"{dim} {row}"
    if dim == "time":
        at = f"sample {row} (t = {float(data['time'].variable[row]):.9g} s)"
    return f"{breach.value} in {said or repr(name)} at {at}"


def _slack(data: xr.Dataset, name: str) -> float:
    """Return what the bounds of a sum may be off by: round-off of it, and of what it was made of."""
    units = data[name].attrs.get("units")
    columns = data.variables.items()
    alike = [
        one for one, column in columns if column.dtype.kind == "f" and column.attrs.get("units") == units
    ]
    return _OWN * _largest(data, name) + _OTHER * max(_largest(data, str(one)) for one in alike)


def _largest(data: xr.Dataset, name: str) -> float:
    values = np.abs(data[name].values)
    return float(values.max(initial=0.0, where=np.isfinite(values)))


def _kept(data: xr.Dataset, name: str) -> NDArray[np.intp]:
    """Return which columns of an energy that contacts or elements lose are of those that lose it for sure.

    Not those under a law of a user's, nor those at flanges, where the point that a force acts at moves along
    with the depth. Nor friction with bristles: some of its dampers put energy in, and what bristles hold by a
    load counts as lost until they give it back.
    """
    if data[name].dims[-1] == "element":
        bristles = set(names_along(data, "bristle"))
        return np.flatnonzero([one not in bristles for one in names_along(data, "element")])
    from antenna_pin.contact import (  # a room that results without contacts do not need
        FRICTION_LAWS,
        NORMAL_LAWS,
    )

    about, kinds, sure = json.loads(data.attrs["clearance_joints"]), contact_kinds(data), []
    joints = names_along(data, "contact_joint")
    for joint, contact in zip(joints, names_along(data, "contact"), strict=True):
        one = about[joint]
        laws = {law["normal_law"]["law"] for law in one["contacts"].values()}
        known = laws <= set(NORMAL_LAWS) and one["friction_law"]["law"] in FRICTION_LAWS
        sure.append(known and kinds[contact] != "axial")
    if data[name].dims[-1] == "episode":
        return np.flatnonzero(np.array(sure, dtype=bool)[data["episode_contact"].values])
    return np.flatnonzero(sure)


def _directions(data: xr.Dataset) -> Iterator[tuple[str, list[int]]]:
    """Yield where in q numbers stand that are of length 1 together, and whose they are."""
    joints = {one.get("name") for one in ElementTree.fromstring(data.attrs["urdf"]).iter("joint")}
    owners: dict[str, dict[str, int]] = {}
    for place, label in enumerate(names_along(data, "configuration")):
        owner, _, part = label.rpartition(".")
        if label not in joints:
            owners.setdefault(owner, {})[part] = place
    for owner, parts in owners.items():
        for names in _PARTS:
            if names <= set(parts):
                yield owner, sorted(parts[one] for one in names)
