"""Shapes of joints with play: their description, and backends of distance queries."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.directions import direction
from antenna_pin.base.parameters import check
from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.dimension import RADIAL, Play, dimensions_of

Vector3 = NDArray[np.float64]
Motion = Literal["turn", "slide"]


class ContactPoint(NamedTuple):
    """Candidate contact of journal and bearing, in bearing axes."""

    gap: float  # [m]; positive apart, so its zero can be located
    normal: Vector3  # (3,), unit, from the bearing into the journal
    point: Vector3  # (3,) [m], from the bearing's centre

    @property
    def depth(self) -> float:
        """Penetration depth [m], zero when apart."""
        return max(-self.gap, 0.0)


class ContactPlace(NamedTuple):
    """Place of a candidate contact on a joint."""

    kind: str  # group of laws of the joint, and name in figures: radial, axial, ...
    end: str = ""  # end among several of its kind: +, -, ...

    @property
    def name(self) -> str:
        """Kind and end in one word."""
        return self.kind + self.end


class Distances(Protocol):
    """Backend: measures gaps in a run in place of the compiled closed form.

    Equal arguments must give equal results, to a billionth of the play: a search may start from the last
    result, but a gap that depends on earlier calls (wear, chance) ends the run as ``FUNCTION_WITH_MEMORY``.
    """

    def query(
        self, pose: NDArray[Any], table: NDArray[Any], row: int, wanted: Sequence[float] | None = None
    ) -> None:
        """Fill gap, normal and point of a joint's rows of a contact table.

        Args:
            pose: :data:`antenna_pin.base.records.POSE` of the journal, (1,).
            table: :data:`antenna_pin.base.records.CONTACT`, (rows,).
            row: The joint's first row.
            wanted: Contacts to query (nonzero); all if not given. The others' rows need not be
                valid.
        """


class ClearanceGeometry(Protocol):
    """Shape of a joint with play: candidate contacts and freedom.

    A kind of joint with play is one class of this protocol, from :class:`Shape`, in a file of its own with a
    line in ``geometry/registry.py``.
    """

    @property
    def kind(self) -> str:
        """Name in results and for readers: revolute, planar, ..."""

    @property
    def contact_places(self) -> tuple[ContactPlace, ...]:
        """Places of the candidate contacts, in the order of their rows."""

    @property
    def radial_clearance(self) -> float:
        """The play that lengths in the joint are measured against [m]."""

    @property
    def section_radius(self) -> float:
        """Size of the hollow [m]; a hundredth of it is the default depth limit."""

    @property
    def half_length(self) -> float | None:
        """Lever over which the play limits the tilt [m]; None if it does not."""

    @property
    def patch_radius(self) -> float | None:
        """Radius of the circle of a distributed flange load's sectors [m], or None."""

    @property
    def planar(self) -> bool:
        """Return whether the joint is planar: three degrees of freedom, else six."""

    @property
    def motion(self) -> Motion | None:
        """Purpose of the joint: turning about the bearing's axis, sliding along it, neither."""

    def candidates(self, axes: ArrayLike) -> NDArray[np.float64]:
        """Return the records of the candidate contacts as flat numbers, (contacts, CANDIDATE).

        Args:
            axes: Columns are the bearing frame's axes in the joint frame, (3, 3).
        """

    def coal(self, axes: ArrayLike) -> Distances:
        """Return the queries of coal for the same distances; ``axes`` as of :meth:`candidates`."""


class Shape:
    """Base of shapes: a frozen dataclass of dimensions, with members beyond those of their protocol.

    A scenario's table of the kind follows from its fields
    (:func:`~antenna_pin.joints.geometry.dimension.dimension`) and ``plays``.

    Attributes:
        plays: Plays between two of its dimensions.
        no_line: What touches, where no law of contact along a line can hold; "" if one can.
        ends: Number of contacts that share a line along the bearing [-].
        sharp: The key that a Hertz stiffness needs and may be zero, and why; "" where there is none.
    """

    __slots__ = ()

    plays: ClassVar[tuple[Play, ...]] = ()
    no_line: ClassVar[str] = ""
    ends: ClassVar[int] = 1
    sharp: ClassVar[str] = ""

    def __post_init__(self) -> None:
        """Check the dimensions."""
        check_dimensions(self)

    @property
    def patch_radius(self) -> float | None:
        """None: the load acts at points."""
        return None

    @property
    def axial_clearance(self) -> float | None:
        """None: without flanges."""
        return None

    def contacts(
        self: ClearanceGeometry, p_HJ: ArrayLike, attitude: ArrayLike = (0.0, 0.0, 1.0)
    ) -> tuple[ContactPoint, ...]:
        """Return the candidate contacts of a pose (:func:`~antenna_pin.joints.geometry.pose_of`)."""
        return points_of_table(closed_form(self, pose_of(p_HJ, attitude)))


