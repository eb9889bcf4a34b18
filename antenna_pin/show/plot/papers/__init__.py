"""Figures of papers that shipped models repeat, with their cases.

Nothing is simulated here: give the runs of the cases, or let ``antenna-pin figures`` make them.
"""

from __future__ import annotations

from antenna_pin.base.arguments import takes
from antenna_pin.errors import UnknownNameError
from antenna_pin.show.plot.papers import bai2020, chen2021, you2010
from antenna_pin.show.plot.papers._figure import AttractorFigure, Diagram, DiagramFigure, PaperFigure

__all__ = [
    "ATTRACTORS",
    "PAPERS",
    "AttractorFigure",
    "Diagram",
    "DiagramFigure",
    "PaperFigure",
    "paper_figures",
]

#: The figures of each paper, by the name of the shipped model that repeats them.
PAPERS: dict[str, tuple[PaperFigure, ...]] = {
    "bai2020": bai2020.FIGURES,
    "you2010": you2010.FIGURES,
    "chen2021": chen2021.FIGURES,
}

#: Those of settled motions, likewise.
ATTRACTORS: dict[str, tuple[AttractorFigure | DiagramFigure, ...]] = {"chen2021": chen2021.ATTRACTORS}


@takes()
def paper_figures(model: str) -> tuple[PaperFigure, ...]:
    """Return a paper's figures that a shipped model repeats, in the paper's order.

    Args:
        model: Name of the model, such as "bai2020".

    Raises:
        UnknownNameError: No paper's figures belong to it.
    """
    if model not in PAPERS:
        raise UnknownNameError("figures", "paper's model", model, PAPERS)
    return PAPERS[model]
