"""Effective-mass modes of a link: masses on slides and inertias on hinges."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from antenna_pin.base.directions import unit
from antenna_pin.base.parameters import check, parameter
from antenna_pin.base.rules import A_DIRECTION, SWINGS
from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism.flexible.inertia import MassProperties
from antenna_pin.mechanism.flexible.modal_data import balanced_rotor, sliding_mass
from antenna_pin.mechanism.flexible.parts import ElasticPart, FlexibleKind, SphereShape, Takes

# Radius of the ball that stands for a mass in pictures, over the link's radius of gyration.
_BALL = 0.08


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectiveMode:
    r"""A mode as the mass, or the inertia, that answers on the hub.

    A mass m on a slide, or an inertia on a hinge. Frequency and damping ratio are those with the hub held:
    :math:`k = m \omega^2`, :math:`c = 2 \zeta \omega m`.

    Attributes:
        frequency: With the hub held, undamped; or a stiffness is given [Hz].
        stiffness: Of the spring, instead of a frequency; of an inertia in N m/rad, of a mass in N/m
            [N*m/rad] ([N/m]).
        damping_ratio: With the hub held [-].
        mass: Effective mass, of a mode that shifts along ``direction`` [kg].
        inertia: Effective moment of inertia, of a mode that turns about ``direction`` [kg*m^2].
        direction: In the link's axes, any length but zero [-].
        place: In the link's frame; the link's mass centre if left out [m].
        shapes: Visual shapes that move along; a ball is drawn where there are none.
    """

    direction: tuple[float, ...] = parameter("1", rule=A_DIRECTION, sizes=(3,))
    frequency: float | None = parameter("Hz", rule="positive", default=None)
    stiffness: float | None = parameter("N*m/rad", sliding="N/m", rule="positive", default=None)
    damping_ratio: float = parameter("1", rule=SWINGS, default=0.0)
    mass: float | None = parameter("kg", rule="positive", default=None)
    inertia: float | None = parameter("kg*m**2", rule="positive", default=None)
    place: tuple[float, ...] | None = parameter("m", sizes=(3,), default=None)
    shapes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse what is no mode."""
        check(self)
        for one, other in (("mass", "inertia"), ("frequency", "stiffness")):
            first, second = getattr(self, one), getattr(self, other)
            if (first is None) == (second is None):
                got = "neither" if first is None else "both"
                raise InvalidParameterError(self, one, f"given, or {other} instead of it", said=got)

    @property
    def natural_frequency(self) -> float:
        """Natural frequency with the hub held [Hz]."""
        if self.frequency is not None:
            return self.frequency
        assert self.stiffness is not None
        return math.sqrt(self.stiffness / (self.mass or self.inertia or math.nan)) / (2.0 * math.pi)

    def part(self, name: str, link: MassProperties) -> ElasticPart:
        """Return the body on a joint that it is."""
        along = unit(self.direction)
        place = link.centre if self.place is None else np.array(self.place)
        omega = 2.0 * math.pi * self.natural_frequency
        if self.mass is not None:
            made = sliding_mass(name, link, self.mass, along, place, omega, self.damping_ratio)
        else:
            assert self.inertia is not None
            made = balanced_rotor(name, link, self.inertia, along, place, omega, self.damping_ratio)
        ball = np.eye(4)
        ball[:3, 3] = place
        drawn = tuple(map(Takes, self.shapes)) or (SphereShape(_BALL * link.gyration, ball),)
        return made.with_drawn(drawn)


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectiveModes(FlexibleKind):
    """A link with effective-mass modes, side by side on its hub.

    Attributes:
        modes: By name; at least one.
    """

    modes: Mapping[str, EffectiveMode] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse none at all."""
        object.__setattr__(self, "modes", dict(self.modes))
        if not self.modes:
            raise InvalidParameterError(self, "modes", "at least one", said="none")

    @property
    def frequencies(self) -> dict[str, float]:
        """Natural frequencies with the hub held, by mode [Hz]."""
        return {name: mode.natural_frequency for name, mode in self.modes.items()}

    def parts(self, name: str, link: MassProperties) -> list[ElasticPart]:
        """Return the modes as bodies on joints."""
        return [mode.part(f"{name}_{key}", link) for key, mode in self.modes.items()]
