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

from robust.inputs import Change, Draft, Input, after, several

from antenna_pin import Scenario, models_path
from antenna_pin.contact import MATERIALS
from antenna_pin.elements import FAMILIES
from antenna_pin.scenario.merge import merge
from antenna_pin.studies.nonlinear import DiagramPlan
from antenna_pin.studies.sweep import Study
from fuzzing.declared import NEW, Named, Names, Place, Table, name_for, places_of
from fuzzing.kinds import RIG, rigs
from fuzzing.odd import Raw, misspelt, odd_value, text_change

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
    """A sound document."""

    name: str  # of its file
    cls: type[Any]  # whose keys it has
    table: Mapping[str, Any]  # its content
    files: Mapping[str, bytes]  # what it names
    names: Names  # names that there are
    replaced: frozenset[tuple[str, ...]] = frozenset()  # keys of which what the file says does not count


@dataclass
class _Work:
    """A document that is being changed: its content, what is set over it, changes of its text."""

    table: dict[str, Any]
    sets: list[str] = field(default_factory=list)
    edits: list[Change] = field(default_factory=list)


@functools.cache
def scenarios() -> tuple[Base, ...]:
    """Return the shipped scenarios, one for each case, short; and those with an element of every kind."""
    return tuple(
        Base("scenario.toml", Scenario, table, files, _names(table, files), _REPLACED)
        for table, files, times in _cases()
        for _ in range(times)
    )


@functools.cache
def small_scenario() -> Base:
    """Return one that takes next to no time."""
    return next(base for base in scenarios() if base.table["mechanism"]["urdf"] == "pair.urdf")


def driven(**drive: Any) -> dict[str, Any]:
    """Return the table of the small scenario without play, driven."""
    push = {"joint": "bore", "kind": "sine", "amplitude": 0.1} | drive
    return {**small_scenario().table, "clearance": {}, "initial": {}, "drives": {"push": push}}


def base_on(scenario: Mapping[str, Any], name: str, cls: type[Any], table: Mapping[str, Any]) -> Base:
    """Return a document that names a scenario with the files of the small one."""
    small = small_scenario()
    files = {**small.files, small.name: document(scenario).encode()}
    return Base(name, cls, table, files, small.names)


def _cases() -> Iterator[tuple[dict[str, Any], dict[str, bytes], int]]:
    for folder in sorted(models_path().iterdir()):
        if not (folder / "scenario.toml").is_file():
            continue
        table = tomllib.loads((folder / "scenario.toml").read_text())
        files = {one.name: one.read_bytes() for one in folder.iterdir() if one.suffix in (".urdf", ".csv")}
        cases = table.pop("cases", {"": {}})
        table.pop("default_case", None)
        for case in cases.values():
            short = {"duration": 1e-3, "integrator": {"engine": "compiled"}}
            own = {key: value for key, value in case.items() if key not in ("description", "base")}
            found = merge(merge(table, own), short)
            for joint in found.get("clearance", {}).values():
                joint["geometry"] = "closed-form"
            yield found, files, _OFTEN if folder.name in _SMALL else 1
    for number, table in enumerate(rigs()):
        yield table, {"rig.urdf": RIG.encode()}, _OFTEN if number else _MOST


def _names(table: Mapping[str, Any], files: Mapping[str, bytes]) -> Names:
    robot = ElementTree.fromstring(files[table["mechanism"]["urdf"]])
    joints = [joint.get("name", "") for joint in robot.findall("joint")]
    families = [kind for kind in FAMILIES if isinstance(table.get(kind), Mapping)]
    found = {
        "joint": joints,
        "link": [link.get("name", "") for link in robot.findall("link")],
        "frame": joints,
        "material": [*table.get("materials", ()), *MATERIALS],
        "contact": [f"{joint}.{side}" for joint in joints for side in ("radial+", "axial-", "radial")],
        "file": [*files],
        "set": [f"{kind}.{name}.on" for kind in families for name in table[kind]],
        "key": [".".join(place.path) for place in places_of(Scenario, table) if place.there],
    }
    return found | {"": [name for names in found.values() for name in names] + ["world", "new"]}


# --- changes -----------------------------------------------------------------------------------------------


def _above(table: Any, path: Sequence[str]) -> dict[str, Any]:
    """Return the table that holds an entry; an empty one if it is not there."""
    for key in path[:-1]:
        table = table.get(key) if isinstance(table, dict) else None
    return table if isinstance(table, dict) else {}


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
            above = _above(work.table, path)
            above[name] = above.pop(key, None)

        return Change(f"{'.'.join(path)} is called {name!r}", rename)
    if roll < 0.82:
        return Change(
            *(f"no {'.'.join(path)}", lambda work: _above(work.table, path).pop(key, None)),
            *(place.what.required, (key,)),
        )
    if roll < 0.9:
        where = chance.choice([place.path[:-1] for place in there])
        name, value = misspelt(chance, key), odd_value(chance)
        return _set((*where, name), value)
    edit = text_change(chance)
    return Change(edit.name, lambda work: work.edits.append(edit))


def _set(path: tuple[str, ...], value: Any, *more: Any) -> Change:
    """Return a change that sets an entry, if the tables that lead to it are there."""

    def put(work: _Work) -> None:
        _above(work.table, path)[path[-1]] = copy.deepcopy(value)

    return Change(f"{'.'.join(path)} = {_short(value)}", put, *more)


