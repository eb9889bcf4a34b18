"""Scenario files, studies and diagrams: every key that their classes declare, with values sound and odd."""

from __future__ import annotations

import copy
import functools
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from random import Random
from typing import Any
from xml.etree import ElementTree

from antenna_pin import Scenario, Study, models_path
from antenna_pin.contact import MATERIALS
from antenna_pin.elements import FAMILIES
from antenna_pin.nonlinear import DiagramPlan
from antenna_pin.scenario.merge import merge
from fuzzing.declared import NEW, Named, Place, Table, places_of
from fuzzing.inputs import Change, Draft, Input
from fuzzing.kinds import RIG, rigs
from fuzzing.odd import misspelt, odd_value
from fuzzing.texts import text_change
from fuzzing.values import Names, admits, name_for, sound_value, toml

__all__ = [
    "Base",
    "document",
    "draft_of",
    "draw_diagram",
    "draw_scenario",
    "draw_study",
    "scenarios",
    "small_scenario",
]

# Of shipped scenarios the small ones are drawn so many times as often, and so are those of a kind each; that
# with most kinds is drawn as often as all of these.
_SMALL, _OFTEN, _MOST = ("impact_pair", "pendulum", "slider", "spherical_pendulum"), 4, 50

#: What keeps a run short, whatever a file says.
SHORT = ("--set", "integrator.max_steps=200")
# So many points of a diagram take longer than an input may; so few are made soon.
_MANY, _FEW = 10**6 + 1, 1000
_REPLACED = frozenset({("integrator",), ("integrator", "max_steps")})


@dataclass(frozen=True)
class Base:
    """A sound document.

    Attributes:
        name: Of its file.
        cls: Whose keys it has.
        table: Its content.
        files: What it names.
        names: Names that there are.
        replaced: Keys of which what the file says does not count.
    """

    name: str
    cls: type[Any]
    table: Mapping[str, Any]
    files: Mapping[str, bytes]
    names: Names
    replaced: frozenset[tuple[str, ...]] = frozenset()


@dataclass
class _Work:
    """A document that is being changed: its content, what is set over it, changes of its text."""

    table: dict[str, Any]
    sets: list[str] = field(default_factory=list)
    edits: list[Callable[[bytes], bytes]] = field(default_factory=list)


@functools.cache
def scenarios() -> tuple[Base, ...]:
    """Return the shipped scenarios, one for each case, short; and those with an element of every kind."""
    return (*_cases(), *_rigs())


def small_scenario() -> Base:
    """Return one that takes next to no time."""
    return next(base for base in scenarios() if base.table["mechanism"]["urdf"] == "pair.urdf")


def _cases() -> Iterator[Base]:
    for folder in sorted(models_path().iterdir()):
        if not (folder / "scenario.toml").is_file():
            continue
        table = tomllib.loads((folder / "scenario.toml").read_text())
        files = {
            path.name: path.read_bytes() for path in folder.iterdir() if path.suffix in (".urdf", ".csv")
        }
        cases = table.pop("cases", {"": {}})
        table.pop("default_case", None)
        for case in cases.values():
            short = {"duration": 1e-3, "integrator": {"engine": "compiled"}}
            own = {key: value for key, value in case.items() if key not in ("description", "base")}
            found = merge(merge(table, own), short)
            for joint in found.get("clearance", {}).values():
                joint["geometry"] = "closed-form"
            base = Base("scenario.toml", Scenario, found, files, _names(found, files), _REPLACED)
            yield from [base] * (_OFTEN if folder.name in _SMALL else 1)


def _rigs() -> Iterator[Base]:
    for number, table in enumerate(rigs()):
        files = {"rig.urdf": RIG.encode()}
        base = Base("scenario.toml", Scenario, table, files, _names(table, files), _REPLACED)
        yield from [base] * (_OFTEN if number else _MOST)


