"""Settled motions of a paper's figures: what they are, and whether that is what the paper says."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin.analysis import RecurrenceKind, diagram_verdicts
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.show.plot import ATTRACTORS, Attractor, AttractorFigure, DiagramFigure, figure_bifurcation
from antenna_pin.studies.nonlinear import load_plan

X, Y = "body_position[platform].z", "body_velocity[platform].z"
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
FIGURES = {one.number: one for one in ATTRACTORS["chen2021"]}


def attractor(label, modulation, noise=0.0, settled=True, count=400):
    """A circle of radius 1 whose points, once a turn, lie where a modulation of turns says."""
    turns = np.arange(count)
    generator = np.random.default_rng(3)
    points = {
        X: 1.0 + modulation(turns, 0) + noise * generator.standard_normal(count),
        Y: modulation(turns, 1) + noise * generator.standard_normal(count),
    }
    section = xr.Dataset(
        {name: ("point", values) for name, values in points.items()} | {"settled": settled},
        attrs={"section": "once a period", "period": 2.0},
    )
    angle = np.linspace(0.0, 2.0 * np.pi, 500)
    run = xr.Dataset(
        {X: ("time", np.cos(angle), {"units": "m"}), Y: ("time", np.sin(angle), {"units": "m/s"})},
        coords={"time": angle / np.pi},
    )
    return Attractor(label, section, run)


def quasi(size, rotation=GOLDEN):
    return lambda n, k: size * np.cos(2.0 * np.pi * rotation * n - 0.5 * np.pi * k)


@pytest.fixture(autouse=True)
def quantities_are_variables(monkeypatch):
    """Stretches of these tests hold the quantities themselves, not a mechanism that they follow from."""
    from antenna_pin.analysis import Quantity

    def read(run, name):
        return Quantity(name, run["time"].values, run[name].values, run[name].attrs["units"], name)

    monkeypatch.setattr("antenna_pin.show.plot.phase.quantity", read)


def test_a_motion_is_judged_by_the_range_of_its_trajectory():
    """Noise of 3e-8 of it, as runs of an accuracy of 1e-5 leave, is none; a curve of 4e-6 of it is one."""
    fixed = attractor("fixed", lambda n, k: 0.0 * n, noise=6e-8)
    assert fixed.recurs(X, Y).period == 1 and fixed.words(X, Y) == "period 1"
    curve = attractor("curve", quasi(4e-6))
    assert curve.recurs(X, Y).kind is RecurrenceKind.QUASI_PERIODIC
    assert curve.words(X, Y) == "quasi-periodic, over 4e-06"
    # Nor is it of period 13 where it has turned but a fiftieth after 200 turns, less than the tolerance.
    assert attractor("near", quasi(4e-6, 2.0 / 13.0 + 1e-4)).recurs(X, Y).period is None
    assert attractor("locked", quasi(4e-3, 2.0 / 13.0)).recurs(X, Y).period == 13
    assert attractor("way", quasi(0.1), settled=False).words(X, Y) == "not settled"
    with pytest.raises(InvalidParameterError, match="holds speed"):
        curve.points(X, "speed")


def test_figures_agree_where_the_eye_sees_what_the_paper_says():
    """Figure 9: quasi-periodic with friction 0.01, period 1 with 0.05 and 0.10; a dot is a point."""
    figure = FIGURES[9]
    wide, dot = attractor("wide", quasi(0.1)), attractor("dot", quasi(1e-4))
    assert figure.judge({"0.01": wide, "0.05": dot, "0.10": dot})
    assert not figure.judge({"0.01": dot, "0.05": dot, "0.10": dot})
    assert not figure.judge({"0.01": wide, "0.05": wide, "0.10": dot})
    said = figure.describe({"0.01": wide, "0.05": dot, "0.10": dot})
    assert said.count("one dot") == 2 and "wide: quasi-periodic, over 0.1;" in said
    with pytest.raises(InvalidParameterError, match=r"with 0.05 and 0.10 among them"):
        figure.draw({"0.01": wide})
    panels = figure.draw({"0.01": wide, "0.05": dot, "0.10": dot}).axes
    assert len(panels) == 6
    # The window about the points of a dot is a hundredth of the trajectory's range, not their own size.
    low, high = panels[3].get_xlim()
    assert high - low == pytest.approx(0.02 * 1e0, rel=1e-3)


def diagram(figure, moves):
    """Points at 20 values; ``moves`` has of each value what points of a period do there."""
    names, values = figure.quantities, np.linspace(15.02e-3, 15.9e-3, 20)
    points = np.stack([0.1 + moves(value) for value in values])
    about = {"units": "m/s", "long_name": "velocity"}
    data = {
        name: (("branch", "value", "point"), points[None] * scale, about)
        for name, scale in zip(names, (1.0, 0.5, 1e-9), strict=True)
    }
    return xr.Dataset(
        data | {"settled": (("branch", "value"), np.arange(20)[None] != 7)},
        coords={"branch": ["fresh"], "value": ("value", values, {"units": "m"})},
        attrs={
            "quantities": str(list(names)).replace("'", '"'),
            "section": "once a period",
            "parameter": "radius",
        },
    )


def test_a_diagram_is_judged_value_by_value():
    n = np.arange(40)
    figure = FIGURES[14]
    single = diagram(figure, lambda value: 2e-5 * np.cos(2.0 * np.pi * GOLDEN * n))
    values, verdicts = figure.verdicts(single)
    # Over clearance, not the radius of the socket, in millimetres; the one that had not settled is left out.
    assert len(values) == 19 and values[0] == pytest.approx(0.02) and values[-1] == pytest.approx(0.9)
    assert set(verdicts) == {"period 1"} and figure.judge(single)
    said, _, rest = figure.describe(single).partition(". ")
    assert said == "period 1 at 19 values: 0.02 to 0.298, 0.391 to 0.9 mm; not settled at 1 value: 0.344 mm"
    assert rest.startswith("Points farthest apart: ")
    # A component of a vector that is nearly zero is judged beside the others; by itself it would scatter.
    tiny = single.assign({figure.quantities[2]: single[figure.quantities[2]] * 0.0 + n % 3 * 1e-9})
    assert set(figure.verdicts(tiny)[1]) == {"period 1"}
    assert set(diagram_verdicts(tiny, figure.quantities)) == {"period 3", None}
    half = single.assign(settled=single["settled"] & (np.arange(20) > 15))
    assert figure.judge(half) is None  # of what has not settled nothing can be said
    double = diagram(figure, lambda value: 0.01 * (-1.0) ** n * (value > 15.5e-3))
    assert not figure.judge(double)
    assert set(figure.verdicts(double)[1]) == {"period 1", "period 2"}
    with pytest.raises(UnknownNameError, match="speed"):
        figure_bifurcation(single, quantities=["speed"])


def test_every_figure_takes_what_its_shipped_diagram_has():
    assert list(FIGURES) == list(range(9, 17))
    for figure in FIGURES.values():
        plan = load_plan((figure.over if isinstance(figure, AttractorFigure) else figure.diagram).name)
        if isinstance(figure, DiagramFigure):
            assert set(figure.quantities) <= set(plan.quantities)
            continue
        assert list(figure.there) == list(figure.values)
        for value in figure.values:
            plan.base([f"{plan.parameter}={value}"])
