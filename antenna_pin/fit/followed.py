"""Where the pieces of a record start, before anything is fitted: along the record, not along one run.

With start values for its numbers a run loses the record, where the motion is chaotic soon. So a piece's start
is sought about where the piece before has come to, for a run that is near to the piece's own rows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import AntennaPinError, ScenarioError
from antenna_pin.fit.bench import Bench, Ran
from antenna_pin.fit.pieces import touching
from antenna_pin.fit.runs import Rig, rows_of, sensed
from antenna_pin.nonlinear import Chart
from antenna_pin.state import State

__all__ = ["followed"]

Array = NDArray[np.float64]

# Step of differences, in error scales; steps of a search, and the change of its sum below which it ends: it
# is a beginning, no more.
_STEP, _ROUNDS, _ROUGHLY = 1e-4, 10, 0.1


def followed(
    rig: Rig, bench: Bench, shift: float, curves: Sequence[tuple[float, float, Array, Array]], place: str
) -> tuple[str, ...]:
    """Return the state in which each piece starts but the first, as text.

    Args:
        rig: The record's test, its pieces known.
        bench: With the start values.
        shift: Of its clock [s].
        curves: Of each column gain, offset, data and noise, (rows,) each of the latter.
        place: Of the record, for messages.

    Raises:
        ScenarioError: A piece's run does not come to its end.
    """
    origins: list[str] = []
    state: State | None = None
    for piece, until in enumerate(rig.pieces[1:]):
        rows = rows_of(rig, shift, piece)
        if state is not None:
            first = int(np.searchsorted(rig.time + shift, rows[0])) if len(rows) else 0
            here = slice(first, first + len(rows))
            own = [(gain, offset, data[here], noise[here]) for gain, offset, data, noise in curves]
            state = _nearer(rig, bench, state, rows, until, own)
            origins.append(state.to_json())
        ran = bench.run(np.zeros(0), until, state and touching(state, bench.system))
        if ran.failed:
            raise ScenarioError(f"{place}: with the start values: {ran.failed}")
        state = ran.end
    return tuple(origins)


def _nearer(
    rig: Rig,
    bench: Bench,
    origin: State,
    rows: Array,
    until: float,
    curves: Sequence[tuple[float, float, Array, Array]],
) -> State:
    """Return a state next to one from which a run is near to rows of a record."""
    from scipy.optimize import least_squares

    chart = Chart(bench.system, origin)
    size = 2 * chart.ways

    def state(z: Array) -> State:
        whole = np.zeros(chart.size)
        whole[:size] = z
        return chart.state(whole)

    def run(z: Array) -> Ran | None:
        try:
            ran = bench.run(rows, until, touching(state(z), bench.system))
        except AntennaPinError:
            return None
        return None if ran.failed else ran

    def residuals(zs: Sequence[Array]) -> list[Array]:
        made = [run(z) for z in zs]
        good = [one.chunk for one in made if one is not None]
        read = iter(sensed(rig, bench, [rows] * len(good), good))
        found = []
        for z, one in zip(zs, made, strict=True):
            if one is None:
                found.append(np.full(len(curves) * len(rows) + size, np.nan))
                continue
            off = [
                (gain * values + offset - data) / noise
                for values, (gain, offset, data, noise) in zip(next(read), curves, strict=True)
            ]
            # What the rows do not tell stays: an error scale counts as a row's noise.
            found.append(np.concatenate([*off, z]))
        return found

    def slopes(z: Array) -> Array:
        found = residuals([z + sign * _STEP * one for one in np.eye(size) for sign in (1.0, -1.0)])
        table = np.column_stack(found)
        return np.nan_to_num((table[:, ::2] - table[:, 1::2]) / (2.0 * _STEP))

    here = residuals([np.zeros(size)])[0] if len(rows) and size else np.array([np.nan])
    if not np.isfinite(here).all():
        return origin

    def one(z: Array) -> Array:
        return residuals([z])[0]

    return state(least_squares(one, np.zeros(size), jac=slopes, ftol=_ROUGHLY, max_nfev=_ROUNDS).x)
