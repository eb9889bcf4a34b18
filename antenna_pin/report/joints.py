"""A section for each joint with play, and one for those without: motion, contacts, and what analyses find."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from antenna_pin.analysis import blocks, impacts, load_statistics, settling
from antenna_pin.report._page import (
    Beside,
    Embedded,
    Picture,
    Row,
    Section,
    Table,
    counts,
    quantities,
    said_of_zeros,
    shares_row,
)
from antenna_pin.report._runs import ReportedRun, ideal_of, labels_of
from antenna_pin.report.contacts import contact_details, every_impact

__all__ = ["base", "every", "hardest_joint", "hardness", "joint_key", "with_play", "without_play"]


def every(runs: Sequence[ReportedRun], dimension: str) -> list[str]:
    """Return the labels along a dimension of any of the runs, each once."""
    return list(dict.fromkeys(name for run in runs for name in run.names(dimension)))


def joint_key(joint: str) -> str:
    """Return the address of a joint's section in the page."""
    return f"joint-{joint}"


def hardness(runs: Sequence[ReportedRun], joint: str) -> float:
    """Return the largest force of a contact in a joint with play, of all runs [N]."""
    tables = (impacts(run.data, joint) for run in runs if joint in run.names("clearance_joint"))
    return max((float(one["peak_force"].max()) for one in tables if one.sizes["impact"]), default=0.0)


def hardest_joint(runs: Sequence[ReportedRun]) -> str | None:
    """Return the joint that a page's head shows: the hardest hit, else the first that moves; None if none."""
    hit = {name: hardness(runs, name) for name in every(runs, "clearance_joint")}
    if hit:
        return max(hit, key=lambda name: hit[name])
    return next(iter((*every(runs, "joint"), *every(runs, "sliding_joint"))), None)


def with_play(
    runs: Sequence[ReportedRun],
    joint: str,
    scales: Mapping[str, float],
    pictures: Sequence[Picture] = (),
    folded: bool = False,
) -> Section:
    """Return the section of a joint with play.

    Args:
        runs: What is reported.
        joint: Name of the joint.
        scales: Of the runs, by which numbers are zero to round-off.
        pictures: Its figures.
        folded: Whether it is shown when asked for.
    """
    touched = [run for run in runs if joint in run.names("clearance_joint")]
    rows = (*_motion(runs, joint, scales), *_contact(runs, joint), *_settled(runs, joint))
    table = Table(
        columns=("", *labels_of(runs)),
        rows=rows,
        caption="Motion and contact in numbers",
        key=joint_key(joint),
    )
    return Section(
        key=joint_key(joint),
        title=f"Joint {joint}",
        items=(
            Beside(table=table),
            *pictures,
            contact_details(touched, joint, scales),
            *every_impact(touched, joint),
        ),
        folded=folded,
        meaning=(
            "Forces, depths and speeds of contacts are the largest of the integrator's dense output, not of "
            "samples. Impulse is the integral of the normal forces over time; energy lost is that of "
            "contacts, normal and friction.",
            *said_of_zeros([table]),
        ),
    )


def beside(section: Section, close: Mapping[str, Sequence[Embedded]]) -> Section:
    """Return a section with what shows its joint close up beside its table, if it is of such a joint."""
    seen = next((tuple(made) for joint, made in close.items() if joint_key(joint) == section.key), ())
    items = (
        replace(item, seen=seen) if seen and isinstance(item, Beside) else item for item in section.items
    )
    return replace(section, items=tuple(items))


def without_play(
    runs: Sequence[ReportedRun], scales: Mapping[str, float], pictures: Sequence[Picture] = ()
) -> Section:
    """Return the section of the joints that have no play in any of the runs."""
    played = every(runs, "clearance_joint")
    rows: list[Row] = []
    for dimension in ("joint", "sliding_joint"):
        for joint in every(runs, dimension):
            if joint not in played:
                rows += [Row(f"joint {joint}"), *_motion(runs, joint, scales)]
    table = Table(
        columns=("", *labels_of(runs)), rows=tuple(rows), caption="Their motion in numbers", key="joints"
    )
    return Section(
        key="joints",
        title="Joints without play" if played else "Joints",
        items=(*([table] if rows else []), *pictures),
        meaning=said_of_zeros([table]),
    )


