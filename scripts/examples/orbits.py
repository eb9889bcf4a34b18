"""A pendulum that is driven at its hinge: its periodic motion, how neighbours come to it, over the torque."""

from antenna_pin import load_scenario
from antenna_pin.studies.nonlinear import Flow, continued, flow_of, largest_exponent, periodic_orbit

PERIOD = 1.6  # [s], that of the drive
DRIVE = f"{{joint = 'hinge', kind = 'sine', amplitude = '1 N*m', frequency = '{1.0 / PERIOD} Hz'}}"
ideal = load_scenario("pendulum", case="ideal", overrides=[f"drives.motor={DRIVE}"])

flow, start = flow_of(ideal)
orbit = periodic_orbit(flow, flow.after(start, 20 * PERIOD), PERIOD)
print(f"the ends of a period meet: {orbit.residual < 1e-9}; stable: {orbit.stable}")
print(f"largest multiplier {abs(orbit.multipliers[0]):.2e}, known to 1e-6: {orbit.doubt < 1e-6}")

exponent = largest_exponent(flow, orbit.start, PERIOD / 8, 160)
print(f"largest exponent {exponent.values[0]:.2f} 1/s: {exponent.verdict}")
print(f"of the multipliers {orbit.exponents.max():.2f} 1/s")


def at_torque(torque: float) -> tuple[Flow, float]:
    """Return the flow of the pendulum under another torque [N m], and its period [s]."""
    return flow_of(ideal.with_overrides({"drives.motor.amplitude": torque}))[0], PERIOD


branch = continued(at_torque, orbit.start, (1.0, 3.0), arc=0.5)
print(f"{len(branch.points)} orbits from 1 N m on: {branch.message}; {len(branch.bifurcations)} bifurcations")
