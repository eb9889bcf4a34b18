"""Figures of runs by their names, so that editors complete them: ``run.plot("contact_forces")``.

What stands between the marks is written by ``python scripts/pages/reference.py --write``, of the catalogue of
figures (:mod:`antenna_pin.plot.catalogue`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Protocol

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Drawing", "FigureName", "NamedFigures"]


class Drawing(Protocol):
    """Figure of a run, ready to be drawn."""

    def __call__(
        self,
        *,
        beside: Any = (),
        joint: str | None = None,
        width: Literal["column", "page"] = "page",
        **options: Any,
    ) -> Figure:
        """Draw it."""
        ...


# <!-- table: figure_names -->
FigureName = Literal[
    "motion_angle",
    "motion_rate",
    "motion_acceleration",
    "slide_position",
    "slide_rate",
    "slide_acceleration",
    "joint_motion",
    "angle_between_runs",
    "rate_between_runs",
    "contact_forces",
    "journal_orbit",
    "bore_load",
    "eccentricity",
    "contact_scenarios",
    "joint_load",
    "steady_force",
    "closure_forces",
    "coupling_torques",
    "drive_efforts",
    "applied_forces",
    "control",
    "stops",
    "gears",
    "deflection",
    "hysteresis",
    "spectra",
    "spectrogram",
    "swept_response",
    "random_density",
    "shock_spectrum",
    "base_position",
    "base_velocity",
    "base_acceleration",
    "base_attitude",
    "base_angular_velocity",
    "base_angular_acceleration",
    "joints_angle",
    "joints_rate",
    "joints_acceleration",
    "body_position",
    "body_velocity",
    "body_acceleration",
    "pointing",
    "energy",
    "momentum",
]


class NamedFigures(Protocol):
    """Figures of runs, each ready to be drawn."""

    motion_angle: Drawing
    """Angle of a joint."""
    motion_rate: Drawing
    """Rate of a joint."""
    motion_acceleration: Drawing
    """Acceleration of a joint."""
    slide_position: Drawing
    """Position of a joint."""
    slide_rate: Drawing
    """Rate of a joint."""
    slide_acceleration: Drawing
    """Acceleration of a joint."""
    joint_motion: Drawing
    """Motion of a joint."""
    angle_between_runs: Drawing
    """Angle of a joint, runs less one another."""
    rate_between_runs: Drawing
    """Rate of a joint, runs less one another."""
    contact_forces: Drawing
    """Contact forces in a joint."""
    journal_orbit: Drawing
    """Orbit of the journal in a joint."""
    bore_load: Drawing
    """Load around the bore of a joint."""
    eccentricity: Drawing
    """Eccentricity and tilt in a joint."""
    contact_scenarios: Drawing
    """Contact scenarios of a joint."""
    joint_load: Drawing
    """Force through a joint."""
    steady_force: Drawing
    """Force through a joint in the second half of the run."""
    closure_forces: Drawing
    """Forces of the closures."""
    coupling_torques: Drawing
    """Torques of the couplings."""
    drive_efforts: Drawing
    """What the drives exert."""
    applied_forces: Drawing
    """Forces on links."""
    control: Drawing
    """What controllers measure and command."""
    stops: Drawing
    """End stops and latches."""
    gears: Drawing
    """Gears, belts and cables."""
    deflection: Drawing
    """Deflections of flexible links."""
    hysteresis: Drawing
    """Torque of springs over angle."""
    spectra: Drawing
    """Spectra, a joint."""
    spectrogram: Drawing
    """Spectrogram, a joint."""
    swept_response: Drawing
    """Response to the swept base."""
    random_density: Drawing
    """Power spectral density on the shaken base."""
    shock_spectrum: Drawing
    """Shock response spectrum on the shaken base."""
    base_position: Drawing
    """Position of the base."""
    base_velocity: Drawing
    """Velocity of the base."""
    base_acceleration: Drawing
    """Acceleration of the base."""
    base_attitude: Drawing
    """Attitude of the base."""
    base_angular_velocity: Drawing
    """Angular velocity of the base."""
    base_angular_acceleration: Drawing
    """Angular acceleration of the base."""
    joints_angle: Drawing
    """Angle of all joints."""
    joints_rate: Drawing
    """Rate of all joints."""
    joints_acceleration: Drawing
    """Acceleration of all joints."""
    body_position: Drawing
    """Position of the body that a joint moves."""
    body_velocity: Drawing
    """Velocity of the body that a joint moves."""
    body_acceleration: Drawing
    """Acceleration of the body that a joint moves."""
    pointing: Drawing
    """Boresight and pointing error."""
    energy: Drawing
    """Energy: work, storage and losses."""
    momentum: Drawing
    """Drift of momentum."""


# <!-- end -->
