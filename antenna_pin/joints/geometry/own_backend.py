"""Backend of a user: queried for the rows of its joint only."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import refused
from antenna_pin.base.records import CONTACT
from antenna_pin.base.units import shown
from antenna_pin.errors import FunctionError
from antenna_pin.joints.geometry.shape import Distances

_RULE = "a finite gap and point, and a finite unit normal, of each queried contact, and change nothing else"
_UNIT = 1e-6  # permitted error of a normal's length
# Numbers that it writes: the first of a row (:data:`antenna_pin.base.records.CONTACT`).
_GIVEN = ("gap", *(f"{name} {axis}" for name in ("normal", "point") for axis in "xyz"))


class OwnBackend:
    """Backend whose results are checked.

    It is passed a table of its own, so that it cannot write into other data.

    Args:
        name: Owner and name of the backend.
        distances: The backend.
        contacts: Contacts of its joint.
    """

    def __init__(self, name: str, distances: Distances, contacts: int) -> None:
        """Allocate nothing yet: the table's length is known at the first query."""
        self.name = name
        self._distances, self._contacts = distances, contacts
        self._table: NDArray[Any] = np.zeros(0, CONTACT)
        self._own = np.zeros((0, len(_GIVEN)))

    def query(
        self, pose: NDArray[Any], table: NDArray[Any], row: int, wanted: Sequence[float] | None = None
    ) -> None:
        """Fill gap, normal and point of the joint's rows (:class:`Distances`).

        Raises:
            FunctionError: It raises an exception, or writes invalid numbers.
        """
        if len(self._table) != len(table):
            self._table = np.zeros_like(table)
            self._own = self._numbers_of(self._table, row)
        own, before = self._own, pose.tobytes()
        own[:] = np.nan
        try:
            if wanted is None:
                self._distances.query(pose, self._table, row)
            else:
                self._distances.query(pose, self._table, row, list(wanted))
        except BaseException as error:
            raise refused(self.name, self.pose_text(pose), _RULE, error) from error
        if pose.tobytes() != before:
            pose[:] = np.frombuffer(before, pose.dtype)
            raise FunctionError(self.name, self.pose_text(pose), _RULE, "a pose that it had changed")
        # Plain numbers: a query is evaluated several times a step.
        for k, numbers in enumerate(own.tolist()):
            if wanted is None or wanted[k]:
                _, x, y, z, *_ = numbers
                if not (abs(x * x + y * y + z * z - 1.0) <= 2.0 * _UNIT and math.isfinite(sum(numbers))):
                    got = f"{shown(dict(zip(_GIVEN, numbers, strict=True)))} for contact {k}"
                    raise FunctionError(self.name, self.pose_text(pose), _RULE, got)
        self._numbers_of(table, row)[:] = own

    def _numbers_of(self, table: NDArray[Any], row: int) -> NDArray[np.float64]:
        """Return gap, normal and point of the joint's table rows, (contacts, 7); a view."""
        rows = table[row : row + self._contacts]
        return rows.view(np.float64).reshape(self._contacts, -1)[:, : len(_GIVEN)]

    def pose_text(self, pose: NDArray[Any]) -> str:
        """Return the queried pose as text."""
        x, y, z = pose["centre"][0].tolist()
        return f"journal at x = {x:.9g} m, y = {y:.9g} m, z = {z:.9g} m in its bearing"
