"""Inputs of every format: sound ones with something changed, drawn from what the package declares."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from random import Random

from robust.inputs import Draft

from fuzzing import calls, documents, mechanisms, options, results, sequences, tables

FORMATS: Mapping[str, Callable[[Random], Draft]] = {
    "scenario": documents.draw_scenario,
    "study": documents.draw_study,
    "diagram": documents.draw_diagram,
    "urdf": mechanisms.draw_urdf,
    "curve": tables.draw_curve,
    "modal": tables.draw_modal,
    "result": results.draw_result,
    "store": results.draw_store,
    "fit": tables.draw_fit,
    "record": tables.draw_record,
    "sensitivity": options.draw_sensitivity,
    "state": results.draw_state,
    "checkpoint": results.draw_checkpoint,
    "session": sequences.draw_session,
    "explored": sequences.draw_explored,
    "fmu": sequences.draw_fmu,
    "options": options.draw_options,
    "python": calls.draw_call,
}
"""What draws an input, by its format."""
