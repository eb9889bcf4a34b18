"""Commands: every option and argument that they declare, with values sound and odd."""

from __future__ import annotations

import functools
import shlex
from enum import Enum
from pathlib import Path
from random import Random
from typing import Any, get_args

import typer.main
from robust.inputs import Change, Draft, draft_of_words, more_words, several

from antenna_pin.apps.cli import app
from antenna_pin.base.units import shown
from fuzzing.documents import SHORT
from fuzzing.made import made
from fuzzing.odd import ODD_TEXTS, as_digits, misspelt, odd_number
from fuzzing.results import KEYS, SENSITIVITY

# Sound words by what a metavar or a type asks for: the first fits an argument.
_FILES = {
    "SCENARIO": ("swing.toml", "play.toml", "run.nc"),
    "FILE": ("run.nc", "orbit.nc", "branch.nc", "diagram.nc", "section.nc"),
    "STUDY": ("few.study.toml", "few.study"),
    "STORE": ("few.study",),
    **dict.fromkeys(("DIR", "FOLDER"), ("some",)),
}
_OUT = ("out.nc", "out.html", "out.png", "out.csv", "out.urdf", "out", "some", "out.json", "out.study")
_TEXTS = (
    *"1 ms|0.5 ms|0.001|1|2|0.1|1,0,0|0,1,0|play|bore|ring|disc|10 mm|1e-3|q[bore.x]|v[bore.vx]".split("|"),
    *"motion_angle[bore]|0.1 mm, 0.2 mm|0.1,0.2|0.1 N*m:0.2 N*m:2|judge|0.1 N*m:0.11 N*m".split("|"),
    *"drives.push.amplitude|drives.push|period|energy|steel|hertz|10x10|integrator.rtol=1e-6".split("|"),
    *"duration=1e-3|clearance.bore.radial_clearance=0.2 mm|1/100|3 periods|all".split("|"),
)

# What keeps a command short whatever else it is told; options given twice count as the last.
_NEEDED = {
    "run": shlex.join(SHORT),
    "poincare": "-q v[bore.vx] --count 32 --transient 0 --most 40",
    "bifurcation": "--over drives.push.amplitude --values 0.1,0.2 -q v[bore.vx] --count 32"
    " --transient 0 --most 40 --workers 1",
    "orbit": "--transient 5 --rtol 1e-8 --most 2",
    "lyapunov": "--count 3 --transient 1 --rtol 1e-8",
    "phase": "-x q[bore.x] -y v[bore.vx]",
    "pointing": "--body disc --boresight 1,0,0 --direction 0,1,0",
    "plot": "--out some --figure energy",
    "record": "--out out.html",
    "report": "--out out.html --no-figures --no-recordings",
    "sweep": "--workers 0",
    "figures": f"--duration '1 ms' --figure 1 {shlex.join(SHORT)}",
    "study report": "--out out.html --no-figures",
    "study plot": "--list",
    "contact restitution": "--no-simulate",
}
# What starts servers, waits for them or asks a browser is not drawn.
_LEFT_OUT = set("--scheduler --tls-ca --tls-cert --tls-key --install-completion --show-completion".split())


@functools.cache
def commands() -> dict[str, Any]:
    """Return every command by its words, but those that work for long."""
    found, left = {}, [("", typer.main.get_command(app))]
    for words, command in left:
        if hasattr(command, "commands"):
            left += [(f"{words} {name}".strip(), one) for name, one in command.commands.items()]
        elif words not in ("explore", "demo"):  # runs of 5 s, drawn
            found[words] = command
    return found


def draw_options(chance: Random) -> Draft:
    """Return a command with options, among small files."""
    name = chance.choice(sorted(commands()))
    command = commands()[name]
    positional = [one for one in command.params if one.param_type_name == "argument"]
    named = [
        one for one in command.params if one.param_type_name == "option" and not _LEFT_OUT & set(one.opts)
    ]
    needed = [*name.split(), *[word for one in positional if one.required for word in _sound(one)[:1]]]
    needed += shlex.split(_NEEDED.get(name, ""))
    needed += [option for one in named for option in one.secondary_opts if option == "--no-progress"]
    first = len(name.split())
    changes = several(chance, lambda: _change(chance, named, positional, needed, first), 1, 1, 2, 3)
    return draft_of_words(changes, needed, made)


