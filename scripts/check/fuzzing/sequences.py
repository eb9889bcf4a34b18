"""Objects that are called again and again: sessions, what a page explores, units for co-simulation."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
from robust.inputs import Change, Draft, Input, draft_of_words, more_words

from antenna_pin import AntennaPinError, load_scenario
from antenna_pin.apps.fmu.packed import Packed
from antenna_pin.apps.live.explored import Explored
from antenna_pin.base.state import State
from antenna_pin.base.units import shown
from antenna_pin.run.session import start
from fuzzing.made import made
from fuzzing.odd import ODD_TEXTS, Raw, as_float, odd_number, odd_value
from fuzzing.results import spoiled

Call = Callable[[Any], Any]
Calls = dict[str, Call]

_SCENARIOS = ("play.toml", "swing.toml")
_loaded = functools.partial(
    load_scenario, overrides=("integrator.max_steps=200", "integrator.engine=compiled")
)
_PLACES = tuple(
    "drives.push.amplitude springs.held.stiffness drives.push springs.held drives.push.frequency".split()
)
_READ = tuple("bore.angle bore.rate motion_angle[bore] time energy drives.push.torque peak_force".split())


def _value(chance: Random) -> Any:
    """Return a number or anything else, sound and odd."""
    roll = chance.random()
    if roll < 0.4:
        return chance.choice((1e-4, 2e-4, "0.1 ms", 1e-3, 0.5, 1.0, True))
    value = odd_number(chance) if roll < 0.7 else odd_value(chance)
    return value.text if isinstance(value, Raw) else value


def _name(chance: Random, sound: Sequence[str]) -> Any:
    return chance.choice(sound if chance.random() < 0.7 else (*ODD_TEXTS, None, 3, ("a",)))


_NUMBERS = ([], [math.nan], [1.0], [0.1] * 7, "x", None, [[1.0]], np.zeros(3), [1e300], {"a": 1})


def _drawn(
    chance: Random, made_of: Callable[[], Any], draw: Callable[[Random], Calls], often: str = ""
) -> Draft:
    """Return some calls of an object, more of those with a word in their names; refusals end none."""

    def one_change() -> Change:
        calls = draw(chance)
        what = chance.choice([*calls, *[name for name in calls if often and often in name]])
        return Change(ascii(what)[1:-1][:160], calls[what])

    changes = tuple(one_change() for _ in range(chance.randrange(1, 7)))

    def written(kept: Sequence[Change]) -> Input:
        def act() -> None:
            one = made_of()
            refusal: AntennaPinError | None = None
            for change in kept:
                try:
                    change.apply(one)
                except AntennaPinError as error:
                    refusal = error
            if refusal is not None:
                raise refusal

        return Input(made(), act)

    return Draft(changes, written)


# --- sessions ----------------------------------------------------------------------------------------------


def draw_session(chance: Random) -> Draft:
    """Return calls of a session."""
    name = chance.choice(_SCENARIOS)
    return _drawn(chance, lambda: start(_loaded(name)), _session_call)


def _session_call(chance: Random) -> Calls:
    value, place, read = _value(chance), _name(chance, _PLACES), _name(chance, _READ)
    q, at, limit = chance.choice(_NUMBERS), chance.random(), _value(chance)
    return {
        f"step({shown(value)})": lambda one: one.step(value),
        f"run_until({shown(value)})": lambda one: one.run_until(value),
        f"run_until(f, {shown(value)})": lambda one: one.run_until(
            lambda moment: math.sin(1e4 * moment.time), value
        ),
        f"run_until(f -> {shown(value)})": lambda one: one.run_until(lambda moment: value, 1e-4),
        f"set({shown(place)}, {shown(value)})": lambda one: one.set(place, value),
        f"set({shown(place)}.on, {shown(value)})": lambda one: one.set(f"{place}.on", value),
        f"on({shown(place)})": lambda one: one.on(place),
        f"off({shown(place)})": lambda one: one.off(place),
        f"[{shown(read)}]": lambda one: one[read],
        f"unit({shown(read)})": lambda one: one.unit(read),
        f"reset(q={shown(q)})": lambda one: one.reset(q=q),
        f"reset(v={shown(q)})": lambda one: one.reset(v=q),
        f"reset(angles={shown(q)})": lambda one: one.reset(angles=q),
        f"restore({shown(value)})": lambda one: one.restore(value),
        f"restore(state at {at:.3f} {shown(limit)})": lambda one: one.restore(
            State.from_json(spoiled(one.save().to_json(), at, limit))
        ),
        "copy": lambda one: one.copy().step(1e-4),
        "trajectory": lambda one: one.trajectory().summary(),
        "close": lambda one: one.close(),
        f"command[{shown(place)}] = {shown(value)}": lambda one: one.command.__setitem__(place, value),
    }


# --- what a page explores ----------------------------------------------------------------------------------


def draw_explored(chance: Random) -> Draft:
    """Return what a page's sliders and boxes do to a scenario."""
    name, span = chance.choice(_SCENARIOS), chance.choice((1e-3, 1e-3, 5e-4, 0.0, -1.0, math.nan, math.inf))
    joint = chance.choice((None, None, "bore", "x"))
    return _drawn(chance, lambda: Explored(_loaded(name), joint, span), _explored_call, often=" at ")


