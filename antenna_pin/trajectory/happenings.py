"""The variables of a result that are of the whole run: contacts, changes of mode, instants, events."""

from __future__ import annotations

from antenna_pin.trajectory.columns import Rule, Variable, rows

__all__ = ["HAPPENINGS", "LOST", "ORDERED", "SIZE", "TOTAL"]

SIZE = Rule(least=0.0)
ORDERED = Rule(rising=True)
TOTAL = Rule(least=0.0, summed=True)
# Of contacts; none of them is sure to lose energy under a law of a user's.
LOST = Rule(least=0.0, summed=True, passive=True)

_OF_TOUCH = "largest effort (N) of the touch that ends, or lasts to the end; NaN: none"

HAPPENINGS: tuple[Variable, ...] = (
    *rows(
        "episodes: episode",
        ("onset_time", "s", "start of the contact", ORDERED),
        ("release_time", "s", "end of the contact; NaN: still touching", Rule(lacks=True)),
        ("approach_speed", "m/s", "depth rate at onset, floored", SIZE),
        ("peak_force", "N", "largest normal force, of the dense output", SIZE),
        ("peak_time", "s", "when the force was largest"),
        ("peak_depth", "m", "largest depth, of the dense output", SIZE),
        ("impulse", "N s", "integral of the normal force", TOTAL),
        ("dissipated", "J", "energy lost, normal and friction", LOST),
        ("effective_mass", "kg", "(n^T M^-1 n)^-1 at onset, along the normal", SIZE),
        ("episode_contact", "1", "index of the contact"),
    ),
    *rows(
        "episodes: change",
        ("change_time", "s", "when the mode changed", ORDERED),
        ("change_angle", "rad", "angle of the joint then (a way [m])"),
        ("change_rate", "rad/s", "rate before (m/s)"),
        ("change_rate_after", "rad/s", "rate after (m/s)"),
        ("change_loss", "J", "energy lost in the impulse"),
        ("change_impulse", "N m s", "impulse about the axis on the child (N s)"),
        ("change_energy", "J", "energy of a latch's joint, 1/2 I_r rate^2; NaN: no latch", Rule(lacks=True)),
        ("change_peak_effort", "N m", _OF_TOUCH, Rule(least=0.0, lacks=True)),
        ("change_peak_time", "s", "when that effort was", Rule(lacks=True)),
    ),
    *rows(
        "episodes: tick",
        ("tick_time", "s", "when the controller was asked", ORDERED),
        ("tick_controller", "1", "index of the controller among the sampled ones", SIZE),
    ),
    *rows(
        "episodes: tick signal",
        ("tick_signal", "1", "what it noted, or commanded, in SI units", Rule(lacks=True)),
    ),
    *rows(
        "episodes: event",
        ("event_time", "s", "when the event happened", ORDERED),
        ("event_energy", "J", "energy that the event's action brought in"),
    ),
)
