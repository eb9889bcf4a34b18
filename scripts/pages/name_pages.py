"""Pages of every public name, a page a room, of what ``__all__``, docstrings and comments say."""

from __future__ import annotations

import ast
import dataclasses
import enum
import importlib
import inspect
import pkgutil
import re
import textwrap
import types
from typing import Any, get_origin

import antenna_pin

__all__ = ["name_pages", "public_rooms"]

# The command line has a page of its own, and what stands beside a test or a lock is nobody's business.
_LEFT_OUT = ("cli",)


def public_rooms() -> dict[str, types.ModuleType]:
    """Return the packages that offer names, by their places below ``antenna_pin``; without private ones."""
    rooms = {}
    for found in pkgutil.walk_packages(antenna_pin.__path__, "antenna_pin."):
        place = found.name.removeprefix("antenna_pin.")
        parts = place.split(".")
        if any(part.startswith("_") or part in _LEFT_OUT for part in parts) or (
            len(parts) > 1 and not found.ispkg
        ):
            continue
        room = importlib.import_module(found.name)
        if any(not inspect.ismodule(getattr(room, name)) for name in getattr(room, "__all__", ())):
            rooms[place] = room
    return rooms


def home_of(name: str, value: Any, room: str, rooms: dict[str, types.ModuleType]) -> str:
    """Return the room whose page has a name: that in which it is written, if that offers it."""
    written = str(getattr(value, "__module__", "") or "").split(".")
    if not is_described(value) or written[0] != "antenna_pin" or len(written) < 2:
        return room
    for place in (".".join(written[1:end]) for end in range(len(written), 1, -1)):
        own = rooms.get(place)
        if own is not None and getattr(own, name, None) is value and name in own.__all__:
            return place
    return room


def is_described(value: Any) -> bool:
    """Return whether a name is of a class or a function, which have a docstring of their own."""
    return (
        (inspect.isclass(value) and get_origin(value) is None)
        or callable(getattr(value, "__wrapped__", value))
        and (inspect.isroutine(inspect.unwrap(value)))
    )


def fields_of(cls: type) -> dict[str, str]:
    """Return the meanings of a class' fields by the comments beside or above them."""
    if not (dataclasses.is_dataclass(cls) or hasattr(cls, "_fields")) or "Attributes:" in str(cls.__doc__):
        return {}
    try:
        lines = textwrap.dedent(inspect.getsource(cls)).splitlines()
    except (OSError, TypeError):  # a class made by a call has no text of its own
        return {}
    (tree,) = ast.parse("\n".join(lines)).body
    found = {}
    for one in tree.body if isinstance(tree, ast.ClassDef) else ():
        if isinstance(one, ast.AnnAssign) and isinstance(one.target, ast.Name):
            said = [lines[one.end_lineno - 1][one.end_col_offset :].strip()]
            above = one.lineno - 2
            while not said[0] and lines[above].strip().startswith("# "):
                said.insert(1, lines[above].strip())
                above -= 1
            text = " ".join(part.lstrip("# ") for part in said).strip()
            if text:
                found[one.target.id] = re.sub(r"([*|])", r"\\\1", text)
    return found


def entry(room: str, name: str, value: Any) -> str:
    """Return what a page has of a name."""
    place = f"antenna_pin.{room}.{name}"
    if inspect.isclass(value) and get_origin(value) is None:
        more = "   :undoc-members:\n" if issubclass(value, enum.Enum) else ""
        fields = fields_of(value) if value.__name__ == name else {}  # of an alias its class says it
        if dataclasses.is_dataclass(value) or fields:  # its docstring says what its fields are, or this does
            names = getattr(value, "_fields", None) or [one.name for one in dataclasses.fields(value)]
            more += f"   :exclude-members: {', '.join(names)}\n"
        if fields:
            more += "\n" + "".join(f"   - **{name}**: {said}\n" for name, said in fields.items())
        return f".. autoclass:: {place}\n{more}"
    if is_described(value):
        return f".. autofunction:: {place}\n"
    kind = type(value).__name__
    return f".. py:data:: {place}\n   :type: {kind}\n"


def room_page(room: str, module: types.ModuleType, rooms: dict[str, types.ModuleType]) -> str:
    """Return the page of a room: what it is, its own names, and those of other rooms that it has too."""
    title = f"antenna_pin.{room}"
    parts = [title, "=" * len(title), "", f".. automodule:: {title}", "   :no-members:", ""]
    elsewhere = []
    for name in sorted(module.__all__, key=str.lower):
        value = getattr(module, name)
        home = home_of(name, value, room, rooms)
        if home != room:
            elsewhere.append(f"- :py:obj:`{title}.{name} <antenna_pin.{home}.{name}>`")
        else:
            parts += [entry(room, name, value), ""]
    if elsewhere:
        parts += ["Described elsewhere", "-------------------", "", *elsewhere, ""]
    return "\n".join(parts)


def name_pages() -> dict[str, str]:
    """Return the pages, reStructuredText by name, with an index that leads to them."""
    rooms = public_rooms()
    pages = {room: room_page(room, module, rooms) for room, module in rooms.items()}
    front = []
    for name in antenna_pin.__all__:
        value = getattr(antenna_pin, name)
        if not inspect.ismodule(value) and not isinstance(value, str):  # the version is a text
            room = home_of(name, value, "", rooms)
            front.append(
                f"   * - :py:obj:`antenna_pin.{name} <antenna_pin.{room}.{name}>`\n     - {first_line(value)}"
            )
    lines = [
        f"   * - :doc:`antenna_pin.{room} <{room}>`\n     - {first_line(module)}"
        for room, module in rooms.items()
    ]
    table = ".. list-table::\n   :widths: 35 65\n\n"
    pages["index"] = "\n".join(
        [
            "Python",
            "======",
            "",
            "Names that ``antenna_pin`` itself has",
            "-------------------------------------",
            "",
            table + "\n".join(front),
            "",
            "Rooms",
            "-----",
            "",
            table + "\n".join(lines),
            "",
            ".. toctree::",
            "   :hidden:",
            "",
            *(f"   {room}" for room in rooms),
            "",
        ]
    )
    return pages


def first_line(value: Any) -> str:
    """Return the first line of a docstring."""
    return (inspect.getdoc(value) or "").split("\n")[0]
