"""Events by the hundred in one step: each as if it were alone, and none asks for more than its share."""

import math
import random

import numpy as np
import pytest
from wheel import wheel_urdf

from antenna_pin import RunSettings, System, build_mechanism, load_scenario, simulate
from antenna_pin.dynamics import ConstantDrive
from antenna_pin.run.simulation import Angle, Event, Gap, Set

EXACT = 1e-12  # [s]: round-off of the angle over the rate
LONG = {"max_step": 1.0, "output_rate": 1.0}


def wheel():
    """Its angle is 0.75 t^2; a step is as long as its turning lets it be."""
    urdf = wheel_urdf(inertia=2.0, joint="joint")
    drives = {"motor": ConstantDrive(joint="joint", value=3.0)}
    return System(build_mechanism(urdf, base="fixed", gravity=(0.0, 0.0, 0.0)), drives=drives)


class Counted:
    """How far a joint is past an angle; counts how often it is asked."""

    def __init__(self, value):
        self.value, self.asked = value, 0

    def __call__(self, moment):
        self.asked += 1
        return moment.angle("joint") - self.value


def happenings(run):
    return run.data["event"].values.tolist(), run.data["event_time"].values


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
def test_each_happens_when_it_would_alone_and_all_in_order(engine):
    """Some have a rate, some have not; one in ten is at the place of another."""
    values = [1.0 + 0.01 * (k - k % 10 // 9) for k in range(100)]
    events = [
        Event(name=f"e{k}", when=Angle("joint", a) if k % 2 else Counted(a)) for k, a in enumerate(values)
    ]
    random.Random(1).shuffle(events)
    run = simulate(wheel(), duration=2.0, events=events, settings=RunSettings(engine=engine, **LONG))
    names, times = happenings(run)
    assert sorted(names) == sorted(event.name for event in events)
    expected = [math.sqrt(values[int(name[1:])] / 0.75) for name in names]
    np.testing.assert_allclose(times, expected, rtol=0.0, atol=EXACT)
    assert (np.diff(times) >= 0.0).all() and run.counts.accepted < 200


def test_a_function_is_asked_as_often_among_many_as_among_few():
    """Else the time of n events in a step would grow as n squared."""
    asked = []
    for count in (10, 160):
        functions = [Counted(1.0 + k / count) for k in range(count)]
        events = [Event(name=f"e{k}", when=f) for k, f in enumerate(functions)]
        run = simulate(wheel(), duration=2.0, events=events, settings=RunSettings(**LONG))
        assert len(run.data["event"]) == count
        asked.append(max(function.asked for function in functions) - run.counts.accepted)
    assert asked[1] < 2 * asked[0]


def test_what_one_of_them_changes_changes_the_times_of_those_after_it():
    """The motor is off from 1.5 rad on: then the wheel turns evenly. One passes many times."""
    events = [Event(name=f"e{k}", when=Angle("joint", 1.0 + 0.01 * k)) for k in range(100)]
    events += [
        Event(name="off", when=Angle("joint", 1.495), action=Set("drives.motor.on", False)),
        Event(name="waves", when=lambda moment: math.sin(20.0 * math.pi * moment.angle("joint")), nodes=64),
    ]
    run = simulate(wheel(), duration=2.0, events=events, settings=RunSettings(**LONG))
    names, times = happenings(run)
    off = math.sqrt(1.495 / 0.75)

    def when(angle):
        return math.sqrt(angle / 0.75) if angle <= 1.495 else off + (angle - 1.495) / (1.5 * off)

    for k in range(100):
        assert times[names.index(f"e{k}")] == pytest.approx(when(1.0 + 0.01 * k), rel=0.0, abs=EXACT)
    waves = times[np.array(names) == "waves"]
    first = round(float(0.75 * waves[0] ** 2) / 0.05)
    passed = [when(0.05 * k) for k in range(first, first + len(waves))]
    np.testing.assert_allclose(waves, passed, rtol=0.0, atol=1e-11)
    assert 0.05 * first < 0.2 and len(waves) > 30


def test_contacts_change_between_events_of_one_step():
    """Passages of the gap before and in the contact: each alone comes at the same time."""
    pair = load_scenario("impact_pair")
    contact = simulate(pair).data["contact"].values[0]
    places = [1e-6 * (7 - k) for k in range(12)]
    events = [Event(name=f"e{k}", when=Gap(contact, a), direction=-1) for k, a in enumerate(places)]
    run = simulate(pair, events=events)
    names, times = happenings(run)
    onset = run.data["onset_time"].values[0]
    np.testing.assert_allclose(onset, simulate(pair).data["onset_time"].values[0], rtol=1e-9)
    for k in range(0, 12, 3):
        _, alone = happenings(simulate(pair, events=[events[k]]))
        np.testing.assert_allclose(times[np.array(names) == f"e{k}"], alone, rtol=1e-8)
    assert times[names.index("e6")] < onset < times[names.index("e8")]
