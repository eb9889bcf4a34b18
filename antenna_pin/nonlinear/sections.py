"""Poincare sections: the points in which a motion returns to a section, once it has settled."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis.transients import LEAST, RULE, Settled, settled
from antenna_pin.base.arguments import takes
from antenna_pin.base.capacity import check_count
from antenna_pin.base.state import State
from antenna_pin.errors import InvalidParameterError
from antenna_pin.nonlinear.returns import Points, Returns
from antenna_pin.nonlinear.surfaces import Section
from antenna_pin.scenario import Scenario
from antenna_pin.simulation import Progress
from antenna_pin.trajectory import table_attributes

__all__ = ["SettledPoints", "check_counts", "poincare", "settled_points"]

Array = NDArray[np.float64]


@dataclasses.dataclass(frozen=True, slots=True)
class SettledPoints:
    """The last points of a section, and how they came about.

    Attributes:
        times: (n,) [s].
        values: (n, quantities).
        settled: Whether they have settled.
        drift: Largest of their statistics over the size of the quantities; NaN for too few [-].
        transient: Points before them [-].
        outcome: How the run ended, by name.
        message: That in words.
        end: State that the run left; None if nothing was run.
    """

    times: Array
    values: Array
    settled: bool
    drift: float
    transient: int
    outcome: str
    message: str
    end: State | None


def settled_points(
    returns: Returns, count: int, transient: int | None, most: int | None, tolerance: float
) -> SettledPoints:
    """Return the points of a section behind its transient.

    With a transient of None points are cut, half of ``count`` at a time, until those kept have settled, or
    ``most`` were made. See :func:`poincare`.
    """
    kept = Points(np.zeros(0), np.zeros((0, len(returns.quantities))))
    made = 0
    limit = (transient or 0) + count if transient is not None else max(most or 20 * count, count)
    ask = limit if transient is not None else count
    while True:
        some = returns.more(ask)
        made += len(some.times)
        kept = Points(*(np.concatenate(pair)[-count:] for pair in zip(kept, some, strict=True)))
        found = _judged(kept.values, returns.sizes, tolerance)
        if found.start == 0 or made >= limit or returns.ended:
            break
        ask = min(max(count // 2, 1), limit - made)
    whole = len(kept.times) == count and not returns.ended
    return SettledPoints(
        *kept,
        settled=found.start == 0 and whole,
        drift=found.drift,
        transient=made - len(kept.times),
        outcome=returns.outcome.name,
        message=returns.message,
        end=returns.state,
    )


def _judged(values: Array, sizes: Array, tolerance: float) -> Settled:
    """Return whether points, (n, quantities), have settled; those that are no numbers have not."""
    if not np.isfinite(values).all():
        return Settled(None, math.nan, tolerance, len(values))
    scale = np.where(sizes > 0.0, sizes, 1.0)
    return settled(values, scale=scale, tolerance=tolerance, whole=True)


@takes()
def poincare(
    scenario: Scenario,
    section: Section,
    quantities: Sequence[str],
    *,
    count: int = 100,
    transient: int | None = None,
    most: int | None = None,
    tolerance: float = 1e-4,
    start: State | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> xr.Dataset:
    """Return the points in which the motion of a scenario returns to a section.

    The run is made in stretches as long as it takes, whatever the scenario's duration, and keeps nothing but
    these points. Where they have settled is judged (:func:`antenna_pin.analysis.settled`), not assumed.

    Args:
        scenario: What to run.
        section: Once a period (:class:`Stroboscope`), or where a surface is passed (:class:`Crossing`).
        quantities: What to note, by the names that :func:`antenna_pin.analysis.quantity` knows.
        count: Points to return, at least 32 [-].
        transient: Points to cut before them; None to cut until what follows has settled [-].
        most: Points after which to stop cutting; 20 times ``count`` if left out [-].
        tolerance: A drift below this part of a quantity's largest amount is none [-].
        start: State that a run left, to start from; the scenario's start if left out. It is one of this
            scenario's system.
        progress: Called about ten times a second.

    Returns:
        Over ``point``: ``time`` [s] and each quantity. ``settled`` says whether they have settled,
        ``transient`` how many points were cut before them, ``drift`` [-] how far their statistics
        went; attributes ``rule``, ``section``, ``period`` [s], ``outcome``, ``message``,
        ``scenario`` (JSON) and ``state``, to go on from (:meth:`antenna_pin.base.state.State.from_json`); it
        is that to which the run got, behind the last point, and of a surface behind later ones too. A run
        that ended early has fewer points, and has not settled.

    Raises:
        AntennaPinError: The input is not valid.
        InvalidParameterError: Likewise; no drive has a period, or the section was never crossed.
    """
    check_counts("poincare", count, transient, most, tolerance)
    returns = Returns(scenario, section, quantities, start, progress)
    found = settled_points(returns, count, transient, most, tolerance)
    if not len(found.times):
        raise InvalidParameterError(
            "poincare",
            "section",
            "one that the motion comes to; choose another surface, direction or start, or a longer duration",
            said=f"{section.words}: {_fate(returns)}",
        )
    return _dataset(scenario, returns, found, tolerance)


def check_counts(
    place: str, count: object, transient: object, most: object, tolerance: float, fewest: int = LEAST
) -> None:
    """Refuse numbers of points that nothing can be told from."""
    for name, value, least in (("count", count, fewest), ("transient", transient, 0), ("most", most, count)):
        if value is None and name != "count":
            continue
        if isinstance(value, bool) or not isinstance(value, int) or value < least:  # type: ignore[operator]
            why = ", with fewer of which nothing can be judged" if name == "count" else ""
            raise InvalidParameterError(place, name, f"a whole number of {least} or more{why}", value)
        check_count(place, name, value, least)  # type: ignore[arg-type]
    if transient is not None and most is not None:
        raise InvalidParameterError(place, "most", "left out beside a transient", most)
    if not 0.0 <= tolerance < 1.0:
        raise InvalidParameterError(place, "tolerance", "from 0 to below 1", tolerance)


def _dataset(scenario: Scenario, returns: Returns, found: SettledPoints, tolerance: float) -> xr.Dataset:
    variables: dict[str, Any] = {
        name: ("point", found.values[:, k], {"units": returns.units[k], "long_name": returns.titles[k]})
        for k, name in enumerate(returns.quantities)
    }
    about = {"long_name": "whether the points have settled"}
    variables["settled"] = ((), found.settled, about)
    variables["transient"] = ((), found.transient, {"units": "1", "long_name": "points cut before these"})
    what = "largest drift of a statistic of the points, over the size of the quantities"
    variables["drift"] = ((), found.drift, {"units": "1", "long_name": what})
    return xr.Dataset(
        variables,
        coords={"time": ("point", found.times, {"units": "s", "long_name": "when the section is passed"})},
        attrs={
            **table_attributes("section", scenario),
            "quantities": json.dumps(returns.quantities),
            "section": returns.section.words,
            "period": returns.period,
            "rule": RULE,
            "tolerance": tolerance,
            "outcome": found.outcome,
            "message": found.message,
            "state": "" if found.end is None else found.end.to_json(),
        },
    )


def _fate(returns: Returns) -> str:
    """Return what became of a run without a point."""
    kept = "" if returns.outcome.name == "STOPPED" else f"; {returns.message}"
    return f"not once in {returns.time:.6g} s{kept}"
