"""URDF files: elements, attributes, names and numbers changed, of shipped mechanisms and of odd ones."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from random import Random
from typing import Any

import numpy as np
from lxml import etree
from urdf_generator import draw_urdf as odd_urdf

from fuzzing.documents import SHORT, document, scenarios
from fuzzing.inputs import Change, Draft, Input
from fuzzing.odd import ODD_TEXTS, misspelt, odd_number
from fuzzing.texts import text_change

__all__ = ["draw_urdf"]

_ODD_URDFS = 40  # that are drawn from, beside the shipped ones
_TYPES = (
    "revolute",
    "continuous",
    "prismatic",
    "fixed",
    "floating",
    "planar",
    "Revolute",
    "ball",
    "universal",
)

# Attributes whose numbers must be finite wherever they stand in what is simulated.
_NUMBERS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


@dataclass
class _Work:
    root: Any
    edits: list[Callable[[bytes], bytes]] = field(default_factory=list)

    def at(self, number: int) -> Any:
        """Return an element by its number in the sound file, if it is there still."""
        return next((one for one in self.root.iter() if one.get("fuzz") == str(number)), None)


def draw_urdf(chance: Random) -> Draft:
    """Return a URDF, checked by itself or in a scenario that is read, written or run."""
    base = chance.choice(scenarios())
    name = base.table["mechanism"]["urdf"]
    content = base.files[name]
    words: Sequence[str]
    if chance.random() < 0.3:
        drawn = odd_urdf(7, chance.randrange(_ODD_URDFS))
        content = drawn.odd
        table = {"duration": 1e-3, "mechanism": {"urdf": name, "base": chance.choice(("free", "fixed"))}}
    else:
        table = dict(base.table)
    root = etree.fromstring(content, etree.XMLParser(recover=True))
    if root is None:  # no XML to a strict reader
        root = etree.fromstring(drawn.plain)
    for number, element in enumerate(root.iter(etree.Element)):
        element.set("fuzz", str(number))
    changes = tuple(_change(chance, root) for _ in range(chance.choice((1, 1, 1, 2, 3))))
    if chance.random() < 0.12:
        edit = text_change(chance)
        changes = (*changes[1:], Change(edit.name, lambda work: work.edits.append(edit.apply)))
    words = chance.choice(
        (
            ("urdf", name, "--check"),
            ("urdf", base.name, "--out", "out.urdf"),
            ("urdf", base.name, "--out", "out.urdf"),
            ("info", base.name),
            ("modes", base.name),
            ("run", base.name, "--out", "out.nc", "--no-progress", *SHORT),
        )
    )

    def made(kept: Sequence[Change]) -> Input:
        work = _Work(copy.deepcopy(root))
        for change in kept:
            change.apply(work)
        for element in work.root.iter(etree.Element):
            element.attrib.pop("fuzz", None)
        text = etree.tostring(work.root)
        for edit in work.edits:
            text = edit(text)
        return Input({**base.files, name: text, base.name: document(table)}, words)

    return Draft(changes, made)


def _change(chance: Random, root: Any) -> Change:
    elements = [one for one in root.iter(etree.Element) if len(one.attrib) > 1]
    number = chance.randrange(len(list(root.iter(etree.Element))))
    if elements and chance.random() < 0.6:
        return _attribute_change(chance, root, chance.choice(elements))
    element = next(one for one in root.iter(etree.Element) if one.get("fuzz") == str(number))
    label = _label(element)
    others = [int(one.get("fuzz")) for one in root.iter(etree.Element)]
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
    return Change(f"{label} {what}", apply)


def _label(element: Any) -> str:
    return "/".join(
        f"{one.tag} {one.get('name', '')}".strip()
        for one in (*reversed(list(element.iterancestors())), element)
    )[-60:]


def _attribute_change(chance: Random, root: Any, element: Any) -> Change:
    key = chance.choice([one for one in element.attrib if one != "fuzz"])
    number, old, roll = int(element.get("fuzz")), element.get(key), chance.random()
    label = f"{_label(element)} {key}"
    if roll < 0.1:
        return Change(
            f"{label} lost", lambda work: _with(work, number, lambda one: one.attrib.pop(key, None))
        )
    if roll < 0.2:
        name = misspelt(chance, key)
        return Change(
            f"{label} called {name!r}",
            lambda work: _with(work, number, lambda one: one.set(name, one.attrib.pop(key, ""))),
        )
    value, wrong = _value(chance, root, key, old)
    return Change(
        f"{label} = {value[:80]!r}",
        lambda work: _with(work, number, lambda one: one.set(key, value)),
        wrong and element.tag == "inertia",
    )


def _value(chance: Random, root: Any, key: str, old: str) -> tuple[str, bool]:
    """Return another value for an attribute, and whether it must be refused where it is a number."""
    words = old.split()
    if not all(_is_number(word) for word in words) or not words:
        names = [one.get("name") for one in root.iter() if one.get("name")]
        pool = (
            *names,
            *_TYPES,
            *ODD_TEXTS,
            misspelt(chance, old),
            "world",
            "package://x/y.stl",
            "file:///no.obj",
        )
        return chance.choice(pool), False
    roll = chance.random()
    if roll < 0.6:
        value = odd_number(chance)
        words[chance.randrange(len(words))] = str(value) if abs(value) < 10**400 else "9" * 5000
    elif roll < 0.75:
        words = words * 2 if chance.random() < 0.5 else words[1:]
    else:
        words[chance.randrange(len(words))] = chance.choice(ODD_TEXTS)
    value = " ".join(words)
    finite = [_is_number(word) and bool(np.isfinite(float(word))) for word in value.split()]
    return value, key in _NUMBERS and (len(finite) != 1 or not all(finite))


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _with(work: _Work, number: int, act: Callable[[Any], Any]) -> None:
    element = work.at(number)
    if element is not None:
        _try(lambda: act(element))


def _try(act: Callable[[], Any]) -> None:
    """Do what lxml may refuse to write, a control character or a name that is none."""
    try:
        act()
    except (ValueError, TypeError):
        pass