def _value_change(chance: Random, base: Base, place: Place) -> Change:
    what, path = place.what, place.path
    value = what.sound(chance, base.names) if chance.random() < 0.35 else odd_value(chance)
    if path[-1] == NEW:
        path = (*path[:-1], name_for(chance, "joint link", base.names))
        if any(isinstance(shape, Table) for shape in what.shapes) and chance.random() < 0.7:
            value = what.sound(chance, base.names)
    # Any text may be the name of something, and anything may stand where nothing is declared.
    anything = any(isinstance(shape, Named) and not shape.of for shape in what.shapes)
    wrong = not what.admits(value) and not anything and path not in base.replaced
    long = isinstance(value, int) and value.bit_length() > 4096  # told of before its place is known
    says = () if long else tuple(name for name in path[-2:] if name.isidentifier())
    plain = all(key.replace("-", "_").isidentifier() for key in path)
    if plain and base.cls is Scenario and chance.random() < 0.2 and not isinstance(value, dict):
        text = f"{'.'.join(path)}={toml(value)}"
        return Change(f"--set {_short(text)}", lambda work: work.sets.append(text), wrong, says)
    return _set(path, value, wrong, says)


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else toml(value)
    return ascii(text if len(text) < 120 else f"{text[:60]}... ({len(text)} letters)")[1:-1]


def toml(value: Any) -> str:
    """Return a value as TOML text."""
    match value:
        case Raw():
            return value.text
        case bool():
            return str(value).lower()
        case int():
            return hex(value) if value > 10**4000 else str(value)
        case float():
            return repr(value)
        case str():
            return f'"{"".join(map(_escaped, value))}"'
        case Mapping():
            return "{" + ", ".join(f"{toml(str(key))} = {toml(entry)}" for key, entry in value.items()) + "}"
        case list() | tuple():
            return "[" + ", ".join(map(toml, value)) + "]"
    return value.isoformat() if hasattr(value, "isoformat") else str(value)


def _escaped(letter: str) -> str:
    if letter in '"\\':
        return f"\\{letter}"
    return letter if letter.isprintable() else f"\\U{ord(letter):08x}"


def document(table: Mapping[str, Any]) -> str:
    """Return a document's text, a table a line."""
    return "".join(f"{toml(key)} = {toml(value)}\n" for key, value in table.items())


def draft_of(chance: Random, base: Base, act: Callable[[list[str]], Sequence[str]]) -> Draft:
    """Return a document with some changes, and the command of what is to be set."""
    changes = several(chance, lambda: change_of(chance, base), 1, 1, 1, 2, 3)

    def made(kept: Sequence[Change]) -> Input:
        work = _Work(copy.deepcopy(dict(base.table)))
        for change in kept:
            change.apply(work)
        content = after(work.edits, document(work.table).encode("utf-8", "surrogatepass"))
        return Input({**base.files, base.name: content}, act([f"--set={text}" for text in work.sets]))

    return Draft(changes, made)


def limited(draft: Draft, name: str, options: Callable[[dict[str, Any]], Sequence[str]]) -> Draft:
    """Return a draft whose command has more options, by what its document asks for."""

    def made(kept: Sequence[Change]) -> Input:
        given = draft.made(kept)
        try:
            table = tomllib.loads(given.files[name].decode())  # type: ignore[union-attr]
        except (ValueError, RecursionError):
            return given
        return replace(given, act=[*given.act, *options(table)])  # type: ignore[misc]

    return replace(draft, made=made)


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


_STUDY = tomllib.loads("""
scenario = "scenario.toml"
seed = 1
set = {duration=1e-3, integrator={max_steps=200}}
sampling = {method="random", count=2}
[parameters]
restitution = {key="clearance.bore.normal.restitution", between=[0.3, 0.9]}
play = {key="clearance.bore.radial_clearance", values=["0.1 mm", "0.2 mm"]}
radius = {key="clearance.bore.bearing_radius", tolerance={nominal="10 mm", plus="10 um", minus="-10 um"}}
speed = {key="integrator.rtol", start=1e-8, stop=1e-6, count=2, spacing="log"}
[responses]
impacts = {measure="impacts"}
speed_left = {measure="peak_acceleration", of="bore"}
like = {measure="peak_force", title="force"}
[reference]
set = {integrator={rtol=1e-9}}
follows = ["play"]
""")


def draw_study(chance: Random) -> Draft:
    """Return a study, whose runs are counted or made."""
    base = base_on(small_scenario().table, "some.study.toml", Study, _STUDY)
    words: tuple[str, ...] = ("sweep", base.name, "--out", "some.study", "--no-progress")
    words += ("--dry-run",) if chance.random() < 0.7 else ("--workers", "0")
    return draft_of(chance, base, lambda sets: [*words, *sets])


_DIAGRAM = tomllib.loads("""
scenario = "scenario.toml"
set = {integrator={max_steps=2000}}
parameter = "drives.push.amplitude"
values = "0.1 N*m:0.2 N*m:2"
section = "period"
quantities = ["v[bore]"]
count = 32
transient = 0
""")


def draw_diagram(chance: Random) -> Draft:
    """Return a bifurcation diagram's file."""
    base = base_on(driven(frequency=1000.0), "some.diagram.toml", DiagramPlan, _DIAGRAM)
    words = ["bifurcation", base.name, "--out", "diagram.nc", "--no-progress", "--workers", "1"]
    draft = draft_of(chance, base, lambda sets: [*words, *sets])
    return limited(draft, base.name, _fewer)


def _fewer(table: dict[str, Any]) -> list[str]:
    """Return options of few points for a diagram of many, which would take their time."""
    return [
        f"--{key}={_FEW}"
        for key in ("count", "transient")
        if isinstance(value := table.get(key), int | float) and _FEW < value < _MANY and value % 1 == 0
    ]
