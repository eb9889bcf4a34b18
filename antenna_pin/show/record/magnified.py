"""Clearance joints drawn with every gap magnified by a number."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

# --- journal in a bore --------------------------------------------------------------------------------------
#
# A play of a tenth of a millimetre cannot be seen beside a journal of ten. Here the parts keep their size,
# the play is drawn M times as wide, and the journal is moved so that at every candidate contact the gap
# between the drawn surfaces is M times the recorded one. So drawn surfaces touch when the real ones do, and
# overlap by M times the real depth. The price is that the drawn journal is sheared rather than turned, for
# M times its tilt is no small angle.
#
# Revolute and planar joints, in bearing axes, with the eccentricities :math:`e_\pm` of the journal's axis at
# the bore's two end circles (:math:`|e| = C_r - gap`, towards the contact):
#
# .. math::  R_{bore} = R_j + M C_r, \qquad
#            x(z) = M \left[\tfrac12 (e_+ + e_-) + (e_+ - e_-) z / L_i\right]
#
# and for the flanges, with the tilt's sine and direction :math:`t = (z_J)_{xy}` and the edge radius R that
# counts, drawn as R':
#
# .. math::  z_\pm(x) = \pm \tfrac12 L_i \pm M (gap_\pm + R |t|) - M \frac{R}{R'}\, t \cdot x

Array = NDArray[np.float64]

_DRAWN = 0.3  # play as drawn, as a share of the journal's radius
_LONGEST = 10.0  # times its bore's radius a bearing is drawn long at most; beyond that its play is not seen


def default_magnification(radius: float, clearance: float) -> float:
    """Return the magnification that draws play as a third of a radius [m].

    It is 1, 1.5, 2, 3, 5 or 7 times a power of ten, at least 1. With more a ball would lie in a bowl; with
    less its motion in the play is not visible.
    """
    wanted = max(_DRAWN * radius / clearance, 1.0)
    power = 10.0 ** np.floor(np.log10(wanted))
    steps = power * np.array([1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0])
    return float(f"{steps[int(np.argmin(np.abs(np.log(steps / wanted))))]:.2g}")


def _directions(points: Array) -> Array:
    """Return unit vectors (n, k) along points; zero where a point has no direction."""
    norm = np.linalg.norm(points, axis=-1, keepdims=True)
    return points / np.where(norm > 0.0, norm, 1.0)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MagnifiedJournal:
    """The drawn parts of a revolute or planar joint and their motion, bearing axes."""

    factor: float  # M [-]
    journal_radius: float  # R_j, drawn as it is [m]
    bore_radius: float  # of the drawn bore [m]
    length: float  # of bore and bearing as drawn [m]; a long one is shortened
    outer_radius: float  # of the drawn bearing [m]
    shortened: float = 1.0  # real length over the drawn one [-]
    edge_radius: float = 0.0  # of the edge at which flanges touch, as it is [m]; 0 without flanges
    drawn_edge: float = 0.0  # of the same as drawn [m]
    flange_radius: float = 0.0  # of the drawn flanges [m]; 0 without
    flange_gap: float = 0.0  # C_a as drawn, M times as wide as it is [m]

    @classmethod
    def of(cls, dimensions: dict[str, Any], factor: float) -> MagnifiedJournal:
        """Return the drawing of a joint of some dimensions, M times its play."""
        journal = float(dimensions["journal_radius"])
        play = factor * (float(dimensions["bearing_radius"]) - journal)
        bore = journal + play
        if "bearing_length" not in dimensions:
            return cls(
                factor=factor,
                journal_radius=journal,
                bore_radius=bore,
                length=max(1.6 * journal, 0.5 * bore),  # it has none of its own
                outer_radius=1.16 * bore,
            )
        real_outer, real_flange = (float(dimensions[k]) for k in ("bearing_outer_radius", "flange_radius"))
        real_length = float(dimensions["bearing_length"])
        length = min(real_length, _LONGEST * bore)
        outer = max(real_outer + play, 1.16 * bore)
        covers = real_flange >= real_outer
        # A flange that covers the bearing's edge does so at every eccentricity, a smaller one at none.
        flange = (
            outer + (real_flange - real_outer) + 1.1 * play if covers else max(0.9 * outer - play, journal)
        )
        return cls(
            factor=factor,
            journal_radius=journal,
            bore_radius=bore,
            length=length,
            shortened=real_length / length,
            edge_radius=min(real_outer, real_flange),
            drawn_edge=outer if covers else flange,
            outer_radius=outer,
            flange_radius=flange,
            flange_gap=factor * 0.5 * (float(dimensions["flange_distance"]) - real_length),
        )

    @property
    def flanges(self) -> bool:
        """Return whether the journal has flanges."""
        return self.flange_radius > 0.0

    @property
    def covered(self) -> bool:
        """Return whether the flanges cover the bearing's edge, which then touches."""
        return self.drawn_edge == self.outer_radius

    @property
    def flange_thickness(self) -> float:
        """Radius of the drawn flanges [m]."""
        return 0.12 * self.bore_radius

    def eccentricity(self, gap: Array, point: Array) -> Array:
        """Return drawn centres at radial contacts (n, contacts, 2) [m], by recorded gaps and points."""
        play = (self.bore_radius - self.journal_radius) / self.factor
        return self.factor * (play - gap)[..., None] * _directions(point[..., :2])

    def barrel(self, centres: Array, shift: Array) -> Array:
        """Return the placement of the drawn barrel, a shear, (n, 3, 4).

        ``centres`` are those of :meth:`eccentricity`, ``shift`` that along the axis as drawn, (n,) [m].
        """
        upper, lower = centres[:, 0], centres[:, -1]
        result = np.zeros((len(centres), 3, 4))
        result[:, [0, 1, 2], [0, 1, 2]] = 1.0
        slope = (upper - lower) / self.length
        result[:, :2, 2] = slope
        result[:, :2, 3] = 0.5 * (upper + lower) + slope * shift[:, None]
        result[:, 2, 3] = shift
        return result

    def flange(self, sign: float, gap: Array, tilt: Array, centres: Array) -> Array:
        """Return the placement of a drawn flange's inner face, (n, 3, 4).

        Args:
            sign: +1 for the flange at +z, -1 for the other.
            gap: Of this flange, as recorded, (n,) [m].
            tilt: x and y of the journal's unit axis, (n, 2) [-].
            centres: Drawn centres at the +z and -z ends, (n, 2, 2) [m].
        """
        upper, lower = centres[:, 0], centres[:, -1]
        middle, slope = 0.5 * (upper + lower), (upper - lower) / self.length
        sine = np.linalg.norm(tilt, axis=1)
        face = sign * (0.5 * self.length + self.factor * (gap + self.edge_radius * sine))
        fall = self.factor * (self.edge_radius / self.drawn_edge) * tilt
        if self.covered:  # the face is laid over the bearing's edge, whose middle is the bearing's
            z = (face - np.sum(fall * middle, axis=1)) / (1.0 + np.sum(fall * slope, axis=1))
        else:  # the flange's own edge about its own middle
            z = face
        result = np.zeros((len(gap), 3, 4))
        result[:, [0, 1, 2], [0, 1, 2]] = 1.0
        result[:, 2, :2] = -fall
        result[:, :2, 2] = slope
        result[:, :2, 3] = middle + slope * z[:, None]
        result[:, 2, 3] = z
        return result

    def radial_points(self, sign: float, point: Array) -> Array:
        """Return drawn contacts in the bore, (n, 3) [m]; ``sign`` 0 in a plane."""
        result = np.full(point.shape, 0.5 * sign * self.length)
        result[:, :2] = self.bore_radius * _directions(point[:, :2])
        return result

    def axial_points(self, sign: float, point: Array, placement: Array) -> Array:
        """Return drawn contacts at a flange, (n, 3) [m], by its :meth:`flange`."""
        result = np.full(point.shape, 0.5 * sign * self.length)
        # With parallel axes a point load acts on the axis, so its place is neither rim.
        out = point[:, :2] / self.edge_radius
        result[:, :2] = self.drawn_edge * out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1.0)
        if not self.covered:
            result[:, :2] += placement[:, :2, 3]
        return result


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MagnifiedBall:
    """Drawn ball and socket, bearing axes: M [-] and radii [m]."""

    factor: float
    ball_radius: float
    socket_radius: float

    @classmethod
    def of(cls, dimensions: dict[str, Any], factor: float) -> MagnifiedBall:
        """Return the drawing of a joint of some dimensions, M times its play."""
        ball = float(dimensions["ball_radius"])
        play = float(dimensions["socket_radius"]) - ball
        return cls(factor=factor, ball_radius=ball, socket_radius=ball + factor * play)

    def centre(self, gap: Array, position: Array) -> Array:
        """Return the drawn centre of the ball, (n, 3) [m], by gap and place."""
        play = (self.socket_radius - self.ball_radius) / self.factor
        return self.factor * (play - gap)[:, None] * _directions(position)

    def points(self, point: Array) -> Array:
        """Return drawn contacts, (n, 3) [m], for those recorded, (n, 3) [m]."""
        return self.socket_radius * _directions(point)


