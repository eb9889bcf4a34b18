"""Declarations of columns of results and tables, and rules of their numbers.

Writers and readers of a column check it by the same declaration.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[Any]

#: Share of a run's largest number in a unit below which a number of it is zero [-]: 1e-16 of round-off, grown
#: 1e6 times over a run, and still far below what the error of a step is asked to be.
ROUND_OFF = 1e-10

_UNIT = 1e-6  # that the length of a direction or a quaternion may be off by


@dataclass(frozen=True, slots=True)
class ColumnRule:
    """Allowed numbers of a column; finite in any case."""

    least: float = -math.inf  # none is less
    most: float = math.inf  # none is more
    only: tuple[float, ...] = ()  # each is one of these, if there are any
    unit: bool = False  # those along the last dimension are of length 1: a quaternion
    rising: bool = False  # none is less than the one before it, along the first dimension
    lacks: bool = False  # NaN stands where there is no number
    infinite: bool = False  # infinity is one of them
    beside: str = ""  # a column without which it is zero: where that one is zero
    summed: bool = False  # integrals of a run, or sums of its large numbers: bounds hold to their errors
    passive: bool = False  # energy that is lost: bounds hold for what is known to put none in

    @property
    def words(self) -> str:
        """Rule as text after "must be"."""
        said = ["a number" if self.infinite else "finite"]
        said += ["or NaN where there is none"] * self.lacks
        if self.only:
            said.append(f"one of {', '.join(f'{one:g}' for one in self.only)}")
        if self.least != -math.inf:
            said.append(f"{self.least:g} or more")
        if self.most != math.inf:
            said.append(f"{self.most:g} or less")
        said += ["of length 1"] * self.unit + ["no less than the one before"] * self.rising
        said += [f"zero where {self.beside} is"] * bool(self.beside)
        return ", ".join(said)

    def breach(
        self,
        values: Numbers,
        *,
        before: Numbers | None = None,
        other: Numbers | None = None,
        slack: Callable[[], float] = lambda: 0.0,
        finite: bool = True,
    ) -> Breach | None:
        """Return the first forbidden number of a column, or None.

        Args:
            values: Of the column, or of some of its rows.
            before: The row before them.
            other: Those of ``beside``, of the same rows.
            slack: Returns the tolerance of bounds, where one of a ``summed`` number is passed.
            finite: Whether numbers must be finite: in a run that ended badly, its last ones need not be.
        """
        if not values.size:
            return None
        rows = len(values)
        first = first_not_finite(values, lacks=self.lacks, infinite=self.infinite) if finite else rows
        if first < rows:
            return self._at(
                values, first, ~(np.isfinite(values[first]) | (self.lacks & np.isnan(values[first])))
            )
        with np.errstate(invalid="ignore"):
            wrong = self._wrong(values, before, other, 0.0)
            if self.summed and wrong.any():
                wrong = self._wrong(values, before, other, slack())
        if not wrong.any():
            return None
        first = int(np.argmax(wrong.reshape(rows, -1).any(axis=1)))
        return self._at(values, first, wrong[first])

    def _wrong(
        self, values: Numbers, before: Numbers | None, other: Numbers | None, slack: float
    ) -> NDArray[np.bool_]:
        """Return which numbers are not allowed; NaN passes here."""
        wrong = (values < self.least - slack) | (values > self.most + slack)
        if self.only:
            wrong |= ~np.isin(values, self.only)
        if self.rising:
            start = values[:1] if before is None else before[np.newaxis]
            wrong |= values < np.concatenate([start, values[:-1]]) - slack
        if self.unit:
            lengths = np.linalg.norm(values, axis=-1, keepdims=True)
            wrong |= np.abs(lengths - 1.0) > _UNIT
        if other is not None:
            shape = (*other.shape, *[1] * (values.ndim - other.ndim))
            wrong |= (values != 0.0) & (other == 0.0).reshape(shape)
        return wrong

    def _at(self, values: Numbers, row: int, wrong: Any) -> Breach:
        found = values[row] if self.unit else np.atleast_1d(values[row])[np.atleast_1d(wrong)][0]
        return Breach(row, np.array2string(np.asarray(found), precision=9, separator=", "))


#: Any finite number.
ANY = ColumnRule()
_SIZE = ColumnRule(least=0.0)


class Breach(NamedTuple):
    """A number that breaks a rule."""

    row: int  # where, along the first dimension
    value: str  # what stands there, as text


def first_not_finite(values: Numbers, *, lacks: bool = False, infinite: bool = False) -> int:
    """Return the first row with numbers that are not finite, or the row count."""
    if values.dtype.kind != "f":
        return len(values)
    good = np.isfinite(values)
    if good.all():
        return len(values)
    good |= (lacks & np.isnan(values)) | (infinite & np.isinf(values))
    if good.all():
        return len(values)
    return int(np.argmin(good.reshape(len(values), -1).all(axis=1)))


@dataclass(frozen=True, slots=True)
class Coordinate:
    """Labels beside those of a dimension."""

    name: str  # of the coordinate
    dim: str  # along what
    meaning: str  # in words


class Reduction(NamedTuple):
    """Number of a whole run that follows from a series, or from contact episodes."""

    by: str  # ``end``, the last value; ``peak``, the largest size; of episodes ``peak``, ``sum`` or ``count``
    of: str  # variable that is reduced


@dataclass(frozen=True, slots=True)
class Variable:
    """Quantity of a result, or of a table that follows from one.

    Texts with bars hold alternatives: what turns, what slides, and both in one column.

    Attributes:
        name: Of the quantity.
        dims: Its dimensions, in order; it is there if they are.
        units: Of its values, as text; "1" if none.
        meaning: Its long name.
        source: Where it comes from, of each sample: the ``state``, its ``derivative`` (the equations of
            motion), the ``contact`` of journals and bearings, the ``ledger`` of works and losses that the
            state holds, the ``audit`` of energies and momenta, the ``motion`` of joints with one axis; of the
            whole run: its ``episodes`` of contact and events, and a ``summary`` of series. Of a derived
            table: its name.
        rule: What its numbers may be.
        flags: What its numbers stand for, if they are codes.
        free_base: Whether it is there with a free base only.
        sliding: Unit where what it belongs to slides; "" for the same.
        label: Heading in tables; from the name if empty.
        entry: Key in summaries; the name if empty, "-" for none.
        reduced: What it is reduced from; None of what is recorded itself.
        form: ``count`` of a whole number, ``share`` of a share of the time.
        exact: Whether round-off is what it measures, so that it is never zero to round-off.
        digits: Significant digits in reports.
    """

    name: str
    dims: tuple[str, ...]
    units: str
    meaning: str
    source: str
    rule: ColumnRule = ANY
    flags: tuple[tuple[int, str], ...] = ()
    free_base: bool = False
    sliding: str = ""
    label: str = ""
    entry: str = ""
    reduced: Reduction | None = None
    form: str = ""
    exact: bool = False
    digits: int = 4

    @property
    def attributes(self) -> dict[str, Any]:
        """Return its attributes in a dataset."""
        found: dict[str, Any] = {"units": self.units, "long_name": self.meaning}
        if self.flags:
            found["flag_values"] = np.array([value for value, _ in self.flags], dtype=np.int8)
            found["flag_meanings"] = " ".join(word for _, word in self.flags)
        return found

    def unit(self, slides: bool | None = False) -> str:
        """Return the unit of what turns or slides; of None, both."""
        if slides is None and self.sliding:
            return f"{self.units}, {self.sliding}"
        return self.sliding if slides and self.sliding else self.units

    def words(self, slides: bool | None = None) -> str:
        """Return the heading of what turns or slides; of None, of a column of both."""
        return _alternative(self.label or self.name.replace("_", " "), slides)

    def key(self, slides: bool = False) -> str:
        """Return the key in summaries of what turns or slides; "" for none."""
        entry = self.entry or self.name
        return "" if entry == "-" else _alternative(entry, slides)

    def heading(self, slides: bool | None = None) -> str:
        """Return heading and unit, as ``peak force [N]``."""
        unit = self.unit(slides).replace("^2", "²")
        if unit == "1":
            unit = "" if self.form == "count" else "-"
        return self.words(slides) + (f" [{unit}]" if unit else "")


def _alternative(text: str, slides: bool | None) -> str:
    """Return the alternative of a text with bars: turning, sliding or both (None)."""
    parts = text.split("|")
    return parts[min({False: 0, True: 1, None: 2}[slides], len(parts) - 1)]


def rows(*blocks: str | tuple[Any, ...], **more: Any) -> tuple[Variable, ...]:
    """Return quantities, block by block.

    Args:
        *blocks: Of each block its source and, behind a colon, its dimensions; then a tuple for each quantity:
            name, unit (behind a bar that of what slides), meaning, and in any order a :class:`ColumnRule`, a
            :class:`Reduction`, a text ``entry: label`` (either may be left out; ``=`` for a label that is the
            meaning), and further fields in a dictionary.
        **more: What else holds for all.
    """
    made, source, dims = [], "", ""
    for row in blocks:
        if isinstance(row, str):
            source, dims = row.split(": ")
            continue
        name, units, meaning, *rest = row
        turning, _, sliding = units.partition("|")
        fields: dict[str, Any] = dict(more, sliding=sliding)
        for one in rest:
            if one == "=":
                fields["label"] = meaning
            elif isinstance(one, str):
                entry, _, label = one.partition(": ")
                fields |= {"entry": entry, "label": label or entry.replace("_", " ").strip("-")}
            elif isinstance(one, Reduction):
                fields = {"rule": _SIZE if one.by == "peak" else ANY} | fields | {"reduced": one}
            else:
                fields |= {"rule": one} if isinstance(one, ColumnRule) else one
        made.append(Variable(name, tuple(dims.split()), turning, meaning, source, **fields))
    return tuple(made)


def peak(of: str) -> Reduction:
    """Return the largest size of a series at a sample, or of an episode's number."""
    return Reduction("peak", of)


def end(of: str) -> Reduction:
    """Return the last value of a series."""
    return Reduction("end", of)


def total(of: str) -> Reduction:
    """Return the sum over episodes."""
    return Reduction("sum", of)
