"""A driven pendulum on its way to an orbit, in phase space.

From rest to a swing over the top of its hinge: rate over angle, coloured by time. The last periods lie on
one another.
"""

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import phase_portrait
from antenna_pin.show.plot import figure_phase

DRIVE = "{joint = 'hinge', kind = 'sine', amplitude = '12.5 N*m', frequency = '0.625 Hz'}"
run = simulate(load_scenario("pendulum", case="ideal", overrides=[f"drives.motor={DRIVE}"]), duration=16.0)
figure = figure_phase(phase_portrait(run, "motion_angle[hinge]", "motion_rate[hinge]"))
