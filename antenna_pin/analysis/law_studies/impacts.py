r"""Impacts of normal laws: closed forms, and integration by SciPy's DOP853 with the compiled law.

A law with hysteresis damping, :math:`f = f_e(\delta)(1 + \chi \dot\delta / v_0)`, separates with the
restitution c that solves :math:`\chi (1 + c) = \ln[(1 + \chi) / (1 - \chi c)]` and goes as deep as

.. math:: U(\delta_{max}) = m v_0^2 \left[\frac1\chi - \frac{\ln(1 + \chi)}{\chi^2}\right]

with the energy U of its elastic part, whatever that is; a law that damps in the approach only goes as deep
and gives all of U back. A damper :math:`\alpha \sqrt{m f_e / \delta}` beside a power law is a linear
oscillator in disguise (:mod:`antenna_pin.contact.damping`): with :math:`g = \zeta \arccos\zeta / \sqrt{1 -
\zeta^2}` it separates with :math:`e^{-2g}` where it is cut off at zero, with :math:`e^{-g}` where it acts in
the approach only. A law that leaves its effective mass to the contact takes that of the impact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.contact import (
    DISSIPATIONS,
    CompiledNormalLaw,
    DampedContact,
    Dissipation,
    Hertz,
    JankowskiDamping,
    KelvinVoigtDamping,
    MarhefkaOrinDamping,
    NoDissipation,
    NormalLaw,
    TsujiDamping,
    delivered_restitution,
    law_parameters,
)
from antenna_pin.contact.hysteresis import HysteresisDamping, stored_share
from antenna_pin.contact.kernels import normal_force
from antenna_pin.errors import InvalidParameterError

# --- integrated impacts -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Impact:
    """Impact, from touch to separation."""

    restitution: float  # relative speed after over before [-]
    peak_depth: float  # largest depth [m]
    peak_force: float  # largest force [N]
    duration: float  # time in contact [s]
    dissipated: float  # energy lost [J]


def _check_impact(place: str, mass: float, speed: float) -> None:
    """Refuse a mass [kg] or speed [m/s] without an impact; ``place`` names the caller."""
    check_number(place, "mass", mass, "positive", "kg")
    check_number(place, "speed", speed, "positive", "m/s")


def _depth_of_energy(law: NormalLaw, energy: float) -> float:
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
    _check_impact("impact_on_wall", mass, speed)
    return _impact(law, (mass, math.inf), (speed, 0.0), rtol)


@takes()
def impact_of_pair(
    law: NormalLaw, *, masses: tuple[float, float], speeds: tuple[float, float], rtol: float = 1e-12
) -> Impact:
    """Integrate the impact of two free bodies along one line.

    Args:
        law: The law.
        masses: Of the body behind and of the one in front [kg].
        speeds: Of the body behind and of the one in front, the first the faster [m/s].
        rtol: Relative tolerance of the integration [-].
    """
    for mass in masses:
        _check_impact("impact_of_pair", mass, 1.0)
    if not speeds[0] > speeds[1]:
        raise InvalidParameterError("impact_of_pair", "speeds", "such that the bodies approach", speeds)
    return _impact(law, masses, speeds, rtol)


def _force(law: NormalLaw, mass: float) -> Callable[[float, float, float], float]:
    if isinstance(law, CompiledNormalLaw):
        code = law.code()
        return lambda depth, rate, speed: float(normal_force(code, depth, rate, speed, mass))
    return lambda depth, rate, speed: law.force(depth, rate, speed) if depth > 0.0 else 0.0


def _impact(law: NormalLaw, masses: tuple[float, float], speeds: tuple[float, float], rtol: float) -> Impact:
    from scipy.integrate import solve_ivp

    approach = speeds[0] - speeds[1]
    mass = 1.0 / (1.0 / masses[0] + 1.0 / masses[1])
    energy = 0.5 * mass * approach**2
    limit = getattr(law, "depth_limit", math.inf)
    length = min(_depth_of_energy(law, energy), limit)
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
    """Return the maximum of a unimodal function, to a relative 1e-12 of its square."""
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


# --- closed forms, and restitution tables -------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class RestitutionRow:
    """Restitution of a dissipation, beside its parameter."""

    dissipation: str  # its name
    asked: float  # coefficient of specified restitution [-]
    closed_form: float  # what it delivers by its closed form [-]
    on_wall: float  # what an integrated impact on a wall delivers [-]; NaN if none was made
    of_pair: float  # what an integrated impact of two free bodies delivers [-]; NaN if none was made
    closed_form_depth: float  # largest depth by its closed form [m]
    depth_on_wall: float  # largest depth of the impact on the wall [m]; NaN if none was made


def _hysteresis(dissipation: Dissipation, speed: float) -> float | None:
    """Return chi of a law with hysteresis damping, 0 without damping, or None."""
    if isinstance(dissipation, HysteresisDamping):
        return dissipation.hysteresis
    if isinstance(dissipation, MarhefkaOrinDamping):
        return dissipation.hysteresis_over_speed * speed
    return 0.0 if isinstance(dissipation, NoDissipation) else None


def _damping_ratio(parts: DampedContact, mass: float) -> float | None:
    """Return zeta of a law equivalent to a linear oscillator, or None."""
    spring: Any = parts.elastic
    if spring.kernel is not Hertz.kernel:
        return None
    if isinstance(parts.dissipation, TsujiDamping | JankowskiDamping):
        secant = parts.dissipation.numbers(spring)
        # Without a mass of its own it takes that of the impact.
        share = secant.mass / mass if secant.mass > 0.0 else 1.0
        return float(secant.damping * math.sqrt(share) / math.sqrt(2.0 * (spring.exponent + 1.0)))
    if isinstance(parts.dissipation, KelvinVoigtDamping) and spring.exponent == 1.0:
        return float(parts.dissipation.damping / (2.0 * math.sqrt(spring.stiffness * mass)))
    return None


def _damping_of(
    place: str, law: CompiledNormalLaw, mass: float, speed: float
) -> tuple[DampedContact, float | None, float | None]:
    """Return a law's parts with chi or zeta, if any."""
    _check_impact(place, mass, speed)
    parts = law.parts
    chi = _hysteresis(parts.dissipation, speed)
    return parts, chi, None if chi is not None else _damping_ratio(parts, mass)


