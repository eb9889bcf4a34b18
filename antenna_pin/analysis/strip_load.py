r"""Load along the line of contact of a tilted journal, by strips.

Each strip is a plane contact.

Along the axis the journal's depth varies; a strip of the line at depth :math:`\delta(x)` carries
:math:`f(\delta)` per length. Between two nodes the depth is linear in x, so with
:math:`\Phi(\delta) = \int_0^\delta f\, d\delta` the load of a segment of length h is exactly

.. math:: \int f\, dx = h\, \frac{\Phi(\delta_2) - \Phi(\delta_1)}{\delta_2 - \delta_1},

also where only a part of it touches (:math:`\Phi = f = 0` without depth). A tilt in one plane has a linear
depth over the whole line; the nodes are for axes that cross.

- Under a distributed load the joint's own law shares the force out: :math:`f` is that law at the depths of
  the run, scaled to the recorded force. Force and moment are those of the run.
- Under point loads the law acts at the ends alone. The tilt is then the run's; how deep the line lies follows
  from the force, with the stiffness of the plane contact (:class:`PlaneStrips`).

Of a linear :math:`f = k \delta` under a tilt :math:`\theta` and a force F over the length l: the largest load
is :math:`F/l + k \theta l / 2` while all of the line touches, :math:`\sqrt{2 k \theta F}` over the length
:math:`\sqrt{2 F / (k \theta)}` beyond.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from antenna_pin.base.arrays import Array
from antenna_pin.contact.normal import CompiledNormalLaw

# Below this share of the depth, a segment's difference of depths loses digits in the quotient of Phi, and
# Simpson's rule is exact to 1e-15.
_LEVEL = 1e-3
# Most steps to the level of the line; Newton's method takes some five.
_MOST = 100


class StripLaw(Protocol):
    """Load per length of a strip over its depth, and the integral of it."""

    def force(self, depth: Array) -> Array:
        """Return the load per length [N/m], zero without depth."""

    def energy(self, depth: Array) -> Array:
        """Return the integral of the load over the depth [N], zero without depth."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaneStrips:
    r"""Plane contact of a journal in a bore: Johnson's compression, then linear.

    .. math:: \delta = \frac{f}{\pi E^*} \max\left(\ln\frac{4 \pi E^* \Delta R}{f} - 1,\, 2\right)

    Johnson's logarithm falls to 2 well before the depth turns over; beyond it :math:`f = \tfrac\pi2 E^*
    \delta`, the stiffness of Persson's conformal contact at small depth.
    """

    modulus: float  # E* [Pa]
    clearance: float  # R_i - R_j [m]

    @property
    def _scale(self) -> float:
        """Load beta of the depth alpha f ln(beta / f) [N/m]."""
        return 4.0 * math.pi * self.modulus * self.clearance / math.e

    def depth(self, load: Array) -> Array:
        """Return the depth of a strip under a load per length [m]."""
        with np.errstate(divide="ignore"):
            logarithm = np.maximum(np.log(self._scale / load), 2.0)
        found: Array = np.where(load > 0.0, load * logarithm, 0.0) / (math.pi * self.modulus)
        return found

    def _logarithm(self, depth: Array) -> Array:
        """Return ln(beta / f), at least 2 [-]."""
        from scipy.special import lambertw

        largest = 2.0 * math.exp(-2.0)  # of w exp(-w), at w = 2
        ratio = math.pi * self.modulus * np.maximum(depth, 0.0) / self._scale
        found: Array = -np.real(lambertw(-np.clip(ratio, 1e-300, largest), -1))
        return found

    def force(self, depth: Array) -> Array:
        """Return the load per length [N/m], zero without depth."""
        return math.pi * self.modulus * np.maximum(depth, 0.0) / self._logarithm(depth)

    def slope(self, depth: Array) -> Array:
        """Return the derivative of the load by the depth [Pa], zero without depth."""
        w = self._logarithm(depth)
        found: Array = np.where(depth > 0.0, math.pi * self.modulus / np.where(w > 2.0, w - 1.0, w), 0.0)
        return found

    def energy(self, depth: Array) -> Array:
        """Return the integral of the load over the depth [N], zero without depth."""
        alpha, w = 1.0 / (math.pi * self.modulus), self._logarithm(depth)
        end = 2.0 * math.exp(-2.0) * alpha * self._scale
        load = self.force(np.minimum(depth, end))
        beyond = np.maximum(depth, end) ** 2 - end**2
        found: Array = alpha * load**2 * (0.5 * w - 0.25) + beyond / (4.0 * alpha)
        return found


