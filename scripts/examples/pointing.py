"""Pointing error of the antenna, and the indices of any signal."""

import numpy as np

from antenna_pin import Trajectory
from antenna_pin.analysis import Orbit, boresight, error_components, pointing_error, pointing_indices

run, ideal = Trajectory.load("case3.nc"), Trajectory.load("case1.nc")

looks = boresight(run, orbit=Orbit(rate=0.0011, normal=(0, 1, 0), nadir=(0, 0, -1)))
for name in ("elevation", "orbit_elevation"):
    print(f"{name}: {1e3 * looks[name].values[-1]:.3f} mrad at the end")

errors = pointing_error(run, ideal)
cross = errors["error"].sel(pointing_axis="cross").values
print(f"largest error about the cross axis: {1e6 * np.abs(cross).max():.1f} µrad")

indices = pointing_indices(errors["time"], error_components(errors), window=0.02, confidence=0.95)
print((1e6 * indices["extreme"]).to_pandas().round(1))

# Any signal will do: here a drift of 2 and a sine of 0.5, two of whose periods a window holds.
time = np.linspace(0.0, 10.0, 10001)
signal = 2.0 * time / time[-1] + 0.5 * np.sin(2.0 * np.pi * 4.0 * time)
found = pointing_indices(time, signal, window=0.5, drift_spacing=1.0, periods=5.0, confidence=0.9)
for kind in found["index"].values:
    one = found.sel(index=kind, component="error")
    level = one["level"].sel(interpretation="temporal").item()
    print(f"{kind}: largest {one['extreme'].item():.4f}, 90 % level {level:.3f}")
