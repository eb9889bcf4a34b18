"""Parameter studies: many runs of a scenario, on the cores at hand or a cluster, kept in one store."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.sweep.cluster import Cluster
    from antenna_pin.sweep.design import Design, design_of
    from antenna_pin.sweep.driver import Standing, run_study
    from antenna_pin.sweep.here import Executor, Here
    from antenna_pin.sweep.measures import MEASURES
    from antenna_pin.sweep.prepared import Prepared, RunTime, Trial, prepare, run_seconds, trial
    from antenna_pin.sweep.sensitivity import sensitivities
    from antenna_pin.sweep.store import open_study
    from antenna_pin.sweep.study import Study, list_studies, load_study

__all__ = [
    "MEASURES",
    "Cluster",
    "Design",
    "Executor",
    "Here",
    "Prepared",
    "Standing",
    "Study",
    "RunTime",
    "Trial",
    "design_of",
    "list_studies",
    "load_study",
    "open_study",
    "prepare",
    "run_seconds",
    "run_study",
    "sensitivities",
    "trial",
]

loaded_when_used(
    __name__,
    {
        "cluster": "Cluster",
        "design": "Design design_of",
        "driver": "Standing run_study",
        "here": "Executor Here",
        "measures": "MEASURES",
        "prepared": "Prepared RunTime Trial prepare run_seconds trial",
        "sensitivity": "sensitivities",
        "store": "open_study",
        "study": "Study list_studies load_study",
    },
)
