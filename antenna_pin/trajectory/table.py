"""Files of tables: labelled datasets beside runs, sealed and identified by a format.

A portrait, a section, a bifurcation diagram, an orbit, a branch of orbits, Lyapunov exponents, a fit, what
a test can tell, a comparison of experiments and sensitivities are a dataset each. Their attributes say
what they are and what they came from: ``format``; ``title``, ``name`` and ``case`` of the scenario, and the
whole of it as JSON; the ``versions`` of what made them; and the ``command`` if it was one.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import absence, has_whole_seal, replacing
from antenna_pin.base.units import shown
from antenna_pin.errors import FileFormatError
from antenna_pin.trajectory.columns import ANY, ColumnRule
from antenna_pin.trajectory.file import load_dataset, open_hdf5, write
from antenna_pin.trajectory.outcome import Outcome
from antenna_pin.trajectory.read import json_in
from antenna_pin.trajectory.result import library_versions

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario


@dataclass(frozen=True, slots=True)
class TableColumn:
    """Column of a table."""

    name: str  # "" for one of each quantity
    dims: tuple[str, ...]
    rule: ColumnRule = ANY
    words: tuple[str, ...] | None = None  # allowed texts of a column of text; any if empty
    optional: bool = False


@dataclass(frozen=True, slots=True)
class Attribute:
    """Attribute of a table: a number, or text, which may be JSON."""

    name: str
    rule: ColumnRule | None = None  # of a number
    words: tuple[str, ...] = ()  # allowed texts; any if empty
    several: int = 0  # least number of texts, of a list of them
    named: bool = False  # texts by name
    table: bool = False  # a table, or nothing

    def problem(self, value: object) -> str | None:
        """Return the rule that a value breaks, or None."""
        if self.rule is not None:
            number = np.asarray(value)
            if number.size != 1 or number.dtype.kind not in "fiub":
                return "which must be a number"
            breach = self.rule.breach(np.atleast_1d(number))
            return None if breach is None else f"which must be {self.rule.words}"
        if not isinstance(value, str):
            return "which must be text"
        if self.words and value not in self.words:
            return f"which must be one of {', '.join(self.words)}"
        if self.several and len(_names(value) or ()) < self.several:
            return f"which must be a list of names, {self.several} or more"
        if self.named:
            texts = json_in(value)
            if isinstance(texts, dict) and all(isinstance(text, str) for text in texts.values()):
                return None
            return "which must be texts by name"
        if self.table and value and not isinstance(json_in(value), dict):
            return "which must be a table, as JSON, or nothing"
        return None


def _names(text: object) -> list[str] | None:
    """Return an attribute that is a list of texts as JSON, or None."""
    names = json_in(text)
    return names if isinstance(names, list) and all(isinstance(name, str) for name in names) else None


_SIZE, _TIMES = ColumnRule(least=0.0), ColumnRule(rising=True)
_LACKS, _WHETHER = ColumnRule(lacks=True), ColumnRule(only=(0.0, 1.0))
_OPEN = ColumnRule(lacks=True, infinite=True)
_SIZE_OR_NONE = ColumnRule(least=0.0, lacks=True)
_WIDTH = ColumnRule(least=0.0, infinite=True)
_OUTCOMES = ("", *(one.name for one in Outcome))


def _columns(*rows: tuple[Any, ...]) -> tuple[TableColumn, ...]:
    """Return columns from rows of dimensions, names, rule, words and ``_OPTIONAL``."""
    found = []
    for dims, names, *rest in rows:
        fields: dict[str, Any] = {"optional": _OPTIONAL in rest}
        for one in rest:
            if one is not _OPTIONAL:
                fields["rule" if isinstance(one, ColumnRule) else "words"] = one
        found += [TableColumn(name, tuple(dims.split()), **fields) for name in names.split() or [""]]
    return tuple(found)


_OPTIONAL, _TEXT = "optional", ()


def _orbits(over: str, parts: ColumnRule, exponents: ColumnRule) -> tuple[TableColumn, ...]:
    return _columns(
        (over, "period residual doubt neutral onsets events", _SIZE),
        (over, "stability", ("stable", "unstable", "neutral")),
        (over, "start"),
        (over, "state", _TEXT),
        (f"{over} configuration", "q"),
        (f"{over} coordinate", "v"),
        (f"{over} multiplier", "multiplier_real multiplier_imaginary", parts),
        (f"{over} multiplier", "exponent", exponents),  # minus infinity where nothing is left
    )


#: The columns of each kind of table; "" stands for one of each quantity.
TABLES: Mapping[str, tuple[TableColumn, ...]] = {
    "portrait": _columns(("sample", "time", _TIMES), ("sample", "", _LACKS)),
    "section": _columns(
        ("point", "time", _TIMES),
        ("point", "", _LACKS),
        ("", "settled", _WHETHER),
        ("", "transient", _SIZE),
        ("", "drift", _SIZE_OR_NONE),
    ),
    "bifurcation": _columns(
        ("value", "value"),
        ("branch value point", "time", _LACKS),
        ("branch value point", "", _LACKS),
        ("branch value", "settled", _WHETHER),
        ("branch value", "drift", _SIZE_OR_NONE),
        ("branch value", "points transient", _SIZE),
        ("branch value", "period", _SIZE_OR_NONE),
        ("branch value", "outcome", _OUTCOMES),
        ("branch value", "message", _TEXT),
    ),
    "orbit": (*_orbits("", ANY, ColumnRule(infinite=True)), *_columns(("to from", "tangent"))),
    "branch": (
        *_orbits("point", _LACKS, _OPEN),
        *_columns(
            ("point", "value"),
            ("bifurcation", "kind", ("fold", "branch-point", "flip", "neimark-sacker", "grazing")),
            ("bifurcation", "at"),
            ("bifurcation", "at_doubt after", _SIZE),
            ("quantity point", "amplitude", _LACKS, _OPTIONAL),
        ),
    ),
    "exponents": _columns(
        ("exponent", "value"),
        ("exponent", "error", _WIDTH),
        ("interval", "time", _TIMES),
        ("interval", "length", _SIZE),
        ("interval exponent", "growth running"),
    ),
    "sensitivity": _columns(
        ("result", "value"),
        ("result parameter", "change doubt", _LACKS),
        ("parameter", "at scale"),
        ("parameter", "exponent", _LACKS),
        ("parameter", "believed", ColumnRule(infinite=True)),
        ("time curve parameter", "curve_change curve_doubt", _LACKS),
        ("time", "time", _TIMES),
        ("result", "result unit", _TEXT),
        ("parameter", "parameter parameter_unit", _TEXT),
        ("curve", "curve curve_unit", _TEXT),
    ),
    "fit": _columns(
        ("parameter", "value start"),
        ("parameter", "lower upper", ColumnRule(infinite=True)),
        ("parameter", "sd", ColumnRule(least=0.0, lacks=True, infinite=True)),
        ("parameter", "low high", _OPEN),
        ("parameter", "logarithmic", _WHETHER),
        ("parameter", "units title key", _TEXT),
        ("parameter other", "covariance", _OPEN),
        ("row", "model data at"),
        ("row", "noise", _SIZE),
        ("row", "record column measure unit", _TEXT),
        ("residual_row", "residual"),
        ("residual_row parameter", "slope"),
        ("search", "search_cost", _SIZE_OR_NONE),
        ("search parameter", "search_start search_end", _OPEN),
        ("row", "band_low band_high new_low new_high", _OPTIONAL),
        ("parameter step", "profile_value profile_root", _LACKS, _OPTIONAL),
        ("parameter side", "profile_end", _OPEN, _OPTIONAL),
        ("parameter side", "profile_how", ("", "crossed", "bounded", "open", "stopped"), _OPTIONAL),
        ("", "profile_reach", _SIZE_OR_NONE, _OPTIONAL),
    ),
    "identifiability": _columns(
        ("parameter", "value"),
        ("parameter", "scale", _SIZE),
        ("parameter", "error half alone", _WIDTH),
        ("parameter", "inflation", _OPEN),
        ("parameter", "felt determined", _WHETHER),
        ("parameter", "units title", _TEXT),
        ("direction", "singular", _SIZE),
        ("direction parameter", "part"),
        ("combination parameter", "null"),
        ("combination", "said hold", _TEXT),
    ),
    "experiments": _columns(
        ("experiment parameter", "half", _WIDTH),
        ("parameter", "before", _WIDTH),
        ("parameter", "value"),
        ("parameter", "scale", _SIZE),
        ("parameter", "units title", _TEXT),
        ("experiment", "what", _TEXT),
        ("experiment", "D A E", _WIDTH),
        ("experiment", "c", _WIDTH, _OPTIONAL),
        ("experiment", "share count", _SIZE, _OPTIONAL),
    ),
}

_QUANTITIES = Attribute("quantities", several=1)
_SETTLED = (Attribute("rule"), Attribute("tolerance", _SIZE))

#: The attributes of each kind of table, beside those of all kinds.
ATTRIBUTES: Mapping[str, tuple[Attribute, ...]] = {
    "portrait": (Attribute("quantities", several=2),),
    "section": (
        _QUANTITIES,
        Attribute("section"),
        Attribute("period", _SIZE_OR_NONE),
        *_SETTLED,
        Attribute("outcome", words=_OUTCOMES),
        Attribute("message"),
        Attribute("state"),
    ),
    "bifurcation": (Attribute("parameter"), _QUANTITIES, Attribute("section"), *_SETTLED),
    "orbit": (Attribute("free_period", _WHETHER), Attribute("iterations", _SIZE)),
    "branch": (Attribute("parameter"), Attribute("message")),
    "exponents": (Attribute("verdict"), Attribute("interval", _SIZE), Attribute("start"), Attribute("end")),
    "sensitivity": (Attribute("refused"),),
    "fit": (
        Attribute("fit", table=True),
        *(Attribute(name, _SIZE) for name in ("chi2", "runs", "evaluations")),
        Attribute("freedoms", ColumnRule()),
        *(Attribute(name) for name in ("noise", "loss", "message")),
        Attribute("converged", _WHETHER),
    ),
    "identifiability": (Attribute("level", ColumnRule(0.0, 1.0)), Attribute("quantile", _SIZE)),
    "experiments": (
        Attribute("criterion", words=("D", "c", "A", "E")),
        Attribute("wanted"),
        Attribute("level", ColumnRule(0.0, 1.0)),
        Attribute("total", _SIZE),
    ),
}

_OF_ALL = (
    *(Attribute(name) for name in ("title", "name", "case")),
    Attribute("scenario", table=True),
    Attribute("versions", named=True),
)


def problem_of_table(table: xr.Dataset, kind: str) -> str | None:
    """Return the first fault of a table of a kind; None without any."""
    return next(_problems(table, kind), None)


def _problems(table: xr.Dataset, kind: str) -> Iterator[str]:
    for attribute in (*_OF_ALL, *ATTRIBUTES[kind]):
        if attribute.name not in table.attrs:
            yield f"no attribute {attribute.name!r}"
            return
        value = table.attrs[attribute.name]
        value = value.item() if isinstance(value, np.generic) else value
        problem = attribute.problem(value)
        if problem is not None:
            yield f"{shown(value)} in the attribute {attribute.name!r}, {problem}"
            return
    for column in TABLES[kind]:
        names = [column.name] if column.name else _names(table.attrs["quantities"]) or []
        for name in names:
            yield from _in_column(table, name, column)


def _in_column(table: xr.Dataset, name: str, column: TableColumn) -> Iterator[str]:
    if name not in table.variables:
        if not column.optional:
            yield f"no variable {name!r}"
        return
    found = table[name]
    if found.dims != column.dims:
        yield f"{name!r} along {shown(found.dims)}, not {shown(column.dims)}"
        return
    values = np.atleast_1d(found.values)
    if column.words is not None:
        texts = {str(one) for one in values.ravel()}
        wrong = sorted(texts - set(column.words)) if column.words else []
        if wrong or values.dtype.kind not in "OUT":
            yield f"{shown(wrong[0] if wrong else values.ravel()[0])} in {name!r}, which must be text" + (
                f", one of {', '.join(column.words)}" if column.words else ""
            )
        return
    if values.dtype.kind not in "fiub":
        yield f"no numbers in {name!r}"
        return
    breach = column.rule.breach(values)
    if breach is not None:
        at = f" at {found.dims[0]} {breach.row}" if found.dims else ""
        yield f"{breach.value} in {name!r}{at}, which must be {column.rule.words}"


TableKind = Literal[
    "portrait",
    "section",
    "bifurcation",
    "orbit",
    "branch",
    "exponents",
    "fit",
    "identifiability",
    "experiments",
    "sensitivity",
]
"""What a dataset is of."""

#: The format of each kind; another version of it is another format.
FORMATS: dict[TableKind, str] = {kind: f"antenna_pin {kind} 1" for kind in get_args(TableKind)}

#: What each kind is, in words.
KINDS: dict[TableKind, str] = {
    "portrait": "a phase portrait",
    "section": "a section",
    "bifurcation": "a bifurcation diagram",
    "orbit": "a periodic solution",
    "branch": "a branch of periodic solutions",
    "exponents": "Lyapunov exponents",
    "fit": "a fit to measured records",
    "identifiability": "an identifiability analysis",
    "experiments": "a comparison of experiments",
    "sensitivity": "sensitivities",
}


def table_attributes(kind: TableKind, scenario: Scenario | None) -> dict[str, Any]:
    """Return the attributes of kind and provenance of a dataset.

    Args:
        kind: Kind of the source.
        scenario: What was run; None for a system built in Python.
    """
    return {
        "format": FORMATS[kind],
        "title": "" if scenario is None else scenario.title or scenario.name,
        "name": "" if scenario is None else scenario.name,
        "case": "" if scenario is None else scenario.case or "",
        "scenario": "" if scenario is None else scenario.model_dump_json(),
        "versions": json.dumps(library_versions()),
    }


def kind_of(data: xr.Dataset) -> TableKind | None:
    """Return the kind of a dataset; None for another format."""
    found = data.attrs.get("format")
    return next((kind for kind, name in FORMATS.items() if name == found), None)


def format_of(path: str | os.PathLike[str]) -> str | None:
    """Return the format of a file; "" without one, None if unreadable.

    Raises:
        FileFormatError: It refers to another file.
    """
    try:
        with open_hdf5(path) as file:
            found = file.attrs.get("format")
    except FileFormatError:
        raise
    except Exception:  # HDF5 raises any
        return None
    return found if isinstance(found, str) else ""


@takes()
def save_table(table: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a dataset to a file (NetCDF 4), whole or not at all.

    Raises:
        OutputError: It cannot be written there.
    """
    stored = table.copy()
    stored.attrs["coordinates"] = " ".join(str(name) for name in table.coords if name not in table.dims)
    with replacing(path) as partial:
        write(stored, partial)