def _names(table: Mapping[str, Any], files: Mapping[str, bytes]) -> Names:
    robot = ElementTree.fromstring(files[table["mechanism"]["urdf"]])
    joints = [joint.get("name", "") for joint in robot.findall("joint")]
    found = {
        "joint": joints,
        "link": [link.get("name", "") for link in robot.findall("link")],
        "frame": joints,
        "material": [*table.get("materials", ()), *MATERIALS],
        "contact": [f"{joint}.{side}" for joint in joints for side in ("radial+", "axial-", "radial")],
        "file": [*files],
        "set": [
            f"{kind}.{name}.on"
            for kind in FAMILIES
            if isinstance(table.get(kind), Mapping)
            for name in table[kind]
        ],
        "key": [".".join(place.path) for place in places_of(Scenario, table) if place.there],
    }
    return found | {"": [name for names in found.values() for name in names] + ["world", "new"]}


# --- changes -----------------------------------------------------------------------------------------------


def _put(table: dict[str, Any], path: Sequence[str], value: Any) -> None:
    """Set an entry, if the tables that lead to it are there."""
    for key in path[:-1]:
        table = table.get(key) if isinstance(table, dict) else None  # type: ignore[assignment]
    if isinstance(table, dict):
        table[path[-1]] = value


def _take(table: dict[str, Any], path: Sequence[str]) -> Any:
    for key in path[:-1]:
        table = table.get(key) if isinstance(table, dict) else None  # type: ignore[assignment]
    return table.pop(path[-1], None) if isinstance(table, dict) else None


def change_of(chance: Random, base: Base) -> Change:
    """Return a random change of a document."""
    places = list(places_of(base.cls, base.table))
    roll = chance.random()
    if roll < 0.62:
        return _value_change(chance, base, chance.choice(places))
    there = [place for place in places if place.there]
    place = chance.choice(there)
    path, key = place.path, place.path[-1]
    if roll < 0.72:
        name = misspelt(chance, key)

        def rename(work: _Work) -> None:
            _put(work.table, (*path[:-1], name), _take(work.table, path))

        return Change(f"{'.'.join(path)} is called {name!r}", rename)
    if roll < 0.82:
        return Change(
            f"no {'.'.join(path)}", lambda work: _take(work.table, path), place.what.required, (key,)
        )
    if roll < 0.9:
        where = chance.choice([place.path[:-1] for place in there])
        name, value = misspelt(chance, key), odd_value(chance)
        return Change(
            f"{'.'.join((*where, name))} = {_short(value)}",
            lambda work: _put(work.table, (*where, name), value),
        )
    edit = text_change(chance)
    return Change(edit.name, lambda work: work.edits.append(edit.apply))


def _value_change(chance: Random, base: Base, place: Place) -> Change:
    what, path = place.what, place.path
    sound = chance.random() < 0.35
    value = sound_value(chance, what, base.names) if sound else odd_value(chance)
    if path[-1] == NEW:
        path = (*path[:-1], name_for(chance, "joint link", base.names))
        if any(isinstance(shape, Table) for shape in what.shapes) and chance.random() < 0.7:
            value = sound_value(chance, what, base.names)
    # Any text may be the name of something, and anything may stand where nothing is declared.
    wrong = not admits(what, value) and not any(
        isinstance(shape, Named) and not shape.of for shape in what.shapes
    )
    wrong = wrong and path not in base.replaced
    long = isinstance(value, int) and value.bit_length() > 4096  # told of before its place is known
    says = () if long else tuple(name for name in path[-2:] if name.isidentifier())
    plain = all(key.replace("-", "_").isidentifier() for key in path)
    if plain and base.cls is Scenario and chance.random() < 0.2 and not isinstance(value, dict):
        text = f"{'.'.join(path)}={toml(value)}"
        return Change(f"--set {_short(text)}", lambda work: work.sets.append(text), wrong, says)
    return Change(
        f"{'.'.join(path)} = {_short(value)}",
        lambda work: _put(work.table, path, copy.deepcopy(value)),
        wrong,
        says,
    )


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else toml(value)
    return ascii(text if len(text) < 120 else f"{text[:60]}... ({len(text)} letters)")[1:-1]


def document(table: Mapping[str, Any]) -> str:
    """Return a document's text, a table a line."""
    return "".join(f"{toml(key)} = {toml(value)}\n" for key, value in table.items())