def _explored_call(chance: Random) -> Calls:
    at, share = chance.random(), _value(chance)
    text, number = chance.choice((*ODD_TEXTS, "1", "1e-3", "0.2", "1e308")), as_float(odd_number(chance))
    share = float(share) if isinstance(share, int | float) and abs(share) < 10**308 else 0.5
    name = chance.choice(("bore", *ODD_TEXTS))

    def turned(value: Callable[[Any], Any]) -> Call:
        def call(one: Explored) -> None:
            knob = one.knobs[int(at * len(one.knobs))]
            one.turn(knob.place, value(knob))
            knob.display_text(one.value(knob))
            one.scenario()

        return call

    return {
        f"typed at {at:.3f} {shown(text)}": turned(lambda knob: knob.read(text)),
        f"slid at {at:.3f} {shown(share)}": turned(lambda knob: knob.from_slider(min(max(share, 0.0), 1.0))),
        f"turned at {at:.3f} {shown(number)}": turned(lambda knob: number),
        f"look_at({shown(name)})": lambda one: one.look_at(name),
        "save": lambda one: load_scenario(one.save(Path("saved.toml"))),
        "reset": lambda one: one.reset(),
    }


# --- units for co-simulation -------------------------------------------------------------------------------

_INPUTS = ("push", "springs.held.stiffness", "drives.push.amplitude")
_PARAMETERS = ("springs.held.damping", "duration", "drives.push.frequency", "integrator.rtol", "format")


def draw_fmu(chance: Random) -> Draft:
    """Return what a unit is made with, or the calls of a master."""
    if chance.random() < 0.3:
        return _exported(chance)
    edit = _value(chance) if chance.random() < 0.3 else None
    at = chance.random()

    def unit() -> Any:
        from antenna_pin.apps.fmu.slave import Slave

        names = {"inputs": _INPUTS[1:2], "outputs": _READ[:2], "parameters": _PARAMETERS[:1]}
        Packed(scenario=_loaded("swing.toml"), **names, token="one").write(Path())
        if edit is not None:
            (path,) = Path().glob("*.json")
            path.write_text(spoiled(path.read_text(), at, edit))
        slave = Slave(instance_name="one", resources=str(Path.cwd()))
        slave.setup_experiment(0.0)
        slave.exit_initialization_mode()
        return slave

    draft = _drawn(chance, unit, _slave_call)
    packed = Change(f"packed at {at:.3f}: {shown(edit)[:60]}", lambda one: None)
    return draft if edit is None else replace(draft, changes=(*draft.changes, packed))


def _slave_call(chance: Random) -> Calls:
    size, now = _float(chance), _float(chance)
    return {
        f"do_step(time, {shown(size)})": lambda one: one.do_step(one.time, size),
        f"do_step({shown(now)}, {shown(size)})": lambda one: one.do_step(now, size),
        f"input {shown(size)}": lambda one: one._inputs.__setitem__("springs.held.stiffness", size),
        f"parameter {shown(size)}": lambda one: one._parameters.__setitem__("springs.held.damping", size),
        "begin": lambda one: one.exit_initialization_mode(),
        "read": lambda one: one._read("bore.angle"),
        "state": lambda one: one._set_fmu_state(one._get_fmu_state()),
        "terminate": lambda one: one.terminate(),
        "description": lambda one: one.to_xml(),
    }


def _float(chance: Random) -> float:
    value = _value(chance)
    return float(value) if isinstance(value, int | float) and abs(value) < 10**308 else 1e-4


def _exported(chance: Random) -> Draft:
    """Return a command that exports a unit, with names sound and odd."""
    sound: Mapping[str, Sequence[str]] = {
        "--inputs": _INPUTS,
        "--outputs": _READ[:4],
        "--parameters": _PARAMETERS,
        "--out": ("a.fmu", "b.fmu", "a", "no/such/a.fmu"),
        "--set": ("springs.held.stiffness=3", "duration=2"),
    }

    def change() -> Change:
        option = chance.choice([*sound])
        word = chance.choice(sound[option] if chance.random() < 0.6 else ODD_TEXTS)
        return more_words(option, word, *(() if chance.random() < 0.8 else (chance.choice(_INPUTS),)))

    changes = [change() for _ in range(chance.randrange(1, 4))]
    return draft_of_words(changes, ("export", "fmu", "swing.toml", "--outputs", "bore.angle"), made)
