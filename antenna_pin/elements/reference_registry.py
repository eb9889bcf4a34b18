"""References by the ``kind`` that a scenario has for them. One enters by a line here."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from antenna_pin.elements.composed_courses import Sum, Table
from antenna_pin.elements.courses import Chirp, Constant, Polynomial, Ramp, Sine, Sines
from antenna_pin.elements.reference import Reference
from antenna_pin.elements.slews import RestToRest, SCurve, Trapezoid

__all__ = ["REFERENCES"]

REFERENCES: Mapping[str, type[Reference]] = MappingProxyType(
    {
        "constant": Constant,
        "ramp": Ramp,
        "polynomial": Polynomial,
        "sine": Sine,
        "chirp": Chirp,
        "sines": Sines,
        "table": Table,
        "trapezoid": Trapezoid,
        "s-curve": SCurve,
        "rest-to-rest": RestToRest,
        "sum": Sum,
    }
)
"""References by their ``kind`` in ``[references.NAME]``."""
