"""Tables of a fit file: columns, layouts of files, parameters and derived numbers."""

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
from antenna_pin.scenario.parameters import AnyQuantity, KeysSpec
from antenna_pin.scenario.spec import Count, QuantityRule, Spec, refuse

# --- columns of a record ------------------------------------------------------------------------------------


_PositiveFrequency = Annotated[float, QuantityRule("Hz", "positive")]
_PositiveSpan = Annotated[float, QuantityRule("s", "positive")]
_Triple = tuple[float, float, float]


class _FilterSpec(Spec):
    """Low-pass filter of a reading: Butterworth, causal, at rest at the record's start.

    Attributes:
        order: Order of the filter [-].
        corner: Frequency at which the filter is 3 dB down [Hz].
    """

    order: Annotated[int, BeforeValidator(Count(1, 12).read)] = 4
    corner: _PositiveFrequency


class SpectrumSpec(Spec):
    """Comparison by the logarithms of band powers of the spectrum (Welch 1967).

    Attributes:
        edges: Edges of the bands, rising [Hz].
        segment: Length of a segment; consecutive segments overlap by half [s].
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

    Each impact counts in parts in the two bins between whose middles its logarithm lies, so that counts
    follow the model's numbers without jumps.

    Attributes:
        level: Level above which an impact lasts, in the column's unit.
        of: Counted number: largest values ``peaks``, ``intervals`` from one onset to the next, integrals over
            time ``impulses``.
        edges: Edges of the bins, positive and rising, in the unit of the counted number.
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
        column: Name in the file; the name of this table by default.
        unit: Unit in the file; the SI unit of the reading by default.
        sensor: ``variable``, a quantity of the result; ``accelerometer``, the specific force at a point of a
            link; ``encoder``, a quantity in steps; ``force-cell``, the load that a joint transmits.
        of: Variable and encoder: name of a quantity, as ``motion_angle[hinge]``.
        link: Accelerometer: link on which it is mounted. Force cell: link whose axes its direction refers to;
            the world's axes by default.
        point: Accelerometer: position in the link's frame [m].
        direction: Sensitive axis, in the link's axes; only the ratio of the numbers counts.
        gravity: Accelerometer: true for the specific force, acceleration less gravity, as sensors down to 0
            Hz read; false for the acceleration.
        resolution: Encoder: size of a step.
        rounding: Encoder: to the ``nearest`` step, or ``down`` to the last step passed.
        joint: Force cell: joint or closure, whose load from parent to child is read.
        load: Force cell: ``force`` or ``torque``.
        gain: Gain of the reading [-].
        offset: Offset of the reading, in the reading's unit.
        filter: Low-pass filter of the reading.
        compare: ``curve``, all rows; ``rms``, one number; ``spectrum``; ``blows``.
        spectrum: Settings of a comparison of spectra.
        blows: Settings of a comparison of impacts.
        sd: Standard deviation of the noise: of a row of a curve, or of the rms, in the reading's unit; of a
            band's power relative to the power [-]. For bands and impacts it follows from counts by default.
        weight: Weight of the column's residuals relative to other columns [-].
    """

    column: str | None = None
    unit: str | None = None
    sensor: Literal["variable", "accelerometer", "encoder", "force-cell"] = "variable"
    of: str | None = None
    link: str | None = None
    point: tuple[Any, Any, Any] | None = None
    direction: _Triple | None = None
    gravity: bool | None = None
    resolution: AnyQuantity = None
    rounding: Literal["nearest", "down"] | None = None
    joint: str | None = None
    load: Literal["force", "torque"] | None = None
    gain: float = 1.0
    offset: AnyQuantity = 0.0
    filter: _FilterSpec | None = None
    compare: Literal["curve", "rms", "spectrum", "blows"] = "curve"
    spectrum: SpectrumSpec | None = None
    blows: BlowsSpec | None = None
    sd: AnyQuantity = None
    weight: Annotated[float, QuantityRule("1", "positive")] = 1.0

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
    """Layout of a record's file; most settings are for text files.

    Attributes:
        delimiter: Delimiter of a text's columns; a blank means any number of blanks. Detected by default.
        decimal: Decimal sign of a text, point or comma. Detected by default.
        encoding: Encoding of a text by Python's name: ``utf-8``, ``latin-1``, ``utf-16``. A byte order mark
            takes precedence over ``utf-8``.
        comment: Prefix of a text's comment lines.
        skip: Number of lines before the column names of a text, comments included [-].
        names: Names of a text's columns, if no line has them.
        units_row: True if a line below the names has the columns' units.
        time: Name of the column of times; ``time`` in a record of a run of this package.
        time_unit: Unit of the times; by default that in the file, else seconds.
        time_format: Format of time stamps: ``iso`` (2026-05-04 10:15:30.25), or a pattern of Python's
            ``strptime`` (``%d.%m.%Y %H:%M:%S,%f``); times count from the first row.
        rate: Rate of the rows of a file without times; times count from the first row [Hz].
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
    rate: Annotated[float, QuantityRule("Hz", "positive")] | None = None

    @model_validator(mode="after")
    def _check_layout(self) -> Self:
        if self.decimal is not None and self.decimal == self.delimiter:
            refuse(f"must differ from decimal, got {shown(self.delimiter)} for both", "delimiter")
        try:
            "".encode(self.encoding)
        except (LookupError, ValueError):  # of what is no encoding, and of one that encodes nothing
            rule = "must be a text encoding of Python, such as utf-8, latin-1 or utf-16"
            refuse(f"{rule}, got {shown(self.encoding)}", "encoding")
        given = self.model_fields_set
        for name in ("time", "time_unit", "time_format"):
            if self.rate is not None and name in given and getattr(self, name) is not None:
                refuse("must be left out with rate, which sets the time of each row", name)
        if self.time_format is not None and self.time_unit is not None:
            refuse("must be left out with time_format, whose stamps have no unit", "time_unit")
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
        ValueError: The text is no arithmetic expression; the message is a rule.
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
    """Return the value in SI units of an expression that :func:`names_in` accepts.

    Raises:
        ValueError: The expression has no finite real value.
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
    """Prior of a parameter: a normal distribution, in the parameter's unit."""

    mean: AnyQuantity
    sd: AnyQuantity