@dataclass(frozen=True, slots=True, kw_only=True)
class LawStrips:
    """Strips that share a force as the law of a joint does."""

    law: CompiledNormalLaw

    def _of_depths(self, depth: Array, energy: bool) -> Array:
        of = self.law.elastic_energy if energy else self.law.elastic_force
        limit = self.law.depth_limit
        found = np.zeros(depth.shape)
        loaded = depth > 0.0
        found[loaded] = [of(min(float(one), limit)) for one in depth[loaded]]
        if energy and math.isfinite(limit):  # beyond its limit the force of a law stays what it is there
            found += np.maximum(depth - limit, 0.0) * self.law.elastic_force(limit)
        return found

    def force(self, depth: Array) -> Array:
        """Return the law's force [N], zero without depth; a multiple of the load per length."""
        return self._of_depths(depth, energy=False)

    def energy(self, depth: Array) -> Array:
        """Return the law's energy [J], zero without depth."""
        return self._of_depths(depth, energy=True)


class LineLoad(NamedTuple):
    """Load along a line of contact at some samples."""

    load: Array  # per length at the nodes, (n, nodes) [N/m]
    depth: Array  # at the nodes, negative where apart, (n, nodes) [m]
    places: Array  # of the nodes along the axis, (n, nodes) [m]

    @property
    def peak(self) -> Array:
        """Largest load per length, (n,) [N/m]."""
        return np.asarray(self.load.max(axis=1, initial=0.0))

    @property
    def along(self) -> Array:
        """Place of the largest load along the axis, (n,) [m]."""
        most = np.argmax(self.load, axis=1)
        return np.asarray(np.take_along_axis(self.places, most[:, None], axis=1)[:, 0])

    @property
    def loaded(self) -> Array:
        """Length of the line that touches, (n,) [m]."""
        left, right = self.depth[:, :-1], self.depth[:, 1:]
        most, least = np.maximum(left, right), np.minimum(left, right)
        partly = np.clip(most, 0.0, None) / np.where(least < 0.0, most - least, 1.0)
        share = np.where(least < 0.0, partly, 1.0)
        return np.asarray((share * np.abs(np.diff(self.places, axis=1))).sum(axis=1))

    def at(self, places: Array, law: StripLaw) -> Array:
        """Return the load of the first sample at other places along the axis, (m,) [N/m]."""
        order = np.argsort(self.places[0])
        depth = np.interp(places, self.places[0][order], self.depth[0][order])
        unit = law.force(self.depth[:1]).max()
        found: Array = (
            law.force(depth) * self.peak[0] / unit if unit > 0.0 else np.full_like(places, self.peak[0])
        )
        return found


def _segment_means(law: StripLaw, depth: Array) -> Array:
    """Return the mean load per length of each segment, (n, nodes - 1)."""
    left, right = depth[:, :-1], depth[:, 1:]
    force, energy = law.force(depth), law.energy(depth)
    middle = law.force(0.5 * (left + right))
    simpson = (force[:, :-1] + 4.0 * middle + force[:, 1:]) / 6.0
    level = np.abs(right - left) <= _LEVEL * np.minimum(left, right)
    level |= (left <= 0.0) & (right <= 0.0)
    quotient = np.diff(energy, axis=1) / np.where(level, 1.0, right - left)
    found: Array = np.where(level, simpson, quotient)
    return found


