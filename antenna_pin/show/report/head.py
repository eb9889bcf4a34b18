"""Head of a page on runs: key numbers, with pictures beside them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from antenna_pin.analysis import (
    closure_loads,
    deviation_measures,
    drive_loads,
    impacts,
    is_round_off,
    load_statistics,
    own_numbers,
)
from antenna_pin.base.readable import readable
from antenna_pin.errors import AntennaPinError
from antenna_pin.show.report._page import (
    Embedded,
    Picture,
    PicturedTable,
    Row,
    Section,
    counts,
    quantities,
    said_of_zeros,
    words,
)
from antenna_pin.show.report._runs import ReportedRun, every, ideal_of, run_table, slides_in
from antenna_pin.show.report.joints import hardness
from antenna_pin.trajectory.quantities import TABLES

# Joints with play that have a row of their own, the hardest hit ones.
_JOINTS = 3


def key_results(
    runs: Sequence[ReportedRun],
    scales: Mapping[str, float],
    pictures: Sequence[Embedded | Picture] = (),
    own: Sequence[str] = (),
) -> Section:
    """Return the key numbers of all runs in one table with pictures.

    ``own``: functions of a run, as ``FILE.py:NAME``.
    """
    rows = [
        quantities("simulated time", [run.end for run in runs], "s"),
        *_blows(runs),
        *_deviation(runs, scales),
        *_constraints(runs, scales),
        *_stopped(runs),
        *_own(runs, own),
        quantities(
            "energy balance, error over scale",
            [run.conserved.get("energy_error_relative") for run in runs],
            "1",
            3,
        ),
    ]
    table = run_table(runs, rows, "Key numbers", "key-results")
    return Section(
        key="results",
        title="Key results",
        items=(PicturedTable(table=table, seen=tuple(pictures)),),
        meaning=said_of_zeros([table]),
    )


def _own(runs: Sequence[ReportedRun], names: Sequence[str]) -> Iterator[Row]:
    for each in zip(*(own_numbers(run.run, names) for run in runs), strict=True):
        name = each[0].name.replace("_", " ")
        yield quantities(name, [one.value for one in each], each[0].units)


def _blows(runs: Sequence[ReportedRun]) -> Iterator[Row]:
    joints = every(runs, "clearance_joint")
    if not joints:
        return
    blows: list[int | None] = []
    lost: list[float | None] = []
    for run in runs:
        play = bool(run.names("clearance_joint"))
        table = impacts(run.data) if play else None
        pairs = (
            () if table is None else zip(table["clearance_joint"].values, table["blow"].values, strict=True)
        )
        blows.append(len(set(pairs)) if play else None)
        lost.append(float(load_statistics(run.data)["joint_dissipated"].values.sum()) if play else None)
    yield counts("blows", blows)
    for joint in sorted(joints, key=lambda name: -hardness(runs, name))[:_JOINTS]:
        peaks = [hardness([run], joint) if joint in run.names("clearance_joint") else None for run in runs]
        yield quantities(f"peak force in {joint}", peaks, "N")
    yield quantities("energy lost in contacts", lost, "J")


def _deviation(runs: Sequence[ReportedRun], scales: Mapping[str, float]) -> Iterator[Row]:
    """Yield how far the joint that deviates most is from the ideal run."""
    ideal = ideal_of(runs)
    if ideal is None:
        return
    found: dict[str, dict[str, float]] = {}
    for run in runs:
        if run is ideal:
            continue
        try:
            measured = deviation_measures(run.data, ideal.data)
        except AntennaPinError:  # said in its own section
            continue
        for one in measured:
            if one.of.endswith((" angle", " position")) and not one.of.startswith("base "):
                found.setdefault(one.of, {})[run.label] = one.maximum
                units = one.units
    if not found:
        return
    of = max(found, key=lambda name: max(found[name].values()))
    values = [found[of].get(run.label) for run in runs]
    if not all(value is None or is_round_off(value, units, scales) for value in values):
        yield quantities(f"deviation of {of}", values, units, 4, scales)


def _constraints(runs: Sequence[ReportedRun], scales: Mapping[str, float]) -> Iterator[Row]:
    """Yield the largest force of a closure, and the largest effort of a drive."""
    closures = [closure_loads(run.data) if run.names("closure") else None for run in runs]
    if any(one is not None for one in closures):
        forces = [None if one is None else float(np.nanmax(one["peak_force"].values)) for one in closures]
        yield quantities("peak force of a closure", forces, "N", 4, scales)
    for name in every(runs, "drive")[:1]:
        of, slides = TABLES["drive loads"]["peak_effort"], slides_in(runs, "drive", name)
        driven = (drive_loads(run.data) if name in run.names("drive") else None for run in runs)
        efforts = [None if one is None else float(one["peak_effort"].sel(drive=name)) for one in driven]
        yield quantities(f"{of.words(slides)} of drive {name}", efforts, of.unit(slides), 4, scales)


def _stopped(runs: Sequence[ReportedRun]) -> Iterator[Row]:
    """Yield touches of stops, and when the last latch was captured."""
    summaries = [run.run.summary() if run.names("element") else {} for run in runs]
    for family, word in (("stops", "touches of stops"), ("gears", "touches of gears")):
        told = [one.get(family) for one in summaries]
        touches = [sum(int(stop.get("touches", 0)) for stop in one.values()) if one else None for one in told]
        if any(touches):
            yield counts(word, touches)
    latches = [one.get("latches") for one in summaries]
    if any(latches):
        said = []
        for one in latches:
            held = [latch["last_capture"] for latch in one.values() if latch["held_at_end"]] if one else []
            caught = [time for time in held if time is not None]
            last = f" by {readable(max(caught), 's')}" if caught else ""
            said.append(f"{len(held)} of {len(one)}{last}" if one else "")
        yield words("latched at the end", said)
