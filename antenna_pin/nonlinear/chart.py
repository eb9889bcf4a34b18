"""Coordinates about a state: how far neighbours are from it, in one list of plain numbers."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.constraints import Constraints, directions
from antenna_pin.dynamics import System, Workspace
from antenna_pin.errors import InvalidParameterError
from antenna_pin.settings import ErrorScales
from antenna_pin.simulation.run import check_sizes
from antenna_pin.simulation.scales import scale_vector
from antenna_pin.state import State

__all__ = ["Chart", "NotAlikeError", "OutOfReachError"]

Array = NDArray[np.float64]

# Newton's steps onto closures; residuals over the length of their plan at which it is there, and with which a
# state counts as closed: those of a run's own corrections.
_ROUNDS, _CLOSED, _OPEN = 25, 1e-14, 1e-11
# Of what rows of constraints do, over the most: what does less is what round-off has left of redundant ones.
_FAINT = 1e-10


class NotAlikeError(InvalidParameterError):
    """Two states whose distance is none of numbers: other contacts touch."""


class OutOfReachError(InvalidParameterError):
    """Coordinates at which closures cannot hold, or not by a way that Newton's method finds."""


class Chart:
    """Coordinates about a state: what may differ between it and a neighbour, (size,).

    They are the freedoms that closures and motions leave, each in units of the run's error scales: ways
    first, then their rates; bristles; and of each contact that touches the logarithm of the approach speed
    that it remembers, which is a state too: a neighbour keeps its own. What is integrated and acts on nothing
    (works, impulses) is none of them, and neither are whole turns.

    Coordinates are components along the freedoms, of the way from the origin and of the change of velocity.
    Across them a neighbour is where closures and motions want it, so that those it is asked for at are those
    it has: a tangent-space parametrisation of the constraint manifold (Potra and Yen 1991, Mechanics of
    Structures and Machines 19, 77-98).

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
        # Joints whose turn is a cosine and a sine: alone, or behind the two ways of a plane.
        self._circles = [
            (slice(joint.idx_q, joint.idx_q + joint.nq), slice(joint.idx_v, joint.idx_v + joint.nv))
            for joint in list(system.model.joints)[1:]
            if (joint.nq, joint.nv) == (2, 1) or joint.shortname() == "JointModelPlanar"
        ]
        self._free, self._bound = self._freedoms()
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

    def _freedoms(self) -> tuple[Array, Array]:
        """Return what constraints leave of the ways, and what not, in units of these, by columns."""
        nv, state, constraints = self.system.model.nv, self.origin, self._workspace.constraints
        if constraints is None:
            return np.eye(nv), np.zeros((nv, 0))
        left = directions(constraints, state.y, self._workspace.program, motions=True)
        ways = np.linalg.svd(left / self._way[:, None])[0]
        free = left.shape[1]
        return np.ascontiguousarray(ways[:, :free]), np.ascontiguousarray(ways[:, free:])

    def state(self, z: Array, system: System | None = None) -> State:
        """Return the neighbour at coordinates z, (size,): on the constraints, at the origin's time.

        Args:
            z: Coordinates.
            system: On whose closures and motions, if not those of the chart's own system: another of the same
                shape, so that states of systems that differ by a parameter have coordinates in one chart.

        Raises:
            OutOfReachError: Closures cannot hold there.
            InvalidParameterError: The system is of another shape.
        """
        model, origin = self.system.model, self.origin
        n, nq, nv = self.ways, model.nq, model.nv
        y = origin.y
        way = self._free @ z[:n]
        y[:nq] = pin.integrate(model, origin.q, self._way * way)
        y[nq : nq + nv] += self._rate * (self._free @ z[n : 2 * n])
        bristles = 2 * n + len(self._bristles)
        y[nq + nv + self._bristles] += self._bristle_units * z[2 * n : bristles]
        workspace = self._workspace
        if system is not None and system is not self.system:
            check_sizes(system, origin)
            workspace = Workspace(system)
        if workspace.constraints is not None:
            self._close(workspace, workspace.constraints, y, way)
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

    def _close(self, workspace: Workspace, constraints: Constraints, y: Array, way: Array) -> None:
        """Bring a state onto constraints, in place, across the freedoms only.

        Args:
            workspace: Of the system whose constraints they are.
            constraints: Its.
            y: State, its configuration a way from the origin.
            way: That way, in units, (nv,).
        """
        model, time, length = self.system.model, self.origin.time, constraints.plan.length
        nq, nv, bound = model.nq, model.nv, self._bound
        last = math.inf
        for _ in range(_ROUNDS):
            workspace.prepare_motions(time, y)
            found = constraints.residuals(time, y, workspace.program)
            now = max(found.gap, found.turn * length)
            # At round-off it comes no nearer. If that is before, the next step may lead anywhere, such as to
            # where the loop is closed in another way.
            if now <= _CLOSED * length or not now < last:
                break
            last = now
            moved = pin.dIntegrate(model, self.origin.q, self._way * way, pin.ArgumentPosition.ARG1)
            rows = constraints.jacobian @ moved @ (self._way[:, None] * bound)
            way = way - bound @ np.linalg.lstsq(rows, constraints.gap, rcond=_FAINT)[0]
            y[:nq] = pin.integrate(model, self.origin.q, self._way * way)
        if not now <= _OPEN * length:
            rule = "so near that closures hold there; take a smaller step"
            raise OutOfReachError("chart", "coordinates", rule, said=f"{now:.1g} m off them")
        rows = constraints.jacobian @ (self._rate[:, None] * bound)
        v = np.linalg.lstsq(rows, constraints.speed, rcond=_FAINT)[0]
        y[nq : nq + nv] -= self._rate * (bound @ v)

    def turned(self, z: Array, other: Chart) -> Array:
        """Return a direction in coordinates of another chart, (its size,), as one in this, (size,).

        What constraints leave has axes of its own in each state. Both are of one system or of systems of the
        same shape, and the same contacts touch in both.
        """
        n = other.ways
        way = other._way * (other._free @ z[:n]) / self._way
        rate = other._rate * (other._free @ z[n : 2 * n]) / self._rate
        return np.concatenate([self._free.T @ way, self._free.T @ rate, z[2 * n :]])

    def directions(self, v: Array, a: Array) -> Array:
        """Return a velocity and an acceleration, (nv,) each, as a direction in coordinates, (size,)."""
        rest = np.zeros(self.size - 2 * self.ways)
        return np.concatenate([self._free.T @ (v / self._way), self._free.T @ (a / self._rate), rest])

    def _way_to(self, q: Array) -> Array:
        """Return the way from the origin to a configuration, (nv,): what ``pin.integrate`` makes go there.

        Pinocchio's own has no turns of 1e-8 rad and less where joints turn without end or move in a plane,
        and in a plane has ways by 1 - cos of the turn.
        """
        here = self.origin.q
        way: Array = pin.difference(self.system.model, here, q)
        for of_q, of_v in self._circles:
            (c, s), (cosine, sine) = here[of_q][-2:], q[of_q][-2:]
            turn = math.atan2(c * sine - s * cosine, c * cosine + s * sine)
            way[of_v.stop - 1] = turn
            if of_v.stop - of_v.start == 3:
                x, y = (q - here)[of_q][:2]
                x, y = c * x + s * y, c * y - s * x
                half = 0.5 * turn
                share = half / math.tan(half) if half != 0.0 else 1.0
                way[of_v][:2] = share * x + half * y, share * y - half * x
        return way

    def coordinates(self, state: State) -> Array:
        """Return where a state near the origin is, (size,); of another time as if it were of this one.

        Raises:
            NotAlikeError: Other contacts touch in it.
        """
        origin = self.origin
        if not np.array_equal(state.memory[:, 0] != 0.0, origin.memory[:, 0] != 0.0):
            names = np.array(self.system.contact_names)
            touching = ", ".join(names[state.memory[:, 0] != 0.0]) or "none"
            here = ", ".join(names[self._touching]) or "none"
            raise NotAlikeError("chart", "contacts that touch", f"those of the origin ({here})", touching)
        ways = self._free.T @ (self._way_to(state.q) / self._way)
        rates = self._free.T @ ((state.v - origin.v) / self._rate)
        bristles = (state.x - origin.x)[self._bristles] / self._bristle_units
        speeds = np.log(state.memory[self._touching, 1] / origin.memory[self._touching, 1])
        return np.concatenate([ways, rates, bristles, speeds])
