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
from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import Floats, Pose, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.elements.element import LOSS, About, Element, Integral, packed
from antenna_pin.elements.hook_kernels import JournalPlace
from antenna_pin.errors import InvalidParameterError

Array = NDArray[np.float64]
Numbers5 = Annotated[Floats, 5]
Matrix5 = Annotated[Floats, (5, 5)]

# Of a matrix that is symmetric, and of its least eigenvalue over its largest: round-off of written numbers.
_ROUND_OFF = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class Bearing(Element):
    """Base of the elements that act on a journal's pose in its bearing.

    Their kernels are ``press``, ``journal_energy`` and ``coordinates``; about its axis a bearing has no
    torque.
    """

    kernels: ClassVar[str] = __name__
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

    @packed
    def springs(self) -> Matrix5:
        """Stiffness over (x, y, z, tilt about x, tilt about y) [N/m, N/rad, N*m/rad]."""
        raise NotImplementedError

    @packed
    def dampers(self) -> Matrix5:
        """Damping over the same [N*s/m, N*s/rad, N*m*s/rad]."""
        raise NotImplementedError

    @packed
    def push(self) -> Numbers5:
        """Force [N] and moment [N*m] in its centred place."""
        return np.zeros(5)

    @packed
    def energy(self) -> float:
        """Energy in its centred place [J]."""
        return 0.0

    @packed
    def offset(self) -> float:
        """Reference point along the axis from the joint's [m]."""
        return 0.0

    @packed
    def ball_count(self) -> int:
        """Number of balls behind the record."""
        return 0


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
            raise InvalidParameterError(self, "matrix", f"omitted if {single[0]} is given", self.matrix)
        if self.matrix is None and not single:
            raise InvalidParameterError(self, "radial", "above zero, or axial or tilt, or matrix given", 0.0)
        if self.damping_matrix is not None and self.damping_time:
            raise InvalidParameterError(
                self, "damping_matrix", "omitted if damping_time is given", self.damping_matrix
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

    springs, dampers = stiffness, damping

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
        given_at: Place of the force F: just ``touching`` the face, at ``rest`` on it with no other load, or
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

    @property
    def springs(self) -> Matrix5:
        """Stiffness along the axis."""
        return np.diag([0.0, 0.0, self.stiffness, 0.0, 0.0])

    @property
    def dampers(self) -> Matrix5:
        """No damping."""
        return np.zeros((5, 5))

    @property
    def push(self) -> Numbers5:
        """Force in the middle; of a preload that has not been placed, the force there."""
        return np.array([0.0, 0.0, self.force + self.stiffness * (self.position or 0.0), 0.0, 0.0])

    @property
    def energy(self) -> float:
        """Energy in the middle [J]."""
        push = float(self.push[2])
        return 0.5 * push * push / self.stiffness

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        said = self.said_of({"force": "preload", "stiffness": "stiffness"}, slides)
        where = {"touching": "where the face touches", "rest": "at rest on the face", "centred": "centred"}
        place = where[self.given_at] if self.position is None else f"at {self.text_of('position', slides)}"
        return f"{', '.join(said)}, force given {place}"


# --- compiled -----------------------------------------------------------------------------------------------


class Ball(Record):
    """A ball between the groove centres of its raceways."""

    cosine: float  # of its azimuth
    sine: float  # of its azimuth
    height: float  # inner groove centre, centred, along the axis from the reference point [m]
    radius: float  # inner groove centre off the axis [m]
    off: float  # from the outer groove centre to the inner, off the axis [m]
    along: float  # the same, along the axis [m]
    rest: float  # distance of the groove centres, unloaded [m]
    hertz: float  # force over elongation^1.5 [N/m^1.5]


BALL = layout(Ball)
BALL_SIZE = words_of(BALL)


@inlined
def _ball(tail: Floats, k: int) -> Ball:
    first = k * BALL_SIZE
    return record(tail[first : first + BALL_SIZE], BALL)


@inlined
def _coordinates(
    offset: float, place: tuple[float, float, float, float, float, float]
) -> tuple[float, float, float, float, float]:
    """Return the five coordinates of a journal's centre and axis."""
    x, y, z, ax, ay, az = place
    # 1 - cos of the tilt without cancellation.
    sunk = (ax * ax + ay * ay) / (1.0 + az) if az > 0.0 else 1.0 - az
    return x + offset * ax, y + offset * ay, z - offset * sunk, -ay, ax


@inlined
def _elongation(ball: Ball, q: tuple[float, float, float, float, float]) -> tuple[float, float, float]:
    """Return the compression of a ball [m], and its load's direction, off and along."""
    x, y, z, tx, ty = q
    tilt = ball.cosine * ty - ball.sine * tx
    off = ball.off + ball.cosine * x + ball.sine * y + ball.height * tilt
    along = ball.along + z - ball.radius * tilt
    way = math.sqrt(off * off + along * along)
    return way - ball.rest, off / way, along / way


@kernel
def press(b: Bearing, tail: Floats, pose: Pose) -> float:
    """Write force and moment about its centre into the journal's pose; return the loss [W]."""
    s = b.offset
    ax, ay, az = pose.axis[0], pose.axis[1], pose.axis[2]
    q = _coordinates(s, (pose.centre[0], pose.centre[1], pose.centre[2], ax, ay, az))
    wx, wy, wz = pose.spin[0], pose.spin[1], pose.spin[2]
    # a' = w x a.
    dx, dy, dz = wy * az - wz * ay, wz * ax - wx * az, wx * ay - wy * ax
    v = (pose.velocity[0] + s * dx, pose.velocity[1] + s * dy, pose.velocity[2] + s * dz, -dy, dx)
    fx, fy, fz, mx, my = b.push[0], b.push[1], b.push[2], b.push[3], b.push[4]
    lost = 0.0
    for k in range(5):
        elastic, damped = q[k], v[k]
        fx -= b.springs[0, k] * elastic + b.dampers[0, k] * damped
        fy -= b.springs[1, k] * elastic + b.dampers[1, k] * damped
        fz -= b.springs[2, k] * elastic + b.dampers[2, k] * damped
        mx -= b.springs[3, k] * elastic + b.dampers[3, k] * damped
        my -= b.springs[4, k] * elastic + b.dampers[4, k] * damped
        for i in range(5):
            lost += v[i] * b.dampers[i, k] * damped
    for k in range(b.ball_count):
        ball = _ball(tail, k)
        depth, off, along = _elongation(ball, q)
        if depth > 0.0:
            load = ball.hertz * depth * math.sqrt(depth)
            fx -= load * off * ball.cosine
            fy -= load * off * ball.sine
            fz -= load * along
            turn = load * (ball.height * off - ball.radius * along)
            mx += turn * ball.sine
            my -= turn * ball.cosine
    pose.force[0], pose.force[1], pose.force[2] = fx, fy, fz
    # Tilts change by w x a, so that their torques are these; then the force's about the journal's centre.
    pose.moment[0] = mx * az + s * (ay * fz - az * fy)
    pose.moment[1] = my * az + s * (az * fx - ax * fz)
    pose.moment[2] = -mx * ax - my * ay + s * (ax * fy - ay * fx)
    return float(lost)


@kernel
def journal_energy(b: Bearing, tail: Floats, place: JournalPlace) -> float:
    """Return the energy stored [J], with the journal's centre and axis at ``place``."""
    q = _coordinates(b.offset, place)
    total = float(b.energy)
    for i in range(5):
        total -= b.push[i] * q[i]
        for k in range(5):
            total += 0.5 * q[i] * b.springs[i, k] * q[k]
    for k in range(b.ball_count):
        ball = _ball(tail, k)
        depth, _, _ = _elongation(ball, q)
        if depth > 0.0:
            total += 0.4 * ball.hertz * depth * depth * math.sqrt(depth)
    return float(total)


@kernel
def coordinates(b: Bearing, place: JournalPlace) -> tuple[float, float, float, float, float, float]:
    """Return the five coordinates of a journal at ``place`` [m], [1].

    Behind them stands where the reference point is along the axis [m].
    """
    offset = float(b.offset)
    x, y, z, tx, ty = _coordinates(offset, place)
    return x, y, z, tx, ty, offset
