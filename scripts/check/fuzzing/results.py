"""What commands write and read again: results, stores of studies, states and checkpoints."""

from __future__ import annotations

import functools
import io
import json
import re
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from random import Random
from typing import Any

import h5py
import numpy as np
from robust.inputs import Change, Draft, Input, after, several
from robust.trials import Content, write_files

from antenna_pin import load_scenario, simulate
from antenna_pin.base.files import seal
from antenna_pin.base.state import State
from antenna_pin.base.units import shown
from antenna_pin.run.session import start
from antenna_pin.run.simulation.sample_files import read_sealed, write_sealed
from fuzzing.documents import SHORT
from fuzzing.made import MADE, SEAL, each, made, stopped, words
from fuzzing.odd import Raw, as_float, misspelt, odd_number, odd_value, text_change

# What is asked of a file, whatever it is.
_ASKED = (
    *each("info FILE|info FILE --json|analyse FILE|impacts FILE --csv a.csv"),
    *each("pointing FILE --body disc --boresight 1,0,0 --direction 0,1,0"),
    *each("phase FILE -x q[bore.x] -y v[bore.vx] --out p.nc|phase FILE --list"),
    *each("plot FILE --out figures --figure energy|record FILE --out a.html"),
    *each("report FILE --out r.html --no-figures --no-recordings|modes FILE|modes play.toml --at FILE"),
    *each("run --resume FILE --no-progress"),
    ("run", "play.toml", "--out", "FILE", "--no-progress", *SHORT),
)
# Of some what they are read for, too.
_ALSO: Mapping[str, tuple[str, ...]] = {
    "orbit.nc": words("orbit FILE --out o.nc --rtol 1e-9 --no-progress"),
    "branch.nc": words("orbit FILE --at 1 --rtol 1e-9 --no-progress"),
    "diagram.nc": (*MADE["diagram.nc"], "--out", "FILE"),
}


# --- one file ----------------------------------------------------------------------------------------------


def draw_result(chance: Random) -> Draft:
    """Return a file that commands write, edited or damaged, and what is asked of it."""
    name = chance.choice([*MADE, "run.nc", "run.nc"])
    files = {key: content for key, content in made().items() if not key.startswith("few")}
    asked = chance.choice((*_ASKED, _ALSO.get(name, _ASKED[0])))
    damaged = chance.random() < 0.2
    sealed = chance.random() < 0.3
    inside = _inside(name)

    def edit() -> Change:
        variable = chance.random() >= 0.5
        return (_attribute_edit, _variable_edit)[variable](chance, chance.choice(inside[variable]))

    changes = several(chance, edit, 1, 1, 2)
    if damaged:
        found = text_change(chance)
        changes = (Change(found.name, found.apply, wrong=asked[0] in ("info", "analyse")),)

    def written(kept: Sequence[Change]) -> Input:
        if damaged:
            content = after(kept, files[name])
            write: Content = content if content != files[name] else b"nothing"  # for what changes nothing
        else:
            write = functools.partial(write_edited, files[name], [change.apply for change in kept], sealed)
        return Input({**files, name: write}, [name if word == "FILE" else word for word in asked])

    return Draft(changes, written)


def write_edited(content: bytes, edits: Sequence[Callable[[Any], Any]], sealed: bool, path: Path) -> None:
    """Write a result after some edits of its HDF5 file, with a seal of its own or without a trace of any."""
    path.write_bytes(content[:-SEAL])
    with h5py.File(path, "r+") as file:
        if not sealed:
            file.attrs.pop("_NCProperties", None)
        for edit in edits:
            edit(file)
    if sealed:
        seal(path)


@functools.cache
def _inside(name: str) -> tuple[list[str], list[str]]:
    with h5py.File(io.BytesIO(made()[name]), "r") as file:
        return sorted(file.attrs), sorted(file)


_PLAIN = (0, -1.0, float("nan"), "x", "", "[", "{}", "[]", "[" * 50_000, [1.0, 2.0], ["a", "b"])


def _attribute_edit(chance: Random, key: str) -> Change:
    roll, at = chance.random(), chance.random()
    value = odd_value(chance)
    if roll < 0.15:
        return Change(f"no attribute {key}", lambda file: file.attrs.pop(key, None))
    if roll < 0.4:
        plain = chance.choice(_PLAIN)
        name = f"attribute {key} = {str(plain)[:40]!r}"
        return Change(name, lambda file: file.attrs.__setitem__(key, plain))
    other = chance.choice((None, None, "gone", misspelt(chance, "name")))

    def edit(file: Any) -> None:
        try:
            file.attrs[key] = spoiled(file.attrs[key], at, value, other)
        except (KeyError, TypeError, ValueError, RecursionError):
            file.attrs[key] = "x"

    return Change(f"attribute {key} at {at:.3f}: {other or shown(value)[:60]!r}", edit)


