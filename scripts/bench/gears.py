#!/usr/bin/env python3
"""A gear that rattles in its play on a free base, for as many changes of its flanks as are asked for.

Two discs on one axis of a body that floats, a gear with play between them, no loss: it goes free over the
play, half a swing in mesh, and back, for ever. Known in closed form are the instants of all touches, the rate
at which it crosses its play, which must not creep, and momentum and energy, which stay. Three changes make a
touch: a flank comes on, turns back, comes off. They are made in parts, each of which begins with the state
that the one before has left. What errors become is told as it goes: a touch adds 1e-11 of the rate at this
tolerance. A million takes half an hour.
"""

from __future__ import annotations

import math
import sys
import time

import numpy as np
from bench_tools import Report

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.elements import Gear

BASE, INPUT, OUTPUT = 0.5, 0.01, 0.04  # moments of inertia about the axis [kg m^2]
RATIO, PLAY, STIFFNESS = -3.0, 0.02, 50.0
START = (0.6, -0.1)  # rates of input and output [rad/s]
PARTS = 10

_LINK = (
    '<link name="{0}"><inertial><mass value="1"/>'
    '<inertia ixx="{1}" iyy="{1}" izz="{1}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
_JOINT = (
    '<joint name="{0}" type="continuous"><parent link="base"/><child link="{0}_link"/>'
    '<axis xyz="0 0 1"/></joint>'
)


def _discs() -> System:
    text = _LINK.format("base", BASE) + _JOINT.format("a") + _JOINT.format("b")
    text += _LINK.format("a_link", INPUT) + _LINK.format("b_link", OUTPUT)
    urdf = Urdf.from_text(f'<robot name="discs">{text}</robot>', "discs.urdf")
    gear = Gear(input="a", output="b", ratio=RATIO, stiffness=STIFFNESS, play=PLAY)
    return System(build_mechanism(urdf, "free", (0, 0, 0)), elements={"gears": {"mesh": gear}})


def _closed_form() -> tuple[float, float]:
    """Return the rate across the play [rad/s], and the time from touch to touch [s]."""
    mass = np.diag([BASE + INPUT + OUTPUT, INPUT, OUTPUT])
    mass[0, 1] = mass[1, 0] = INPUT
    mass[0, 2] = mass[2, 0] = OUTPUT
    slopes = np.array([0.0, 1.0 / RATIO, -1.0])
    omega = math.sqrt(STIFFNESS * slopes @ np.linalg.solve(mass, slopes))
    speed = abs(START[0] / RATIO - START[1])
    return speed, math.pi / omega + PLAY / speed


def main() -> int:
    """Run it and tell."""
    report = Report("gears", __doc__.split("\n")[0])
    report.parser.add_argument("--changes", type=int, default=20_000, help="of flanks [%(default)s]")
    asked = report.parse()
    wanted = 1000 if asked.quick else asked.changes
    speed, period = _closed_form()
    system, parts = _discs(), min(PARTS, max(1, wanted // 1000))
    # A part ends where it crosses the middle of its play.
    touches = math.ceil(wanted / 3 / parts)
    settings = RunSettings(rtol=1e-12, max_step=10.0, output_rate=0.01, engine="compiled")
    start, scale, spin = None, 0.0, 0.0
    changes, late, creep, off, energy = 0, 0.0, 0.0, 0.0, 0.0
    began = time.perf_counter()
    for k in range(parts):
        begun = {"v": np.array([*[0.0] * 6, *START])} if start is None else {"start": start}
        run = simulate(system, duration=touches * period, settings=settings, **begun)
        names = np.array(run.data.change.values, dtype=str)
        on, back = (np.char.endswith(names, what) for what in (": on", ": off"))
        times, rates = run.data.change_time.values, run.data.change_rate.values
        expected = 0.5 * PLAY / speed + period * np.arange(k * touches, (k + 1) * touches)
        if len(times[on]) != touches:
            raise SystemExit(f"part {k + 1} has {len(times[on])} touches, of {touches}")
        momentum = run.data.angular_momentum.values
        if start is None:
            scale, spin = float(run.data.kinetic_energy[0]), float(momentum[0, 2])
        late = max(late, float(np.abs(times[on] - expected).max()))
        creep = max(creep, float(np.abs(np.abs(rates[back]) - speed).max()) / speed)
        off = max(off, float(np.abs(momentum - [0.0, 0.0, spin]).max()))
        stored = run.data.kinetic_energy.values + run.data.element_energy.values.sum(axis=1)
        energy = max(energy, float(np.abs(stored - scale).max()) / scale)
        start, changes = run.end, changes + len(names)
        wall = time.perf_counter() - began
        print(
            f"{changes} changes in {wall:.0f} s: touches off by {late:.1e} s, rate by {creep:.1e}, "
            f"angular momentum by {off:.1e} N m s, energy by {energy:.1e}",
            flush=True,
        )
    report.add("changes of flanks", changes)
    report.add("wall time a change", 1e3 * (time.perf_counter() - began) / changes, "ms")
    report.add("touches, from the closed form", late, "s")
    report.add("rate across the play, creep", creep, "-", 1e-5)
    report.add("angular momentum, drift", off, "N m s", 1e-9)
    report.add("energy, drift over that at the start", energy, "-", 1e-6)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
