"""Read a result: every variable has dimensions, a unit and a long name."""

import numpy as np

from antenna_pin import Trajectory

run = Trajectory.load("case3.nc")
print(run.outcome.name, run.counts.accepted, "steps")

force = run.data["normal_force"]  # sampled
print(force.attrs["long_name"], force.attrs["units"], force.dims, force.shape)

hardest = run.data.isel(episode=int(np.argmax(run.data["peak_force"].values)))  # of the dense output
contact = str(run.data["contact"].values[int(hardest["episode_contact"])])
print(contact, f"{hardest['peak_force'].item():.1f} N at t = {1e3 * hardest['peak_time'].item():.3f} ms")
