r"""Disturbance of a mechanism on its base: loads, and orders of a wheel.

A wheel disturbs its base with forces and moments at multiples of its speed, whose amplitudes rise with the
square of the speed (Masterson, Miller and Grogan 2002, J. Sound Vib. 249(3), 575-598):

.. math:: F(t) = \sum_i C_i \Omega^2 \sin(h_i \theta(t) + \alpha_i), \qquad \dot\theta = \Omega

with :math:`C_1 = U_s` of the static imbalance in the radial forces and :math:`C_1 = U_d` of the dynamic one
in the moments across the shaft. In a record at a speed all coefficients are found together by linear least
squares over the wheel's angle, so that a speed that changes, as in a run-up, does not smear them. A resonance
of the structure raises or lowers an amplitude at some speeds only: those are left out of :math:`C_i`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import AXES, RunLike, data_of, floats, sample_times
from antenna_pin.analysis.bodies import applied_wrenches, connection_loads, joint_loads, mechanism_of
from antenna_pin.analysis.spectrum import dominant_frequencies
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.mechanism import link_motion
from antenna_pin.trajectory import names_along
from antenna_pin.trajectory.columns import ROUND_OFF
from antenna_pin.trajectory.quantities import dataset_of


@takes()
def interface_loads(run: RunLike) -> xr.Dataset:
    """Return force and moment of a mechanism on its root link.

    They follow by inverse dynamics from the recorded motion: the sum over all joints that the root link
    carries, and over closures and springs between it and other links; its own inertia and weight take no
    part. On a fixed base they are what the interface has to hold, less that weight.

    Returns:
        ``force`` [N] and ``moment`` [N m] about the origin of the root link's frame, (time, axis), in its
        axes.
    """
    data = data_of(run)
    times = sample_times(data, "interface_loads")
    mechanism = mechanism_of(data)
    root = mechanism.urdf.root
    q, v, a = (floats(data[name]) for name in "qva")
    turned, motion = link_motion(mechanism, root, q, v, a)
    origin = motion[:, 0]
    loads = joint_loads(data)
    force, moment = np.zeros((len(times), 3)), np.zeros((len(times), 3))
    for joint in mechanism.urdf.robot.joints:
        if joint.parent != root or joint.name not in mechanism.joints:
            continue
        one = loads.sel(moving_joint=joint.name)
        _, of_child = link_motion(mechanism, joint.child, q, v, a)
        arm = of_child[:, 0] - origin
        passed = floats(one["force"])
        force -= passed
        moment -= floats(one["torque"]) + np.cross(arm, passed)
    beside = [
        load for kind in ("closures", "point_springs") for load in connection_loads(data, mechanism, kind)
    ]
    for link, wrench in applied_wrenches(mechanism, beside):
        if link == root:
            force += wrench[:, :3]
            moment += wrench[:, 3:] - np.cross(origin, wrench[:, :3])
    columns = {
        "force": np.einsum("nji,nj->ni", turned, force),
        "moment": np.einsum("nji,nj->ni", turned, moment),
    }
    return dataset_of("base loads", columns, {"time": times, "axis": list(AXES)}, {"base": root})


LOAD_AXES = ("fx", "fy", "fz", "mx", "my", "mz")
"""Axes of a disturbance at the interface: forces and moments."""

# Turns of a record and samples of a turn, at least; speeds, at least.
_TURNS, _SAMPLES, _SPEEDS = 2.0, 8.0, 3
# Share of the largest amplitude of an axis' kind that an order must have to be searched for.
_LEAST_SHARE = 1e-4


class SpeedRecord(NamedTuple):
    """Disturbance of a wheel while it turns about one speed."""

    angle: Array  # of the wheel, rising, (n,) [rad]
    rate: Array  # of the wheel, (n,) [rad/s]
    loads: Array  # forces, then moments, (n, 6) [N, N m]

    @property
    def speed(self) -> float:
        """Root mean square of the rate [rad/s]."""
        return float(np.sqrt(np.mean(self.rate**2)))


@takes(after="s")
def speed_records(
    run: RunLike, joint: str, *, after: float = 0.0, turns: float | None = None
) -> list[SpeedRecord]:
    """Return the disturbance at the interface of a run, cut into records of some turns.

    Args:
        run: A run with series, or its data.
        joint: Joint about which the wheel turns.
        after: Time from which the run counts [s].
        turns: Turns of a record, as for a run-up; one record of the whole run if left out.

    Raises:
        UnknownNameError: There is no such joint.
        InvalidParameterError: The wheel turns round, or too little.
    """
    data = data_of(run)
    known = names_along(data, "joint")
    if joint not in known:
        raise UnknownNameError("wheel orders", "joint", joint, known)
    times = sample_times(data, "speed_records")
    # Of two samples at one time, but for round-off, the later one.
    late = (times >= after) & (np.diff(times, append=np.inf) > 1e-12 * abs(times[-1]))
    loads = interface_loads(data)
    whole = np.concatenate([loads["force"].values, loads["moment"].values], axis=1)[late]
    one = data.sel(joint=joint)
    angle, rate = (floats(one[name])[late] for name in ("motion_angle", "motion_rate"))
    if angle.size and angle[-1] < angle[0]:
        angle, rate = -angle, -rate
    if angle.size < 2 or not (np.diff(angle) > 0.0).all():
        rule = f"of a joint that turns one way all the time, as a wheel does; {joint!r} does not"
        raise InvalidParameterError("wheel orders", "run", rule, said=f"{angle.size} samples")
    if turns is None:
        return [SpeedRecord(angle, rate, whole)]
    edges = np.arange(angle[0], angle[-1] + 1e-9, 2.0 * np.pi * turns)
    cuts = np.searchsorted(angle, edges)
    return [SpeedRecord(angle[a:b], rate[a:b], whole[a:b]) for a, b in zip(cuts[:-1], cuts[1:], strict=True)]


@takes()
def wheel_orders(
    records: Sequence[SpeedRecord],
    *,
    harmonics: Sequence[float] | None = None,
    count: int = 5,
    resonance: float = 0.25,
) -> xr.Dataset:
    """Return the orders of a wheel's disturbance: harmonics h_i, coefficients C_i, resonances.

    Harmonics that are not given are searched for: peaks of the spectra over turns that keep their order in
    most records, refined together by nonlinear least squares. A coefficient is least squares of amplitudes
    over the squares of the speeds, without the speeds that are resonant: where an amplitude over the square
    of the speed differs from its median by more than ``resonance``.

    Args:
        records: Disturbance at three speeds or more.
        harmonics: h_i; searched for if left out.
        count: Most harmonics to search for.
        resonance: Relative difference that counts as a resonance [-].

    Returns:
        Over ``order`` and ``axis`` (fx to mz): ``coefficient`` C_i [kg m] ([kg m^2] of moments) and
        ``misfit``, the root mean square of what the amplitudes differ by, over theirs [-]; with ``speed``
        [rad/s] too ``amplitude`` [N] ([N m]), ``phase`` at the wheel's angle 0 [rad] and ``resonant``.
        Over ``axis`` and ``speed``: ``rest``, the root mean square of what follows no order.
    """
    for record in records:
        _check(record)
    if len(records) < _SPEEDS:
        rule = f"{_SPEEDS} or more, at different speeds"
        raise InvalidParameterError("wheel orders", "records", rule, said=str(len(records)))
    if not resonance > 0.0:
        raise InvalidParameterError("wheel orders", "resonance", "positive", resonance)
    if harmonics is None:
        orders = _refined(records, _peak_orders(records, count))
    else:
        orders = np.sort(np.array(harmonics, dtype=float))
        if not orders.size or not (orders > 0.0).all():
            raise InvalidParameterError("wheel orders", "harmonics", "positive numbers", said=str(harmonics))
    speeds = np.array([record.speed for record in records])
    fits = [_fitted(record, orders) for record in records]
    ratio = np.stack([fit[0] for fit in fits], axis=-1)  # complex, over Omega^2, (order, axis, speed)
    amplitude = np.abs(ratio) * speeds**2
    for own in (slice(0, 3), slice(3, 6)):  # round-off of an axis without a disturbance is none
        largest = amplitude[:, own].max(initial=0.0)
        amplitude[:, own][amplitude[:, own] < ROUND_OFF * largest] = 0.0
    over = amplitude / speeds**2
    middle = np.median(over, axis=-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.maximum(over / middle, middle / over) - 1.0
    resonant = np.where(middle > 0.0, off > resonance, over > 0.0)
    weight = np.where(resonant, 0.0, 1.0)
    square = (weight * speeds**4).sum(axis=-1)
    coefficient = (weight * amplitude * speeds**2).sum(axis=-1) / np.where(square > 0.0, square, 1.0)
    left = weight * (amplitude - coefficient[..., None] * speeds**2)
    size = np.sqrt((weight * amplitude**2).sum(axis=-1))
    misfit = np.sqrt((left**2).sum(axis=-1)) / np.where(size > 0.0, size, 1.0)
    along = ("order", "axis")
    variables: dict[str, Any] = {
        "coefficient": (along, coefficient, {"units": "kg m, kg m^2", "long_name": "C_i"}),
        "misfit": (along, misfit, {"units": "1", "long_name": "misfit of C_i times the speed squared"}),
        "amplitude": ((*along, "speed"), amplitude, {"units": "N, N m", "long_name": "amplitude"}),
        "phase": ((*along, "speed"), np.angle(ratio), {"units": "rad", "long_name": "phase at angle 0"}),
        "resonant": ((*along, "speed"), resonant, {"long_name": "amplified or lowered by a resonance"}),
        "rest": (
            ("axis", "speed"),
            np.stack([fit[1] for fit in fits], axis=-1),
            {"units": "N, N m", "long_name": "root mean square of what follows no order"},
        ),
    }
    coordinates = {
        "order": ("order", orders, {"units": "1", "long_name": "harmonic of the wheel's speed"}),
        "axis": list(LOAD_AXES),
        "speed": ("speed", speeds, {"units": "rad/s", "long_name": "speed of the wheel"}),
    }
    return xr.Dataset(variables, coords=coordinates).sortby("speed")


def _check(record: SpeedRecord) -> None:
    """Refuse a record that is too short, or sampled too coarsely."""
    turns = float(record.angle[-1] - record.angle[0]) / (2.0 * np.pi) if len(record.angle) else 0.0
    if turns < _TURNS:
        rule = f"of {_TURNS:g} turns or more; take a longer run, or more turns in a record"
        raise InvalidParameterError("wheel orders", "records", rule, said=f"{turns:.3g} turns")
    if len(record.angle) < _SAMPLES * turns:
        rule = f"sampled {_SAMPLES:g} times in a turn or more: raise output.rate"
        raise InvalidParameterError("wheel orders", "records", rule, said=f"{len(record.angle) / turns:.3g}")


def _columns(record: SpeedRecord, orders: Array) -> Array:
    """Return the columns of the least squares, (n, 1 + 2 orders)."""
    turned = record.angle[:, None] * orders
    square = (record.rate**2)[:, None]
    return np.concatenate(
        [np.ones((len(turned), 1)), square * np.cos(turned), square * np.sin(turned)], axis=1
    )


def _fitted(record: SpeedRecord, orders: Array) -> tuple[Array, Array]:
    """Return complex coefficients over the square of the rate, (orders, 6), and the rest, (6,)."""
    columns = _columns(record, orders)
    sizes = np.linalg.norm(columns, axis=0)
    fit, *_ = np.linalg.lstsq(columns / sizes, record.loads, rcond=None)
    rest = record.loads - columns @ (fit / sizes[:, None])
    fit = fit[1:] / sizes[1:, None]
    count = len(orders)
    return fit[:count] - 1j * fit[count:], np.sqrt(np.mean(rest**2, axis=0))


def _peak_orders(records: Sequence[SpeedRecord], count: int) -> Array:
    """Return the orders whose peaks most records have, (k,)."""
    rows: list[tuple[float, int, float]] = []  # order, record, share of the largest of its kind
    for k, record in enumerate(records):
        spread = np.ptp(record.loads, axis=0)
        largest = np.repeat([spread[:3].max(), spread[3:].max()], 3)
        for axis in range(6):
            if spread[axis] <= _LEAST_SHARE * largest[axis]:
                continue
            peaks = dominant_frequencies(record.angle / (2.0 * np.pi), record.loads[:, axis], 2 * count)
            shares = peaks["amplitude"].values / largest[axis]
            rows += [(float(h), k, float(s)) for h, s in zip(peaks["frequency"].values, shares, strict=True)]
    turns = min(float(np.ptp(record.angle)) for record in records) / (2.0 * np.pi)
    found: list[float] = []
    for h, _, _ in sorted(rows, key=lambda row: -row[2]):
        near = [row for row in rows if abs(row[0] - h) < 1.0 / turns]
        kept = len({row[1] for row in near}) > 0.5 * len(records)
        if kept and all(abs(h - other) > 2.0 / turns for other in found):
            weights = np.array([row[2] for row in near])
            found.append(float(np.array([row[0] for row in near]) @ weights / weights.sum()))
    if not found:
        rule = "with peaks at multiples of the speed, got none; give harmonics"
        raise InvalidParameterError("wheel orders", "records", rule, said=f"{len(records)} records")
    return np.sort(found[:count])


def _refined(records: Sequence[SpeedRecord], orders: Array) -> Array:
    """Return orders that leave least of all records, forces and moments weighted alike."""
    from scipy.optimize import least_squares

    whole = np.concatenate([record.loads - record.loads.mean(axis=0) for record in records])
    sizes = [np.linalg.norm(whole[:, own]) or 1.0 for own in (slice(0, 3), slice(3, 6))]
    weights = 1.0 / np.repeat(np.array(sizes, dtype=float), 3)

    def left(trial: Array) -> Array:
        parts = []
        for record in records:
            columns = _columns(record, trial)
            columns = columns / np.linalg.norm(columns, axis=0)
            basis, _ = np.linalg.qr(columns)
            target = record.loads * weights
            parts.append((target - basis @ (basis.T @ target)).ravel())
        return np.concatenate(parts)

    turns = max(float(np.ptp(record.angle)) for record in records) / (2.0 * np.pi)
    found = least_squares(left, orders, x_scale=1.0 / turns, method="lm", xtol=1e-15, ftol=1e-15, gtol=1e-15)
    return np.asarray(found.x)
