"""A normal law, a friction law and a drive of one's own, compiled by Numba: as fast as the built-in ones."""

import math
from dataclasses import replace
from pathlib import Path

from numba import njit

from antenna_pin import RunSettings, System, build_system, load_scenario, simulate
from antenna_pin.contact import CustomFriction, CustomNormal
from antenna_pin.dynamics import CallableDrive

STIFFNESS, DAMPING = 2e7, 0.3  # [N/m], [-]

normal = CustomNormal(
    # Depth [m], rate [m/s] and approach speed [m/s] give the force [N]; called in contact only.
    force=njit(lambda depth, rate, approach: STIFFNESS * depth * (1.0 + DAMPING * rate / approach)),
    # What of it comes back, and the energy stored [J]: the rest is the ledger's dissipation.
    elastic_force=njit(lambda depth: STIFFNESS * depth),
    elastic_energy=njit(lambda depth: 0.5 * STIFFNESS * depth**2),
)
friction = CustomFriction(coefficient=njit(lambda speed: 0.1 * speed / math.hypot(speed, 1e-3)))


@njit
def controller(t: float, angle: float, rate: float) -> float:
    """Return the motor's torque [N m] at time t [s], joint angle [rad] and rate [rad/s]."""
    target = -0.5 * (1.0 - math.exp(-t / 0.05))
    return 8.0 * (target - angle) - 1.0 * rate


panel = build_system(load_scenario(Path(__file__).parent / "panel" / "first.toml"))
hinge = replace(panel.clearances[0], radial=normal, axial=normal, friction=friction, backend="closed-form")
drives = {"motor": CallableDrive(joint="hinge", torque=controller)}
system = System(panel.mechanism, clearances=[hinge], drives=drives)
run = simulate(system, duration=0.1, settings=RunSettings(engine="compiled"))

print(run.outcome.name)
print("angle at the end [rad]:", run.data["motion_angle"].sel(joint="hinge")[-1].item())
print("energy ledger, relative:", run.summary()["conservation"]["energy_error_relative"])
