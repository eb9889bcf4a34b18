"""What sessions are compared with."""

import numpy as np

from antenna_pin import load_scenario


def antenna(*overrides, case="case3", geometry="closed-form"):
    """The antenna with a constant torque at its elevation joint, which a session commands."""
    return load_scenario(
        "bai2020",
        case=case,
        overrides=[
            *([f"clearance.elevation.geometry={geometry}"] if case == "case3" else []),
            "drives.elevation={kind='constant', value=0.5, replace=true}",
            "springs.hold={joint='azimuth', stiffness=2.0, damping=0.1}",
            *overrides,
        ],
    )


def differences(one, other):
    """Return what two results do not both have with the same values, to the last bit."""
    names = {*map(str, one.data.variables), *map(str, other.data.variables)} - {
        "event"
    }  # what they are called
    return sorted(
        name
        for name in names
        if name not in one.data
        or name not in other.data
        or not np.array_equal(
            one.data[name].values, other.data[name].values, equal_nan=one.data[name].dtype.kind == "f"
        )
    )
