"""What motions come to, as files: labelled datasets beside runs, sealed as these are, told apart by a format.

A portrait, a section, a bifurcation diagram, an orbit, a branch of orbits, Lyapunov exponents, a fit, what
a test can tell, experiments beside one another and sensitivities are a dataset each. Their attributes say
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
from antenna_pin.trajectory.columns import ANY, Rule
from antenna_pin.trajectory.file import load_dataset, open_hdf5, write
from antenna_pin.trajectory.outcome import Outcome
from antenna_pin.trajectory.read import json_in
from antenna_pin.trajectory.result import library_versions

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario

__all__ = [
    "ATTRIBUTES",
    "Attribute",
    "Column",
    "FORMATS",
    "KINDS",
    "TABLES",
    "TableKind",
    "format_of",
    "kind_of",
    "open_table",
    "problem_of_table",
    "save_table",
    "table_attributes",
]


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table.

    Attributes:
        name: Of it; "" for one of each quantity.
        dims: Its dimensions, in order.
        rule: What its numbers may be.
        words: What its texts may be, if it is one of text; any if that is empty.
        optional: Whether a table may do without it.
    """

    name: str
    dims: tuple[str, ...]
    rule: Rule = ANY
    words: tuple[str, ...] | None = None
    optional: bool = False


@dataclass(frozen=True, slots=True)
class Attribute:
    """One attribute of a table.

    Attributes:
        name: Of it.
        rule: What its number may be, if it is one.
        words: What its text may be, if it is one; any if that is empty.
        several: How many texts it has at least, if it is a list of them, as JSON.
        named: Whether it is texts by name, as JSON.
        table: Whether it is a table, as JSON, or nothing.
    """

    name: str
    rule: Rule | None = None
    words: tuple[str, ...] = ()
    several: int = 0
    named: bool = False
    table: bool = False

    def problem(self, value: object) -> str | None:
        """Return what of a value is not as it must be, in words; None if all is."""
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
        if self.named and not _is_named(value):
            return "which must be texts by name"
        if self.table and value and not isinstance(json_in(value), dict):
            return "which must be a table, as JSON, or nothing"
        return None


def _names(text: object) -> list[str] | None:
    """Return the list of texts that an attribute holds as JSON; None if it holds none."""
    names = json_in(text)
    return names if isinstance(names, list) and all(isinstance(name, str) for name in names) else None


def _is_named(text: object) -> bool:
    """Whether an attribute holds texts by name, as JSON."""
    found = json_in(text)
    return isinstance(found, dict) and all(isinstance(value, str) for value in found.values())


_SIZE, _TIMES = Rule(least=0.0), Rule(rising=True)
_LACKS, _WHETHER = Rule(lacks=True), Rule(only=(0.0, 1.0))
_OPEN = Rule(lacks=True, infinite=True)
_SIZE_OR_NONE = Rule(least=0.0, lacks=True)
_WIDTH = Rule(least=0.0, infinite=True)
_OUTCOMES = ("", *(one.name for one in Outcome))


def _orbits(*over: str) -> tuple[Column, ...]:
    several = _OPEN if over else Rule(infinite=True)
    parts = _LACKS if over else ANY
    return (
        *(
            Column(name, over, _SIZE)
            for name in ("period", "residual", "doubt", "neutral", "onsets", "events")
        ),
        Column("stability", over, words=("stable", "unstable", "neutral")),
        Column("start", over),
        Column("state", over, words=()),
        Column("q", (*over, "configuration")),
        Column("v", (*over, "coordinate")),
        Column("multiplier_real", (*over, "multiplier"), parts),
        Column("multiplier_imaginary", (*over, "multiplier"), parts),
        Column("exponent", (*over, "multiplier"), several),  # minus infinity where nothing is left
    )


_AT_VALUE = ("branch", "value")