def _decay(zeta: float) -> float:
    """Return ``zeta arccos(zeta) / sqrt(1 - zeta^2)``, the decay exponent to the peak."""
    if abs(zeta - 1.0) < 1e-8:
        return 1.0
    if zeta < 1.0:
        return zeta * math.acos(zeta) / math.sqrt(1.0 - zeta * zeta)
    return zeta * math.acosh(zeta) / math.sqrt(zeta * zeta - 1.0)


@takes(mass="kg", speed="m/s")
def closed_form_restitution(law: CompiledNormalLaw, *, mass: float, speed: float) -> float | None:
    """Return the restitution of a law in a free impact [-], or None.

    Args:
        law: The law.
        mass: Effective mass of the bodies [kg]: 1/m = 1/m_1 + 1/m_2.
        speed: Approach speed [m/s].
    """
    parts, chi, zeta = _damping_of("closed_form_restitution", law, mass, speed)
    if chi is not None:
        return delivered_restitution(chi, approach_only=getattr(parts.dissipation, "approach_only", False))
    if zeta is None:
        return None
    one_way = isinstance(parts.dissipation, JankowskiDamping)
    return math.exp(-_decay(zeta) if one_way else -2.0 * _decay(zeta))


@takes(mass="kg", speed="m/s")
def closed_form_peak_depth(law: CompiledNormalLaw, *, mass: float, speed: float) -> float | None:
    """Return the largest depth of a free impact [m]; arguments as of :func:`closed_form_restitution`."""
    parts, chi, zeta = _damping_of("closed_form_peak_depth", law, mass, speed)
    if chi is not None:
        return _depth_of_energy(law, mass * speed**2 * stored_share(chi))
    if zeta is None:
        return None
    spring: Any = parts.elastic
    half = 0.5 * (spring.exponent + 1.0)
    peak = half * speed / math.sqrt(half * spring.stiffness / mass) * math.exp(-_decay(zeta))
    return float(peak ** (1.0 / half))


@takes()
def restitution_table(
    dissipations: Iterable[str] | None = None,
    asked: Iterable[float] = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0),
    *,
    stiffness: float = 1e10,
    exponent: float = 1.5,
    mass: float = 1.0,
    speed: float = 0.1,
    simulate: bool = True,
) -> tuple[RestitutionRow, ...]:
    """Return the restitutions of dissipations, in closed form and integrated.

    Args:
        dissipations: Names in ``DISSIPATIONS``; all that take a restitution if not given.
        asked: Coefficients of restitution; those that a dissipation refuses are left out.
        stiffness: K of the elastic law [N/m^n].
        exponent: n of the elastic law [-].
        mass: Effective mass [kg]; of the free pair one body has three times the mass of the other.
        speed: Approach speed [m/s].
        simulate: Whether to integrate impacts too.
    """
    taking = [name for name, cls in DISSIPATIONS.items() if "restitution" in law_parameters(cls)]
    rows = []
    for name in taking if dissipations is None else dissipations:
        if name not in taking:
            raise InvalidParameterError(
                "restitution_table", "dissipations", f"of {', '.join(taking)}, which take a restitution", name
            )
        cls = DISSIPATIONS[name]
        for value in asked:
            try:
                dissipation = cls(restitution=value)
            except InvalidParameterError:
                if value == 0.0:
                    continue
                raise
            law = DampedContact(
                elastic=Hertz(stiffness=stiffness, exponent=exponent), dissipation=dissipation
            )
            wall = pair = None
            if simulate:
                wall = impact_on_wall(law, mass=mass, speed=speed)
                pair = impact_of_pair(
                    law, masses=(4.0 * mass, 4.0 * mass / 3.0), speeds=(0.25 * speed, -0.75 * speed)
                )
            closed = closed_form_restitution(law, mass=mass, speed=speed)
            depth = closed_form_peak_depth(law, mass=mass, speed=speed)
            rows.append(
                RestitutionRow(
                    dissipation=name,
                    asked=value,
                    closed_form=math.nan if closed is None else closed,
                    on_wall=math.nan if wall is None else wall.restitution,
                    of_pair=math.nan if pair is None else pair.restitution,
                    closed_form_depth=math.nan if depth is None else depth,
                    depth_on_wall=math.nan if wall is None else wall.peak_depth,
                )
            )
    return tuple(rows)


@takes()
def largest_errors(rows: Iterable[RestitutionRow]) -> tuple[float, float]:
    """Return the largest deviations of integrated impacts from closed forms.

    Returns:
        In restitution, wall and free pair alike, and in peak depth relative to it [-]; NaN where no row has a
        closed form.
    """
    restitution = depth = math.nan
    for row in rows:
        if math.isfinite(row.closed_form):
            off = max(abs(row.on_wall - row.closed_form), abs(row.of_pair - row.closed_form))
            restitution = off if math.isnan(restitution) else max(restitution, off)
        if math.isfinite(row.closed_form_depth):
            off = abs(row.depth_on_wall / row.closed_form_depth - 1.0)
            depth = off if math.isnan(depth) else max(depth, off)
    return restitution, depth
