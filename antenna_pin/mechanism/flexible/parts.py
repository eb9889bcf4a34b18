"""Elastic parts of flexible links, bodies on sprung and damped joints, and their kinds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from antenna_pin.mechanism.flexible.inertia import MassProperties

Array = NDArray[np.float64]

# --- elastic parts ------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class SphereShape:
    """A ball to draw.

    Attributes:
        radius: [m].
        placement: In the link's frame, (4, 4) [-, m].
    """

    radius: float
    placement: Array


@dataclass(frozen=True, slots=True, eq=False)
class CylinderShape:
    """A cylinder to draw, along the z of its placement.

    Attributes:
        radius: [m].
        length: [m].
        placement: In the link's frame, (4, 4) [-, m].
    """

    radius: float
    length: float
    placement: Array


@dataclass(frozen=True, slots=True, eq=False)
class BoxShape:
    """A box to draw.

    Attributes:
        size: Lengths along x, y, z, (3,) [m].
        placement: In the link's frame, (4, 4) [-, m].
    """

    size: tuple[float, float, float]
    placement: Array


@dataclass(frozen=True, slots=True, eq=False)
class MeshShape:
    """A mesh to draw.

    Attributes:
        filename: As the URDF is to name it.
        placement: In the link's frame, (4, 4) [-, m].
    """

    filename: str
    placement: Array


@dataclass(frozen=True, slots=True)
class Takes:
    """A shape of the rigid link that goes along with a part.

    Attributes:
        shape: Name of the link's ``<visual>``.
    """

    shape: str


Drawn = SphereShape | CylinderShape | BoxShape | MeshShape | Takes


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ElasticPart:
    r"""A body that leaves its link by one joint, against a spring and a damper.

    With the hub held it swings freely at :math:`\omega = \sqrt{k / D}` with the damping ratio
    :math:`c / (2 \omega D)`, where D is the mass (or moment of inertia) that the joint moves.

    Attributes:
        name: Of the part; joint and spring bear it too.
        slides: Whether the joint is prismatic, else it is a hinge.
        origin: (3,) where the joint is, in the link's frame [m].
        axis: (3,) unit, in the link's axes [-].
        body: What moves, in the link's frame, at rest.
        stiffness: [N/m], or [N m/rad].
        damping: [N s/m], or [N m s/rad].
        drawn: What is to be seen of it.
    """

    name: str
    slides: bool
    origin: Array
    axis: Array
    body: MassProperties
    stiffness: float
    damping: float
    drawn: tuple[Drawn, ...] = ()

    @classmethod
    def swinging(cls, moment: float, omega: float, ratio: float, **more: Any) -> ElasticPart:
        """Return a part by natural frequency and damping ratio with the hub held.

        Args:
            moment: Mass [kg] or moment of inertia [kg m^2] that the joint moves.
            omega: Natural angular frequency [rad/s].
            ratio: Damping ratio [-].
            **more: Other fields.
        """
        return cls(stiffness=moment * omega**2, damping=2.0 * ratio * omega * moment, **more)

    @property
    def moved(self) -> float:
        """Mass [kg] or moment of inertia about the axis [kg m^2] that the joint moves."""
        if self.slides:
            return self.body.mass
        arm = np.cross(self.axis, self.body.centre - self.origin)
        return float(self.axis @ self.body.inertia @ self.axis + self.body.mass * (arm @ arm))

    @property
    def frequency(self) -> float:
        """Natural frequency with the hub held, undamped [Hz]."""
        return math.sqrt(self.stiffness / self.moved) / (2.0 * math.pi)

    @property
    def damping_ratio(self) -> float:
        """Damping ratio with the hub held [-]."""
        return self.damping / (2.0 * math.sqrt(self.stiffness * self.moved))

    def with_drawn(self, drawn: tuple[Drawn, ...]) -> ElasticPart:
        """Return the same part, drawn as given."""
        return replace(self, drawn=drawn)

    def participation(self, root: Array) -> Array:
        r"""Return its participation factors about a point of the link, (6,) [sqrt(kg), sqrt(kg) m].

        Translation, then rotation, in the link's axes, of the mode scaled to unit modal mass: with the hub's
        acceleration a at the point, :math:`\ddot\eta + 2 \zeta \omega \dot\eta + \omega^2 \eta
        + \delta a = 0`.

        Args:
            root: (3,) the point, in the link's frame [m].
        """
        if self.slides:
            linear, angular = self.body.mass * self.axis, np.zeros(3)
        else:
            linear = self.body.mass * np.cross(self.axis, self.body.centre - self.origin)
            angular = self.body.inertia @ self.axis
        about = angular + np.cross(self.body.centre - root, linear)
        return np.concatenate([linear, about]) / math.sqrt(self.moved)


def frame_with_z(axis: Array, origin: Array) -> Array:
    """Return a placement (4, 4) with z along a unit axis, and a definite x."""
    placement = np.eye(4)
    start = np.zeros(3)
    start[int(np.argmin(np.abs(axis)))] = 1.0
    x = start - (start @ axis) * axis
    x /= np.linalg.norm(x)
    placement[:3, :3] = np.column_stack([x, np.cross(axis, x), axis])
    placement[:3, 3] = origin
    return placement


# --- kinds of flexible links --------------------------------------------------------------------------------


class FlexibleKind(Protocol):
    """A way to make a link flexible."""

    __slots__ = ()

    @property
    def frequencies(self) -> Mapping[str, float]:
        """Natural frequencies with the hub held, by part, without the link's name [Hz]."""
        ...

    @property
    def removes(self) -> tuple[str, ...]:
        """Names of the link's shapes that are not drawn any more."""
        return ()

    @property
    def hub_shapes(self) -> tuple[Drawn, ...]:
        """Shapes drawn for the hub, beside the link's own."""
        return ()

    def part_note(self, part: int, link: MassProperties) -> str:
        """Return a refusal's note on a part, such as its place in a file.

        Args:
            part: Its place in :meth:`parts`.
            link: The whole link.
        """
        return ""

    def parts(self, name: str, link: MassProperties) -> list[ElasticPart]:
        """Return the elastic parts of a link.

        Args:
            name: Of the flexible link; the parts' names begin with it.
            link: The whole link.
        """
        ...
