"""Numbers that are zero to round-off, as they stand in tables."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import typer

from antenna_pin.cli._tables import text_of

if TYPE_CHECKING:
    from antenna_pin.trajectory import Trajectory

_UNIT = re.compile(r"\[([^\[\]]+)\]$")
# Entries of a summary that tell how well something was kept, whose round-off is what is asked for, and
# lengths in a joint, which the mechanism's length is no measure of.
_NOT_JUDGED = ("balance", "drift", "scale", "residual", "corrections", "gaps", "depth", "wall time")


class Zeros:
    """Tells what is zero to round-off by the scales of some runs, and says so once.

    Args:
        runs: The runs whose numbers stand together.
    """

    def __init__(self, runs: Iterable[Trajectory]) -> None:
        """Look at the runs."""
        from antenna_pin.analysis import round_off_scales

        self._scales: Mapping[str, float] = round_off_scales(*(run.data for run in runs))
        self._met = False

    def is_zero(self, value: Any, unit: str) -> bool:
        """Whether a number is zero to round-off."""
        from antenna_pin.analysis import is_round_off

        return isinstance(value, int | float) and is_round_off(value, unit, self._scales)

    def text(self, value: Any, name: str) -> str:
        """Return a number as it stands in a row, or column, of a name that ends in its unit."""
        found = _UNIT.search(name)
        if found is None or any(word in name for word in _NOT_JUDGED) or not self.is_zero(value, found[1]):
            return text_of(value)
        self._met = True
        return "≈ 0"

    def say(self) -> None:
        """Say what the sign means, where it was met."""
        if self._met:
            from antenna_pin.analysis import ROUND_OFF_WORDS

            typer.echo(ROUND_OFF_WORDS)
        self._met = False
