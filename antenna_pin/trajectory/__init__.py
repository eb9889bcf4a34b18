"""One run, sampled: labelled arrays by a schema, how the run ended, and the file that holds both."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.trajectory.blows import blow_counts, blow_numbers, surfaces
    from antenna_pin.trajectory.file import FORMAT, write_blocks
    from antenna_pin.trajectory.labelled import Column
    from antenna_pin.trajectory.meshes import Span, mesh_spans, mesh_touches, met_by_meshes
    from antenna_pin.trajectory.outcome import ENDED_WELL, REACHED_END, Counts, Outcome
    from antenna_pin.trajectory.plain import columns_of
    from antenna_pin.trajectory.read import (
        contact_ends,
        contact_joints,
        contact_kinds,
        contacts_of,
        is_lean,
        names_along,
        series,
    )
    from antenna_pin.trajectory.result import RunEvent, Trajectory, library_versions, open_run
    from antenna_pin.trajectory.table import (
        FORMATS,
        KINDS,
        TableKind,
        format_of,
        kind_of,
        open_table,
        save_table,
        table_attributes,
    )
    from antenna_pin.trajectory.touches import (
        ModeChange,
        Touch,
        elements_of,
        latch_changes,
        mode_changes,
        touches,
    )

__all__ = [
    "ENDED_WELL",
    "REACHED_END",
    "FORMAT",
    "FORMATS",
    "KINDS",
    "Column",
    "Counts",
    "ModeChange",
    "Outcome",
    "RunEvent",
    "Span",
    "TableKind",
    "Touch",
    "Trajectory",
    "blow_counts",
    "blow_numbers",
    "columns_of",
    "contact_ends",
    "contact_joints",
    "contact_kinds",
    "contacts_of",
    "elements_of",
    "format_of",
    "is_lean",
    "kind_of",
    "latch_changes",
    "library_versions",
    "mesh_spans",
    "mesh_touches",
    "met_by_meshes",
    "mode_changes",
    "names_along",
    "open_run",
    "open_table",
    "save_table",
    "series",
    "surfaces",
    "table_attributes",
    "touches",
    "write_blocks",
]

loaded_when_used(
    __name__,
    {
        "blows": "blow_counts blow_numbers surfaces",
        "file": "FORMAT write_blocks",
        "labelled": "Column",
        "meshes": "Span mesh_spans mesh_touches met_by_meshes",
        "outcome": "Counts ENDED_WELL REACHED_END Outcome",
        "read": "contact_ends contact_joints contact_kinds contacts_of is_lean names_along series",
        "plain": "columns_of",
        "result": "RunEvent Trajectory library_versions open_run",
        "table": "FORMATS KINDS TableKind format_of kind_of open_table save_table table_attributes",
        "touches": "ModeChange Touch elements_of latch_changes mode_changes touches",
    },
)
