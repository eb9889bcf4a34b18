"""How results show themselves: ``run.plot``, ``run.record``, ``run.report``, ``run.analyse`` and their like.

Every reader here is bound to a result by the table ``antenna_pin._views.VIEWS``. It draws, records and
reports by the rooms below, and adds what those who have a result at hand leave unsaid: which run it is.
"""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.views.numbers import RunNumbers
    from antenna_pin.views.runs import Drawing, RunFigures
    from antenna_pin.views.studies import StudyFigures, figures_of_study

__all__ = ["Drawing", "RunFigures", "RunNumbers", "StudyFigures", "figures_of_study"]

loaded_when_used(
    __name__,
    {
        "numbers": "RunNumbers",
        "runs": "Drawing RunFigures",
        "studies": "StudyFigures figures_of_study",
    },
)
