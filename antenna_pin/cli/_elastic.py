"""The table of the elastic parts of flexible links, for ``antenna-pin analyse``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from antenna_pin.cli._tables import print_rows, text_of

_COLUMNS = {
    "frequency": "held [Hz]",
    "peak_deflection": "peak",
    "time_of_peak": "at [s]",
    "rms_deflection": "rms",
    "peak_energy": "peak energy [J]",
    "lost": "energy lost [J]",
    "spin_ratio": "spin [-]",
}


def print_elastic(label: str, found: Sequence[dict[str, Any]]) -> None:
    """Print how far elastic parts went, what they stored and lost."""
    rows = [[f"{one['of']} [{one['units']}]", *(text_of(one[name]) for name in _COLUMNS)] for one in found]
    print_rows(f"{label}: deflections of flexible links", ("", *_COLUMNS.values()), rows)
