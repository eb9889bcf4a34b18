"""How long a run spent in each contact scenario."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.errors import FileFormatError
from antenna_pin.geometry import AxialScenario, RadialScenario
from antenna_pin.trajectory import Trajectory

__all__ = ["scenario_shares"]

_NEEDED = ("radial_scenario", "axial_scenario", "touching")


def scenario_shares(run: Trajectory | xr.Dataset) -> xr.DataArray:
    """Return the share of the time that each clearance joint spent in each pair of contact scenarios.

    Contacts begin and end at samples, and each has a sample between: the file has one at every change and at
    every largest force. So the time between two samples belongs to the scenario seen at its ends; half to
    each where they differ; and not to that of an end at which the joint's contacts of the kind have just
    changed, where gaps are zero but for round-off. Where both ends are such, the number of touching contacts
    tells none, one and two points.

    Args:
        run: A run with clearance joints, or its data.

    Returns:
        Shares [-], (clearance_joint, radial, axial), labelled by the scenarios' names in lower case; they sum
        to 1 for each joint. No joint, no row, if the run has no clearance joint. A planar or spherical joint
        knows "none" and "one_point" in the bore and no axial contact.
    """
    data = run.data if isinstance(run, Trajectory) else run
    radial, axial = ([kind.name.lower() for kind in kinds] for kinds in (RadialScenario, AxialScenario))
    joints = [str(name) for name in data["clearance_joint"].values] if "clearance_joint" in data.sizes else []
    if joints:
        missing = [name for name in _NEEDED if name not in data]
        if missing:
            raise FileFormatError(f"run: no variable {missing[0]!r}; is it an antenna_pin result?")
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


def _shares(data: xr.Dataset, joint: str) -> NDArray[np.float64]:
    time = np.asarray(data["time"].values, dtype=float)
    shares = np.zeros((len(RadialScenario), len(AxialScenario)))
    ends = []
    for kind in ("radial", "axial"):
        seen = np.asarray(data[f"{kind}_scenario"].sel(clearance_joint=joint).values, dtype=int)
        names = [
            str(name)
            for name in data["contact"].values
            if str(name).rpartition(".")[0] == joint
            and str(name).rpartition(".")[2].startswith("axial") == (kind == "axial")
        ]
        ends.append(_ends(seen, np.asarray(data["touching"].sel(contact=names).values, dtype=int)))
    if time.size < 2:
        shares[ends[0][0][0], ends[1][0][0]] = 1.0
        return shares
    span = np.diff(time) / (time[-1] - time[0])
    for side in range(2):
        np.add.at(shares, (ends[0][side][: span.size], ends[1][side][: span.size]), 0.5 * span)
    return shares


def _ends(seen: NDArray[np.int_], touching: NDArray[np.int_]) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Return the scenarios at the start and at the end of every interval between samples.

    Args:
        seen: Scenario at every sample, (n,).
        touching: Whether each contact of the kind touches from a sample on, (n, contacts).
    """
    count = touching.sum(axis=1)
    if seen.size < 2:
        return seen, seen
    change = np.any(touching[1:] != touching[:-1], axis=1)
    # A contact that starts with a gap of zero changes at the first sample, too.
    starts = np.concatenate([[(count[0] > 0) and seen[0] == 0], change[:-1]])
    start = np.where(starts, np.where(change, count[:-1], seen[1:]), seen[:-1])
    end = np.where(change, np.where(starts, count[:-1], seen[:-1]), seen[1:])
    # No contact touches: none, whatever a gap of round-off at an end says.
    start[count[:-1] == 0] = 0
    end[count[:-1] == 0] = 0
    return start, end
