"""Motorization margin of a geared pointing mechanism."""

from antenna_pin.studies.margins import margin

found = margin(
    "pointing_gear",
    "dish",
    travel=("-10 deg", "10 deg"),
    count=5,
    available={"controller": 0.2},
    additional={"H_A": 2.0},
)
print(found.smallest, found.worst.name)
