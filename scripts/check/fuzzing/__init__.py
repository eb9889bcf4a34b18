"""Inputs of every format: sound ones with something changed, drawn from what the package declares."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from random import Random

from robust.inputs import Draft

from fuzzing.calls import draw_call
from fuzzing.documents import draw_diagram, draw_scenario, draw_study
from fuzzing.measured import draw_fit, draw_record
from fuzzing.mechanisms import draw_urdf
from fuzzing.options import draw_options
from fuzzing.results import draw_result, draw_store
from fuzzing.sequences import draw_explored, draw_fmu, draw_session
from fuzzing.states import draw_checkpoint, draw_sensitivity, draw_state
from fuzzing.tables import draw_curve, draw_modal

__all__ = ["FORMATS"]

FORMATS: Mapping[str, Callable[[Random], Draft]] = {
    "scenario": draw_scenario,
    "study": draw_study,
    "diagram": draw_diagram,
    "urdf": draw_urdf,
    "curve": draw_curve,
    "modal": draw_modal,
    "result": draw_result,
    "store": draw_store,
    "fit": draw_fit,
    "record": draw_record,
    "sensitivity": draw_sensitivity,
    "state": draw_state,
    "checkpoint": draw_checkpoint,
    "session": draw_session,
    "explored": draw_explored,
    "fmu": draw_fmu,
    "options": draw_options,
    "python": draw_call,
}
"""What draws an input, by its format."""
