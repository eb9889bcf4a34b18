"""Where the antenna looks: the error of its boresight against the ideal joint's.

Turns about the antenna's own axes, and the angle between both boresights. Requirements are written for
these numbers.
"""

from antenna_pin import load_scenario, simulate

ideal = simulate(load_scenario("bai2020", case="case1"), duration=0.2)
play = simulate(load_scenario("bai2020", case="case3"), duration=0.2)
figure = play.plot("pointing", beside=ideal)
