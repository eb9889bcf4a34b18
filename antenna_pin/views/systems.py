"""What a system shows of itself: its joints, what acts on it, what holds it, and the numbers of its state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from antenna_pin.base.readable import readable
from antenna_pin.views._card import Card, Fact, Fold, table

if TYPE_CHECKING:
    from antenna_pin.dynamics import System

__all__ = ["system_card"]

_NAMES = 12  # of things of a kind
_ROWS = 60  # of a table


def system_card(system: System) -> Card:
    """Return what a system is: its mechanism, joints by kind, elements by family, and its state."""
    mechanism, model = system.mechanism, system.model
    joints = dict(_joints(system))
    mass = float(sum(one.mass for one in model.inertias))
    nx = system.manifold.nx
    facts = [
        Fact("base", f"{mechanism.base}; {readable(mass, 'kg')} in all"),
        Fact("state", f"{model.nq} numbers of configuration, {model.nv} of velocity, {nx} integrated"),
        Fact("joints", _by_kind(joints)),
        *(Fact(family, _by_kind(kinds)) for family, kinds in _acting(system)),
    ]
    places = [(name, slot.q, slot.v) for name, slot in mechanism.joints.items()]
    if mechanism.base == "free":
        places.insert(0, ("base", mechanism.base_q, mechanism.base_v))
    rows = [
        [name, joints.get(name, "free"), ", ".join(system.names_q[q]), ", ".join(system.names_v[v])]
        for name, q, v in places
    ]
    more = f"first {_ROWS} of {len(rows)}" if len(rows) > _ROWS else "names of q and v"
    folds = (Fold("coordinates", more, table(rows[:_ROWS], ("", "", "configuration", "velocity"))),)
    return Card("System of", mechanism.name, tuple(fact for fact in facts if fact.text), folds)


def _joints(system: System) -> Iterator[tuple[str, str]]:
    """Yield what each joint is: with play, held, on a bearing, or of the tree."""
    play = {joint.name: type(joint.geometry).__name__ for joint in system.clearances}
    for name, slot in system.mechanism.joints.items():
        if name in play:
            yield name, f"with play, {play[name]}"
        elif name in system.held:
            yield name, f"{system.held[name]}, held by constraint"
        elif name in system.elastic:
            yield name, "elastic part"
        else:
            yield name, "on a bearing" if name in system.on_bearings else str(slot.kind)


def _acting(system: System) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield what acts on joints and links, by family, and what holds them: names and kinds."""
    for family, elements in system.families.items():
        yield (
            family,
            {name: type(one).__name__ for name, one in elements.items() if name not in system.elastic},
        )
    loops = {name: str(one.kind) for name, one in system.closures.items() if name not in system.held}
    yield "closures", loops
    yield "couplings", dict.fromkeys(system.couplings, "")


def _by_kind(kinds: Mapping[str, str]) -> str:
    """Return names, those of a kind together: "root, first (Latch)"."""
    names: dict[str, list[str]] = {}
    for name, kind in kinds.items():
        names.setdefault(kind, []).append(name)
    return "; ".join(f"{_few(some)}{f' ({kind})' if kind else ''}" for kind, some in names.items())


def _few(names: list[str]) -> str:
    left = len(names) - _NAMES
    return ", ".join(names) if left <= 0 else f"{', '.join(names[:_NAMES])} and {left} more"
