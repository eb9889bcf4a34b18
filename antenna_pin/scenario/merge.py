"""Overlay of tables, and values set over a file: ``integrator.rtol=1e-9``."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any

from antenna_pin.base.files import is_unicode
from antenna_pin.base.units import shown
from antenna_pin.errors import ScenarioError
from antenna_pin.scenario.toml_text import NotTomlError, quoted, read_toml_text, unbounded

Overrides = Mapping[str, Any] | Sequence[str]

# Keys of which a table has one or the other: giving one removes the other from below. "*" is any name.
_ALTERNATIVES: dict[tuple[str, ...], tuple[tuple[frozenset[str], frozenset[str]], ...]] = {
    ("integrator",): ((frozenset({"accuracy"}), frozenset({"method", "rtol"})),),
    ("drives", "*"): ((frozenset({"file"}), frozenset({"time", "torque", "reference"})),),
    ("flexible", "*"): (
        (frozenset({"file", "places", "reading"}), frozenset({"frequency", "participation"})),
        (frozenset({"frequency"}), frozenset({"stiffness"})),
    ),
    ("flexible", "*", "modes", "*"): (
        (frozenset({"frequency"}), frozenset({"stiffness"})),
        (frozenset({"mass"}), frozenset({"inertia"})),
    ),
    ("pointing", "*"): (
        (frozenset({"altitude"}), frozenset({"period", "rate"})),
        (frozenset({"period"}), frozenset({"rate"})),
    ),
}

_PLAIN = re.compile(r"[A-Za-z0-9_-]+")  # key of TOML without quotes

# What a word stands for where a table may stand.
_SHORT: dict[tuple[str, ...], dict[bool, dict[str, Any]]] = {
    # A rigid stop without rebound is the one that needs no number of anybody's: no stiffness, no restitution.
    ("stops",): {
        True: {"*": {"kind": "rigid", "restitution": 0.0, "replace": True}},
        False: {"replace": True},
    },
}


def _written_out(path: tuple[str, ...], value: Any) -> Any:
    """Return the table that ``true`` or ``false`` stands for at a place."""
    return _SHORT[path][value] if isinstance(value, bool) and path in _SHORT else value


def merge(base: Mapping[str, Any], over: Mapping[str, Any], path: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return one table laid over another.

    Tables are merged key by key; numbers, text and arrays are replaced. A table with ``replace = true``
    replaces the one below instead. A key that excludes another, as ``journal_radius`` does
    ``radial_clearance``, removes the other.
    """
    merged = dict(base)
    for one, other in _alternatives(path, over.get("model", base.get("model"))):
        for given, excluded in ((one, other), (other, one)):
            if given & over.keys():
                for key in excluded:
                    merged.pop(key, None)
    for key, written in over.items():
        value = _written_out((*path, key), written)
        if isinstance(value, Mapping):
            below = merged.get(key)
            fresh = value.get("replace")
            if isinstance(fresh, bool):
                value = {name: entry for name, entry in value.items() if name != "replace"}
            if fresh is True or not isinstance(below, Mapping):
                below = {}
            merged[key] = merge(below, value, (*path, key))
        else:
            merged[key] = value
    return merged


def _alternatives(path: tuple[str, ...], model: object) -> Iterator[tuple[frozenset[str], frozenset[str]]]:
    for pattern, pairs in _ALTERNATIVES.items():
        if len(pattern) == len(path) and all(
            key in ("*", seen) for key, seen in zip(pattern, path, strict=True)
        ):
            yield from pairs
    if len(path) == 2 and path[0] == "clearance":
        from antenna_pin.scenario._dimensions import alternatives  # which loads the shapes

        yield from alternatives(model if isinstance(model, str) else "")


def read_overrides(overrides: Overrides) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return overrides as one table, and as text for repetition.

    Args:
        overrides: Dotted keys and values: ``{"integrator.rtol": 1e-9}``, or text as on a command line:
            ``["integrator.rtol=1e-9", "clearance.hinge.radial_clearance=0.1 mm"]``, where what is no TOML
            value is taken as text.
    """
    tree: dict[str, Any] = {}
    record = []
    for key, value in _entries(overrides):
        _put(tree, key_parts(key), value, key)
        record.append(f"{key}={toml_value(value)}")
        if not is_unicode(record[-1]):
            rule = "must be UTF-8, as a scenario file is; files of other names are found from its folder"
            raise ScenarioError(f"override {record[-1]}: {rule}")
    return tree, tuple(record)


def toml_value(value: object) -> str:
    """Return a value as TOML text on one line."""
    if isinstance(value, Mapping):
        pairs = (f"{quoted(name)} = {toml_value(v)}" for name, v in value.items())
        return "{" + ", ".join(pairs) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(toml_value(entry) for entry in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return quoted(value) if isinstance(value, str) else repr(value)


def _entries(overrides: Overrides) -> Iterator[tuple[str, Any]]:
    if isinstance(overrides, Mapping):
        for key, value in overrides.items():
            problem = unbounded(value)
            if problem:
                raise ScenarioError(f"override {key}: {problem}")
            yield key, _plain(value, key)
        return
    for text in (overrides,) if isinstance(overrides, str) else overrides:
        key, equals, value = text.partition("=")
        if not equals:
            raise ScenarioError(f"override {text!r} must be KEY=VALUE, as in integrator.rtol=1e-9")
        yield key.strip(), _value(value.strip())


def _value(text: str) -> Any:
    try:
        table = read_toml_text(f"value = {text}")
    except NotTomlError:
        return text
    value = table["value"]
    plain = len(table) == 1 and isinstance(value, str | int | float | list | dict)  # dates are text here
    return value if plain else text


def key_of(parts: Sequence[str]) -> str:
    """Return the key with dots of some parts, in quotes where they need them."""
    return ".".join(part if _PLAIN.fullmatch(part) else quoted(part) for part in parts)


def key_parts(dotted: str) -> list[str]:
    """Return the parts of a dotted key; parts with other characters are quoted.

    Raises:
        ScenarioError: The text is no such key.
    """
    try:
        table = read_toml_text(f"{dotted} = 0") if "\n" not in dotted else {}
    except NotTomlError:
        table = {}
    if len(table) != 1:
        rule = (
            "must be keys joined by dots, as in integrator.rtol; a key with other characters stands in quotes"
        )
        raise ScenarioError(f"override {dotted!r}: its key {rule}")
    keys: list[str] = []
    below: Any = table
    while isinstance(below, dict):
        ((key, below),) = below.items()
        keys.append(key)
    return keys


def _put(tree: dict[str, Any], keys: Sequence[str], value: Any, dotted: str) -> None:
    for i, key in enumerate(keys[:-1], start=1):
        below = tree.setdefault(key, {})
        if not isinstance(below, dict):
            outer = ".".join(keys[:i])
            raise ScenarioError(f"override {dotted}: {outer} is set to {shown(below)}, which has no keys")
        tree = below
    old = tree.get(keys[-1])
    tree[keys[-1]] = merge(old, value) if isinstance(old, dict) and isinstance(value, dict) else value


def _plain(value: Any, place: str) -> Any:
    """Return a value from Python as TOML would have it."""
    if isinstance(value, Mapping):
        return {str(key): _plain(entry, place) for key, entry in value.items()}
    if hasattr(value, "tolist"):  # of NumPy
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(entry, place) for entry in value]
    if isinstance(value, PurePath):
        return str(value)
    if not isinstance(value, str | bool | int | float):
        raise ScenarioError(
            f"override {place} must be a number, text, an array or a table, got {shown(value)}"
        )
    return value
