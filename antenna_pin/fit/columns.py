"""What a fit file says of the columns of a record: what was measured, by which sensor, how it is compared."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, model_validator

from antenna_pin.base.units import any_quantity, shown
from antenna_pin.scenario.spec import Count, Quantity, Spec, refuse

__all__ = ["BlowsSpec", "ColumnSpec", "FilterSpec", "SpectrumSpec"]


def _quantity(value: object) -> object:
    if any_quantity(value) is None:
        refuse(f"must be a number, or text with a unit, got {shown(value)}", value=value)
    return value


#: A number or text with a unit; which unit fits is known once the model's column is.
AnyQuantity = Annotated[Any, BeforeValidator(_quantity)]

PositiveFrequency = Annotated[float, Quantity("Hz", "positive")]
PositiveSpan = Annotated[float, Quantity("s", "positive")]
Triple = tuple[float, float, float]


class FilterSpec(Spec):
    """The low-pass filter that a reading went through: Butterworth's, causal, at rest at the record's start.

    Attributes:
        order: Of it [-].
        corner: Where it is 3 dB down [Hz].
    """

    order: Annotated[int, BeforeValidator(Count(1, 12).read)] = 4
    corner: PositiveFrequency


class SpectrumSpec(Spec):
    """A curve compared by the powers of bands of its spectrum (Welch 1967), as logarithms.

    Attributes:
        edges: Of the bands, rising [Hz].
        segment: Length of a segment; half of it overlaps with the next [s].
    """

    edges: tuple[PositiveFrequency, ...]
    segment: PositiveSpan

    @model_validator(mode="after")
    def _check_bands(self) -> Self:
        if len(self.edges) < 2 or not all(a < b for a, b in zip(self.edges, self.edges[1:], strict=False)):
            refuse(f"must be two or more frequencies that rise, got {shown(self.edges)}", "edges")
        return self


class BlowsSpec(Spec):
    """A curve compared by a histogram of its blows: stretches in which its size is above a level.

    Each counts in the two bins between whose middles its logarithm lies, in parts, so that counts follow the
    model's numbers without jumps.

    Attributes:
        level: Above which a blow lasts, in the column's unit.
        of: What is counted: largest values ``peaks``, ``intervals`` from one onset to the next, integrals
            over time ``impulses``.
        edges: Of the bins, positive and rising, in the unit of what is counted.
    """

    level: AnyQuantity
    of: Literal["peaks", "intervals", "impulses"] = "peaks"
    edges: tuple[AnyQuantity, ...]

    @model_validator(mode="after")
    def _check_bins(self) -> Self:
        numbers = [(any_quantity(edge) or (math.nan, ""))[0] for edge in self.edges]
        rising = all(a < b for a, b in zip(numbers, numbers[1:], strict=False))
        if len(numbers) < 3 or not numbers[0] > 0.0 or not rising:
            refuse(f"must be three or more positive numbers that rise, got {shown(self.edges)}", "edges")
        if not (any_quantity(self.level) or (0.0, ""))[0] > 0.0:
            refuse(f"must be positive, got {shown(self.level)}", "level")
        return self


#: Keys that each sensor must have, and those that it may have, beside those of all.
_OF_SENSOR: Mapping[str, tuple[frozenset[str], frozenset[str]]] = {
    "variable": (frozenset({"of"}), frozenset()),
    "accelerometer": (frozenset({"link", "direction"}), frozenset({"point", "gravity"})),
    "encoder": (frozenset({"of", "resolution"}), frozenset({"rounding"})),
    "force-cell": (frozenset({"joint", "direction"}), frozenset({"link", "load"})),
}


class ColumnSpec(Spec):
    """One column of a record: what its sensor reads of the motion, times ``gain``, plus ``offset``.

    Attributes:
        column: Name in the file; that of this table if left out.
        unit: In which the file has it; the SI unit of what is read if left out.
        sensor: ``variable``, a quantity of the result as it is; ``accelerometer``, the specific force at a
            point of a link; ``encoder``, a quantity in steps; ``force-cell``, what a joint passes on.
        of: Of variable and encoder: a quantity by its name, as ``motion_angle[hinge]``.
        link: Of an accelerometer: the link that it is fixed on. Of a force cell: in whose axes its direction
            is; the world's if left out.
        point: Of an accelerometer: its place in the link's frame [m].
        direction: Its axis, in the link's axes; only the ratio of the numbers counts.
        gravity: Whether the accelerometer reads the specific force, acceleration less that of gravity, as
            all that go down to 0 Hz do; else the acceleration.
        resolution: Of an encoder: its step.
        rounding: Of an encoder: to the ``nearest`` step, or ``down`` to the last that was passed.
        joint: Of a force cell: the joint or closure, whose load from parent to child it reads.
        load: Of a force cell: ``force`` or ``torque``.
        gain: Of the reading [-].
        offset: Of the reading, in the unit of what is read.
        filter: What the reading went through.
        compare: ``curve``, all rows; ``rms``, one number; ``spectrum``; ``blows``.
        spectrum: How, where spectra are compared.
        blows: How, where blows are.
        sd: Standard deviation of the noise: of a row of a curve, or of the rms, in the unit of what is read;
            of a band's power as a part of it [-]. Of bands and blows it follows from counts if left out.
        weight: Of the column's residuals beside the others' [-].
    """

    column: str | None = None
    unit: str | None = None
    sensor: Literal["variable", "accelerometer", "encoder", "force-cell"] = "variable"
    of: str | None = None
    link: str | None = None
    point: tuple[Any, Any, Any] | None = None
    direction: Triple | None = None
    gravity: bool | None = None
    resolution: AnyQuantity = None
    rounding: Literal["nearest", "down"] | None = None
    joint: str | None = None
    load: Literal["force", "torque"] | None = None
    gain: float = 1.0
    offset: AnyQuantity = 0.0
    filter: FilterSpec | None = None
    compare: Literal["curve", "rms", "spectrum", "blows"] = "curve"
    spectrum: SpectrumSpec | None = None
    blows: BlowsSpec | None = None
    sd: AnyQuantity = None
    weight: Annotated[float, Quantity("1", "positive")] = 1.0

    @model_validator(mode="after")
    def _check_sensor(self) -> Self:
        needed, allowed = _OF_SENSOR[self.sensor]
        every = {name for pair in _OF_SENSOR.values() for part in pair for name in part}
        for name in sorted(every):
            given = getattr(self, name) is not None
            if name in needed and not given:
                refuse(f"is missing; a sensor of kind {self.sensor} must have it", name)
            if given and name not in needed | allowed:
                refuse(f"must be left out of a sensor of kind {self.sensor}", name)
        if self.direction is not None and not any(self.direction):
            refuse(f"must be a direction, not all zeros, got {shown(self.direction)}", "direction")
        return self

    @model_validator(mode="after")
    def _check_comparison(self) -> Self:
        for name in ("spectrum", "blows"):
            given = getattr(self, name) is not None
            if self.compare == name and not given:
                refuse(f'is missing; compare = "{name}" must have it', name)
            if given and self.compare != name:
                refuse(f'must be left out but for compare = "{name}"', name)
        if self.compare in ("curve", "rms") and self.sd is None:
            refuse("is missing; give the standard deviation of the column's noise", "sd")
        if self.compare == "blows" and self.sd is not None:
            refuse("must be left out of blows, whose noise follows from their counts", "sd")
        if self.sd is not None and not (any_quantity(self.sd) or (0.0, ""))[0] > 0.0:
            refuse(f"must be positive, got {shown(self.sd)}", "sd")
        if self.gain == 0.0 or not math.isfinite(self.gain):
            refuse(f"must be a number other than zero, got {self.gain}", "gain")
        if self.filter is not None and self.sensor == "encoder":
            refuse("must be left out of an encoder, which counts", "filter")
        return self
