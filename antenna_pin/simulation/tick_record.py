"""What a result has of the controllers of a run: their instants, what they noted and commanded."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from antenna_pin.simulation.ticks import Ticked

__all__ = ["labels_of_ticks", "values_of_ticks"]


def labels_of_ticks(ticked: Sequence[Ticked], lean: bool) -> dict[str, Any]:
    """Return the labels of controllers; of a result with series those of their instants too."""
    if not ticked:
        return {}
    labels: dict[str, Any] = {"sampled": [one.name for one in ticked]}
    if not lean:
        labels["tick"] = sum(len(one.times) for one in ticked)
        labels["signal"] = [f"{one.name}.{column}" for one in ticked for column in one.columns]
    return labels


def values_of_ticks(ticked: Sequence[Ticked]) -> dict[str, Any]:
    """Return the variables of controllers, their instants in the order of time."""
    if not ticked:
        return {}
    times = np.concatenate([one.times for one in ticked])
    which = np.concatenate([np.full(len(one.times), k) for k, one in enumerate(ticked)])
    signals = np.full((len(times), sum(len(one.columns) for one in ticked)), np.nan)
    row = column = 0
    for one in ticked:
        signals[row : row + len(one.times), column : column + len(one.columns)] = one.values
        row, column = row + len(one.times), column + len(one.columns)
    order = np.lexsort((which, times))
    return {
        "tick_time": times[order],
        "tick_controller": which[order].astype(np.int64),
        "tick_signal": signals[order],
        "ticks": np.array([len(one.times) for one in ticked], dtype=np.int64),
        "saturated_ticks": np.array(
            [0 if one.saturated is None else (one.values[:, one.saturated] > 0.0).sum() for one in ticked],
            dtype=np.int64,
        ),
    }
