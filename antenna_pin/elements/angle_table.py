"""Springs whose torque is a table over the joint's angle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from antenna_pin.base.parameters import parameter
from antenna_pin.base.readable import number, readable
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.curve import Interpolation, areas, check_table, cubics
from antenna_pin.elements.curve_kernels import area, curve
from antenna_pin.elements.element import LOSS, Element, Integral, packed
from antenna_pin.errors import InvalidParameterError

Outside = Literal["hold", "extend", "refuse"]
"""What follows beyond a table: its last torque, that with its slope there, or the end of the run."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TableSpring(Element):
    """A spring whose torque is a table over the joint's angle, as of a harness.

    Between points the torque is a monotone cubic: no overshoot, its slope is continuous; or a straight line.
    What it stores is the integral of the torque, from the table's first angle on: it conserves energy.
    Angles count whole turns.

    Attributes:
        file: Where the table came from, relative to the scenario's folder; None if given as numbers.
        interpolation: ``cubic`` or ``linear``.
        angle: Strictly increasing, at least two [rad] ([m]).
        torque: On the child, one for each angle [N*m] ([N]).
        outside: Beyond the table: ``hold`` its last torque, ``extend`` its slope, or ``refuse``: the run
            ends.
    """

    kernels: ClassVar[str] = __name__
    traced: ClassVar[bool] = True
    columns: ClassVar[tuple[str, ...]] = ("angle", "torque")
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS,)

    file: str | None = None
    interpolation: Interpolation = "cubic"
    angle: tuple[float, ...] = parameter("rad", sliding="m", sizes=(0,), repr=False)
    torque: tuple[float, ...] = parameter("N*m", sliding="N", sizes=(0,), repr=False)
    outside: Outside = "hold"
    on: bool = True

    def __post_init__(self) -> None:
        """Check the table."""
        Element.__post_init__(self)
        for name in self.columns[1:]:
            check_table(self, name, "angle", "rad")

    @property
    def ends(self) -> tuple[float, ...]:
        """Angles at which a run must end [rad] ([m])."""
        return (self.angle[0], self.angle[-1]) if self.outside == "refuse" else ()

    @property
    def has_kinks(self) -> bool:
        """Return the ends of the table, unless it continues."""
        return self.outside != "refuse"

    def check_begin(self, place: str, angle: float) -> None:
        """Refuse a start beyond a table that has nothing there."""
        if self.ends and not self.angle[0] <= angle <= self.angle[-1]:
            rule = f"a table that covers the start, at {angle:g}; extend it, or choose what is outside"
            raise InvalidParameterError(place, "angle", rule, (self.angle[0], self.angle[-1]))

    @packed
    def points(self) -> int:
        """Number of points."""
        return len(self.angle)

    @packed
    def extends(self) -> bool:
        """Continuation of the slope beyond the table."""
        return self.outside != "hold"

    def tail(self) -> tuple[float, ...]:
        """Return the curve through its points, and its integral up to each."""
        return self.curve_of(self.torque)

    def curve_of(self, torque: tuple[float, ...]) -> tuple[float, ...]:
        """Return the curve through some torques at the angles, and its integral up to each."""
        curve = cubics(self.angle, torque, self.interpolation)
        return (*curve, *areas(curve, len(self.angle)))

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        torques = [value for name in self.columns[1:] for value in getattr(self, name)]
        largest = readable(max(map(abs, torques)), self.unit("torque", slides))
        where = "" if self.file is None else f" of {self.file}"
        unit = self.unit("angle", slides)
        span = f"{number(self.angle[0])} to {number(self.angle[-1])} {unit}"
        beyond = {"hold": "held", "extend": "extended", "refuse": "refused"}[self.outside]
        points = f"{len(self.angle)} points from {span}, {self.interpolation} between them, {beyond} beyond"
        return f"table{where}: {points}, up to {largest}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def torque_at(words: Floats, at: int, shape: tuple[int, bool], angle: float) -> tuple[float, float]:
    """Return torque and slope of the curve at words[at:]; ``shape``: points, whether it continues."""
    points, goes_on = shape
    inside = min(max(angle, words[at]), words[at + points - 1])
    value, slope = curve(words, at, points, inside)
    if angle != inside:
        slope = slope if goes_on else 0.0
        value += slope * (angle - inside)
    return float(value), float(slope)


@inlined
def given_at(words: Floats, at: int, shape: tuple[int, bool], angle: float) -> float:
    """Integral of the torque up to an angle [J]."""
    points, goes_on = shape
    inside = min(max(angle, words[at]), words[at + points - 1])
    found = area(words, at, points, inside)
    if angle != inside:
        beyond = angle - inside
        value, slope = curve(words, at, points, inside)
        found += value * beyond + (0.5 * slope * beyond * beyond if goes_on else 0.0)
    return float(found)


@inlined
def ends_at(words: Floats, at: int, points: int, angle: float) -> float:
    """Product of the ways to the table's ends: it passes zero there."""
    return float((angle - words[at]) * (angle - words[at + points - 1]))


@inlined
def effort(table: TableSpring, tail: Floats, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    value, _ = torque_at(tail, 0, (table.points, table.extends), angle)
    return value


@inlined
def stored(table: TableSpring, tail: Floats, angle: float) -> float:
    """Energy stored [J]."""
    return -given_at(tail, 0, (table.points, table.extends), angle)


@inlined
def kink(table: TableSpring, tail: Floats, t: float, angle: float, rate: float) -> float:
    """Return a function that passes zero at the ends of the table."""
    return ends_at(tail, 0, table.points, angle)
