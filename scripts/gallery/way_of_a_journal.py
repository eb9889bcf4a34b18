"""The way of a journal in its bearing.

Both ends of the antenna's elevation journal in their bores: the circle is the play. The journal tilts in
it, so that its ends come to rest on opposite sides.
"""

from antenna_pin import load_scenario, simulate

run = simulate(load_scenario("bai2020", case="case3"), duration=0.2)
figure = run.plot("journal_orbit")
