"""Checks of files made of tables, for other rooms that read such files like scenarios."""

from antenna_pin.scenario._base import (
    Count,
    Folder,
    PositiveTime,
    Quantity,
    Spec,
    refuse,
    refuse_name,
)
from antenna_pin.scenario._explained import Place, dotted, explained

__all__ = [
    "Count",
    "Folder",
    "Place",
    "PositiveTime",
    "Quantity",
    "Spec",
    "dotted",
    "explained",
    "refuse",
    "refuse_name",
]
