"""Where the ledger of a run opened: the first sample, what happened there, and what changed most."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.simulation.loop import Run

__all__ = ["First", "Opening", "Trail", "entries_of", "events_between"]

Array = NDArray[np.float64]
Values = Mapping[str, Any]


class Opening(NamedTuple):
    """A ledger that does not close.

    Attributes:
        time: Of the first sample whose error is not explained [s].
        text: Which ledger, by how much it is off, and the events at that sample.
    """

    time: float
    text: str


class First(NamedTuple):
    """The first sample at which an error is larger than explained.

    Attributes:
        time: Of the sample [s].
        before: Of the sample before; NaN if there is none [s].
        error: In its unit.
        movers: Numbers of the coordinate and of the element that changed most since the sample before; -1
            for none.
    """

    time: float
    before: float
    error: float
    movers: tuple[int, ...]


class Trail:
    """Samples at which an error grew beyond all before, and beyond what was known to be explained then."""

    def __init__(self) -> None:
        """Begin without a sample."""
        self._found: list[tuple[Array, Array, Array, NDArray[np.intp]]] = []
        self._largest = 0.0

    def add(self, times: Array, before: Array, errors: Array, least: float, movers: NDArray[np.intp]) -> None:
        """Keep of a block what grew beyond all before and beyond ``least``."""
        so_far = np.fmax.accumulate(np.concatenate([[max(self._largest, least)], errors]))
        grown = errors > so_far[:-1]
        self._largest = max(self._largest, float(np.fmax.reduce(errors, initial=0.0)))
        if grown.any():
            self._found.append((times[grown], before[grown], errors[grown], movers[grown]))

    def first_beyond(self, bound: float) -> First | None:
        """Return the first sample whose error is above a bound; None if there is none."""
        for times, before, errors, movers in self._found:
            if (errors > bound).any():
                k = int(np.argmax(errors > bound))
                return First(float(times[k]), float(before[k]), float(errors[k]), tuple(movers[k].tolist()))
        return None


# Events that are named where a ledger opens.
_MOST = 4


def events_between(run: Run, before: float, time: float) -> str:
    """Return what happened from one sample to the next, in words: events, changes of elements, contacts."""
    found = list(dict.fromkeys(_events(run, before, time)))
    more = f" and {len(found) - _MOST} more" if len(found) > _MOST else ""
    return (", ".join(found[:_MOST]) or "no event") + more


def _events(run: Run, before: float, time: float) -> Iterator[str]:

    # An instant may have two samples, one before and one after what happens at it.
    def here(when: float) -> bool:
        return (math.isnan(before) or when >= before) and when <= time

    for one in run.actions.happened:
        if here(one.time):
            yield f"event {one.name!r}"
    for changed in run.actions.modes.changed:
        if here(changed.time):
            yield changed.name
    for episode in run.episodes:
        name = run.system.contact_names[int(episode["contact"])]
        if here(float(episode["onset"])):
            yield f"contact {name} begins"
        if here(float(episode["release"])):
            yield f"contact {name} ends"


# Entries of the ledger that elements have, by the dimension of their names, and what stands before those.
_OWNERS = (
    ("drive", "drives.", ("drive_work",)),
    ("force", "forces.", ("force_work", "force_loss", "force_energy")),
    ("contact", "contact ", ("dissipation_normal", "dissipation_friction")),
    ("spring", "springs.", ("dissipation_damper",)),
    ("elastic_part", "elastic part ", ("elastic_energy", "dissipation_elastic")),
    ("element", "", ("element_energy", "element_loss")),
)


def entries_of(values: Values, labels: Mapping[str, Any]) -> tuple[list[str], list[Array]]:
    """Return elements with the entries that they have in the ledger, (n,) [J]; one may be named twice."""
    springs = values["spring_energy"] - values["element_energy"].sum(axis=1)
    names, columns = ["springs", "energy in contacts"], [springs, values["contact_energy"]]
    for dim, before, of in _OWNERS:
        for k, name in enumerate(labels.get(dim, ())):
            names += [f"{before}{name}"] * len(of)
            columns += [values[one][:, k] for one in of]
    return names, columns
