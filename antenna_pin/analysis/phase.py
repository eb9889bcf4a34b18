"""Phase portraits: two or three quantities of a run, without its transient."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike, data_of, floats, label_of
from antenna_pin.analysis.quantity import Quantity, quantity
from antenna_pin.analysis.transients import settled
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.rules import NotNegative, Positive
from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory import Trajectory, open_table, table_attributes

_JUDGED = 4096  # even samples that the judge sees


@takes(period="s")
@dataclass(frozen=True, slots=True)
class Periods:
    """A transient of so many periods."""

    count: NotNegative  # how many, zero or more [-]
    period: Positive  # of what, positive [s]


@dataclass(frozen=True, slots=True, eq=False)
class PhasePortrait:
    """Quantities of a run over each other."""

    run: str  # what the run is called
    quantities: tuple[Quantity, ...]  # two or three of them, behind the transient
    start: float  # when the transient ends [s]
    rule: str  # how that was decided, in words

    @property
    def time(self) -> Array:
        """Sample times [s], (n,)."""
        return self.quantities[0].time

    @property
    def points(self) -> Array:
        """The portrait, (n, 2) or (n, 3), each column in the unit of its quantity."""
        return np.column_stack([one.values for one in self.quantities])


@takes()
def phase_portrait(
    run: RunLike,
    x: str,
    y: str,
    z: str | None = None,
    *,
    transient: float | Periods | Literal["judge"] | None = None,
) -> PhasePortrait:
    """Return two or three quantities of a run for a portrait, without its transient.

    The test (:func:`antenna_pin.analysis.settled`) uses 4096 even samples of the quantities. It
    needs a run of many oscillations: where half a run is transient, each of its blocks is a sixteenth of it.

    Args:
        run: A run, or its data.
        x: Name of the first quantity (:func:`antenna_pin.analysis.quantity`).
        y: Of the second.
        z: Of the third; two if left out.
        transient: What is cut: all before a time [s], a number of periods from the first sample on, or what
            the judge finds not settled; nothing if left out.

    Raises:
        UnknownNameError: The run has no such quantity.
        InvalidParameterError: A name leaves open which quantity it is; nothing is left of the run; or the
            judge finds that it has not settled.
    """
    label = label_of(data_of(run))
    every = tuple(quantity(run, name) for name in (x, y, z) if name is not None)
    time = every[0].time
    start, rule = _cut(every, label, transient)
    kept = time >= start
    if kept.sum() < 2:
        raise InvalidParameterError(
            "phase_portrait",
            "transient",
            f"over before the run ends, at {_seconds(time[-1])}",
            said=_seconds(start),
        )
    cut = tuple(one._replace(time=one.time[kept], values=one.values[kept]) for one in every)
    return PhasePortrait(label, cut, start, rule)


def _seconds(value: float) -> str:
    return f"{value:.6g} s"


def _cut(
    every: tuple[Quantity, ...], label: str, transient: float | Periods | str | None
) -> tuple[float, str]:
    """Return when the transient ends, and the rule in words."""
    time = every[0].time
    begin = float(time[0])
    if transient is None:
        return begin, "from the first sample on"
    if isinstance(transient, Periods):
        words = f"after {transient.count:g} periods of {_seconds(transient.period)}"
        return begin + transient.count * transient.period, words
    if isinstance(transient, str):
        if transient != "judge":
            raise InvalidParameterError(
                "phase_portrait", "transient", "a time [s], Periods, or 'judge'", transient
            )
        return _judged(every, label)
    if not transient >= 0.0:
        raise InvalidParameterError("phase_portrait", "transient", "a time, zero or later [s]", transient)
    return float(transient), f"from {_seconds(transient)} on, as given"


def _judged(every: tuple[Quantity, ...], label: str) -> tuple[float, str]:
    time = every[0].time
    even = np.linspace(time[0], time[-1], _JUDGED)
    found = settled(np.column_stack([np.interp(even, one.time, one.values) for one in every]))
    if found.start is None:
        raise InvalidParameterError(
            "phase_portrait",
            "transient",
            f"a time, or the run longer: {label} has not settled within {_seconds(time[-1])}"
            f" (the statistics of {' and '.join(one.name for one in every)} drift by {found.drift:.2g} of"
            " half their ranges)",
            "judge",
        )
    if found.start == 0:
        return float(time[0]), "from the first sample on, as its statistics do not drift"
    start = float(even[found.start])
    return start, f"from {_seconds(start)} on, where its statistics drift no more"


# --- as a dataset, and its file ---


@takes()
def portrait_table(portrait: PhasePortrait, run: RunLike) -> xr.Dataset:
    """Return a portrait as a dataset, which :func:`antenna_pin.trajectory.save_table` writes.

    Returns:
        Over ``sample``: ``time`` [s] and each quantity in its unit; attributes ``quantities`` (JSON, in the
        order of the axes), ``run``, ``start`` [s] and ``rule``.
    """
    data = data_of(run)
    attributes = table_attributes("portrait", run.scenario if isinstance(run, Trajectory) else None)
    # A result that was read without its scenario has its text all the same; versions are those of the run.
    for name in ("title", "case", "scenario", "versions"):
        attributes[name] = str(data.attrs.get(name) or attributes[name])
    attributes["name"] = json.loads(attributes["scenario"] or "{}").get("name", "")
    attributes |= {
        "quantities": json.dumps([one.name for one in portrait.quantities]),
        "run": portrait.run,
        "start": portrait.start,
        "rule": portrait.rule,
    }
    variables: dict[str, Any] = {
        one.name: ("sample", one.values, {"units": one.units, "long_name": one.meaning})
        for one in portrait.quantities
        if one.name != "time"
    }
    time = ("sample", portrait.time, {"units": "s", "long_name": "time"})
    return xr.Dataset(variables, coords={"time": time}, attrs=attributes)


@takes()
def portrait_of(table: xr.Dataset) -> PhasePortrait:
    """Return the portrait that a dataset holds (:func:`portrait_table`)."""
    time = floats(table["time"])
    every = tuple(
        Quantity(
            name,
            time,
            floats(table[name]),
            str(table[name].attrs["units"]),
            str(table[name].attrs["long_name"]),
        )
        for name in json.loads(table.attrs["quantities"])
    )
    attributes = table.attrs
    return PhasePortrait(str(attributes["run"]), every, float(attributes["start"]), str(attributes["rule"]))


@takes()
def open_portrait(path: str | os.PathLike[str]) -> PhasePortrait:
    """Return a portrait from its file, as ``antenna-pin phase --out`` writes it."""
    return portrait_of(open_table(path, "portrait"))