def spoiled(text: str | bytes, at: float, value: Any, other: str | None = None) -> str:
    """Return JSON with the entry at some part of it replaced, lost or called otherwise."""
    return json.dumps(_replaced(json.loads(text), at, value, other), default=str)


def _replaced(content: Any, at: float, value: Any, other: str | None) -> Any:
    if isinstance(value, Raw):
        value = [[[[value.text]]]]
    if isinstance(value, int) and value.bit_length() > 4096:  # which Python does not print
        value = 10**400
    places: list[tuple[Any, Any]] = []

    def walk(node: Any) -> None:
        for key, entry in node.items() if isinstance(node, dict) else enumerate(node):
            places.append((node, key))
            if isinstance(entry, dict | list):
                walk(entry)

    if isinstance(content, dict | list):
        walk(content)
    if not places:
        return value
    node, key = places[int(at * len(places))]
    if other is None:
        node[key] = value
    elif other == "gone" or isinstance(node, list):
        del node[key]
    else:
        node[other] = node.pop(key)
    return content


def _variable_edit(chance: Random, name: str) -> Change:
    value, at = chance.choice((float("nan"), float("inf"), -1.0, 1e300, 1e9, 0.5)), chance.random()
    changes: dict[str, Callable[[Any], Any] | None] = {
        "gone": None,
        "a group": lambda of: None,
        "backwards": lambda of: of[::-1],
        "one less": lambda of: of[:-1],
        "none": lambda of: of[:0],
        "one more": lambda of: np.concatenate([of, of[-1:]]),
        "an axis more": lambda of: of[..., None],
        "a number": lambda of: of.flat[0] if of.size else 0.0,
        "text": lambda of: np.full(of.shape, b"x"),
        "complex": lambda of: of.astype(complex),
        "whole": lambda of: np.clip(np.nan_to_num(of), -1e9, 1e9).astype("i4"),
        "big-endian": lambda of: of.astype(">f8"),
        f"with {value:g} at {at:.2f}": lambda of: with_value(of, int(at * np.size(of)), value),
        f"all {value:g}": lambda of: np.full(of.shape, value),
        "of another unit": lambda of: of,
    }
    what = chance.choice([*changes, *[key for key in changes if key.startswith("with")] * 4])
    change = changes[what]

    def edit(file: Any) -> None:
        if name not in file:
            return
        if what == "of another unit":
            file[name].attrs["units"] = "mm"
            return
        old = file[name][()] if isinstance(file[name], h5py.Dataset) else np.zeros(1)
        try:
            values = None if change is None else change(np.asarray(old))
        except (TypeError, ValueError, IndexError):
            return  # there is nothing to be changed so
        if values is None:
            del file[name]
            if change is not None:
                file.create_group(name)
        else:
            text = {"dtype": h5py.string_dtype()} if np.asarray(values).dtype == object else {}
            put_variable(file, name, values, **text)

    return Change(f"variable {name} {what}", edit)


def put_variable(file: Any, name: str, values: Any, **more: Any) -> None:
    """Put other values into a variable of a file, which keeps its dimensions and attributes."""
    kept = {key: value for key, value in file[name].attrs.items() if key not in _SCALES}
    scale = isinstance(file[name], h5py.Dataset) and file[name].is_scale
    del file[name]
    new = file.create_dataset(name, data=values, **more)
    if scale:
        new.make_scale(name)
    for key, entry in kept.items():
        new.attrs[key] = entry


_SCALES = ("CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST")


def with_value(of: Any, at: int, value: float) -> Any:
    """Return an array of floats with one of its values, by its place in the flat array, another."""
    values = np.array(of, dtype=float)
    values.flat[at] = value
    return values


# --- stores of studies -------------------------------------------------------------------------------------


def draw_store(chance: Random) -> Draft:
    """Return the store of a study, a file of it damaged, and what is asked of it."""
    files = {key: one for key, one in made().items() if not key.endswith(".nc") or key.startswith("few")}
    name = chance.choice(sorted(key for key in files if key.startswith("few.study/")))
    asked = chance.choice(
        each("study show few.study --json|study show few.study --failed|study plot few.study --list")
        + each("study report few.study --out r.html --no-figures|sweep few.study --workers 0 --no-progress")
        + each("sweep few.study.toml --out few.study --workers 0 --no-progress")
    )
    changes = several(chance, lambda: _store_change(chance, name), 1, 1, 2)

    def written(kept: Sequence[Change]) -> Input:
        content = after(kept, files[name])
        rest = {key: one for key, one in files.items() if key != name}
        return Input(rest if content is None else {**rest, name: content}, asked)

    return Draft(changes, written)