def draft_of(chance: Random, base: Base, act: Callable[[list[str]], Sequence[str]]) -> Draft:
    """Return a document with some changes, and the command of what is to be set."""
    changes = tuple(change_of(chance, base) for _ in range(chance.choice((1, 1, 1, 2, 3))))

    def made(kept: Sequence[Change]) -> Input:
        work = _Work(copy.deepcopy(dict(base.table)))
        for change in kept:
            change.apply(work)
        content = document(work.table).encode("utf-8", "surrogatepass")
        for edit in work.edits:
            content = edit(content)
        return Input({**base.files, base.name: content}, act([f"--set={text}" for text in work.sets]))

    return Draft(changes, made)


# --- the formats -------------------------------------------------------------------------------------------


def draw_scenario(chance: Random) -> Draft:
    """Return a scenario file, read, written as URDF, asked for its modes or run."""
    base = chance.choice(scenarios())
    words: tuple[str, ...] = chance.choice(
        (("info",),) * 5
        + (("urdf", "--out", "out.urdf"), ("info", "--json"), ("modes",))
        + (("run", "--out", "out.nc", "--no-progress", *SHORT),) * 2
    )
    return draft_of(chance, base, lambda sets: [words[0], base.name, *sets, *words[1:]])


_STUDY = {
    "scenario": "scenario.toml",
    "seed": 1,
    "set": {"duration": 1e-3, "integrator": {"max_steps": 200}},
    "sampling": {"method": "random", "count": 2},
    "parameters": {
        "restitution": {"key": "clearance.bore.normal.restitution", "between": [0.3, 0.9]},
        "play": {"key": "clearance.bore.radial_clearance", "values": ["0.1 mm", "0.2 mm"]},
        "radius": {
            "key": "clearance.bore.bearing_radius",
            "tolerance": {"nominal": "10 mm", "plus": "10 um", "minus": "-10 um"},
        },
        "speed": {"key": "integrator.rtol", "start": 1e-8, "stop": 1e-6, "count": 2, "spacing": "log"},
    },
    "responses": {
        "impacts": {"measure": "impacts"},
        "speed_left": {"measure": "peak_acceleration", "of": "bore"},
        "like": {"measure": "peak_force", "title": "force"},
    },
    "reference": {"set": {"integrator": {"rtol": 1e-9}}, "follows": ["play"]},
}


@functools.cache
def _study_base() -> Base:
    small = small_scenario()
    files = {**small.files, small.name: document(small.table).encode()}
    return Base("some.study.toml", Study, _STUDY, files, small.names)


def draw_study(chance: Random) -> Draft:
    """Return a study, whose runs are counted or made."""
    base = _study_base()
    words: tuple[str, ...] = ("sweep", base.name, "--out", "some.study", "--no-progress")
    words += ("--dry-run",) if chance.random() < 0.7 else ("--workers", "0")
    return draft_of(chance, base, lambda sets: [*words, *sets])


_DIAGRAM = {
    "scenario": "scenario.toml",
    "set": {"integrator": {"max_steps": 2000}},
    "parameter": "drives.push.amplitude",
    "values": "0.1 N*m:0.2 N*m:2",
    "section": "period",
    "quantities": ["v[bore]"],
    "count": 32,
    "transient": 0,
}


@functools.cache
def _diagram_base() -> Base:
    small = small_scenario()
    push = {"joint": "bore", "kind": "sine", "amplitude": 0.1, "frequency": 1000.0}
    table = {**small.table, "clearance": {}, "initial": {}, "drives": {"push": push}}
    files = {**small.files, small.name: document(table).encode()}
    return Base("some.diagram.toml", DiagramPlan, _DIAGRAM, files, small.names)


def draw_diagram(chance: Random) -> Draft:
    """Return a bifurcation diagram's file."""
    base = _diagram_base()
    words = ["bifurcation", base.name, "--out", "diagram.nc", "--no-progress", "--workers", "1"]
    draft = draft_of(chance, base, lambda sets: [*words, *sets])
    return replace(draft, made=lambda kept: _in_time(draft.made(kept)))


def _in_time(asked: Input) -> Input:
    """Return a diagram of few points for one of many: they take the time that they take, and it says so."""
    try:
        table = tomllib.loads(asked.files["some.diagram.toml"].decode())
    except (ValueError, RecursionError):
        return asked
    many = [
        f"--{key}={_FEW}"
        for key in ("count", "transient")
        if isinstance(value := table.get(key), int | float) and _FEW < value < _MANY and value % 1 == 0
    ]
    return replace(asked, act=[*asked.act, *many])
