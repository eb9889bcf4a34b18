r"""Appendages from modal data of a finite-element code, each mode a body on a joint.

A mode that was scaled to unit modal mass acts on its hub through six numbers, its participation factors delta
= (t, r) in translation and rotation. A body on a joint does the same, to first order in its motion. A mass m
on a slide along d at p has :math:`\delta = \sqrt m\,(d,\; p \times d)`: t and r are at right angles, since a
slide is no screw. A hinge can carry the rest, for its body need not be balanced. Let u be the hinge's axis, L
the way from it to the body's mass centre b, across it along :math:`\hat t \times u` so that the centre moves
along :math:`\hat t`, and J the inertia about b. With :math:`D = m L^2 + J_{uu}`

.. math:: t = \frac{m L}{\sqrt D}\,\hat t, \qquad r - b \times t = \frac{J u}{\sqrt D}.

J u has a part along t too if the body has a product of inertia there. So *every* (t, r) but zero is a body on
a slide or on a hinge, exactly. With :math:`w u` the part across t of :math:`r_b = r - b \times t` and
:math:`x = m - t^2`, what the body needs is

.. math:: \sqrt D = \frac{w m}{x}, \quad J_{uu} = w \sqrt D, \quad J_{ut} = (\hat t \cdot r) \sqrt D,
          \quad L = \frac{|t| w}{x}.

It is heavier than the mode's effective mass t^2 by x, which is free: a small one makes the arm long and the
turns small. The place b is free as well; it settles w.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.parameters import check, parameter
from antenna_pin.base.rules import SWINGS
from antenna_pin.base.units import shown
from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism.flexible.inertia import (
    MassProperties,
    inertia_of,
    least_share,
    share_taken,
    shares_taken,
)
from antenna_pin.mechanism.flexible.parts import ElasticPart, FlexibleKind, SphereShape

Array = NDArray[np.float64]

# --- modes as bodies on joints ------------------------------------------------------------------------------

# Own second moments of a mass on a slide, as a share of those of so much of its link. They are free, since it
# does not turn on the hub: small, so that its place decides, but not zero, which no body has.
_OWN = 0.01
# What is below this of the rest, lengths counted in the link's radius of gyration, is round-off of the data.
_NOTHING = 1e-9
# Of a mode that asks for more where it belongs, the body goes to where it takes less.
_MUCH = 0.5
# Among which the body that takes least is looked for: places, masses and shapes.
_LEVERS, _LEAST_LEVER, _FACTORS, _FLATS = 9, 1e-3, (0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0), (0.1, 0.5, 0.9)
# Arms longer than so many radii of gyration gain nothing.
_LONG = 1e3


def sliding_mass(
    name: str, link: MassProperties, mass: float, direction: Array, place: Array, omega: float, ratio: float
) -> ElasticPart:
    """Return a mass on a slide.

    Args:
        name: Of the part.
        link: The whole link.
        mass: [kg].
        direction: (3,) unit, in the link's axes [-].
        place: (3,) of the mass, in the link's frame [m].
        omega: Natural angular frequency with the hub held [rad/s].
        ratio: Damping ratio with the hub held [-].
    """
    own = inertia_of(_OWN * mass / link.mass * link.spread)
    body = MassProperties(mass, place, own)
    return ElasticPart.swinging(
        mass, omega, ratio, name=name, slides=True, origin=place, axis=direction, body=body
    )


def balanced_rotor(
    name: str,
    link: MassProperties,
    inertia: float,
    direction: Array,
    place: Array,
    omega: float,
    ratio: float,
) -> ElasticPart:
    """Return a flat, balanced disc on a hinge through its centre.

    Its mass is free. It gets the share of the link's that it has of the link's inertia about its axis.

    Args:
        name: Of the part.
        link: The whole link.
        inertia: About the axis [kg m^2].
        direction: (3,) unit axis, in the link's axes [-].
        place: (3,) of the disc's centre, in the link's frame [m].
        omega: Natural angular frequency with the hub held [rad/s].
        ratio: Damping ratio with the hub held [-].
    """
    mass = link.mass * inertia / float(direction @ link.inertia @ direction)
    across = np.eye(3) - np.outer(direction, direction)
    spread = 0.5 * inertia * (across + _OWN * np.outer(direction, direction))
    body = MassProperties(mass, place, inertia_of(spread))
    return ElasticPart.swinging(
        inertia, omega, ratio, name=name, slides=False, origin=place, axis=direction, body=body
    )


def realised(
    name: str,
    link: MassProperties,
    translation: Array,
    rotation: Array,
    omega: float,
    ratio: float,
    *,
    least: bool = False,
) -> ElasticPart:
    """Return the body on a joint that acts on its hub as a mode does.

    The mass sits where the mode's forces act. If that takes more than half of a moment of the link, or
    ``least`` is requested, it is the body that takes least of some hundreds between there and the link's mass
    centre, on hinges of several arms.

    Args:
        name: Of the part.
        link: The whole link.
        translation: (3,) participation factors about the origin of the link's frame, in its axes [sqrt(kg)].
        rotation: (3,) likewise [sqrt(kg) m].
        omega: Natural angular frequency with the hub held [rad/s].
        ratio: Damping ratio with the hub held [-].
        least: Whether to take what takes the least of the link anyhow.
    """
    size, reach = float(np.linalg.norm(translation)), link.gyration
    about_centre = rotation - np.cross(link.centre, translation)
    turning = float(np.linalg.norm(about_centre))
    if size * reach <= _NOTHING * turning:
        return balanced_rotor(name, link, turning**2, about_centre / turning, link.centre, omega, ratio)
    along = translation / size
    pitch = float(along @ rotation)  # times size: the participation that a slide cannot have
    across = about_centre - (along @ about_centre) * along
    away = float(np.linalg.norm(across))
    if not least:
        part = _mode_as_mass(name, link, translation, rotation, across, pitch, omega, ratio)
        if share_taken(link, part.body) <= _MUCH:
            return part
    # No further than the radius of gyration from the link's mass centre, nearer than where it acts.
    high = away + size * reach
    low = min(max(abs(pitch), away - size * reach, _LEAST_LEVER * high), high)
    here = _mode_as_mass(name, link, translation, rotation, across, pitch, omega, ratio)
    levers, factors, flats = (
        grid.ravel()
        for grid in np.meshgrid(
            np.linspace(low, min(max(low, away), high), _LEVERS), _FACTORS, _FLATS, indexing="ij"
        )
    )
    extras = factors * (levers * size / reach + (levers / reach) ** 2)
    shares = shares_taken(link, _hinged_moments(link, translation, rotation, levers, extras, flats))
    best = int(np.argmin(shares))
    if share_taken(link, here.body) <= shares[best]:
        return here
    chosen = (float(levers[best]), float(extras[best]))
    return hinged(name, link, translation, rotation, *chosen, omega, ratio, float(flats[best]))


def _mode_as_mass(
    name: str,
    link: MassProperties,
    translation: Array,
    rotation: Array,
    across: Array,
    pitch: float,
    omega: float,
    ratio: float,
) -> ElasticPart:
    """Return a mode as a mass on a slide, or on a hinge."""
    size, reach = float(np.linalg.norm(translation)), link.gyration
    along = translation / size
    if abs(pitch) <= _NOTHING * size * reach:
        place = link.centre + np.cross(along, across) / size
        return sliding_mass(name, link, size**2, along, place, omega, ratio)
    arm = reach * min(math.sqrt(size * reach / abs(pitch)), _LONG)
    extra = abs(pitch) * size / max(arm, reach)
    return hinged(name, link, translation, rotation, abs(pitch), extra, omega, ratio)


def hinged(
    name: str,
    link: MassProperties,
    translation: Array,
    rotation: Array,
    lever: float,
    extra: float,
    omega: float,
    ratio: float,
    flat: float = 0.5,
) -> ElasticPart:
    """Return a mode as an unbalanced body on a hinge.

    Args:
        name: Of the part.
        link: The whole link, whose mass centre the body is put towards.
        translation: (3,) participation factors about the origin of the link's frame, not zero [sqrt(kg)].
        rotation: (3,) likewise [sqrt(kg) m].
        lever: w, the participation in rotation about the body's centre and across t [sqrt(kg) m].
        extra: x, the body's mass beyond the mode's effective mass [kg].
        omega: Natural angular frequency with the hub held [rad/s].
        ratio: Damping ratio with the hub held [-].
        flat: Which share of J_uu is of mass spread along t, the rest being across it [-].
    """
    axes, centres, masses, roots, spreads = _hinges(
        link, translation, rotation, *(np.array([one]) for one in (lever, extra, flat))
    )
    axis, centre, mass, root, spread = axes[0], centres[0], float(masses[0]), float(roots[0]), spreads[0]
    size = float(np.linalg.norm(translation))
    along = translation / size
    return ElasticPart.swinging(
        root**2,
        omega,
        ratio,
        name=name,
        slides=False,
        origin=centre - size * lever / extra * np.cross(along, axis),
        axis=axis,
        body=MassProperties(mass, centre, inertia_of(spread)),
    )


def _hinges(
    link: MassProperties, translation: Array, rotation: Array, levers: Array, extras: Array, flats: Array
) -> tuple[Array, Array, Array, Array, Array]:
    """Return n hinges' axes, (n, 3), and their bodies' centres, masses and moments.

    Args:
        link: The whole link, whose mass centre the bodies are put towards.
        translation: (3,) participation factors, as for :func:`hinged`.
        rotation: (3,) likewise.
        levers: w, (n,).
        extras: x, (n,).
        flats: (n,).
    """
    size = float(np.linalg.norm(translation))
    along = translation / size
    about_centre = rotation - np.cross(link.centre, translation)
    across = about_centre - (along @ about_centre) * along
    away = float(np.linalg.norm(across))
    other = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    aside = across / away if away > 0.0 else other
    far = away > 1e-9 * levers
    axes = np.where(far[:, None], aside, other / np.linalg.norm(other))
    # r_b across t is w u: from the link's centre, where it is `across`, by t x (across - w u) / t^2.
    centres = link.centre + np.cross(along, across - levers[:, None] * axes) / size
    masses = size**2 + extras
    roots = levers * masses / extras  # sqrt(D)
    spins, products = levers * roots, float(along @ rotation) * roots
    normals = np.cross(axes, along)
    thick = flats * spins  # second moments along t and n add up to J_uu
    askew = axes[:, :, None] * along

    def by(numbers: Array, squares: Array) -> Array:
        return np.asarray(numbers[:, None, None] * squares)

    spreads = (
        by(thick, np.outer(along, along)[None])
        + by(spins - thick, normals[:, :, None] * normals[:, None])
        - by(products, askew + askew.transpose(0, 2, 1))
        + by(products**2 / thick + _OWN * spins, axes[:, :, None] * axes[:, None])
    )
    return axes, centres, masses, roots, spreads


def _hinged_moments(
    link: MassProperties, translation: Array, rotation: Array, levers: Array, extras: Array, flats: Array
) -> Array:
    """Return the pseudo-inertias of the bodies of :func:`_hinges`, (n, 4, 4)."""
    _, centres, masses, _, spreads = _hinges(link, translation, rotation, levers, extras, flats)
    found = np.empty((len(masses), 4, 4))
    found[:, :3, :3] = spreads + masses[:, None, None] * centres[:, :, None] * centres[:, None]
    found[:, :3, 3] = found[:, 3, :3] = masses[:, None] * centres
    found[:, 3, 3] = masses
    return found


# --- appendages ---------------------------------------------------------------------------------------------

#: Names of the participation factors of a mode: translation, then rotation.
FACTORS = ("tx", "ty", "tz", "rx", "ry", "rz")
# A mode with less than that in all six has a mass that is none [sqrt(kg)], [sqrt(kg) m].
_FELT = 1e-50
# Radius of the ball that stands for a mode in pictures, over the link's radius of gyration.
_BALL = 0.08


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalData(FlexibleKind):
    r"""An appendage of a link by its fixed-root modes of unit modal mass.

    With the root's acceleration a, of its point and of turning, (6,), the force and moment F on the root,
    and M the inertia of the rigid whole, appendage included,

    .. math:: M a + \sum_i \delta_i \ddot\eta_i = F, \qquad
              \ddot\eta_i + 2 \zeta_i \omega_i \dot\eta_i + \omega_i^2 \eta_i + \delta_i \cdot a = 0.

    Attributes:
        frequency: Of each mode, undamped, in rising order or not [Hz].
        participation: Six numbers a mode, mode by mode: translation along x, y, z in sqrt(kg), rotation about
            them at the root in sqrt(kg) m [-].
        damping_ratio: One for all modes, or one for each [-].
        root_xyz: The appendage's root in the link's frame [m].
        root_rpy: Roll, pitch, yaw of the appendage's axes in the link's frame [rad].
        places: Where each mode stands in the file that they were read from, for messages; none if in none.
    """

    frequency: tuple[float, ...] = parameter("Hz", sizes=(0,), rule="positive", repr=False)
    participation: tuple[float, ...] = parameter("1", sizes=(0,), repr=False)
    damping_ratio: tuple[float, ...] = parameter("1", sizes=(0,), rule=SWINGS, default=(0.0,))
    root_xyz: tuple[float, ...] = parameter("m", sizes=(3,), default=(0.0, 0.0, 0.0))
    root_rpy: tuple[float, ...] = parameter("rad", sizes=(3,), default=(0.0, 0.0, 0.0))
    places: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse numbers that do not go together."""
        check(self)
        count = len(self.frequency)
        if count == 0:
            raise InvalidParameterError(self, "frequency", "at least one number", said="none")
        if len(self.participation) != 6 * count:
            rule = f"six numbers for each of {count} modes, {6 * count}"
            raise InvalidParameterError(self, "participation", rule, said=str(len(self.participation)))
        if len(self.damping_ratio) not in (1, count):
            rule = f"one number, or one for each of {count} modes"
            raise InvalidParameterError(self, "damping_ratio", rule, said=str(len(self.damping_ratio)))
        for k, row in enumerate(self.factors):
            if not np.abs(row).max() > _FELT:
                where = f"which no hub feels, at {self._place(k)}; leave the mode out"
                rule = f"other than six zeros, or nearly so, {where}"
                raise InvalidParameterError(self, "participation", rule, said=shown(row.tolist()))

    @property
    def factors(self) -> Array:
        """The participation factors, (n, 6)."""
        return np.array(self.participation).reshape(-1, 6)

    @property
    def frequencies(self) -> dict[str, float]:
        """Natural frequencies with the root held, by mode [Hz]."""
        return {f"mode{k + 1}": frequency for k, frequency in enumerate(self.frequency)}

    def about_link(self) -> Array:
        """Return the participation factors about the link frame's origin, in its axes, (n, 6)."""
        turn = _turn(*self.root_rpy)
        translation, rotation = self.factors[:, :3] @ turn.T, self.factors[:, 3:] @ turn.T
        return np.hstack([translation, rotation + np.cross(np.array(self.root_xyz), translation)])

    def _place(self, mode: int) -> str:
        return self.places[mode] if mode < len(self.places) else f"mode {mode + 1}"

    def part_note(self, part: int, link: MassProperties) -> str:
        """Return a mode's place in the file, and its largest effective mass.

        The square of a participation factor is the effective mass, or moment of inertia about the root. All
        modes together cannot have more than the rigid link has.
        """
        away = link.centre - np.array(self.root_xyz)
        about_root = link.inertia + link.mass * (away @ away * np.eye(3) - np.outer(away, away))
        turn = _turn(*self.root_rpy)
        whole = np.array([link.mass] * 3 + list(np.diag(turn.T @ about_root @ turn)))
        effective = self.factors[part] ** 2
        most = int(np.argmax(effective / whole))
        what, unit = ("mass", "kg") if most < 3 else ("moment of inertia about the root", "kg m^2")
        return (
            f"; {self._place(part)}, column {FACTORS[most]}: an effective {what} of {effective[most]:.4g} "
            f"{unit}, of the link's {whole[most]:.4g} {unit}"
        )

    def parts(self, name: str, link: MassProperties) -> list[ElasticPart]:
        """Return the bodies on joints that the modes are.

        Masses sit where their modes' forces act; where that does not leave a hub that can exist, all go where
        they take the least of the link.
        """
        ratios = np.broadcast_to(self.damping_ratio, len(self.frequency))
        found: list[ElasticPart] = []
        for least in (False, True):
            found = [
                self._drawn(
                    realised(
                        f"{name}_{key}",
                        link,
                        row[:3],
                        row[3:],
                        2.0 * math.pi * self.frequency[k],
                        float(ratios[k]),
                        least=least,
                    ),
                    link,
                )
                for k, (key, row) in enumerate(zip(self.frequencies, self.about_link(), strict=True))
            ]
            left = link.moments - sum(part.body.moments for part in found)
            if least_share(link, left) > 0.0:
                break
        return found

    @staticmethod
    def _drawn(part: ElasticPart, link: MassProperties) -> ElasticPart:
        ball = np.eye(4)
        ball[:3, 3] = part.body.centre
        return part.with_drawn((SphereShape(_BALL * link.gyration, ball),))


def _turn(roll: float, pitch: float, yaw: float) -> Array:
    """Return the rotation of URDF's angles, Rz(yaw) Ry(pitch) Rx(roll), (3, 3)."""
    turn = np.eye(3)
    for angle, (i, k) in ((roll, (1, 2)), (pitch, (2, 0)), (yaw, (0, 1))):
        one = np.eye(3)
        one[[i, k], [i, k]] = math.cos(angle)
        one[i, k], one[k, i] = -math.sin(angle), math.sin(angle)
        turn = one @ turn
    return np.asarray(turn)
