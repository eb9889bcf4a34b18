#!/usr/bin/env python3
"""Language of the package: summary lines, names and spelling, each rule with a ceiling that only falls.

    scripts/check/language.py                 # counts beside their ceilings; exit code 1 above one
    scripts/check/language.py --list openings # places of a rule
    scripts/check/language.py --lower         # write today's counts as ceilings, where they are lower

Rules:

- ``openings``: summary lines that begin with a question word or a fragment (What, How, Whether, Of, ...).
- ``long``: summary lines of more than 15 words.
- ``persons``: summary lines in which code is told, asked or shown, or knows and keeps something.
- ``names``: modules, classes, functions and arguments named by a participle or an adverb alone.
- ``shared``: class names that more than one class has.
- ``british``: American spellings in docstrings, comments and pages.
- ``idiom``: lines of messages and docstring bodies in which code is told, asked or looked at.
- ``spelling``: words that codespell corrects.
"""

from __future__ import annotations

import argparse
import ast
import os
import re
import subprocess
import sys
import tokenize
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
CEILINGS = Path(__file__).with_suffix(".toml")

_OPENINGS = re.compile(r"(What|How|Whether|Where|When|Who|Whose|Which|Of|That|Those|Such|One|It|They)\b")
_PERSONS = re.compile(
    r"\b(is|are|be|was|were|been) (told|asked|shown|said|seen|looked at|met|minded|given up)\b"
    r"|\b(asks?|tells?|told|knows?|knew|minds?|looks? (at|for|from|like)|keeps?|kept|says?|said)\b"
)
_IDIOM = re.compile(
    r"\b(is|are|be|was|were|been) (told|asked|said|looked at|minded|given up)\b|\b(asked|asks?) for\b"
    r"|\bknows?\b|\b(goes|go|gone) on\b|\blooks? (at|for)\b|\bleft out beside\b|\banew\b"
    r"|\b(told|tells?) apart\b|\bhangs? on\b"
)
_ALONE = frozenset(
    "told asked kept taken made found named seen held first now near beside within alike unlike hidden "
    "missed standing passages witness happened followed given measured prepared searched said".split()
)
_AMERICAN = re.compile(
    r"\b(color(ed|s|ing)?|center(ed|s|ing)?|behavior(s|al)?|label(ed|ing)|model(ed|ing)|travel(ed|ing)|gray|"
    r"neighbor(s|ing|hood)?|favor(s|ed|able)?|flavor(s)?|analyz(e|ed|es|ing)|catalog|fiber(s)?|"
    r"cancel(ed|ing)|modulus'es)\b"
)
_WORDS = 15
_RULES = ("openings", "long", "persons", "names", "shared", "british", "idiom", "spelling")


class Place(NamedTuple):
    """Place where a rule is broken."""

    file: str  # path below the root
    line: int  # number of the line
    text: str  # name, or text that breaks the rule


def places() -> dict[str, list[Place]]:
    """Return the places where each rule is broken, by the name of the rule."""
    found: dict[str, list[Place]] = {rule: [] for rule in _RULES}
    classes: dict[str, list[Place]] = defaultdict(list)
    for path in sorted((ROOT / "antenna_pin").rglob("*.py")):
        file = str(path.relative_to(ROOT))
        tree = ast.parse(path.read_text(encoding="utf-8"))
        if path.stem.strip("_") in _ALONE:
            found["names"].append(Place(file, 1, path.stem))
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                classes[node.name].append(Place(file, node.lineno, node.name))
            for rule, place in (*_of_summary(file, node), *_of_names(file, node)):
                found[rule].append(place)
        found["idiom"] += _idiom(file, tree)
    found["shared"] = [one for ones in classes.values() if len(ones) > 1 for one in ones]
    found["british"] = list(_american())
    found["spelling"] = list(_misspelt())
    return found


def _of_summary(file: str, node: ast.AST) -> Iterator[tuple[str, Place]]:
    """Yield the rules that a summary line breaks."""
    if not isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
        return
    summary = (ast.get_docstring(node) or "").split("\n\n")[0].replace("\n", " ")
    place = Place(file, getattr(node, "lineno", 1), summary)
    if _OPENINGS.match(summary):
        yield "openings", place
    if len(summary.split()) > _WORDS:
        yield "long", place
    if _PERSONS.search(summary):
        yield "persons", place


def _idiom(file: str, tree: ast.Module) -> Iterator[Place]:
    """Yield lines of docstring bodies and messages that have a banned phrase."""
    bodies = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            if ast.get_docstring(node) is not None:
                bodies.add(id(node.body[0].value))  # type: ignore[attr-defined]
    for node in ast.walk(tree):
        if not isinstance(node, ast.Constant) or not isinstance(node.value, str):
            continue
        text = node.value.partition("\n\n")[2] if id(node) in bodies else node.value
        for line in text.split("\n") if " " in text else ():
            if _IDIOM.search(re.sub(r"`[^`]*`", "", line)):
                yield Place(file, node.lineno, line.strip())


