"""Sections against closed forms: a driven oscillator, a pendulum, a mass that is let go."""

import math

import numpy as np
import pytest
from scipy.special import ellipk

from antenna_pin import simulate
from antenna_pin.base.state import State
from antenna_pin.errors import AntennaPinError
from antenna_pin.run.simulation import Angle, Event, Rate
from antenna_pin.studies.nonlinear import Crossing, Stroboscope, drive_period, poincare, section_of

DRIVEN = """
[springs.way]
stiffness = 40.0
damping = 1.0
[drives.motor]
joint = "way"
kind = "sine"
amplitude = 3.0
frequency = 0.8
[initial.joints.way]
position = 0.3
"""
FREE = """
[springs.coil]
joint = "{joint}"
stiffness = {stiffness}
[initial.joints.{joint}]
{start}
"""
HERE = ["q[{0}]", "v[{0}]"]


def names(joint):
    return [name.format(joint) for name in HERE]


@pytest.mark.parametrize("phase", [0.0, 0.3])
def test_a_driven_oscillator_returns_to_its_steady_state(rig, phase):
    """The stroboscopic section is one point, the closed-form steady state at that phase."""
    w = 2.0 * math.pi * 0.8
    found = poincare(rig(DRIVEN), Stroboscope(phase=phase), names("way"), count=32, transient=60)
    steady = 3.0 * np.exp(1j * 2.0 * math.pi * phase) / (40.0 - w**2 + 1j * w)
    assert np.array_equal(found["time"], (phase + 60 + np.arange(32) + (phase == 0.0)) * 1.25)
    # What is left of the transient is exp(-0.5 60 1.25) = 5e-17; a step's tolerance is 1e-10.
    assert np.abs(found["q[way]"] - steady.imag).max() < 1e-10
    assert np.abs(found["v[way]"] - (1j * w * steady).imag).max() < 1e-9
    assert found["settled"].item() and found["transient"].item() == 60


def test_a_transient_is_cut_where_it_has_died_down(rig):
    """Unasked, as many points are cut as the oscillator's decay of exp(-0.625) a period takes."""
    found = poincare(rig(DRIVEN), Stroboscope(), names("way"), count=32, tolerance=1e-4)
    assert found["settled"].item()
    # The first block of four points is off by exp(-0.625 k), to be below 1e-4 of the way, 0.3 m: k = 15.
    assert found["transient"].item() == 16
    early = poincare(rig(DRIVEN), Stroboscope(), names("way"), count=32, transient=0)
    assert not early["settled"].item()


@pytest.mark.parametrize("direction", [1, -1, 0])
def test_a_pendulum_passes_its_lowest_place_at_the_instants_of_elliptic_functions(rig, direction):
    """At 2 rad, in vacuum: quarter periods of K(sin 1), and there the rate is 2 w sin 1."""
    scenario = rig(FREE.format(joint="hinge", stiffness=1e-300, start="angle = 2.0"), True, -9.0, rtol=1e-12)
    found = poincare(
        scenario, Crossing(when=Angle("hinge", 0.0), direction=direction), names("hinge")[1:], count=32,
        transient=0,
    )  # fmt: skip
    w = 3.0 / math.sqrt(1.000001)  # of the bob's own inertia
    quarter = ellipk(math.sin(1.0) ** 2) / w
    first, every = {1: (3, 4), -1: (1, 4), 0: (1, 2)}[direction]
    expected = quarter * (first + every * np.arange(32))
    assert np.abs(found["time"] - expected).max() < 1e-10
    way = np.where((first + every * np.arange(len(expected))) % 4 == 3, 1.0, -1.0)
    assert np.abs(found["v[hinge]"] - 2.0 * w * math.sin(1.0) * way).max() < 1e-9


