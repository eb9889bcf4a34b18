#!/usr/bin/env python3
"""Reference tables of README.md and docs/, made from the code.

A table stands between ``<!-- table: NAME -->`` and ``<!-- end -->``::

    python scripts/pages/reference.py             # are all of them up to date? (--check)
    python scripts/pages/reference.py --write     # bring them up to date

There are ``scenario``, the tables of a scenario file, and ``scenario_GROUP``, their keys (by
``scenario_tables.py``); ``formulas``, ``element_formulas`` and ``sources``, what the classes of laws and
elements say of themselves (by ``formulas.py``); ``dimensions`` and ``trajectory``, what a result holds;
``figures``, what can be drawn of runs; ``layers``, who may import whom; and in the package, for editors,
``figure_names``, the names of the figures.
"""

from __future__ import annotations

import argparse
import re
import sys
import tomllib
from collections.abc import Callable
from functools import partial
from pathlib import Path

from formulas import element_formulas, formulas_table, sources_table
from scenario_tables import GROUPS, overview, page_of

from antenna_pin.show.plot import CATALOGUE, PAPERS
from antenna_pin.trajectory.schema import COORDINATES, DIMENSIONS, VARIABLES

ROOT = Path(__file__).parents[2]
PLACE = re.compile(r"(<!-- table: (\w+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


# --- the variables of a result, the figures of runs, and the layers of the package ---

#: What docs/trajectory.md says once above its tables: names, units of sliding joints, spans, peaks.
_SAID_ABOVE = re.compile(
    r",? by name(?=$|;)"
    r"| \((a |m/s|N s|N\b|way|displacement|m/s\^2)[^()]*\)"
    r"|,? (since the start|from start to end|at a sample|in all)\b"
)
_LARGEST = re.compile(r"^largest (size of )?(the |its |an |a )?", re.IGNORECASE)


def short(meaning: str, name: str) -> str:
    """Return the meaning of a variable without what its page says above, or nothing if it is the name."""
    meaning = _SAID_ABOVE.sub("", meaning)
    if name.startswith("peak_"):
        meaning = _LARGEST.sub("", meaning)
    return "" if name.replace("_", " ").endswith(meaning.lower()) else meaning


def trajectory_table() -> str:
    """Return the variables and labels of a result, of its schema, by their dimensions."""
    groups: dict[str, list[str]] = {"time": ["- `time` [s]"]}
    for label in COORDINATES:
        groups.setdefault(label.dim, []).append(f"- `{label.name}`: {label.meaning}")
    for one in VARIABLES.values():
        of_group = rf"(?<!integral) of the ({'|'.join(one.dims)})\b(?!')"
        meaning = short(re.sub(of_group, "", one.meaning), one.name)
        if one.flags:
            meaning += ": " + ", ".join(f"{value} {word}" for value, word in one.flags)
        if "NaN" in one.rule.words and "NaN" not in meaning:
            meaning += ", or NaN"
        unit = "-" if one.units == "1" else one.units
        line = f"- `{one.name}` [{unit}]" + (f": {meaning}" if meaning else "")
        groups.setdefault(", ".join(one.dims), []).append(line)
    return "\n\n".join(f"**{dims}**\n\n" + "\n".join(lines) for dims, lines in groups.items()) + "\n"


def dimensions_table() -> str:
    """Return the dimensions of a result, of its schema."""
    return "".join(f"- `{name}`: {short(meaning, name)}\n" for name, meaning in DIMENSIONS.items())


def figures_table() -> str:
    """Return the catalogue of figures, with the papers' figures that show the same."""
    lines = []
    for figure in CATALOGUE.values():
        papers = [
            f"`{model}` {', '.join(numbers)}"
            for model, each in PAPERS.items()
            if (numbers := [str(one.number) for one in each if one.figure == figure.name])
        ]
        drawn = [place for place, mark in (("plot", figure.standard), ("report", figure.reported)) if mark]
        shows = figure.title.format(joint="a joint")
        said = [*([] if len(drawn) == 2 else [", ".join(drawn) or "by name"]), *papers]
        lines.append(f"- `{figure.name}`: {shows}" + (f" ({'; '.join(said)})" if said else ""))
    return "\n".join([*lines, ""])


def figure_names() -> str:
    """Return the names of the catalogue's figures as Python, for type checkers."""
    names = "".join(f"    {name!r},\n".replace("'", '"') for name in CATALOGUE)
    drawn = "".join(
        f'    {name}: DrawingView\n    """{figure.title.format(joint="a joint")}."""\n'
        for name, figure in CATALOGUE.items()
    )
    return (
        f"FigureName = Literal[\n{names}]\n\n\nclass NamedFigures(Protocol):\n"
        f'    """Figures of runs, each ready to be drawn."""\n\n{drawn}\n\n# '
    )


def layers_table() -> str:
    """Return the layers that the import contract in pyproject.toml names."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    (layers,) = (contract["layers"] for contract in contracts if contract["id"] == "layers")
    return "\n".join(["```text", *(layer.replace("(", "").replace(")", "") for layer in layers), "```", ""])


TABLES: dict[str, Callable[[], str]] = {
    "scenario": overview,
    **{f"scenario_{group}": partial(page_of, group) for group in GROUPS},
    "formulas": formulas_table,
    "element_formulas": element_formulas,
    "sources": sources_table,
    "trajectory": trajectory_table,
    "dimensions": dimensions_table,
    "figures": figures_table,
    "layers": layers_table,
    "figure_names": figure_names,
}


# --- documents ---


def documents() -> list[Path]:
    """Return the documents that may hold a table."""
    own = ROOT / "antenna_pin" / "base" / "views.py"
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")), own]


def names_of_tables(text: str) -> list[str]:
    """Return the names of the tables that a document holds."""
    return [name for _, name, _, _ in PLACE.findall(text)]


def filled(text: str) -> str:
    """Return a document with its tables as the code has them."""
    return PLACE.sub(lambda match: f"{match.group(1)}{TABLES[match.group(2)]()}{match.group(4)}", text)


def main() -> int:
    """Check or write all tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    choice = parser.add_mutually_exclusive_group()
    choice.add_argument("--check", action="store_true", help="only say what is out of date (default)")
    choice.add_argument("--write", action="store_true", help="bring them up to date")
    write = parser.parse_args().write
    late = 0
    for path in documents():
        text = path.read_text()
        if (new := filled(text)) == text:
            continue
        if write:
            path.write_text(new)
        late += not write
        said = "written" if write else "out of date; bring it up to date with --write"
        print(f"{path.relative_to(ROOT)}: {said}")
    return 1 if late else 0


if __name__ == "__main__":
    sys.exit(main())
