"""Poincaré sections: stroboscopes of a drive's period, and surfaces crossed."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import bare
from antenna_pin.base.rules import NumberRule, Positive
from antenna_pin.base.units import quantity
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.run.simulation import Angle, Force, Gap, Moment, Rate
from antenna_pin.scenario import Scenario

# Relative difference of equal periods written in different units.
_SAME = 1e-12

_DIRECTIONS: dict[str, Literal[-1, 0, 1]] = {"rising": 1, "falling": -1, "both": 0}


@takes()
@dataclass(frozen=True, slots=True, kw_only=True)
class Stroboscope:
    """Section once a period, at the times ``(phase + k) period``."""

    # [s]; None for that of the scenario's drives, which then have to have one and the same
    period: Positive | None = None
    drive: str | None = None  # whose period it is, where drives differ; None otherwise
    # part of the period at which it is examined, from 0 to below 1 [-]
    phase: Annotated[float, NumberRule("from 0 to below 1, a part of the period")] = 0.0

    def __post_init__(self) -> None:
        """Check what goes together."""
        if self.period is not None and self.drive is not None:
            raise InvalidParameterError(self, "drive", "left out with a period", self.drive)

    def period_in(self, scenario: Scenario) -> float:
        """Return its period in a scenario [s]."""
        return drive_period(scenario, self.drive) if self.period is None else self.period

    @property
    def words(self) -> str:
        """Description."""
        whose = "a period"
        if self.period is not None:
            whose = f"every {self.period:.9g} s"
        elif self.drive is not None:
            whose = f"a period of drive {self.drive}"
        once = "" if self.period is not None else "once "
        return f"{once}{whose}" + (f", at {self.phase:.6g} of it" if self.phase else "")


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossing:
    """Section at zeros of a function of the state, located on the dense output."""

    # the function: a condition of :mod:`antenna_pin.run.simulation`, as ``Angle("hinge", 0.0)``, or one of
    # your own, ``(moment) -> float``, with which the compiled engine is slower
    when: Callable[[Moment], float]
    direction: Literal[-1, 0, 1] = 1  # +1: rising; -1: falling; 0: both
    name: str = ""  # its name; made from the condition if left out

    def __post_init__(self) -> None:
        """Check the kinds."""
        if not callable(self.when):
            raise InvalidParameterError(self, "when", "a function of a Moment", self.when)
        if self.direction not in (-1, 0, 1):
            raise InvalidParameterError(self, "direction", "-1, 0 or 1", self.direction)

    @property
    def words(self) -> str:
        """Description."""
        how = {1: "rising", -1: "falling", 0: "either way"}[self.direction]
        return f"{self.name or _words_of(self.when)}, {how}"


Section = Stroboscope | Crossing
"""Condition at which a motion is sampled."""


def _words_of(when: Callable[[Moment], float]) -> str:
    if isinstance(when, Angle | Rate):
        return f"{type(when).__name__.lower()} of {when.joint} = {when.value:.9g}"
    if isinstance(when, Gap | Force):
        return f"{type(when).__name__.lower()} of {when.contact} = {when.value:.9g}"
    return str(getattr(when, "__name__", type(when).__name__))


# --- period of drives ---------------------------------------------------------------------------------------


@takes()
def drive_period(scenario: Scenario, drive: str | None = None) -> float:
    """Return the period of a scenario's drives [s].

    A sine and a motion that swings have that of their frequency, a motion that turns on at a constant rate
    that of a turn. Constant drives have any; curves, tables and controllers have none.

    Args:
        scenario: The scenario.
        drive: Name of the drive; of all, which must agree, if left out.

    Raises:
        UnknownNameError: There is no such drive.
        InvalidParameterError: The drive has no period, none has one, or they differ.
    """
    place = f"scenario {scenario.name}" if scenario.name else "scenario"
    if drive is not None:
        if drive not in scenario.drives:
            raise UnknownNameError(place, "drive", drive, scenario.drives)
        found = _period(scenario.drives[drive])
        if found is None:
            raise InvalidParameterError(
                place,
                f"drives.{drive}",
                "periodic: a sine, a motion that swings, or one that turns at a "
                "constant rate; or give the period",
                said=f"kind {_kind(scenario.drives[drive])!r}",
            )
        return found
    periods = {name: found for name, one in scenario.drives.items() if (found := _period(one)) is not None}
    if not periods:
        kinds = ", ".join(f"{name} ({_kind(one)})" for name, one in scenario.drives.items()) or "no drive"
        raise InvalidParameterError(place, "drives", "periodic, or the period be given", said=kinds)
    least, most = min(periods.values()), max(periods.values())
    if most - least > _SAME * most:
        said = ", ".join(f"{name} {period:.9g} s" for name, period in periods.items())
        raise InvalidParameterError(
            place, "drives", "of one period, or one of them or the period be given", said=said
        )
    return least


def _kind(table: object) -> str:
    return str(getattr(table, "kind", type(table).__name__))


def _period(table: object) -> float | None:
    """Return the period of a drive's table [s]; None without one."""
    frequency: float | None = getattr(table, "frequency", None)
    rate = getattr(table, "rate", 0.0) or 0.0
    grows = rate or any(getattr(table, "velocity", ()) or ()) or getattr(table, "coefficients", ())
    if getattr(table, "time", None) is not None:
        return None
    if frequency is not None:
        return None if grows else 1.0 / float(frequency)
    if rate and not getattr(table, "coefficients", ()) and getattr(table, "motion", None) != "translation":
        return 2.0 * math.pi / abs(float(rate))
    return None