def _of_names(file: str, node: ast.AST) -> Iterator[tuple[str, Place]]:
    """Yield the names that are a participle or an adverb alone."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        if node.name.strip("_").lower() in _ALONE:
            yield "names", Place(file, node.lineno, node.name)
    if isinstance(node, ast.arg) and node.arg.strip("_") in _ALONE:
        yield "names", Place(file, node.lineno, node.arg)


def _american() -> Iterator[Place]:
    """Yield American spellings in docstrings, comments and pages; quoted code is left out."""
    for path in sorted([*(ROOT / "antenna_pin").rglob("*.py")]):
        file = str(path.relative_to(ROOT))
        with tokenize.open(path) as source:
            for token in tokenize.generate_tokens(source.readline):
                prose = token.type == tokenize.COMMENT or token.string.startswith(('"""', 'r"""'))
                if prose and (hit := _AMERICAN.search(re.sub(r"`[^`]*`|\"[^\"]*\"", "", token.string))):
                    yield Place(file, token.start[0], hit.group())
    for path in sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]):
        code = False
        for k, line in enumerate(path.read_text(encoding="utf-8").split("\n"), 1):
            code ^= line.startswith("```")
            hit = None if code else _AMERICAN.search(re.sub(r"`[^`]*`|\([^)]*\)|<[^>]*>", "", line))
            if hit:
                yield Place(str(path.relative_to(ROOT)), k, hit.group())


def _misspelt() -> Iterator[Place]:
    """Yield what codespell corrects."""
    folders = [str(ROOT / name) for name in ("antenna_pin", "docs", "README.md", "CHANGELOG.md")]
    options = ["--skip", "*.pyc,*.svg,*.png,*.js,*.json,*.ipynb,*.nc,*.csv,*.css,*.html,__pycache__"]
    command = [sys.executable, "-m", "codespell_lib", "-L", ",".join(_RIGHT), *options, *folders]
    run = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "COLUMNS": "200"})  # noqa: S603
    if run.returncode not in (0, 65) and not run.stdout:
        raise SystemExit(
            f"language: codespell must run, got {run.stderr.strip()[-200:]!r}; run scripts/setup"
        )
    for line in run.stdout.splitlines():
        where, _, text = line.rpartition(": ")
        file, _, number = where.rpartition(":")
        if number.isdigit():
            yield Place(str(Path(file).relative_to(ROOT)), int(number), text)


# Words of the field, and names of people, that codespell takes for slips.
_RIGHT = "wit worstcase fro lates commun shepperd gere numer lond precesses orgin statics".split()


def main(arguments: list[str] | None = None) -> int:
    """Print the counts beside their ceilings, or the places of one rule."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--list", metavar="RULE", help="print the places of a rule")
    parser.add_argument("--lower", action="store_true", help="write lower ceilings")
    given = parser.parse_args(arguments)
    found = places()
    if given.list is not None:
        if given.list not in found:
            parser.error(f"--list must be one of {', '.join(found)}, got {given.list!r}")
        for place in found[given.list]:
            print(f"{place.file}:{place.line}: {place.text}")
        return 0
    counts = {rule: len(ones) for rule, ones in found.items()}
    counts["shared"] = len({one.text for one in found["shared"]})
    ceilings = tomllib.loads(CEILINGS.read_text(encoding="utf-8")) if CEILINGS.exists() else {}
    above = {rule for rule, count in counts.items() if count > ceilings.get(rule, 0)}
    for rule, count in counts.items():
        mark = " above" if rule in above else ""
        print(f"{rule:10} {count:5} of {ceilings.get(rule, 0):5}{mark}")
        worst = Counter(
            one.file.removeprefix("antenna_pin/").split("/")[0] for one in found[rule] if rule in above
        )
        if worst:
            print(f"           {', '.join(f'{room} {n}' for room, n in worst.most_common(6))}")
    if given.lower:
        lower = {rule: min(count, ceilings.get(rule, count)) for rule, count in counts.items()}
        text = "# Ceilings of scripts/check/language.py, which only fall.\n"
        CEILINGS.write_text(text + "".join(f"{rule} = {n}\n" for rule, n in lower.items()), encoding="utf-8")
        return 0
    if above:
        print(f"language: see scripts/check/language.py --list {sorted(above)[0]}")
    return 1 if above else 0


if __name__ == "__main__":
    sys.exit(main())
