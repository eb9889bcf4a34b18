"""Coordinates about a state: how far neighbours are from it, in one list of plain numbers."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.dynamics import System, Workspace
from antenna_pin.errors import InvalidParameterError
from antenna_pin.settings import ErrorScales
from antenna_pin.simulation.scales import scale_vector
from antenna_pin.state import State

__all__ = ["Chart", "NotAlikeError"]

Array = NDArray[np.float64]

# What is left of a direction below which constraints leave nothing of it.
_HELD = 1e-9


class NotAlikeError(InvalidParameterError):
    """Two states whose distance is none of numbers: other contacts touch."""


class Chart:
    """Coordinates about a state: what may differ between it and a neighbour, (size,).

    They are the freedoms that closures and motions leave, each in units of the run's error scales: ways
    first, then their rates; bristles; and of each contact that touches the logarithm of the approach speed
    that it remembers, which is a state too: a neighbour keeps its own. What is integrated and acts on nothing
    (works, impulses) is none of them, and neither are whole turns.

    Args:
        system: Whose state it is.
        state: The origin.
        scales: What counts as one unit of each kind of quantity.

    Attributes:
        names: Of the coordinates.
        ways: How many of them are ways, and as many rates.
    """

    def __init__(self, system: System, state: State, scales: ErrorScales | None = None) -> None:
        """Find the freedoms."""
        self.system, self.origin = system, state
        nv = system.model.nv
        units = scale_vector(system, scales or ErrorScales())
        self._way, self._rate = units[:nv], units[nv : 2 * nv]
        self._workspace = Workspace(system)
        for place, value in state.adjusted:
            raise InvalidParameterError(
                "chart", "state", "one whose drives and springs no event has changed", (place, value)
            )
        self._free = self._freedoms()
        self._bristles = np.asarray(system.bristle_x, dtype=int)
        self._bristle_units = units[2 * nv + self._bristles]
        self._touching = np.flatnonzero(state.memory[:, 0] != 0.0)
        self.ways = self._free.shape[1]
        contacts = system.contact_names
        self.names = (
            *self._names("way"),
            *self._names("rate"),
            *(f"bristle {k + 1}" for k in range(len(self._bristles))),
            *(f"{contacts[c]} approach speed" for c in self._touching),
        )

    @property
    def size(self) -> int:
        """How many coordinates there are."""
        return len(self.names)

    def _names(self, what: str) -> list[str]:
        model, free = self.system.model, self._free
        if free.shape[1] < model.nv:
            return [f"{what} {k + 1}" for k in range(free.shape[1])]
        names = []
        for j in range(1, model.njoints):
            joint = model.joints[j]
            names += [
                f"{model.names[j]} {what}" + (f" {k + 1}" if joint.nv > 1 else "") for k in range(joint.nv)
            ]
        return names

    def _freedoms(self) -> Array:
        """Return what constraints leave of the ways, in units of these, by columns at right angles."""
        nv, state, constraints = self.system.model.nv, self.origin, self._workspace.constraints
        if constraints is None:
            return np.eye(nv)
        self._workspace.prepare_motions(state.time, state.y)
        constraints.residuals(state.time, state.y, self._workspace.program)
        rows = constraints.jacobian * self._way
        lengths = np.linalg.norm(rows, axis=1, keepdims=True)
        _, values, ways = np.linalg.svd(rows / np.where(lengths > 0.0, lengths, 1.0))
        return np.ascontiguousarray(ways[int(np.count_nonzero(values > _HELD)) :].T)

    def state(self, z: Array) -> State:
        """Return the neighbour at coordinates z, (size,): on the constraints, at the origin's time."""
        model, origin = self.system.model, self.origin
        n, nq, nv = self.ways, model.nq, model.nv
        y = origin.y
        y[:nq] = pin.integrate(model, origin.q, self._way * (self._free @ z[:n]))
        y[nq : nq + nv] += self._rate * (self._free @ z[n : 2 * n])
        bristles = 2 * n + len(self._bristles)
        y[nq + nv + self._bristles] += self._bristle_units * z[2 * n : bristles]
        if self._workspace.constraints is not None:
            self._workspace.hold(origin.time, y)
        memory = origin.memory.copy()
        memory[self._touching, 1] *= np.exp(z[bristles:])
        speeds = memory[:, 1]
        contacts = tuple(
            dataclasses.replace(one, approach_speed=float(speeds[one.contact])) for one in origin.contacts
        )
        return dataclasses.replace(
            origin,
            reached=origin.time,
            q=y[:nq].copy(),
            v=y[nq : nq + nv].copy(),
            x=y[nq + nv :].copy(),
            memory=memory,
            contacts=contacts,
        )

    def directions(self, v: Array, a: Array) -> Array:
        """Return a velocity and an acceleration, (nv,) each, as a direction in coordinates, (size,)."""
        rest = np.zeros(self.size - 2 * self.ways)
        return np.concatenate([self._free.T @ (v / self._way), self._free.T @ (a / self._rate), rest])

    def coordinates(self, state: State) -> Array:
        """Return where a state near the origin is, (size,); of another time as if it were of this one.

        Raises:
            NotAlikeError: Other contacts touch in it.
        """
        model, origin = self.system.model, self.origin
        if not np.array_equal(state.memory[:, 0] != 0.0, origin.memory[:, 0] != 0.0):
            names = np.array(self.system.contact_names)
            touching = ", ".join(names[state.memory[:, 0] != 0.0]) or "none"
            here = ", ".join(names[self._touching]) or "none"
            raise NotAlikeError("chart", "contacts that touch", f"those of the origin ({here})", touching)
        ways = self._free.T @ (pin.difference(model, origin.q, state.q) / self._way)
        rates = self._free.T @ ((state.v - origin.v) / self._rate)
        bristles = (state.x - origin.x)[self._bristles] / self._bristle_units
        speeds = np.log(state.memory[self._touching, 1] / origin.memory[self._touching, 1])
        return np.concatenate([ways, rates, bristles, speeds])
