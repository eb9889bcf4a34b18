"""Figures of runs, for papers: motion against the ideal joint, contact forces, energy and momentum audits.

Every function takes runs (trajectories, or pairs of a label and a dataset) and returns a
:class:`matplotlib.figure.Figure` that belongs to no window; :func:`save_figures` writes the whole set.
"""

from __future__ import annotations

from antenna_pin.plot.audit import figure_energy, figure_momentum
from antenna_pin.plot.files import FORMATS, save_figures
from antenna_pin.plot.forces import figure_contact_forces
from antenna_pin.plot.motion import QUANTITIES, figure_motion

__all__ = [
    "FORMATS",
    "QUANTITIES",
    "figure_contact_forces",
    "figure_energy",
    "figure_momentum",
    "figure_motion",
    "save_figures",
]
