"""Find a hinge's play, stiffness, restitution and friction from a record, and use them."""

from pathlib import Path

from antenna_pin import load_fit, run_fit

fit = run_fit(load_fit(Path(__file__).with_name("hinge.fit.toml")))
play = fit.scenario().clearance["hinge"].radial_play  # of the scenario with the values found
print(f"{fit.runs} runs; play {play:.6f} m")
