"""Blows of joints: episodes of contacts that are one meeting of the same surfaces.

A pin that meets its bore along a line has a contact at each end of the bore, and both have an episode.
Between the same two surfaces of a joint (bore and journal, a flange and its face: contacts of one kind)
episodes that overlap are one blow: it begins where a contact touches while none of them did, and lasts until
none does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from antenna_pin.trajectory.read import contact_joints, contact_kinds

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["blow_counts", "blow_numbers", "surfaces"]

# Of the run's time: instants closer than that are one, for times are no finer.
_SAME_INSTANT = 1e-12


def surfaces(data: xr.Dataset) -> NDArray[np.object_]:
    """Return the surfaces that each contact of a run is between, as ``joint.kind``, (contacts,)."""
    joints, kinds = contact_joints(data), contact_kinds(data)
    return np.array([f"{joint}.{kinds[name]}" for name, joint in joints.items()], dtype=object)


def blow_numbers(data: xr.Dataset) -> NDArray[np.int64]:
    """Return of each contact episode the number of the blow that it belongs to, in order of their begin.

    Args:
        data: Of a run with contacts.
    """
    onset = np.asarray(data["onset_time"].values, dtype=float)
    release = np.asarray(data["release_time"].values, dtype=float)
    release = np.where(np.isfinite(release), release, np.inf)
    of = surfaces(data)[np.asarray(data["episode_contact"].values, dtype=int)]
    same = _SAME_INSTANT * max(1.0, float(data.attrs["end_time"]))
    numbers, begun = np.zeros(onset.size, dtype=np.int64), 0
    last: dict[str, tuple[int, float]] = {}
    for k in np.argsort(onset, kind="stable").tolist():
        number, until = last.get(of[k], (-1, -np.inf))
        if onset[k] > until + same:
            number, begun = begun, begun + 1
            until = release[k]
        numbers[k], last[of[k]] = number, (number, max(until, release[k]))
    return numbers


def blow_counts(data: xr.Dataset) -> dict[str, int]:
    """Return how many blows there were between each two surfaces, as ``joint.kind``."""
    of = surfaces(data)
    index, numbers = np.asarray(data["episode_contact"].values, dtype=int), blow_numbers(data)
    return {str(name): len(set(numbers[of[index] == name].tolist())) for name in dict.fromkeys(of)}
