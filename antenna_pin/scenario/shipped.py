"""The shipped scenarios, and how one is found by name or by path."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from antenna_pin.base.files import absence
from antenna_pin.errors import ScenarioError, UnknownNameError, printable
from antenna_pin.scenario.toml_text import NotTomlError, read_toml_text

FILE_NAME = "scenario.toml"


class CaseSummary(NamedTuple):
    """A case of a scenario, in a line."""

    name: str
    description: str


class ScenarioSummary(NamedTuple):
    """A shipped scenario and its cases, in a line each."""

    name: str
    title: str
    cases: tuple[CaseSummary, ...]


class ScenarioFile(NamedTuple):
    """A scenario file that was found.

    Attributes:
        path: Of the file.
        label: How messages call it.
        name: Name of the scenario.
    """

    path: Path
    label: str
    name: str


def models_path() -> Path:
    """Return the folder of shipped models, in a package or a checkout."""
    package = Path(__file__).resolve().parents[1]
    installed, checkout = package / "_models", package.parent / "models"
    for folder in (installed, checkout):
        if folder.is_dir():
            return folder
    raise ScenarioError(f"the shipped models are missing: neither {installed} nor {checkout} is a folder")


def list_scenarios() -> list[ScenarioSummary]:
    """Return the shipped scenarios by name, with title and cases, without reading units."""
    return [scenario_summary(path.parent.name) for path in sorted(models_path().glob(f"*/{FILE_NAME}"))]


def scenario_summary(name_or_path: str | os.PathLike[str]) -> ScenarioSummary:
    """Return name, title and cases of a scenario, shipped or at a path.

    Raises:
        ScenarioError: There is no such file, or it is no TOML.
    """
    found = find_scenario(name_or_path)
    document = read_toml(found.path, found.label)
    cases = tuple(
        CaseSummary(case, _one_line(table.get("description")))
        for case, table in tables(document.get("cases")).items()
        if isinstance(table, Mapping)
    )
    return ScenarioSummary(found.name, _one_line(document.get("title")), cases)


def _one_line(text: object) -> str:
    return printable(" ".join(text.split())) if isinstance(text, str) else ""


def scenario_cases(name_or_path: str | os.PathLike[str]) -> tuple[CaseSummary, ...]:
    """Return a scenario's cases in the file's order; none without cases."""
    return scenario_summary(name_or_path).cases


def find_scenario(name_or_path: str | os.PathLike[str]) -> ScenarioFile:
    """Return the scenario file of a shipped name, of a folder, or at a path."""
    text = os.fspath(name_or_path)
    shipped = {path.parent.name: path for path in models_path().glob(f"*/{FILE_NAME}")}
    if text in shipped and not isinstance(name_or_path, os.PathLike):
        return ScenarioFile(shipped[text], f"{text}/{FILE_NAME}", text)
    path = Path(os.path.expanduser(text))
    if os.path.isdir(path):
        if not (path / FILE_NAME).is_file():
            others = ", ".join(sorted(other.name for other in path.glob("*.toml")))
            hint = f"; give one of its files: {others}" if others else ""
            raise ScenarioError(f"{text}: the folder has no {FILE_NAME}{hint}")
        return ScenarioFile(path / FILE_NAME, str(Path(text) / FILE_NAME), path.resolve().name)
    if os.path.isfile(path):
        return ScenarioFile(path, text, path.resolve().parent.name if path.name == FILE_NAME else path.stem)
    if path.name == text and path.suffix != ".toml":
        raise UnknownNameError("load_scenario", "shipped scenario, file or folder", text, shipped)
    raise ScenarioError(
        f"{text}: {absence(path, 'file or folder')}; shipped scenarios: {', '.join(sorted(shipped))}"
    )


def read_toml(path: Path, label: str) -> dict[str, Any]:
    """Return the contents of a TOML file, or refuse it with its label."""
    try:
        return read_toml_text(path.read_text(encoding="utf-8-sig"))
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{label}: is not UTF-8 text (byte {error.start})") from None
    except NotTomlError as error:
        raise ScenarioError(f"{label}: {error}") from None
    except OSError as error:
        raise ScenarioError(f"{label}: cannot be read: {error.strerror}") from None


def tables(value: object) -> Mapping[str, Any]:
    """Return a table, or an empty one for what is not a table."""
    return value if isinstance(value, Mapping) else {}
