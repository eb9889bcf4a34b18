"""Figures of branches, multipliers and exponents show what the datasets say."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin.errors import UnknownNameError
from antenna_pin.show.plot import figure_branch, figure_exponents, figure_multipliers
from antenna_pin.show.plot.periodic import track

# A branch that turns at 2, doubles its period at 1.4 on the way back and ends in a graze at 1.
VALUES = [0.0, 1.0, 1.9, 1.9, 1.6, 1.2]
STABILITY = ["stable", "stable", "stable", "unstable", "unstable", "stable"]
LARGEST = [0.2, 0.5, 0.9, 1.2, 1.5, 0.8]
HAPPENED = [("fold", 2.0, 2), ("flip", 1.4, 4), ("grazing", 1.0, 5)]


def branch(values=VALUES, stability=STABILITY, largest=LARGEST, happened=HAPPENED):
    count = len(values)
    turn = np.exp(0.5j)
    over = ("point", "multiplier")
    multipliers = np.array(largest)[:, None] * np.array([turn, turn.conjugate()])
    return xr.Dataset(
        {
            "stability": ("point", np.array(stability, dtype=object)),
            "multiplier_real": (over, multipliers.real),
            "multiplier_imaginary": (over, multipliers.imag),
            "q": (("point", "configuration"), np.linspace(0.0, 1.0, count)[:, None]),
            "v": (("point", "coordinate"), np.linspace(0.0, 10.0, count)[:, None]),
            "kind": ("bifurcation", np.array([one[0] for one in happened], dtype=object)),
            "at": ("bifurcation", np.array([one[1] for one in happened], dtype=float)),
            "after": ("bifurcation", np.array([one[2] for one in happened], dtype=int)),
        },
        coords={
            "value": ("point", np.array(values, dtype=float), {"units": "N"}),
            "configuration": ["way"],
            "configuration_unit": ("configuration", ["m"]),
            "coordinate": ["way"],
            "coordinate_unit": ("coordinate", ["m/s"]),
        },
        attrs={"parameter": "drives.motor.amplitude", "message": "it ends in a graze at 1"},
    )


def test_stability_changes_where_something_happens():
    found = track(branch(), np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0]))
    assert [said for said, _, _ in found.pieces] == ["stable", "unstable", "stable"]
    first, second, third = found.pieces
    assert first[1].tolist() == [0.0, 1.0, 1.9, 2.0] and second[1].tolist() == [2.0, 1.9, 1.6, 1.4]
    assert third[1].tolist() == [1.4, 1.2, 1.0]
    # The fold is where the multiplier is 1, from 0.9 to 1.2 a third of the way; the flip half way, as 1.4 is
    # between 1.6 and 1.2; no orbit is behind the graze.
    fold = pytest.approx(2.0 + 1.0 / 3.0)
    assert found.marks == [("fold", 2.0, fold), ("flip", 1.4, pytest.approx(4.5)), ("grazing", 1.0, 5.0)]
    assert first[2][-1] == second[2][0] == fold and third[2][-1] == 5.0


def test_a_change_that_nobody_located_is_where_the_multiplier_is_one():
    plain = branch([0.0, 1.0], ["stable", "unstable"], [0.9, 1.3], [])
    found = track(plain, np.array([0.0, 1.0]))
    assert found.marks == [("stability changes", pytest.approx(0.25), pytest.approx(0.25))]


def test_a_figure_of_a_branch():
    figure = figure_branch(branch())
    where, size = figure.axes
    assert where.get_ylabel() == "v[way]\nat the start [m/s]"
    assert size.get_xlabel() == "amplitude of motor [N]"
    lines = [line for line in size.get_lines() if len(line.get_xdata()) > 2]
    assert [line.get_linestyle() for line in lines if line.get_label() == "stable"] == ["-", "-"]
    assert [line.get_linestyle() for line in lines if line.get_label() == "unstable"] == ["--"]
    marks = {
        line.get_label(): line.get_marker() for line in size.get_lines() if line.get_linestyle() == "None"
    }
    assert set(marks) == {"fold", "flip", "grazing"} and len(set(marks.values())) == 3
    assert any(list(line.get_ydata()) == [1.0, 1.0] for line in size.get_lines())
    with pytest.raises(UnknownNameError, match=r"v\[way\]"):
        figure_branch(branch(), "v[wy]")


def test_amplitudes_come_before_coordinates():
    amplitude = xr.DataArray([np.arange(6.0)], dims=("quantity", "point"))
    known = branch().assign(amplitude=amplitude, amplitude_unit=("quantity", ["rad"]))
    known = known.assign_coords(quantity=["motion_angle[hinge]"])
    assert figure_branch(known).axes[0].get_ylabel() == "amplitude of\nmotion_angle[hinge] [rad]"
    assert figure_branch(known, "q[way]").axes[0].get_ylabel() == "q[way]\nat the start [m]"


def test_multipliers_stand_beside_the_unit_circle():
    orbit = branch().isel(point=4).assign(doubt=1e-8, period=1.5)
    (axes,) = figure_multipliers(orbit).axes
    circle, outside = axes.get_lines()
    assert np.hypot(*circle.get_data()) == pytest.approx(1.0, abs=1e-15)  # round-off of sine and cosine
    assert outside.get_label() == "outside" and np.hypot(*outside.get_data()) == pytest.approx(1.5)
    assert axes.get_aspect() == 1.0 and axes.get_xlim()[1] > 1.5 * np.cos(0.5)
    points = figure_multipliers(branch()).axes[0].collections[0]
    assert len(points.get_offsets()) == 12 and sorted(set(points.get_array())) == sorted(set(VALUES))


def test_exponents_end_in_their_error():
    running = np.array([[4.0, -3.0], [1.5, -1.8], [1.2, -2.0]])
    exponents = xr.Dataset(
        {
            "value": ("exponent", running[-1]),
            "error": ("exponent", [0.2, np.inf]),
            "running": (("interval", "exponent"), running),
        },
        coords={"time": ("interval", [1.0, 2.0, 3.0])},
        attrs={"verdict": "chaotic", "interval": 1.0},
    )
    figure = figure_exponents(exponents)
    (axes,) = figure.axes
    lines = {line.get_label(): line for line in axes.get_lines()}
    assert lines["1.2 ± 0.2 1/s"].get_ydata().tolist() == running[:, 0].tolist()
    assert "-2, error unknown 1/s" in lines
    bars = [one.get_segments()[0] for one in axes.collections if len(one.get_segments())]
    assert bars[0][:, 1].tolist() == pytest.approx([1.0, 1.4])
    assert "chaotic; 3 intervals of 1 s" in figure.get_supxlabel()
