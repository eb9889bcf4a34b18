"""Tables of flexible links that name a file of modal data."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["has_modal_file", "modal_stand_in"]


def has_modal_file(table: object) -> bool:
    """Return whether the table of a flexible link may take its numbers from a file that it names."""
    return isinstance(table, Mapping) and table.get("kind") == "modal-data" and "file" in table


def modal_stand_in() -> dict[str, tuple[float, ...]]:
    """Return the least that modal data need in place of a file that is not to be read."""
    return {"frequency": (1.0,), "participation": (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)}
