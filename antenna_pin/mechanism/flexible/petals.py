"""Segmented dish: petals of a paraboloid on root springs around a hub."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.directions import unit
from antenna_pin.base.parameters import check, parameter
from antenna_pin.base.rules import A_DIRECTION, SWINGS
from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism.flexible.inertia import MassProperties
from antenna_pin.mechanism.flexible.parts import (
    BoxShape,
    CylinderShape,
    Drawn,
    ElasticPart,
    FlexibleKind,
    MeshShape,
    frame_with_z,
)

Array = NDArray[np.float64]

_STRIPS = 5  # boxes that a petal is drawn as, where there is no mesh
_THICKNESS = 0.012  # of these boxes, over the rim's radius
_MOST = 360  # petals: each is a body with a joint of its own
_NODES = 48  # of the Gauss rule along the radius: exact to round-off, as the integrand is smooth


def petal_body(
    mass: float, focal_length: float, inner: float, outer: float, half_angle: float
) -> MassProperties:
    r"""Return a uniform shell: a sector of the paraboloid z = r^2 / (4 f).

    .. math:: dm = \sigma \sqrt{1 + r^2 / (4 f^2)}\; r\,dr\,d\varphi

    Args:
        mass: [kg].
        focal_length: f [m].
        inner: Least radius [m].
        outer: Largest radius [m].
        half_angle: Half of the angle that the sector spans [rad].
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    r = 0.5 * (outer + inner) + 0.5 * (outer - inner) * nodes
    area = weights * r * np.sqrt(1.0 + (r / (2.0 * focal_length)) ** 2)
    z = r**2 / (4.0 * focal_length)
    a = half_angle
    # Integrals over the angle, divided by its span: of cos, cos^2 and sin^2.
    cos, cos2 = math.sin(a) / a, 0.5 + math.sin(2.0 * a) / (4.0 * a)
    share = mass * area / area.sum()
    first = np.array([cos * (share @ r), 0.0, share @ z])
    second = np.diag([cos2 * (share @ r**2), (1.0 - cos2) * (share @ r**2), share @ z**2])
    second[0, 2] = second[2, 0] = cos * (share @ (r * z))
    moments = np.zeros((4, 4))
    moments[:3, :3], moments[3, 3] = second, mass
    moments[:3, 3] = moments[3, :3] = first
    return MassProperties.of_moments(moments)


