"""A backend of a user's as it is asked: for the rows of its joint and nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.answers import asked
from antenna_pin.errors import FunctionError
from antenna_pin.geometry.base import Distances
from antenna_pin.records import CONTACT

__all__ = ["OwnBackend"]

_RULE = "a finite gap and point, and a finite unit normal, of each contact asked for, and change nothing else"
_UNIT = 1e-6  # that a normal's length may be off by
_GIVEN = ("gap", "normal", "point")


class OwnBackend:
    """A backend whose answers are looked at.

    It gets a table of its own, so that it cannot write into what belongs to others.

    Args:
        name: Whose it is and what it is called.
        distances: The backend.
        contacts: Of its joint.
    """

    def __init__(self, name: str, distances: Distances, contacts: int) -> None:
        """Allocate nothing yet: how long the table is, is seen when it is asked."""
        self.name = name
        self._distances, self._contacts = distances, contacts
        self._table = np.zeros(0, CONTACT)

    def query(
        self, pose: NDArray[Any], table: NDArray[Any], row: int, wanted: Sequence[float] | None = None
    ) -> None:
        """Fill gap, normal and point of the joint's rows (:class:`Distances`).

        Raises:
            FunctionError: It raises something, or what it fills in is not what it should be.
        """
        if len(self._table) != len(table):
            self._table = np.zeros_like(table)
        rows, before = slice(row, row + self._contacts), pose.tobytes()
        own = self._table[rows]
        for name in _GIVEN:
            own[name] = np.nan
        more = () if wanted is None else (list(wanted),)
        asked(self.name, self.told(pose), _RULE, self._distances.query, pose, self._table, row, *more)
        if pose.tobytes() != before:
            pose[:] = np.frombuffer(before, pose.dtype)
            raise self._refused(pose, "a pose that it had changed")
        for k, row_of in enumerate(own):
            if wanted is not None and not wanted[k]:
                continue
            normal = row_of["normal"]
            numbers = (row_of["gap"], *normal, *row_of["point"])
            if not np.isfinite(numbers).all():
                raise self._refused(pose, self._got(row_of, k))
            if not abs(float(normal @ normal) - 1.0) <= 2.0 * _UNIT:
                raise self._refused(pose, self._got(row_of, k))
        for name in _GIVEN:
            table[name][rows] = own[name]

    def told(self, pose: NDArray[Any]) -> str:
        """Return a question in words."""
        x, y, z = pose["centre"][0].tolist()
        return f"journal at x = {x:.9g} m, y = {y:.9g} m, z = {z:.9g} m in its bearing"

    def _got(self, row: Any, number: int) -> str:
        said = ", ".join(f"{name} {np.array2string(row[name], precision=6)}" for name in _GIVEN)
        return f"{said} for contact {number}"

    def _refused(self, pose: NDArray[Any], got: str) -> FunctionError:
        return FunctionError(self.name, self.told(pose), _RULE, got)
