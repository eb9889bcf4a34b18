"""Further analyses of a verification's nominal state, for its report: sampled loops, curves of margins."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from antenna_pin.base.arguments import takes
from antenna_pin.errors import AntennaPinError
from antenna_pin.studies.verification.verify import Verified

__all__ = ["analyses_of"]


@takes()
def analyses_of(
    verified: Verified, folder: Path, say: Callable[[str], None]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return sampled loops, and tables and figures of other analyses.

    Args:
        verified: The result.
        folder: Folder of the output.
        say: Called with each note, one line.

    Returns:
        Of each PID loop its margins and response; of each other analysis a table or figure with its caption.
    """
    loops = []
    scenario = verified.plan.base
    names = [name for name, table in scenario.controllers.items() if table.kind == "pid"]
    for name in names:
        from antenna_pin.studies.linear import loop_margins

        try:
            found = loop_margins(scenario, name)
        except AntennaPinError as error:
            say(f"note: no margins of loop {name}: {error}")
            continue
        keys = ("gain_margin", "phase_margin", "delay_margin", "modulus_margin", "loop_damping", "bandwidth")
        loops.append(
            {key: getattr(found, key) for key in keys}
            | {"controller": name, "frequency": found.frequency[::20], "response": found.response[::20]}
        )
    return loops, []
