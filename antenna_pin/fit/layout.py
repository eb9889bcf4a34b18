"""How a record's file is laid out: where its columns begin, how its numbers and times are written."""

from __future__ import annotations

import re
from datetime import datetime
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from antenna_pin.base.units import shown
from antenna_pin.scenario.spec import Count, Quantity, Spec, refuse

__all__ = ["LayoutSpec"]

_SOME_DAY = datetime(2026, 5, 4, 10, 15, 30, 250000)


class LayoutSpec(Spec):
    """What of a record is its file's, as a recorder or a spreadsheet wrote it. Most of it is of texts.

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
    """Refuse a pattern of stamps that cannot be read: an unknown directive, or the same one twice."""
    try:
        datetime.strptime(_SOME_DAY.strftime(pattern), pattern)
    except (ValueError, re.error) as error:
        said = f"{shown(pattern)} ({' '.join(str(error).split())})"
        refuse(
            f"must be iso, or a pattern of different directives that strptime reads, got {said}",
            "time_format",
        )
