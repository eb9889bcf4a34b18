"""A run at a glance says what its numbers are, in few lines."""

import dataclasses

import numpy as np
import pytest

from antenna_pin import list_scenarios, load_scenario, simulate
from antenna_pin.analysis import answer
from antenna_pin.base.readable import readable
from antenna_pin.trajectory import Trajectory


@pytest.fixture(scope="module")
def antenna():
    return simulate(load_scenario("bai2020", case="case3", overrides=["duration=0.05"]))


def plain(text):
    return text.replace("\N{NO-BREAK SPACE}", " ")


def told(run):
    """What is said about each thing."""
    return {line.about: plain(line.text) for line in answer(run).lines}


def test_a_joint_says_its_hardest_blow_when_it_was_and_what_was_lost(antenna):
    data = antenna.data
    hardest = int(data["peak_force"].values.argmax())
    text = told(antenna)["elevation"]
    for name, unit, digits in (("peak_force", "N", 4), ("peak_time", "s", 6)):
        assert plain(readable(float(data[name][hardest]), unit, digits)) in text, name
    lost = float(data["total_normal_loss"].sum() + data["total_friction_loss"].sum())
    assert f"; {plain(readable(lost, 'J', 3))} lost" in text
    # Both are within their own play but for the depth of a contact; together they would be beyond the radial.
    way = data["journal_position"].values[:, 0]
    off, along = float(np.linalg.norm(way[:, :2], axis=-1).max()), float(np.abs(way[:, 2]).max())
    said = f"journal up to {readable(off, 'm', 3)} off radially, {readable(along, 'm', 3)} axially"
    assert plain(said) in text


def test_the_books_are_those_of_the_summary(antenna):
    kept = antenna.summary()["conservation"]
    text = told(antenna)["energy"]
    assert plain(readable(kept["energy_error"], "J", 2)) in text
    assert "of the gross work of the drives; momentum kept to " in text


def test_what_is_let_go_is_measured_by_the_largest_energy():
    """Gravity has given a little more than moves: what is lost in contact."""
    run = simulate(load_scenario("pendulum", case="contact", overrides=["duration=0.05"]))
    kept = run.summary()["conservation"]
    largest = float(np.abs(run.data["gravity_energy"] - run.data["gravity_energy"][0]).max())
    assert kept["gross_work"] == 0.0 and kept["energy_scale"] == largest
    assert kept["energy_error_relative"] == kept["energy_error"] / largest < 1e-6
    assert "of the largest stored energy" in told(run)["energy"]


def test_work_of_forces_alone_is_theirs():
    """A ramp of 1 kN/s for 0.2 s against a contact: there are no drives that could have done it."""
    run = simulate(load_scenario("liu2013", overrides=["duration=0.2"]))
    work = float(run.data["total_force_work"].sum())
    gross = run.summary()["conservation"]["gross_work"]
    assert gross > 0.0 and work == pytest.approx(gross, rel=1e-3)  # but for the ripple it pulls all the way
    assert told(run)["energy"].startswith("forces did ") and "drives did" not in told(run)["energy"]


def test_many_joints_share_a_line():
    run = simulate(load_scenario("solar_array", case="play", overrides=["duration=5 ms"]))
    assert len([about for about in told(run) if about in ("root", "first", "second", "third")]) == 4
    # Five or more: three lines of their own, and one for the rest.
    from antenna_pin.analysis import at_a_glance

    hits = [at_a_glance._Hit(f"j{k}", k, 10.0 * k, 0.5, "hit") for k in range(6)]
    lines = list(at_a_glance._of_hits(hits))
    assert [line.about for line in lines] == ["j5", "j4", "j3", "3 other joints with play"]
    assert plain(lines[-1].text) == "3 blows, at most 20 N; 1.5 J lost"


def test_a_commanded_antenna_says_how_far_off_it_looks(antenna, tmp_path):
    from antenna_pin.analysis import pointing_error

    overrides = ["duration=0.01", "pointing.commanded=world", "pointing.direction=[1, 0, 0]"]
    run = simulate(load_scenario("bai2020", case="case1", overrides=overrides))
    most = float(pointing_error(run)["half_cone"].max())
    assert told(run)["pointing"].startswith(plain(f"off by at most {readable(most, 'rad', 3)}"))
    file = run.save(tmp_path / "run.nc")
    assert told(Trajectory.load(file, scenario=False)) == told(run)
    assert "pointing" not in told(antenna)


def test_what_is_zero_to_round_off_is_said_to_be():
    """A gear without play comes to rest, to 1e-27 rad; a planar motion leaves its plane by as much."""
    rest = simulate(load_scenario("pointing_gear", case="tight", overrides=["duration=5"]))
    assert 0.0 < abs(rest.data["motion_angle"].values[-1]).max() < 1e-14
    assert told(rest)["joints"].startswith("dish \u2248 0 rad, motor \u2248 0 rad at the end")
    planar = simulate(load_scenario("slider_crank", case="3d", overrides=["duration=2 ms"]))
    assert np.abs(planar.data["journal_tilt"].values).max() < 1e-14
    assert "askew" not in told(planar)["pin"] and "journal up to" in told(planar)["pin"]


def test_a_journal_that_has_not_left_its_centre_is_not_said_to_be_off():
    start = simulate(load_scenario("bai2020", case="case3"), duration=1e-12)
    assert told(start)["elevation"] == "no contact"


def test_a_lean_run_says_what_it_knows(antenna):
    lean = simulate(load_scenario("bai2020", case="case3", overrides=["duration=0.05", "output.form=lean"]))
    full, short = told(antenna)["elevation"], told(lean)["elevation"]
    assert full.startswith(short) and "off" not in short


@pytest.mark.parametrize("name", [one.name for one in list_scenarios()])
def test_every_shipped_case_is_told_in_nine_lines(name):
    """With a title of two lines, where a screen is narrow, and the file's line these are twelve at most."""
    cases = [case for case, _ in next(one.cases for one in list_scenarios() if one.name == name)]
    for case in {cases[0], cases[-1]}:
        scenario = load_scenario(name, case=case)
        run = simulate(scenario, duration=min(2e-3, scenario.duration))
        found = answer(dataclasses.replace(run, scenario=None))
        assert 1 <= len(found.lines) <= 9 and all(line.about and line.text for line in found.lines)
        assert found.title and "simulated in" in found.ended


def test_gears_say_how_often_they_touched_and_how_hard():
    run = simulate(load_scenario("pointing_gear", case="play", overrides=["duration=0.5"]))
    (gear,) = run.summary()["gears"].values()
    torque = plain(readable(gear["peak_torque"], "N m"))
    assert told(run)["gears"].startswith(f"{gear['touches']} touches, at most {torque} at train; apart for ")


@pytest.mark.parametrize("form", ["full", "lean"])
def test_a_latch_that_was_released_is_not_counted_as_latched(form):
    """It captures as the pendulum comes down, lets go at a torque that its weight passes, or never."""
    for most, text in (("1 mN*m", "0 of 1 latched at the end; released: hinge"), (None, "1 of 1 latched")):
        latch = {"kind": "rigid", "angle": "5 deg", "width": "1 deg"}
        latch |= {} if most is None else {"holding_torque": most}
        overrides = {"latches.hinge": latch, "duration": 1.0, "output.form": form}
        run = simulate(load_scenario("pendulum", case="ideal", overrides=overrides))
        assert run.summary()["latches"]["hinge"]["captures"] >= 1
        assert told(run)["latches"].startswith(text)
