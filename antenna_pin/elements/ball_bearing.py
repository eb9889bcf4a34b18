"""A ball bearing by its balls and grooves."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import check_number
from antenna_pin.base.calculus import root_between
from antenna_pin.base.parameters import parameter
from antenna_pin.contact.pressure import Ellipse, ball_load_limit, raceway_ellipse, static_rating
from antenna_pin.elements.bearing import Bearing, Matrix5, Numbers5
from antenna_pin.errors import InvalidParameterError

# --- Hertz's point contact of a ball in a groove ---

# Axis ratio up to which the ellipse of contact is looked for: far beyond grooves as tight as balls.
_LONGEST = 1e8


def groove_contact(diameter: float, conformity: float, gamma: float, softness: float) -> float:
    """Return K of Q = K delta^1.5, of a ball on a raceway [N/m^1.5].

    Args:
        diameter: Of the ball [m].
        conformity: Radius of the groove over the ball's diameter, above 0.5 [-].
        gamma: D cos(contact angle) / d_m of an inner raceway, the opposite of an outer one [-].
        softness: Sum of (1 - nu^2) / E of both bodies [1/Pa].

    References:
        Harris and Kotzalas, Rolling Bearing Analysis, chapters 2 and 6: curvatures of raceways.
    """
    along = 2.0 / diameter * (1.0 + gamma / (1.0 - gamma))
    across = 2.0 / diameter - 1.0 / (conformity * diameter)
    return point_stiffness(along, across, softness)


def point_stiffness(first: float, second: float, softness: float) -> float:
    r"""Return K of Q = K delta^1.5 for two bodies [N/m^1.5].

    Their principal curvatures are in the same planes.

    The axis ratio kappa = a / b of the ellipse of contact follows from

    .. math:: \frac{|\rho_1 - \rho_2|}{\rho_1 + \rho_2} =
              \frac{(\kappa^2 + 1) E - 2 K}{(\kappa^2 - 1) E}, \qquad m = 1 - \kappa^{-2}

    with complete elliptic integrals K(m) and E(m), and then

    .. math:: \delta = \frac{2 K}{\pi} \left(\frac{\pi}{2 \kappa^2 E}\right)^{1/3}
              \left(\frac{3 Q \eta}{2 \Sigma\rho}\right)^{2/3} \frac{\Sigma\rho}{2}.

    Args:
        first: Sum of both bodies' curvatures in one plane, positive [1/m].
        second: In the other, positive [1/m].
        softness: eta, sum of (1 - nu^2) / E of both [1/Pa].
    """
    from scipy.special import ellipe, ellipkm1

    total, uneven = first + second, abs(first - second) / (first + second)
    ratio = 1.0
    if uneven > 1e-9:

        def lack(log: float) -> float:
            square = math.exp(2.0 * log)
            whole = ellipe(1.0 - 1.0 / square)
            return (
                float(((square + 1.0) * whole - 2.0 * ellipkm1(1.0 / square)) / ((square - 1.0) * whole))
                - uneven
            )

        ratio = math.exp(root_between(lack, 1e-6, math.log(_LONGEST), absolute=1e-15))
    first_kind, second_kind = float(ellipkm1(ratio**-2)), float(ellipe(1.0 - ratio**-2))
    depth = 2.0 * first_kind / math.pi * (math.pi / (2.0 * ratio**2 * second_kind)) ** (1.0 / 3.0)
    depth *= (1.5 * softness / total) ** (2.0 / 3.0) * 0.5 * total
    return float(depth**-1.5)


def in_series(one: float, second: float) -> float:
    """Return K of two contacts under the same load [N/m^1.5]."""
    return float((one ** (-2.0 / 3.0) + second ** (-2.0 / 3.0)) ** -1.5)


Array = NDArray[np.float64]

# Ball's record, by the names of its layout.
_COSINE, _SINE, _HEIGHT, _RADIUS, _OFF, _ALONG, _REST, _HERTZ = range(8)


@dataclass(frozen=True, slots=True, kw_only=True)
class BallBearing(Bearing):
    r"""A preloaded angular-contact ball bearing, or a pair, by its dimensions: quasi-static, without speed.

    Each ball is pressed between the grooves of both raceways, whose centres of curvature are
    A = (f_i + f_o - 1) D apart unloaded, at the contact angle; it stands on the line between them, and its
    load follows from how far they are further apart,

    .. math:: Q = K \delta^{3/2}, \quad \delta = s - A, \quad K^{-2/3} = K_i^{-2/3} + K_o^{-2/3}

    with Hertz's point contacts K_i, K_o. The inner ring is rigid; balls stand at fixed, even azimuths. Left
    out are centrifugal force, gyroscopic torque of balls and friction.

    The preload is an axial force: of a pair that of each row on the other, of a single row one that an
    outside force of that size balances, which counts as part of it. ``linear`` takes the stiffness at the
    preload; ``balls`` sums over the balls at every instant, and contacts open.

    Attributes:
        count: Balls in a row.
        ball_diameter: D [m].
        pitch_diameter: d_m, of the circle of the balls' centres [m].
        contact_angle: Between load and the plane of the balls, unloaded [rad].
        preload: Axial force of each row [N].
        inner_conformity: f_i, groove radius over ball diameter [-].
        outer_conformity: f_o, likewise [-].
        modulus: Of elasticity, of rings and balls [Pa].
        poisson: Poisson's ratio of rings and balls [-].
        ball_modulus: Of the balls, if another (ceramic) [Pa].
        ball_poisson: Poisson's ratio of the balls, if another [-].
        arrangement: ``single``, its axial force on the inner ring along +z, or a pair, ``back-to-back`` or
            ``face-to-face``.
        spread: Distance of a pair's planes of balls [m].
        offset: Reference point, amid the balls, along the joint's axis from its origin [m].
        damping_time: beta, of damping in proportion to the stiffness at the preload [s].
        by: ``linear`` or ``balls``.

    References:
        Harris and Kotzalas, Rolling Bearing Analysis; Jones (1960), A general theory for elastically
        constrained ball and radial roller bearings.
    """

    count: int = parameter(rule="positive")
    ball_diameter: float = parameter("m", rule="positive")
    pitch_diameter: float = parameter("m", rule="positive")
    contact_angle: float = parameter("rad", rule="zero or more")
    preload: float = parameter("N", rule="positive")
    inner_conformity: float = parameter(rule="positive", default=0.52)
    outer_conformity: float = parameter(rule="positive", default=0.52)
    modulus: float = parameter("Pa", rule="positive", default=2.06e11)
    poisson: float = parameter(rule="above -1 and at most 0.5", default=0.3)
    ball_modulus: float | None = parameter("Pa", rule="positive", default=None)
    ball_poisson: float | None = parameter(rule="above -1 and at most 0.5", default=None)
    arrangement: Literal["single", "back-to-back", "face-to-face"] = "single"
    spread: float = parameter("m", rule="zero or more", default=0.0)
    offset: float = parameter("m", default=0.0)
    damping_time: float = parameter("s", rule="zero or more", default=0.0)
    by: Literal["linear", "balls"] = "linear"

    def __post_init__(self) -> None:
        """Check that it is a bearing."""
        Bearing.__post_init__(self)
        check_number(self, "count", self.count, "3 or more, or a direction would not be held")
        if not self.contact_angle < 0.5 * math.pi:
            raise InvalidParameterError(self, "contact_angle", "below a right angle", self.contact_angle)
        if not self.ball_diameter < self.pitch_diameter * math.sin(math.pi / self.count):
            most = self.pitch_diameter * math.sin(math.pi / self.count)
            rule = f"below {most:g} m, at which {self.count} balls touch one another"
            raise InvalidParameterError(self, "ball_diameter", rule, self.ball_diameter)
        for name in ("inner_conformity", "outer_conformity"):
            if not getattr(self, name) > 0.5:
                rule = "above 0.5: a groove is wider than its ball"
                raise InvalidParameterError(self, name, rule, getattr(self, name))
        if self.arrangement == "single" and self.spread:
            raise InvalidParameterError(self, "spread", "left out of a single row", self.spread)
        way = math.hypot(self._open * math.cos(self.contact_angle), self._along) - self._open
        if not way < 0.1 * self.ball_diameter:
            rule = "small: it presses balls in by more than a tenth of their diameter"
            raise InvalidParameterError(self, "preload", rule, self.preload)

    @property
    def _open(self) -> float:
        """A, distance of the grooves' centres unloaded [m]."""
        return (self.inner_conformity + self.outer_conformity - 1.0) * self.ball_diameter

    @property
    def hertz(self) -> float:
        """K of a ball between its raceways [N/m^1.5]."""
        inner, outer = (
            groove_contact(self.ball_diameter, conformity, gamma, self.softness)
            for conformity, gamma in self.grooves
        )
        return in_series(inner, outer)

    @property
    def softness(self) -> float:
        """Sum of (1 - nu^2) / E of ball and ring [1/Pa]."""
        poisson = self.poisson if self.ball_poisson is None else self.ball_poisson
        modulus = self.modulus if self.ball_modulus is None else self.ball_modulus
        return (1.0 - self.poisson**2) / self.modulus + (1.0 - poisson**2) / modulus

    @property
    def grooves(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Conformity and gamma of inner and outer raceway, as :func:`groove_contact` has them [-]."""
        gamma = self.ball_diameter * math.cos(self.contact_angle) / self.pitch_diameter
        return (self.inner_conformity, gamma), (self.outer_conformity, -gamma)

    @property
    def ellipses(self) -> list[Ellipse]:
        """Ellipses of contact of a ball with inner and outer raceway, under 1 N."""
        modulus = 1.0 / self.softness
        return [
            raceway_ellipse(self.ball_diameter, conformity, gamma, modulus)
            for conformity, gamma in self.grooves
        ]

    @property
    def ball_limit(self) -> float:
        """Load of a ball that ISO 76 permits, the less of both raceways [N]."""
        return min(map(ball_load_limit, self.ellipses))

    @property
    def axial_rating(self) -> float:
        """Static axial rating C_0a of a row by ISO 76 [N]."""
        return static_rating(self.count, self.contact_angle, self.ball_limit)[1]

    @property
    def rows(self) -> int:
        """Number of rows of balls."""
        return 1 if self.arrangement == "single" else 2

    @property
    def _along(self) -> float:
        """Axial distance of the grooves' centres under the preload [m]."""
        rest, angle, stiffness = self._open, self.contact_angle, self.hertz
        off = rest * math.cos(angle)

        def lack(along: float) -> float:
            way = math.hypot(off, along)
            depth = max(way - rest, 0.0)
            return self.count * stiffness * depth * math.sqrt(depth) * along / way - self.preload

        start = rest * math.sin(angle)
        # Enough at which a ball's load alone, on a line that is no steeper, is all.
        far = start + rest
        while lack(far) < 0.0:
            far *= 2.0
        return root_between(lack, start, far, absolute=1e-20)

    @property
    def loaded_angle(self) -> float:
        """Contact angle under the preload [rad]."""
        return math.atan2(self._along, self._open * math.cos(self.contact_angle))

    @property
    def scale(self) -> tuple[float, float] | None:
        """Depth of balls under the preload, and the radius of their circle [m]."""
        if self.by == "linear":
            return None
        way = math.hypot(self._open * math.cos(self.contact_angle), self._along)
        return way - self._open, 0.5 * self.pitch_diameter

    def balls(self) -> Array:
        """Return the balls of all rows, as the kernels' ``BALL``, (n, 8)."""
        angle, along, hertz = self.contact_angle, self._along, self.hertz
        inner = (self.inner_conformity - 0.5) * self.ball_diameter
        # The sense in which a row takes load from the inner ring, and its plane.
        rows = {
            "single": ((1.0, 0.0),),
            "back-to-back": ((-1.0, 0.5 * self.spread), (1.0, -0.5 * self.spread)),
            "face-to-face": ((1.0, 0.5 * self.spread), (-1.0, -0.5 * self.spread)),
        }[self.arrangement]
        found = np.zeros((len(rows), self.count, 8))
        azimuth = 2.0 * math.pi * np.arange(self.count) / self.count
        for row, (sense, plane) in zip(found, rows, strict=True):
            row[:, _COSINE], row[:, _SINE] = np.cos(azimuth), np.sin(azimuth)
            row[:, _HEIGHT] = plane + sense * inner * math.sin(angle)
            row[:, _RADIUS] = 0.5 * self.pitch_diameter + inner * math.cos(angle)
            row[:, _OFF], row[:, _ALONG] = self._open * math.cos(angle), sense * along
            row[:, _REST], row[:, _HERTZ] = self._open, hertz
        return found.reshape(-1, 8)

    @property
    def stiffness(self) -> Array:
        """K at the preload, over place and tilt at the reference point, (5, 5)."""
        total = np.zeros((5, 5))
        for c, s, height, radius, off, along, rest, hertz in self.balls():
            # How the way from groove to groove changes, off and along the axis.
            change = np.array(
                [[c, s, 0.0, -height * s, height * c], [0.0, 0.0, 1.0, radius * s, -radius * c]]
            )
            way = math.hypot(off, along)
            unit = np.array([off, along]) / way
            depth = way - rest
            line = np.outer(unit, unit)
            bend = hertz * (1.5 * depth**0.5 * line + depth**1.5 / way * (np.eye(2) - line))
            total += change.T @ bend @ change
        return total

    @property
    def springs(self) -> Matrix5:
        """Stiffness at the preload, none if its balls are summed over."""
        return self.stiffness if self.by == "linear" else np.zeros((5, 5))

    @property
    def dampers(self) -> Matrix5:
        """Damping in proportion."""
        return self.damping_time * self.stiffness

    @property
    def push(self) -> Numbers5:
        """Preload of a single row whose balls are summed over."""
        push = self.preload if self.by == "balls" and self.arrangement == "single" else 0.0
        return np.array([0.0, 0.0, push, 0.0, 0.0])

    @property
    def ball_count(self) -> int:
        """Number of balls that are summed over."""
        return len(self.balls()) if self.by == "balls" else 0

    def tail(self) -> tuple[float, ...]:
        """Return the balls' numbers, if they are summed over."""
        return tuple(self.balls().ravel()) if self.by == "balls" else ()

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        kind = "single row" if self.arrangement == "single" else f"{self.arrangement} pair"
        said = {
            "ball_diameter": f"{self.count} balls of",
            "pitch_diameter": "pitch diameter",
            "contact_angle": "contact angle",
            "preload": "preload",
            "damping_time": "damped in proportion by",
        }
        law = "stiffness at the preload" if self.by == "linear" else "summed over its balls"
        return f"ball bearing, {kind}, {', '.join(self.said_of(said, slides))}, {law}"
