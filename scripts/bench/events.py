#!/usr/bin/env python3
"""How the time of a run grows with events that a step passes: 60 to 500 of them, marks and changes.

A wheel turns up evenly and passes angles a hundredth of a milliradian apart, all in a few steps. Marks change
nothing: they are found together, and the time should grow as their number. After one that sets a number all
others have to be looked for anew, and it grows as the square, of a small time.
"""

from __future__ import annotations

import math
import time

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.dynamics import ConstantDrive
from antenna_pin.simulation import Angle, Event, Mark, Set

COUNTS = (60, 125, 250, 500)
URDF = """<robot name="rig"><link name="ground"/><link name="body"><inertial><mass value="1"/>
<inertia ixx="2" iyy="2" izz="2" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="joint" type="continuous"><parent link="ground"/><child link="body"/><axis xyz="0 0 1"/></joint>
</robot>"""


def seconds(count: int, engine: str, changing: bool) -> float:
    """Return what a run with so many events takes [s]."""
    mechanism = build_mechanism(Urdf.from_text(URDF, "rig.urdf"), base="fixed")
    system = System(mechanism, drives={"motor": ConstantDrive(joint="joint", value=3.0)})
    events = [
        Event(
            name=f"e{k}",
            when=Angle("joint", 1.0 + 1e-5 * k),
            action=Set("drives.motor.value", 3.0 + 1e-6 * k) if changing else Mark(),
        )
        for k in range(count)
    ]
    settings = RunSettings(engine="compiled" if engine == "compiled" else "pinocchio", max_step=1.0)
    began = time.perf_counter()
    run = simulate(system, duration=2.0, events=events, settings=settings)
    assert len(run.data["event"]) == count
    return time.perf_counter() - began


def main() -> None:
    """Print a table, and how the time grows between the last two."""
    print("events      " + "".join(f"{count:>10}" for count in COUNTS) + "   exponent")
    for engine in ("pinocchio", "compiled"):
        for changing in (False, True):
            seconds(COUNTS[0], engine, changing)
            took = [seconds(count, engine, changing) for count in COUNTS]
            grows = math.log(took[-1] / took[-2]) / math.log(COUNTS[-1] / COUNTS[-2])
            name = f"{engine[:9]} {'sets' if changing else 'marks'}"
            print(f"{name:16}" + "".join(f"{one:8.2f} s" for one in took) + f"{grows:9.1f}")


if __name__ == "__main__":
    main()
