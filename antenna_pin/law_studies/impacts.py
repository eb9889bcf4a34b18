"""One impact, integrated in SciPy's DOP853 with the compiled law: a mass on a wall, or two free bodies.

A law that leaves its effective mass to the contact takes that of the impact.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from antenna_pin.base.arguments import takes
from antenna_pin.contact import CompiledNormalLaw, NormalLaw
from antenna_pin.contact.kernels import normal_force
from antenna_pin.errors import InvalidParameterError

__all__ = ["Impact", "check_impact", "depth_of_energy", "impact_of_pair", "impact_on_wall"]


@dataclass(frozen=True, slots=True)
class Impact:
    """One impact, from touch to separation.

    Attributes:
        restitution: Relative speed after over before [-].
        peak_depth: Largest depth [m].
        peak_force: Largest force [N].
        duration: Time in contact [s].
        dissipated: Energy lost [J].
    """

    restitution: float
    peak_depth: float
    peak_force: float
    duration: float
    dissipated: float


def check_impact(place: str, mass: float, speed: float) -> None:
    """Refuse a mass [kg] or a speed [m/s] that makes no impact; ``place`` is who asks."""
    if not 0.0 < mass < math.inf:
        raise InvalidParameterError(place, "mass", "positive and finite [kg]", mass)
    if not 0.0 < speed < math.inf:
        raise InvalidParameterError(place, "speed", "positive and finite [m/s]", speed)


def depth_of_energy(law: NormalLaw, energy: float) -> float:
    """Return the depth at which a law stores an energy [m]; infinite beyond its range."""
    from scipy.optimize import brentq

    limit = getattr(law, "depth_limit", math.inf)
    high = min(1e-6, limit)
    while law.elastic_energy(high) < energy:
        if high >= limit:
            return math.inf
        high = min(4.0 * high, limit)
    low = 0.25 * high
    while law.elastic_energy(low) > energy:
        low *= 0.25
    # Where the energy goes as the depth squared, a tolerance on the depth is half of one on the energy.
    return float(brentq(lambda d: law.elastic_energy(d) / energy - 1.0, low, high, xtol=1e-30, rtol=1e-15))


@takes(mass="kg", speed="m/s")
def impact_on_wall(law: NormalLaw, *, mass: float, speed: float, rtol: float = 1e-12) -> Impact:
    """Integrate the impact of a free mass on a wall.

    Args:
        law: The law.
        mass: [kg].
        speed: Approach speed [m/s].
        rtol: Relative tolerance of the integration [-].
    """
    check_impact("impact_on_wall", mass, speed)
    return _impact(law, (mass, math.inf), (speed, 0.0), rtol)


@takes()
def impact_of_pair(
    law: NormalLaw, *, masses: tuple[float, float], speeds: tuple[float, float], rtol: float = 1e-12
) -> Impact:
    """Integrate the impact of two free bodies on one line.

    Args:
        law: The law.
        masses: Of the body behind and of the one in front [kg].
        speeds: Of the body behind and of the one in front, the first the faster [m/s].
        rtol: Relative tolerance of the integration [-].
    """
    for mass in masses:
        check_impact("impact_of_pair", mass, 1.0)
    if not speeds[0] > speeds[1]:
        raise InvalidParameterError("impact_of_pair", "speeds", "such that the bodies approach", speeds)
    return _impact(law, masses, speeds, rtol)


def _force(law: NormalLaw, mass: float) -> Callable[[float, float, float], float]:
    if isinstance(law, CompiledNormalLaw):
        code = law.code()
        return lambda depth, rate, first: float(normal_force(code, depth, rate, first, mass))
    return lambda depth, rate, first: law.force(depth, rate, first) if depth > 0.0 else 0.0


def _impact(law: NormalLaw, masses: tuple[float, float], speeds: tuple[float, float], rtol: float) -> Impact:
    from scipy.integrate import solve_ivp

    approach = speeds[0] - speeds[1]
    mass = 1.0 / (1.0 / masses[0] + 1.0 / masses[1])
    energy = 0.5 * mass * approach**2
    limit = getattr(law, "depth_limit", math.inf)
    length = min(depth_of_energy(law, energy), limit)
    scale = length / approach  # of time; the state is in units of length and approach speed
    shares = (mass / masses[0], mass / masses[1])
    force = _force(law, mass)

    def pressing(z: Any) -> float:
        depth, rate = (z[0] - z[2]) * length, (z[1] - z[3]) * approach
        return force(depth, rate, approach) * scale / (mass * approach)

    def rates(_: float, z: Any) -> list[float]:
        f = pressing(z)
        return [z[1], -f * shares[0], z[3], f * shares[1]]

    def deepest(_: float, z: Any) -> float:
        return float(z[1] - z[3])

    def apart(t: float, z: Any) -> float:
        return float(z[0] - z[2]) if t > 0.0 else 1.0

    events: tuple[Any, Any] = (deepest, apart)
    for event in events:
        event.direction = -1.0
    events[1].terminal = True
    # The step is held down because many laws have no second derivative at the ends.
    run: Any = solve_ivp(
        rates,
        (0.0, 1e5),
        [0.0, speeds[0] / approach, 0.0, speeds[1] / approach],
        method="DOP853",
        rtol=max(rtol, 3e-14),
        atol=1e-3 * rtol,
        max_step=0.05,
        events=events,
        dense_output=True,
    )
    if not run.t_events[1].size:
        raise InvalidParameterError("impact", "law", "one that separates", law)
    end, last = float(run.t_events[1][0]), run.y_events[1][0]
    top = float(run.t_events[0][0])
    peak = _largest(lambda t: pressing(run.sol(t)), 0.0, min(2.0 * top, end))
    restitution = float(last[3] - last[1])
    peak_depth = float(run.y_events[0][0][0] - run.y_events[0][0][2]) * length
    if peak_depth > limit * (1.0 + 1e-9):  # of the integration
        raise InvalidParameterError(
            "impact", "speed", f"lower, for the law ends at depth_limit = {limit:g} m", approach
        )
    return Impact(
        restitution=restitution,
        peak_depth=peak_depth,
        peak_force=peak * mass * approach / scale,
        duration=end * scale,
        dissipated=energy * (1.0 - restitution**2),
    )


def _largest(function: Callable[[float], float], low: float, high: float) -> float:
    """Return the largest value of a function with one maximum, to a relative 1e-12 of its square."""
    times = np.linspace(low, high, 65)
    values = [function(t) for t in times]
    best = int(np.argmax(values))
    a, b = float(times[max(best - 1, 0)]), float(times[min(best + 1, 64)])
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    for _ in range(40):
        c, d = b - ratio * (b - a), a + ratio * (b - a)
        if function(c) > function(d):
            b = d
        else:
            a = c
    return max(max(values), function(0.5 * (a + b)))
