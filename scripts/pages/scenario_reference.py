"""What the code says of the keys of a scenario file, as rows and tables; what kinds share stands once.

Meanings are what docstrings say of attributes, units and defaults those of the fields. Which tables there are
stands in ``scenario_tables.py``.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, get_args

from pydantic.fields import FieldInfo

from antenna_pin.base.parameters import attribute_docs, parameters_of
from antenna_pin.contact import Parameter
from antenna_pin.scenario import MadeSpec

# --- what code says of a key ---


def docs_of(cls: type[Any]) -> dict[str, str]:
    """Return what docstrings say of a table's keys: its own, and those of the class that it fills."""
    docs = attribute_docs(cls)
    if issubclass(cls, MadeSpec):
        filled = attribute_docs(cls.fills)
        docs |= {key: filled[name] for key in cls.model_fields if (name := cls.field_of(key)) in filled}
    return docs


def plain(text: str) -> str:
    """Return what a docstring says of an attribute as a table of keys and units has it."""
    text = re.sub(r"\s*(\[[^\]]*\]\s*(\(\[[^\]]*\]\))?)(?=[.;]|$)", "", text).replace("``", "`")
    for python, file in (
        ("None for ", "if left out, "),
        ("None if ", "left out if "),
        ("None where ", "left out where "),
        ("None to choose it", "if left out, it is chosen"),
    ):
        text = text.replace(python, file)
    for said, short in _SAID_ONCE:
        text = re.sub(said, short, text)
    return re.sub(r"; if left out, (?!it )", "; default: ", text).strip(".; ")


#: What docs/scenario.md says once, of all keys: that nothing follows where one is left out, files, sizes.
_NOTHING = (
    r"if left out, (none|no limit|no stop there|no end there|any rate|any energy|the same)",
    r"(none|zero|0|same) (if|for) (left out|not given|none)",
    r"left out (if never|where nothing swings)",
    r"left out if ((it is )?given as numbers|there is no such part, or it is given as numbers)",
)
_SAID_ONCE = (
    (rf"; ({'|'.join(_NOTHING)})(?=\.|$)", ""),
    (
        r"^Where (the |a |it )?(table|part that is a table)? ?came from, "
        r"relative to the scenario's folder\.?$",
        "[table](../tables.md), in place of the numbers",
    ),
    (
        r"^(Of (the|a) table, )?[Ss]trictly increasing, at least two[.;]? ?([Aa] run must lie within them)?",
        "Increasing",
    ),
    (r",? ?\((\d,|[mnp],( [mnp])?)\)(?=[,;.]|$)", ""),
    (r"(, of|,) any length( but zero)?", ""),
    (r"^Whether ", ""),
    (r"^Name of the ", ""),
    (r"^`\w+` or `\w+`\.?$", ""),
)


def annotations(item: Any) -> Iterator[Any]:
    """Yield what stands in an annotation, at any depth."""
    yield item
    for part in get_args(item):
        yield from annotations(part)


def kind_of(field: FieldInfo, parameter: Parameter | None = None) -> str:
    """Return the unit of a field, or what else it holds."""
    if parameter is not None and parameter.sizes == (0,):
        units = kind_of_units(parameter.units)
        return "list" if units == "-" else f"list of {units}"
    for item in (*field.metadata, *annotations(field.annotation)):
        if type(item).__name__ in ("QuantityRule", "Vector"):
            text = kind_of_units(item.unit)
            sizes = getattr(item, "sizes", ())
            if not sizes:
                return text
            count = " or ".join(map(str, sizes))
            return f"{count} numbers" if text == "-" else f"{count} × {text}"
    choices = [value for item in annotations(field.annotation) for value in get_args(item)]
    choices = [value for value in choices if isinstance(value, str)]
    if choices:
        return ", ".join(f"`{value}`" for value in choices)
    if str in annotations(field.annotation):
        return "list" if "tuple" in str(field.annotation) else "text"
    return "list" if "tuple" in str(field.annotation) else "-"


def kind_of_units(unit: str | tuple[str, ...]) -> str:
    """Return a unit, or several of which one will do, as the tables have them."""
    units = unit if isinstance(unit, tuple) else (unit,)
    return ", ".join("-" if unit == "1" else unit.replace("**", "^").replace("*", "·") for unit in units)


