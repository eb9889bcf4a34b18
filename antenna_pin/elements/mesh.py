"""Gears, splines and racks: what meshes with play between two joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar, Literal

from antenna_pin.base.parameters import LEAST, parameter
from antenna_pin.base.readable import number
from antenna_pin.elements.curve import both_given, check_as_many
from antenna_pin.elements.flanks import BOTH_WAYS, TWO, Flanks
from antenna_pin.errors import InvalidParameterError


class Teeth(Flanks):
    """Base of what meshes by teeth, with play between them or without."""

    # The fields are those of the classes that declare them, with their units and meanings.
    __slots__ = ()

    play: float
    damping: float
    offset: float

    labels: ClassVar[Mapping[str, str]] = {"stiffness": "stiffness", "damping": "damping", "play": "play"}

    @property
    def has_kinks(self) -> bool:
        """Return whether the flanks have a damper, with a limit."""
        return self.play > 0.0 and self.damping > 0.0

    @property
    def room(self) -> float:
        """Minus half the play."""
        return -0.5 * self.play

    @property
    def springs(self) -> int:
        """Both flanks, or a spring either way without play."""
        return TWO if self.play > 0.0 else BOTH_WAYS

    @property
    def shares(self) -> tuple[float, float]:
        """Derivatives a and -b of the deflection over the positions: 1 and -1."""
        return 1.0, 1.0

    @property
    def rest(self) -> float:
        """Middle of the play."""
        return self.offset


@dataclass(frozen=True, slots=True, kw_only=True)
class Gear(Teeth):
    r"""A pair of gears, or a gearbox: elastic, with play, errors and friction.

    With a deflection measured on the output side (times the ratio on the input's)

    .. math:: x = \phi_\text{in} / r - \phi_\text{out} - x_0 - e(\phi_\text{in})

    nothing acts for :math:`|x| < b/2`, b the total play; beyond, by the excess s, :math:`k s` and a damping
    torque :math:`c \dot s` that is at most as large, so that flanks never pull. Angles are those of a joint's
    child on its parent, with all turns.

    The input gets the torque's part by the derivative of x over its angle, with its reaction on its own
    parent, the output likewise: with axes in parallel on one housing this takes both. Friction acts on the
    input, as a share of the torque that it has from the mesh: driving it gives 1 / ``efficiency`` of what the
    mesh takes, driven it gets ``efficiency_back`` of what the mesh gives.

    Attributes:
        ratio: Angle of the input for one of the output; negative for opposite ways.
        stiffness: Of the mesh, on the side that ``side`` says [N*m/rad].
        damping: Likewise, in contact only [N*m*s/rad].
        play: Total play (backlash), likewise [rad].
        side: Side of deflection, stiffness, damping, play, offset and error.
        offset: x_0, the deflection that is none: middle of the play where both angles are zero [rad].
        efficiency: Share of the power that arrives where the input drives.
        efficiency_back: Share of the power that arrives where the output drives; zero or more.
        slow_rate: Rate of the input where friction is 71 % of its limit [rad/s].
        error_angle: Angles of the input, increasing, over one period of the transmission error [rad].
        error: e at each, the last as the first, joined by a periodic spline [rad].

    References:
        Names as in Modelica's ElastoBacklash (total play, a damping torque that the spring's limits); the
        ratio as in Simscape's Gear Box, input over output.
    """

    ratio: float = parameter("1", default=1.0)
    stiffness: float = parameter("N*m/rad", rule="positive")
    damping: float = parameter("N*m*s/rad", rule="zero or more", default=0.0)
    play: float = parameter("rad", rule="zero or more", default=0.0)
    side: Literal["output", "input"] = "output"
    offset: float = parameter("rad", default=0.0)
    efficiency: float = parameter("1", rule="in (0, 1]", default=1.0)
    efficiency_back: float = parameter("1", rule="from 0 to 1", default=1.0)
    slow_rate: float = parameter("rad/s", rule="positive", default=1e-3)
    error_angle: tuple[float, ...] | None = parameter("rad", sizes=(0,), default=None, repr=False)
    error: tuple[float, ...] | None = parameter("rad", sizes=(0,), default=None, repr=False)
    on: bool = True

    def __post_init__(self) -> None:
        """Check the numbers, and the table of the error."""
        Teeth.__post_init__(self)
        if abs(self.ratio) < LEAST:
            raise InvalidParameterError(self, "ratio", "other than zero", self.ratio)
        self._check_error()

    def _check_error(self) -> None:
        angles, error = self.error_angle, self.error
        both_given(self, "error_angle", "error")
        if angles is None or error is None:
            return
        if len(angles) < 4:
            raise InvalidParameterError(self, "error_angle", "at least 4 numbers", said=f"{len(angles)}")
        check_as_many(self, "error_angle", "error")
        for k, (before, after) in enumerate(pairwise(angles), start=1):
            if not after - before >= LEAST:
                rule = f"above the one before, {before!r}"
                raise InvalidParameterError(self, f"error_angle[{k}]", rule, after)
        if error[0] != error[-1]:
            rule = f"as the first, {error[0]!r}: the table is one period"
            raise InvalidParameterError(self, f"error[{len(error) - 1}]", rule, error[-1])

    @property
    def reversals(self) -> tuple[str, ...]:
        """The input, if there is friction on it."""
        return (self.input,) if min(self.efficiency, self.efficiency_back) < 1.0 else ()

    @property
    def shares(self) -> tuple[float, float]:
        """Derivatives a and -b of the deflection over the positions, by the ratio."""
        return (1.0, self.ratio) if self.side == "input" else (1.0 / self.ratio, 1.0)

    @property
    def points(self) -> int:
        """Number of points of the error's curve."""
        return len(self.error_angle or ())

    def tail(self) -> tuple[float, ...]:
        """Return the curve of the error."""
        if self.error_angle is None or self.error is None:
            return ()
        from scipy.interpolate import CubicSpline

        found = CubicSpline(self.error_angle, self.error, bc_type="periodic").c.T
        return (*self.error_angle, *found.ravel().tolist())

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        said = [f"{self.between_said()}, ratio {number(self.ratio)}"]
        said += self.said_of(self.labels, False)
        said[-1] += f" on the {self.side} side"
        if self.efficiency < 1.0 or self.efficiency_back < 1.0:
            said.append(f"efficiency {number(self.efficiency)}, backward {number(self.efficiency_back)}")
        if self.error is not None:
            largest = max(abs(value) for value in self.error)
            said.append(f"transmission error up to {number(largest)} rad in {len(self.error)} points")
        return ", ".join(said)