def _motion(runs: Sequence[ReportedRun], joint: str, scales: Mapping[str, float]) -> Iterator[Row]:
    slides = joint in every(runs, "sliding_joint")
    dimension, variable = ("sliding_joint", "slide") if slides else ("joint", "motion")
    unit = "m" if slides else "rad"

    def column(pick: Callable[[ReportedRun, int], float]) -> list[float | None]:
        return [
            pick(run, run.names(dimension).index(joint)) if joint in run.names(dimension) else None
            for run in runs
        ]

    if joint not in every(runs, dimension):
        return
    place = "position" if slides else "angle"
    ends = (
        column(lambda run, k, of=of: _last(run, f"{variable}_{of}", k))  # type: ignore[misc]
        for of in (place, "rate")
    )
    for name, values, of in zip((place, "rate"), ends, (unit, f"{unit}/s"), strict=True):
        yield quantities(f"{name} at the end", values, of, 5, scales)
    peaks = column(lambda run, k: _largest(run, f"{variable}_acceleration", k))
    yield quantities("largest acceleration", peaks, f"{unit}/s^2", scales=scales)
    ideal = ideal_of(runs)
    if ideal is not None and joint in ideal.names(dimension):
        own = peaks[list(runs).index(ideal)]
        ratios = [peak / own if peak is not None and own else None for peak in peaks]
        yield quantities("the same over the ideal joint's", ratios, "1", 3)


def _contact(runs: Sequence[ReportedRun], joint: str) -> Iterator[Row]:
    tables = [impacts(run.data, joint) if joint in run.names("clearance_joint") else None for run in runs]
    loads = [
        load_statistics(run.data, joint) if joint in run.names("clearance_joint") else None for run in runs
    ]

    def largest(name: str) -> list[float | None]:
        return [None if t is None else float(t[name].max()) if t.sizes["impact"] else 0.0 for t in tables]

    def total(name: str) -> list[float | None]:
        return [None if found is None else float(found[f"joint_{name}"].values[0]) for found in loads]

    yield counts("contacts", (None if t is None else t.sizes["impact"] for t in tables))
    yield counts("blows", (None if t is None else len(set(t["blow"].values.tolist())) for t in tables))
    yield quantities("largest normal force", largest("peak_force"), "N")
    yield quantities("greatest depth", largest("peak_depth"), "m")
    yield quantities("fastest approach", largest("approach_speed"), "m/s")
    yield quantities("impulse", total("impulse"), "N s")
    yield quantities("energy lost", total("dissipated"), "J")
    yield shares_row("share of time in contact", total("contact_share"))


def _settled(runs: Sequence[ReportedRun], joint: str) -> Iterator[Row]:
    found = [
        next(iter(settling(run.data, joint)), None) if joint in run.names("clearance_joint") else None
        for run in runs
    ]
    times = [None if one is None else one.time for one in found]
    if any(time is not None for time in times):
        yield quantities("lasting contact from", times, "s", 3)


def _last(run: ReportedRun, name: str, k: int) -> float:
    return float(run.data[name][-1, k])


def _largest(run: ReportedRun, name: str, k: int) -> float:
    return max(float(np.abs(part[name].values[:, k]).max()) for part in blocks(run.data))


# --- base ---


def base(
    runs: Sequence[ReportedRun], scales: Mapping[str, float], pictures: Sequence[Picture] = ()
) -> Section:
    """Return how far a free base went and turned."""
    items: list[Table | Picture] = []
    if any("base_position" in run.data for run in runs):
        rows = (
            quantities(
                "farthest from its start", [_moved(run, _displacement) for run in runs], "m", 4, scales
            ),
            quantities("largest turn from its start", [_moved(run, _turn) for run in runs], "rad", 4, scales),
        )
        items.append(
            Table(columns=("", *labels_of(runs)), rows=rows, caption="Motion of the base", key="base")
        )
    return Section(key="base", title="Base", items=(*items, *pictures))


def _moved(run: ReportedRun, of: Callable[[ReportedRun], float]) -> float | None:
    return of(run) if "base_position" in run.data else None


def _displacement(run: ReportedRun) -> float:
    start = run.data["base_position"][0].values
    parts = (part["base_position"].values - start for part in blocks(run.data))
    return max(float(np.linalg.norm(part, axis=1).max()) for part in parts)


def _turn(run: ReportedRun) -> float:
    x0 = run.data["base_attitude"][0].values
    return max(_largest_turn(x0, part["base_attitude"].values) for part in blocks(run.data))


def _largest_turn(x0: np.ndarray, q: np.ndarray) -> float:
    # Of q0* q the vector part is sin of half the angle; small angles keep their digits that way.
    scalar = q @ x0
    vector = (
        x0[3] * q[:, :3] - q[:, 3:] * x0[:3] - np.cross(np.broadcast_to(x0[:3], q[:, :3].shape), q[:, :3])
    )
    return float((2.0 * np.arctan2(np.linalg.norm(vector, axis=1), np.abs(scalar))).max())
