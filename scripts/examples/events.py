"""Events: mark a moment, change a drive, stop the run."""

import math
from pathlib import Path

from antenna_pin import load_scenario, simulate
from antenna_pin.run.simulation import Angle, Event, Moment, Rate, Set, Stop

panel = load_scenario(
    Path(__file__).parent / "panel",
    case="ideal",
    overrides=["drives.motor={joint='hinge', kind='constant', value='-50 N*mm'}"],
)


def tip_speed(moment: Moment) -> float:
    """Return the speed of a point 0.6 m from the hinge, less 0.5 m/s."""
    return 0.6 * abs(moment.rate("hinge")) - 0.5


off = Set("drives.motor.on", False)
run = simulate(
    panel,
    duration=10.0,
    events=[
        Event(name="fast", when=tip_speed),
        Event(name="motor off", when=Angle("hinge", -math.pi / 6), direction=-1, action=off),
        Event(name="back", when=Rate("hinge"), direction=1, action=Stop()),
    ],
)

print(run.message)
for name, time in zip(run.data["event"].values, run.data["event_time"].values, strict=True):
    print(f"{name:10}{time:.9f} s")
