"""The axes of coordinates about a state: what may differ between it and a neighbour, to first order."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.settings import ErrorScales
from antenna_pin.constraints import directions
from antenna_pin.dynamics import System, Workspace
from antenna_pin.integrate import KINDS
from antenna_pin.nonlinear.kept import Kept
from antenna_pin.simulation.steps import scale_vector

__all__ = [
    "CLOCK",
    "MEMORIES",
    "Frame",
    "Lift",
    "Rates",
    "Units",
    "frame_at",
    "own_state",
    "parts_of",
    "way_between",
]

Array = NDArray[np.float64]

#: What contact memory holds besides whether a contact touches, by its column.
MEMORIES = {1: "approach speed", 2: "effective mass"}
#: What counts as one of time where it is a coordinate [s].
CLOCK = 1e-2


class Units(NamedTuple):
    """What counts as one in a displacement: the run's error scales.

    Attributes:
        way: Of the configuration, (nv,).
        rate: Of the velocity, (nv,).
        bristle: Of each bristle, (bristles,).
    """

    way: Array
    rate: Array
    bristle: Array

    @classmethod
    def of(cls, system: System, scales: ErrorScales | None = None) -> Units:
        """Return the units of a system."""
        nv, every = system.model.nv, scale_vector(system, scales or ErrorScales())
        return cls(every[:nv], every[nv : 2 * nv], every[2 * nv + np.asarray(system.bristle_x, dtype=int)])


class Frame(NamedTuple):
    """Axes of coordinates in one state.

    Attributes:
        free: What closures and motions leave of the ways, in units of these, by columns, (nv, ways).
        bound: What they do not leave, (nv, nv - ways).
        remembered: Contact and column of its memory of each coordinate that a contact's memory is.
        kept: Which numbers of elements are coordinates (:mod:`antenna_pin.nonlinear.kept`).
        clock: Whether time is one, behind ways and rates: how much later a neighbour's state is its own.
    """

    free: Array
    bound: Array
    remembered: tuple[tuple[int, int], ...]
    kept: tuple[int, ...] = ()
    clock: bool = False

    @property
    def ways(self) -> int:
        """How many coordinates are ways, and as many are rates."""
        return int(self.free.shape[1])

    @property
    def first_bristle(self) -> int:
        """Where among coordinates those of bristles begin."""
        return 2 * self.ways + int(self.clock)


class Lift(NamedTuple):
    """Coordinates about a state as displacements of one, and back.

    A displacement, (2 nv + bristles + 2 contacts + parameters + kept + 1,), is that of the configuration in
    the coordinates of velocities, of the velocity, of bristles, of the logarithms of approach speeds, of
    those of effective masses, of parameters of the system in their scales, of what elements keep, of time.
    Coordinates are ways, rates, time if it is one, bristles, parameters, what elements keep, and what
    contacts remember.

    Attributes:
        up: Displacement of each coordinate, by columns, (displacement, size).
        down: Coordinates of a displacement, (size, displacement).
    """

    up: Array
    down: Array


class Rates(NamedTuple):
    """Derivatives of rates in a state.

    Attributes:
        sixth: Of the coordinates' rates over the coordinates, by differences of sixth order, (size, size).
        fourth: The same by differences of fourth order.
        along: Of rates along one displacement, in units, (nv + bristles,).
        noise: Round-off of these.
        books: Of the rates of what is integrated over the coordinates, (nx, size).
    """

    sixth: Array
    fourth: Array
    along: Array
    noise: float
    books: Array


def parts_of(system: System, kept: int, parameters: int = 0) -> tuple[slice, ...]:
    """Return the parts of a displacement.

    They are way, rate, bristles, approach speeds, masses, parameters, kept numbers, time.

    Args:
        system: The system.
        kept: How many numbers its elements keep.
        parameters: How many of its numbers are displaced (:mod:`antenna_pin.nonlinear.numbers`).
    """
    nv, contacts = system.model.nv, len(system.contact_names)
    sizes = [nv, nv, len(system.bristle_x), contacts, contacts, parameters, kept, 1]
    ends = np.cumsum(sizes).tolist()
    return tuple(slice(end - size, end) for end, size in zip(ends, sizes, strict=True))


def own_state(
    frame: Frame, size: int, lasting: Collection[int], kept: Collection[int] = ()
) -> NDArray[np.bool_]:
    """Return which coordinates are a neighbour's own state, (size,): all but what lasting contacts remember.

    Nothing changes what a contact remembers while it lasts. Over a time over which it does, that is a
    parameter of the motion: neighbours share it. So it is of what elements keep.

    Args:
        frame: The axes; what contacts remember is behind all other coordinates, what elements keep before it.
        size: How many coordinates there are.
        lasting: Contacts that last over the time that is looked at.
        kept: Numbers of elements that nothing changes over it.
    """
    own = np.ones(size, dtype=bool)
    remembered = size - len(frame.remembered)
    for k, (contact, _) in enumerate(frame.remembered, remembered):
        own[k] = contact not in lasting
    for k, number in enumerate(frame.kept, remembered - len(frame.kept)):
        own[k] = number not in kept
    return own


def _remembered(masses: Sequence[bool], touching: Array) -> tuple[tuple[int, int], ...]:
    """Return contact and column of what the contacts that touch remember and their forces depend on.

    Args:
        masses: Of each contact, whether it goes by the effective mass that it remembers.
        touching: Of each contact, 0 or not, (contacts,).
    """
    touch = np.flatnonzero(touching).tolist()
    return tuple((c, column) for c in touch for column in ((1, 2) if masses[c] else (1,)))


def frame_at(workspace: Workspace, units: Units, y: Array, touching: Array, kept: Kept) -> Frame:
    """Return the axes of coordinates in a state.

    Args:
        workspace: To look at constraints with, and at the modes of elements.
        units: Of ways.
        y: State [q, v, x].
        touching: Of each contact, 0 or not, (contacts,).
        kept: What elements keep.
    """
    system, constraints = workspace.system, workspace.constraints
    memories, nv = _remembered(kept.masses, touching), system.model.nv
    numbers = kept.gone_by(workspace.program)
    if constraints is None:
        return Frame(np.eye(nv), np.zeros((nv, 0)), memories, numbers)
    left = directions(constraints, y, workspace.program, motions=True, holds=True)
    free = left.shape[1]
    # Where elements hold nothing at present the axes are the joints' own.
    ways = np.eye(nv) if free == nv else np.linalg.svd(left / units.way[:, None])[0]
    return Frame(
        np.ascontiguousarray(ways[:, :free]), np.ascontiguousarray(ways[:, free:]), memories, numbers
    )


def way_between(system: System, here: Array, there: Array) -> Array:
    """Return the way from one configuration to another, (nv,): what ``pin.integrate`` makes go there.

    Pinocchio's own has no turns of 1e-8 rad and less where joints turn without end or move in a plane, and in
    a plane has ways by 1 - cos of the turn.
    """
    way: Array = pin.difference(system.model, here, there)
    i = j = 0
    for kind in system.manifold.kinds:
        _, nq, nv = KINDS[kind]
        if kind in ("circle", "plane"):
            (c, s), (cosine, sine) = here[i + nq - 2 : i + nq], there[i + nq - 2 : i + nq]
            turn = math.atan2(c * sine - s * cosine, c * cosine + s * sine)
            way[j + nv - 1] = turn
            if kind == "plane":
                x, y = there[i] - here[i], there[i + 1] - here[i + 1]
                x, y = c * x + s * y, c * y - s * x
                half = 0.5 * turn
                share = half / math.tan(half) if half != 0.0 else 1.0
                way[j : j + 2] = share * x + half * y, share * y - half * x
        i, j = i + nq, j + nv
    return way
