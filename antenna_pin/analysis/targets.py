"""What of a shaken run answers, where nothing is asked for: the last link, along the motion."""

from __future__ import annotations

import numpy as np

from antenna_pin.analysis._run import RunLike, data_of
from antenna_pin.analysis.bodies import mechanism_of
from antenna_pin.analysis.shaken import shaken_link, shakes_of, way_of
from antenna_pin.base.arguments import takes

__all__ = ["base_quantity", "shaken_target"]

_AXES = ("x", "y", "z")


@takes()
def base_quantity(run: RunLike, shake: str | None = None) -> str:
    """Return the name of the base's absolute acceleration along the world's axis nearest to a motion of it.

    Args:
        run: A run whose base is shaken, or its data.
        shake: Name of the motion; the first one along a direction if left out.
    """
    data = data_of(run)
    return f"body_acceleration[{shaken_link(data)}].{_axis(data, shake)}"


@takes()
def shaken_target(run: RunLike, shake: str | None = None) -> str:
    """Return the name of the acceleration of the URDF's last link, along the same axis.

    Args:
        run: A run whose base is shaken, or its data.
        shake: Name of the motion; the first one along a direction if left out.
    """
    data = data_of(run)
    shaken_link(data)
    last = mechanism_of(data).urdf.robot.links[-1].name
    return f"body_acceleration[{last}].{_axis(data, shake)}"


def _axis(data: RunLike, shake: str | None) -> str:
    """Return the world's axis nearest to a motion's direction; z where all turn."""
    if shake is None and not any(one["slides"] for one in shakes_of(data).values()):
        return "z"
    _, way = way_of(data, shake)
    return _AXES[int(np.argmax(np.abs(way)))]
