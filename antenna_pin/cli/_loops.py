"""Tables of closed loops and prescribed motions, for ``antenna-pin analyse``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import typer

from antenna_pin.cli._tables import print_rows
from antenna_pin.cli._zeros import Zeros

_CLOSURES = {
    "peak_force": "peak force [N]",
    "time_of_peak_force": "at [s]",
    "rms_force": "rms force [N]",
    "peak_moment": "peak moment [N m]",
    "rms_moment": "rms moment [N m]",
}
_DRIVES = {
    "peak_effort": "peak",
    "time_of_peak_effort": "at [s]",
    "rms_effort": "rms",
    "peak_power": "peak power [W]",
    "work": "work [J]",
    "gross_work": "gross work [J]",
}


def print_loops(label: str, found: Mapping[str, Any], zeros: Zeros) -> None:
    """Print what closures and drives carried, and how many equations they are."""
    from antenna_pin.analysis import said_of_constraints, said_of_singular

    if found["closures"]:
        rows = [
            [one["of"], *(zeros.text(one[name], unit) for name, unit in _CLOSURES.items())]
            for one in found["closures"]
        ]
        print_rows(f"{label}: forces of closures", ("", *_CLOSURES.values()), rows)
    if found["drives"]:
        rows = [
            [
                f"{'motion' if one['motion'] else 'drive'} {one['of']} [{one['units']}]",
                *(
                    zeros.text(one[name], unit if "[" in unit else f"{unit} [{one['units']}]")
                    for name, unit in _DRIVES.items()
                ),
            ]
            for one in found["drives"]
        ]
        print_rows(f"{label}: what drives exert", ("", *_DRIVES.values()), rows)
    for text in (said_of_constraints(found["constraints"]), said_of_singular(found["constraints"])):
        if text:
            typer.echo(text)
    typer.echo()
