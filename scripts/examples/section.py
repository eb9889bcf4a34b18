"""A section of a driven pendulum: once a period of its drive, with the transient judged."""

from antenna_pin import load_scenario
from antenna_pin.studies.nonlinear import Stroboscope, poincare

DRIVE = "{joint = 'hinge', kind = 'sine', amplitude = '1 N*m', frequency = '0.625 Hz'}"
pendulum = load_scenario("pendulum", case="ideal", overrides=[f"drives.motor={DRIVE}"])
section = poincare(pendulum, Stroboscope(), ["motion_angle[hinge]", "motion_rate[hinge]"], count=40)
print(f"{section.sizes['point']} points, settled: {bool(section['settled'].item())}")
