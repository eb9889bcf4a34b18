"""Frequency responses against closed forms, mode shapes as motions, and the command."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from wheel import INERTIA, wheel_urdf

from antenna_pin import AntennaPinError, System, build_mechanism, load_scenario
from antenna_pin.analysis import body_poses
from antenna_pin.dynamics import ConstantDrive, JointSpring
from antenna_pin.elements import LuGreFriction
from antenna_pin.show.plot import figure_response
from antenna_pin.show.record import record_several
from antenna_pin.studies.linear import frequency_response, modes, swing

TAU = 2.0 * np.pi


def test_two_masses_on_a_spring(chain: Any):
    """The drive pushes both apart: their way over the force is 1 / (k + i c w - mu w^2), mu reduced."""
    k, c, m, base = 300.0, 4.0, 2.0, 5.0
    system = System(
        chain([base, m]),
        springs={"k": JointSpring(joint="s1", stiffness=k, damping=c)},
        drives={"push": ConstantDrive(joint="s1", value=0.3)},
    )
    found = modes(system)
    grid = np.geomspace(0.01, 100.0, 50)
    answer = frequency_response(found, "drives.push", ["s1", "base.x"], grid)
    w = TAU * grid
    expected = 1.0 / (k + 1j * c * w - w**2 / (1.0 / m + 1.0 / base))
    assert np.abs(answer["response"].values[:, 0] / expected - 1.0).max() < 1e-11
    # The mass centre stays: the base goes the other way by m / (m + M).
    assert np.abs(answer["response"].values[:, 1] / (-m / (m + base) * expected) - 1.0).max() < 1e-10
    assert list(answer["unit"].values) == ["m/(N)", "m/(N)"]
    push = frequency_response(found, "base.fx", "base.x", grid)["response"].values[:, 0]
    spring = k + 1j * c * w
    absorbed = 1.0 / (-(w**2) * base - w**2 * m * spring / (spring - m * w**2))
    assert np.abs(push / absorbed - 1.0).max() < 1e-10
    own = frequency_response(found, "drives.push")
    assert list(own["target"].values) == ["s1"]
    peak = float(own["frequency"].values[int(own["gain"].values.argmax())])
    ratio = found.damping_ratio[-1]
    assert peak == pytest.approx(found.frequency[-1] * np.sqrt(1.0 - 2.0 * ratio**2), rel=0.02)


def test_a_wheel_that_sticks_swings_on_its_bristles():
    """A torque below friction turns it by 1 / (sigma_0 + i (sigma_1 + sigma_2) w - J w^2)."""
    friction = LuGreFriction(
        joint="axle", coulomb=2.0, static=3.0, stribeck_rate=0.1, stiffness=40.0, damping=0.6, viscous=0.5
    )
    system = System(
        build_mechanism(wheel_urdf("revolute"), "fixed"),
        springs={"friction": friction},
        drives={"push": ConstantDrive(joint="axle", value=0.0)},
    )
    grid = np.geomspace(0.01, 100.0, 50)
    answer = frequency_response(modes(system), "drives.push", ["axle"], grid)
    w = TAU * grid
    expected = 1.0 / (40.0 + 1j * (0.6 + 0.5) * w - INERTIA * w**2)
    assert np.abs(answer["response"].values[:, 0] / expected - 1.0).max() < 1e-10


def test_the_boresight_follows_the_elevation_drive():
    """A rigid antenna turns about its cross axis as the joint and the base do."""
    found = modes(load_scenario("bai2020", case="case1"))
    answer = frequency_response(
        found, "drives.elevation", ["boresight", "elevation", "base.rx", "base.ry"], [2.0]
    )
    cross, up, angle, _, base = answer["response"].values[0]
    # The cross axis is y at the start, against the joint's turn about it or along it.
    assert abs(cross) == pytest.approx(abs(angle + base), rel=1e-9)
    assert abs(up) < 1e-2 * abs(cross)


def test_play_pressed_into_contact_answers_as_the_ideal_joint_at_low_frequency():
    stiff = modes(load_scenario("bai2020", case="case2-planar"), load=[300.0, 0.0, 0.0])
    ideal = modes(load_scenario("bai2020", case="case1"))
    one, other = (
        frequency_response(each, "drives.elevation", "elevation", [0.01]).response.values[0, 0]
        for each in (stiff, ideal)
    )
    # Friction at rest resists the turn: c = mu F R / v_s against inertias of some kg m^2.
    assert abs(one / other) < 1.0 + 1e-3


@pytest.mark.parametrize(
    ("source", "targets", "grid", "said"),
    [
        ("drives.azimut", None, None, "did you mean drives.azimuth?"),
        ("drives.azimuth", "boresigt", None, "did you mean boresight?"),
        ("drives.azimuth", None, [1.0, 1.0], "positive and rising"),
        ("drives.azimuth", None, [-1.0], "positive and rising"),
    ],
)
def test_refusals(source: str, targets: Any, grid: Any, said: str):
    found = modes(load_scenario("bai2020", case="case1"))
    with pytest.raises(AntennaPinError, match=said.replace("?", r"\?")):
        frequency_response(found, source, targets, grid)


@pytest.fixture(scope="module")
def found():
    """Return the modes of the antenna with a flexible dish."""
    return modes(load_scenario("bai2020", case="flexible-ideal"))


def test_a_shape_swings_about_the_state(found):
    """At a quarter of the period each joint is where the shape says; after half of it on the other side."""
    first = found.elastic[0]
    run = swing(found, first)
    shape = found.shape(first).real
    poses = body_poses(run)
    assert float(run.data["time"][-1]) == pytest.approx(3.0 / found.frequency[first - 1])
    slot = found.linearisation.system.mechanism.joint("elevation")
    angle = run.data["q"].values[:, slot.q.start]
    assert angle[12] / angle[36] == pytest.approx(-1.0, rel=1e-12)
    nod = found.linearisation.system.mechanism.joint("reflector_nod")
    part = run.data["q"].values[12, nod.q.start]
    assert part / angle[12] == pytest.approx(shape[nod.v.start] / shape[slot.v.start], rel=1e-12)
    assert np.ptp(poses["attitude"].values, axis=0).max() > 0.1
    assert np.abs(swing(found, first, 0.5).data["q"].values[12, nod.q.start] / part) == pytest.approx(0.5)


def test_a_page_of_several_shapes(found, tmp_path: Any):
    shapes = [swing(found, k) for k in found.elastic]
    page = record_several(shapes, tmp_path / "modes.html", "Shapes").read_text()
    assert page.count('class="ap-frame"') == 2
    assert page.count("<h2>") == 2 and "17.3 Hz" in page


def test_the_figure_shows_the_response(found):
    answer = frequency_response(found, "drives.elevation", ["boresight", "base.x"])
    figure = figure_response(answer)
    lines = figure.axes[0].get_lines()
    assert lines[0].get_ydata() == pytest.approx(answer["gain"].values[:, 0])
    # One panel for turns, one for ways, one for phases.
    assert len(figure.axes) == 3


# --- the command ---


def test_the_command_says_what_python_finds(found, cli: Any, tmp_path: Any):
    said = cli("modes", "bai2020", "--case", "flexible-ideal", "--json")
    table = json.loads(said.out)
    assert [one["frequency"] for one in table["modes"]] == found.frequency.tolist()
    assert table["modes"][0]["damping_ratio"] is None
    shown = cli("modes", "bai2020", "--case", "flexible-ideal", "--hold", "base", "--csv", "m.csv")
    assert "saved m.csv" in shown.out
    head, *rows = (tmp_path / "m.csv").read_text().splitlines()
    assert head.startswith(
        "mode,kind,frequency [Hz],damped modulus [Hz],damping ratio [-],effective mass x [kg]"
    )
    assert len(rows) == 4
    text = cli("modes", "bai2020", "--case", "flexible-ideal", "--hold", "base").out
    assert "effective masses, about the base's origin" in text
    assert "rigid whole" in text


def test_the_command_draws_and_records(cli: Any, tmp_path: Any):
    wanted = "--record m.html --plot r.png --from drives.azimuth --to azimuth"
    said = cli("modes", "bai2020", "--case", "flexible-ideal", *wanted.split())
    assert said.code == 0 and "saved m.html" in said.out and "saved r.png" in said.out
    assert (tmp_path / "r.png").stat().st_size > 10_000


def test_the_command_takes_a_time_and_a_result(cli: Any):
    at = cli("modes", "bai2020", "--case", "case1", "--at", "20 ms", "--json")
    assert json.loads(at.out)["time"] == 0.02
    cli("run", "bai2020", "--case", "case1", "--duration", "20 ms", "--out", "r.nc", "--quiet")
    of_run = json.loads(cli("modes", "r.nc", "--json").out)
    assert of_run["modes"] == json.loads(at.out)["modes"]
    with_run = json.loads(cli("modes", "bai2020", "--case", "case1", "--at", "r.nc", "--json").out)
    assert with_run["modes"] == of_run["modes"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--load", "1,2"], "--load must be three numbers"),
        (["--from", "drives.azimuth"], "--from must be given with --plot FILE"),
        (["--mode", "2"], "--mode must be given with --record FILE"),
        (["--record", "r.mp4"], "must end in .html"),
        (["--hold", "elevaton"], "did you mean elevation?"),
        (["--at", "noon"], "--at"),
        (["--record", "r.html"], "given --mode NUMBER, as nothing vibrates here"),
        (["--record", "r.html", "--mode", "99"], "a number from 1 to"),
    ],
)
def test_the_command_refuses_in_one_line(cli: Any, arguments: list[str], said: str):
    refused = cli("modes", "bai2020", "--case", "case3", *arguments)
    assert refused.code == 2
    assert said in refused.err
    assert len(refused.err.strip().splitlines()) == 1