class FitParameterSpec(KeysSpec):
    """Unknown number of a fit.

    Attributes:
        key: Key of the scenario, as in a study, or several keys that get the same value; or a number of a
            record: ``records.NAME.clock_shift``, ``records.NAME.columns.COLUMN.gain`` or ``.offset``. Left
            out of a parameter that only derived numbers use.
        start: Start value of the search.
        between: Bounds.
        scale: ``log`` for a positive number of unknown order of magnitude.
        prior: Prior knowledge, which counts as one more measurement.
        records: Records to which the parameter belongs; all by default.
        title: Title in figures; the name by default.
    """

    key: str | tuple[str, ...] = ()
    start: AnyQuantity
    between: tuple[AnyQuantity, AnyQuantity] | None = None
    scale: Literal["linear", "log"] = "linear"
    prior: _PriorSpec | None = None
    records: tuple[str, ...] | None = None
    title: str = ""

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


class DerivedSpec(KeysSpec):
    """Number of the scenario that follows from parameters, such as ``coulomb + excess``.

    With a nonnegative difference as the parameter, two numbers keep their order.

    Attributes:
        key: Key of the scenario, or several keys that get the same value.
        value: Expression of parameters: + - * / **, sqrt, exp, log, min, max; all numbers are in SI units.
        records: Records to which the number belongs; all by default.
        unit: SI unit in printed results.
    """

    value: str
    records: tuple[str, ...] | None = None
    unit: str = ""

    @field_validator("value")
    @classmethod
    def _check_value(cls, value: str) -> str:
        try:
            names_in(value)
        except ValueError as error:
            refuse(str(error))
        return value
