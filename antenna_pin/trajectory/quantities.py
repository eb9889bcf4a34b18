"""Catalogue of the quantities of a run, and of tables derived from it.

Result files, summaries, tables, reports, cards, responses of studies and sensitivities render the rows here.
A row with a reduction is computed from the series or the episodes that it names wherever it is needed.
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from antenna_pin.trajectory.columns import ColumnRule, Reduction, Variable, end, peak, rows, total
from antenna_pin.trajectory.read import json_in, names_along

if TYPE_CHECKING:
    import xarray as xr


SIZE = ColumnRule(least=0.0)
ORDERED = ColumnRule(rising=True)
TOTAL = ColumnRule(least=0.0, summed=True)
# Of contacts; none of them is sure to lose energy under a law of a user's.
LOST = ColumnRule(least=0.0, summed=True, passive=True)
_LACKS = ColumnRule(lacks=True)
_COUNT, _SHARE, _EXACT = {"form": "count"}, {"form": "share"}, {"exact": True}
COUPLED = "torque of the coupling on its follower (a force [N] if it slides)"
_OF_TOUCH = "largest effort (N) of the touch that ends, or lasts to the end; NaN: none"
_HOLDS = "largest size of the torque that holds the motion, located between samples (a force [N])"
_EFFORT = "peak_torque|peak_force: peak torque|peak force"
_PEAK, _RMS = ": peak torque|peak force|peak", ": rms torque|rms force|rms"

# fmt: off
#: Ends, sums and peaks of series, recorded with each result.
SUMMARIES: tuple[Variable, ...] = rows(
    "summary: joint",
    ("final_angle", "rad", "motion angle at the end", "angle: angle at the end", end("motion_angle"),
     {"digits": 5}),
    ("final_rate", "rad/s", "its rate at the end", "rate: rate at the end", end("motion_rate"),
     {"digits": 5}),
    ("peak_acceleration", "rad/s^2", "largest size of its acceleration at a sample",
     peak("motion_acceleration")),
    "summary: sliding_joint",
    ("final_position", "m", "way along the joint's axis at the end", "position: position at the end",
     end("slide_position"), {"digits": 5}),
    ("final_slide_rate", "m/s", "its rate at the end", "slide_rate: rate at the end", end("slide_rate"),
     {"digits": 5}),
    ("peak_slide_acceleration", "m/s^2", "largest size of its acceleration at a sample",
     "peak_slide_acceleration: peak acceleration", peak("slide_acceleration")),
    "summary: drive",
    ("total_work", "J", "work of the drive from start to end", "work", end("drive_work")),
    ("total_gross_work", "J", "integral of |power| of the drive from start to end", TOTAL, "-: gross work",
     end("drive_gross_work")),
    "summary: contact",
    ("total_normal_loss", "J", "energy lost to normal contact from start to end", LOST, "-",
     end("dissipation_normal")),
    ("total_friction_loss", "J", "energy lost to friction from start to end", LOST, "-",
     end("dissipation_friction")),
    "summary: motion",
    ("peak_effort", "N m|N", _HOLDS, _EFFORT, peak("drive_torque")),
    ("time_of_peak_effort", "s", "when it was", "-"),
    "summary: drive",
    ("peak_drive_effort", "N m|N",
     "largest size of the drive's torque, located between samples (a force [N])", SIZE, "-"),
    ("time_of_peak_drive_effort", "s", "when it was", "-"),
    "summary: closure",
    ("peak_closure_force", "N", "largest force of the closure at a sample", "peak_force",
     peak("closure_force")),
    ("peak_closure_moment", "N m", "largest moment of the closure at a sample", "peak_moment",
     peak("closure_moment")),
    "summary: coupling",
    ("peak_coupling_torque", "N m|N", f"largest size of the {COUPLED}", _EFFORT, peak("coupling_torque")),
    "summary: spring",
    ("total_damper_loss", "J", "energy lost in the damper, or to a joint's own friction, in all", TOTAL,
     "-: energy lost", end("dissipation_damper")),
    "summary: bearing",
    ("peak_bearing_force", "N", "largest force of the bearing at a sample", "peak_force",
     peak("bearing_force")),
    ("peak_bearing_moment", "N m", "largest moment of the bearing at a sample", "peak_moment",
     peak("bearing_moment")),
    "summary: sampled",
    ("ticks", "1", "times of the controller's samples", SIZE, "ticks: instants", _COUNT),
    ("saturated_ticks", "1", "those at which limits held its command", SIZE,
     "saturated: instants at limits", _COUNT),
    "summary: element",
    ("total_element_loss", "J", "energy lost in it in all", LOST, "element_loss: energy lost",
     end("element_loss")),
    "summary: elastic_part",
    ("peak_deflection", "rad|m", "largest size of the part's deflection at a sample (a way [m])",
     "peak_deflection|peak_shift: peak deflection", peak("deflection")),
    ("peak_elastic_energy", "J", "largest energy in the part's spring at a sample",
     "peak_elastic_energy: peak energy in the spring", peak("elastic_energy")),
    ("total_elastic_loss", "J", "energy lost in the part's damper in all", TOTAL,
     "elastic_loss: energy lost in the damper", end("dissipation_elastic")),
    ("peak_spin", "rad/s", "largest angular speed of the part's hub at a sample", SIZE, "-"),
    "summary: force",
    ("total_force_work", "J", "work of the force from start to end", "work", end("force_work")),
    ("total_force_gross_work", "J", "integral of |power| of the force from start to end", TOTAL,
     "-: gross work", end("force_gross_work")),
    ("total_force_loss", "J", "energy lost in all, of one that puts nothing in", "-: energy lost",
     end("force_loss")),
    "summary: force axis",
    ("total_impulse", "N s", "integral of the force from start to end, world axes", "impulse",
     end("force_impulse")),
    ("total_angular_impulse", "N m s", "integral of its moment about the world's origin, world axes",
     "angular_impulse: angular impulse about the origin", end("force_angular_impulse")),
    "summary: force_place",
    ("peak_applied_force", "N", "largest force there at a sample", "peak_force", peak("applied_force")),
    ("peak_applied_torque", "N m", "largest torque about the place at a sample", "peak_torque",
     peak("applied_torque")),
)

#: Contacts, changes of mode, instants of controllers and events, recorded one by one.
EPISODES: tuple[Variable, ...] = rows(
    "episodes: episode",
    ("onset_time", "s", "start of the contact", ORDERED),
    ("release_time", "s", "end of the contact; NaN: still touching", _LACKS),
    ("approach_speed", "m/s", "depth rate at onset, floored", SIZE),
    ("peak_force", "N", "largest normal force, of the dense output", SIZE),
    ("peak_time", "s", "when the force was largest"),
    ("peak_depth", "m", "largest depth, of the dense output", SIZE),
    ("impulse", "N s", "integral of the normal force", TOTAL),
    ("dissipated", "J", "energy lost, normal and friction", LOST),
    ("effective_mass", "kg", "(n^T M^-1 n)^-1 at onset, along the normal", SIZE),
    ("episode_contact", "1", "index of the contact"),
    "episodes: change",
    ("change_time", "s", "when the mode changed", ORDERED),
    ("change_angle", "rad|m", "angle of the joint then (a way [m])"),
    ("change_rate", "rad/s|m/s", "rate before (m/s)"),
    ("change_rate_after", "rad/s|m/s", "rate after (m/s)"),
    ("change_loss", "J", "energy lost in the impulse"),
    ("change_impulse", "N m s|N s", "impulse about the axis on the child (N s)"),
    ("change_energy", "J", "energy of a latch's joint, 1/2 I_r rate^2; NaN: no latch", _LACKS),
    ("change_peak_effort", "N m|N", _OF_TOUCH, ColumnRule(least=0.0, lacks=True)),
    ("change_peak_time", "s", "when that effort was", _LACKS),
    "episodes: tick",
    ("tick_time", "s", "times of the controller's samples", ORDERED),
    ("tick_controller", "1", "index of the controller among the sampled ones", SIZE),
    "episodes: tick signal",
    ("tick_signal", "1", "recorded signals and commands, in SI units", _LACKS),
    "episodes: event",
    ("event_time", "s", "when the event happened", ORDERED),
    ("event_energy", "J", "energy that the event's action brought in"),
)

#: Of the run as a whole: counts, books, equations of closures, most of which measure round-off.
_RUN = rows(
    "run: ",
    ("time", "s", "simulated time", "=", {"exact": False}),
    ("accepted", "1", "steps accepted", "=", _COUNT),
    ("rejected", "1", "steps rejected", "=", _COUNT),
    ("relocated", "1", "steps cut to a change of contact", "=", _COUNT),
    ("wall_seconds", "s", "wall time", "="),
    ("compile_seconds", "s", "wall time of compiling, once", "="),
    ("gap_difference", "m", "gaps, coal against closed form", "="),
    "conservation: ",
    ("energy_error", "J", "energy balance error", "="),
    ("gross_work", "J", "gross work of drives and forces", "=", {"exact": False}),
    ("energy_scale", "J", "energy scale: largest of gross work, kinetic, stored", "="),
    ("energy_error_relative", "1", "energy balance error, relative", "="),
    ("energy_tolerance", "J", "energy balance error that is explained", "="),
    ("linear_momentum_drift", "kg m/s", "linear momentum drift"),
    ("linear_momentum_scale", "kg m/s", "linear momentum scale"),
    ("linear_momentum_drift_relative", "1", "linear momentum drift, relative", "="),
    ("linear_momentum_tolerance", "kg m/s", "linear momentum drift that is explained", "="),
    ("angular_momentum_drift", "kg m^2/s", "angular momentum drift"),
    ("angular_momentum_scale", "kg m^2/s", "angular momentum scale"),
    ("angular_momentum_drift_relative", "1", "angular momentum drift, relative", "="),
    ("angular_momentum_tolerance", "kg m^2/s", "angular momentum drift that is explained", "="),
    "constraints: ",
    ("freedoms", "1", "freedoms of the tree", "=", _COUNT),
    ("closure_equations", "1", "equations of closures", "=", _COUNT),
    ("couplings", "1", "equations of couplings", "=", _COUNT),
    ("closure_rank", "1", "independent equations of closures", "=", _COUNT),
    ("rank", "1", "independent equations, those of motions among them", "=", _COUNT),
    ("motions", "1", "prescribed motions", _COUNT),
    ("mobility", "1", "mobility: freedoms that closures leave", "=", _COUNT),
    ("freedoms_left", "1", "freedoms that closures and motions leave", "=", _COUNT),
    ("position_residual", "m", "largest position residual of closures and motions", "="),
    ("angle_residual", "rad", "largest angle residual of closures and motions", "="),
    ("velocity_residual", "m/s", "largest velocity residual of closures and motions", "="),
    ("rate_residual", "rad/s", "largest rate residual of closures and motions", "="),
    ("projection_energy", "J", "energy that corrections put in", "="),
    exact=True,
)
RUN: dict[str, Variable] = {one.name: one for one in _RUN}

#: Of the episodes of each contact, or of several contacts together.
CONTACTS: tuple[Variable, ...] = rows(
    "contacts: contact",
    ("impacts", "1", "number of contacts", "episodes: impacts", Reduction("count", "peak_force"), _COUNT),
    ("peak_force", "N", "largest normal force", peak("peak_force")),
    ("peak_depth", "m", "largest depth", peak("peak_depth"), _EXACT),
    ("approach_speed", "m/s", "largest speed at first touch", "largest_approach_speed",
     peak("approach_speed")),
    ("impulse", "N s", "all normal impulses", total("impulse")),
    ("dissipated", "J", "energy lost in contacts", ": energy lost", total("dissipated")),
    ("contact_time", "s", "time in contact, each contact counted", "-", total("duration")),
)

_TIMES = (("onset", "s", "first touch"), ("release", "s", "release; NaN: still touching"))
_DENSITY = (("density", "{density}", "amplitude density"), ("power", "{power}", "power density"))
#: Columns of tables that follow from a result, by table.
TABLES: dict[str, dict[str, Variable]] = {}
for _one in rows(
    "impacts: impact",
    ("onset", "s", "first touch", {"digits": 6}),
    ("duration", "s", "from first touch to release, or to the end of the run"),
    ("approach_speed", "m/s", "rate of depth at first touch"),
    ("separation_speed", "m/s", "rate of the gap at release; NaN: still touching"),
    ("restitution", "1", "separation over approach speed; NaN: still touching or floored"),
    ("peak_force", "N", "largest normal force"),
    ("peak_time", "s", "when the force was largest", ": time of peak", {"digits": 6}),
    ("peak_depth", "m", "largest depth", _EXACT),
    ("impulse", "N s", "integral of the normal force"),
    ("dissipated", "J", "energy lost, normal and friction", ": energy lost"),
    ("ended", "1", "whether it was released before the end"),
    ("floored", "1", "whether the law saw its floor of speed"),
    ("blow", "1", "number of the blow of the joint"),
    "impact statistics: contact",
    ("impacts", "1", "number of impacts", _COUNT),
    ("floored", "1", "impacts slower than the law's floor", ": impacts below the law's floor of speed",
     _COUNT),
    ("touching", "1", "impacts that have not ended", ": still touching at the end", _COUNT),
    ("median_approach_speed", "m/s", "rate of depth at first touch"),
    ("largest_approach_speed", "m/s", "rate of depth at first touch"),
    ("median_restitution", "1", "separation over approach speed; NaN: still touching or floored",
     ": median restitution delivered"),
    ("median_duration", "s", "from first touch to release, or to the end of the run"),
    ("peak_force", "N", "largest normal force"),
    ("impulse", "N s", "integral of the normal force"),
    ("dissipated", "J", "energy lost, normal and friction", ": energy lost"),
    "blows: blow",
    ("onset", "s", "first touch"),
    ("duration", "s", "from first touch until no contact of the surfaces touches, or to the end of the run"),
    ("contacts", "1", "contact episodes that it consists of", _COUNT),
    ("approach_speed", "m/s", "largest rate of depth at a first touch"),
    ("peak_force", "N", "largest normal force of one contact"),
    ("impulse", "N s", "integral of the normal forces' magnitudes"),
    ("dissipated", "J", "energy lost, normal and friction", ": energy lost"),
    ("ended", "1", "whether it was over before the end"),
    "blow statistics: clearance_joint",
    ("blows", "1", "number of blows", _COUNT),
    "loads: contact",
    ("peak_force", "N", "largest normal force, of the dense output"),
    ("mean_force", "N", "mean normal force over the whole time"),
    ("mean_force_in_contact", "N", "mean normal force while touching; NaN: never"),
    ("rms_force", "N", "root mean square of the normal force"),
    ("contact_share", "1", "share of the time in contact", "=", _SHARE),
    ("episodes", "1", "number of contacts", ": impacts", _COUNT),
    ("impulse", "N s", "integral of the normal force"),
    ("dissipated", "J", "energy lost, normal and friction", ": energy lost"),
    "joint loads: clearance_joint",
    ("joint_peak_force", "N", "largest contact force on the journal, of the samples"),
    ("joint_mean_force", "N", "mean size of the contact force on the journal"),
    ("joint_rms_force", "N", "root mean square of the contact force on the journal"),
    ("joint_contact_share", "1", "share of the time with any contact"),
    ("joint_episodes", "1", "number of contacts", _COUNT),
    ("joint_impulse", "N s", "integral of all normal forces"),
    ("joint_dissipated", "J", "energy lost, normal and friction"),
    "settling: clearance_joint",
    ("time", "s", "lasting contact from", "="),
    ("share_before", "1", "share of the time in contact before", "=", _SHARE),
    ("share_after", "1", "share of the time in contact after", "=", _SHARE),
    ("decay_rate", "1/s", "decay of approach speeds", "="),
    ("decay_r2", "1", "R2 of an exponential decay", "="),
    ("last_gap", "s", "end of the last time apart", "="),
    "closure loads: closure",
    ("peak_force", "N", "largest force at a sample"),
    ("time_of_peak_force", "s", "when it was", ": at"),
    ("rms_force", "N", "root mean square of the force"),
    ("peak_moment", "N m", "largest moment at a sample"),
    ("rms_moment", "N m", "root mean square of the moment"),
    "coupling loads: coupling",
    ("peak_torque", "N m|N", "largest size of the torque on the follower at a sample (N if it slides)",
     _PEAK),
    ("time_of_peak_torque", "s", "when it was", ": at"),
    ("rms_torque", "N m|N", "root mean square of the torque on the follower (N if it slides)", _RMS),
    "drive loads: drive",
    ("peak_effort", "N m|N", "largest size of the effort, between samples too (N if it slides)",
     _PEAK),
    ("time_of_peak_effort", "s", "when it was", ": at"),
    ("rms_effort", "N m|N", "root mean square of the effort (N if it slides)", _RMS),
    ("peak_power", "W", "largest size of the power at a sample"),
    ("work", "J", "work since the start"),
    ("gross_work", "J", "integral of the size of the power"),
    "elastic motion: elastic_part",
    ("frequency", "Hz", "with the hub held"),
    ("peak_deflection", "rad|m", "largest size at a sample", ": peak deflection|peak deflection|peak"),
    ("time_of_peak", "s", "when it was", ": at"),
    ("rms_deflection", "rad|m", "root mean square", ": rms deflection|rms deflection|rms"),
    ("peak_energy", "J", "largest energy of the part against its hub"),
    ("lost", "J", "energy lost in the damper", ": energy lost"),
    ("spin_ratio", "1", "largest angular speed of the hub over the part's own", ": spin over frequency"),
    "controllers: controller",
    ("peak_error", "rad|m", "largest size of the error at a sample", peak("control_error")),
    "motors: motor",
    ("peak_current", "A", "largest size of the current at a sample", peak("motor_current")),
    ("heat", "J", "heat of the winding", "=", end("motor_heat")),
    "traced springs: traced_spring",
    ("peak_spring_torque", "N m|N", "largest size of the torque at a sample", ": peak torque|peak force",
     peak("spring_torque")),
    "point springs: point_spring",
    ("peak_tension", "N", "largest size of the tension at a sample", peak("spring_tension")),
    ("peak_length", "m", "largest length at a sample", peak("spring_length")),
    "frictions: element",
    ("peak_element_effort", "N m|N", "largest size of the effort at a sample", ": peak torque|peak force",
     peak("element_effort")),
    "touches: touch",
    *_TIMES,
    ("approach_rate", "rad/s|m/s", "rate into contact at the onset (m/s)"),
    ("rebound_rate", "rad/s|m/s", "rate out of it at the release; NaN: still touching (m/s)"),
    ("peak_effort", "N m|N", "largest torque; infinite in a blow (a force [N])",
     ": peak torque|peak force"),
    ("impulse", "N m s|N s", "integral of the torque's size; NaN: still touching (N s)"),
    ("loss", "J", "energy lost; NaN: still touching", ": energy lost"),
    "latch events: latch_event",
    ("time", "s", "when"),
    ("angle", "rad|m", "of the joint (a way [m])",
     ": angle at the last capture|position at the last capture"),
    ("rate", "rad/s|m/s", "of the joint before (m/s)", ": rate at the last capture"),
    ("loss", "J", "energy lost by it"),
    ("impulse", "N m s|N s", "on the child by it (N s)", ": impulse of the last capture"),
    ("energy", "J", "of the joint's own motion before: what a lock would take",
     ": energy at the last capture"),
    "spans: span",
    ("begin", "s", "begin"),
    ("end", "s", "end"),
    # Stops, latches, gears, belts and cables in a summary.
    "elements: element",
    ("touches", "1", "touches", _COUNT),
    ("fastest_touch", "rad/s|m/s", "fastest approach of a touch"),
    ("fastest_rebound", "rad/s|m/s", "fastest rebound of a touch", "-: fastest rebound"),
    ("peak_torque", "N m|N", "largest torque (a force [N])", _EFFORT),
    ("largest_blow", "N m s|N s", "largest impulse", "="),
    ("captures", "1", "captures of a latch", _COUNT),
    ("refusals", "1", "refusals of a latch", _COUNT),
    ("largest_energy_refused", "J", "largest energy at a refusal"),
    ("last_capture", "s", "time of the last capture"),
    ("let_go", "1", "releases of a latch", _COUNT),
    ("held_at_end", "1", "whether a latch holds at the end", _COUNT),
    ("time_apart", "s", "time without contact", "="),
    ("time_slack", "s", "time with a slack strand", "="),
    ("element_loss", "J", "energy lost", "="),
    # Arrays over time, frequency or windows; {units} is the unit of a signal, {whose} the owner of a frame.
    "poses: time body axis",
    ("position", "m", "link's frame in the world"),
    "poses: time body quaternion",
    ("attitude", "1", "link's frame in the world, quaternion"),
    "twists: time body axis",
    ("velocity", "m/s", "of the link's frame"),
    ("angular_velocity", "rad/s", "of the link"),
    "transmitted loads: time moving_joint axis",
    ("force", "N", "force through the joint"),
    ("torque", "N m", "torque through the joint"),
    "base loads: time axis",
    ("force", "N", "force on the base"),
    ("moment", "N m", "moment on the base"),
    "frame motion: time axis",
    ("position", "m", "{whose}'s origin, world axes"),
    ("rotation", "rad", "{whose}'s rotation since the start, world axes"),
    ("velocity", "m/s", "velocity of the {whose}'s origin, world axes"),
    ("angular_velocity", "rad/s", "{whose}'s angular velocity, world axes"),
    ("acceleration", "m/s^2", "acceleration of the {whose}'s origin, world axes"),
    ("angular_acceleration", "rad/s^2", "{whose}'s angular acceleration, world axes"),
    "frame motion: time quaternion",
    ("attitude", "1", "{whose} in the world, quaternion"),
    "journal motion: time place axis",
    ("offset", "m", "journal's axis from the bearing's, bearing axes"),
    "journal motion: time place",
    ("eccentricity", "m", "its distance from the bearing's axis or centre"),
    ("eccentricity_ratio", "1", "eccentricity over clearance"),
    "journal motion: time",
    ("tilt", "rad", "angle between the axes"),
    ("twist", "rad", "turn about the bearing's axis"),
    ("axial", "m", "journal's centre along the axis"),
    "bore load: contact sector",
    ("impulse", "N s", "integral of normal force"),
    "orbit angles: time",
    *((name, "rad", f"{name} of the link from orbit-fixed axes") for name in ("pitch", "roll", "yaw")),
    "pointing error: time pointing_axis",
    ("error", "rad", "pointing error about"),
    "pointing error: time cross_axis",
    ("boresight_error", "rad", "turn of the boresight about"),
    "pointing error: time",
    ("half_cone", "rad", "angle between both boresights"),
    "settling curve: window",
    ("contact_share", "1", "share of the window in contact"),
    ("impacts", "1", "contacts begun in the window"),
    ("largest_approach_speed", "m/s", "largest approach speed of the window"),
    ("mean_approach_speed", "m/s", "mean approach speed of the window"),
    *("spectrum: frequency", *_DENSITY, "spectra: frequency component", *_DENSITY),
    *("spectrogram: frequency time", *_DENSITY),
    "peaks: peak",
    ("frequency", "Hz", "frequency"),
    ("amplitude", "{units}", "amplitude"),
    ("contrast", "1", "over the spectrum around it"),
    "bands: band",
    ("low", "Hz", "lowest frequency of the band"),
    ("high", "Hz", "highest frequency of the band"),
    ("rms", "{units}", "root mean square in the band"),
    ("standard_error", "{units}", "its standard error, of a Gaussian signal"),
    "shock: frequency",
    ("positive", "{units}", "largest absolute acceleration, positive sense"),
    ("negative", "{units}", "largest absolute acceleration, negative sense"),
    ("maximum", "{units}", "largest absolute acceleration"),
    ("residual", "{units}", "largest absolute acceleration after the signal"),
    ("pseudo_velocity", "{units} s", "omega times the largest relative displacement"),
    "swept response: window",
    ("frequency", "Hz", "frequency of the base"),
    ("way", "1", "1: swept up, -1: down"),
    ("time", "s", "middle of the window"),
    ("response", "({units})/(m/s^2)", "target over the base's acceleration"),
    ("gain", "({units})/(m/s^2)", "magnitude of the response"),
    ("phase", "rad", "phase of the response"),
    ("amplitude", "{units}", "amplitude of the target at the base's frequency"),
    ("base", "m/s^2", "amplitude of the base's acceleration"),
    ("distortion", "1", "what does not follow over what does, root mean square"),
):
    TABLES.setdefault(_one.source, {})[_one.name] = _one
# fmt: on


class Group(NamedTuple):
    """Things of one kind in a summary, a row of a table for each."""

    title: str  # heading of their names
    # Dimension of the result that they are labels of; that of :data:`TABLES` without one of their own.
    dim: str
    prefix: bool = False  # whether headings of its quantities begin with the group

    @property
    def variables(self) -> tuple[Variable, ...]:
        """The quantities of each."""
        if self.dim == "contact":
            return CONTACTS
        known = (*SUMMARIES, *TABLES["elements"].values(), *TABLES["blow statistics"].values())
        found = tuple(one for one in known if one.dims[:1] == (self.dim,))
        return (*found, _WORK) if self.dim == "motion" else found


_WORK = next(one for one in SUMMARIES if one.name == "total_work")
#: Groups of a summary whose entries are named things.
GROUPS: dict[str, Group] = {
    "motion": Group("joints", "joint"),
    "slides": Group("sliding joints", "sliding_joint"),
    "contacts": Group("contacts", "contact"),
    "elastic_parts": Group("elastic parts", "elastic_part"),
    "closures": Group("closures", "closure"),
    "motions": Group("motions", "motion"),
    "couplings": Group("couplings", "coupling"),
    "bearings": Group("bearings", "bearing"),
    "stops": Group("stops", "element", True),
    "latches": Group("latches", "element", True),
    "gears": Group("gears", "element", True),
    "forces": Group("forces", "force"),
    "controllers": Group("controllers", "sampled", True),
    "blows": Group("surfaces", "clearance_joint"),
}
#: Quantities by their keys in summaries, and whether one is of what slides; of None, either.
HEADINGS: dict[str, tuple[Variable, bool | None]] = {}
for _one in (*RUN.values(), *(one for group in GROUPS.values() for one in group.variables)):
    _both = _one.key() == _one.key(slides=True)
    for _slides in (False, True):
        HEADINGS.setdefault(_one.key(_slides), (_one, None if _both else _slides))


def heading_of(key: str) -> str:
    """Return the heading of an entry of a summary, with its unit."""
    if key not in HEADINGS:
        return key.replace("_", " ")
    variable, slides = HEADINGS[key]
    return variable.heading(slides)


def slides_along(data: xr.Dataset, dim: str) -> dict[str, bool]:
    """Return whether what the labels along a dimension stand for slides, where that is known."""
    if dim in ("joint", "sliding_joint"):
        return dict.fromkeys(names_along(data, dim), dim == "sliding_joint")
    if dim == "traced_spring":
        sliding = names_along(data, "sliding_joint")
        joints = names_along(data, "traced_joint")
        return {name: at in sliding for name, at in zip(names_along(data, dim), joints, strict=True)}
    attribute = {"elastic_part": "elastic_parts", "coupling": "couplings", "element": "elements"}.get(
        dim, "drives"
    )
    about = json.loads(data.attrs.get(attribute, "{}"))
    return {name: bool(about.get(name, {}).get("slides")) for name in names_along(data, dim)}


def entries_of(data: xr.Dataset, dim: str) -> dict[str, dict[str, float]]:
    """Return the recorded numbers along a dimension, by label and summary key."""
    variables = [one for one in SUMMARIES if one.dims[:1] == (dim,) and one.key() and one.name in data]
    values = {one.name: np.asarray(data[one.name].values, dtype=float) for one in variables}
    return {
        name: {one.key(slides): _size(values[one.name][k]) for one in variables}
        for k, (name, slides) in enumerate(slides_along(data, dim).items())
    }


def _size(value: Any) -> float:
    return math.hypot(*value.tolist()) if np.ndim(value) else float(value)


def reduced(variable: Variable, columns: Any, mine: Any, until: float) -> float | int:
    """Return a number of episodes.

    Args:
        variable: With a reduction of a variable of episodes.
        columns: The variables of episodes, with their ``values``.
        mine: Which episodes count.
        until: End of the run, up to which an episode without release lasts [s].
    """
    assert variable.reduced is not None
    by, of = variable.reduced
    if of == "duration":
        release = np.nan_to_num(np.asarray(columns["release_time"].values, dtype=float), nan=until)
        values = (release - columns["onset_time"].values)[mine]
    else:
        values = np.asarray(columns[of].values, dtype=float)[mine]
    if by == "count":
        return int(values.size)
    return float(values.sum()) if by == "sum" else float(values.max()) if values.size else 0.0


def table(
    name: str,
    columns: Mapping[str, Any],
    labels: Mapping[str, Any],
    attributes: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """Return columns along one dimension as a table of :data:`TABLES`.

    Args:
        name: Name of the table.
        columns: Values along its dimension, by column.
        labels: Labels along the dimension, by coordinate; without its own labels it is numbered.
        attributes: Attributes of the dataset.
    """
    (dim,) = next(iter(TABLES[name].values())).dims
    coords: dict[str, Any] = {} if dim in labels else {dim: np.arange(len(next(iter(columns.values()))))}
    for key, texts in labels.items():
        coords[key] = (dim, np.array(texts, dtype=object) if len(texts) else np.zeros(0, dtype="<U1"))
    return dataset_of(name, {key: np.array(values) for key, values in columns.items()}, coords, attributes)


def dataset_of(
    name: str,
    columns: Mapping[str, Any],
    coords: Mapping[str, Any],
    attributes: Mapping[str, Any] | None = None,
    **words: str,
) -> xr.Dataset:
    """Return arrays with dimensions, units and long names from :data:`TABLES`.

    Args:
        name: Name of the table.
        columns: Arrays by column.
        coords: Coordinates, in any form that xarray accepts.
        attributes: Attributes of the dataset.
        **words: Values of the fields in units and long names, such as ``units``.
    """
    import xarray as xr

    found = {}
    for key, values in columns.items():
        variable = TABLES[name][key]
        about = {"units": variable.units.format(**words), "long_name": variable.meaning.format(**words)}
        found[key] = (variable.dims, values, about)
    return xr.Dataset(found, coords=coords, attrs=attributes)


#: Quantities of a record that need all its samples: peaks at samples, located efforts, the ledger.
OF_SAMPLES = frozenset(
    one.name
    for one in (*SUMMARIES, *RUN.values())
    if one.source == "conservation" or one.name.startswith(("peak_", "time_of_peak_"))
)
#: Names that ``output.keep`` may have.
KEEPABLE = frozenset({*OF_SAMPLES, "blows", *(one.name for one in (*CONTACTS, *SUMMARIES))})


def needs_samples(quantities: Collection[str] | None) -> bool:
    """Return whether a record with these quantities needs all samples; None stands for all.

    Episodes, and sums from start to end, do not.
    """
    return quantities is None or not OF_SAMPLES.isdisjoint(quantities)


def left_out_of(data: xr.Dataset) -> frozenset[str]:
    """Return the quantities left out of a result at the request of its scenario."""
    names = json_in(data.attrs.get("kept"))
    return OF_SAMPLES if isinstance(names, list) and not needs_samples(names) else frozenset()
