"""What moves an impact: clearance, restitution and speed, through several blows."""

from antenna_pin import load_scenario
from antenna_pin.studies.sensitivity import sensitivities

pair = load_scenario("impact_pair", overrides={"clearance.bore.geometry": "closed-form"})
keys = ["clearance.bore.radial_clearance", "clearance.bore.normal.restitution"]
found = sensitivities(pair, keys, times=[2e-3, 15e-3])  # [s]

speed = found.derivative("v")[:, 0]  # of the base along x, (time, parameter)
print(f"per unit of restitution the base is {speed[1, 1]:.6f} m/s faster at 15 ms")
fourth = found.derivative("onset_time")[3]  # of the fourth blow, (parameter,)
print(f"0.01 mm more play: the fourth blow comes {1e-5 * fourth[0] * 1e3:.5f} ms later")
print(f"known to {found.doubt('onset_time')[3, 0] / fourth[0]:.0e}")
