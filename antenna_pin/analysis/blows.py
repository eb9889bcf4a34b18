"""The blows of the joints of a run: contact episodes of the same surfaces put together."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike, data_of
from antenna_pin.analysis.impacts import impacts
from antenna_pin.base.arguments import takes
from antenna_pin.trajectory import blow_counts, names_along
from antenna_pin.trajectory.quantities import table as table_of

__all__ = ["blow_statistics", "blows"]


@takes()
def blows(run: RunLike, joint: str | None = None) -> xr.Dataset:
    """Return the table of blows of a run, in order of their onset.

    A blow is what an observer of the joint counts: from where two of its surfaces (bore and journal, or a
    flange and its face) touch while they did not, to where they part, whatever contacts take part. The two
    ends of a bore that are met at once are one blow, and so is an end that knocks while the other rests; each
    contact by itself is in :func:`antenna_pin.analysis.impacts`.

    Args:
        run: A run, or its data.
        joint: Name of a clearance joint; all of them if left out.

    Returns:
        Over ``blow``: ``onset`` [s], ``duration`` [s], ``contacts``, how many episodes it consists of,
        ``approach_speed`` [m/s] and ``peak_force`` [N], the largest of them, ``impulse`` [N s] and
        ``dissipated`` [J] in all; whether it ``ended``; labelled by ``clearance_joint`` and ``surface``,
        the kind of contact. No rows if the run has no clearance joint.
    """
    table = impacts(run, joint)
    numbers = table["blow"].values
    order = np.unique(numbers, return_index=True)[1]
    own = [table.isel(impact=np.flatnonzero(numbers == numbers[k])) for k in order]
    ends = [part["onset"].values + part["duration"].values for part in own]
    columns: dict[str, Any] = {
        "onset": [part["onset"].values.min() for part in own],
        "duration": [end.max() - part["onset"].values.min() for end, part in zip(ends, own, strict=True)],
        "contacts": [part.sizes["impact"] for part in own],
        **{name: [part[name].values.max() for part in own] for name in ("approach_speed", "peak_force")},
        **{name: [part[name].values.sum() for part in own] for name in ("impulse", "dissipated")},
    }
    columns["ended"] = np.array([part["ended"].values.all() for part in own], dtype=bool)
    labels = {
        "clearance_joint": table["clearance_joint"].values[order],
        "surface": table["surface"].values[order],
    }
    return table_of("blows", columns, labels, table.attrs)


@takes()
def blow_statistics(run: RunLike) -> xr.Dataset:
    """Return how many ``blows`` each joint with play took, all surfaces, over ``clearance_joint``."""
    data = data_of(run)
    joints = names_along(data, "clearance_joint")
    counts = blow_counts(data) if joints else {}
    own = [sum(n for name, n in counts.items() if name.rpartition(".")[0] == joint) for joint in joints]
    return table_of("blow statistics", {"blows": np.array(own, float)}, {"clearance_joint": joints})
