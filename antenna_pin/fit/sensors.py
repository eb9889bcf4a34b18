r"""What a sensor reads of a run, before its gain and offset: from a result's samples to a column.

An accelerometer at a point r of a link, with its axis d, both in the link's axes R, reads the specific force

.. math:: f = (\mathbf{R} \mathbf{d})^T [\dot{\mathbf{v}}_P - \mathbf{g}], \quad
    \mathbf{v}_P = \mathbf{v} + \boldsymbol{\omega} \times \mathbf{R} \mathbf{r}.

Behind a filter velocity and position of the point count as well as its acceleration
(:mod:`antenna_pin.fit.filters`): of a blow between two samples they give the impulse and the time.
"""

from __future__ import annotations

import json
import math

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis import joint_loads, mechanism_of, quantity
from antenna_pin.base.directions import unit as along
from antenna_pin.base.units import quantity as in_si
from antenna_pin.errors import AntennaPinError, ScenarioError, UnknownNameError
from antenna_pin.fit.columns import ColumnSpec
from antenna_pin.fit.filters import FilterInput, filter_response, input_of_acceleration, input_of_values
from antenna_pin.mechanism import link_motion

__all__ = ["amount", "check_sensor", "instants", "noise_of", "reading", "unit_of"]

Array = NDArray[np.float64]

# Samples of a filter's input in one period of its corner: of an acceleration, whose moments between samples
# are known, and of values that are straight between samples, to (2 pi / 64)^2 / 12 = 8e-4 at the corner.
_PER_PERIOD, _PER_PERIOD_OF_VALUES = 24, 64


def unit_of(data: xr.Dataset, column: ColumnSpec, place: str) -> str:
    """Return the SI unit of what a sensor reads, or refuse one of what a run does not have.

    Args:
        data: Of a run.
        column: Of the sensor.
        place: Of the column, for messages.

    Raises:
        UnknownNameError: It is at a link or joint that is not there.
        AntennaPinError: The result has no such quantity.
    """
    if column.sensor == "accelerometer":
        _check_link(data, str(column.link), f"{place}.link")
        return "m/s^2"
    if column.sensor == "force-cell":
        if column.link is not None:
            _check_link(data, column.link, f"{place}.link")
        joints = [str(name) for name in joint_loads(data, [0])["moving_joint"].values]
        if column.joint not in joints:
            raise UnknownNameError(f"{place}.joint", "joint", str(column.joint), joints)
        return "N" if (column.load or "force") == "force" else "N m"
    try:
        return quantity(data, str(column.of)).units
    except AntennaPinError as error:
        raise ScenarioError(f"{place}.of: {error}") from None


def _check_link(data: xr.Dataset, link: str, place: str) -> None:
    links = [one.name for one in mechanism_of(data).urdf.robot.links]
    if link not in links:
        raise UnknownNameError(place, "link", link, links)


def check_sensor(column: ColumnSpec, unit: str, place: str) -> None:
    """Refuse numbers of a column that are not of its unit.

    Raises:
        ScenarioError: One is not.
    """
    for name in ("sd", "offset", "resolution"):
        value = getattr(column, name)
        relative = name == "sd" and column.compare in ("spectrum", "blows")
        if value is not None:
            amount(value, "1" if relative else unit, f"{place}.{name}")
    if column.sensor == "encoder" and not amount(column.resolution, unit, place) > 0.0:
        raise ScenarioError(f"{place}.resolution must be positive, got {column.resolution!r}")
    if column.point is not None:
        for i, value in enumerate(column.point):
            amount(value, "m", f"{place}.point[{i}]")
    if column.blows is not None:
        amount(column.blows.level, unit, f"{place}.blows.level")
        counted = {"peaks": unit, "intervals": "s", "impulses": f"{unit} s"}[column.blows.of]
        for i, edge in enumerate(column.blows.edges):
            amount(edge, counted, f"{place}.blows.edges[{i}]")


def amount(value: object, unit: str, place: str) -> float:
    """Return a number of a fit file in SI units; one without a unit is in them.

    Raises:
        ScenarioError: It is of another unit.
    """
    written = unit.replace("^", "**").replace(" ", "*")
    return in_si(value, written or "1", place)


