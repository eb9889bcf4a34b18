"""What files made of tables are checked with, for other rooms that read such files as scenarios are read."""

from antenna_pin.scenario._base import Count, Folder, PositiveTime, Quantity, Spec, refuse, refuse_name
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
