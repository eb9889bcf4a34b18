"""How things show themselves: one card, as text for a shell and as HTML for a notebook.

The HTML runs no scripts. Parts fold by the browser's own means; colours are the page's, but for those of
lines and of how something ended, which have a value for light pages and one for dark ones.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

from antenna_pin.base.readable import readable

__all__ = ["Card", "Fact", "Fold", "measured", "table"]

_COLUMNS, _LINES = 80, 24

# Pages say whether they are dark in several ways: the system's, JupyterLab's, Sphinx' and VS Code's.
_LIGHT = (
    "--good:#00734f;--bad:#b3261e;--line-1:#0072b2;--line-2:#c44e00;--line-3:#00734f;--line-4:#a8417a;"
    "--line-5:#8a6100;--line-6:#2a7fb8"
)
_DARK = (
    "--good:#4cc38a;--bad:#ff8a70;--line-1:#6cb6ff;--line-2:#ff9d5c;--line-3:#4cc38a;--line-4:#e5a3c9;"
    "--line-5:#f2c14e;--line-6:#8fd3ff"
)
_SAYS_LIGHT = ('html[data-theme="light"]', '[data-jp-theme-light="true"]', "body.vscode-light")
_SAYS_DARK = ('html[data-theme="dark"]', '[data-jp-theme-light="false"]', "body.vscode-dark")
_RULES = {
    "": "font:14px/1.45 system-ui,sans-serif;max-width:60rem;text-align:left;overflow-wrap:anywhere",
    " header": "border-bottom:1px solid color-mix(in srgb,currentColor 25%,transparent);padding:.2rem 0",
    " header i": "opacity:.75;font-style:normal;margin-right:.5em",
    " dl": "display:grid;grid-template-columns:minmax(6em,max-content) 1fr;gap:.1rem .9rem;margin:.4rem 0",
    " dt": "opacity:.75;font-weight:400",
    " dd": "margin:0",
    " summary": "cursor:pointer;padding:.15rem 0",
    " summary span": "opacity:.75",
    " details>div": "overflow-x:auto;padding:0 0 .4rem 1rem",
    " table": "border-collapse:collapse;font-size:13px;margin:0;overflow-wrap:normal",
    " tr": "background:none",
    " td": "text-align:left;padding:.1rem .9rem .1rem 0;vertical-align:top;border:0",
    " th": "text-align:left;padding:.1rem .9rem .1rem 0;vertical-align:bottom;border:0;opacity:.75;"
    "font-weight:400",
    " .n": "text-align:right;font-variant-numeric:tabular-nums",
    " td.n": "white-space:nowrap",
    " pre": "margin:0;font-size:12px;white-space:pre-wrap;background:none;color:inherit",
    " .good": "color:var(--good)",
    " .bad": "color:var(--bad)",
}


def _style() -> str:
    own = ".antenna-pin-card"
    rules = "".join(f"{own}{place}{{{rule}}}" for place, rule in _RULES.items())
    light, dark = (",".join(f"{one} {own}" for one in said) for said in (_SAYS_LIGHT, _SAYS_DARK))
    return (
        f"<style>{own}{{{_LIGHT}}}@media(prefers-color-scheme:dark){{{own}{{{_DARK}}}}}"
        f"{light}{{{_LIGHT}}}{dark}{{{_DARK}}}{rules}</style>"
    )


@dataclass(frozen=True, slots=True)
class Fact:
    """One thing that is said: what it is about, and what is said.

    Attributes:
        about: Of what.
        text: What.
        good: Whether that is as it should be; None where that is no question.
    """

    about: str
    text: str
    good: bool | None = None


@dataclass(frozen=True, slots=True)
class Fold:
    """A part that folds.

    Attributes:
        title: Its title.
        said: What is said beside it while it is folded.
        html: What is in it.
        open: Whether it is open at first.
    """

    title: str
    said: str
    html: str
    open: bool = False


@dataclass(frozen=True, slots=True)
class Card:
    """What a thing shows of itself.

    Attributes:
        kind: What it is.
        title: Which one.
        facts: What is said of it first.
        folds: What is there besides, in a notebook.
        hint: What to ask it next, in a shell.
    """

    kind: str
    title: str
    facts: tuple[Fact, ...]
    folds: tuple[Fold, ...] = ()
    hint: str = ""

    def text(self) -> str:
        """Return it as text, of 80 columns and at most 24 lines."""
        widest = min(max((len(fact.about) for fact in self.facts), default=0), 24)
        lines = textwrap.wrap(f"{self.kind} {self.title}", _COLUMNS, subsequent_indent="  ")
        for fact in self.facts:
            about = f"  {fact.about:<{widest}}  "
            whole = f"{about}{fact.text}"
            lines += textwrap.wrap(whole, _COLUMNS, subsequent_indent=" " * (widest + 4)) or [about]
        last = textwrap.wrap(self.hint, _COLUMNS - 2, initial_indent="  ", subsequent_indent="  ")
        room = _LINES - len(last)
        if len(lines) > room:
            lines = [*lines[: room - 1], f"  ... and {len(lines) - room + 1} lines more"]
        return "\n".join([*lines, *last])

    def html(self) -> str:
        """Return it as HTML for a notebook."""
        return f'{_style()}<div class="antenna-pin-card">{"".join(self._parts())}</div>'

    def _parts(self) -> Iterator[str]:
        yield f"<header><i>{escape(self.kind)}</i><b>{escape(self.title)}</b></header>"
        said = "".join(
            f"<dt>{escape(fact.about)}</dt><dd{_look(fact.good)}>{escape(fact.text)}</dd>"
            for fact in self.facts
        )
        yield f"<dl>{said}</dl>" if said else ""
        for fold in self.folds:
            yield (
                f"<details{' open' if fold.open else ''}><summary>{escape(fold.title)} "
                f"<span>{escape(fold.said)}</span></summary><div>{fold.html}</div></details>"
            )


def _look(good: bool | None) -> str:
    return "" if good is None else f' class="{"good" if good else "bad"}"'


@dataclass(frozen=True, slots=True)
class Measured:
    """A number with its unit, and all its digits for who points at it."""

    value: float
    text: str


def measured(value: float | None, unit: str = "1", digits: int = 4) -> Measured | str:
    """Return a number for a table's cell, as it is read, with all its digits behind it; a dash for none."""
    if value is None or value != value:
        return readable(None)
    return Measured(float(value), readable(float(value), unit, digits))


def table(rows: Sequence[Sequence[Any]], head: Sequence[str] = ()) -> str:
    """Return rows of texts and numbers (:func:`measured`) as HTML."""
    columns = [any(isinstance(one, Measured) for one in column) for column in zip(*rows, strict=True)]
    right = ['class="n"' if numbers else "" for numbers in columns] or [""] * len(head)
    cells = (_element("th", look, escape(one)) for look, one in zip(right, head, strict=False))
    top = f"<tr>{''.join(cells)}</tr>" if head else ""
    body = "".join(f"<tr>{''.join(map(_cell, right, row))}</tr>" for row in rows)
    return f"<table>{top}{body}</table>"


def _cell(look: str, one: Any) -> str:
    if isinstance(one, Measured):
        return _element("td", f'{look} title="{one.value!r}"', escape(one.text))
    return _element("td", look, escape(str(one)))


def _element(name: str, attributes: str, text: str) -> str:
    return f"<{name}{attributes and ' '}{attributes}>{text}</{name}>"
