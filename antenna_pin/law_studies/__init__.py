"""Studies of the contact laws: what they do in an impact, side by side, and against a measured joint."""

from antenna_pin._lazy import only_public
from antenna_pin.law_studies.certificates import (
    RestitutionRow,
    closed_form_peak_depth,
    closed_form_restitution,
    largest_errors,
    restitution_table,
)
from antenna_pin.law_studies.comparison import (
    differing_factor,
    elastic_laws_of_joint,
    force_table,
    force_within,
    laws_left_out,
)
from antenna_pin.law_studies.experiment import (
    LIU_2013,
    LIU_2013_PLAYS,
    LIU_2013_STEEL,
    ExperimentFit,
    ExperimentPoint,
    compare_with_experiment,
    printed_columns,
    ranked,
)
from antenna_pin.law_studies.findings import ExperimentFindings, LeastError, experiment_findings
from antenna_pin.law_studies.impacts import Impact, impact_of_pair, impact_on_wall
from antenna_pin.law_studies.reproduction import ReproducedTable, reproduce_table

__all__ = [
    "LIU_2013",
    "LIU_2013_PLAYS",
    "LIU_2013_STEEL",
    "ExperimentFindings",
    "ExperimentFit",
    "ExperimentPoint",
    "Impact",
    "LeastError",
    "ReproducedTable",
    "RestitutionRow",
    "closed_form_peak_depth",
    "closed_form_restitution",
    "compare_with_experiment",
    "differing_factor",
    "elastic_laws_of_joint",
    "experiment_findings",
    "force_table",
    "force_within",
    "impact_of_pair",
    "impact_on_wall",
    "largest_errors",
    "laws_left_out",
    "printed_columns",
    "ranked",
    "reproduce_table",
    "restitution_table",
]

only_public(__name__)