# --- slider in a guide --------------------------------------------------------------------------------------
#
# As in :mod:`antenna_pin.show.record.magnified` the parts keep their size, play and displacements are drawn M
# times as large, and drawn surfaces touch when the real ones do. In the section's axes the guide's sides
# are those of the slider and M times the play. The centre of a corner's rounding, at c in the slider, is
# drawn at
#
# .. math:: c + M \left[p + (R - 1) c\right]
#
# across the axis, with the slider's place p and rotation R, and the rounding of radius r about it. A
# corner's gap to a wall is then M times the real one at any tilt, and what is drawn is an affine picture of
# the slider. Along the axis nothing is magnified; where the guide has no end the picture goes along with
# the slider.


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MagnifiedSlider:
    """The drawn parts of a slider in its guide, and their motion."""

    factor: float  # M [-]
    size: Array  # of the slider, drawn as it is, (3,) [m]
    guide: Array  # width and height of the drawn guide, (2,) [m]
    corner_radius: float  # of the slider's edges [m]
    roll: float  # of the section, from the bearing's axes [rad]
    length: float = 0.0  # of the guide [m]; 0 for one without end

    @classmethod
    def of(cls, dimensions: dict[str, Any], factor: float) -> MagnifiedSlider:
        """Return the drawing of a joint of some dimensions, M times its play."""
        size = np.array([float(dimensions[f"slider_{side}"]) for side in ("width", "height", "length")])
        guide = np.array([float(dimensions[f"guide_{side}"]) for side in ("width", "height")])
        return cls(
            factor=factor,
            size=size,
            guide=size[:2] + factor * (guide - size[:2]),
            corner_radius=float(dimensions["corner_radius"]),
            roll=float(dimensions["roll"]),
            length=float(dimensions.get("guide_length", 0.0)),
        )

    @property
    def turn(self) -> Array:
        """Rotation from the section's axes to the bearing's, (3, 3)."""
        c, s = math.cos(self.roll), math.sin(self.roll)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    def _affine(self, position: Array, attitude: Array) -> tuple[Array, Array]:
        """Return the affine map of drawn rounding centres, section axes."""
        turn = self.turn
        real = turn.T @ Rotation.from_quat(attitude).as_matrix() @ turn
        stretch = np.array([self.factor, self.factor, 1.0])[:, None]
        along = 1.0 if self.length else 0.0
        return np.eye(3) + stretch * (real - np.eye(3)), (position @ turn) * [self.factor, self.factor, along]

    def slider(self, position: Array, attitude: Array) -> Array:
        """Return the placement of the drawn slider, a box in bearing axes, (n, 3, 4).

        ``position`` of its centre (n, 3) [m] and ``attitude`` (quaternions xyzw, (n, 4)) are as recorded.
        """
        matrix, shift = self._affine(position, attitude)
        half, r = 0.5 * self.size, self.corner_radius
        # A corner is drawn its rounding's radius beyond the centre of it, along the walls' normals.
        placed = (matrix * (half - r) + r * np.eye(3)) / half
        turn = self.turn
        return np.concatenate([turn @ placed @ turn.T, (shift @ turn.T)[:, :, None]], axis=2)

    def axis(self, position: Array, attitude: Array, sign: float) -> Array:
        """Return the drawn end of the slider's axis, +z or -z, (n, 3) [m]."""
        placed = self.slider(position, attitude)
        return np.asarray(placed[:, :, 3] + 0.5 * sign * self.size[2] * placed[:, :, 2])

    def point(self, end: str, position: Array, attitude: Array) -> Array:
        """Return a drawn contact, on its wall at its corner, bearing axes, (n, 3) [m].

        The end ``+x-y+z`` is the wall at +x and there the corner at -y and +z.
        """
        sign = {end[k + 1]: 1.0 if end[k] == "+" else -1.0 for k in (0, 2, 4)}
        signs, wall = np.array([sign[axis] for axis in "xyz"]), "xy".index(end[1])
        matrix, shift = self._affine(position, attitude)
        drawn = matrix @ (signs * (0.5 * self.size - self.corner_radius)) + shift
        if self.length:  # beyond a mouth it is the mouth that touches
            out = drawn[:, 2] - np.clip(drawn[:, 2], -0.5 * self.length, 0.5 * self.length)
            drawn -= (out / matrix[:, 2, 2])[:, None] * matrix[:, :, 2]
        drawn[:, wall] = 0.5 * signs[wall] * self.guide[wall]
        return np.asarray(drawn @ self.turn.T)
