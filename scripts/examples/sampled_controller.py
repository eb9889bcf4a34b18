"""A sampled controller of one's own, asked once a period; its integral is part of the run's state."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from antenna_pin import System, Urdf, build_mechanism, simulate
from antenna_pin.dynamics import ConstantDrive
from antenna_pin.elements.control import Controller

PERIOD, TARGET = 0.01, -0.5  # [s], [rad]


@dataclass
class Integrating(Controller):
    """Brings the hinge to its target."""

    period: float = PERIOD
    commands: tuple[str, ...] = ("motor",)
    signals: tuple[str, ...] = ("error",)
    state: dict[str, float] = field(default_factory=lambda: {"integral": 0.0})

    def update(self, now: Any) -> dict[str, float]:
        """Return the torque [N m] for the next period."""
        error = TARGET - now.angle("hinge")
        self.state["integral"] += error * PERIOD
        now.note(error=error)
        return {"motor": 5.0 * error + 1.0 * self.state["integral"] - 3.0 * now.rate("hinge")}


mechanism = build_mechanism(Urdf.load(Path(__file__).parent / "panel" / "panel.urdf"))
system = System(mechanism, drives={"motor": ConstantDrive(joint="hinge", value=0.0)})
run = simulate(system, duration=1.0, controllers={"loop": Integrating()})
print(f"after 1 s: {run.data['motion_angle'].values[-1, 0]:.9f} rad")
print(f"{run.summary()['controllers']['loop']['ticks']:.0f} instants, the last error of these:")
print(f"{run.data['tick_signal'].sel(signal='loop.error').values[-1]:.9f} rad")
