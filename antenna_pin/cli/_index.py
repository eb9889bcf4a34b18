"""The page that lists the figures of a folder, in Markdown."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote

from antenna_pin.base.files import replacing
from antenna_pin.cli._run_store import RunStore


@dataclass
class FigureIndex:
    """The page that lists the figures.

    Attributes:
        folder: Where figures and index are.
        title: Of the scenario.
        source: Of the scenario.
        command: That makes the figures.
        expected: Titles of a paper's figures.
        entries: Title, files, what the paper shows, what is found here.
    """

    folder: Path
    title: str
    source: str
    command: str
    expected: list[str] = field(default_factory=list)
    entries: list[tuple[str, list[str], str, str]] = field(default_factory=list)

    @property
    def path(self) -> Path:
        return self.folder / "index.md"

    def add(self, title: str, files: Iterable[Path], shows: str, found: str) -> None:
        self.entries.append((title, [file.name for file in files], shows, found))

    def write(self, store: RunStore) -> None:
        """Write the page, in Markdown."""
        numbered = bool(self.expected)
        text = [f"# {self.title or 'Figures'}", ""]
        text += [f"Source: {self.source}.", ""] if self.source else []
        text += ["Made by", "", f"    {self.command}", ""]
        if store.cases:
            text += ["| case | what it is | result | how it ended |", "|---|---|---|---|"]
        for case, run in store.runs.items():
            what = store.scenarios[case].description or store.scenarios[case].title
            file = Path(os.path.relpath(store.files[case], self.folder)).as_posix()
            link = f"[{_cell(file)}]({quote(file)})"
            text.append(f"| {_cell(case or store.name)} | {_cell(what)} | {link} | {_cell(run.message)} |")
        waiting = [case or store.name for case in store.cases if case not in store.runs]
        text += ["", f"Not run: {', '.join(waiting)}."] if waiting else []
        missing = [title for title in self.expected if title not in [entry[0] for entry in self.entries]]
        text += ["", f"Not drawn: {', '.join(missing)}."] if missing else []
        if not self.entries:
            pass
        elif numbered:
            text += ["", "| figure | the paper shows | here |", "|---|---|---|"]
        else:
            text += ["", "| figure | files |", "|---|---|"]
        for title, files, shows, found in self.entries:
            links = ", ".join(f"[{Path(file).suffix[1:]}]({file})" for file in files)
            cells = [f"{title} {links}", shows, found] if numbered else [title, links or found]
            text.append(f"| {' | '.join(_cell(cell) for cell in cells)} |")
        for title, files, _, _ in self.entries:
            picture = next((file for file in files if not file.endswith(".pdf")), None)
            text += ["", f"![{title}]({picture})"] if picture else []
        with replacing(self.path) as partial:
            partial.write_text("\n".join(text) + "\n", encoding="utf-8", errors="backslashreplace")


def _cell(text: str) -> str:
    """Return text that fits into a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")