# --- sections as text ---------------------------------------------------------------------------------------

_CROSSING = re.compile(r"(angle|rate|gap|force)[.: ]\s*(.+?)\s*=\s*([^=]+)")


@takes()
def section_of(text: str, direction: str = "rising", phase: float = 0.0) -> Section:
    """Return the section that a text describes.

    ``period`` is once a period of the drives, ``period=DRIVE`` of that drive, ``period=0.5 s`` of a given
    time; ``angle.JOINT=VALUE``, ``rate.JOINT=VALUE``, ``gap.CONTACT=VALUE`` and ``force.CONTACT=VALUE`` are
    surfaces.

    Args:
        text: The text.
        direction: Of a crossing: ``rising``, ``falling`` or ``both``.
        phase: Of a stroboscope [-].
    """
    said = text.strip()
    if direction not in _DIRECTIONS:
        raise UnknownNameError("section", "direction", direction, _DIRECTIONS)
    head, equals, tail = said.partition("=")
    if head.strip() == "period":
        if not equals:
            return Stroboscope(phase=phase)
        if re.match(r"\s*[-+.\d]", tail):
            return Stroboscope(period=quantity(bare(tail), "s", "section period"), phase=phase)
        return Stroboscope(drive=tail.strip().removeprefix("drives."), phase=phase)
    match = _CROSSING.fullmatch(said)
    if match is None:
        raise InvalidParameterError(
            "section",
            "text",
            "period, period=DRIVE, period=TIME, angle.JOINT=VALUE, rate.JOINT=VALUE, gap.CONTACT=VALUE or "
            "force.CONTACT=VALUE",
            text,
        )
    if phase:
        raise InvalidParameterError("section", "phase", "left out for a crossing, which has none", phase)
    kind, name, value = match.groups()
    units = {"angle": ("rad", "m"), "rate": ("rad/s", "m/s"), "gap": ("m",), "force": ("N",)}[kind]
    number = quantity(bare(value), units if len(units) > 1 else units[0], f"section {kind}.{name}")
    kinds: dict[str, Callable[[str, float], Callable[[Moment], float]]]
    kinds = {"angle": Angle, "rate": Rate, "gap": Gap, "force": Force}
    return Crossing(when=kinds[kind](name, number), direction=_DIRECTIONS[direction], name=said)