#: The columns of each kind of table.
TABLES: Mapping[str, tuple[Column, ...]] = {
    "portrait": (Column("time", ("sample",), _TIMES), Column("", ("sample",), _LACKS)),
    "section": (
        Column("time", ("point",), _TIMES),
        Column("", ("point",), _LACKS),
        Column("settled", (), _WHETHER),
        Column("transient", (), _SIZE),
        Column("drift", (), _SIZE_OR_NONE),
    ),
    "bifurcation": (
        Column("value", ("value",)),
        Column("time", (*_AT_VALUE, "point"), _LACKS),
        Column("", (*_AT_VALUE, "point"), _LACKS),
        Column("settled", _AT_VALUE, _WHETHER),
        Column("drift", _AT_VALUE, _SIZE_OR_NONE),
        Column("points", _AT_VALUE, _SIZE),
        Column("transient", _AT_VALUE, _SIZE),
        Column("period", _AT_VALUE, _SIZE_OR_NONE),
        Column("outcome", _AT_VALUE, words=_OUTCOMES),
        Column("message", _AT_VALUE, words=()),
    ),
    "orbit": (*_orbits(), Column("tangent", ("to", "from"))),
    "branch": (
        *_orbits("point"),
        Column("value", ("point",)),
        Column("kind", ("bifurcation",), words=("fold", "branch-point", "flip", "neimark-sacker", "grazing")),
        Column("at", ("bifurcation",)),
        Column("at_doubt", ("bifurcation",), _SIZE),
        Column("after", ("bifurcation",), _SIZE),
        Column("amplitude", ("quantity", "point"), _LACKS, optional=True),
    ),
    "exponents": (
        Column("value", ("exponent",)),
        Column("error", ("exponent",), Rule(least=0.0, infinite=True)),
        Column("time", ("interval",), _TIMES),
        Column("length", ("interval",), _SIZE),
        Column("growth", ("interval", "exponent")),
        Column("running", ("interval", "exponent")),
    ),
    "sensitivity": (
        Column("value", ("result",)),
        *(Column(name, ("result", "parameter"), _LACKS) for name in ("change", "doubt")),
        *(Column(name, ("parameter",)) for name in ("at", "scale")),
        Column("exponent", ("parameter",), _LACKS),
        Column("believed", ("parameter",), Rule(infinite=True)),
        *(Column(name, ("time", "curve", "parameter"), _LACKS) for name in ("curve_change", "curve_doubt")),
        Column("time", ("time",), _TIMES),
        *(Column(name, ("result",), words=()) for name in ("result", "unit")),
        *(Column(name, ("parameter",), words=()) for name in ("parameter", "parameter_unit")),
        *(Column(name, ("curve",), words=()) for name in ("curve", "curve_unit")),
    ),
    "fit": (
        *(Column(name, ("parameter",)) for name in ("value", "start")),
        *(Column(name, ("parameter",), Rule(infinite=True)) for name in ("lower", "upper")),
        Column("sd", ("parameter",), Rule(least=0.0, lacks=True, infinite=True)),
        *(Column(name, ("parameter",), _OPEN) for name in ("low", "high")),
        Column("logarithmic", ("parameter",), _WHETHER),
        *(Column(name, ("parameter",), words=()) for name in ("units", "title", "key")),
        Column("covariance", ("parameter", "other"), _OPEN),
        *(Column(name, ("row",)) for name in ("model", "data", "at")),
        Column("noise", ("row",), _SIZE),
        *(Column(name, ("row",), words=()) for name in ("record", "column", "measure", "unit")),
        Column("residual", ("residual_row",)),
        Column("slope", ("residual_row", "parameter")),
        Column("search_cost", ("search",), _SIZE_OR_NONE),
        *(Column(name, ("search", "parameter"), _OPEN) for name in ("search_start", "search_end")),
        *(Column(name, ("row",), optional=True) for name in ("band_low", "band_high", "new_low", "new_high")),
        *(
            Column(name, ("parameter", "step"), _LACKS, optional=True)
            for name in ("profile_value", "profile_root")
        ),
        Column("profile_end", ("parameter", "side"), _OPEN, optional=True),
        Column(
            "profile_how",
            ("parameter", "side"),
            words=("", "crossed", "bounded", "open", "stopped"),
            optional=True,
        ),
        Column("profile_reach", (), _SIZE_OR_NONE, optional=True),
    ),
    "identifiability": (
        Column("value", ("parameter",)),
        Column("scale", ("parameter",), _SIZE),
        *(Column(name, ("parameter",), _WIDTH) for name in ("error", "half", "alone")),
        Column("inflation", ("parameter",), _OPEN),
        *(Column(name, ("parameter",), _WHETHER) for name in ("felt", "determined")),
        *(Column(name, ("parameter",), words=()) for name in ("units", "title")),
        Column("singular", ("direction",), _SIZE),
        Column("part", ("direction", "parameter")),
        Column("null", ("combination", "parameter")),
        *(Column(name, ("combination",), words=()) for name in ("said", "hold")),
    ),
    "experiments": (
        Column("half", ("experiment", "parameter"), _WIDTH),
        Column("before", ("parameter",), _WIDTH),
        Column("value", ("parameter",)),
        Column("scale", ("parameter",), _SIZE),
        *(Column(name, ("parameter",), words=()) for name in ("units", "title")),
        Column("what", ("experiment",), words=()),
        *(Column(name, ("experiment",), _WIDTH) for name in ("D", "A", "E")),
        Column("c", ("experiment",), _WIDTH, optional=True),
        *(Column(name, ("experiment",), _SIZE, optional=True) for name in ("share", "count")),
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
    "exponents": (
        Attribute("verdict"),
        Attribute("interval", _SIZE),
        Attribute("start"),
        Attribute("end"),
    ),
    "sensitivity": (Attribute("refused"),),
    "fit": (
        Attribute("fit", table=True),
        *(Attribute(name, _SIZE) for name in ("chi2", "runs", "evaluations")),
        Attribute("freedoms", Rule()),
        *(Attribute(name) for name in ("noise", "loss", "message")),
        Attribute("converged", _WHETHER),
    ),
    "identifiability": (Attribute("level", Rule(0.0, 1.0)), Attribute("quantile", _SIZE)),
    "experiments": (
        Attribute("criterion", words=("D", "c", "A", "E")),
        Attribute("wanted"),
        Attribute("level", Rule(0.0, 1.0)),
        Attribute("total", _SIZE),
    ),
}

_OF_ALL = (
    *(Attribute(name) for name in ("title", "name", "case")),
    Attribute("scenario", table=True),
    Attribute("versions", named=True),
)


def problem_of_table(table: xr.Dataset, kind: str) -> str | None:
    """Return what of a table is not as its kind's is, in words; None if all is."""
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


def _in_column(table: xr.Dataset, name: str, column: Column) -> Iterator[str]:
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
    "identifiability": "what a test can tell",
    "experiments": "experiments beside one another",
    "sensitivity": "sensitivities",
}


def table_attributes(kind: TableKind, scenario: Scenario | None) -> dict[str, Any]:
    """Return the attributes that say what a dataset is, and what it came from.

    Args:
        kind: What it is of.
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
    """Return what a dataset is of; None for one of another format."""
    found = data.attrs.get("format")
    return next((kind for kind, name in FORMATS.items() if name == found), None)


def format_of(path: str | os.PathLike[str]) -> str | None:
    """Return the format that a file says it has, "" if it says none; None where it cannot be read.

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
        raise FileFormatError(f"{file}: {absence(file)}; it must be {KINDS[kind]} that antenna-pin wrote")
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