class _Radii(Protocol):
    """The two radii of a round part in a round hollow [m]."""

    @property
    def bearing_radius(self) -> float: ...

    @property
    def journal_radius(self) -> float: ...


class RoundShape(Shape):
    """A round part in a round hollow."""

    __slots__ = ()

    plays: ClassVar[tuple[Play, ...]] = (RADIAL,)

    @property
    def section_radius(self: _Radii) -> float:
        """R_i, the size of the hollow [m]."""
        return self.bearing_radius

    @property
    def radial_clearance(self: _Radii) -> float:
        """C_r, the hollow's radius less that of the part inside [m]."""
        return self.bearing_radius - self.journal_radius

    @property
    def contact_radius(self: _Radii) -> float:
        """Effective radius of curvature of a contact, R_i R_j / C_r [m]."""
        return self.bearing_radius * self.journal_radius / (self.bearing_radius - self.journal_radius)


def pose_of(p_HJ: ArrayLike, attitude: ArrayLike) -> NDArray[Any]:
    """Return a journal's pose at rest as a record, (1,).

    Args:
        p_HJ: Journal's centre from the bearing's centre, bearing axes, (3,) [m].
        attitude: Direction of the journal's axis in bearing axes, (3,), normalised here; or its rotation
            R_HJ, (3, 3).
    """
    p = np.asarray(p_HJ, dtype=float)
    given = np.asarray(attitude, dtype=float)
    if p.shape != (3,) or given.shape not in ((3,), (3, 3)) or not np.isfinite([*p, *given.ravel()]).all():
        raise InvalidParameterError(
            "contacts", "pose", "three finite numbers, and a vector (3,) or rotation (3, 3)", (p, given)
        )
    pose = np.zeros(1, POSE)
    pose["centre"] = p
    if given.ndim == 2:
        pose["rotation"] = given
        axis = given[:, 2]
    else:
        axis = direction(given, "contacts", "attitude")
        pose["rotation"] = _smallest_rotation(axis)
    pose["axis"] = axis
    pose["sine"] = math.sqrt(axis[0] ** 2 + axis[1] ** 2)
    return pose


def _smallest_rotation(axis: Vector3) -> NDArray[np.float64]:
    """Return the rotation by the shortest way that takes the z axis to an axis."""
    x, y, z = axis
    if z < -1.0 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    f = 1.0 / (1.0 + z)
    return np.array([[1.0 - f * x * x, -f * x * y, x], [-f * x * y, 1.0 - f * y * y, y], [-x, -y, z]])


def points_of_table(table: NDArray[Any]) -> tuple[ContactPoint, ...]:
    """Return the rows of a contact table as named values."""
    return tuple(ContactPoint(float(row["gap"]), row["normal"].copy(), row["point"].copy()) for row in table)


def closed_form(shape: ClearanceGeometry, pose: NDArray[Any]) -> NDArray[Any]:
    """Return the contact table of a shape in a pose (see :func:`pose_of`), (contacts,)."""
    table = np.zeros(len(shape.contact_places), CONTACT)
    kernels.fill(shape.candidates(np.eye(3)).ravel(), pose, table)
    return table


def queried_contacts(backend: Distances, contacts: int, pose: NDArray[Any]) -> tuple[ContactPoint, ...]:
    """Return the candidate contacts that a backend finds in a pose."""
    table = np.zeros(contacts, CONTACT)
    backend.query(pose, table, 0)
    return points_of_table(table)


def flat(layout: np.dtype[Any], *rows: tuple[Any, ...]) -> NDArray[np.float64]:
    """Return records as rows of plain 8-byte numbers, (len(rows), words)."""
    return np.array(list(rows), dtype=layout).view(np.float64).reshape(len(rows), -1)


def check_dimensions(shape: Any) -> None:
    """Check the dimensions of a shape by their declarations: units, rules, order."""
    check(shape)
    for name, one in dimensions_of(type(shape)).items():
        if one.below:
            require_below(shape, name, one.below)
        if one.above and not getattr(shape, name) > getattr(shape, one.above):
            raise InvalidParameterError(shape, name, f"above {one.above} = {getattr(shape, one.above):g} m")


def require_below(shape: object, name: str, other: str) -> None:
    """Refuse a dimension that is not smaller than another."""
    most = getattr(shape, other)
    if not getattr(shape, name) < most:
        raise InvalidParameterError(shape, name, f"below {other} = {most:g} m")
