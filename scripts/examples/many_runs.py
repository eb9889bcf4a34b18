"""Many runs at once: the compiled engine runs without the interpreter's lock, so threads share the cores."""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from antenna_pin import Trajectory, load_scenario, simulate

CHANGES = ["clearance.elevation.geometry=closed-form", "integrator.engine=compiled", "output.form=lean"]
case = load_scenario("bai2020", case="case3", overrides=CHANGES)


def run(friction: float) -> Trajectory:
    """Run 0.1 s of case 3 with a coefficient of static friction, and two thirds of it in fast slip."""
    law = "clearance.elevation.friction"
    changed = case.with_overrides({f"{law}.static": friction, f"{law}.dynamic": friction / 1.5})
    return simulate(changed, duration=0.1)


coefficients = np.linspace(0.03, 0.15, 5)
with ThreadPoolExecutor(os.cpu_count()) as pool:
    runs = list(pool.map(run, coefficients.tolist()))
for friction, one in zip(coefficients, runs, strict=True):
    lost = 1e3 * sum(one.data[f"total_{of}_loss"].sum().item() for of in ("normal", "friction"))
    print(
        f"friction {friction:5.3f}: largest force {one.data['peak_force'].max():6.1f} N, lost {lost:.3f} mJ"
    )
