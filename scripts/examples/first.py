"""An own mechanism with play in a joint: run it, ask it, keep it."""

from antenna_pin import load_scenario, simulate

run = simulate(load_scenario("scripts/examples/panel/first.toml"))
blows = run.data["peak_force"]
print(f"{blows.size} contacts, the strongest of {blows.max().item():.1f} N")
print(f"angle of the hinge at the end: {run.data['motion_angle'][-1, 0].item():.4f} rad")
run.save("panel.nc")