@dataclass(frozen=True, slots=True, kw_only=True)
class Spline(Teeth):
    r"""Splined shafts on one axis: play between two joints that turn together.

    The deflection is :math:`\phi_\text{in} - \phi_\text{out} - x_0`; beyond half the play its torque is that
    of :class:`Gear`.

    Attributes:
        stiffness: Of the teeth [N*m/rad].
        damping: In contact only [N*m*s/rad].
        play: Total play about the axis [rad].
        offset: x_0, the middle of the play [rad].
    """

    stiffness: float = parameter("N*m/rad", rule="positive")
    damping: float = parameter("N*m*s/rad", rule="zero or more", default=0.0)
    play: float = parameter("rad", rule="zero or more", default=0.0)
    offset: float = parameter("rad", default=0.0)
    on: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Rack(Teeth):
    r"""A pinion and a rack, with play: a turning and a sliding joint.

    The deflection is a way along the pitch line, :math:`r \phi_\text{in} - s_\text{out} - x_0`; beyond half
    the play its force is that of :class:`Gear`. The pinion gets r times the force, the rack the force along
    its axis, each with its reaction on its own parent.

    Attributes:
        radius: Pitch radius r of the pinion; negative for the opposite way [m].
        stiffness: Of the teeth, along the pitch line [N/m].
        damping: In contact only [N*s/m].
        play: Total play along the pitch line [m].
        offset: x_0, the middle of the play [m].
    """

    along: ClassVar[bool] = True
    slide: ClassVar[tuple[bool, bool]] = (False, True)
    instead: ClassVar[str] = "the pinion for the input and the rack for the output"
    labels: ClassVar[Mapping[str, str]] = {"radius": "radius", **Teeth.labels}

    radius: float = parameter("m")
    stiffness: float = parameter("N/m", rule="positive")
    damping: float = parameter("N*s/m", rule="zero or more", default=0.0)
    play: float = parameter("m", rule="zero or more", default=0.0)
    offset: float = parameter("m", default=0.0)
    on: bool = True

    def __post_init__(self) -> None:
        """Check the numbers."""
        Teeth.__post_init__(self)
        if abs(self.radius) < LEAST:
            raise InvalidParameterError(self, "radius", "other than zero", self.radius)

    @property
    def shares(self) -> tuple[float, float]:
        """Derivatives a and -b of the deflection over the positions: the radius and -1."""
        return self.radius, 1.0
