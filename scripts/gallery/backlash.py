"""A gear with backlash in a pointing mechanism.

Flanks part and meet as the load changes its sense. Where they are apart the output is free.
"""

from antenna_pin import load_scenario, simulate

run = simulate(load_scenario("pointing_gear"), duration=4.0)
figure = run.plot("gears")
