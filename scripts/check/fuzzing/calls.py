"""Calls of everything public in Python: arguments by their annotations, sound ones and odd ones."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import importlib
import inspect
import math
import pkgutil
import re
import tempfile
import typing
from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from pathlib import Path
from random import Random
from types import NoneType, UnionType
from typing import Any, Literal, get_args, get_origin

import numpy as np
from robust.inputs import Change, Draft, Input
from robust.trials import write_files

import antenna_pin
from antenna_pin import Trajectory, Urdf, build_system, load_scenario, load_study
from antenna_pin.base.parameters import parameters_of
from antenna_pin.base.units import shown as shown_value
from fuzzing.made import made
from fuzzing.odd import Raw, odd_number, odd_value

# Classes of what calls return or hand to a function.
_GIVEN = ("Exploration", "Flow", "Mechanism", "Modes", "Moment", "Progress", "Trajectory")

_IMPORT = re.compile(r"from (antenna_pin[.\w]*) import \(?([\w, ]+(?:(?<=\()[\w, \n]+)?)")

_ODD_OBJECTS: tuple[Callable[[], Any], ...] = (
    *(lambda: None, object, lambda: b"bytes", lambda: 1j, lambda: np.array([1.0, math.nan])),
    *(lambda: np.eye(3), lambda: np.array(["a"]), lambda: np.float64("nan")),
    *(lambda: np.datetime64("2020-01-01"), lambda: "a\ud800", lambda: "a\0b", lambda: {1: 2}),
    *(lambda: {"a": object()}, lambda: (k for k in range(3)), lambda: range(3), lambda: set("ab")),
    *(lambda: int, lambda: lambda *_: None, lambda: lambda: math.nan, lambda: Path("no/such")),
    *(lambda: [None], lambda: np.zeros((2, 0)), lambda: [np.zeros(3), np.zeros(2)]),
)


@functools.cache
def public() -> dict[str, Any]:
    """Return what people call: what the documents import, and every class that declares parameters."""
    found: dict[str, Any] = {}
    root = Path(__file__).parents[3]
    names = {f"antenna_pin.{name}" for name in antenna_pin.__all__}
    for page in (root / "README.md", *(root / "docs").glob("*.md")):
        for room, several in _IMPORT.findall(page.read_text()):
            names |= {f"{room}.{name}" for name in re.findall(r"\w+", several)}
    for name in sorted(names - {"antenna_pin.apps.live.explore"}):  # which goes on
        room, _, one = name.rpartition(".")
        found[name] = getattr(importlib.import_module(room), one)
    for info in pkgutil.walk_packages(antenna_pin.__path__, "antenna_pin."):
        room = (
            importlib.import_module(info.name) if info.ispkg and info.name != "antenna_pin.apps.cli" else None
        )
        for name in getattr(room, "__all__", ()):
            one = getattr(room, name)
            if dataclasses.is_dataclass(one) and isinstance(one, type) and parameters_of(one):
                found[f"{info.name}.{name}"] = one
    return {name: one for name, one in found.items() if callable(one) and not _is_given(one)}


def _is_given(one: Any) -> bool:
    """Whether it is nothing that people call, but what they get: an error, an outcome, what calls return."""
    if not isinstance(one, type):
        return get_origin(one) is not None
    given = one.__name__ in _GIVEN or getattr(one, "_is_protocol", False)
    return given or issubclass(one, (BaseException, Enum))


@functools.cache
def _parameters(name: str) -> dict[str, tuple[Any, bool]]:
    """Return the annotations of what a call takes, and whether it must be given."""
    one = public()[name]
    try:
        signature = inspect.signature(one)
    except (TypeError, ValueError):
        return {}
    hints: dict[str, Any] = {}
    with contextlib.suppress(Exception):  # of names that are imported for type checkers only
        hints = typing.get_type_hints(one.__init__ if isinstance(one, type) else one)
    return {
        key: (hints.get(key, Any), each.default is inspect.Parameter.empty)
        for key, each in signature.parameters.items()
        if each.kind in (each.POSITIONAL_OR_KEYWORD, each.KEYWORD_ONLY)
    }


# --- sound arguments ---------------------------------------------------------------------------------------


@functools.cache
def _objects() -> Mapping[str, Any]:
    """Return some objects of the package, by the names of their classes."""
    with tempfile.TemporaryDirectory() as name:
        write_files(Path(name), made())
        scenario = load_scenario(Path(name) / "play.toml")
        system = build_system(scenario)
        run = Trajectory.load(Path(name) / "run.nc")
        run.data.load()
        found = [scenario, system, run, run.end, run.data, load_study(Path(name) / "few.study.toml")]
        found += [Urdf.load(Path(name) / "pair.urdf"), system.mechanism]
        found += [joint for joint in system.joints][:1] if hasattr(system, "joints") else []
    return {type(one).__name__: one for one in found}


_SOUND: Mapping[Any, Sequence[Any]] = {
    float: (0.5, 1.0, 0.01, 2),
    int: (1, 2, 3),
    str: ("bore", "disc", "ring", "play.toml", "hertz", "1 mm", "run.nc", "motion_angle"),
    **dict.fromkeys((Any, object), (1.0, "bore", [1.0, 2.0])),
}


def _sound(chance: Random, hint: Any, depth: int = 0) -> Any:
    """Return a value that an annotation allows; raises LookupError where none is known."""
    origin, parts = get_origin(hint), get_args(hint)
    if origin is typing.Annotated:
        return _sound(chance, parts[0], depth)
    if origin is Literal:
        return chance.choice(parts)
    if origin in (typing.Union, UnionType):
        kinds = [part for part in parts if part is not NoneType]
        return _sound(chance, chance.choice(kinds), depth)
    if hint is bool:
        return chance.random() < 0.5
    for kind, values in _SOUND.items():
        if hint is kind:
            return chance.choice(values)
    if hint is Path or "PathLike" in str(hint):
        return Path(chance.choice(("run.nc", "play.toml", "pair.urdf", "out.nc", "out.html")))
    if "NDArray" in str(hint) or hint is np.ndarray or "ArrayLike" in str(hint):
        return np.array(chance.choice(([1.0, 0.0, 0.0], [0.1, 0.2], [0.0] * 6, [1.0])))
    if origin in (tuple, list, Sequence) or (
        isinstance(origin, type) and issubclass(origin, typing.Iterable)
    ):
        if issubclass(origin, Mapping):
            return {"bore": _sound(chance, parts[-1], depth + 1)}
        inside = [part for part in parts if part is not Ellipsis]
        fixed = origin is tuple and Ellipsis not in parts
        return tuple(_sound(chance, part, depth + 1) for part in (inside if fixed else inside[:1] * 2))
    if origin is Callable or "Callable" in str(hint):
        return lambda *_: 1.0
    name = getattr(hint, "__name__", str(hint))
    if name in _objects():
        return _objects()[name]
    for key, one in public().items():
        if one is hint and depth < 3:
            return one(**_needed(chance, key, depth + 1))
    raise LookupError(f"nothing is known of {hint}")


def _needed(chance: Random, name: str, depth: int = 0) -> dict[str, Any]:
    """Return sound values for what a call must be given."""
    parameters = _parameters(name).items()
    return {key: _sound(chance, hint, depth) for key, (hint, needed) in parameters if needed}


def _odd(chance: Random) -> Callable[[], Any]:
    roll = chance.random()
    if roll < 0.5:
        return chance.choice(_ODD_OBJECTS)
    value = odd_number(chance) if roll < 0.75 else odd_value(chance)
    return lambda: value.text if isinstance(value, Raw) else value


# --- calls -------------------------------------------------------------------------------------------------


def draw_call(chance: Random) -> Draft:
    """Return a call of something public, an argument of it odd."""
    name = chance.choice(sorted(public()))
    parameters = _parameters(name)
    seed = chance.randrange(2**32)
    count = chance.choice((1, 1, 2)) if parameters else 0
    changes = tuple(_change(chance, name, sorted(parameters)) for _ in range(count))

    def written(kept: Sequence[Change]) -> Input:
        def act() -> Any:
            try:
                arguments = _needed(Random(seed), name)
            except (LookupError, antenna_pin.AntennaPinError, TypeError):
                # Nothing sound is known of some: all that is known is odd.
                arguments = dict.fromkeys((key for key, (_, needed) in parameters.items() if needed), 1.0)
            for change in kept:
                change.apply(arguments)
            return public()[name](**arguments)

        return Input(made(), act)

    return Draft(changes, written)


def _change(chance: Random, name: str, keys: Sequence[str]) -> Change:
    key, value = chance.choice(keys), _odd(chance)
    shown = ascii(shown_value(value()))[:60]
    return Change(f"{name}({key}={shown})", lambda arguments: arguments.__setitem__(key, value()))
