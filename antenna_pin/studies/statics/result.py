"""Results of statics: equilibria and quasi-static travels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.readable import brief, number
from antenna_pin.scenario import Scenario

Array = NDArray[np.float64]

StaticStability = Literal["stable", "unstable", "neutral", "held"]
"""Sign of the reduced tangent stiffness: all eigenvalues positive, one negative, one zero; ``held``: none."""


class StaticContact(NamedTuple):
    """Contact that carries load in an equilibrium."""

    name: str  # of the contact, led by its joint's
    depth: float  # penetration depth [m]
    force: float  # normal force [N]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Equilibrium:
    """Configuration in which a mechanism rests.

    Attributes:
        state: [q, v, x] with v = 0, (nq + nv + nx,).
        positions: Of joints with an axis [rad] ([m]), by name.
        units: Of these positions, ``rad`` or ``m``, by name.
        length: Of the mechanism [m], the scale of displacements.
        efforts: Of elements at joints, on the child about the joint's axis [N*m] ([N]), by place, as
            ``springs.coil``.
        holding: Torques of motions, couplings and holding elements on their joint [N*m] ([N]), by name.
        reactions: Force and moment on the child of each joint, at the joint's origin in world axes, (6,)
            [N, N*m]; by name.
        contacts: Contacts that carry load.
        stiffness: Eigenvalues of the reduced tangent stiffness, rising, (k,) [N*m/rad]; displacements count
            over the mechanism's length.
        stability: Stability by the signs of these eigenvalues.
        residual: Largest force out of balance over the largest force [-].
        friction: Dry friction and hysteresis: ``none`` (off), or in full against a motion ``forward`` or
            ``backward``, at the ends of a set of equilibria.
        ends: Both ends of the set that friction and hysteresis make of this equilibrium; () without either.
    """

    __repr__ = brief

    state: Array
    positions: Mapping[str, float]
    units: Mapping[str, str]
    length: float
    efforts: Mapping[str, float]
    holding: Mapping[str, float]
    reactions: Mapping[str, Array]
    contacts: tuple[StaticContact, ...]
    stiffness: Array
    stability: StaticStability
    residual: float
    friction: Literal["none", "forward", "backward"] = "none"
    ends: tuple[Equilibrium, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return the equilibrium in plain numbers."""
        return {
            "positions": dict(self.positions),
            "units": dict(self.units),
            "stability": self.stability,
            "stiffness": self.stiffness.tolist(),
            "efforts": dict(self.efforts),
            "holding": dict(self.holding),
            "reactions": {name: one.tolist() for name, one in self.reactions.items()},
            "contacts": [one._asdict() for one in self.contacts],
            "residual": self.residual,
            "friction": self.friction,
            "ends": [one.to_dict() for one in self.ends],
        }


@dataclass(frozen=True, slots=True, eq=False)
class QuasiStaticTravel:
    """A joint moved through its travel at vanishing rate, and back.

    Attributes:
        data: Along ``sense`` (``out``, and ``back`` if the travel is made both ways) and ``position`` [rad]
            ([m]): ``torque``, needed at the joint's child for equilibrium [N*m] ([N]);
            ``component`` of each ``source``, the torque that it exerts along the motion, reduced to the
            joint by virtual work, so that torque and components sum to zero; ``joint_position`` of each
            ``joint``, ``reaction`` of each (``component`` fx to mz, on the child at the joint's origin in
            world axes [N, N*m]), ``stiffness``, the least eigenvalue of the reduced tangent stiffness of
            what stays free [N*m/rad] (NaN where nothing does), and ``residual`` [-]. Positions of both
            senses stand in the order of the way out.
        states: [q, v, x] at each, (senses, n, nq + nv + nx).
        joint: The joint's name.
        sliding: Whether the joint is prismatic.
        notes: Assumptions and limits, in sentences.
        scenario: Of the mechanism; None for a system built in Python.
    """

    data: xr.Dataset
    states: Array
    joint: str
    sliding: bool
    notes: tuple[str, ...] = ()
    scenario: Scenario | None = None

    @property
    def position(self) -> Array:
        """Positions of the joint, (n,) [rad] ([m])."""
        return np.asarray(self.data["position"].values)

    @property
    def torque(self) -> Array:
        """Needed torque on the way out, (n,) [N*m] ([N])."""
        return np.asarray(self.data["torque"].sel(sense="out").values)

    @property
    def torque_back(self) -> Array:
        """Needed torque on the way back, in outward order, (n,) [N*m] ([N])."""
        return np.asarray(self.data["torque"].sel(sense="back").values)

    @property
    def unit(self) -> str:
        """Unit of the torque."""
        return "N" if self.sliding else "N*m"

    def component(self, source: str, sense: str = "out") -> Array:
        """Return the torque of a source along the motion, (n,) [N*m] ([N]).

        Args:
            source: Place of an element, as ``springs.coil``, or ``gravity`` and ``contacts.JOINT``.
            sense: ``out`` or ``back``.
        """
        return np.asarray(self.data["component"].sel(source=source, sense=sense).values)

    def to_dict(self) -> dict[str, Any]:
        """Return the travel in plain numbers."""
        data = self.data
        found: dict[str, Any] = {"joint": self.joint, "unit": self.unit, "position": self.position.tolist()}
        for sense in data["sense"].values:
            one = data.sel(sense=sense)
            found[str(sense)] = {
                "torque": one["torque"].values.tolist(),
                "components": {
                    str(source): one["component"].sel(source=source).values.tolist()
                    for source in data["source"].values
                },
                "stiffness": [None if np.isnan(k) else k for k in one["stiffness"].values.tolist()],
                "residual": float(np.abs(one["residual"].values).max()),
            }
        return {**found, "notes": list(self.notes)}

    def __repr__(self) -> str:
        """Show joint, travel and the range of the torque."""
        p, t = self.position, self.data["torque"].values
        unit = "m" if self.sliding else "rad"
        return (
            f"QuasiStaticTravel({self.joint!r}, {number(p[0])} to {number(p[-1])} {unit}, {len(p)} "
            f"positions, torque {number(float(t.min()))} to {number(float(t.max()))} {self.unit})"
        )
