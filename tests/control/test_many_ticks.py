"""Many instants of a controller: the state is the closed form's, memory grows by the record alone."""

import resource
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from controlled_wheel import WHEEL, rig

from antenna_pin import RunSettings, simulate
from antenna_pin.elements.control import Controller

MANY, PERIOD = 150_000, 5e-4
TORQUE = 2.0**-4  # [N m], a power of two: what it gives is counted without round-off


@dataclass
class Square(Controller):
    """Pushes one way at even instants and the other way at odd ones; counts, and has a delay in its queue."""

    period: float = PERIOD
    delay_periods: float = 3.0
    commands: tuple[str, ...] = ("motor",)
    signals: tuple[str, ...] = ("rate",)
    state: Any = field(default_factory=lambda: {"asked": 0, "sum": 0})

    def update(self, now):
        self.state["asked"] += 1
        self.state["sum"] += now.tick
        now.note(rate=now.rate("joint"))
        return {"motor": TORQUE if now.tick % 2 == 0 else -TORQUE}


def largest():
    """Most memory that this process had [bytes]."""
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


@pytest.mark.slow
def test_many_instants():
    """The rate is the sum of the pushes, and one push or none; the way that of every other push."""
    square = Square()
    settings = RunSettings(output_rate=1.0)
    short = simulate(rig(), duration=0.5, controllers={"square": square}, settings=settings)
    assert short.data.ticks.values.tolist() == [1001]  # all is loaded, the labelled data too
    before = largest()
    run = simulate(rig(), duration=MANY * PERIOD, controllers={"square": square}, settings=settings)
    assert run.completed, run.message
    assert run.data.ticks.values.tolist() == [MANY + 1]
    (memory,) = run.end.controllers
    # The state that is left is that before the last instant, at which the run ends, or after it.
    assert memory.tick in (MANY, MANY + 1)
    assert len(memory.queue) <= 4
    times = run.data.tick_time.values
    assert np.all(np.abs(times - np.arange(MANY + 1) * PERIOD) <= np.spacing(times))
    # Up to three periods nothing is commanded; from there pushes go to and fro. Each lasts from instant to
    # instant as doubles have them, up to 1.4e-14 s off, which walks up to 1e-14 beside rates of 1e-5.
    pushes = TORQUE / WHEEL * np.where(np.arange(MANY) % 2 == 1, 1.0, -1.0)
    pushes[:3] = 0.0
    expected = np.concatenate([[0.0], np.cumsum(pushes * np.diff(times))])
    rates = run.data.tick_signal.sel(signal="square.rate").values
    pushed = TORQUE / WHEEL * PERIOD
    # Round-off of as many sums, each by half of the last digit at most.
    assert np.abs(rates - expected).max() < 0.5 * MANY * np.spacing(pushed)
    assert np.abs(expected[4::2] - pushed).max() < 1e-8 * pushed
    assert np.abs(expected[5::2]).max() < 1e-8 * pushed
    # A push of one period leaves a mean of half its rate from then on.
    way = 0.5 * pushed * PERIOD * (MANY - 3)
    assert float(run.data.motion_angle.values[-1, 0]) == pytest.approx(way, rel=1e-9)
    # Time, signal and command of each instant as doubles, and some copies of these on the way to the result:
    # far from what lists of Python's, or kept states, would take.
    assert largest() - before < 12 * 3 * 8 * MANY
