"""A sampled controller with an integral: a run for each of its periods, from the end of the one before."""

from pathlib import Path

from antenna_pin import System, Urdf, build_mechanism, simulate
from antenna_pin.dynamics import CallableDrive, ConstantDrive

PERIOD, TARGET = 0.01, -0.5  # [s], [rad]


class Controller:
    """A PID controller that is asked once a period."""

    def __init__(self) -> None:
        """Begin with an integral of zero."""
        self.integral = 0.0

    def __call__(self, t: float, angle: float, rate: float) -> float:
        """Return the torque [N m] for the next period."""
        self.integral += (TARGET - angle) * PERIOD
        return 5.0 * (TARGET - angle) + 1.0 * self.integral - 3.0 * rate


mechanism = build_mechanism(Urdf.load(Path(__file__).parent / "panel" / "panel.urdf"))

# Wrong: a run asks a drive at every stage of every step, and back in time.
wrong = System(mechanism, drives={"motor": CallableDrive(joint="hinge", torque=Controller())})
print(simulate(wrong, duration=1.0).outcome.name)

# Right: pieces of runs.
controller, state, angle, rate = Controller(), None, 0.0, 0.0
for k in range(100):
    drive = ConstantDrive(joint="hinge", value=controller(k * PERIOD, angle, rate))
    system = System(mechanism, drives={"motor": drive})
    run = simulate(system, duration=PERIOD, start=state)
    state = run.end
    angle, rate = (float(run.data[name][-1, 0]) for name in ("motion_angle", "motion_rate"))
print(f"after 1 s: {angle:.9f} rad")
