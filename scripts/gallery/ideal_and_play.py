"""A joint's acceleration, ideal and with play.

Bai and Zhao's antenna, its elevation driven by a motor: the ideal joint follows the motor, the one with 0.2
mm of play is driven by blows. This is the figure by which papers compare clearance models.
"""

from antenna_pin import load_scenario, simulate

ideal = simulate(load_scenario("bai2020", case="case1"), duration=0.2)
play = simulate(load_scenario("bai2020", case="case3"), duration=0.2)
figure = play.plot("motion_acceleration", beside=ideal, joint="elevation")
