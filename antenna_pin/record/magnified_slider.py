r"""A slider in a guide drawn so that every gap is shown a given number of times wider than it is.

As in :mod:`antenna_pin.record.magnified` the parts keep their size, play and displacements are drawn M times
as large, and drawn surfaces touch when the real ones do. In the section's axes the guide's sides are those of
the slider and M times the play. The centre of a corner's rounding, at c in the slider, is drawn at

.. math:: c + M \left[p + (R - 1) c\right]

across the axis, with the slider's place p and rotation R, and the rounding of radius r about it. A corner's
gap to a wall is then M times the real one at any tilt, and what is drawn is an affine picture of the slider.
Along the axis nothing is magnified; where the guide has no end the picture goes along with the slider.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

__all__ = ["MagnifiedSlider"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MagnifiedSlider:
    """The drawn parts of a slider in its guide, and their motion.

    Attributes:
        factor: M [-].
        size: Of the slider, drawn as it is, (3,) [m].
        guide: Width and height of the drawn guide, (2,) [m].
        corner_radius: Of the slider's edges [m].
        roll: Of the section, from the bearing's axes [rad].
        length: Of the guide [m]; 0 for one without end.
    """

    factor: float
    size: Array
    guide: Array
    corner_radius: float
    roll: float
    length: float = 0.0

    @classmethod
    def of(cls, dimensions: dict[str, Any], factor: float) -> MagnifiedSlider:
        """Return the drawing of a joint.

        Args:
            dimensions: Of its shape, as the run carries them [m, rad].
            factor: M, positive [-].
        """
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
        """Return what the centres of roundings are drawn by, section axes: (n, 3, 3) and (n, 3)."""
        turn = self.turn
        real = turn.T @ Rotation.from_quat(attitude).as_matrix() @ turn
        stretch = np.array([self.factor, self.factor, 1.0])[:, None]
        along = 1.0 if self.length else 0.0
        return np.eye(3) + stretch * (real - np.eye(3)), (position @ turn) * [self.factor, self.factor, along]

    def slider(self, position: Array, attitude: Array) -> Array:
        """Return the placement of the drawn slider, a box of its size in bearing axes, (n, 3, 4).

        Args:
            position: Of the slider's centre, bearing axes, (n, 3) [m].
            attitude: Its quaternions xyzw, (n, 4).
        """
        matrix, shift = self._affine(position, attitude)
        half, r = 0.5 * self.size, self.corner_radius
        # A corner is drawn its rounding's radius beyond the centre of it, along the walls' normals.
        placed = (matrix * (half - r) + r * np.eye(3)) / half
        turn = self.turn
        return np.concatenate([turn @ placed @ turn.T, (shift @ turn.T)[:, :, None]], axis=2)

    def axis(self, position: Array, attitude: Array, sign: float) -> Array:
        """Return where the slider's axis is drawn at its end at +z or -z, bearing axes, (n, 3) [m].

        Args:
            position: As of :meth:`slider`.
            attitude: As of :meth:`slider`.
            sign: +1 or -1.
        """
        placed = self.slider(position, attitude)
        return np.asarray(placed[:, :, 3] + 0.5 * sign * self.size[2] * placed[:, :, 2])

    def point(self, end: str, position: Array, attitude: Array) -> Array:
        """Return a drawn contact, on its wall at its corner, bearing axes, (n, 3) [m].

        Args:
            end: Of the contact, such as ``+x-y+z``: the wall at +x and there the corner at -y and +z.
            position: As of :meth:`slider`.
            attitude: As of :meth:`slider`.
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
