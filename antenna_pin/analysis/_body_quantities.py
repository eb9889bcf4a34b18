r"""What a result does not hold but follows from it: motion of links and journals, loads of a shaken base.

The velocity of the journal's centre p_J in the bearing, whose centre p_B turns with it, is

.. math:: \mathbf{R}_B^T [\dot{\mathbf{p}}_J - \dot{\mathbf{p}}_B
    - \boldsymbol{\omega}_B \times (\mathbf{p}_J - \mathbf{p}_B)],

the rate of ``journal_position``, in the same axes.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.spatial.transform import Rotation

from antenna_pin.analysis._run import Array, variable
from antenna_pin.analysis.bodies import mechanism_of
from antenna_pin.analysis.journal import clearance_shapes
from antenna_pin.analysis.shaken import base_wrench, shaken_link, shakes_of
from antenna_pin.mechanism import link_motion
from antenna_pin.trajectory import names_along

__all__ = ["AXES", "DERIVED", "Derived", "owners_of"]

#: Components of every one.
AXES = ("x", "y", "z")


class Derived(NamedTuple):
    """A vector over time of each of several owners.

    Attributes:
        dim: What the owners are: a dimension of the quantity beside time and axis.
        units: Of its components.
        meaning: What it is.
        row: Of :func:`antenna_pin.mechanism.link_motion`; of a base's loads, force or moment.
    """

    dim: str
    units: str
    meaning: str
    row: int

    def values(self, data: xr.Dataset, owner: str) -> Array:
        """Return the vector of one owner at the samples, (n, 3)."""
        if self.dim == "shaken_base":
            return base_wrench(data)[:, 3 * self.row : 3 * self.row + 3]
        if self.dim == "body":
            return _motion(data, owner)[1][:, self.row]
        return _in_bearing(data, clearance_shapes(data)[owner])


#: What can be asked for beside what a result holds, by name.
DERIVED: dict[str, Derived] = {
    "body_position": Derived("body", "m", "place of the link's frame in the world", 0),
    "body_velocity": Derived("body", "m/s", "velocity of the link's frame, world axes", 1),
    "body_acceleration": Derived("body", "m/s^2", "acceleration of the link's frame, world axes", 3),
    "body_angular_velocity": Derived("body", "rad/s", "angular velocity of the link, world axes", 2),
    "body_angular_acceleration": Derived(
        "body", "rad/s^2", "angular acceleration of the link, world axes", 4
    ),
    "journal_velocity": Derived(
        "clearance_joint", "m/s", "velocity of the journal's centre in the bearing", 1
    ),
    "base_force": Derived("shaken_base", "N", "force on the shaken base, its axes", 0),
    "base_moment": Derived("shaken_base", "N m", "moment on the shaken base about its frame, its axes", 1),
}


def owners_of(data: xr.Dataset) -> dict[str, list[str]]:
    """Return the names along the dimensions of derived vectors; no links if the run carries no mechanism."""
    links = [link.name for link in mechanism_of(data).urdf.robot.links] if "urdf" in data.attrs else []
    joints = list(clearance_shapes(data)) if "clearance_joints" in data.attrs else []
    base = [shaken_link(data)] if shakes_of(data) else []
    return {
        "body": links,
        "clearance_joint": joints or names_along(data, "clearance_joint"),
        "shaken_base": base,
    }


def _motion(data: xr.Dataset, link: str) -> tuple[Array, Array]:
    """Return attitudes and motion of a link, as :func:`antenna_pin.mechanism.link_motion`."""
    q, v, a = (np.asarray(variable(data, name, "quantity").values, dtype=float) for name in "qva")
    return link_motion(mechanism_of(data), link, q, v, a)


def _in_bearing(data: xr.Dataset, shape: dict[str, Any]) -> Array:
    """Return the velocity of a journal's centre in its bearing, in bearing axes, (n, 3) [m/s]."""
    places, rates, turns = [], [], []
    for side in ("bearing", "journal"):
        placement = np.asarray(shape[f"{side}_placement"], dtype=float).ravel()
        attitudes, motion = _motion(data, str(shape[f"{side}_body"]))
        arm = attitudes @ placement[:3]
        places.append(motion[:, 0] + arm)
        rates.append(motion[:, 1] + np.cross(motion[:, 2], arm))
        turns.append((attitudes @ Rotation.from_quat(placement[3:]).as_matrix(), motion[:, 2]))
    axes, spin = turns[0]
    seen = rates[1] - rates[0] - np.cross(spin, places[1] - places[0])
    return np.asarray(np.einsum("nji,nj->ni", axes, seen))
