"""A torque from a table over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import check, parameter
from antenna_pin.base.readable import number, readable
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.curve import Interpolation, check_covers, check_table, cubics, points_and_middles
from antenna_pin.elements.curve_kernels import curve
from antenna_pin.elements.element import Drive, packed


@dataclass(frozen=True, slots=True, kw_only=True)
class TableDrive(Drive):
    """A torque, or force at a sliding joint, interpolated in a table.

    Attributes:
        file: Where the table came from, relative to the scenario's folder; None if given as numbers.
        interpolation: ``linear`` or ``cubic``, which is monotone between points: no overshoot.
        time: Strictly increasing, at least two [s]. A run must lie within them.
        torque: One for each time [N*m] ([N]).
    """

    kernels: ClassVar[str] = __name__
    columns: ClassVar[tuple[str, str]] = ("time", "torque")

    file: str | None = None
    interpolation: Interpolation = "linear"
    time: tuple[float, ...] = parameter("s", sizes=(0,), repr=False)
    torque: tuple[float, ...] = parameter("N*m", sliding="N", sizes=(0,), repr=False)

    def __post_init__(self) -> None:
        """Check the table."""
        check(self)
        check_table(self, "torque")

    @property
    def instants(self) -> tuple[float, ...]:
        """Points of the table; of cubics, with work of eighth degree, their middles too [s]."""
        return self.time if self.interpolation == "linear" else points_and_middles(self.time)

    @packed
    def points(self) -> int:
        """Number of points."""
        return len(self.time)

    def tail(self) -> tuple[float, ...]:
        """Return the curve through its points."""
        return cubics(self.time, self.torque, self.interpolation)

    def check_span(self, place: str, begin: float, end: float) -> None:
        """Refuse a run that the table does not cover."""
        check_covers(self.time, place, begin, end)

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        largest = readable(max(abs(value) for value in self.torque), self.unit("torque", slides))
        where = "" if self.file is None else f" of {self.file}"
        points = f"{len(self.time)} points from {number(self.time[0])} to {number(self.time[-1])} s"
        return f"table{where}: {points}, {self.interpolation} between them, up to {largest}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def effort(table: TableDrive, tail: Floats, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    value, _ = curve(tail, 0, table.points, t)
    return value
