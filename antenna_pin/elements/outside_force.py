"""A force and torque from outside on a link, over time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

from antenna_pin.base.parameters import parameter
from antenna_pin.base.readable import GIVEN, number, readable
from antenna_pin.base.records import Floats, Triple
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.composed_courses import Table
from antenna_pin.elements.courses import Sine
from antenna_pin.elements.curve import Interpolation, both_given, check_covers, check_table
from antenna_pin.elements.desk_kernels import Desk, turned
from antenna_pin.elements.element import packed
from antenna_pin.elements.on_links import AtPoint
from antenna_pin.elements.reference import Reference
from antenna_pin.elements.term_kernels import course
from antenna_pin.errors import InvalidParameterError

_NONE = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class OutsideForce(AtPoint):
    r"""A force at a point of a link, and a torque, over one course.

    .. math:: (F, M)(t) = s \, c(t) \, (F_0, M_0), \quad
              c(t) = 1, \ \sin(2 \pi f t + \varphi), \ \text{of a table, or of a reference}

    In the world's axes a direction stays, in the link's it turns with the link; the point goes with the link
    in both.

    Attributes:
        force: F_0, (3,) [N].
        torque: M_0, (3,) [N*m].
        axes: Whether these two are in the axes of the ``link`` or of the ``world``.
        follows: A reference, whose value c is [-]; None for none.
        value: s, what both are multiplied by [-]; what a controller commands.
        frequency: f, of a course that swings [Hz]; None where nothing swings.
        phase: varphi, of a course that swings, at t = 0 [rad].
        file: Where a table came from, relative to the scenario's folder; None if given as numbers.
        interpolation: Of a table, ``linear`` or ``cubic``, which is monotone between points: no overshoot.
        time: Of a table, strictly increasing, at least two [s]. A run must lie within them.
        factors: c of a table, one for each time [-].
    """

    kernels: ClassVar[str] = __name__
    columns: ClassVar[tuple[str, str]] = ("time", "factors")
    commanded: ClassVar[str] = "value"

    force: Triple = parameter("N", sizes=(3,), default=_NONE)
    torque: Triple = parameter("N*m", sizes=(3,), default=_NONE)
    axes: Literal["link", "world"] = "link"
    follows: Reference | None = None
    value: float = parameter("1", default=1.0)
    frequency: float | None = parameter("Hz", rule="positive", default=None)
    phase: float = parameter("rad", default=0.0)
    file: str | None = None
    interpolation: Interpolation = "linear"
    time: tuple[float, ...] | None = parameter("s", sizes=(0,), default=None, repr=False)
    factors: tuple[float, ...] | None = parameter("1", sizes=(0,), default=None, repr=False)

    def __post_init__(self) -> None:
        """Check the parameters, and that it has one course and something to do."""
        AtPoint.__post_init__(self)
        if not any((*self.force, *self.torque)):
            raise InvalidParameterError(self, "force", "other than zero, or torque", said="neither")
        both_given(self, "time", "factors")
        courses = {"frequency": self.frequency, "time": self.time, "follows": self.follows}
        several = [name for name, course in courses.items() if course is not None]
        if several[1:]:
            rule = f"omitted if {several[1]} is given: a force has one course; follow a sum, or use two"
            raise InvalidParameterError(self, several[0], rule)
        if self.time is not None:
            check_table(self, "factors")
        if self.phase and self.frequency is None:
            raise InvalidParameterError(self, "frequency", "given beside a phase", said="none")

    @property
    def instants(self) -> tuple[float, ...]:
        """Points of its table, of cubics their middles too; those of its reference [s]."""
        if self.time is not None and self.interpolation == "linear":
            return self.time
        return () if self.course is None else self.course.instants

    @property
    def longest_step(self) -> float:
        """Longest step that resolves the course [s]."""
        return math.inf if self.course is None else self.course.longest_step

    @property
    def course(self) -> Reference | None:
        """Its course over time; None if it is constant."""
        if self.frequency is not None:
            return Sine(amplitude=1.0, frequency=self.frequency, phase=self.phase)
        if self.time is not None and self.factors is not None:
            return Table(time=self.time, values=self.factors, interpolation=self.interpolation)
        return self.follows

    @packed
    def in_world(self) -> bool:
        """Force and torque in the world's axes."""
        return self.axes == "world"

    @packed
    def course_length(self) -> int:
        """Number of words of its course."""
        return len(self.tail())

    def tail(self) -> tuple[float, ...]:
        """Return its course for kernels."""
        return () if self.course is None else self.course.terms()

    def check_span(self, place: str, begin: float, end: float) -> None:
        """Refuse a run in which its course is not known."""
        if self.course is not None:
            check_covers(self.course.known, place, begin, end)

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        parts = [
            f"{what} ({', '.join(readable(one, unit, GIVEN) for one in numbers)})"
            for what, numbers, unit in (("force", self.force, "N"), ("torque", self.torque, "N m"))
            if any(numbers)
        ]
        text = f"{' and '.join(parts)} on {self.at[0]}, axes of the {self.axes}"
        if self.value != 1.0:
            text += f", times {number(self.value, GIVEN)}"
        if self.frequency is not None:
            phase = f" + {self.text_of('phase', slides)}" if self.phase else ""
            text += f", times sin(2π · {number(self.frequency, GIVEN)} Hz · t{phase})"
        if self.time is not None:
            where = "" if self.file is None else f" of {self.file}"
            text += f", times a table{where} of {len(self.time)} points"
        if self.follows is not None:
            text += f", times {self.follows.words(slides)}"
        return text


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def act(own: OutsideForce, tail: Floats, t: float, desk: Desk) -> None:
    """Write force and torque on the link."""
    value = own.value
    if own.course_length > 0:
        factor, _, _ = course(tail, 0, own.course_length, t)
        value *= factor
    link = desk[1][0]
    f, m = own.force, own.torque
    fx, fy, fz, mx, my, mz = f[0], f[1], f[2], m[0], m[1], m[2]
    if not own.in_world:
        fx, fy, fz = turned(link.rotation, fx, fy, fz)
        mx, my, mz = turned(link.rotation, mx, my, mz)
    link.force[0], link.force[1], link.force[2] = value * fx, value * fy, value * fz
    link.torque[0], link.torque[1], link.torque[2] = value * mx, value * my, value * mz
