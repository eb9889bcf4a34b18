"""A run that is shown where something changes, with its steps up to there."""

import numpy as np
import pytest

from antenna_pin import RunSettings
from antenna_pin.run.simulation import Angle, Event
from antenna_pin.run.simulation import steps as stepping
from antenna_pin.run.simulation.loop import Run
from antenna_pin.scenario.assemble import build_system, initial_state
from tests.simulation.test_events import EXACT, oscillator, with_events


class Seen:
    """Looks at a run: contacts that changed, events that happened and steps, since the last look."""

    def __init__(self, run):
        self.changes, self.events, self.steps, self.ends = [], [], [], []
        self._passages = run.actions.effects = []
        self._touched = run.workspace.memory["touching"].copy()

    def observe(self, run):
        touching = run.workspace.memory["touching"]
        self.changes.append(int(np.count_nonzero(touching != self._touched)))
        self.events.append([one.time for one in self._passages])
        self.steps.append(list(run.steps.log))
        self.ends.append((run.stepper.t, run.here.copy()))
        self._touched = touching.copy()
        self._passages.clear()

    end = observe


def shown(system, y, span, events=()):
    """The run as it is shown, and what was seen."""
    run = Run(system, y, span, RunSettings(output_rate=100.0), events, logged=True)
    seen = Seen(run)
    run.advance(observer=seen)
    return run, seen


@pytest.mark.parametrize("most", [stepping._LOGGED, 3])
def test_a_taped_run_is_the_run(monkeypatch, most):
    """To the last bit; steps go from where the last ended, and nothing changes but where one ends."""
    monkeypatch.setattr(stepping, "_LOGGED", most)
    asked, events = with_events()
    system = build_system(asked)
    y = system.state(*initial_state(asked, system))
    whole = Run(system, y, 0.06, RunSettings(output_rate=100.0), events)
    whole.advance()
    run, seen = shown(system, y, 0.06, events)
    assert run.state == whole.state and run.actions.happened == whole.actions.happened
    assert sum(map(len, seen.steps)) == whole.steps.accepted and max(map(len, seen.steps)) > 1
    onsets, releases = (run.episodes[name] for name in ("onset", "release"))
    assert sum(seen.changes) == np.count_nonzero(onsets > 0.0) + np.count_nonzero(releases <= 0.06)
    assert max(seen.changes) == 1
    jumped = 0
    time, state = 0.0, y
    for steps, happened, (end, there) in zip(seen.steps, seen.events, seen.ends, strict=True):
        for one in steps:
            assert one.time == time and np.array_equal(one.y, state)
            # The end is told by the sum, but where a step is to end at an instant, to round-off of that.
            assert one.until == pytest.approx(one.time + one.size, rel=1e-15)
            time, state = one.until, one.end
        assert time == end and set(happened) <= {one.until for one in steps} | {end}
        if not np.array_equal(state, there):
            jumped += 1
            assert end in (0.01, 0.025, 0.05)  # where an event strikes the shaft: the step ends before that
        state = there
    assert jumped == 3


def test_each_instant_of_several_in_a_step_ends_one():
    """Four angles that a trial step of 10 ms passes change nothing: they are found with the first."""
    events = [Event(name=f"{k}", when=Angle("joint", 0.05 - 1e-4 * k)) for k in range(4)]
    system = oscillator()
    _, seen = shown(system, system.state(np.array([0.1]), np.zeros(1)), 1.0, events)
    (look,) = [k for k, one in enumerate(seen.events) if one]
    assert [one.until for one in seen.steps[look][-4:]] == seen.events[look]
    # Of an angle 0.1 cos(2 t).
    expected = 0.5 * np.arccos(0.5 - 1e-3 * np.arange(4))
    assert np.abs(np.array(seen.events[look]) - expected).max() < EXACT
