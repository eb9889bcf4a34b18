"""A figure of runs as the catalogue declares it: its name, what it shows, of what, and what draws it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from matplotlib.figure import Figure

from antenna_pin.plot._kinds import TOUCHING, JointKind, RunKind
from antenna_pin.plot._runs import Run
from antenna_pin.plot._style import Width

__all__ = ["RunFigure"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunFigure:
    """A figure of runs.

    Attributes:
        name: What it is asked for by, and its file without a format.
        title: What it shows; "{joint}" stands for the joint.
        function: Draws it, from runs, ``options``, the joint if it is of one, and a width.
        options: Arguments of the function that make it this figure.
        of: The joints that there is one each of; None for one of whole runs.
        needs: Runs that it takes; None for all.
        compares: Whether every run in it stands beside the ideal one.
        standard: Whether it is drawn where none is asked for by name.
        reported: Whether it is in a report.
    """

    name: str
    title: str
    function: Callable[..., Figure]
    options: Mapping[str, Any] = field(default_factory=dict)
    of: JointKind | None = None
    needs: RunKind | None = None
    compares: bool = True
    standard: bool = True
    reported: bool = True

    @property
    def touching(self) -> bool:
        """Whether only runs with contact are in it."""
        return self.of is TOUCHING

    @property
    def needed(self) -> str:
        """What a run must have to be in it; nothing where every run can."""
        kind = self.of or self.needs
        return kind.words if kind is not None else ""

    def draw(
        self, runs: Iterable[Run] | Run, *, joint: str | None = None, width: Width = "page", **options: Any
    ) -> Figure:
        """Return the figure.

        Args:
            runs: Trajectories, or pairs of a label and a dataset or trajectory.
            joint: Name of the joint; the one that the runs are about if left out. Of no meaning for a figure
                of whole runs.
            width: "column" (88 mm) or "page" (180 mm).
            **options: Further arguments of the function, such as ``zoom``.
        """
        of_joint = {} if self.of is None else {"joint": joint}
        return self.function(runs, **self.options, **of_joint, width=width, **options)
