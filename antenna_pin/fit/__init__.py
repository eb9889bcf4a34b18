"""From measured records to numbers of a scenario: what play, stiffness, friction a joint has."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.fit.plan import FitPlan, load_fit
    from antenna_pin.fit.problem import Problem
    from antenna_pin.fit.result import Fit, open_fit
    from antenna_pin.fit.solve import run_fit

__all__ = ["Fit", "FitPlan", "Problem", "load_fit", "open_fit", "run_fit"]

loaded_when_used(
    __name__,
    {
        "plan": "FitPlan load_fit",
        "problem": "Problem",
        "result": "Fit open_fit",
        "solve": "run_fit",
    },
)
