"""Run a shipped study in this process, shortened, and look at its dataset."""

from antenna_pin import load_study, open_study, run_study

study = load_study(
    "bai2020/clearances", ["set.duration=0.1 s", 'parameters.axial.values=["0.2 mm", "0.4 mm"]']
)
run_study(study, "short.study")  # on all cores: executor=antenna_pin.studies.sweep.Cluster()
table = open_study("short.study")  # while it runs, or later: an xarray.Dataset
for radial, force in table["peak_force"].sel(axial=0.0002).to_series().items():
    print(f"radial clearance {1e3 * radial:.2f} mm: largest force {force:.0f} N")
