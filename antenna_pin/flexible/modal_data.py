"""An appendage from the modal data of a finite-element code."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.parameters import SWINGS, check, parameter
from antenna_pin.base.units import shown
from antenna_pin.errors import InvalidParameterError
from antenna_pin.flexible.inertia import MassProperties, least_share
from antenna_pin.flexible.kind import FlexibleKind
from antenna_pin.flexible.part import ElasticPart, SphereShape
from antenna_pin.flexible.realised import realised

__all__ = ["ModalData"]

Array = NDArray[np.float64]

# What the numbers of a mode are called, in files too.
_COLUMNS = ("tx", "ty", "tz", "rx", "ry", "rz")
# A mode with less than that in all six has a mass that is none [sqrt(kg)], [sqrt(kg) m].
_FELT = 1e-50
# Radius of the ball that stands for a mode in pictures, over the link's radius of gyration.
_BALL = 0.08


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalData(FlexibleKind):
    r"""An appendage of a link by its modes with the root held, scaled to unit modal mass.

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
        """Return the participation factors about the origin of the link's frame, in its axes, (n, 6)."""
        turn = _turn(*self.root_rpy)
        translation, rotation = self.factors[:, :3] @ turn.T, self.factors[:, 3:] @ turn.T
        return np.hstack([translation, rotation + np.cross(np.array(self.root_xyz), translation)])

    def _place(self, mode: int) -> str:
        return self.places[mode] if mode < len(self.places) else f"mode {mode + 1}"

    def told_of(self, part: int, link: MassProperties) -> str:
        """Return where a mode stands, and which of its numbers answers with most of the rigid whole.

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
            f"; {self._place(part)}, column {_COLUMNS[most]}: an effective {what} of {effective[most]:.4g} "
            f"{unit}, of the link's {whole[most]:.4g} {unit}"
        )

    def parts(self, name: str, link: MassProperties) -> list[ElasticPart]:
        """Return the bodies on joints that the modes are.

        Masses sit where their modes' forces act; where that does not leave a hub that can exist, all go where
        they take the least of the link.

        Args:
            name: Of the flexible link; the parts' names begin with it.
            link: The whole link.
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
