"""Findings of a paper's figures: statements with numbers about runs, and their checks."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import xarray as xr

from antenna_pin.analysis import (
    base_motion,
    body_deviation,
    deviation,
    impacts,
    joint_loads,
    journal_motion,
    load_statistics,
    moved_body,
    settling,
    time_mean,
)
from antenna_pin.errors import AntennaPinError
from antenna_pin.show.plot._style import Array, three_digits
from antenna_pin.show.plot.papers._figure import Cases, with_unit


def deviations(cases: Cases, of: str) -> str:
    """Return the largest deviation, as of "elevation angle", of each case."""
    (_, ideal), *others = cases.items()
    parts = []
    for case, data in others:
        try:
            found = deviation(data, ideal)[of]
        except AntennaPinError as error:
            parts.append(f"{case}: {error}")
            continue
        parts.append(f"{case} {with_unit(found.maximum, found.units)} at {found.time_of_maximum:.3g} s")
    return f"largest deviation of the {of} from the ideal joint: {'; '.join(parts)}"


def of_base(cases: Cases, quantity: str) -> str:
    """Return the base's largest deviation, and the ideal run's own size."""
    ideal = base_motion(next(iter(cases.values())))
    name = "rotation" if quantity == "attitude" else quantity
    values = ideal[name].values - (ideal[name].values[0] if quantity == "position" else 0.0)
    largest = float(np.linalg.norm(values, axis=1).max())
    words = deviations(cases, f"base {quantity.replace('_', ' ')}")
    return f"{words}; the ideal run's own is up to {with_unit(largest, str(ideal[name].attrs['units']))}"


def of_joints(cases: Cases, quantity: str) -> str:
    """Return the largest deviation of every joint from the ideal run."""
    names = [str(name) for name in next(iter(cases.values()))["joint"].values]
    return ". ".join(deviations(cases, f"{name} {quantity}") for name in names)


def of_body(cases: Cases, quantity: str, joint: str) -> str:
    """Return a body's deviation from the ideal run, in all and late."""
    (_, ideal), *others = cases.items()
    body, parts = moved_body(ideal, joint), []
    for case, data in others:
        try:
            apart = body_deviation(data, ideal, body)[quantity]
        except AntennaPinError as error:
            parts.append(f"{case}: {error}")
            continue
        unit, size = str(apart.attrs["units"]), np.linalg.norm(apart.values, axis=1)
        late = _second_half(apart["time"].values)
        words = f"in the second half up to {with_unit(float(size[late].max()), unit)}"
        if quantity == "position":
            means = time_mean(apart["time"].values[late], apart.values[late])
            along = (f"{axis} {with_unit(value, unit)}" for axis, value in zip("xyz", means, strict=True))
            words += f", in the mean {', '.join(along)}"
        parts.append(f"{case} up to {with_unit(float(size.max()), unit)}, {words}")
    return f"deviation of the {body} from the ideal run: {'; '.join(parts)}"


def steady_forces(cases: Cases, joint: str) -> str:
    """Return the range of the force through a joint in each second half."""
    parts = []
    for case, data in cases.items():
        force = joint_loads(data)["force"].sel(moving_joint=joint)
        size = np.linalg.norm(force.values, axis=1)[_second_half(np.asarray(force["time"].values))]
        low, high = float(size.min()), float(size.max())
        ratio = f", ratio {three_digits(high / low)}" if low > 0.0 else ""
        parts.append(f"{case} {with_unit(low, 'N')} to {with_unit(high, 'N')}{ratio}")
    return f"force through {joint} in the second half of the run: {'; '.join(parts)}"


def _second_half(time: Array) -> slice:
    """Return the samples of the second half of a run."""
    middle = 0.5 * (float(time[0]) + float(time[-1]))
    return slice(int(np.searchsorted(time, middle)), None)


def peak_accelerations(cases: Cases, joint: str) -> str:
    """Return the largest acceleration of a joint in each case."""
    peaks = {
        case: float(np.nanmax(np.abs(data["motion_acceleration"].sel(joint=joint).values)))
        for case, data in cases.items()
    }
    return f"largest {joint} acceleration: " + "; ".join(
        f"{case} {with_unit(peak, 'rad/s^2')}" for case, peak in peaks.items()
    )


