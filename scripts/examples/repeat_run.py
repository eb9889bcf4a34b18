"""A result file is enough to repeat its run."""

import numpy as np

from antenna_pin import Trajectory, simulate

before = Trajectory.load("case3.nc")
again = simulate(before.scenario, duration=0.2)
print(np.abs(again.data["q"].values - before.data["q"].values).max())
