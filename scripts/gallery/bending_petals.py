"""Petals of a dish that bend, by their modes.

Blows in the elevation joint set the petals of the antenna swinging: how far their tips go, against the
rigid shape.
"""

from antenna_pin import load_scenario, simulate

run = simulate(load_scenario("bai2020", case="flexible"), duration=0.2)
figure = run.plot("deflection")
