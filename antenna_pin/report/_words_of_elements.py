"""Drives and springs in words: one entry for each kind."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from antenna_pin.readable import number, readable
from antenna_pin.report._runs import ReportedRun
from antenna_pin.scenario import ConstantDrive, DriveSpec, Scenario, SineDrive, SpringSpec, TableDrive

__all__ = ["DRIVES", "GIVEN", "names_of_elements", "words_of_elements"]

#: Digits of what people gave: as many as they wrote.
GIVEN = 10


def _constant(drive: ConstantDrive, unit: str) -> str:
    return f"constant {readable(drive.value, unit, GIVEN)}"


def _sine(drive: SineDrive, unit: str) -> str:
    phase = f" + {readable(drive.phase, 'rad', GIVEN)}" if drive.phase else ""
    frequency = number(drive.frequency, GIVEN)
    return f"{readable(drive.amplitude, unit, GIVEN)} × sin(2π · {frequency} Hz · t{phase})"


def _table(drive: TableDrive, unit: str) -> str:
    largest = max(abs(value) for value in drive.torque)
    where = "" if drive.file is None else f" of {drive.file}"
    return (
        f"table{where}: {len(drive.time)} points from {number(drive.time[0])} to {number(drive.time[-1])} s, "
        f"{drive.interpolation} between them, up to {readable(largest, unit)}"
    )


#: What is said of each kind of drive, whose force or torque has the unit.
DRIVES: dict[type[Any], Callable[[Any, str], str]] = {
    ConstantDrive: _constant,
    SineDrive: _sine,
    TableDrive: _table,
}


def _spring(spring: SpringSpec) -> str:
    slides = spring.motion == "translation"
    units = ("N/m", "N s/m", "m") if slides else ("N m/rad", "N m s/rad", "rad")
    values = (spring.stiffness, spring.damping, spring.rest_angle)
    words = ("stiffness", "damping", "at rest at")
    return ", ".join(
        f"{word} {readable(value, unit, GIVEN)}"
        for word, value, unit in zip(words, values, units, strict=True)
        if value
    )


def _drive(drive: DriveSpec) -> str:
    return DRIVES[type(drive)](drive, "N" if drive.motion == "translation" else "N m")


def words_of_elements(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Yield each drive and each spring of a scenario, with what it does."""
    for name, drive in scenario.drives.items():
        text = _drive(drive)
        if drive.joint != name:
            text += f", at {drive.joint}"
        clearance = scenario.clearance.get(drive.joint)
        if clearance is not None and clearance.model != "ideal":
            text += f", about the {drive.axis}'s axis"
        yield f"drive {name}", text
    for name, spring in scenario.springs.items():
        yield f"spring {name}", _spring(spring) + ("" if spring.joint == name else f", at {spring.joint}")


def names_of_elements(run: ReportedRun) -> Iterator[tuple[str, str]]:
    """Yield the names of drives and springs of a system built in Python, which is all a result tells."""
    for dimension, word in (("drive", "drives"), ("spring", "springs")):
        if names := run.names(dimension):
            yield word, ", ".join(names)
