"""Formula, parameters, range and source of every law, as docs/theory/laws.md has them.

A law's class says its formula, where it holds and whose it is; here that is turned into Markdown. Written by
``reference.py``.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Iterator
from typing import Any

from scenario_reference import law_default

from antenna_pin.contact import DISSIPATIONS, FRICTION_LAWS, NORMAL_LAWS, law_parameters
from antenna_pin.contact.aliases import ALIASES
from antenna_pin.elements import FAMILIES

__all__ = ["formulas_table", "has_formula", "parts_of", "source_of"]

#: Laws that are nothing: there is no formula of none.
NOTHING = ("none",)
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


def law_entry(name: str, cls: type[Any]) -> Iterator[str]:
    """Yield the lines of a law: words and formula, parameters, source."""
    yield from (f"### `{name}`", "", markdown(parts_of(cls)["said"]), "")
    parameters = law_parameters(cls)
    if parameters:
        yield from ("| parameter | unit | default | meaning |", "|---|---|---|---|")
        for key, one in parameters.items():
            unit = "-" if one.unit == "1" else str(one.unit).replace("**", "^")
            yield f"| `{key}` | {unit} | {law_default(key, parameters)} | {one.doc} |"
        yield ""
    if source := source_of(cls):
        yield from (f"*Source:* {markdown(source)}", "")


def kinds() -> Iterator[tuple[str, str, type[Any]]]:
    """Yield family, kind and class of each element that says a formula."""
    for family, entry in FAMILIES.items():
        for kind, cls in entry.kinds.items():
            if has_formula(cls):
                yield family, kind, cls


def formulas_table() -> str:
    """Return all laws: elastic ones, what dissipates, laws as a whole, friction, and those of elements."""
    whole = {alias.name for alias in ALIASES}
    groups = (
        ("Elastic laws", "A normal law of which any dissipation below can be named.", NORMAL_LAWS),
        ("Dissipation", "Beside an elastic law, as `dissipation`.", DISSIPATIONS),
        (
            "Friction",
            "On the journal, against its slip; $\\mu$ is the force over the normal force.",
            FRICTION_LAWS,
        ),
    )
    lines: list[str] = []
    for title, note, laws in groups:
        lines += [f"## {title}", "", note, ""]
        for name, cls in laws.items():
            if name not in NOTHING and (laws is not NORMAL_LAWS or name not in whole):
                lines += law_entry(name, cls)
        if laws is DISSIPATIONS:
            lines += ["## Laws as a whole", "", "An elastic law with the dissipation of its authors.", ""]
            lines += ["| law | elastic part | dissipation | exponent |", "|---|---|---|---|"]
            for alias in ALIASES:
                cls = NORMAL_LAWS[alias.name]
                own = {law: key for key, law in NORMAL_LAWS.items()}
                damped = {law: key for key, law in DISSIPATIONS.items()}
                exponent = law_parameters(cls)["exponent"].default
                lines.append(
                    f"| `{alias.name}` | `{own[cls.elastic]}` | `{damped[cls.dissipation]}` | {exponent:g} |"
                )
            lines.append("")
    lines += ["## Elements", "", "Kinds of elements at joints and on links that have a formula.", ""]
    for family, kind, cls in kinds():
        lines += [f"### `{kind}` of `[{family}]`", "", markdown(parts_of(cls)["said"]), ""]
        if source := source_of(cls):
            lines += [f"*Source:* {markdown(source)}", ""]
    return "\n".join(lines)
