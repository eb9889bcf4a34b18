"""Figures for papers: of runs, and of contact laws.

Of runs: motion of joints, base and boresight against the ideal run, forces, the journal in its bearing,
contact scenarios, spectra, energy and momentum audits. Every such function takes runs (trajectories, or pairs
of a label and a dataset or trajectory). :data:`CATALOGUE` has all of them by name, :func:`save_figures`
writes those that the runs allow, :func:`paper_figures` lists the figures of a paper that a shipped model
repeats. Of contact laws: force over depth, restitution, and the experiment of Liu et al. 2013. Every function
returns a :class:`matplotlib.figure.Figure` that belongs to no window and shows itself in a notebook.
"""

from antenna_pin.base.lazy import exported

exported(__name__)
