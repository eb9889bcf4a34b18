"""What is to be said against a site that was built."""
from __future__ import annotations
from pathlib import Path
__all__ = ["complaints"]


def complaints(site: Path) -> list[str]:
    """Return a line for each thing that is wrong."""
    return []
