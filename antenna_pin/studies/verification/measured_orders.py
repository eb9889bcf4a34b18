"""Orders of a wheel's disturbance, measured in runs at several speeds."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import xarray as xr

from antenna_pin.analysis import SpeedRecord, speed_records, wheel_orders
from antenna_pin.base.arguments import takes
from antenna_pin.base.interruption import uninterrupted
from antenna_pin.errors import InvalidParameterError
from antenna_pin.run.simulation import simulate
from antenna_pin.scenario import Scenario

# Turns that pass before a measurement, and those that it takes; samples of a turn.
_SETTLING, _MEASURED, _SAMPLES = 20, 20, 64


@takes(speeds="rad/s")
def measured_orders(
    scenario: Scenario,
    joint: str,
    speeds: Sequence[float | str],
    *,
    count: int = 6,
    harmonics: Sequence[float] | None = None,
) -> xr.Dataset:
    """Return the orders of a wheel by runs at several speeds (:func:`antenna_pin.analysis.wheel_orders`).

    Args:
        scenario: The scenario.
        joint: Joint about which the wheel turns.
        speeds: As of :func:`records_at_speeds`.
        count: Likewise.
        harmonics: Harmonics of the speed; searched for if left out.
    """
    return wheel_orders(records_at_speeds(scenario, joint, speeds, count=count), harmonics=harmonics)


@takes(speeds="rad/s")
def records_at_speeds(
    scenario: Scenario, joint: str, speeds: Sequence[float | str], *, count: int = 6
) -> list[SpeedRecord]:
    """Return the disturbance of a wheel in runs at several speeds.

    Each run begins with the wheel at its speed, which drives of the scenario have to hold, and lasts 40
    turns, of which the last 20 count.

    Args:
        scenario: The scenario.
        joint: Joint about which the wheel turns.
        speeds: Lowest and highest speed [rad/s], between which ``count`` are evenly spaced; or all of three
            and more.
        count: Number of speeds between two.

    Raises:
        InvalidParameterError: Speeds that are not positive, or do not rise.
    """
    values = np.array(speeds, dtype=float)
    if len(values) < 2 or values[0] <= 0.0 or not (np.diff(values) > 0.0).all():
        rule = "positive speeds that rise, two or more"
        raise InvalidParameterError("measured orders", "speeds", rule, said=str(list(speeds)))
    if len(values) == 2:
        values = np.linspace(values[0], values[1], count)
    records = []
    for speed in values:
        turn = 2.0 * math.pi / float(speed)
        rate = max(_SAMPLES / turn, scenario.output.rate or 0.0)
        changed = scenario.with_overrides(
            {
                f"initial.joints.{joint}.rate": float(speed),
                "duration": (_SETTLING + _MEASURED) * turn,
                "output.rate": rate,
            }
        )
        records += speed_records(uninterrupted(simulate(changed)), joint, after=_SETTLING * turn)
    return records
