"""Rows of plain numbers for ``antenna-pin analyse``, None for missing ones."""

from __future__ import annotations

import math
from typing import Any

import xarray as xr

from antenna_pin.analysis._run import sample_times
from antenna_pin.analysis.closures import (
    closure_loads,
    coupling_loads,
    couplings_of,
    drive_loads,
    drives_of,
    effort_unit,
)
from antenna_pin.analysis.deviation import deviation_measures
from antenna_pin.analysis.elastic import elastic_motion, elastic_parts_of
from antenna_pin.analysis.impacts import blow_statistics, impact_statistics, impacts
from antenna_pin.analysis.loads import load_statistics
from antenna_pin.analysis.round_off import is_round_off, round_off_scales
from antenna_pin.analysis.settling import settling
from antenna_pin.analysis.signals import scales_of, signals
from antenna_pin.analysis.spectrum import dominant_frequencies
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory import Trajectory

_PEAKS = 3  # of a spectrum
# Fields of a settling, in the order of a row.
_SETTLING = (
    *("joint", "time", "note", "longest_gap", "share_before", "share_after", "decay_rate", "decay_r2"),
    *("decays", "driven"),
)


@takes(longest_gap="s")
def numbers_of(
    run: Trajectory, ideal: Trajectory | None = None, *, longest_gap: float | str = 1e-3
) -> dict[str, Any]:
    """Return deviation, impacts, loads, settling, loops and dominant frequencies of a run.

    Contact counts as lasting up to a ``longest_gap`` apart [s].

    Returns:
        Lists of rows by what they are of, as ``antenna-pin analyse --json`` prints them; ``notes`` tell what
        is not there, and why.

    Raises:
        FileFormatError: The result is a lean one, without series.
    """
    samples = len(sample_times(run.data, "analyse"))
    found: dict[str, Any] = {"case": run.data.attrs.get("case", ""), "outcome": run.outcome.name}
    notes = [] if run.completed else [f"the run {run.outcome.verdict}: {run.message}"]
    if samples < 2:
        notes.append("one sample: no deviation, no frequencies")
    if ideal is not None and samples > 1:
        found["deviation"] = _deviation(run, ideal, notes)
    if run.data.sizes.get("clearance_joint", 0):
        found |= _contact(run, float(longest_gap))
    else:
        notes.append("no joint with clearance: no impacts, loads and settling")
    if run.constraints:
        found |= _loops(run)
    if "elastic_part" in run.data.sizes:
        found["elastic"] = _elastic(run)
    found["frequencies"] = _frequencies(run, notes)
    return {**found, "notes": notes}


def _deviation(run: Trajectory, ideal: Trajectory, notes: list[str]) -> list[dict[str, Any]]:
    ends = [float(one.data["time"].values[-1]) for one in (run, ideal)]
    if ends[0] > ends[1]:
        notes.append(f"compared with the ideal run up to its end at {ends[1]:g} s")
    scales = round_off_scales(run.data, ideal.data)
    return [
        {
            "of": one.of,
            "units": one.units,
            "maximum": _plain(one.maximum),
            "time_of_maximum": one.time_of_maximum,
            "rms": _plain(one.rms),
            "end": _plain(one.end),
            "growth": str(one.growth),
            "round_off": is_round_off(one.maximum, one.units, scales),
        }
        for one in deviation_measures(run, ideal)
    ]


def _contact(run: Trajectory, longest_gap: float) -> dict[str, Any]:
    loads = load_statistics(run)
    joints = loads.drop_dims("contact").rename(
        {str(name): str(name).removeprefix("joint_") for name in loads if str(name).startswith("joint_")}
    )
    return {
        "impacts": _records(impact_statistics(impacts(run)), "contact"),
        "blows": _records(blow_statistics(run), "clearance_joint"),
        "loads": _records(joints, "clearance_joint")
        + _records(loads.drop_dims("clearance_joint"), "contact"),
        "settling": [
            {name: _plain(getattr(one, name)) for name in _SETTLING}
            for one in settling(run, longest_gap=longest_gap)
        ],
    }


def _elastic(run: Trajectory) -> list[dict[str, Any]]:
    about = elastic_parts_of(run)
    return [
        {**one, "units": "m" if about[one["of"]]["slides"] else "rad"}
        for one in _records(elastic_motion(run), "elastic_part")
    ]


def _frequencies(run: Trajectory, notes: list[str]) -> list[dict[str, Any]]:
    result: list[dict[str, Any]] = []
    found = signals(run)
    scales = scales_of(found.values())
    for name, one in found.items():
        try:
            peaks = dominant_frequencies(one.time, one.read, _PEAKS, scale=scales[one.units])
        except InvalidParameterError as error:
            notes.append(f"no frequencies: {error}")
            break
        result.append(
            {
                "of": name,
                "units": one.units,
                "resolution": float(peaks.attrs["resolution"]),
                "round_off": bool(peaks.attrs["round_off"]),
                "frequency": [float(x) for x in peaks["frequency"].values],
                "amplitude": [float(x) for x in peaks["amplitude"].values],
            }
        )
    return result


def _loops(run: Trajectory) -> dict[str, Any]:
    """Return residuals and loads of closures, couplings, motions and drives."""
    about, couplings = drives_of(run), couplings_of(run)
    return {
        "constraints": run.constraints,
        "closures": _records(closure_loads(run), "closure"),
        "couplings": [
            {**one, "units": "N" if couplings[one["of"]]["slides"] else "N m"}
            for one in _records(coupling_loads(run), "coupling")
        ],
        "drives": [
            {**one, "units": effort_unit(run, one["of"]), "motion": about[one["of"]]["motion"]}
            for one in _records(drive_loads(run), "drive")
        ],
    }


def _records(table: xr.Dataset, dim: str) -> list[dict[str, Any]]:
    """Return the rows of a table in plain numbers, None for NaN."""
    return [
        {"of": str(name)}
        | {
            str(column): _plain(table[column].values[k])
            if table[column].ndim == 1
            else {
                f"{p:g}": _plain(x)
                for p, x in zip(table["percent"].values, table[column].values[k], strict=True)
            }
            for column in table.data_vars
        }
        for k, name in enumerate(table[dim].values)
    ]


def _plain(value: Any) -> Any:
    """Return a value of Python's own types; None for NaN."""
    value = value.item() if hasattr(value, "item") else value
    return None if isinstance(value, float) and math.isnan(value) else value
