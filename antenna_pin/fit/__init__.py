"""From measured records to numbers of a scenario: what play, stiffness, friction a joint has."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.fit.certainty import certain, profiles_of, tells
    from antenna_pin.fit.designs import Design, Plan, design, planned
    from antenna_pin.fit.experiments import Experiments, Trial, load_experiments
    from antenna_pin.fit.identifiable import Identifiable, identifiable
    from antenna_pin.fit.plan import FitPlan, load_fit
    from antenna_pin.fit.problem import Problem
    from antenna_pin.fit.profiled import Profile, profiles
    from antenna_pin.fit.result import Fit, open_fit
    from antenna_pin.fit.solve import run_fit
    from antenna_pin.fit.sureness import Sure, sure
    from antenna_pin.fit.tell_tables import (
        experiments_table,
        identifiability_table,
        open_experiments,
        open_identifiability,
    )

__all__ = [
    "Design",
    "Experiments",
    "Fit",
    "FitPlan",
    "Identifiable",
    "Plan",
    "Problem",
    "Profile",
    "Sure",
    "Trial",
    "certain",
    "design",
    "experiments_table",
    "identifiability_table",
    "identifiable",
    "load_experiments",
    "load_fit",
    "open_experiments",
    "open_fit",
    "open_identifiability",
    "planned",
    "profiles",
    "profiles_of",
    "run_fit",
    "sure",
    "tells",
]

loaded_when_used(
    __name__,
    {
        "certainty": "certain profiles_of tells",
        "designs": "Design Plan design planned",
        "experiments": "Experiments Trial load_experiments",
        "identifiable": "Identifiable identifiable",
        "profiled": "Profile profiles",
        "sureness": "Sure sure",
        "tell_tables": "experiments_table identifiability_table open_experiments open_identifiability",
        "plan": "FitPlan load_fit",
        "problem": "Problem",
        "result": "Fit open_fit",
        "solve": "run_fit",
    },
)
