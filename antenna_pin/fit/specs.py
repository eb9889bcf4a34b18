"""Tables of a fit file: columns of a record, layout of its file, parameters and derived numbers."""

from __future__ import annotations

import ast
import functools
import math
import operator
import re
from collections.abc import Callable, Mapping
from datetime import datetime
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, field_validator, model_validator

from antenna_pin.base.units import any_quantity, shown
from antenna_pin.scenario.spec import Count, Quantity, Spec, refuse

__all__ = [
    "BlowsSpec",
    "ColumnSpec",
    "DerivedSpec",
    "FitParameterSpec",
    "LayoutSpec",
    "SpectrumSpec",
    "evaluate",
    "names_in",
]


# --- columns of a record ------------------------------------------------------------------------------------


def _quantity(value: object) -> object:
    if any_quantity(value) is None:
        refuse(f"must be a number, or text with a unit, got {shown(value)}", value=value)
    return value


#: A number or text with a unit, checked once the model's column is known.
_AnyQuantity = Annotated[Any, BeforeValidator(_quantity)]

_PositiveFrequency = Annotated[float, Quantity("Hz", "positive")]
_PositiveSpan = Annotated[float, Quantity("s", "positive")]
_Triple = tuple[float, float, float]


class _FilterSpec(Spec):
    """Low-pass filter of a reading: Butterworth, causal, at rest at the record's start.

    Attributes:
        order: Of it [-].
        corner: Where it is 3 dB down [Hz].
    """

    order: Annotated[int, BeforeValidator(Count(1, 12).read)] = 4
    corner: _PositiveFrequency


class SpectrumSpec(Spec):
    """Comparison by the logarithms of band powers of the spectrum (Welch 1967).

    Attributes:
        edges: Of the bands, rising [Hz].
        segment: Length of a segment; half of it overlaps with the next [s].
    """

    edges: tuple[_PositiveFrequency, ...]
    segment: _PositiveSpan

    @model_validator(mode="after")
    def _check_bands(self) -> Self:
        if len(self.edges) < 2 or not all(a < b for a, b in zip(self.edges, self.edges[1:], strict=False)):
            refuse(f"must be two or more frequencies that rise, got {shown(self.edges)}", "edges")
        return self


class BlowsSpec(Spec):
    """Comparison by a histogram of impacts: intervals in which a curve exceeds a level.

    Each counts in the two bins between whose middles its logarithm lies, in parts, so that counts follow the
    model's numbers without jumps.

    Attributes:
        level: Above which an impact lasts, in the column's unit.
        of: What is counted: largest values ``peaks``, ``intervals`` from one onset to the next, integrals
            over time ``impulses``.
        edges: Of the bins, positive and rising, in the unit of what is counted.
    """

    level: _AnyQuantity
    of: Literal["peaks", "intervals", "impulses"] = "peaks"
    edges: tuple[_AnyQuantity, ...]

    @model_validator(mode="after")
    def _check_bins(self) -> Self:
        numbers = [(any_quantity(edge) or (math.nan, ""))[0] for edge in self.edges]
        rising = all(a < b for a, b in zip(numbers, numbers[1:], strict=False))
        if len(numbers) < 3 or not numbers[0] > 0.0 or not rising:
            refuse(f"must be three or more positive numbers that rise, got {shown(self.edges)}", "edges")
        if not (any_quantity(self.level) or (0.0, ""))[0] > 0.0:
            refuse(f"must be positive, got {shown(self.level)}", "level")
        return self


#: Required and optional keys of each sensor, beside the common ones.
_OF_SENSOR: Mapping[str, tuple[frozenset[str], frozenset[str]]] = {
    "variable": (frozenset({"of"}), frozenset()),
    "accelerometer": (frozenset({"link", "direction"}), frozenset({"point", "gravity"})),
    "encoder": (frozenset({"of", "resolution"}), frozenset({"rounding"})),
    "force-cell": (frozenset({"joint", "direction"}), frozenset({"link", "load"})),
}


