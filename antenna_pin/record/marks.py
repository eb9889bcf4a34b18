"""What is marked in a recording of a mechanism beside its bodies: one list of marks, each made by a function.

To add a mark is to write a function of :class:`Marking` in a file of its own and one line of ``MARKS``.
"""

from __future__ import annotations

from collections.abc import Callable

from antenna_pin.record._closure_marks import mark_closures
from antenna_pin.record._frame_marks import mark_frames
from antenna_pin.record._gear_marks import mark_gears
from antenna_pin.record._joint_marks import mark_joints
from antenna_pin.record._marking import Mark, Marking
from antenna_pin.record._spring_marks import mark_springs
from antenna_pin.record._stop_marks import mark_stops

__all__ = ["MARKS", "marks_of"]

MARKS: tuple[Callable[[Marking], Mark | None], ...] = (
    mark_closures,
    mark_stops,
    mark_gears,
    mark_springs,
    mark_joints,
    mark_frames,
)
"""In the order in which a page lists them; each returns None where there is nothing of its kind."""


def marks_of(marking: Marking) -> list[Mark]:
    """Put all marks into a scene; return those that there are.

    Args:
        marking: What they are made of.
    """
    return [mark for make in MARKS if (mark := make(marking)) is not None]
