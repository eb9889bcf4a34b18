"""Pictures of a bearing with "up" against gravity, and which axes of the bearing they then show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from antenna_pin.analysis import steady_up
from antenna_pin.plot._style import Array

__all__ = ["ShownAxes", "mark_axes", "shown_axes"]

_ACROSS = 0.1  # sine of the axis' angle to gravity, from which on a cross section has an "up"
_SAME = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class ShownAxes:
    """The axes that a picture of a bearing shows.

    Attributes:
        turn: Rotation from bearing axes to them, (3, 3) [-].
        names: Of each, for its label.
        up: Direction against gravity, bearing axes, (3,) [-]; None where the picture has no "up".
    """

    turn: Array
    names: tuple[str, str, str]
    up: Array | None

    @property
    def turned(self) -> bool:
        """Whether these are other axes than the bearing's."""
        return bool(np.abs(self.turn - np.eye(3)).max() > _SAME)


def shown_axes(data: xr.Dataset, joint: str, *, spatial: bool) -> ShownAxes:
    """Return the axes to show a bearing in: its own without a steady gravity, else with one of them upwards.

    Args:
        data: Of a run.
        joint: A clearance joint.
        spatial: Whether the third axis is shown upwards; else the second is, about the bearing's own third.
    """
    up = steady_up(data, joint)
    if up is not None and not spatial and np.hypot(up[0], up[1]) < _ACROSS:
        up = None
    if up is None:
        return ShownAxes(np.eye(3), ("x", "y", "z"), None)
    if spatial:
        z = up
        along = np.eye(3)[0 if abs(up[0]) < 0.9 else 1]
        x = along - (along @ z) * z
        x /= np.linalg.norm(x)
        turn = np.stack([x, np.cross(z, x), z])
    else:
        y = np.array([up[0], up[1], 0.0]) / np.hypot(up[0], up[1])
        turn = np.stack([np.array([y[1], -y[0], 0.0]), y, np.array([0.0, 0.0, 1.0])])
    upwards = 2 if spatial else 1
    names = [_name(row) or ("level" if not spatial else f"level {k + 1}") for k, row in enumerate(turn)]
    names[upwards] = f"{_name(turn[upwards])}, up".removeprefix(", ")
    return ShownAxes(turn, (names[0], names[1], names[2]), up)


def _name(direction: Array) -> str:
    """Return the axis of the bearing along a direction with its sign, or nothing."""
    k = int(np.argmax(np.abs(direction)))
    if 1.0 - abs(direction[k]) > _SAME:
        return ""
    return ("" if direction[k] > 0.0 else "\N{MINUS SIGN}") + "xyz"[k]


def mark_axes(axes: Axes, shown: ShownAxes, across: int, up: int) -> None:
    """Draw the bearing's axes into the corner of a panel that shows others than its own.

    Args:
        axes: The panel, of equal scales.
        shown: What it shows.
        across: The axis across.
        up: The axis upwards.
    """
    if not shown.turned:
        return
    size = 0.075
    for k, name in enumerate("xyz"):
        way = shown.turn[[across, up], k]
        if np.hypot(*way) < 0.2:
            continue  # it points at who looks
        x, y = (0.16 + size * way).tolist()
        arrow = {"arrowstyle": "->", "linewidth": 0.6, "shrinkA": 0.0, "shrinkB": 0.0}
        axes.annotate("", (x, y), (0.16, 0.16), "axes fraction", arrowprops=arrow)
        x, y = (0.16 + (size + 0.035) * way).tolist()
        axes.text(x, y, name, transform=axes.transAxes, ha="center", va="center", fontsize=6.5)
