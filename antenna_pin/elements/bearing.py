r"""Bearings as springs in all freedoms but the rotation about the axis.

They act on five coordinates of the journal at a *reference point* of the axis, in bearing axes, which do not
spin: its place x, y, z, and the tilt of its axis a,

.. math:: \theta = e_z \times a = (-a_y, a_x)

whose size is the sine of the angle between the axes. With s the reference point's distance from the joint's
along the axis, the place is that of the journal's point at s a from its centre, over s e_z. Energy is a
function of the five alone, and force and torque are its exact gradient at any tilt; as no tilt changes when
the journal turns about its own axis, they have no torque about it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.parameters import parameter
from antenna_pin.elements.element import LOSS, About, Element, Integral
from antenna_pin.errors import InvalidParameterError

__all__ = ["AxialPreload", "Bearing", "StiffnessBearing", "moved"]

Array = NDArray[np.float64]

# Of a matrix that is symmetric, and of its least eigenvalue over its largest: round-off of written numbers.
_ROUND_OFF = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class Bearing(Element):
    """Base of the elements that act on a journal's pose in its bearing.

    Beside their kernels' ``LAYOUT`` and ``effort``, which is zero:

    - ``press(words, at, pose)``: force and moment on the journal, written into its pose; the power lost [W];
    - ``journal_energy(words, at, place)``: the energy stored [J] with the journal's centre and axis there;
    - ``coordinates(words, at, place)``: the five coordinates there, and the reference point's distance.
    """

    kernels: ClassVar[str] = "bearing_kernels"
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS,)
    # Whether it holds its joint, which is free otherwise; or acts beside the play that the joint has.
    frees: ClassVar[bool] = True

    on: bool = True

    @property
    def about(self) -> About:
        """Axis of the effort at a joint with play."""
        return "pose"

    @property
    def scale(self) -> tuple[float, float] | None:
        """Displacement over which stiffness changes, and its lever to tilts [m]; None if constant."""
        return None

    def check_joint(self, place: str, slides: bool) -> None:
        """Refuse a joint that slides."""
        if slides:
            rule = "revolute or continuous: a bearing is of a joint that turns"
            raise InvalidParameterError(place, "joint", rule, self.joint)

    def derived(self) -> dict[str, Any]:
        """Return the packed parameters that are no fields of the element."""
        return {"push": np.zeros(5), "energy": 0.0, "balls": 0}


def moved(matrix: Array, way: float) -> Array:
    """Return a stiffness about a reference point that stands further along the axis.

    The coupling of place and tilt changes, and the tilt stiffness with it.

    Args:
        matrix: About the present point, over (x, y, z, tilt about x, tilt about y), (5, 5).
        way: From the present reference point to the new one, along the axis [m].
    """
    # The old point's coordinates from the new one's: x = x' - way ty, y = y' + way tx.
    back = np.eye(5)
    back[0, 4], back[1, 3] = -way, way
    found: Array = back.T @ matrix @ back
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class StiffnessBearing(Bearing):
    r"""A bearing by its stiffness matrix, symmetric, at its reference point.

    .. math:: F = -K q - C \dot q, \qquad
              K = \begin{pmatrix} k_r & & & & k_c \\ & k_r & & -k_c & \\ & & k_a & & \\
              & -k_c & & k_t & \\ k_c & & & & k_t \end{pmatrix}

    over q = (x, y, z, tilt about x, tilt about y), or by all its numbers; C = beta K, or a matrix of its own.
    It spins freely.

    Attributes:
        radial: k_r [N/m].
        axial: k_a [N/m].
        tilt: k_t [N m/rad].
        coupling: k_c, force for a tilt, torque for a way; positive where the point that a radial force does
            not tilt is above the reference point [N/rad].
        offset: Reference point along the joint's axis from the joint's origin [m].
        damping_time: beta, of damping in proportion [s].
        matrix: All 25 numbers of K instead, row by row, in SI units; none if not given.
        damping_matrix: All 25 numbers of C, row by row, in SI units; none if not given.
    """

    radial: float = parameter("N/m", rule="zero or more", default=0.0)
    axial: float = parameter("N/m", rule="zero or more", default=0.0)
    tilt: float = parameter("N*m/rad", rule="zero or more", default=0.0)
    coupling: float = parameter("N/rad", default=0.0)
    offset: float = parameter("m", default=0.0)
    damping_time: float = parameter("s", rule="zero or more", default=0.0)
    matrix: tuple[float, ...] | None = parameter("1", sizes=(25,), default=None)
    damping_matrix: tuple[float, ...] | None = parameter("1", sizes=(25,), default=None)

    def __post_init__(self) -> None:
        """Check that energy can be stored, and is lost."""
        Bearing.__post_init__(self)
        single = [name for name in ("radial", "axial", "tilt", "coupling") if getattr(self, name)]
        if self.matrix is not None and single:
            raise InvalidParameterError(self, "matrix", f"left out beside {single[0]}", self.matrix)
        if self.matrix is None and not single:
            raise InvalidParameterError(self, "radial", "above zero, or axial or tilt, or matrix given", 0.0)
        if self.damping_matrix is not None and self.damping_time:
            raise InvalidParameterError(
                self, "damping_matrix", "left out beside damping_time", self.damping_matrix
            )
        for name, found in (("matrix", self.stiffness), ("damping_matrix", self.damping)):
            fault = _fault(found, symmetric=name == "matrix")
            if fault is None:
                continue
            if name == "matrix" and self.matrix is None:
                most = math.sqrt(self.radial * self.tilt)
                rule = f"no larger than sqrt(radial * tilt) = {most:g} N, or it would give energy away"
                raise InvalidParameterError(self, "coupling", rule, self.coupling)
            raise InvalidParameterError(self, name, fault, getattr(self, name))

    @property
    def stiffness(self) -> Array:
        """K, (5, 5)."""
        if self.matrix is not None:
            return np.array(self.matrix).reshape(5, 5)
        found = np.diag([self.radial, self.radial, self.axial, self.tilt, self.tilt])
        found[0, 4] = found[4, 0] = self.coupling
        found[1, 3] = found[3, 1] = -self.coupling
        return found

    @property
    def damping(self) -> Array:
        """C, (5, 5)."""
        if self.damping_matrix is not None:
            return np.array(self.damping_matrix).reshape(5, 5)
        return self.damping_time * self.stiffness

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        said = {"radial": "radial stiffness", "axial": "axial", "tilt": "tilt", "coupling": "coupling"}
        parts = self.said_of(said, slides) if self.matrix is None else ["stiffness by a matrix"]
        if self.damping_matrix is not None:
            parts.append("damping by a matrix")
        more = {"damping_time": "damped in proportion by", "offset": "reference point at"}
        return f"ball bearing, {', '.join([*parts, *self.said_of(more, slides)])}"


def _fault(matrix: Array, symmetric: bool) -> str | None:
    """Return the rule that a matrix breaks, if any."""
    if symmetric and np.abs(matrix - matrix.T).max() > _ROUND_OFF * np.abs(matrix).max():
        return "symmetric, or energy would be made in going round"
    # Ways and tilts on scales on which the diagonal is one, so that the eigenvalues can be compared.
    scale = np.sqrt(np.abs(np.diag(matrix)))
    scale[scale == 0.0] = 1.0
    even = 0.5 * (matrix + matrix.T) / np.outer(scale, scale)
    values = np.linalg.eigvalsh(even)
    if values[0] < -_ROUND_OFF * np.abs(values).max():
        return "without negative eigenvalues, or it would give energy away"
    return None


@dataclass(frozen=True, slots=True, kw_only=True)
class AxialPreload(Bearing):
    r"""A spring that pushes a journal along its axis and takes out play.

    .. math:: F_z = F - k (z - z_F)

    on the journal, at its centre, with the reaction on the bearing. The face that it presses on lifts off
    under an outside force of F (given where the face just touches), whatever the stiffnesses.

    Attributes:
        force: F, along the bearing's axis; negative the other way [N].
        stiffness: k [N/m].
        given_at: Where the force is F: just ``touching`` the face, at ``rest`` on it with no other load, or
            ``centred``.
        position: z_F instead [m].
    """

    frees: ClassVar[bool] = False

    force: float = parameter("N")
    stiffness: float = parameter("N/m", rule="positive")
    given_at: Literal["touching", "rest", "centred"] = "touching"
    position: float | None = parameter("m", default=None)

    def __post_init__(self) -> None:
        """Check that it does something."""
        Bearing.__post_init__(self)
        if self.force == 0.0:
            raise InvalidParameterError(self, "force", "above or below zero", self.force)

    def derived(self) -> dict[str, Any]:
        """Return the packed parameters that are no fields of the element."""
        found = Bearing.derived(self)
        # Of a preload that has not been placed, one in the middle.
        found["push"][2] = push = self.force + self.stiffness * (self.position or 0.0)
        stiffness = np.diag([0.0, 0.0, self.stiffness, 0.0, 0.0])
        own = {"stiffness": stiffness, "damping": np.zeros((5, 5)), "offset": 0.0}
        return found | own | {"energy": 0.5 * push * push / self.stiffness}

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        said = self.said_of({"force": "preload", "stiffness": "stiffness"}, slides)
        where = {"touching": "where the face touches", "rest": "at rest on the face", "centred": "centred"}
        place = where[self.given_at] if self.position is None else f"at {self.text_of('position', slides)}"
        return f"{', '.join(said)}, force given {place}"
