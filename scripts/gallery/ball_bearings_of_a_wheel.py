"""A reaction wheel on ball bearings, out of balance.

What the satellite feels of a wheel whose mass is not quite where its axis is, over the frequency.
"""

from antenna_pin import load_scenario, simulate

run = simulate(load_scenario("reaction_wheel"))
figure = run.plot("spectra")