def noise_of(column: ColumnSpec, unit: str) -> float:
    """Return the standard deviation of a row: that of the noise and, of an encoder, of its steps [SI].

    A step of size s rounds by an error that is spread evenly, of variance s^2 / 12.
    """
    noise = amount(column.sd, unit, "sd")
    if column.sensor == "encoder":
        noise = math.hypot(noise, amount(column.resolution, unit, "resolution") / math.sqrt(12.0))
    return noise


def instants(column: ColumnSpec, time: Array) -> Array:
    """Return when of a run a column has to be asked for to be read at rising times [s].

    Behind a filter these are even steps from zero on, and the last of the times.
    """
    if column.filter is None:
        return time
    count = _PER_PERIOD if column.sensor == "accelerometer" else _PER_PERIOD_OF_VALUES
    step, last = 1.0 / (count * column.filter.corner), float(time[-1])
    return np.append(np.arange(math.ceil(last / step)) * step, last)


def reading(data: xr.Dataset, column: ColumnSpec, unit: str, time: Array) -> Array:
    """Return what a sensor reads at times, (n,), before its gain and offset.

    Args:
        data: Of a run, at the :func:`instants`; behind a filter further samples in between, such as those at
            events, count too.
        column: Of the sensor.
        unit: Of what it reads.
        time: When it is read [s].
    """
    if column.filter is None:
        return _points(data, column, unit)
    if column.sensor == "accelerometer":
        given = _acceleration(data, column)
    else:
        given = input_of_values(np.asarray(data["time"].values, dtype=float), _points(data, column, unit))
    return filter_response(given, time, column.filter.corner, column.filter.order)


def _points(data: xr.Dataset, column: ColumnSpec, unit: str) -> Array:
    """Return what a sensor without a filter reads at a result's samples."""
    if column.sensor == "accelerometer":
        axes, arms, motion = _of_point(data, column)
        return np.asarray(np.einsum("ni,ni->n", axes, _of_arm(motion, arms) - _gravity(data, column)))
    if column.sensor == "force-cell":
        loads = joint_loads(data)[column.load or "force"].sel(moving_joint=column.joint).values
        direction = along(column.direction or (0.0, 0.0, 1.0))
        if column.link is None:
            return np.asarray(loads @ direction)
        axes = _motion(data, column.link)[0] @ direction
        return np.asarray(np.einsum("ni,ni->n", axes, loads))
    values = np.asarray(quantity(data, str(column.of)).values, dtype=float)
    if column.rounding == "down":  # on average half a step is still to come
        return values - 0.5 * amount(column.resolution, unit, "resolution")
    return values


def _acceleration(data: xr.Dataset, column: ColumnSpec) -> FilterInput:
    """Return the specific force between a result's samples as a filter's input."""
    axes, arms, motion = _of_point(data, column)
    velocity = motion[:, 1] + np.cross(motion[:, 2], arms)
    return input_of_acceleration(
        np.asarray(data["time"].values, dtype=float),
        axes,
        motion[:, 0] + arms,
        velocity,
        _of_arm(motion, arms),
        _gravity(data, column),
    )


def _of_arm(motion: Array, arms: Array) -> Array:
    """Return the acceleration of a point on an arm from a link's origin, (n, 3) [m/s^2]."""
    spin = motion[:, 2]
    turned: Array = np.cross(motion[:, 4], arms) + np.cross(spin, np.cross(spin, arms))
    return motion[:, 3] + turned


def _of_point(data: xr.Dataset, column: ColumnSpec) -> tuple[Array, Array, Array]:
    """Return a sensor's axis, its arm from the link's origin, (n, 3), and the link's motion: world axes."""
    attitudes, motion = _motion(data, str(column.link))
    point = [amount(value, "m", "point") for value in column.point or (0.0, 0.0, 0.0)]
    return attitudes @ along(column.direction or (0.0, 0.0, 1.0)), attitudes @ np.array(point), motion


def _motion(data: xr.Dataset, link: str) -> tuple[Array, Array]:
    q, v, a = (np.asarray(data[name].values, dtype=float) for name in "qva")
    return link_motion(mechanism_of(data), link, q, v, a)


def _gravity(data: xr.Dataset, column: ColumnSpec) -> Array:
    """Return the gravity that counts, (3,) [m/s^2]."""
    if column.gravity is False:
        return np.zeros(3)
    return np.asarray(json.loads(data.attrs["mechanism"])["gravity"], dtype=float)
