"""What end stops took and latches did: a row per touch, a row per change, and what each comes to."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike, data_of
from antenna_pin.base.arguments import takes
from antenna_pin.trajectory import ModeChange, Touch, elements_of, latch_changes, touches

__all__ = ["labelled_table", "latch_events", "stop_impacts", "stops_and_latches"]

_TOUCH = {
    "onset": ("s", "first touch"),
    "release": ("s", "release; NaN: still touching"),
    "approach_rate": ("rad/s", "rate into the stop at the onset (m/s)"),
    "rebound_rate": ("rad/s", "rate out of it at the release; NaN: still touching (m/s)"),
    "peak_effort": ("N m", "largest torque; infinite in a blow (a force [N])"),
    "impulse": ("N m s", "integral of the torque's size; NaN: still touching (N s)"),
    "loss": ("J", "energy lost; NaN: still touching"),
}
_CHANGE = {
    "time": ("s", "when"),
    "angle": ("rad", "of the joint (a way [m])"),
    "rate": ("rad/s", "of the joint before (m/s)"),
    "loss": ("J", "energy lost by it"),
    "impulse": ("N m s", "on the child by it (N s)"),
    "energy": ("J", "of the joint's own motion before: what a lock would take"),
}


@takes()
def stop_impacts(run: RunLike) -> xr.Dataset:
    """Return the touches of end stops of a run, in order of their onset.

    Beside :func:`antenna_pin.analysis.impacts`, which has those of contacts. A blow of a rigid stop lasts no
    time; a joint that comes to rest on one has a rebound rate once it leaves.

    Args:
        run: A run, or its data.

    Returns:
        Over ``touch``: ``onset`` and ``release`` [s], ``approach_rate`` and ``rebound_rate`` [rad/s],
        ``peak_effort`` [N m], ``impulse`` [N m s] and ``loss`` [J], in m/s, N and N s at a joint that slides;
        labelled by ``stop`` (its place) and ``side``. No rows if the run has no stop, or none was touched.
    """
    found = touches(data_of(run))
    labels = {"stop": [one.stop for one in found], "side": [one.side for one in found]}
    names = [item.name for item in fields(Touch) if item.name in _TOUCH]
    columns = {name: [getattr(one, name) for one in found] for name in names}
    return labelled_table("touch", columns, _TOUCH, labels)


@takes()
def latch_events(run: RunLike) -> xr.Dataset:
    """Return what the latches of a run captured, refused and let go, in order of time.

    Args:
        run: A run, or its data.

    Returns:
        Over ``latch_event``: ``time`` [s], ``angle`` [rad], ``rate`` [rad/s], ``loss`` [J], ``impulse``
        [N m s], ``energy`` [J], in m, m/s and N s at a joint that slides; labelled by ``latch`` (its place)
        and ``what``.
    """
    found = latch_changes(data_of(run))
    labels = {"latch": [one.element for one in found], "what": [one.what for one in found]}
    columns = {name: [getattr(one, name) for one in found] for name in ModeChange._fields if name in _CHANGE}
    return labelled_table("latch_event", columns, _CHANGE, labels)


@takes()
def stops_and_latches(run: RunLike) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the places of the stops and of the latches of a run."""
    places = elements_of(data_of(run))
    stops, latches = (tuple(one for one in places if one.startswith(of)) for of in ("stops.", "latches."))
    return stops, latches


def labelled_table(
    dimension: str,
    columns: dict[str, list[float]],
    units: dict[str, tuple[str, str]],
    labels: dict[str, list[str]],
) -> xr.Dataset:
    """Return columns of numbers over a dimension, with their units and meanings, and labels beside them."""
    count = len(next(iter(columns.values())))
    return xr.Dataset(
        {
            name: (dimension, np.array(values, dtype=float), {"units": unit, "long_name": said})
            for name, values in columns.items()
            for unit, said in [units[name]]
        },
        coords={
            dimension: np.arange(count),
            **{
                name: (dimension, np.array(values, dtype=object) if values else np.zeros(0, dtype="<U1"))
                for name, values in labels.items()
            },
        },
    )
