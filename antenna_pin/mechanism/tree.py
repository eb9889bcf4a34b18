"""Tree of moving bodies in numbers, and its compiled dynamics checked against Pinocchio."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.records import CIRCLE, FIXED_AXIS, PLANE, RIGID, ROTATION, SLIDE
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import tree_kernels as _bodies
from antenna_pin.mechanism.dynamics_kernels import aba
from antenna_pin.mechanism.inertia import idle_joint, mass_matrix
from antenna_pin.mechanism.mass_kernels import mass_and_bias
from antenna_pin.mechanism.model import Mechanism
from antenna_pin.mechanism.room_kernels import ROOM
from antenna_pin.mechanism.spatial_kernels import CHANGE
from antenna_pin.mechanism.tangent_kernels import (
    LANES,
    prepare_changes,
    solve_tree,
    subtract_wrenches,
    write_changes,
)
from antenna_pin.mechanism.tree_kernels import BODY, PLACE, bias_accelerations, place_bodies

__all__ = [
    "BODY",
    "body_tree",
    "CHANGE",
    "freedoms_below",
    "LANES",
    "PLACE",
    "ROOM",
    "TreeDynamics",
]

# --- tree ---------------------------------------------------------------------------------------------------

_KINDS = {
    "revolute": FIXED_AXIS,
    "continuous": CIRCLE,
    "prismatic": SLIDE,
    "floating": RIGID,
    "spherical": ROTATION,
    "planar": PLANE,
}

_FREEDOMS = {RIGID: 6, ROTATION: 3, PLANE: 3}


@takes()
def body_tree(mechanism: Mechanism) -> NDArray[Any]:
    """Return the moving bodies as the kernels take them, (bodies,) of ``BODY``; parents first."""
    model = mechanism.model
    kinds = {slot.joint_id: (_KINDS[slot.kind], slot.axis) for slot in mechanism.joints.values()}
    free = mechanism.base == "free"
    if free:
        kinds[1] = (RIGID, np.zeros(3))
    tree = np.zeros(model.njoints - 1, dtype=_bodies.BODY)
    for i, body in enumerate(tree, start=1):
        placement, inertia = model.jointPlacements[i], model.inertias[i]
        if kinds[i][0] in (FIXED_AXIS, CIRCLE):
            body["armature"] = model.armature[model.idx_vs[i]]
        body["parent"] = model.parents[i] - 1
        body["kind"], body["axis"] = kinds[i]
        body["q"], body["v"] = model.idx_qs[i], model.idx_vs[i]
        body["counts"] = not (free and i == 1)
        body["rotation"], body["position"] = placement.rotation, placement.translation
        body["mass"], body["centre"], body["inertia"] = inertia.mass, inertia.lever, inertia.inertia
    return tree


@takes()
def freedoms_below(tree: NDArray[Any]) -> NDArray[np.int64]:
    """Return the next freedom towards the root of each one, -1 without one, (nv,).

    Args:
        tree: Bodies, parents first, ``BODY``, (bodies,).
    """
    below: list[int] = []
    last: list[int] = []
    for body in tree:
        under = last[body["parent"]] if body["parent"] >= 0 else -1
        count = _FREEDOMS.get(int(body["kind"]), 1)
        below += [under, *range(len(below), len(below) + count - 1)]
        last.append(len(below) - 1)
    return np.array(below, dtype=np.int64)


# --- dynamics -----------------------------------------------------------------------------------------------

Array = NDArray[np.float64]

#: Deviation from Pinocchio at most, over the largest number: round-off of chains of 64 is 1e-3 of it.
AGREEMENT = 1e-11
_STATES = 4
#: Models compared last, with their trees: runs of a study share one.
_compared: deque[tuple[Any, bytes]] = deque(maxlen=4)


class TreeDynamics:
    """A mechanism's tree in numbers, as compiled code takes it, with gravity.

    The numbers come from the Pinocchio model. At random states mass matrix and the force of gravity and
    velocities are compared with ``pin.crba`` and ``pin.nonLinearEffects``, and accelerations with what both
    say that they take.

    Args:
        mechanism: Whose bodies move.

    Attributes:
        tree: Bodies, parents first, :data:`antenna_pin.mechanism.BODY`, (bodies,); not to be written to.
        gravity: In world axes [m/s^2], (3,); not to be written to.
        nq: Size of the configuration.
        nv: Size of the generalized velocity.

    Raises:
        MechanismError: Where the numbers differ by more than ``AGREEMENT``, relative.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        """Take the numbers over and compare them with Pinocchio's."""
        self.tree = body_tree(mechanism)
        self.gravity: Array = np.array(mechanism.model.gravity.linear)
        self.nq, self.nv = int(mechanism.model.nq), int(mechanism.model.nv)
        tree, model = self.tree.tobytes(), mechanism.model
        if any(tree == other and model == compared for compared, other in tuple(_compared)):
            return
        for what, deviation in self._deviations(model).items():
            if not deviation <= AGREEMENT:  # not a number fails too
                raise MechanismError(
                    f"mechanism {mechanism.name!r}: {what} of the compiled tree must be Pinocchio's to "
                    f"{AGREEMENT:g} relative, got a deviation of {deviation:.1e}; the model is not one that "
                    "the compiled dynamics can take, so run it on Pinocchio's"
                )
        _compared.append((model, tree))

    def room(self) -> NDArray[Any]:
        """Return the workspace of the kernels, ROOM, (bodies + 1,)."""
        return np.zeros(len(self.tree) + 1, ROOM)

    def acceleration(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike) -> Array:
        """Return the acceleration under a generalized force, (nv,): each joint's, in its own child axes."""
        found = np.zeros(self.nv)
        force = np.array(tau, dtype=float)
        aba(self._state(q, v), self.nq, self.tree, self.gravity, force, self.room(), found)
        return found

    def acceleration_changes(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, ways: ArrayLike) -> Array:
        """Return the derivatives of the acceleration along displacements, (nv, k).

        Args:
            q: Configuration, (nq,).
            v: Velocity, (nv,).
            tau: Generalized force, (nv,).
            ways: Displacements of the configuration, in the coordinates of velocities, of the velocity and
                of the force, (3 nv, k).
        """
        along = np.ascontiguousarray(np.asarray(ways, dtype=float).T)
        nv, force = self.nv, np.array(tau, dtype=float)
        places, bodies = np.zeros(len(self.tree) + 1, PLACE), np.zeros(len(self.tree), CHANGE)
        mass, below = np.zeros((nv, nv)), freedoms_below(self.tree)
        scratch = places, self.room(), mass, np.zeros(nv)
        prepare_changes(self._state(q, v), self.nq, (self.tree, below), self.gravity, force, scratch, bodies)
        out = along[:, 2 * nv :].copy()
        for way, change in zip(along, out, strict=True):
            write_changes(way, nv, self.tree, places, self.gravity, bodies)
            subtract_wrenches(self.tree, places, bodies, change)
            solve_tree(mass, below, change)
        return np.asarray(out.T)

    def mass_and_bias(self, q: ArrayLike, v: ArrayLike) -> tuple[Array, Array]:
        """Return the mass matrix, (nv, nv), and the generalized force of gravity and velocities, (nv,)."""
        mass, bias = np.zeros((self.nv, self.nv)), np.zeros(self.nv)
        places = np.zeros(len(self.tree) + 1, PLACE)
        place_bodies(self._state(q, v), self.nq, self.tree, places)
        bias_accelerations(self.tree, places)
        mass_and_bias(self.tree, places, self.gravity, self.room(), mass, bias)
        return mass, bias

    def _state(self, q: ArrayLike, v: ArrayLike) -> Array:
        return np.concatenate([np.asarray(q, dtype=float), np.asarray(v, dtype=float)])

    def _deviations(self, model: Any) -> dict[str, float]:
        """Return the largest deviations at random states, by what deviates, relative to the largest number.

        Accelerations count by the forces that they take, M a: of a thin rod about its own axis, which has
        next to no inertia, none are certain to more than that, and ``pin.aba``'s not to that. A tree that is
        regular by its couplings alone has none: constraints solve by its mass matrix.
        """
        data, rng = model.createData(), np.random.default_rng(0)
        worst = {"accelerations": 0.0, "mass matrix": 0.0, "forces of gravity and velocities": 0.0}
        for _ in range(_STATES):
            q = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv))
            v = rng.normal(size=model.nv)
            mass = mass_matrix(model, data, q)
            bias = np.array(pin.nonLinearEffects(model, data, q, v))
            wanted = mass @ rng.normal(size=model.nv)
            own_mass, own_bias = self.mass_and_bias(q, v)
            lacks = _over(mass @ self.acceleration(q, v, wanted + bias) - wanted, np.append(wanted, bias))
            if not lacks <= AGREEMENT and idle_joint(model, q) is not None:
                lacks = 0.0
            ratios = (
                lacks,
                _over(own_mass - mass, mass),
                _over(own_bias - bias, np.append(wanted, bias)),
            )
            # Unlike max() it keeps what is not a number.
            worst = {what: float(np.maximum(worst[what], r)) for what, r in zip(worst, ratios, strict=True)}
        return worst


def _over(deviation: Array, whole: Array) -> float:
    """Return the largest deviation over the largest number of the whole."""
    return float(np.abs(deviation).max() / np.abs(whole).max())
