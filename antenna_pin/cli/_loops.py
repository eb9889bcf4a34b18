"""Tables of closed loops, couplings and prescribed motions, for ``antenna-pin analyse``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import typer

from antenna_pin.cli._tables import print_rows
from antenna_pin.cli._zeros import Zeros

__all__ = ["print_loops"]

_CLOSURES = {
    "peak_force": "peak force [N]",
    "time_of_peak_force": "at [s]",
    "rms_force": "rms force [N]",
    "peak_moment": "peak moment [N m]",
    "rms_moment": "rms moment [N m]",
}
_COUPLINGS = {"peak_torque": "peak", "time_of_peak_torque": "at [s]", "rms_torque": "rms"}
_DRIVES = {
    "peak_effort": "peak",
    "time_of_peak_effort": "at [s]",
    "rms_effort": "rms",
    "peak_power": "peak power [W]",
    "work": "work [J]",
    "gross_work": "gross work [J]",
}


def print_loops(label: str, found: Mapping[str, Any], zeros: Zeros) -> None:
    """Print what closures, couplings and drives carried, and how many equations they are."""
    from antenna_pin.analysis import said_of_constraints, said_of_singular

    if found["closures"]:
        rows = [
            [one["of"], *(zeros.text(one[name], unit) for name, unit in _CLOSURES.items())]
            for one in found["closures"]
        ]
        print_rows(f"{label}: forces of closures", ("", *_CLOSURES.values()), rows)
    if found["couplings"]:
        rows = [_row(one, one["of"], _COUPLINGS, zeros) for one in found["couplings"]]
        print_rows(f"{label}: torques of couplings, on followers", ("", *_COUPLINGS.values()), rows)
    if found["drives"]:
        rows = [
            _row(one, f"{'motion' if one['motion'] else 'drive'} {one['of']}", _DRIVES, zeros)
            for one in found["drives"]
        ]
        print_rows(f"{label}: what drives exert", ("", *_DRIVES.values()), rows)
    for text in (said_of_constraints(found["constraints"]), said_of_singular(found["constraints"])):
        if text:
            typer.echo(text)
    typer.echo()


def _row(one: Mapping[str, Any], name: str, columns: Mapping[str, str], zeros: Zeros) -> list[str]:
    """Return the row of something that acts at a joint: in its own unit, where a column names none."""
    units = f"[{one['units']}]"
    cells = (
        zeros.text(one[key], head if "[" in head else f"{head} {units}") for key, head in columns.items()
    )
    return [f"{name} {units}", *cells]
