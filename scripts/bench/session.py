#!/usr/bin/env python3
"""Cost of a session's step, for the antenna on ideal joints: 10 microseconds, two steps of the integrator.

Their integration is some 0.05 ms of it. Beside it stands what such a step costs that is commanded each time,
and as a run of its own from the state before.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np
from bench_tools import Report, scenario

from antenna_pin import simulate
from antenna_pin.run.session import start

STEP = 1e-5  # [s]
MOTOR = "drives.elevation={kind='constant', value=0.5, replace=true}"


def spent(does: Callable[[int], object], times: int) -> float:
    """Return the processor time that something takes at its quickest of five rounds [ms]."""
    rounds = []
    for _ in range(5):
        began = time.process_time()
        for k in range(times):
            does(k)
        rounds.append((time.process_time() - began) / times * 1e3)
    return float(np.min(rounds))


def main() -> int:
    """Take the times."""
    report = Report("session", __doc__ or "")
    arguments = report.parse()
    times = 50 if arguments.quick else 500
    antenna = scenario("case1", MOTOR, "integrator.engine=compiled")
    told, commanded = start(antenna, record=False), start(antenna, record=False)
    for session in (told, commanded):
        session.step(0.05)

    def command(k: int) -> None:
        commanded.command["elevation"] = 0.5 + 1e-3 * (k % 2)
        commanded.step(STEP)

    step = spent(lambda k: told.step(STEP), times)
    report.add("step that is told", step, "ms", 0.5)
    report.add("with a command, to without", spent(command, times) / step, "-", 3.0)
    system = told.system
    state = told.state
    own = spent(lambda k: simulate(system, duration=STEP, start=state), max(times // 25, 4))
    report.add("step that is told, to a run of its own", step / own, "-", 0.1)
    report.add("reading an angle", spent(lambda k: told["elevation.angle"], times), "ms", 0.02)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
