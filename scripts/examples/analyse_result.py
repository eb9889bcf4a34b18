"""What a run shows, in Python: deviation, impacts, load, settling, frequencies."""

from antenna_pin import Trajectory
from antenna_pin.analysis import (
    deviation,
    dominant_frequencies,
    impacts,
    load_statistics,
    settling,
    signals,
)

play, ideal = Trajectory.load("case3.nc"), Trajectory.load("case1.nc")

angle = deviation(play, ideal)["elevation angle"]
print(f"angle: at most {1e6 * angle.maximum:.1f} urad off, rms {1e6 * angle.rms:.1f} urad, {angle.growth}")

table = impacts(play)  # an xarray Dataset, one row per contact episode
ended = table.isel(impact=table["ended"].values)
print(f"{ended.sizes['impact']} impacts, restitution {float(ended['restitution'].median()):.3f}")

loads = load_statistics(play)
print(f"peak {float(loads['peak_force'].max()):.0f} N, contact {float(loads['joint_contact_share'][0]):.1%}")

(joint,) = settling(play, longest_gap=1e-3)
print(joint.joint, "settled at", joint.time, joint.note)

one = signals(ideal)["elevation acceleration"]
peaks = dominant_frequencies(one.time, one.values, count=1)
print(f"{peaks['frequency'][0]:.3f} Hz, {peaks['amplitude'][0]:.2f} {one.units}")