def open_table(path: str | os.PathLike[str], kind: TableKind) -> xr.Dataset:
    """Return a dataset from its file.

    Args:
        path: The file, as :func:`save_table` wrote it.
        kind: What it is to be of.

    Raises:
        FileFormatError: It is of something else, or damaged, or not there.
    """
    file = Path(path)
    if not file.is_file():
        raise FileFormatError(f"{file}: {absence(file)}; it must be {KINDS[kind]} written by antenna-pin")
    try:
        whole = has_whole_seal(file)
        table = load_dataset(file)
    except FileFormatError:
        raise
    except Exception as error:  # HDF5 raises any
        words = " ".join(str(error).split())
        raise FileFormatError(f"{file}: must be {KINDS[kind]}, got: {words}") from None
    found = table.attrs.get("format")
    if found != FORMATS[kind]:
        raise FileFormatError(f"{file}: must be {KINDS[kind]}, of format {FORMATS[kind]!r}, got {found!r}")
    if whole is not True:
        raise FileFormatError(
            f"{file}: must be as antenna-pin wrote it, got another checksum, or none: it was damaged, or "
            "edited in place; take another copy of it, or make it again"
        )
    problem = problem_of_table(table, kind)
    if problem is not None:
        raise FileFormatError(
            f"{file}: must be {KINDS[kind]} as antenna-pin writes it, got {problem}; make it again"
        )
    return table