def contact_peaks(cases: Cases) -> str:
    """Return largest and mean radial and axial contact forces of each case."""
    parts = []
    for case, data in cases.items():
        loads = load_statistics(data)
        for kind in ("radial", "axial"):
            mine = [name for name in loads["contact"].values if f".{kind}" in str(name)]
            if mine:
                of_kind = loads.sel(contact=mine)
                peak, mean = float(of_kind["peak_force"].max()), float(of_kind["mean_force"].sum())
                parts.append(
                    f"{case} {kind} up to {with_unit(peak, 'N')}, mean {with_unit(mean, 'N')}, "
                    f"{int(of_kind['episodes'].sum())} contacts"
                )
    return "; ".join(parts)


def penetration(cases: Cases) -> str:
    """Return number, depth and end of the journal's impacts."""
    parts = []
    for case, data in cases.items():
        motion, rows = journal_motion(data), impacts(data)
        if not rows.sizes["impact"]:
            parts.append(f"{case}: no contact")
            continue
        deepest = int(np.argmax(rows["peak_depth"].values))
        parts.append(
            f"{case}: {rows.sizes['impact']} contacts, {_settled(data)}; "
            f"deepest {with_unit(float(rows['peak_depth'][deepest]), 'm')} at "
            f"{float(rows['peak_time'][deepest]):.3g} s, with a clearance of "
            f"{with_unit(motion.attrs['radial_clearance'], 'm')}"
        )
    return "; ".join(parts)


def _settled(data: xr.Dataset) -> str:
    """Return the start of lasting contact."""
    found = settling(data)[0]
    return f"lasting contact from {found.time:.3g} s on" if found.time is not None else "no lasting contact"


def force_ratio(cases: Cases, joint: str) -> str:
    """Return the largest force over the ideal case's, of impacts and in all."""
    (ideal, base), *others = cases.items()
    parts = []
    for case, data in others:
        settled = next((each.time for each in settling(data) if each.joint == joint), None)
        for until, words in ((settled, "while impacts last, up to"), (None, "in all, up to")):
            if until is None and words.startswith("while"):
                continue
            end = float(data["time"][-1]) if until is None else until
            ours, theirs = _largest_force(data, joint, end), _largest_force(base, joint, end)
            parts.append(
                f"{words} {end:.3g} s: {case} {with_unit(ours, 'N')}, {ideal} {with_unit(theirs, 'N')}, "
                f"{three_digits(ours / theirs)} times"
            )
    return f"largest force through {joint}: {'; '.join(parts)}"


def _largest_force(data: xr.Dataset, joint: str, until: float) -> float:
    """Return the largest force through a joint up to a time [N]."""
    force = joint_loads(data)["force"].sel(moving_joint=joint)
    held = force.values[np.asarray(force["time"].values) <= until]
    return float(np.linalg.norm(held, axis=1).max())


# --- agreement of runs with a paper's figures ---

# By how much one number has to exceed another to be seen in a figure.
_SEEN = 1.05


def rising_deviations(runs: Cases, of: str, cases: Sequence[str]) -> bool:
    """Return whether the largest deviation from the first run grows case by case."""
    ideal = next(iter(runs.values()))
    try:
        return _rises([deviation(runs[case], ideal)[of].maximum for case in cases])
    except AntennaPinError:
        return False


def rising_accelerations(runs: Cases, joint: str, cases: Sequence[str]) -> bool:
    """Return whether the largest acceleration of a joint grows from each case to the next."""
    found = (runs[case]["motion_acceleration"].sel(joint=joint).values for case in cases)
    return _rises([float(np.nanmax(np.abs(values))) for values in found])


def higher_axial_peaks(runs: Cases, case: str, than: str) -> bool:
    """Return whether one case has the higher largest axial force."""
    peaks = []
    for name in (than, case):
        loads = load_statistics(runs[name])
        axial = [one for one in loads["contact"].values if ".axial" in str(one)]
        peaks.append(float(loads["peak_force"].sel(contact=axial).max()) if axial else 0.0)
    return _rises(peaks)


def _rises(values: Sequence[float]) -> bool:
    return all(after > _SEEN * before for before, after in pairwise(values))
