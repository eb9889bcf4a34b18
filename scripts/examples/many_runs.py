"""Many runs at once: the compiled engine runs without the interpreter's lock, so threads share the cores."""

from concurrent.futures import ThreadPoolExecutor

from antenna_pin import Trajectory, load_scenario, simulate

CHANGES = ["clearance.elevation.geometry=closed-form", "integrator.engine=compiled", "output.form=lean"]
case = load_scenario("bai2020", case="case3", overrides=CHANGES)


def run(friction: float) -> Trajectory:
    """Run 0.1 s of case 3 with a coefficient of static friction, and two thirds of it in fast slip."""
    law = "clearance.elevation.friction"
    changed = case.with_overrides({f"{law}.static": friction, f"{law}.dynamic": friction / 1.5})
    return simulate(changed, duration=0.1)


coefficients = [0.03, 0.09, 0.15]
with ThreadPoolExecutor() as pool:
    for friction, one in zip(coefficients, pool.map(run, coefficients), strict=True):
        print(f"friction {friction}: largest force {one.data['peak_force'].max():.1f} N")
