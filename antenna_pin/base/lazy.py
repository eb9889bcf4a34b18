"""Names and classes that are loaded at first use, for fast commands."""

from __future__ import annotations

import importlib
import sys
import types
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any


class _Package(types.ModuleType):
    """Package that finds its names by its stub file."""

    homes_of_names: dict[str, str]

    def __getattr__(self, name: str) -> Any:
        try:
            home = self.homes_of_names[name]
        except KeyError:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}") from None
        if home == self.__name__:
            return importlib.import_module(f"{home}.{name}")
        value = getattr(importlib.import_module(home), name)
        setattr(self, name, value)
        return value

    def __setattr__(self, name: str, value: Any) -> None:
        # Python makes a file that was loaded an attribute of its package. A name that the file holds and
        # that is called like it goes before, or what the package gives depended on who loaded what first.
        if isinstance(value, types.ModuleType) and self.homes_of_names.get(name) == value.__name__:
            value = getattr(value, name)
        super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted(self.__dict__["__all__"])


def exported(package: str) -> None:
    """Make the names of a package available without loading the files that hold them.

    The stub beside its file, ``__init__.pyi``, is the one place that lists them, a line each, which type
    checkers read too: ``from antenna_pin.room.file import Name as Name``. ``dir``, and with it completion,
    lists these only.
    """
    module = sys.modules[package]
    assert module.__file__ is not None
    stub = Path(module.__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    lines = [line.split() for line in stub.splitlines() if line.startswith("from ")]
    homes = {name: home for _, home, _, _, _, name in lines}
    module.__dict__.update(homes_of_names=homes, __all__=list(homes))
    module.__class__ = _Package


class Classes(Mapping[str, type[Any]]):
    """Classes by what they are called elsewhere, each loaded when it is first asked for."""

    def __init__(self, package: str, homes: Mapping[str, str]) -> None:
        """Store a package, and each class's file and name: ``"sine.SineDrive"``."""
        self.places = {called: f"{package}.{home}" for called, home in homes.items()}
        """Full names of the classes, by what they are called."""

    def __getitem__(self, called: str) -> type[Any]:
        file, _, name = self.places[called].rpartition(".")
        found: type[Any] = getattr(importlib.import_module(file), name)
        return found

    def __contains__(self, called: object) -> bool:
        return isinstance(called, str) and called in self.places

    def __iter__(self) -> Iterator[str]:
        return iter(self.places)

    def __len__(self) -> int:
        return len(self.places)


def go_without(*packages: str) -> None:
    """Make unloaded packages seem missing, until :func:`take_back`."""
    for package in packages:
        sys.modules.setdefault(package, None)  # type: ignore[arg-type]


def take_back(package: str) -> None:
    """Let a package be loaded by whoever imports it from here on."""
    if sys.modules.get(package, sys) is None:
        del sys.modules[package]
