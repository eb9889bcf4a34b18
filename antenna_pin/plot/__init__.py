"""Figures for papers: of runs, and of contact laws.

Of runs: motion of joints, base and boresight against the ideal run, forces, the journal in its bearing,
contact scenarios, spectra, energy and momentum audits. Every such function takes runs (trajectories, or pairs
of a label and a dataset or trajectory). :data:`CATALOGUE` has all of them by name, :func:`save_figures`
writes those that the runs allow, :func:`paper_figures` lists the figures of a paper that a shipped model
repeats. Of contact laws: force over depth, restitution, and the experiment of Liu et al. 2013. Every function
returns a :class:`matplotlib.figure.Figure` that belongs to no window and shows itself in a notebook.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.plot._run_figure import RunFigure
    from antenna_pin.plot.attractors import Attractor, figure_attractors
    from antenna_pin.plot.audit import figure_energy, figure_momentum
    from antenna_pin.plot.base import BASE_QUANTITIES, figure_base, figure_joints
    from antenna_pin.plot.bodies import BODY_QUANTITIES, figure_body
    from antenna_pin.plot.bore import figure_bore_load
    from antenna_pin.plot.catalogue import CATALOGUE, Allowed, allowed_figures, run_figure
    from antenna_pin.plot.closures import (
        figure_applied_forces,
        figure_closure_forces,
        figure_coupling_torques,
        figure_drive_efforts,
    )
    from antenna_pin.plot.contact import figure_force_curves, figure_restitution, save_contact_figures
    from antenna_pin.plot.control import figure_control
    from antenna_pin.plot.drawn import Drawn, drawn_numbers
    from antenna_pin.plot.eccentricity import figure_eccentricity
    from antenna_pin.plot.elastic import figure_deflection
    from antenna_pin.plot.experiment import figure_contact_width, figure_experiment, figures_of_experiment
    from antenna_pin.plot.exponents import figure_exponents
    from antenna_pin.plot.files import (
        FORMATS,
        check_one_mechanism,
        folder_for_figures,
        processes_to_draw,
        rendered,
        save_figure,
        save_figures,
    )
    from antenna_pin.plot.fit_curves import curves_of_fit, figure_fit
    from antenna_pin.plot.fit_sure import correlations, figure_correlation, figure_profiles
    from antenna_pin.plot.fit_tests import figure_experiments, figure_identifiability
    from antenna_pin.plot.forces import figure_contact_forces
    from antenna_pin.plot.gears import figure_gears
    from antenna_pin.plot.glance import figure_glance
    from antenna_pin.plot.hysteresis import figure_hysteresis
    from antenna_pin.plot.joint import figure_joint
    from antenna_pin.plot.loads import figure_joint_load, figure_steady_force
    from antenna_pin.plot.motion import QUANTITIES, figure_motion
    from antenna_pin.plot.orbit import figure_orbit
    from antenna_pin.plot.papers import (
        ATTRACTORS,
        PAPERS,
        AttractorFigure,
        Diagram,
        DiagramFigure,
        PaperFigure,
        paper_figures,
    )
    from antenna_pin.plot.periodic import figure_branch, figure_multipliers
    from antenna_pin.plot.phase import figure_phase
    from antenna_pin.plot.pointing import figure_pointing
    from antenna_pin.plot.response import figure_response
    from antenna_pin.plot.scenarios import figure_scenarios
    from antenna_pin.plot.sections import figure_bifurcation, figure_section
    from antenna_pin.plot.sensitivity import figure_sensitivity
    from antenna_pin.plot.shaken import figure_density, figure_shock, figure_swept
    from antenna_pin.plot.spectra import SIGNALS, figure_spectra, figure_spectrogram
    from antenna_pin.plot.stops import figure_stops
    from antenna_pin.plot.study import (
        QUANTILES,
        StudyFigure,
        study_distribution,
        study_figures,
        study_map,
        study_response,
        study_scatter,
        study_sensitivities,
    )
    from antenna_pin.plot.tables import TableFigure, table_figures

__all__ = [
    "ATTRACTORS",
    "Attractor",
    "AttractorFigure",
    "Diagram",
    "DiagramFigure",
    "Drawn",
    "drawn_numbers",
    "figure_glance",
    "figure_attractors",
    "BASE_QUANTITIES",
    "BODY_QUANTITIES",
    "CATALOGUE",
    "FORMATS",
    "PAPERS",
    "QUANTILES",
    "QUANTITIES",
    "SIGNALS",
    "Allowed",
    "PaperFigure",
    "RunFigure",
    "StudyFigure",
    "TableFigure",
    "allowed_figures",
    "check_one_mechanism",
    "correlations",
    "curves_of_fit",
    "figure_bifurcation",
    "figure_applied_forces",
    "figure_base",
    "figure_body",
    "figure_bore_load",
    "figure_branch",
    "figure_closure_forces",
    "figure_control",
    "figure_correlation",
    "figure_coupling_torques",
    "figure_contact_forces",
    "figure_contact_width",
    "figure_deflection",
    "figure_hysteresis",
    "figure_density",
    "figure_drive_efforts",
    "figure_eccentricity",
    "figure_energy",
    "figure_experiment",
    "figure_experiments",
    "figure_exponents",
    "figure_fit",
    "figure_identifiability",
    "figure_force_curves",
    "figure_joint",
    "figure_joint_load",
    "figure_joints",
    "figure_momentum",
    "figure_motion",
    "figure_multipliers",
    "figure_orbit",
    "figure_phase",
    "figure_pointing",
    "figure_profiles",
    "figure_response",
    "figure_section",
    "figure_sensitivity",
    "figure_restitution",
    "figures_of_experiment",
    "rendered",
    "figure_scenarios",
    "figure_shock",
    "figure_spectra",
    "figure_gears",
    "figure_swept",
    "figure_stops",
    "figure_spectrogram",
    "figure_steady_force",
    "folder_for_figures",
    "paper_figures",
    "processes_to_draw",
    "run_figure",
    "save_contact_figures",
    "save_figure",
    "save_figures",
    "study_distribution",
    "study_figures",
    "study_map",
    "study_response",
    "study_scatter",
    "study_sensitivities",
    "table_figures",
]

loaded_when_used(
    __name__,
    {
        "_run_figure": "RunFigure",
        "attractors": "Attractor figure_attractors",
        "audit": "figure_energy figure_momentum",
        "base": "BASE_QUANTITIES figure_base figure_joints",
        "bodies": "BODY_QUANTITIES figure_body",
        "catalogue": "CATALOGUE Allowed allowed_figures run_figure",
        "closures": (
            "figure_applied_forces figure_closure_forces figure_coupling_torques figure_drive_efforts"
        ),
        "control": "figure_control",
        "contact": "figure_force_curves figure_restitution save_contact_figures",
        "drawn": "Drawn drawn_numbers",
        "eccentricity": "figure_eccentricity",
        "glance": "figure_glance",
        "elastic": "figure_deflection",
        "hysteresis": "figure_hysteresis",
        "experiment": "figure_contact_width figure_experiment figures_of_experiment",
        "exponents": "figure_exponents",
        "files": (
            "FORMATS check_one_mechanism folder_for_figures processes_to_draw rendered save_figure "
            "save_figures"
        ),
        "fit_curves": "curves_of_fit figure_fit",
        "fit_sure": "correlations figure_correlation figure_profiles",
        "fit_tests": "figure_experiments figure_identifiability",
        "forces": "figure_contact_forces",
        "joint": "figure_joint",
        "loads": "figure_joint_load figure_steady_force",
        "motion": "QUANTITIES figure_motion",
        "bore": "figure_bore_load",
        "orbit": "figure_orbit",
        "papers": ("ATTRACTORS PAPERS AttractorFigure Diagram DiagramFigure PaperFigure paper_figures"),
        "periodic": "figure_branch figure_multipliers",
        "phase": "figure_phase",
        "pointing": "figure_pointing",
        "response": "figure_response",
        "scenarios": "figure_scenarios",
        "sections": "figure_bifurcation figure_section",
        "sensitivity": "figure_sensitivity",
        "shaken": "figure_density figure_shock figure_swept",
        "spectra": "SIGNALS figure_spectra figure_spectrogram",
        "gears": "figure_gears",
        "stops": "figure_stops",
        "study": (
            "QUANTILES StudyFigure study_distribution study_figures study_map study_response "
            "study_scatter study_sensitivities"
        ),
        "tables": "TableFigure table_figures",
    },
)
