"""Formula, parameters, range and source of every law and element, as pages of docs/theory have them.

A law's class says its formula, where it holds and whose it is; here that is turned into Markdown. Written by
``reference.py``.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from scenario_reference import plain

from antenna_pin.contact import DISSIPATIONS, FRICTION_LAWS, NORMAL_LAWS, Parameter, law_parameters
from antenna_pin.contact.registry import ALIASES
from antenna_pin.elements import FAMILIES

#: Laws that are nothing: there is no formula of none.
NOTHING = ("none",)
_LISTED = 8  # laws that have a parameter; that of more is described once
_LONG = 15  # words of a meaning; a longer one of several laws is described once
_SECTION = re.compile(r"^(Attributes|References|Args|Returns|Raises):$", re.MULTILINE)
_DISPLAYED = re.compile(r"^\.\. math::(.*(?:\n(?:[ \t]+\S.*|[ \t]*(?=\n[ \t]+\S)))*)", re.MULTILINE)


def parts_of(cls: type[Any]) -> dict[str, str]:
    """Return the sections of a class's docstring by name; what stands before them is ``said``."""
    text = inspect.getdoc(cls) or ""
    pieces = _SECTION.split(text)
    named = {
        name: textwrap.dedent(body).strip("\n") for name, body in zip(pieces[1::2], pieces[2::2], strict=True)
    }
    return {"said": pieces[0].strip(), **named}


def has_formula(cls: type[Any]) -> bool:
    """Return whether a class says its formula."""
    return ":math:" in parts_of(cls)["said"] or ".. math::" in parts_of(cls)["said"]


def source_of(cls: type[Any]) -> str:
    """Return whose law it is, in one paragraph."""
    return " ".join(parts_of(cls).get("References", "").split())


def markdown(text: str) -> str:
    """Return a docstring's words and formulas as Markdown, which GitHub and the site draw."""

    def displayed(match: re.Match[str]) -> str:
        return "$$\n" + "\n".join(line.strip() for line in match.group(1).strip().splitlines()) + "\n$$"

    text = _DISPLAYED.sub(displayed, text)
    text = re.sub(r":math:`([^`]*)`", lambda match: f"${' '.join(match.group(1).split())}$", text)
    text = re.sub(r":\w+:`~?(?:[\w.]*\.)?(\w+)`", r"`\1`", text)
    return text.replace("``", "`")


def law_default(name: str, parameters: dict[str, Parameter]) -> str:
    """Return the default of a law's parameter, or where it comes from if a file leaves it out."""
    parameter = parameters[name]
    if parameter.default is not None:
        return f"{parameter.default:g}"
    if not parameter.from_joint:
        return "required"
    if name == "stiffness":
        given = "from materials and radii"
        return given if parameters["exponent"].default == 1.5 else f"required; {given} if exponent is 1.5"
    return {"modulus": "from materials", "effective_mass": "from the contact"}.get(name, "from the joint")


#: What a dissipation delivers, which docs/contact-laws.md shows of all beside one another.
_DELIVERED = re.compile(r": delivers\s(?:[^.]|\.\d)*|(?<=\.)\s+Delivers\s(?:[^.]|\.\d)*\.")


def essence(cls: type[Any], named: bool = False) -> str:
    """Return what a class is and its formula, with the paragraph behind it.

    Args:
        cls: Class.
        named: Without its first line where the formula follows: the scenario's reference has it.
    """
    paragraphs = parts_of(cls)["said"].split("\n\n")
    if named and paragraphs[1].startswith(".. math::"):
        paragraphs = paragraphs[1:]
    shown = [k for k, text in enumerate(paragraphs) if text.startswith(".. math::")]
    # A formula may have lines of its own that are empty: what is indented belongs to it.
    last = shown[-1] if shown else 0
    while last + 1 < len(paragraphs) and paragraphs[last + 1].startswith(" "):
        last += 1
    text = markdown("\n\n".join(paragraphs[: last + 2]))
    return _DELIVERED.sub("", text) if cls in DISSIPATIONS.values() else text


def unit_of(parameter: Parameter) -> str:
    """Return the unit of a law's parameter as the pages have it."""
    return "-" if parameter.unit == "1" else str(parameter.unit).replace("**", "^").replace("*", "·")


def is_shared(meaning: str, laws: list[str]) -> bool:
    """Return whether a parameter is described once for all of its laws."""
    return len(laws) > _LISTED or (len(laws) > 1 and len(meaning.split()) > _LONG)


def parameters_line(cls: type[Any]) -> str:
    """Return the parameters of a law with unit, default and meaning: bold those it needs."""
    parameters = law_parameters(cls)
    shared = {which for which, names in meanings().items() if is_shared(which[2], names)}
    lines = []
    for name, one in parameters.items():
        default = law_default(name, parameters)
        said = f"**`{name}`**" if default.startswith("required") else f"`{name}`"
        said += f" = {default}" if re.match(r"[-\d]", default) else ""
        said += f" [{unit_of(one)}]"
        if (name, unit_of(one), plain(one.doc)) not in shared:
            lines.append(f"{said}: {plain(one.doc)}" + (f", {default}" if name == "stiffness" else ""))
        elif not one.from_joint:
            lines.append(said)
    if not lines:
        return "All is the joint's."
    return "; ".join([*lines, *(["the rest is the joint's"] if len(lines) < len(parameters) else [])]) + "."


