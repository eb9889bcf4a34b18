"""Figures for papers: of runs, and of contact laws.

Of runs: motion against the ideal joint, contact forces, energy and momentum audits. Every such function takes
runs (trajectories, or pairs of a label and a dataset); :func:`save_figures` writes the whole set. Of contact
laws: force over depth, restitution, and the experiment of Liu et al. 2013. Every function returns a
:class:`matplotlib.figure.Figure` that belongs to no window.
"""

from __future__ import annotations

from antenna_pin.plot.audit import figure_energy, figure_momentum
from antenna_pin.plot.contact import figure_force_curves, figure_restitution, save_contact_figures
from antenna_pin.plot.experiment import figure_contact_width, figure_experiment, figures_of_experiment
from antenna_pin.plot.files import FORMATS, rendered, save_figures
from antenna_pin.plot.forces import figure_contact_forces
from antenna_pin.plot.motion import QUANTITIES, figure_motion

__all__ = [
    "FORMATS",
    "QUANTITIES",
    "figure_contact_forces",
    "figure_contact_width",
    "figure_energy",
    "figure_experiment",
    "figure_force_curves",
    "figure_momentum",
    "figure_motion",
    "figure_restitution",
    "figures_of_experiment",
    "rendered",
    "save_contact_figures",
    "save_figures",
]
