"""References by the ``kind`` that a scenario has for them. One enters by a line here."""

from __future__ import annotations

from antenna_pin.base.lazy import Classes

__all__ = ["REFERENCES"]

REFERENCES = Classes(
    "antenna_pin.elements",
    {
        "constant": "courses.Constant",
        "ramp": "courses.Ramp",
        "polynomial": "courses.Polynomial",
        "sine": "courses.Sine",
        "chirp": "courses.Chirp",
        "sines": "courses.Sines",
        "table": "composed_courses.Table",
        "trapezoid": "slews.Trapezoid",
        "s-curve": "slews.SCurve",
        "rest-to-rest": "slews.RestToRest",
        "sum": "composed_courses.Sum",
    },
)
"""References by their ``kind`` in ``[references.NAME]``."""
