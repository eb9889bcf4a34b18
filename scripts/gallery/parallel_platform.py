"""A parallel platform with play in a ball joint.

Chen and Cui's 4UPS-UPU mechanism, five closed loops, a ball joint of one leg with play: the ball's way in
its socket.
"""

from antenna_pin import load_scenario, simulate

run = simulate(load_scenario("chen2021"), duration=0.05)
figure = run.plot("eccentricity")
