"""Run a shipped scenario and look at the result."""

from antenna_pin import load_scenario, simulate

run = simulate(load_scenario("bai2020", case="case3"), duration=0.2)
run.save("case3.nc")
print(run.data["motion_angle"].sel(joint="elevation")[-1].item())  # [rad]
