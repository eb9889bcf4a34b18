"""Groups of kernels that only some runs need, called through slots (``slots.py``)."""

from __future__ import annotations

import sys

__all__ = ["is_required", "note_group", "require", "require_all"]

_known: set[str] = set()
_required: set[str] = set()


def note_group(group: str) -> None:
    """Register a group of kernels."""
    _known.add(group)


def is_required(group: str) -> bool:
    """Return whether something in this process needs a group."""
    return group in _required


def require(group: str) -> None:
    """Have the kernels of a group compiled or loaded before whoever calls them runs."""
    if group in _required:
        return
    _required.add(group)
    slots = sys.modules.get("antenna_pin.compiled.slots")
    if slots is not None:
        slots.fill(group)


def require_all() -> None:
    """Require all groups of loaded modules, for a shared library of all kernels."""
    for group in sorted(_known):
        require(group)
