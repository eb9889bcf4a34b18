"""Phase portraits: what is cut, what is drawn, what the command says."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import Periods, open_portrait, phase_portrait
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.show.plot import figure_phase
from antenna_pin.show.plot.phase import thinned
from antenna_pin.trajectory import open_table

X, Y = "motion_angle[hinge]", "motion_rate[hinge]"


@pytest.fixture(scope="module")
def oscillator():
    """A hinge that swings with 1 rad at 2 pi rad/s, about an offset that decays with 2 s."""
    time = np.arange(0.0, 50.0, 0.01)
    decay = 3.0 * np.exp(-time / 2.0)
    angle = np.cos(2.0 * np.pi * time) + decay
    rate = -2.0 * np.pi * np.sin(2.0 * np.pi * time) - 0.5 * decay
    over = ("time", "joint")
    return xr.Dataset(
        {
            "motion_angle": (over, angle[:, None], {"units": "rad", "long_name": "angle"}),
            "motion_rate": (over, rate[:, None], {"units": "rad/s", "long_name": "rate"}),
            "motion_acceleration": (over, np.gradient(rate, time)[:, None], {"units": "rad/s^2"}),
        },
        coords={"time": ("time", time, {"units": "s"}), "joint": ["hinge"]},
        attrs={"case": "swing"},
    )


def test_a_portrait_is_the_samples_behind_its_transient(oscillator):
    whole = phase_portrait(oscillator, X, Y)
    assert np.array_equal(whole.points[:, 0], oscillator["motion_angle"].values[:, 0])
    assert whole.rule == "from the first sample on"
    later = phase_portrait(oscillator, X, Y, transient=20.0)
    assert np.array_equal(later.points, whole.points[whole.time >= 20.0])
    counted = phase_portrait(oscillator, X, Y, transient=Periods(20, 1.0))
    assert np.array_equal(counted.time, later.time)
    assert counted.rule == "after 20 periods of 1 s"
    # What is left is the circle of the oscillator.
    across, up = later.points.T
    assert np.hypot(across, up / (2.0 * np.pi)) == pytest.approx(1.0, abs=2e-4)  # 3 exp(-10) = 1.4e-4


def test_the_judge_cuts_where_the_offset_has_died_out(oscillator):
    """Three e^(-t/2) is a hundredth of the motion at 11 s, a thousandth at 16 s."""
    found = phase_portrait(oscillator, X, Y, transient="judge")
    assert 6.0 < found.start < 18.0
    growing = oscillator.copy()
    growing["motion_angle"] = growing["motion_angle"] * (1.0 + growing["time"])
    with pytest.raises(InvalidParameterError, match="swing has not settled within 49.99 s"):
        phase_portrait(growing, X, Y, transient="judge")


def test_what_cannot_be_cut_is_refused(oscillator):
    with pytest.raises(InvalidParameterError, match="over before the run ends, at 49.99 s, got 60 s"):
        phase_portrait(oscillator, X, Y, transient=60.0)
    with pytest.raises(InvalidParameterError, match="zero or later"):
        phase_portrait(oscillator, X, Y, transient=float("nan"))
    with pytest.raises(InvalidParameterError, match="Periods: period must be positive"):
        Periods(3, 0.0)
    with pytest.raises(UnknownNameError, match="did you mean hinge"):
        phase_portrait(oscillator, X, "motion_rate[hing]")


def test_figures_show_what_they_say(oscillator):
    flat = figure_phase(phase_portrait(oscillator, X, Y, transient=20.0))
    axes = flat.axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == (f"{X} [rad]", f"{Y} [rad/s]")
    drawn = np.concatenate(axes.collections[0].get_segments())
    assert drawn[:, 0].max() == pytest.approx(1.0, abs=1e-3)
    assert drawn[:, 1].min() == pytest.approx(-2.0 * np.pi, rel=1e-3)
    spatial = figure_phase(phase_portrait(oscillator, X, Y, "motion_acceleration[hinge]"), width="column")
    assert spatial.axes[0].get_zlabel() == "motion_acceleration[hinge] [rad/s²]"
    dense = figure_phase(phase_portrait(oscillator, X, Y, transient=20.0), shade="density")
    share = dense.axes[0].collections[0].get_array()
    assert share.sum() == pytest.approx(100.0, rel=1e-9)
    with pytest.raises(InvalidParameterError, match="time for three quantities"):
        figure_phase(phase_portrait(oscillator, X, Y, "time"), shade="density")


def test_thinning_keeps_the_line():
    """Every point is within a cell of one that is drawn, and a single spike is."""
    time = np.linspace(0.0, 1.0, 200_000)
    points = np.column_stack([np.cos(2.0 * np.pi * time), np.sin(2.0 * np.pi * time)])
    points[70_000] = [3.0, 3.0]
    kept = thinned(points)
    assert 70_000 in kept and kept[0] == 0 and kept[-1] == len(points) - 1
    assert len(kept) < 20_000
    near = np.interp(np.arange(len(points)), kept, points[kept, 0])
    assert np.abs(near - points[:, 0]).max() < 4.0 / 2000 * 1.01


def test_a_portrait_comes_back_from_its_file(cli):
    """Also of a quantity over time, whose name the time axis has."""
    run = simulate(load_scenario("pendulum", case="planar"), duration=0.05)
    run.save("run.nc")
    for names in ((X, Y), ("time", X, Y)):
        options = [word for pair in zip(("-x", "-y", "-z"), names, strict=False) for word in pair]
        said = cli("phase", "run.nc", *options, "--from", "10 ms", "--out", "p.nc", "--plot", "p.svg")
        assert said.code == 0 and said.out.endswith("saved p.nc\nsaved p.svg\n")
        found, wanted = open_portrait("p.nc"), phase_portrait(run, *names, transient=0.01)
        assert np.array_equal(found.points, wanted.points) and np.array_equal(found.time, wanted.time)
        assert (found.run, found.start, found.rule) == (wanted.run, wanted.start, wanted.rule)
        assert [one[3:] for one in found.quantities] == [one[3:] for one in wanted.quantities]
    kept = open_table("p.nc", "portrait")
    assert kept.attrs["name"] == "pendulum" and kept.attrs["versions"] == run.data.attrs["versions"]


def test_the_command(cli):
    simulate(load_scenario("pendulum", case="planar"), duration=0.05).save("run.nc")
    said = cli("phase", "run.nc", "--list")
    assert said.code == 0 and "motion_rate[hinge]" in said.out and "rad/s²" in said.out
    said = cli("phase", "run.nc", "-x", X, "-y", Y, "--from", "10 ms", "-o", "p.png")
    assert (said.code, said.err) == (0, "")
    assert "from 0.01 s on, as given" in said.out and said.out.endswith("saved p.png\n")
    for arguments, message in (
        (("-x", X, "-o", "p.png"), "phase: -y must be given as -y NAME, or --list, got nothing"),
        (("-x", X, "-y", Y, "-o", "p.gif"), "phase: -o must be a file that ends in .png, .pdf, .svg"),
        (("-x", X, "-y", "rate", "-o", "p.png"), "quantity: "),
        (("-x", X, "-y", Y, "--from", "3 periods", "-o", "p.png"), "--from must be given with --period TIME"),
        (
            ("-x", X, "-y", Y, "--from", "3e0 periods", "-o", "p.png"),
            "--from must be given with --period TIME",
        ),
        (
            ("-x", X, "-y", Y, "--period", "1 s", "-o", "p.png"),
            "--period must be given with --from 'N periods'",
        ),
        (("-x", X, "-y", Y, "--from", "1 kg", "-o", "p.png"), "--from must be a time [s]"),
    ):
        said = cli("phase", "run.nc", *arguments)
        assert said.code == 2 and message in said.err and said.err.count("\n") == 1
