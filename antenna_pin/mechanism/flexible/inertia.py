"""Mass properties of a body as one number per moment, and remainders without a part."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# Added to a body's second moments, as a share of their sum: a flat plate has none across itself, and no
# comparison with it would have a meaning.
_FLAT = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class MassProperties:
    r"""Mass, mass centre and inertia of a rigid body, all in one frame.

    Attributes:
        mass: [kg].
        centre: (3,) mass centre [m].
        inertia: (3, 3) about the mass centre [kg m^2].
    """

    mass: float
    centre: Array
    inertia: Array

    @classmethod
    def of(cls, mass: float, centre: ArrayLike, inertia: ArrayLike) -> MassProperties:
        """Return a body of numbers given as arrays of any kind."""
        return cls(float(mass), np.array(centre, dtype=float), np.array(inertia, dtype=float))

    @classmethod
    def of_moments(cls, moments: Array) -> MassProperties:
        """Return the body that has a pseudo-inertia, (4, 4); its mass is not zero."""
        mass = float(moments[3, 3])
        centre = moments[:3, 3] / mass
        return cls(mass, centre, inertia_of(moments[:3, :3] - mass * np.outer(centre, centre)))

    @property
    def spread(self) -> Array:
        """Second moments of mass about the mass centre, (3, 3) [kg m^2]."""
        return np.asarray(0.5 * np.trace(self.inertia) * np.eye(3) - self.inertia)

    @property
    def moments(self) -> Array:
        r"""Pseudo-inertia about the frame's origin, (4, 4): second moments, first moments and mass.

        .. math:: \begin{bmatrix} \int r r^T dm & \int r\,dm \\ \int r^T dm & m \end{bmatrix}

        It is positive (semi)definite exactly where a body can have these numbers: positive mass and moments
        that keep the triangle rule; and it is additive (Wensing, Kim and Slotine 2018, IEEE Robotics and
        Automation Letters 3(1), 60-67).
        """
        found = np.empty((4, 4))
        found[:3, :3] = self.spread + self.mass * np.outer(self.centre, self.centre)
        found[:3, 3] = found[3, :3] = self.mass * self.centre
        found[3, 3] = self.mass
        return found

    @property
    def gyration(self) -> float:
        """Radius of gyration of the mean principal moment [m]."""
        return float(np.sqrt(np.trace(self.inertia) / (3.0 * self.mass)))

    def less(self, parts: Iterable[MassProperties]) -> MassProperties:
        """Return what is left without some parts, whether a body can have it or not."""
        return MassProperties.of_moments(self.moments - sum(part.moments for part in parts))

    def moved(self, placement: Array) -> MassProperties:
        """Return the same body in a frame that has it at a placement, (4, 4)."""
        turn = placement[:3, :3]
        return MassProperties(self.mass, turn @ self.centre + placement[:3, 3], turn @ self.inertia @ turn.T)


def inertia_of(spread: Array) -> Array:
    """Return the inertia (3, 3) from second moments of mass about the same point."""
    return np.asarray(np.trace(spread) * np.eye(3) - spread)


def share_taken(whole: MassProperties, part: MassProperties) -> float:
    """Return a part's share of a body: at 1 some moment of mass vanishes [-].

    It is the largest eigenvalue of the part's pseudo-inertia in the metric of the whole's: 0.3 of the mass
    at the mass centre is 0.3, further out it is more.
    """
    return float(shares_taken(whole, part.moments[None])[0])


def shares_taken(whole: MassProperties, moments: Array) -> Array:
    """Return the same of parts by their pseudo-inertias, (n, 4, 4), as (n,)."""
    return np.asarray(np.linalg.eigvalsh(_in_metric(whole, moments))[..., -1])


def least_share(whole: MassProperties, left: Array) -> float:
    """Return the least share of moments in a pseudo-inertia (4, 4) [-]; negative if impossible."""
    return float(np.linalg.eigvalsh(_in_metric(whole, left))[0])


def _in_metric(whole: MassProperties, moments: Array) -> Array:
    """Return pseudo-inertias, (..., 4, 4), in the metric of a body's principal axes."""
    values, axes = np.linalg.eigh(whole.spread)
    values = np.maximum(values, _FLAT * values.sum())
    # x = scale^-1 axes^T (r - c) for the first three, in which the whole is the unit matrix times its mass.
    shift = np.eye(4)
    shift[:3, 3] = -whole.centre
    about = shift @ moments @ shift.T
    scale = np.zeros((4, 4))
    scale[:3, :3] = axes / np.sqrt(values)
    scale[3, 3] = 1.0 / np.sqrt(whole.mass)
    return np.asarray(scale.T @ about @ scale)
