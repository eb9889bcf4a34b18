"""What a run goes on from, states and checkpoints, as files and in Python; what sensitivities are asked."""

from __future__ import annotations

import functools
import json
import re
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
from robust.inputs import Change, Draft, Input, after, draft_of_words, more_words
from robust.trials import write_files

from antenna_pin import load_scenario, simulate, start
from antenna_pin.base.state import State
from antenna_pin.base.units import shown
from antenna_pin.simulation.parts import read_sealed, write_sealed
from fuzzing.documents import SHORT
from fuzzing.made import made, stopped
from fuzzing.odd import ODD_TEXTS, as_float, odd_number, odd_value
from fuzzing.results import replaced
from fuzzing.texts import text_change

_ANY = re.compile(".*")
_KEYS = ("springs.held.stiffness", "springs.held.damping", "drives.push.amplitude", "drives.push.frequency")
_SENSITIVITY = ("sensitivity", "swing.toml", "--set", "integrator.max_steps=200", "--duration", "1 ms")


def draw_state(chance: Random) -> Draft:
    """Return a state with something changed, to go on from by a command or in Python."""
    at, value, other = chance.random(), odd_value(chance), chance.choice((None, None, None, "gone", "x"))
    change = Change(
        f"at {at:.3f}: {other or shown(value)[:60]}",
        lambda text: json.dumps(replaced(json.loads(text), at, value, other), default=str).encode(),
    )
    if chance.random() < 0.2:
        change = text_change(chance)
    python = chance.random() < 0.5

    def written(kept: Sequence[Change]) -> Input:
        def act() -> None:
            text = Path("state.json").read_bytes().decode("utf-8", "surrogateescape")
            scenario = load_scenario("swing.toml", overrides=SHORT[1:])
            simulate(scenario, duration=1e-3, start=State.from_json(text))

        words = [*_SENSITIVITY, _KEYS[0], "--method", "equation", "--start", "state.json"]
        return Input({**made(), "state.json": after(kept, _state())}, act if python else words)

    return Draft((change,), written)


@functools.cache
def _state() -> bytes:
    """Return a state after a millisecond, as text."""
    with tempfile.TemporaryDirectory() as name:
        write_files(Path(name), {file: made()[file] for file in ("swing.toml", "pair.urdf")})
        session = start(load_scenario(Path(name) / "swing.toml"))
        session.step(1e-3)
        return session.state.to_json().encode()


# --- checkpoints -------------------------------------------------------------------------------------------


def draw_checkpoint(chance: Random) -> Draft:
    """Return a run that was stopped, its checkpoint changed and sealed again or damaged, and gone on with."""
    name = chance.choice(("checkpoint", "checkpoint", "checkpoint", "000000.part"))
    files = stopped()
    if f"stopped.nc.parts/{name}" not in files:
        name = "checkpoint"
    path = f"stopped.nc.parts/{name}"
    damaged = chance.random() < 0.2
    changes = tuple(
        text_change(chance) if damaged else _array_change(chance, name == "checkpoint")
        for _ in range(chance.choice((1, 1, 2)))
    )

    def written(kept: Sequence[Change]) -> Input:
        def write(target: Path) -> None:
            target.write_bytes(files[path])
            numbers = read_sealed(target, _ANY)
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
            about = replaced(json.loads(str(numbers["about"])), at, value, other)
            numbers["about"] = np.array(json.dumps(about, default=str))

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
        name = sorted(set(numbers) - {"about"})[int(name_at * (len(numbers) - 1))]
        found = edits[what](numbers.pop(name))
        if found is not None:
            numbers[name] = found

    if roll > 0.95:
        return Change("an array more", lambda numbers: numbers.__setitem__("more", np.zeros(3)))
    return Change(f"array at {name_at:.3f} {what}", change)


# --- sensitivities -----------------------------------------------------------------------------------------


def draw_sensitivity(chance: Random) -> Draft:
    """Return what may be asked of sensitivities: keys, scales, methods, pieces."""
    changes = []
    for _ in range(chance.choice((1, 1, 2))):
        odd = chance.random() < 0.6
        scale = shown(odd_number(chance)) if odd else "1"
        words = chance.choice(
            (
                [chance.choice(ODD_TEXTS) if odd else chance.choice(_KEYS)],
                [f"{chance.choice(_KEYS)}={scale}"],
                ["--method", chance.choice(ODD_TEXTS) if odd else chance.choice(("quick-runs", "runs"))],
                ["--pieces", chance.choice((*ODD_TEXTS, scale)) if odd else "0.2 ms"],
                ["--duration", chance.choice((*ODD_TEXTS, scale)) if odd else "0.5 ms"],
                ["--most", scale],
                ["--start", chance.choice((*ODD_TEXTS, "play.toml", "run.nc"))],
                ["--out", chance.choice(("a.nc", "a", "swing.toml", "no/a.nc"))],
                ["--plot", chance.choice(("a.png", "a.xyz", "run.nc"))],
                ["--csv", chance.choice(("a.csv", "run.nc"))],
            )
        )
        changes.append(more_words(*words))
    return draft_of_words(changes, (*_SENSITIVITY, _KEYS[1], "--method", "equation"), made)
