"""One run, sampled: labelled arrays by a schema, how the run ended, and the file that holds both."""

from antenna_pin.trajectory.file import FORMAT, write_blocks
from antenna_pin.trajectory.read import (
    contact_ends,
    contact_joints,
    contact_kinds,
    contacts_of,
    is_lean,
    names_along,
    series,
)
from antenna_pin.trajectory.result import Counts, Outcome, Trajectory, library_versions

__all__ = [
    "FORMAT",
    "Counts",
    "Outcome",
    "Trajectory",
    "contact_ends",
    "contact_joints",
    "contact_kinds",
    "contacts_of",
    "is_lean",
    "library_versions",
    "names_along",
    "series",
    "write_blocks",
]