def _kind(parameter: Any) -> type[Any]:
    """Return what an argument or option is read as, one of several if it may be repeated."""
    hint = parameter.type_descriptor.annotation
    hint = get_args(hint)[0] if get_args(hint) else hint
    return hint if isinstance(hint, type) else str


def _sound(parameter: Any) -> tuple[str, ...]:
    """Return sound words for an argument or option."""
    kind = _kind(parameter)
    if issubclass(kind, Enum):
        return tuple(str(one.value) for one in kind)
    meta = (parameter.metavar or "").upper()
    found = tuple(word for key, words in _FILES.items() if key in meta for word in words)
    if kind is Path:
        found += _OUT if parameter.param_type_name == "option" else ("run.nc",)
    if kind is int:
        return ("1", "2", "3", "32")
    if kind is float:
        return ("0.5", "1", "2", "1e-3")
    return found or _TEXTS


def _change(chance: Random, named: list[Any], positional: list[Any], needed: list[str], first: int) -> Change:
    roll = chance.random()
    if roll < 0.75 and named:
        option = chance.choice(named)
        flag = chance.choice([*option.opts, *option.secondary_opts])
        if option.is_flag:
            return more_words(flag)
        value, wrong = _word(chance, option)
        short = value if len(value) < 80 else f"{value[:40]}... ({len(value)} letters)"
        says = (flag, *(one.strip("-").replace("-", "_") for one in option.opts), flag.strip("-"))
        return Change(f"{flag} {ascii(short)}", lambda words: words.extend((flag, value)), wrong, says)
    if roll < 0.85:
        option = chance.choice(named) if named else None
        return more_words(misspelt(chance, option.opts[0] if option else "--out"))
    if roll < 0.95 and positional:
        value, _ = _word(chance, positional[0])
        at = next((k for k, word in enumerate(needed) if word in _sound(positional[0])), None)

        def put(words: list[str]) -> None:
            if at is not None and at < len(words):
                words[at] = value
            else:
                words.append(value)

        return Change(f"argument {ascii(value[:80])}", put)
    k = chance.randrange(first, max(len(needed), first + 1))
    return Change(f"word {k} lost", lambda words: words.pop(k) if k < len(words) else None)


def _word(chance: Random, parameter: Any) -> tuple[str, bool]:
    """Return a word for an option, and whether it must be refused."""
    sound = _sound(parameter)
    roll, kind = chance.random(), _kind(parameter)
    if roll < 0.4:
        return chance.choice(sound), False
    if roll < 0.55:
        return misspelt(chance, chance.choice(sound)), False
    if roll < 0.75:
        word = as_digits(odd_number(chance))
        return word, kind is int and not word.lstrip("-").isdigit()
    others = ("no/such/out.nc", "/proc/out.nc", "/dev/full", "run.nc", ".")
    word = chance.choice((*ODD_TEXTS, *_TEXTS, *_OUT, *others))
    # No number at all, where one is asked for.
    return word, kind in (int, float) and not any(letter.isdigit() or letter in "inf" for letter in word)


def draw_sensitivity(chance: Random) -> Draft:
    """Return what may be asked of sensitivities: keys, scales, methods, pieces."""

    def change() -> Change:
        odd = chance.random() < 0.6
        scale = shown(odd_number(chance)) if odd else "1"
        method, texts = ("quick-runs", "runs"), (*ODD_TEXTS, scale)
        options = (
            (chance.choice(ODD_TEXTS if odd else KEYS),),
            (f"{chance.choice(KEYS)}={scale}",),
            ("--method", chance.choice(ODD_TEXTS if odd else method)),
            ("--pieces", chance.choice(texts) if odd else "0.2 ms"),
            ("--duration", chance.choice(texts) if odd else "0.5 ms"),
            ("--most", scale),
            ("--start", chance.choice((*ODD_TEXTS, "play.toml", "run.nc"))),
            ("--out", chance.choice(("a.nc", "a", "swing.toml", "no/a.nc"))),
            ("--plot", chance.choice(("a.png", "a.xyz", "run.nc"))),
            ("--csv", chance.choice(("a.csv", "run.nc"))),
        )
        return more_words(*chance.choice(options))

    return draft_of_words(
        several(chance, change, 1, 1, 2), (*SENSITIVITY, KEYS[1], "--method", "equation"), made
    )