def line_load(force: Array, depth: Array, places: Array, law: StripLaw) -> LineLoad:
    """Return the load along a line under forces and a tilt.

    Nodes are (n, nodes): depths [m], of :class:`PlaneStrips` all but a constant, which the force sets, and
    places along the axis [m].

    Returns:
        The loads; uniform where a law is to share out a force and no node is in contact, which rounding alone
        does.
    """
    steps = np.abs(np.diff(places, axis=1))
    length = steps.sum(axis=1)
    load, pressed = np.zeros_like(depth), depth.copy()
    rows = np.flatnonzero(force > 0.0)
    mine, h, total = depth[rows], steps[rows], force[rows]
    if isinstance(law, PlaneStrips):
        mine = mine - mine.max(axis=1, keepdims=True)
        mine = mine + _level(total, mine, h, law)[:, None]
    carried = (_segment_means(law, mine) * h).sum(axis=1)
    uniform = ~(carried > 0.0)
    scale = total / np.where(uniform, 1.0, carried)
    even = np.broadcast_to((total / length[rows])[:, None], mine.shape)
    load[rows] = np.where(uniform[:, None], even, law.force(mine) * scale[:, None])
    pressed[rows] = np.where(uniform[:, None], 0.0, mine)
    return LineLoad(load, pressed, places)


def _level(force: Array, depth: Array, steps: Array, law: PlaneStrips) -> Array:
    """Return the largest depth that balances a force, (n,) [m].

    The depths are relative to the largest one.
    """
    low = law.depth(force / steps.sum(axis=1))
    high = low - depth.min(axis=1)
    at: Array = low.copy()
    for _ in range(_MOST):
        moved = depth + at[:, None]
        excess = (_segment_means(law, moved) * steps).sum(axis=1) - force
        low, high = np.where(excess < 0.0, at, low), np.where(excess > 0.0, at, high)
        gained, rise = np.diff(law.force(moved), axis=1), np.diff(moved, axis=1)
        level = np.abs(rise) <= 1e-9 * moved.max(axis=1, keepdims=True)
        slope = np.where(level, law.slope(moved[:, :-1]), gained / np.where(level, 1.0, rise))
        after = at - excess / (slope * steps).sum(axis=1)
        after = np.where((after >= low) & (after <= high), after, 0.5 * (low + high))
        done = np.abs(after - at) <= 1e-13 * at
        at = after
        if bool(done.all()):
            break
    return at


def bore_depths(offset: Array, places: Array, clearance: float, radius: float) -> Array:
    r"""Return the depth of a journal along its bore, negative where apart, (n, nodes) [m].

    With the point :math:`\mathbf e(x)` in which the journal's axis pierces the cross section at x, linear in
    x, and its slope :math:`\mathbf t`,

    .. math:: \delta = |\mathbf e| - c + \tfrac12 R (\mathbf t \cdot \mathbf e / |\mathbf e|)^2

    except for terms of third order in tilt and play; the last one is a tilted circle's, which is narrower.

    Args:
        offset: e at the nodes, across the axis, (n, nodes, 2) [m].
        places: x of the nodes, (n, nodes) [m].
        clearance: c = R_i - R_j [m].
        radius: R of the circles that touch: the bore's; zero leaves the last term out [m].
    """
    size = np.linalg.norm(offset, axis=2)
    run = places[:, -1:] - places[:, :1]
    slope = (offset[:, -1] - offset[:, 0]) / np.where(run == 0.0, 1.0, run)
    with np.errstate(divide="ignore", invalid="ignore"):
        lean = np.where(size > 0.0, (offset * slope[:, None, :]).sum(axis=2) / size, 0.0)
    found: Array = size - clearance + 0.5 * radius * lean**2
    return found
