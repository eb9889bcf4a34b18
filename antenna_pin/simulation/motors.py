"""What a result has of motors: current, energy that the supply gives, heat of the winding."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import kernels, records_at
from antenna_pin.elements import Motor
from antenna_pin.simulation.seen import Seen

__all__ = ["MOTORS_SINCE_BEGIN", "motors_of", "of_motors"]

Array = NDArray[np.float64]

#: Series that count from the run's first sample on.
MOTORS_SINCE_BEGIN = ("motor_electric_energy", "motor_heat")


def motors_of(seen: Seen) -> list[str]:
    """Return the drives that are motors, by name."""
    return [name for name, drive in seen.system.drives.items() if isinstance(drive, Motor)]


def of_motors(seen: Seen) -> Mapping[str, Any]:
    """Return the series of motors."""
    names = motors_of(seen)
    shape = len(seen.times), len(names)
    current, electric, heat = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    behind = seen.system.model.nq + seen.system.model.nv
    for k, name in enumerate(names):
        motor = seen.system.drives[name]
        assert isinstance(motor, Motor)
        block = seen.system.drive_blocks[name]
        head = seen.system.program[block : block + kernels.PARAMETERS].view(kernels.ELEMENT)[0]
        places = {one.name: behind + int(head["x"]) + j for j, one in enumerate(motor.integrals)}
        since = seen.states - seen.start.first
        electric[:, k], heat[:, k] = since[:, places["electric"]], since[:, places["heat"]]
        if motor.inductance > 0.0:
            current[:, k] = seen.states[:, places["current"]]
        else:
            current[:, k] = _algebraic(seen, motor, name)
    return {"motor_current": current, "motor_electric_energy": electric, "motor_heat": heat}


def _algebraic(seen: Seen, motor: Motor, name: str) -> Array:
    """Return the current of a motor without inductance, by its torque at the joint; 0 where it is off [A]."""
    block = seen.system.drive_blocks[name]
    on = records_at(seen.programs, block, kernels.ELEMENT)["on"]
    own = records_at(seen.programs, block + int(kernels.PARAMETERS), Motor.compiled().LAYOUT)
    torque = seen.found.effort["effort"][:, list(seen.system.drives).index(name)] / own["ratio"]
    names, motion = seen.slides if seen.system.slides(motor.joint) else seen.joints
    turned = own["ratio"] * motion[names.index(motor.joint), :, 0]
    cogging = -own["cogging"] * np.sin(own["cycles"] * turned + own["phase"])
    return np.where(on == 0.0, 0.0, (torque - cogging) / own["torque_constant"])
