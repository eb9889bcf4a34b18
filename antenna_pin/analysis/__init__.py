"""What a run shows, and what a joint's shape allows: readers of trajectories and geometries."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.analysis.at_a_glance import Answer, Line, answer
    from antenna_pin.analysis.attitude import interpolate_attitude, interpolation_error
    from antenna_pin.analysis.base import base_motion
    from antenna_pin.analysis.between import between_samples
    from antenna_pin.analysis.blows import blow_statistics, blows
    from antenna_pin.analysis.bodies import body_poses, body_twists, joint_loads, mechanism_of
    from antenna_pin.analysis.body import body_deviation, body_motion, moved_body
    from antenna_pin.analysis.branch import (
        StabilitySpan,
        said_of_multiplier,
        stability_spans,
        unexplained_changes,
    )
    from antenna_pin.analysis.chaos_test import Chaos, ChaosTest, chaos_test
    from antenna_pin.analysis.closure_words import (
        said_of_constraints,
        said_of_coupling,
        said_of_moving,
        said_of_singular,
    )
    from antenna_pin.analysis.closures import (
        closure_loads,
        closures_of,
        coupling_loads,
        couplings_of,
        drive_loads,
        drive_power,
        drives_of,
        effort_unit,
    )
    from antenna_pin.analysis.deviation import (
        Deviation,
        DeviationMeasures,
        deviation,
        deviation_measures,
        deviation_over_time,
    )
    from antenna_pin.analysis.diagrams import Verdict, diagram_verdicts, said_of_verdicts
    from antenna_pin.analysis.elastic import (
        SPIN_WITHIN,
        elastic_motion,
        elastic_parts_of,
        modal_energy,
        said_of_spin,
    )
    from antenna_pin.analysis.gears import gear_contacts, gear_impacts, gears_of
    from antenna_pin.analysis.growth import Growth, growth_of
    from antenna_pin.analysis.impacts import impact_statistics, impacts
    from antenna_pin.analysis.in_orbit import orbit_angles
    from antenna_pin.analysis.journal import bore_load, clearance_shapes, journal_motion
    from antenna_pin.analysis.limits import said_of_limits
    from antenna_pin.analysis.loads import load_statistics
    from antenna_pin.analysis.long_spectra import long_spectrogram, long_spectrum
    from antenna_pin.analysis.numbers import numbers_of
    from antenna_pin.analysis.orbit import Orbit
    from antenna_pin.analysis.phase import (
        Periods,
        PhasePortrait,
        open_portrait,
        phase_portrait,
        portrait_of,
        portrait_table,
    )
    from antenna_pin.analysis.piecewise import LONG, beside, blocks
    from antenna_pin.analysis.pointing import Antenna, Command, boresight, pointing_error, pointing_spec
    from antenna_pin.analysis.pointing_indices import INTERPRETATIONS, error_components, pointing_indices
    from antenna_pin.analysis.quantity import Quantity, QuantityName, quantities, quantity
    from antenna_pin.analysis.recurrence import Recurrence, RecurrenceKind, recurrence, section_lines
    from antenna_pin.analysis.round_off import (
        ROUND_OFF,
        ROUND_OFF_WORDS,
        is_round_off,
        round_off_scales,
    )
    from antenna_pin.analysis.sampled import resampled, time_mean, time_percentiles, time_rms
    from antenna_pin.analysis.scenarios import (
        SCENARIO_COLUMNS,
        JournalPose,
        ScenarioPair,
        TiltRange,
        possible_scenarios,
        scenario_of,
        scenario_rows,
    )
    from antenna_pin.analysis.settling import Settling, settling, touching_intervals
    from antenna_pin.analysis.shaken import base_loads, shaken_link, shakes_of
    from antenna_pin.analysis.shares import scenario_shares, scenario_spans
    from antenna_pin.analysis.shock import shock_spectrum
    from antenna_pin.analysis.signals import RunSignal, scales_of, signals
    from antenna_pin.analysis.slider_scenarios import slider_scenarios
    from antenna_pin.analysis.spectrum import (
        UniformSignal,
        dominant_frequencies,
        spectrogram,
        spectrum,
        uniform,
    )
    from antenna_pin.analysis.stops import latch_events, stop_impacts, stops_and_latches
    from antenna_pin.analysis.swept import following, swept_response
    from antenna_pin.analysis.targets import base_quantity, shaken_target
    from antenna_pin.analysis.transients import Settled, settled
    from antenna_pin.analysis.upright import STEADY, bearing_up, steady_up
    from antenna_pin.analysis.vibration import band_rms, power_density, transfer

__all__ = [
    "Verdict",
    "said_of_verdicts",
    "INTERPRETATIONS",
    "LONG",
    "SCENARIO_COLUMNS",
    "SPIN_WITHIN",
    "STEADY",
    "Answer",
    "Antenna",
    "Chaos",
    "ChaosTest",
    "Command",
    "Deviation",
    "DeviationMeasures",
    "Growth",
    "JournalPose",
    "Line",
    "Orbit",
    "Periods",
    "PhasePortrait",
    "Quantity",
    "QuantityName",
    "Recurrence",
    "RecurrenceKind",
    "RunSignal",
    "ScenarioPair",
    "Settled",
    "Settling",
    "StabilitySpan",
    "TiltRange",
    "UniformSignal",
    "answer",
    "base_loads",
    "base_motion",
    "base_quantity",
    "band_rms",
    "bearing_up",
    "beside",
    "between_samples",
    "blocks",
    "body_deviation",
    "body_motion",
    "body_poses",
    "body_twists",
    "bore_load",
    "boresight",
    "chaos_test",
    "clearance_shapes",
    "closure_loads",
    "closures_of",
    "coupling_loads",
    "couplings_of",
    "deviation",
    "diagram_verdicts",
    "deviation_measures",
    "deviation_over_time",
    "dominant_frequencies",
    "drive_loads",
    "drive_power",
    "drives_of",
    "effort_unit",
    "elastic_motion",
    "elastic_parts_of",
    "error_components",
    "following",
    "growth_of",
    "impact_statistics",
    "blow_statistics",
    "blows",
    "impacts",
    "interpolate_attitude",
    "interpolation_error",
    "joint_loads",
    "journal_motion",
    "latch_events",
    "load_statistics",
    "long_spectrogram",
    "long_spectrum",
    "mechanism_of",
    "modal_energy",
    "numbers_of",
    "moved_body",
    "open_portrait",
    "orbit_angles",
    "phase_portrait",
    "pointing_error",
    "pointing_indices",
    "pointing_spec",
    "portrait_of",
    "portrait_table",
    "power_density",
    "possible_scenarios",
    "quantities",
    "quantity",
    "recurrence",
    "ROUND_OFF",
    "ROUND_OFF_WORDS",
    "is_round_off",
    "round_off_scales",
    "resampled",
    "said_of_constraints",
    "said_of_coupling",
    "said_of_limits",
    "said_of_moving",
    "said_of_multiplier",
    "said_of_singular",
    "said_of_spin",
    "scales_of",
    "scenario_of",
    "scenario_rows",
    "shaken_link",
    "shaken_target",
    "shakes_of",
    "scenario_shares",
    "scenario_spans",
    "slider_scenarios",
    "section_lines",
    "settled",
    "settling",
    "shock_spectrum",
    "signals",
    "spectrogram",
    "spectrum",
    "stability_spans",
    "steady_up",
    "gear_contacts",
    "gear_impacts",
    "gears_of",
    "swept_response",
    "stop_impacts",
    "stops_and_latches",
    "time_mean",
    "time_percentiles",
    "time_rms",
    "transfer",
    "touching_intervals",
    "unexplained_changes",
    "uniform",
]

loaded_when_used(
    __name__,
    {
        "at_a_glance": "Answer Line answer",
        "attitude": "interpolate_attitude interpolation_error",
        "base": "base_motion",
        "between": "between_samples",
        "piecewise": "LONG beside blocks",
        "bodies": "body_poses body_twists joint_loads mechanism_of",
        "body": "body_deviation body_motion moved_body",
        "branch": "StabilitySpan said_of_multiplier stability_spans unexplained_changes",
        "chaos_test": "Chaos ChaosTest chaos_test",
        "closures": "closure_loads closures_of coupling_loads couplings_of drive_loads drive_power drives_of"
        " effort_unit",
        "closure_words": "said_of_constraints said_of_coupling said_of_moving said_of_singular",
        "diagrams": "Verdict diagram_verdicts said_of_verdicts",
        "deviation": "Deviation DeviationMeasures deviation deviation_measures deviation_over_time",
        "elastic": "SPIN_WITHIN elastic_motion elastic_parts_of modal_energy said_of_spin",
        "growth": "Growth growth_of",
        "blows": "blow_statistics blows",
        "impacts": "impact_statistics impacts",
        "journal": "bore_load clearance_shapes journal_motion",
        "limits": "said_of_limits",
        "loads": "load_statistics",
        "long_spectra": "long_spectrogram long_spectrum",
        "numbers": "numbers_of",
        "orbit": "Orbit",
        "in_orbit": "orbit_angles",
        "phase": "Periods PhasePortrait open_portrait phase_portrait portrait_of portrait_table",
        "pointing": "Antenna Command boresight pointing_error pointing_spec",
        "pointing_indices": "INTERPRETATIONS error_components pointing_indices",
        "quantity": "Quantity QuantityName quantities quantity",
        "recurrence": "Recurrence RecurrenceKind recurrence section_lines",
        "round_off": "ROUND_OFF ROUND_OFF_WORDS is_round_off round_off_scales",
        "sampled": "resampled time_mean time_percentiles time_rms",
        "scenarios": "SCENARIO_COLUMNS JournalPose ScenarioPair TiltRange"
        " possible_scenarios scenario_of scenario_rows",
        "settling": "Settling settling touching_intervals",
        "shaken": "base_loads shaken_link shakes_of",
        "shock": "shock_spectrum",
        "swept": "following swept_response",
        "targets": "base_quantity shaken_target",
        "vibration": "band_rms power_density transfer",
        "shares": "scenario_shares scenario_spans",
        "slider_scenarios": "slider_scenarios",
        "signals": "RunSignal scales_of signals",
        "spectrum": "UniformSignal dominant_frequencies spectrogram spectrum uniform",
        "transients": "Settled settled",
        "gears": "gear_contacts gear_impacts gears_of",
        "stops": "latch_events stop_impacts stops_and_latches",
        "upright": "STEADY bearing_up steady_up",
    },
)
