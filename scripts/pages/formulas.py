"""Formula, parameters, range and source of every law and element, as pages of docs/theory have them.

A law's class says its formula, where it holds and whose it is; here that is turned into Markdown. Written by
``reference.py``.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Iterator, Mapping
from typing import Any

from scenario_reference import plain

from antenna_pin.contact import DISSIPATIONS, FRICTION_LAWS, NORMAL_LAWS, Parameter, law_parameters
from antenna_pin.contact.registry import ALIASES
from antenna_pin.elements import FAMILIES

__all__ = [
    "element_formulas",
    "formulas_table",
    "has_formula",
    "law_default",
    "parts_of",
    "source_of",
    "sources_table",
]

#: Laws that are nothing: there is no formula of none.
NOTHING = ("none",)
_LISTED = 8  # laws that have a parameter; of more, only how many
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


def essence(cls: type[Any]) -> str:
    """Return what a class is and its formula, with the paragraph behind it."""
    paragraphs = parts_of(cls)["said"].split("\n\n")
    shown = [k for k, text in enumerate(paragraphs) if text.startswith(".. math::")]
    # A formula may have lines of its own that are empty: what is indented belongs to it.
    last = shown[-1] if shown else 0
    while last + 1 < len(paragraphs) and paragraphs[last + 1].startswith(" "):
        last += 1
    return markdown("\n\n".join(paragraphs[: last + 2]))


def parameters_line(cls: type[Any]) -> str:
    """Return what a law needs, and what it may be given, in a line."""
    parameters = law_parameters(cls)
    defaults = {name: law_default(name, parameters) for name in parameters}
    needed = [f"`{name}`" for name, one in defaults.items() if one.startswith("required")]
    chosen = [f"`{name}` ({one})" for name, one in defaults.items() if re.match(r"[-\d]", one)]
    pieces = [
        f"Needs {', '.join(needed)}" if needed else "",
        f"may be given {', '.join(chosen)}" if chosen else "",
        "the rest is the joint's" if len(needed) + len(chosen) < len(defaults) else "",
    ]
    line = "; ".join(filter(None, pieces))
    return f"*{line[:1].upper()}{line[1:]}.*".replace("*The rest is", "*All is")


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
        "In bold the laws that need it; others have a default, or take it from the joint.",
        "",
    ]
    for (key, unit, meaning), names in meanings().items():
        said = ", ".join(f"**`{name}`**" if needed else f"`{name}`" for name, needed in names)
        if len(names) > _LISTED:
            said = f"**{len(names)} laws**" if names[0][1] else f"{len(names)} laws"
        lines.append(f"- `{key}` [{unit}]: {meaning} ({said})")
    return "\n".join([*lines, ""])


def meanings() -> dict[tuple[str, str, str], list[tuple[str, bool]]]:
    """Return each parameter by name, unit and meaning: which laws have it, and whether they need it."""
    found: dict[tuple[str, str, str], list[tuple[str, bool]]] = {}
    for _, _, laws in _GROUPS:
        for name, cls in own_laws(laws).items():
            parameters = law_parameters(cls)
            for key, one in parameters.items():
                unit = "-" if one.unit == "1" else str(one.unit).replace("**", "^").replace("*", "·")
                needed = law_default(key, parameters) == "required"
                found.setdefault((key, unit, plain(one.doc)), []).append((name, needed))
    return found


def _whole_laws() -> list[str]:
    """Return the list of laws that combine an elastic law and a dissipation."""
    lines = [
        "## Laws as a whole",
        "",
        "An elastic law with the dissipation of that name, unless given, and exponent 1.5, unless given.",
        "",
    ]
    elastic = {law: key for key, law in NORMAL_LAWS.items()}
    damped = {law: key for key, law in DISSIPATIONS.items()}
    for alias in ALIASES:
        cls = NORMAL_LAWS[alias.name]
        exponent = law_parameters(cls)["exponent"].default
        parts = [f"`{elastic[cls.elastic]}`"]
        if damped[cls.dissipation] != alias.name:
            parts.append(f"`{damped[cls.dissipation]}`")
        named = f"- `{alias.name}`: {' with '.join(parts)}"
        lines.append(named if exponent == 1.5 else f"{named}, exponent {exponent:g}")
    return [*lines, ""]


def element_formulas() -> str:
    """Return what kinds of elements with a formula say of themselves."""
    lines: list[str] = []
    for family, kind, cls in kinds():
        lines += [f"### `{kind}` of `[{family}]`", "", essence(cls), ""]
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