@dataclass(frozen=True, slots=True, kw_only=True)
class Petals(FlexibleKind):
    r"""A dish of petals on sprung root hinges; at rest a paraboloid.

    Each petal is a sector of a thin, even shell and turns about the tangent of the hub's rim at its root; to
    the positive side it closes. Frequency and damping ratio are those of a petal with the hub held.

    Attributes:
        petals: How many.
        mass: Of all petals together; the rest of the link is the hub [kg].
        rim_radius: Of the dish [m].
        hub_radius: Where the petals begin [m].
        focal_length: Of the paraboloid [m].
        vertex: Of the paraboloid, in the link's frame [m].
        boresight: Where the dish opens to, in the link's axes, any length but zero [-].
        frequency: Of a petal, undamped; or a stiffness is given [Hz].
        stiffness: Of a root spring, instead of a frequency [N*m/rad].
        damping_ratio: Of a petal [-].
        mesh: Of a petal: x along the boresight, origin at the vertex, the petal over the y axis; None for
            boxes.
        hub_mesh: Of the hub in the same axes; None for a disc.
        replaces: Visual shapes of the link that are the dish, and are not drawn any more.
    """

    petals: int = parameter("1", rule=f"from 2 to {_MOST}")
    mass: float = parameter("kg", rule="positive")
    rim_radius: float = parameter("m", rule="positive")
    hub_radius: float = parameter("m", rule="positive")
    focal_length: float = parameter("m", rule="positive")
    vertex: tuple[float, ...] = parameter("m", sizes=(3,), default=(0.0, 0.0, 0.0))
    boresight: tuple[float, ...] = parameter("1", rule=A_DIRECTION, sizes=(3,), default=(1.0, 0.0, 0.0))
    frequency: float | None = parameter("Hz", rule="positive", default=None)
    stiffness: float | None = parameter("N*m/rad", rule="positive", default=None)
    damping_ratio: float = parameter("1", rule=SWINGS, default=0.0)
    mesh: str | None = None
    hub_mesh: str | None = None
    replaces: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse what is no dish."""
        check(self)
        if not self.hub_radius < self.rim_radius:
            rule = f"below rim_radius = {self.rim_radius:g} m"
            raise InvalidParameterError(self, "hub_radius", rule)
        if (self.frequency is None) == (self.stiffness is None):
            got = "neither" if self.frequency is None else "both"
            raise InvalidParameterError(self, "frequency", "given, or stiffness instead of it", said=got)

    @property
    def body(self) -> MassProperties:
        """A petal in the dish's frame, z along the boresight, over the x axis."""
        return petal_body(
            self.mass / self.petals,
            self.focal_length,
            self.hub_radius,
            self.rim_radius,
            math.pi / self.petals,
        )

    @property
    def root(self) -> Array:
        """(3,) middle of that petal's root, where its hinge is [m]."""
        return np.array([self.hub_radius, 0.0, self.hub_radius**2 / (4.0 * self.focal_length)])

    @property
    def moment(self) -> float:
        """Moment of inertia of a petal about its hinge [kg m^2]."""
        body, arm = self.body, self.body.centre - self.root
        return float(body.inertia[1, 1] + body.mass * (arm[0] ** 2 + arm[2] ** 2))

    @property
    def natural_frequency(self) -> float:
        """Natural frequency of a petal with the hub held [Hz]."""
        if self.frequency is not None:
            return self.frequency
        assert self.stiffness is not None
        return math.sqrt(self.stiffness / self.moment) / (2.0 * math.pi)

    @property
    def frequencies(self) -> dict[str, float]:
        """Natural frequencies with the hub held, by petal [Hz]."""
        return {f"petal{k + 1}": self.natural_frequency for k in range(self.petals)}

    @property
    def removes(self) -> tuple[str, ...]:
        """Names of the link's shapes that are not drawn any more."""
        return self.replaces

    @property
    def placement(self) -> Array:
        """Dish's frame in the link's, z along the boresight, (4, 4)."""
        return frame_with_z(unit(self.boresight), np.array(self.vertex))

    @property
    def hub_shapes(self) -> tuple[Drawn, ...]:
        """Shapes drawn for the hub."""
        if self.hub_mesh is not None:
            return (MeshShape(self.hub_mesh, self.placement @ _MESH),)
        disc = np.eye(4)
        disc[2, 3] = 0.5 * self.root[2]
        thickness = max(self.root[2], _THICKNESS * self.rim_radius)
        return (CylinderShape(self.hub_radius, thickness, self.placement @ disc),)

    def parts(self, name: str, link: MassProperties) -> list[ElasticPart]:
        """Return the petals."""
        body, moment = self.body, self.moment
        omega = 2.0 * math.pi * self.natural_frequency
        found = []
        for k, key in enumerate(self.frequencies):
            place = self.placement @ _turned(2.0 * math.pi * k / self.petals)
            turn = place[:3, :3]
            found.append(
                ElasticPart.swinging(
                    moment,
                    omega,
                    self.damping_ratio,
                    name=f"{name}_{key}",
                    slides=False,
                    origin=turn @ self.root + place[:3, 3],
                    axis=-turn[:, 1],
                    body=body.moved(place),
                    drawn=self._drawn(place),
                )
            )
        return found

    def _drawn(self, place: Array) -> tuple[Drawn, ...]:
        if self.mesh is not None:
            return (MeshShape(self.mesh, place @ _MESH),)
        edges = np.linspace(self.hub_radius, self.rim_radius, _STRIPS + 1)
        boxes = []
        for low, high in zip(edges, edges[1:], strict=False):
            rise = (high**2 - low**2) / (4.0 * self.focal_length)
            slope = math.atan2(rise, high - low)
            width = 1.9 * 0.5 * (low + high) * math.tan(min(math.pi / self.petals, 1.0))
            box = np.eye(4)
            box[:3, :3] = [
                [math.cos(slope), 0.0, -math.sin(slope)],
                [0.0, 1.0, 0.0],
                [math.sin(slope), 0.0, math.cos(slope)],
            ]
            box[:3, 3] = [0.5 * (low + high), 0.0, (low**2 + high**2) / (8.0 * self.focal_length)]
            size = (math.hypot(high - low, rise), width, _THICKNESS * self.rim_radius)
            boxes.append(BoxShape(size, place @ box))
        return tuple(boxes)


# Axes of the meshes, x along the boresight and y over the petal, in the dish's, z and x.
_MESH = np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])


def _turned(angle: float) -> Array:
    turn = np.eye(4)
    turn[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    return turn
