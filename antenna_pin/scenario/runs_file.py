"""Files of runs of a scenario, found by path or shipped name."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Self

from pydantic import Field, ValidationError

from antenna_pin.errors import ScenarioError, UnknownNameError, printable
from antenna_pin.scenario.load import load_scenario
from antenna_pin.scenario.merge import merge, read_overrides
from antenna_pin.scenario.scenario import Scenario
from antenna_pin.scenario.shipped import models_path, read_toml
from antenna_pin.scenario.spec import Spec, ValuePlace, Version, dotted, explained


class RunsFile(Spec):
    """Base of such files.

    Attributes:
        format: Version of the format of such files.
        title: Short title.
        scenario: Name of a shipped scenario, or path of a scenario file, from this file's folder.
        case: Of the scenario; its default one if left out.
        set: What is set over scenario and case for all runs: dotted keys, or tables.
    """

    # How the names of such files end, and what one is called.
    suffix: ClassVar[str]
    word: ClassVar[str]
    carried: ClassVar[frozenset[str]] = frozenset({"name", "folder"})

    format: Version = 1
    title: str = ""
    scenario: str
    case: str | None = None
    set: dict[str, Any] = Field(default_factory=dict)

    def base(self, settings: Sequence[str] = ()) -> Scenario:
        """Return the scenario that runs are laid over, with more settings over it."""
        scenario = self.scenario_with(self.case, self.set)
        return scenario.with_overrides(settings) if settings else scenario

    def scenario_with(self, case: str | None, settings: Mapping[str, Any]) -> Scenario:
        """Return a case of the scenario with settings over it."""
        folder: Path = self.folder  # type: ignore[attr-defined]  # declared behind a file's own keys
        beside = folder / os.path.expanduser(self.scenario)
        shipped = (models_path() / self.scenario).is_dir() or not beside.exists()
        return load_scenario(self.scenario if shipped else beside, case, settings)

    @classmethod
    def shipped(cls) -> list[str]:
        """Return the names of the shipped files, as ``bai2020/clearances``."""
        root = models_path()
        return sorted(
            path.relative_to(root).as_posix().removesuffix(cls.suffix)
            for path in root.glob(f"*/*{cls.suffix}")
        )

    @classmethod
    def loaded(
        cls, place: str, path: str | os.PathLike[str], settings: Mapping[str, Any] | Sequence[str]
    ) -> Self:
        """Return a file, complete and checked; its scenario is not read yet.

        Args:
            place: Name of the caller, for messages.
            path: Of the file, or the name of a shipped one.
            settings: What takes the place of the file's keys.

        Raises:
            ScenarioError: With one line that gives file, place, rule, the value seen and a way out.
            UnknownNameError: There is no such file.
        """
        found, label = Path(os.path.expanduser(os.fspath(path))), str(path)
        if not found.is_file():
            shipped = models_path() / f"{label}{cls.suffix}"
            if not shipped.is_file():
                what = f"{cls.word} file or shipped {cls.word}"
                raise UnknownNameError(place, what, label, cls.shipped())
            found = shipped
        data = read_toml(found, label)
        for key in cls.carried & data.keys():
            raise ScenarioError(
                f"{label}: {key} is unknown: a {cls.word}'s name and folder are those of its file"
            )
        layer, _ = read_overrides(settings)
        # Keys of the scenario stand with dots in [set], and with dots they stay: as tables they are the same.
        for table in (data, layer):
            if isinstance(table.get("set"), Mapping):
                table["set"] = nested(table["set"])
        name = printable(found.name.removesuffix(cls.suffix).removesuffix(".toml"))
        try:
            return cls.validated(merge(data, layer) | {"name": name, "folder": found.parent.resolve()})
        except ValidationError as error:
            raise explained(
                error, lambda location: ValuePlace(f"{label}: {dotted(location)}".strip())
            ) from None


def nested(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table with dotted keys, as ``"integrator.engine"``, as nested tables."""
    plain: dict[str, Any] = {}
    for key, value in table.items():
        layer, _ = read_overrides({key: value})
        plain = laid_over(plain, layer)
    return plain


def laid_over(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Return one table of settings over another, without a scenario below.

    A table's ``replace = true`` stays in it: what it replaces is in the scenario too.
    """
    found = dict(below)
    for key, value in above.items():
        old = found.get(key)
        both = isinstance(old, Mapping) and isinstance(value, Mapping) and value.get("replace") is not True
        found[key] = laid_over(old, value) if both else value  # type: ignore[arg-type]
    return found