def _store_change(chance: Random, name: str) -> Change:
    roll, at, value = chance.random(), chance.random(), odd_value(chance)
    if roll < 0.1:
        return Change(f"no {name}", lambda content: None)
    if roll < 0.5 or not name.endswith("json"):
        found = text_change(chance)
        return Change(f"{name}: {found.name}", found.apply)

    def edit(content: bytes) -> bytes:
        try:
            return spoiled(content, at, value).encode()
        except (ValueError, RecursionError):
            return content[:-1]

    return Change(f"{name} at {at:.3f}: {shown(value)[:60]!r}", edit)


# --- states and checkpoints --------------------------------------------------------------------------------

KEYS = ("springs.held.stiffness", "springs.held.damping", "drives.push.amplitude", "drives.push.frequency")
SENSITIVITY = words("sensitivity swing.toml --set integrator.max_steps=200 --duration '1 ms'")


def draw_state(chance: Random) -> Draft:
    """Return a state with something changed, to go on from by a command or in Python."""
    at, value, other = chance.random(), odd_value(chance), chance.choice((None, None, None, "gone", "x"))
    name = f"at {at:.3f}: {other or shown(value)[:60]}"
    change = Change(name, lambda text: spoiled(text, at, value, other).encode())
    if chance.random() < 0.2:
        change = text_change(chance)
    python = chance.random() < 0.5

    def written(kept: Sequence[Change]) -> Input:
        def act() -> None:
            text = Path("state.json").read_bytes().decode("utf-8", "surrogateescape")
            scenario = load_scenario("swing.toml", overrides=SHORT[1:])
            simulate(scenario, duration=1e-3, start=State.from_json(text))

        command = (*SENSITIVITY, KEYS[0], "--method", "equation", "--start", "state.json")
        return Input({**made(), "state.json": after(kept, _state())}, act if python else command)

    return Draft((change,), written)


@functools.cache
def _state() -> bytes:
    """Return a state after a millisecond, as text."""
    with tempfile.TemporaryDirectory() as name:
        write_files(Path(name), {file: made()[file] for file in ("swing.toml", "pair.urdf")})
        session = start(load_scenario(Path(name) / "swing.toml"))
        session.step(1e-3)
        return session.state.to_json().encode()


def draw_checkpoint(chance: Random) -> Draft:
    """Return a run that was stopped, its checkpoint changed and sealed again or damaged, and gone on with."""
    name = chance.choice(("checkpoint", "checkpoint", "checkpoint", "000000.part"))
    files = stopped()
    name = name if f"stopped.nc.parts/{name}" in files else "checkpoint"
    path = f"stopped.nc.parts/{name}"
    damaged = chance.random() < 0.2
    draw = text_change if damaged else functools.partial(_array_change, told=name == "checkpoint")
    changes = several(chance, lambda: draw(chance), 1, 1, 2)

    def written(kept: Sequence[Change]) -> Input:
        def write(target: Path) -> None:
            target.write_bytes(files[path])
            numbers = read_sealed(target, re.compile(".*"))
            for change in kept:
                change.apply(numbers)
            write_sealed(target, numbers)

        content = after(kept, files[path]) if damaged else write
        return Input({**made(), **files, path: content}, ["run", "--resume", "stopped.nc", "--no-progress"])

    return Draft(changes, written)


def _array_change(chance: Random, told: bool) -> Change:
    roll, at, value, name_at = chance.random(), chance.random(), odd_value(chance), chance.random()
    if told and roll < 0.5:
        other = chance.choice((None, None, None, "gone", "x"))

        def edit(numbers: dict[str, Any]) -> None:
            numbers["about"] = np.array(spoiled(str(numbers["about"]), at, value, other))

        return Change(f"about at {at:.3f}: {other or shown(value)[:60]}", edit)
    number = as_float(odd_number(chance))
    edits: dict[str, Callable[[Any], Any]] = {
        "gone": lambda of: None,
        "one more": lambda of: np.concatenate([of.reshape(-1), of.reshape(-1)[:1]]),
        "one less": lambda of: of[:-1] if of.ndim else of,
        "an axis more": lambda of: of[..., None],
        f"all {number:g}": lambda of: np.full(of.shape, number) if of.dtype.kind == "f" else of,
        "large": lambda of: np.full(of.shape, 2**40).astype(of.dtype) if of.dtype.kind in "iu" else of,
        "below zero": lambda of: np.full(of.shape, -1).astype(of.dtype) if of.dtype.kind in "iu" else of,
        "text": lambda of: np.array("x"),
        "none": lambda of: of[:0] if of.ndim else of,
    }
    what = chance.choice([*edits])

    def change(numbers: dict[str, Any]) -> None:
        key = sorted(set(numbers) - {"about"})[int(name_at * (len(numbers) - 1))]
        if (array := edits[what](numbers.pop(key))) is not None:
            numbers[key] = array

    if roll > 0.95:
        return Change("an array more", lambda numbers: numbers.__setitem__("more", np.zeros(3)))
    return Change(f"array at {name_at:.3f} {what}", change)
