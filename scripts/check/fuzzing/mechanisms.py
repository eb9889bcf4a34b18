"""URDF files: elements, attributes, names and numbers changed, of shipped mechanisms and of odd ones."""

from __future__ import annotations

import contextlib
import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from random import Random
from typing import Any

import numpy as np
from lxml import etree
from robust.inputs import Change, Draft, Input, after, several
from urdf_generator import draw_urdf as odd_urdf

from fuzzing.documents import SHORT, document, scenarios
from fuzzing.odd import ODD_TEXTS, as_digits, misspelt, odd_number, text_change

_ODD_URDFS = 40  # that are drawn from, beside the shipped ones
_TYPES = tuple("revolute continuous prismatic fixed floating planar Revolute ball universal".split())
# Attributes whose numbers must be finite wherever they stand in what is simulated.
_NUMBERS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


@dataclass
class _Work:
    root: Any
    edits: list[Change] = field(default_factory=list)

    def at(self, number: int) -> Any:
        """Return an element by its number in the sound file, if it is there still."""
        return next((one for one in self.root.iter() if one.get("fuzz") == str(number)), None)


def draw_urdf(chance: Random) -> Draft:
    """Return a URDF, checked by itself or in a scenario that is read, written or run."""
    base = chance.choice(scenarios())
    name = base.table["mechanism"]["urdf"]
    content = base.files[name]
    if chance.random() < 0.3:
        drawn = odd_urdf(7, chance.randrange(_ODD_URDFS))
        content = drawn.odd
        table = {"duration": 1e-3, "mechanism": {"urdf": name, "base": chance.choice(("free", "fixed"))}}
    else:
        table = dict(base.table)
    root = etree.fromstring(content, etree.XMLParser(recover=True))
    root = etree.fromstring(drawn.plain) if root is None else root  # no XML to a strict reader
    for number, element in enumerate(root.iter(etree.Element)):
        element.set("fuzz", str(number))
    changes = several(chance, lambda: _change(chance, root), 1, 1, 1, 2, 3)
    if chance.random() < 0.12:
        edit = text_change(chance)
        changes = (*changes[1:], Change(edit.name, lambda work: work.edits.append(edit)))
    written = ("urdf", base.name, "--out", "out.urdf")
    run = ("run", base.name, "--out", "out.nc", "--no-progress", *SHORT)
    words = chance.choice(
        (("urdf", name, "--check"), written, written, ("info", base.name), ("modes", base.name), run)
    )

    def made(kept: Sequence[Change]) -> Input:
        work = _Work(copy.deepcopy(root))
        for change in kept:
            change.apply(work)
        for element in work.root.iter(etree.Element):
            element.attrib.pop("fuzz", None)
        text = after(work.edits, etree.tostring(work.root))
        return Input({**base.files, name: text, base.name: document(table)}, words)

    return Draft(changes, made)


def _change(chance: Random, root: Any) -> Change:
    every = list(root.iter(etree.Element))
    elements = [one for one in every if len(one.attrib) > 1]
    number = chance.randrange(len(every))
    if elements and chance.random() < 0.6:
        return _attribute_change(chance, root, chance.choice(elements))
    others = [int(one.get("fuzz")) for one in every]
    element = every[others.index(number)]
    other, kind, tag = chance.choice(others), chance.randrange(6), misspelt(chance, str(element.tag))

    def apply(work: _Work) -> None:
        here, there = work.at(number), work.at(other)
        parent = None if here is None else here.getparent()
        if here is None or parent is None:
            return
        if kind == 0:
            parent.remove(here)
        elif kind == 1:
            parent.insert(0, copy.deepcopy(here))
        elif kind == 2 and there is not None and here not in [there, *there.iterancestors()]:
            there.append(here)
        elif kind == 3 and there is not None:
            there.append(copy.deepcopy(here))
        elif kind == 4:
            _try(lambda: setattr(here, "tag", tag))
        else:
            here.text = "1 2 3"
            here[:] = []

    what = ("lost", "twice", "moved", "copied elsewhere", f"called {tag!r}", "emptied")[kind]
    return Change(f"{_label(element)} {what}", apply)


def _label(element: Any) -> str:
    path = (*reversed(list(element.iterancestors())), element)
    return "/".join(f"{one.tag} {one.get('name', '')}".strip() for one in path)[-60:]


def _attribute_change(chance: Random, root: Any, element: Any) -> Change:
    key = chance.choice([one for one in element.attrib if one != "fuzz"])
    number, old, roll = int(element.get("fuzz")), element.get(key), chance.random()
    label = f"{_label(element)} {key}"

    def change(what: str, act: Callable[[Any], Any], wrong: bool = False) -> Change:
        def apply(work: _Work) -> None:
            if (one := work.at(number)) is not None:
                _try(lambda: act(one))

        return Change(f"{label} {what}", apply, wrong)

    if roll < 0.1:
        return change("lost", lambda one: one.attrib.pop(key, None))
    if roll < 0.2:
        name = misspelt(chance, key)
        return change(f"called {name!r}", lambda one: one.set(name, one.attrib.pop(key, "")))
    value, wrong = _value(chance, root, key, old)
    return change(f"= {value[:80]!r}", lambda one: one.set(key, value), wrong and element.tag == "inertia")


def _value(chance: Random, root: Any, key: str, old: str) -> tuple[str, bool]:
    """Return another value for an attribute, and whether it must be refused where it is a number."""
    words = old.split()
    if not all(_is_number(word) for word in words) or not words:
        names = [one.get("name") for one in root.iter() if one.get("name")]
        others = (misspelt(chance, old), "world", "package://x/y.stl", "file:///no.obj")
        return chance.choice((*names, *_TYPES, *ODD_TEXTS, *others)), False
    roll = chance.random()
    if roll < 0.6:
        number = as_digits(odd_number(chance))
        words[chance.randrange(len(words))] = number
    elif roll < 0.75:
        words = words * 2 if chance.random() < 0.5 else words[1:]
    else:
        words[chance.randrange(len(words))] = chance.choice(ODD_TEXTS)
    value = " ".join(words)
    finite = [_is_number(word) and bool(np.isfinite(float(word))) for word in value.split()]
    return value, key in _NUMBERS and (len(finite) != 1 or not all(finite))


def _is_number(word: str) -> bool:
    with contextlib.suppress(ValueError):
        return float(word) is not None
    return False


def _try(act: Callable[[], Any]) -> None:
    """Do what lxml may refuse to write, a control character or a name that is none."""
    with contextlib.suppress(ValueError, TypeError):
        act()
