"""Contact scenarios of a run over time, and their shares of the time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis._run import RunLike, blocks, choose, data_of, floats, variable
from antenna_pin.analysis.journal import clearance_shapes, journal_motion
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry import AxialScenario, RadialScenario
from antenna_pin.trajectory import contact_ends, contacts_of, names_along, series
from antenna_pin.trajectory.schema import VARIABLES

# --- sliders in a guide -------------------------------------------------------------------------------------

_NAMES = ("none", "one_point", "two_points", "line", "surface")
_NONE, _ONE, _TWO, _LINE, _SURFACE = range(5)
_KINDS = ("prismatic", "cylindrical")


@takes()
def slider_scenarios(run: RunLike, joint: str | None = None) -> xr.Dataset:
    """Return the contact scenarios of a slider at the walls of its guide.

    Of a rectangular one, of each of four walls: one corner (or mouth's edge) is a point, two at one end or
    along one edge a line, three or four a surface. Of a round one, whose one wall is ``bore``: one end is a
    point, both ends are a line if the middle between them presses as well, else two points.

    Returns:
        ``scenario`` (time, wall), numbers with their names in ``flag_meanings``, and ``share`` (wall, kind)
        [-] of the time; between two samples that differ each takes half.

    Raises:
        InvalidParameterError: The run has no such joint.
    """
    data = data_of(run)
    known = [name for name, shape in clearance_shapes(data).items() if shape["kind"] in _KINDS]
    if not known:
        raise InvalidParameterError("slider_scenarios", "run", "one with a slider in a guide", "none")
    joint = choose("slider_scenarios", "slider", joint or known[0], known)[0]
    shape = clearance_shapes(data)[joint]
    names = contacts_of(data, joint)
    gaps = floats(variable(data, "gap", "slider_scenarios").sel(contact=names))
    ends = [contact_ends(data)[name] for name in names]
    if shape["kind"] == "cylindrical":
        walls, found = ["bore"], _round(data, joint, shape["dimensions"], gaps)[:, None]
    else:
        walls = ["+x", "-x", "+y", "-y"]
        found = np.stack([_flat(gaps, ends, wall) for wall in walls], axis=1)
    time = floats(data["time"])
    weights = np.zeros(time.size)
    weights[:-1] += 0.5 * np.diff(time)
    weights[1:] += 0.5 * np.diff(time)
    weights = weights / weights.sum() if weights.sum() > 0.0 else np.full(time.size, 1.0 / time.size)
    share = np.stack([[weights[column == k].sum() for k in range(len(_NAMES))] for column in found.T])
    about = {
        "units": "1",
        "long_name": "contact scenario at a wall of the guide",
        "flag_values": np.arange(len(_NAMES), dtype=np.int8),
        "flag_meanings": " ".join(_NAMES),
    }
    return xr.Dataset(
        {
            "scenario": (("time", "wall"), found.astype(np.int8), about),
            "share": (("wall", "kind"), share, {"units": "1", "long_name": "share of the time"}),
        },
        coords={"time": data["time"], "wall": walls, "kind": list(_NAMES)},
        attrs={"joint": joint},
    )


def _flat(gaps: Array, ends: list[str], wall: str) -> NDArray[np.int_]:
    """Return the scenario at a flat wall from its four corners."""
    own = [k for k, end in enumerate(ends) if end.startswith(wall)]
    signs = np.array([[1 if ends[k][n] == "+" else -1 for n in (2, 4)] for k in own])
    pressed = gaps[:, own] < 0.0
    count = pressed.sum(axis=1)
    found = np.select([count == 0, count == 1, count == 2], [_NONE, _ONE, _LINE], _SURFACE)
    opposite = np.all(pressed @ signs == 0, axis=1)  # of two: both of their signs differ
    return np.where((count == 2) & opposite, _TWO, found)


def _round(data: xr.Dataset, joint: str, size: dict[str, float], gaps: Array) -> NDArray[np.int_]:
    """Return the scenario in a round guide from both ends and the middle."""
    pressed = gaps[:, :2] < 0.0
    offset = journal_motion(data, joint)["offset"].values
    middle = np.linalg.norm(offset.mean(axis=1)[:, :2], axis=1)
    both = np.where(middle > size["bearing_radius"] - size["journal_radius"], _LINE, _TWO)
    return np.select([pressed.all(axis=1), pressed.any(axis=1)], [both, _ONE], _NONE)


# --- shares of time -----------------------------------------------------------------------------------------


@takes()
def scenario_shares(run: RunLike) -> xr.DataArray:
    """Return each clearance joint's shares of the time in pairs of contact scenarios.

    Contacts begin and end at samples, and each has a sample between: the file has one at every change and at
    every largest force. So the time between two samples belongs to the scenario seen at its ends; half to
    each where they differ; and not to that of an end at which the joint's contacts of the kind have just
    changed, where gaps are zero except for round-off. Where both ends are such, the number of touching
    contacts tells none, one and two points.

    Returns:
        Shares [-], (clearance_joint, radial, axial), labelled by the scenarios' names in lower case; they sum
        to 1 for each joint. No joint, no row, if the run has no clearance joint. A joint without flanges
        has "none" and "one_point" in the bore and no axial contact; that of a slider is any contact.
    """
    data = series(data_of(run), "scenario_shares")
    radial, axial = ([kind.name.lower() for kind in kinds] for kinds in (RadialScenario, AxialScenario))
    joints = names_along(data, "clearance_joint")
    shares = np.zeros((len(joints), len(radial), len(axial)))
    for k, joint in enumerate(joints):
        shares[k] = _shares(data, joint)
    return xr.DataArray(
        shares,
        dims=("clearance_joint", "radial", "axial"),
        coords={"clearance_joint": joints, "radial": radial, "axial": axial},
        name="scenario_share",
        attrs={"units": "1", "long_name": "share of the time in a pair of contact scenarios"},
    )


@takes()
def scenario_spans(run: RunLike, joint: str | None = None) -> xr.Dataset:
    """Return the time spans of a clearance joint in single pairs of contact scenarios.

    The time between two samples is shared as in :func:`scenario_shares`, its first half to the scenario at
    its start, and neighbours of the same pair are one span.

    Args:
        run: A run with a clearance joint, or its data.
        joint: Name of the clearance joint; the first one if left out.

    Returns:
        Over ``span``: ``start`` and ``end`` [s], each span beginning where the one before ends, and the
        scenarios ``radial`` and ``axial`` as numbers, their names in the attribute ``flag_meanings``.
    """
    data = data_of(run)
    known = names_along(data, "clearance_joint")
    if not known:
        raise InvalidParameterError("scenario_spans", "run", "one with a clearance joint", "none")
    joint = choose("scenario_spans", "clearance joint", known[0] if joint is None else joint, known)[0]
    found = [_spans(part, ends) for part, ends in _scenarios(data, joint)]
    start, until, radial, axial = (np.concatenate(columns) for columns in zip(*found, strict=True))
    start, until, radial, axial = _merged(start, until, radial, axial)

    return xr.Dataset(
        {
            "start": ("span", start, {"units": "s", "long_name": "start of the span"}),
            "end": ("span", until, {"units": "s", "long_name": "its end"}),
            "radial": ("span", radial.astype(np.int8), VARIABLES["radial_scenario"].attributes),
            "axial": ("span", axial.astype(np.int8), VARIABLES["axial_scenario"].attributes),
        },
        attrs={"joint": joint},
    )


_Ends: TypeAlias = "tuple[NDArray[np.int_], NDArray[np.int_]]"
_Spans: TypeAlias = "tuple[Array, Array, NDArray[np.int_], NDArray[np.int_]]"


def _spans(time: Array, ends: list[_Ends]) -> _Spans:
    """Return the spans of some samples: start, end, and numbers of both scenarios."""
    halves = [np.stack(pair, axis=1)[: max(time.size - 1, 1)].ravel() for pair in ends]
    middles = np.stack([time[:-1], 0.5 * (time[:-1] + time[1:])], axis=1).ravel()
    edges = np.concatenate([middles, time[-1:]]) if time.size > 1 else np.repeat(time, 3)
    lasting = np.diff(edges) > 0.0
    start, until = edges[:-1][lasting], edges[1:][lasting]
    return _merged(start, until, *(half[lasting] for half in halves))


def _merged(start: Array, until: Array, radial: NDArray[np.int_], axial: NDArray[np.int_]) -> _Spans:
    """Return spans that follow one another, neighbours of the same pair as one."""
    new = np.ones(start.size, dtype=bool)
    new[1:] = (radial[1:] != radial[:-1]) | (axial[1:] != axial[:-1])
    last = np.concatenate([np.flatnonzero(new)[1:] - 1, [start.size - 1]]) if start.size else np.zeros(0, int)
    return start[new], until[last], radial[new], axial[new]


def _shares(data: xr.Dataset, joint: str) -> Array:
    shares = np.zeros((len(RadialScenario), len(AxialScenario)))
    whole = data["time"].values[-1] - data["time"].values[0]
    for time, ends in _scenarios(data, joint):
        if time.size < 2:
            shares[ends[0][0][0], ends[1][0][0]] = 1.0
            return shares
        span = np.diff(time) / whole
        for side in range(2):
            np.add.at(shares, (ends[0][side][: span.size], ends[1][side][: span.size]), 0.5 * span)
    return shares


def _scenarios(data: xr.Dataset, joint: str) -> Iterator[tuple[Array, list[_Ends]]]:
    """Yield sample times and, radial and axial, the scenarios at both ends of every interval.

    Part by part, each from the last sample of the one before on.
    """
    for name in ("radial_scenario", "axial_scenario", "touching"):
        variable(data, name, "contact scenarios")
    names = {kind: contacts_of(data, joint, flanges=kind == "axial") for kind in ("radial", "axial")}
    # A joint without flanges knows none and one point, however many of its contacts touch.
    most = 2 if contacts_of(data, joint, flanges=True) else 1
    for number, part in enumerate(blocks(data, overlap=2)):
        ends = []
        # What has changed at a sample is told by the one before: a part has it, but not its interval again.
        begin = min(number, 1)
        for kind, own in names.items():
            seen = np.asarray(part[f"{kind}_scenario"].sel(clearance_joint=joint).values, dtype=int)
            touching = np.asarray(part["touching"].sel(contact=own).values, dtype=int)
            start, end = _ends(seen, touching, most)
            ends.append((start[begin:], end[begin:]))
        yield floats(part["time"])[begin:], ends


def _ends(scenario: NDArray[np.int_], touching: NDArray[np.int_], most: int) -> _Ends:
    """Return the scenarios at the start and at the end of every interval between samples."""
    count = np.minimum(touching.sum(axis=1), most)
    if scenario.size < 2:
        return scenario, scenario
    change = np.any(touching[1:] != touching[:-1], axis=1)
    # A contact that starts with a gap of zero changes at the first sample, too.
    starts = np.concatenate([[(count[0] > 0) and scenario[0] == 0], change[:-1]])
    start = np.where(starts, np.where(change, count[:-1], scenario[1:]), scenario[:-1])
    end = np.where(change, np.where(starts, count[:-1], scenario[:-1]), scenario[1:])
    # No contact touches: none, whatever a gap of round-off at an end says.
    start[count[:-1] == 0] = 0
    end[count[:-1] == 0] = 0
    return start, end
