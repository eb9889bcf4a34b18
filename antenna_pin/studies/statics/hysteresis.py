r"""Rate-independent states of elements along a travel: Bouc-Wen springs, harnesses, bristles.

The rate of such a state is proportional to the joint's rate, so that it is a function of the displacement:
:math:`dz/ds = f_\pm(z)` for either sense, at vanishing rate where the law depends on rates. Where f is
affine on a side of z = 0, as of most laws, the solution is an exponential; else it is integrated
to round-off.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import words_of
from antenna_pin.compiled.decorators import in_python, record
from antenna_pin.dynamics import System, acting_in, kernels
from antenna_pin.elements import Motor
from antenna_pin.elements.element import takes_tail

Array = NDArray[np.float64]

# Rate that vanishes before those by which laws fall from static to sliding friction [rad/s] ([m/s]).
_RATE = 1e-10
# Share by which values of an affine function may be off.
_AFFINE = 1e-9
# Way over the reach of a state after which it has reached its limit.
_FAR = 1e6


class _RateBranch(NamedTuple):
    """Rate of a state over the displacement, f = constant + slope z."""

    constant: float
    slope: float
    affine: bool


class HystereticState:
    """State of one element that depends on its joint's displacement.

    Attributes:
        place: Table and name of the element, as ``springs.coil``.
        block: Place of its block in a program.
        x: Index of the state in y.
    """

    def __init__(self, system: System, place: str, element: Any, block: int, integral: int) -> None:
        """Determine the branches of the state's rate."""
        self.place, self.block = place, block
        head = system.program[block : block + kernels.PARAMETERS].view(kernels.ELEMENT)[0]
        model = system.model
        self.x = model.nq + model.nv + int(head["x"]) + integral
        self.start = float(getattr(element, "start", 0.0))
        words = system.program[block + kernels.PARAMETERS : block + int(head["length"])].copy()
        self._kernel, size = in_python(element.hook("write_rates_of")), words_of(element.layout())
        own = record(words[:size], element.layout())
        self._own = (own, words[size:]) if takes_tail(self._kernel) else (own,)
        self._integral, self._count = integral, len(element.integrals)
        self._scale = float(getattr(element, "limit", 1.0))
        self._branches = {
            (sense, side): self._branch(sense, side) for sense in (1.0, -1.0) for side in (1.0, -1.0)
        }

    def rate(self, z: float, sense: float) -> float:
        """Return dz/ds of a motion in one sense."""
        own = np.zeros(self._count)
        own[self._integral] = z - self.start
        rates = np.zeros(self._count)
        self._kernel(*self._own, (0.0, sense * _RATE, 0.0), (own, 0), rates, 0)
        return float(rates[self._integral]) / _RATE

    def _branch(self, sense: float, side: float) -> _RateBranch:
        z = side * self._scale * np.array([0.13, 0.55, 0.91])
        f = [self.rate(one, sense) for one in z]
        slope = (f[2] - f[0]) / (z[2] - z[0])
        constant = f[0] - slope * z[0]
        size = max(map(abs, f)) + abs(constant)
        affine = abs(constant + slope * z[1] - f[1]) <= _AFFINE * size
        return _RateBranch(float(constant), float(slope), bool(affine))

    def advanced(self, offset: float, way: float) -> float:
        """Return the state, less its start, after a signed displacement of the joint.

        Args:
            offset: The state before, less its start.
            way: Its displacement [rad] ([m]).
        """
        if way == 0.0:
            return offset
        z, rest, sense = offset + self.start, abs(way), math.copysign(1.0, way)
        for _ in range(4):
            side = math.copysign(1.0, z if z != 0.0 else self.rate(0.0, sense))
            branch = self._branches[sense, side]
            if not branch.affine:
                return self._integrated(z, sense, rest) - self.start
            z, rest = _along(branch, z, side, rest)
            if rest <= 0.0:
                break
        return z - self.start

    def developed(self, sense: float) -> float:
        """Return the state (less its start) after a long displacement in one sense."""
        return self.advanced(0.0, sense * _FAR * self._reach())

    def _reach(self) -> float:
        """Return the displacement within which the state approaches its limit [rad] ([m])."""
        f = abs(self.rate(0.0, 1.0))
        return self._scale / f if f > 0.0 else 1.0

    def _integrated(self, z: float, sense: float, way: float) -> float:
        from scipy.integrate import solve_ivp

        far = 200.0 * self._reach()
        span = min(way, far)
        found = solve_ivp(
            lambda _, state: [self.rate(float(state[0]), sense)],
            (0.0, span),
            [z],
            method="DOP853",
            rtol=1e-13,
            atol=1e-15 * self._scale,
        )
        return float(found.y[0, -1])


def _along(branch: _RateBranch, z: float, side: float, way: float) -> tuple[float, float]:
    """Return the state after a displacement along an affine branch, and the remaining displacement."""
    constant, slope, _ = branch
    end = _affine(constant, slope, z, way)
    if side * end >= 0.0 or z == 0.0:
        return end, 0.0
    # It passes zero: constant + slope z has the sign against z all the way.
    if slope == 0.0:
        used = -z / constant
    else:
        used = -math.log1p(slope * z / constant) / slope
    return 0.0, way - used


def _affine(constant: float, slope: float, z: float, way: float) -> float:
    """Return the solution of dz/ds = constant + slope z after a displacement."""
    grown = slope * way
    if slope == 0.0:
        return z + constant * way
    return z * math.exp(grown) + constant / slope * math.expm1(grown)


def hysteretic_states(system: System) -> list[HystereticState]:
    """Return the rate-independent states of the elements of a system that are on."""
    found = []
    for one in acting_in(system):
        element = one.element
        if isinstance(element, Motor) or not element.acts or element.hook("write_rates_of") is None:
            continue
        for own in element.states:
            if own.name == "dwell":
                continue
            integral = element.integrals.index(own)
            found.append(HystereticState(system, one.place, element, one.block, integral))
    return found