class ColumnSpec(Spec):
    """Column of a record: its sensor's reading of the motion, times ``gain``, plus ``offset``.

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
        impacts: How, where impacts are.
        sd: Standard deviation of the noise: of a row of a curve, or of the rms, in the unit of what is read;
            of a band's power as a part of it [-]. Of bands and impacts it follows from counts if left out.
        weight: Of the column's residuals beside the others' [-].
    """

    column: str | None = None
    unit: str | None = None
    sensor: Literal["variable", "accelerometer", "encoder", "force-cell"] = "variable"
    of: str | None = None
    link: str | None = None
    point: tuple[Any, Any, Any] | None = None
    direction: _Triple | None = None
    gravity: bool | None = None
    resolution: _AnyQuantity = None
    rounding: Literal["nearest", "down"] | None = None
    joint: str | None = None
    load: Literal["force", "torque"] | None = None
    gain: float = 1.0
    offset: _AnyQuantity = 0.0
    filter: _FilterSpec | None = None
    compare: Literal["curve", "rms", "spectrum", "blows"] = "curve"
    spectrum: SpectrumSpec | None = None
    blows: BlowsSpec | None = None
    sd: _AnyQuantity = None
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


# --- layout of a record's file ------------------------------------------------------------------------------

_SOME_DAY = datetime(2026, 5, 4, 10, 15, 30, 250000)


class LayoutSpec(Spec):
    """Layout of a record's file, most of it for texts.

    Attributes:
        delimiter: Between a text's columns; a blank is any number of blanks. Detected if left out.
        decimal: A text's decimal sign, point or comma. Detected if left out.
        encoding: Of a text, as Python calls it: ``utf-8``, ``latin-1``, ``utf-16``. A byte order mark comes
            before ``utf-8``.
        comment: With what a text's lines begin that do not count.
        skip: A text's lines in front of its column names, comments too [-].
        names: Of a text's columns, if no line of it has them.
        units_row: Whether a line beneath the names has the columns' units.
        time: Name of the column of times; a record of a run of this package has ``time``.
        time_unit: In which it is; where it is left out what the file says, else seconds.
        time_format: Of times that are stamps: ``iso`` (2026-05-04 10:15:30.25), or as Python's ``strptime``
            has it (``%d.%m.%Y %H:%M:%S,%f``); they count from the first row.
        rate: Of a file without times: how many rows a second has; they count from the first row [Hz].
    """

    delimiter: Annotated[str, Field(min_length=1, max_length=1)] | None = None
    decimal: Literal[".", ","] | None = None
    encoding: str = "utf-8"
    comment: Annotated[str, Field(min_length=1)] = "#"
    skip: Annotated[int, BeforeValidator(Count(0, 100_000).read)] = 0
    names: tuple[str, ...] | None = None
    units_row: bool = False
    time: str = "time"
    time_unit: str | None = None
    time_format: str | None = None
    rate: Annotated[float, Quantity("Hz", "positive")] | None = None

    @model_validator(mode="after")
    def _check_layout(self) -> Self:
        if self.decimal is not None and self.decimal == self.delimiter:
            refuse(f"must differ from decimal, got {shown(self.delimiter)} for both", "delimiter")
        try:
            "".encode(self.encoding)
        except (LookupError, ValueError):  # of what is no encoding, and of one that encodes nothing
            rule = "must be a text encoding that Python knows, such as utf-8, latin-1 or utf-16"
            refuse(f"{rule}, got {shown(self.encoding)}", "encoding")
        given = self.model_fields_set
        for name in ("time", "time_unit", "time_format"):
            if self.rate is not None and name in given and getattr(self, name) is not None:
                refuse("must be left out beside rate, which says when each row is", name)
        if self.time_format is not None and self.time_unit is not None:
            refuse("must be left out beside time_format, whose stamps have no unit", "time_unit")
        if self.time_format not in (None, "iso") and "%" not in str(self.time_format):
            rule = "must be iso, or a pattern such as %d.%m.%Y %H:%M:%S,%f"
            refuse(f"{rule}, got {shown(self.time_format)}", "time_format")
        if self.time_format not in (None, "iso"):
            _check_stamps(str(self.time_format))
        if self.names is not None and len(set(self.names)) < len(self.names):
            refuse(f"must be different names, got {shown(self.names)}", "names")
        return self


