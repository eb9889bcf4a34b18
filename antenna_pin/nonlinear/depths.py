"""How far contacts open along displacements; coordinates of which all but one each leave depths as they are.

Next to where a contact begins the derivative of its force over the depth is as large as one likes, and what
it is multiplied by next to nothing: the sum of all coordinates' parts of the depth. It is that to round-off
if it is taken as one number, and not as the sum of products of which each is large and differentiated by
itself.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.differences import WEIGHTS
from antenna_pin.base.records import CONTACT
from antenna_pin.engine import Tangents
from antenna_pin.nonlinear.frames import CLOCK, Frame, Units
from antenna_pin.nonlinear.near import STEP, Function, Near

__all__ = ["Depths"]

Array = NDArray[np.float64]

# Steps of differences of what is smooth on the scale of a play, over it, and over a parameter's; and how much
# finer they are tried, as often at most, where the scale is another, as that of a tilt that is next to none.
_STEP, _OF_NUMBERS = 1e-3, 1e-2
_FINER, _OFTEN, _PART = 10.0, 3, 1e-8  # the last: what parts two orders then, over the largest derivative
_ROUND_OFF = 4.0 * float(np.finfo(float).eps)
# Part of a row's largest number that must be left of it beside those before: else it says nothing new.
_NEW = 1e-3


class Depths:
    """Differentiates what goes with where joints are in their play: with steps far coarser than forces'.

    Args:
        near: Evaluates it at displaced states.
        units: Of displacements.

    Attributes:
        tangents: Know the derivatives of what is met at contacts; None where differences have to do.
    """

    def __init__(self, near: Near, units: Units) -> None:
        """Keep how fine steps must be."""
        self._near, self._coarse = near, near.coarseness(units, _STEP)
        *_, speeds, masses, _, _, clock = near.parts
        self._coarse[speeds] = self._coarse[masses] = 1.0 / STEP
        self._coarse[clock] = 1.0 / (STEP * CLOCK)
        self._table = np.zeros(len(near.workspace.table), CONTACT)
        self.tangents: Tangents | None = None
        joints = near.system.clearances
        self._of_points = [joint.load == "point" for joint in joints for _ in joint.contact_names]
        self._over_numbers = np.eye(len(self._coarse))[:, near.parts[-3]]

    def known_at(self, c: int) -> Tangents | None:
        """Return what knows what is met at a contact; None where it is not known, as of distributed load."""
        return self.tangents if self._of_points[c] else None

    def along(self, function: Function, time: float, y: Array, ways: Array) -> Array:
        """Return the derivatives of a function along displacements of any size, (values, k).

        Args:
            function: ``(time, y) -> values``, smooth on the scale of a play.
            time: [s].
            y: State.
            ways: By columns, (displacement, k).
        """
        return np.asarray(self.of_orders(function, time, y, ways, self.steps(ways))[0])

    def both(self, function: Function, time: float, y: Array, ways: Array) -> Array:
        """Return derivatives of what may be smooth on a finer scale only, and others that tell their doubt.

        As :meth:`along`; (2, values, k).
        """
        steps, noise = self.steps(ways), _ROUND_OFF * np.abs(function(time, y))[:, None]
        found = self.of_orders(function, time, y, ways, steps)
        off, rough = np.abs(found[0] - found[1]), np.arange(len(steps))
        good = _PART * np.abs(found[0]).max(axis=1, keepdims=True, initial=0.0)
        for _ in range(_OFTEN):
            # Finer ones serve where what parts two orders is more than round-off is by these.
            rough = rough[(off > np.maximum(good, noise * _FINER / steps))[:, rough].any(axis=0)]
            if not len(rough):
                break
            steps[rough] /= _FINER
            again = self.of_orders(function, time, y, ways[:, rough], steps[rough])
            rest = np.abs(again[0] - again[1])
            better = rest < off[:, rough] / _FINER**2  # which round-off that is there by chance is hardly
            found[:, :, rough] = np.where(better, again, found[:, :, rough])
            off[:, rough] = np.minimum(rest, off[:, rough])
        return found

    def steps(self, ways: Array) -> Array:
        """Return the steps of such differences, (k,)."""
        sizes = np.abs(self._coarse[:, None] * ways).max(axis=0, initial=0.0)
        return np.asarray(1.0 / np.where(sizes > 0.0, sizes, 1.0))

    def of_orders(self, function: Function, time: float, y: Array, ways: Array, steps: Array) -> Array:
        """Return derivatives of sixth and of fourth order by given steps, (2, values, k)."""
        out = np.zeros((len(WEIGHTS), len(function(time, y)), ways.shape[1]))
        for k, (way, step) in enumerate(zip(ways.T, steps.tolist(), strict=True)):
            if way.any():
                out[:, :, k] = self._near.over(function, time, y, way, step)
        return out

    def over_numbers(self, y: Array, c: int) -> Array:
        """Return how far a contact's gap opens with each parameter, (parameters,) [m]."""
        near, numbers = self._near, self._near.numbers
        assert numbers is not None
        if (known := self.known_at(c)) is not None:
            return known.opening(y, c, self._over_numbers)

        def gap(displaced: Array) -> float:
            back = numbers.displace(displaced)
            try:
                return near.workspace.along_normal(y, c)[1]
            finally:
                back()

        here, out = near.workspace.along_normal(y, c)[1], np.zeros(numbers.count)
        for k, way in enumerate(_OF_NUMBERS * np.eye(numbers.count)):
            far = gap(3.0 * way)
            if far == here:
                continue  # most numbers are none of a contact's geometry, and do not move it by a bit
            ahead = np.array([gap(way), gap(2.0 * way), far])
            behind = np.array([gap(-j * way) for j in (1.0, 2.0, 3.0)])
            out[k] = WEIGHTS[0] @ (ahead - behind) / _OF_NUMBERS
        return out

    def opening(self, y: Array, c: int, ways: Array) -> tuple[Array, float]:
        """Return how far a contact's gap opens along displacements, (k,), and per second.

        Args:
            y: State.
            c: Which contact.
            ways: Displacements, (displacement, k).
        """
        near = self._near
        normal, _ = near.workspace.along_normal(y, c)
        own = normal @ ways[near.parts[0]]
        if near.numbers is not None:
            own = own + self.over_numbers(y, c) @ ways[near.parts[-3]]
        nq = near.system.model.nq
        return own, float(normal @ y[nq : nq + near.system.model.nv])

    def impact(self, time: float, y: Array, c: int, ways: Array) -> tuple[Array, Array]:
        """Return how what is remembered of an onset changes along displacements, (2, k) each.

        That is the approach speed [m/s], and the logarithm of the effective mass; by what parts the two rows
        of each it is in doubt.

        Args:
            time: [s].
            y: State of the onset.
            c: Which contact begins.
            ways: Displacements, (displacement, k).
        """
        if (known := self.known_at(c)) is not None:
            faster, heavier = known.impact(y, c, ways)
            return np.array([faster, faster]), np.array([heavier, heavier])
        workspace, (_, rate, *_) = self._near.workspace, self._near.parts
        own = slice(rate.start, self._near.parts[4].stop)
        # Masses do not go with velocities, rates do by the normal: neither need be differentiated over them.
        placed = ways.copy()
        placed[own] = 0.0

        def met(_: float, state: Array) -> Array:
            workspace.locate(state, self._table)
            return np.array([self._table["rate"][c], np.log(workspace.effective_mass(state, c))])

        faster, heavier = self.both(met, time, y, placed).transpose(1, 0, 2)
        return faster - workspace.along_normal(y, c)[0] @ ways[rate], heavier

    def level(self, frame: Frame, y: Array, up: Array) -> Array | None:
        """Return in what basis rates are differentiated next to where contacts begin or end, (size, size).

        Args:
            frame: Axes of coordinates; there is no such basis if time is none of these.
            y: State.
            up: Displacements of coordinates, (displacement, size).
        """
        workspace = self._near.workspace
        touching = np.flatnonzero(workspace.memory["touching"]).tolist()
        if not (frame.clock and touching):
            return None
        gaps = [(-workspace.along_normal(y, c)[1], c) for c in touching]
        return _level([self.opening(y, c, up)[0] for _, c in sorted(gaps)], frame.ways)


def _level(rows: Sequence[Array], ways: int) -> Array:
    """Return the basis, by columns, (size, size).

    Args:
        rows: Derivatives of gaps over coordinates, the shallowest first, (size,) each.
        ways: Among how many coordinates, the first ones, that one is chosen which changes a gap.
    """
    basis = np.eye(len(rows[0]))
    taken: list[int] = []
    for row in rows:
        here = row @ basis
        among = np.abs(here[:ways])
        among[taken] = 0.0
        one = int(np.argmax(among))
        if among[one] <= _NEW * np.abs(row[:ways]).max():
            continue
        share = here / here[one]
        share[one] = 0.0
        basis -= np.outer(basis[:, one], share)
        taken.append(one)
    return basis