def short_source(cls: type[Any]) -> str:
    """Return author and year of what a law is from, if it says them."""
    found = re.match(r"[^();:.]*(?:\. ?[A-Z][^();:.]*)*\([^)]*\d{4}[^)]*\)", source_of(cls))
    return found.group() if found and len(found.group()) < 90 else ""


def law_entry(name: str, cls: type[Any]) -> Iterator[str]:
    """Yield the lines of a law: words and formula, parameters, source."""
    yield from (f"### `{name}`", "", essence(cls), "")
    said = short_source(cls)
    source = f"[{said or 'Source'}](sources.md)" if source_of(cls) else ""
    yield from (f"{parameters_line(cls)} {source}".strip(), "")


def kinds() -> Iterator[tuple[str, str, type[Any]]]:
    """Yield family, kind and class of each element that says a formula."""
    for family, entry in FAMILIES.items():
        for kind, cls in entry.kinds.items():
            if has_formula(cls):
                yield family, kind, cls


def own_laws(laws: Mapping[str, type[Any]]) -> dict[str, type[Any]]:
    """Return the laws of a kind that have a formula of their own."""
    whole = {alias.name for alias in ALIASES} if laws is NORMAL_LAWS else set()
    return {name: cls for name, cls in laws.items() if name not in NOTHING and name not in whole}


def formulas_table() -> str:
    """Return all laws: elastic ones, what dissipates, laws as a whole, friction; then their parameters."""
    lines: list[str] = []
    for title, note, laws in _GROUPS:
        lines += [f"## {title}", "", note, ""]
        for name, cls in own_laws(laws).items():
            lines += law_entry(name, cls)
        if laws is DISSIPATIONS:
            lines += _whole_laws()
    lines += [
        "## Parameters",
        "",
        "Those of a law stand with it, bold if it needs them. Of many laws, and the joint's unless given:",
        "",
    ]
    for (key, unit, meaning), names in meanings().items():
        if is_shared(meaning, names):
            lines.append(f"- `{key}` [{unit}]: {meaning}")
    return "\n".join([*lines, ""])


@cache
def meanings() -> dict[tuple[str, str, str], list[str]]:
    """Return each parameter by name, unit and meaning: which laws have it."""
    found: dict[tuple[str, str, str], list[str]] = {}
    for _, _, laws in _GROUPS:
        for name, cls in own_laws(laws).items():
            parameters = law_parameters(cls)
            for key, one in parameters.items():
                found.setdefault((key, unit_of(one), plain(one.doc)), []).append(name)
    return found


def _whole_laws() -> list[str]:
    """Return the list of laws that combine an elastic law and a dissipation."""
    elastic = {law: key for key, law in NORMAL_LAWS.items()}
    damped = {law: key for key, law in DISSIPATIONS.items()}
    laws: dict[str, list[str]] = {}
    for alias in ALIASES:
        cls = NORMAL_LAWS[alias.name]
        exponent = law_parameters(cls)["exponent"].default
        power = "" if exponent == 1.5 else f" with the exponent {exponent:g}"
        other = "" if damped[cls.dissipation] == alias.name else f" and `{damped[cls.dissipation]}`"
        laws.setdefault(f"`{elastic[cls.elastic]}`{power}{other}", []).append(f"`{alias.name}`")
    return [
        "## Laws as a whole",
        "",
        "An elastic law with the dissipation of that name and the exponent 1.5, unless given.",
        "",
        *(f"- {parts}: {', '.join(names)}" for parts, names in laws.items()),
        "",
    ]


def element_formulas() -> str:
    """Return what kinds of elements with a formula say of themselves."""
    lines: list[str] = []
    for family, kind, cls in kinds():
        lines += [f"### `{kind}` of `[{family}]`", "", essence(cls, named=True), ""]
    return "\n".join(lines)


#: What is said of many sources, and the mark that docs/theory/sources.md explains.
_MARKS = (
    (r"[;.]? ?([Tt]he )?([Ff]ormula )?[Rr]ecalled, not checked( against the papers?)?", " †"),
    (r"[;.]? ?([Tt]he )?[Ff]ormula recalled, not checked against the papers", " †"),
    (r"; the formula as a public multibody code \(DyS\) has it, not checked against the paper", " ‡"),
    (r"[;.]? [Nn]ot checked against the (book|paper)", " ‡"),
)


def sources_table() -> str:
    """Return whose laws and elements these are, and how far that was checked."""
    entries = [(f"`{name}`", cls) for _, _, laws in _GROUPS for name, cls in own_laws(laws).items()]
    entries += [(f"`{kind}` of `[{family}]`", cls) for family, kind, cls in kinds()]
    said: dict[str, list[str]] = {}
    for name, cls in entries:
        source = source_of(cls)
        for words, mark in _MARKS:
            source = re.sub(words, mark, source)
        if source:
            said.setdefault(markdown(source).rstrip("."), []).append(name)
    return "".join(f"- {', '.join(names)}: {source}\n" for source, names in said.items())


_GROUPS: tuple[tuple[str, str, Mapping[str, type[Any]]], ...] = (
    ("Elastic laws", "With any `dissipation` beside them.", NORMAL_LAWS),
    ("Dissipation", "Beside an elastic law; $\\chi$ as in [impacts](impacts.md).", DISSIPATIONS),
    (
        "Friction",
        "On the journal, against its slip; $\\mu$ is the force over the normal force.",
        FRICTION_LAWS,
    ),
)