def _check_stamps(pattern: str) -> None:
    """Refuse a pattern of time stamps with unknown or repeated directives."""
    try:
        datetime.strptime(_SOME_DAY.strftime(pattern), pattern)
    except (ValueError, re.error) as error:
        said = f"{shown(pattern)} ({' '.join(str(error).split())})"
        refuse(
            f"must be iso, or a pattern of different directives that strptime reads, got {said}",
            "time_format",
        )


# --- expressions of parameters ------------------------------------------------------------------------------

_OPERATORS: Mapping[type, Callable[..., float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
_FUNCTIONS: Mapping[str, Callable[..., float]] = {
    "sqrt": math.sqrt,
    "exp": math.exp,
    "log": math.log,
    "min": min,
    "max": max,
}
_RULE = f"must be made of parameters, numbers, + - * / ** and {', '.join(_FUNCTIONS)}"


@functools.lru_cache(maxsize=256)
def _tree(text: str) -> ast.expr:
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ValueError(f"{_RULE}, got {text!r}") from None


def names_in(text: str) -> tuple[str, ...]:
    """Return the names of the parameters in an expression, in alphabetical order.

    Raises:
        ValueError: It is no expression, or has more in it than arithmetic; the message is a rule.
    """
    found: set[str] = set()

    def look(node: ast.expr) -> None:
        if isinstance(node, ast.Name):
            found.add(node.id)
        elif isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            look(node.left)
            look(node.right)
        elif isinstance(node, ast.UnaryOp) and type(node.op) in _OPERATORS:
            look(node.operand)
        elif _is_call(node):
            for one in node.args:  # type: ignore[attr-defined]
                look(one)
        elif not (isinstance(node, ast.Constant) and type(node.value) in (int, float)):
            raise ValueError(f"{_RULE}, got {ast.unparse(node)!r}")

    look(_tree(text))
    return tuple(sorted(found))


def evaluate(text: str, values: Mapping[str, float]) -> float:
    """Return the value of an expression that :func:`names_in` accepts.

    Args:
        text: The expression.
        values: Of the parameters in it [SI].

    Raises:
        ValueError: It has no finite real value there.
    """

    def value(node: Any) -> Any:
        if isinstance(node, ast.Constant):
            return float(node.value)  # type: ignore[arg-type]
        if isinstance(node, ast.Name):
            return values[node.id]
        if isinstance(node, ast.UnaryOp):
            return _OPERATORS[type(node.op)](value(node.operand))
        if isinstance(node, ast.BinOp):
            return _OPERATORS[type(node.op)](value(node.left), value(node.right))
        return _FUNCTIONS[node.func.id](*map(value, node.args))

    try:
        found = value(_tree(text))
    except (ArithmeticError, ValueError, TypeError):
        found = math.nan
    if isinstance(found, complex) or not math.isfinite(found):
        at = ", ".join(f"{name} = {values[name]:g}" for name in names_in(text))
        raise ValueError(f"{text} must be finite, got none for {at}")
    return float(found)


def _is_call(node: ast.expr) -> bool:
    return (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id in _FUNCTIONS
        and bool(node.args)
        and not node.keywords
    )


# --- parameters ---------------------------------------------------------------------------------------------


class _PriorSpec(Spec):
    """Prior of a parameter: a normal distribution.

    Attributes:
        mean: Its mean, in the parameter's unit.
        sd: Its standard deviation, in the parameter's unit.
    """

    mean: _AnyQuantity
    sd: _AnyQuantity


class FitParameterSpec(Spec):
    """Unknown number.

    Attributes:
        key: Key of the scenario, as a study has it, or several that get the same value; or a number of a
            record: ``records.NAME.clock_shift``, ``records.NAME.columns.COLUMN.gain`` or ``.offset``. Left
            out of a parameter that only numbers derived from it use.
        start: Where the search begins.
        between: Its bounds.
        scale: ``log`` for a positive number of which not even the size is known.
        prior: What is known of it from elsewhere, which counts like one more measurement.
        records: Whose it is; of all records if left out.
        title: What it is called in figures; its name if left out.
    """

    key: str | tuple[str, ...] = ()
    start: _AnyQuantity
    between: tuple[_AnyQuantity, _AnyQuantity] | None = None
    scale: Literal["linear", "log"] = "linear"
    prior: _PriorSpec | None = None
    records: tuple[str, ...] | None = None
    title: str = ""

    @property
    def keys_set(self) -> tuple[str, ...]:
        """Keys that the parameter sets."""
        return (self.key,) if isinstance(self.key, str) else self.key

    def numbers(self) -> tuple[float, float, float, str]:
        """Return start and bounds in SI units, infinite without bounds, and the unit."""
        texts = (self.start, *(self.between or ()))
        read = [any_quantity(text) or (0.0, "") for text in texts]
        unit = next((unit for _, unit in read if unit not in ("", "1")), "")
        written = str(self.start).strip().partition(" ")[2].strip()
        if unit and any_quantity(f"1 {written}") == (1.0, unit):
            unit = written  # as its author knows it: N/m**1.5, not kg/m**0.5/s**2
        low, high = (read[1][0], read[2][0]) if self.between is not None else (-float("inf"), float("inf"))
        return read[0][0], low, high, unit

    def prior_numbers(self) -> tuple[float, float]:
        """Return mean and standard deviation of the prior in SI units."""
        if self.prior is None:
            return 0.0, float("inf")
        mean, sd = ((any_quantity(one) or (0.0, ""))[0] for one in (self.prior.mean, self.prior.sd))
        return mean, sd

    @model_validator(mode="after")
    def _check_numbers(self) -> Self:
        wanted = _unit(self.start)
        for name in ("mean", "sd") if self.prior is not None else ():
            value = getattr(self.prior, name)
            if _unit(value) != wanted:
                refuse(f"must be of start's unit [{wanted or '1'}], got {shown(value)}", "prior", name)
        if self.prior is not None and not self.prior_numbers()[1] > 0.0:
            refuse(f"must be positive, got {shown(self.prior.sd)}", "prior", "sd")
        for i, value in enumerate(self.between or ()):
            number, unit = any_quantity(value) or (0.0, "")
            if _unit(value) != wanted and not (number == 0.0 and not unit):
                refuse(f"must be of start's unit [{wanted or '1'}], got {shown(value)}", "between", i)
        start, low, high, _ = self.numbers()
        if not low < high:
            refuse(f"must be bounds that rise, got {shown(self.between)}", "between")
        if not low <= start <= high:
            refuse(f"must be within the bounds {shown(self.between)}, got {shown(self.start)}", "start")
        if self.scale == "log" and not (start > 0.0 and (self.between is None or low > 0.0)):
            at = "start" if not start > 0.0 else "between"
            value = self.start if at == "start" else self.between
            refuse(f'must be positive for scale = "log", got {shown(value)}', at)
        return self


def _unit(value: object) -> str:
    """Return the SI unit of a quantity; "" of a pure number."""
    unit = (any_quantity(value) or (0.0, ""))[1]
    return "" if unit == "1" else unit


class DerivedSpec(Spec):
    """Number of the scenario that follows from parameters, such as ``coulomb + excess``.

    With a difference as the parameter, of zero or more, two numbers keep their order.

    Attributes:
        key: Key of the scenario, or several that get the same value.
        value: Expression of parameters: + - * / **, sqrt, exp, log, min, max; all numbers are in SI units.
        records: Whose it is; of all records if left out.
        unit: SI unit in which it is printed.
    """

    key: str | tuple[str, ...]
    value: str
    records: tuple[str, ...] | None = None
    unit: str = ""

    @property
    def keys_set(self) -> tuple[str, ...]:
        """Keys that the number sets."""
        return (self.key,) if isinstance(self.key, str) else self.key

    @field_validator("value")
    @classmethod
    def _check_value(cls, value: str) -> str:
        try:
            names_in(value)
        except ValueError as error:
            refuse(str(error))
        return value
