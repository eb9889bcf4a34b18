"""What is explored is a run: ``simulate``'s numbers, the same from its file, the latest asked for."""

import threading
import time

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import journal_motion
from antenna_pin.apps.live import Explored, Runner, explore
from antenna_pin.errors import AntennaPinError

FAST = {"clearance.elevation.geometry": "closed-form", "integrator.engine": "compiled"}
PLAY = "clearance.elevation.radial_clearance"


@pytest.fixture
def antenna():
    return Explored(load_scenario("bai2020", case="case3"), span=0.05)


class Told:
    """What a runner has told."""

    def __init__(self):
        self.made, self.done = [], threading.Event()

    def __call__(self, made):
        self.made.append(made)
        if made.done:
            self.done.set()


def made_by(explored):
    told = Told()
    runner = Runner(told)
    runner.ask(explored.scenario)
    assert told.done.wait(600.0)  # kernels may have to be compiled
    runner.close()
    return told.made[-1]


def test_a_scenario_that_cannot_be_made_is_answered_at_once():
    """With why, and after how long; an error that is none of ours is one line too."""

    def refused():
        raise AntennaPinError("no such joint")

    def failing():
        raise ZeroDivisionError("of\nzero")

    for scenario, said in ((refused, "no such joint"), (failing, "ZeroDivisionError: of zero")):
        told, began = Told(), time.perf_counter()
        runner = Runner(told)
        number = runner.ask(scenario)
        assert told.done.wait(60.0)  # which a thread that is not woken never ends
        runner.close()
        (made,) = told.made
        assert (made.number, made.run, made.refused) == (number, None, said)
        assert 0.0 <= made.wall <= time.perf_counter() - began


def test_a_run_gets_on_however_slow_its_pieces_are(antenna, monkeypatch):
    """Where going on takes its time whatever the piece, shorter pieces would never come to the end."""
    from antenna_pin.apps.live import runner

    monkeypatch.setattr(runner, "_LOOK", 0.0)
    made = made_by(antenna)
    assert made.refused == "" and made.run.data["time"].values[-1] == 0.05


def test_a_run_in_pieces_is_simulates_bit_for_bit(antenna):
    antenna.turn(PLAY, 0.15e-3)
    made = made_by(antenna)
    changes = {PLAY: 0.15e-3, "duration": 0.05} | FAST
    same = simulate(load_scenario("bai2020", case="case3", overrides=changes))
    for name, variable in same.data.data_vars.items():
        assert np.array_equal(made.run.data[name].values, variable.values, equal_nan=True), name


def test_curves_are_the_runs(antenna):
    run = made_by(antenna).run
    curves = antenna.curves(run)
    motion = journal_motion(run, "elevation")
    assert [curve.name for curve in curves.first] == ["end +", "end −"]
    assert np.array_equal(curves.first[0].x, motion["offset"].values[:, 0, 0])
    radial = (
        run.data["normal_force"].sel(contact=["elevation.radial+", "elevation.radial-"]).values.sum(axis=1)
    )
    assert np.array_equal(curves.second[0].y, radial)
    assert np.array_equal(curves.third[0].y, run.data["motion_acceleration"].sel(joint="elevation").values)
    assert np.hypot(*curves.outline.T) == pytest.approx(0.2e-3, rel=1e-12, abs=0.0)  # round-off of a circle


@pytest.mark.parametrize(
    "name", ["pointing_gear", "slider", "spherical_pendulum", "reaction_wheel", "shaker", "chen2021"]
)
def test_every_kind_of_scenario_can_be_explored(name):
    explored = Explored(load_scenario(name), span=0.01)
    curves = explored.curves(made_by(explored).run)
    for panel in (curves.first, curves.second, curves.third):
        assert panel and all(len(curve.x) == len(curve.y) > 2 for curve in panel)


def test_a_saved_file_makes_the_run_that_was_shown(antenna, tmp_path):
    antenna.turn(PLAY, 0.123e-3)
    antenna.turn("materials.steel.young", 100e9)
    antenna.turn("drives.elevation.amplitude", 7.0)
    run = made_by(antenna).run
    path = antenna.save(tmp_path / "narrow.toml")
    again = simulate(load_scenario(path))
    for name in ("q", "v", "normal_force", "peak_force"):
        assert np.array_equal(run.data[name].values, again.data[name].values, equal_nan=True), name
    assert "radial_clearance = 0.000123" in path.read_text()


def test_the_latest_wins_and_what_runs_is_stopped():
    """Of a run of hours, asked for first, nothing is told once another is asked for."""
    explored = Explored(load_scenario("bai2020", case="case3"), span=0.05)
    long = load_scenario("bai2020", case="case3", overrides={"duration": 1000.0} | FAST)
    told = Told()
    runner = Runner(told)
    runner.ask(lambda: long)
    deadline = time.monotonic() + 600.0
    while not told.made and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not told.made[0].done and 0.0 < told.made[0].run.data["time"].values[-1] < 1000.0
    number = runner.ask(explored.scenario)
    assert told.done.wait(600.0)
    runner.close()
    assert told.made[-1].number == number and told.made[-1].run.data["time"].values[-1] == 0.05
    first_of_second = next(k for k, made in enumerate(told.made) if made.number == number)
    assert all(made.number == number for made in told.made[first_of_second:])


def test_a_refused_value_is_one_line_and_the_next_one_runs(antenna):
    antenna.turn("clearance.elevation.normal.restitution", 1.3)
    made = made_by(antenna)
    assert made.run is None
    assert made.refused.endswith("normal.restitution must be in [0, 1], got 1.3 (set by an override)")
    antenna.turn("clearance.elevation.normal.restitution", 0.5)
    assert made_by(antenna).run is not None


def test_reset_and_a_value_turned_back_leave_the_scenario(antenna):
    given = antenna.scenario()
    antenna.turn(PLAY, 0.1e-3)
    assert antenna.scenario() != given
    antenna.turn(PLAY, 0.2e-3)
    assert antenna.scenario() is given
    antenna.turn("drives.elevation.amplitude", 1.0)
    antenna.reset()
    assert antenna.scenario() is given


def test_another_joint_keeps_what_was_turned(antenna):
    antenna.turn(PLAY, 0.1e-3)
    antenna.look_at("azimuth")
    assert antenna.settings == {PLAY: 0.1e-3} and not antenna.has_play
    assert PLAY not in [knob.place for knob in antenna.knobs]


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"joint": "elevatoin"}, "explore: joint 'elevatoin'"),
        ({"duration": 0.0}, "explore: duration must be positive and finite [s], got 0.0"),
        ({"port": 70000}, "explore: port must be from 0 to 65535, got 70000"),
        ({"out": "nowhere/a.toml"}, "the output's folder 'nowhere' does not exist"),
    ],
)
def test_what_cannot_be_explored_is_refused_before_anything_is_served(how, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    pytest.importorskip("bokeh", reason="the extra explore is not installed")
    with pytest.raises(AntennaPinError) as refused:
        explore(load_scenario("bai2020", case="case3"), **how)
    assert said in str(refused.value) and "\n" not in str(refused.value)
