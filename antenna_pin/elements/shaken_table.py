"""A base shaken by a table of displacement, velocity or acceleration over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from antenna_pin.base.parameters import parameter
from antenna_pin.base.readable import readable
from antenna_pin.elements.composed_courses import curve_term, going_on
from antenna_pin.elements.curve import check_covers, check_table, points_and_middles
from antenna_pin.elements.reference import pieces
from antenna_pin.elements.shake import Shake
from antenna_pin.errors import InvalidParameterError


@dataclass(frozen=True, slots=True, kw_only=True)
class TableShake(Shake):
    """Base motion by a table of displacement, velocity or acceleration; the others follow exactly.

    A displacement is joined by cubics whose second derivative is continuous; a velocity, or an acceleration,
    by straight lines. The integrals of the last two start at ``start_displacement`` and, of an acceleration,
    ``start_velocity``. Their final values are in the description: the integral of a measured acceleration
    drifts, and is not corrected.

    Attributes:
        of: Quantity of the course.
        file: Where the table came from, relative to the scenario's folder; None if it is given as numbers.
        time: Strictly increasing, at least two; a run must lie within them [s].
        course: A number for each time, in SI units once multiplied by ``scale``.
        scale: 9.80665 for accelerations in g [-].
        start_displacement: At the first time, of a velocity or acceleration [rad] ([m]).
        start_velocity: At the first time, of an acceleration [rad/s] ([m/s]).
    """

    columns: ClassVar[tuple[str, str]] = ("time", "course")
    at_start: ClassVar[tuple[str, ...]] = ("scale", "start_displacement", "start_velocity", "fade_in")

    of: Literal["displacement", "velocity", "acceleration"]
    file: str | None = None
    time: tuple[float, ...] = parameter("s", sizes=(0,), repr=False)
    course: tuple[float, ...] = parameter("1", sizes=(0,), repr=False)
    scale: float = parameter("1", default=1.0)
    start_displacement: float = parameter("rad", sliding="m", default=0.0)
    start_velocity: float = parameter("rad/s", sliding="m/s", default=0.0)

    def __post_init__(self) -> None:
        """Check the table, and that no start is given of what the table has itself."""
        Shake.__post_init__(self)
        check_table(self, "course")
        own = ("displacement", "velocity", "acceleration").index(self.of)
        for name in ("start_displacement", "start_velocity")[own:]:
            if getattr(self, name):
                raise InvalidParameterError(self, name, f"left out: the table is of the {self.of}")

    @classmethod
    def units_of_columns(cls, table: Mapping[str, Any]) -> dict[str, str]:
        """Return the unit of the course in a scenario's file; none beside ``scale``."""
        unit = "m" if table.get("direction") is not None else "rad"
        per = {"displacement": "", "velocity": "/s", "acceleration": "/s**2"}.get(str(table.get("of")))
        return {} if per is None or "scale" in table else {"course": unit + per}

    @property
    def instants(self) -> tuple[float, ...]:
        """Its points, where a derivative jumps, and the middles between them [s]."""
        return tuple(sorted({*points_and_middles(self.time), *self.faded}))

    def terms(self) -> tuple[float, ...]:
        """Return the displacement for kernels: a cubic between points."""
        given = self.scale * np.array(self.course)
        if self.of == "displacement":
            return curve_term(self.time, tuple(given.tolist()), "smooth")
        steps = np.diff(self.time)
        slopes = np.diff(given) / steps
        found = np.zeros((len(steps), 4))
        place, speed = self.start_displacement, self.start_velocity
        for k, (step, slope, value) in enumerate(zip(steps, slopes, given[:-1], strict=True)):
            if self.of == "velocity":
                found[k] = 0.0, slope / 2.0, value, place
            else:
                found[k] = slope / 6.0, value / 2.0, speed, place
                speed += (slope / 2.0 * step + value) * step
            place = float(np.polyval(found[k], step))
        return pieces(going_on(self.time), found[:, ::-1].tolist())

    def check_span(self, place: str, begin: float, end: float) -> None:
        """Refuse a run that the table does not cover."""
        check_covers(self.time, place, begin, end)

    def words(self, slides: bool = False) -> str:
        """Return what it is in words, the drift at its end as well."""
        where = "" if self.file is None else f" of {self.file}"
        place, speed, _ = self.at(self.time[-1])
        way = ("m", "m/s") if self.slides else ("rad", "rad/s")
        ends = [readable(place, way[0]), readable(speed, way[1])]
        drift = "" if self.of == "displacement" else f", ends at {' and '.join(ends)}"
        return f"{self.way()}: table{where} of {self.of}, {len(self.time)} points{drift}{self.said_fade()}"