def default_of(field: FieldInfo) -> str:
    """Return the default of a field as a file would have it."""
    value = field.default
    if field.is_required():
        return "required"
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, (tuple, list)) and not value:
        return ""
    if isinstance(value, tuple) and all(isinstance(one, float) for one in value):
        return f"`[{', '.join(f'{one:g}' for one in value)}]`"
    return f"`{value if isinstance(value, str) else json.dumps(value)}`" if value != "" else ""


# --- rows and tables ---

#: What every element has, said once above all of them.
_OF_ALL = "it acts from the start on; an event may switch it"


class Row(NamedTuple):
    """What is to be said of a key."""

    key: str
    kind: str
    default: str
    meaning: str

    def line(self) -> str:
        """Return it as a line of a list: bold what a file must give, behind it what holds if it does not."""
        key = f"**{self.key}**" if self.default == "required" else self.key
        meaning = self.meaning
        if re.match(r"required |the |where |as ", self.default):
            said = (
                self.default.replace("the ", "left out, the ", 1) if "name" in self.default else self.default
            )
            meaning = f"{meaning}; {said}" if meaning else said
        elif self.default and self.default != "required":
            key += f" = {self.default}"
        said = f": {meaning}" if meaning else ""
        choices = re.findall(r"`[^`]+`", self.kind)
        explained = choices and all(choice in meaning for choice in choices)
        told = self.kind not in ("", "text") and not explained and self.default not in ("`true`", "`false`")
        return f"- {key}{f' [{self.kind}]' if told else ''}{said}"


def first_line(cls: type[Any]) -> str:
    """Return what a class is, in a line."""
    return (cls.__doc__ or "").splitlines()[0].rstrip(".").replace("``", "`")


def keys_of(
    cls: type[Any], *names: str, without: tuple[str, ...] = (), required: str = "required"
) -> list[Row]:
    """Return the rows of a table's keys: of all of them, or of those named."""
    docs = docs_of(cls)
    parameters = parameters_of(cls.fills) if issubclass(cls, MadeSpec) else {}
    found = []
    for name in names or cls.model_fields:
        if name in without:
            continue
        field = cls.model_fields[name]
        meaning = plain(docs[name])
        kind, default = kind_of(field, parameters.get(name)), default_of(field)
        if "`exact-restitution`" in kind:
            kind = "a [dissipation](../theory/laws.md#dissipation), or `elastic`"
        said = "" if meaning == name.replace("_", " ") else meaning
        found.append(Row(f"`{name}`", kind, required if default == "required" else default, said))
    return found


def said_once(rows: list[Row]) -> list[Row]:
    """Return rows without what every element has, and with the keys of an upper side in one row."""
    upper = [row for row in rows if row.key.startswith("`upper_")]
    left = [row for row in rows if row.meaning != _OF_ALL and row not in upper]
    if len(upper) > 1:
        names = ", ".join(row.key for row in upper)
        meaning = "The same of the upper side, where it differs; a law of its own needs its parameters"
        left.append(Row(names, "as above", "", meaning))
    elif upper:
        left += upper
    return left


def listed(rows: list[Row]) -> list[str]:
    """Return rows as a list, and what is to stand behind it."""
    return [*(row.line() for row in rows), ""] if rows else []


def kinds_of(rows: Mapping[str, list[Row]], said: Mapping[str, str]) -> list[str]:
    """Return the rows of kinds as lists: what all share, what some do, and what each has for itself.

    Args:
        rows: Of each kind.
        said: What each kind is, in a line; where none is said of any, none is.
    """
    having: dict[Row, list[str]] = {}
    for kind, own in rows.items():
        for row in own:
            if not (said and row.key.strip("*") == "`kind`"):
                having.setdefault(row, []).append(kind)
    groups: dict[tuple[str, ...], list[Row]] = {}
    for row, kinds in having.items():
        groups.setdefault(tuple(kinds), []).append(row)
    of_all = listed(groups.pop(tuple(rows), []))
    lines = list(of_all)
    for kinds in sorted(groups, key=lambda some: (list(rows).index(some[0]), -len(some))):
        names = ", ".join(f"`{kind}`" for kind in kinds)
        lines += [f"**{names}**", "", *listed(groups[kinds])]
    kinds_said = [f"- `{kind}`: {words}" for kind, words in said.items()]
    shared = ["Of all:" if groups else "Keys:", ""] if kinds_said and of_all else []
    return [*kinds_said, *([""] if kinds_said else []), *shared, *lines]
