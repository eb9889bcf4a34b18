"""A loop of one's own around a run: read, command, step; branch off; one trajectory at the end."""

from pathlib import Path

from antenna_pin import System, Urdf, build_mechanism, simulate
from antenna_pin.dynamics import ConstantDrive
from antenna_pin.run.session import start
from antenna_pin.run.simulation import Rate

PERIOD, TARGET = 0.01, -0.5  # [s], [rad]

mechanism = build_mechanism(Urdf.load(Path(__file__).parent / "panel" / "panel.urdf"))
system = System(mechanism, drives={"motor": ConstantDrive(joint="hinge", value=0.0)})
session, integral = start(system), 0.0
for k in range(100):
    error = TARGET - session["hinge.angle"]
    integral += error * PERIOD
    session.command["motor"] = 5.0 * error + 1.0 * integral - 3.0 * session["hinge.rate"]
    session.run_until((k + 1) * PERIOD)
print(session)

# What if the motor failed here? A branch of its own goes on to where the hinge turns back, if it does.
branch = session.copy()
branch.off("drives.motor")
print(f"turns back within 2 s: {branch.run_until(Rate('hinge'), timeout='2 s')}")

# The session has gone no further. Its trajectory is that of one run with the same commands, bit for bit.
run = session.trajectory()
same = simulate(system, duration=run.end.reached, events=session.events)
difference = abs(run.data["q"] - same.data["q"]).max().item()
print(f"{len(session.events)} commands; largest difference of q to one run with them: {difference}")
