"""Closures of loops and couplings in words: what they join, where, and along what."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import Rotation

from antenna_pin.analysis import closures_of, couplings_of, said_of_coupling
from antenna_pin.base.readable import number, readable
from antenna_pin.mechanism import Mechanism
from antenna_pin.report._runs import ReportedRun

__all__ = ["words_of_closures", "words_of_couplings"]


def words_of_closures(run: ReportedRun, mechanism: Mechanism) -> Iterator[tuple[str, str]]:
    """Yield each closure of a loop; those that hold a joint of the tree are said with the joints."""
    for name, closure in closures_of(run.run).items():
        if name in mechanism.joints:
            continue
        places = []
        for side in ("first", "second"):
            seven = np.array(closure[f"{side}_placement"])
            text = f"{closure[f'{side}_body']} at ({', '.join(readable(float(x), 'm') for x in seven[:3])})"
            if closure["axis"]:
                axis = Rotation.from_quat(seven[3:]).as_matrix()[:, 2]
                text += f", axis ({', '.join(number(float(x), 5) for x in _cleared(axis))})"
            places.append(text)
        yield name, f"{closure['kind']}, {closure['equations']} equations: {places[0]}; {places[1]}"


def words_of_couplings(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield each coupling: which joint follows which, and how."""
    for name, one in couplings_of(run.run).items():
        yield name, said_of_coupling(one)


def _cleared(axis: np.ndarray) -> np.ndarray:
    """Return a direction without the round-off of a quaternion."""
    return np.where(np.abs(axis) < 1e-12, 0.0, axis)