def test_crossings_of_a_value_and_of_a_function_of_ones_own(rig):
    """A mass on a spring, let go: the instants at which it is at a part of its amplitude."""
    scenario = rig(FREE.format(joint="way", stiffness=16.0, start="position = 0.5"), rtol=1e-12)
    given = Crossing(when=Angle("way", 0.2), direction=-1)
    own = Crossing(when=lambda moment: moment.angle("way") - 0.2, direction=-1, name="at 0.2 m")
    expected = (math.acos(0.4) + 2.0 * math.pi * np.arange(32)) / 4.0
    for section in (given, own):
        found = poincare(scenario, section, names("way"), count=32, transient=0)
        assert np.abs(found["time"] - expected).max() < 1e-10
        assert np.abs(found["q[way]"] - 0.2).max() < 1e-13


def test_stretches_are_the_one_run(rig):
    """Points of a run made in stretches of 64 are those of one run with the same event, bit for bit."""
    scenario = rig(DRIVEN, duration="1 s")
    found = poincare(scenario, Crossing(when=Rate("way")), names("way"), count=150, transient=0)
    event = Event(name="here", when=Rate("way"), direction=1)
    run = simulate(scenario, duration=float(found["time"][-1]) + 1e-3, events=[event])
    assert np.array_equal(found["time"], run.data["event_time"])
    at = run.data["q"].sel(time=found["time"].values, configuration="way")
    assert np.array_equal(found["q[way]"], at)


def test_a_section_goes_on_from_the_state_that_it_leaves(rig):
    """Two halves of a section are the whole one."""
    scenario = rig(DRIVEN)
    whole = poincare(scenario, Stroboscope(), names("way"), count=64, transient=0)
    first = poincare(scenario, Stroboscope(), names("way"), count=32, transient=0)
    state = State.from_json(first.attrs["state"])
    second = poincare(scenario, Stroboscope(), names("way"), count=32, transient=0, start=state)
    assert np.array_equal(whole["q[way]"], np.concatenate([first["q[way]"], second["q[way]"]]))


def test_the_period_of_what_drives(rig):
    """A quantity that there is none of is refused."""
    assert drive_period(rig(DRIVEN)) == 1.25
    turning = '[drives.hinge]\nkind = "motion"\nrate = "60 rpm"\n'
    assert drive_period(rig(turning, True)) == pytest.approx(1.0, rel=1e-15)
    other = DRIVEN + '[drives.second]\njoint = "way"\nkind = "sine"\namplitude = 1.0\nfrequency = 0.5\n'
    assert drive_period(rig(other), "second") == 2.0
    with pytest.raises(AntennaPinError, match="speed"):
        poincare(rig(DRIVEN), Stroboscope(), ["speed"], count=32)


STEADY = '[drives.way]\nkind = "constant"\nvalue = 1.0\n'
TWO = DRIVEN + '[drives.second]\njoint = "way"\nkind = "sine"\namplitude = 1.0\nfrequency = 0.5\n'


@pytest.mark.parametrize(
    ("tables", "section", "count", "words"),
    [
        (STEADY, "period", 32, "drives must be periodic, or the period be given"),
        (STEADY, "period=way", 32, "drives.way must be periodic"),
        (TWO, "period", 32, "must be of one period, or one of them or the period be given"),
        (DRIVEN, "period=moter", 32, "did you mean motor?"),
        (
            DRIVEN,
            "period",
            31,
            "count must be a whole number of 32 or more, with fewer of which nothing can be",
        ),
        (DRIVEN, "angle.way=5", 32, "not once in 10 s"),
        (DRIVEN, "angle.path=5", 32, "'path'"),
        (DRIVEN, "angle.way=5 N", 32, "must be"),
        (DRIVEN, "height=5", 32, "section: text must be period, period=DRIVE"),
    ],
)
def test_refusals(rig, tables, section, count, words):
    with pytest.raises(AntennaPinError, match=words.replace("?", r"\?")) as error:
        poincare(rig(tables), section_of(section), names("way"), count=count, transient=0)
    assert "\n" not in str(error.value)
