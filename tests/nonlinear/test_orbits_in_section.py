"""Where orbits of a branch pass a section, and the figure that lays them over a diagram."""

import json

import numpy as np
import pytest
import xarray as xr

from antenna_pin import load_scenario
from antenna_pin.errors import InvalidParameterError
from antenna_pin.show.plot import figure_bifurcation
from antenna_pin.studies.nonlinear import (
    Stroboscope,
    branch_table,
    continued,
    family_of,
    flow_of,
    orbits_in_section,
    poincare,
    section_of,
)

KEY = "drives.motor.amplitude"
DRIVE = "{joint = 'hinge', kind = 'sine', amplitude = '1 N*m', frequency = '0.625 Hz'}"
NAMES = ["motion_angle[hinge]", "motion_rate[hinge]"]


@pytest.fixture(scope="module")
def pendulum():
    return load_scenario("pendulum", case="ideal", overrides=[f"drives.motor={DRIVE}"])


@pytest.fixture(scope="module")
def branch(pendulum):
    """Two orbits or more from 1 to 1.2 N m."""
    flow, start = flow_of(pendulum)
    family = family_of(pendulum, KEY)
    found = continued(family, flow.after(start, 20 * 1.6), (1.0, 1.2), arc=0.2)
    return branch_table(found, flow.system, KEY, "N m", pendulum)


@pytest.mark.parametrize("phase", [0.0, 0.25])
def test_a_stable_orbit_passes_where_the_motion_settles(pendulum, branch, phase):
    """Forty periods on, the motion has come as near as multipliers of 0.4 bring it: to round-off."""
    section = Stroboscope(phase=phase)
    found = orbits_in_section(branch, section, NAMES)
    settled = poincare(pendulum, section, NAMES, count=40)
    assert float(found["value"][0]) == pytest.approx(1.0, abs=1e-12)
    for name in NAMES:
        assert found[name].sizes["pass"] == 1
        here = float(found[name].values[0, 0])
        # The runs of the section have the scenario's tolerance of 1e-8 or so.
        assert here == pytest.approx(float(settled[name].values[-1]), abs=1e-6)
        assert found[name].attrs["units"] in ("rad", "rad/s")


def test_a_surface_is_refused(branch):
    with pytest.raises(InvalidParameterError, match="section must be one of a period"):
        orbits_in_section(branch, section_of("angle.hinge=0"), NAMES)


def diagram(parameter=KEY):
    values = np.linspace(1.0, 1.2, 5)
    points = np.zeros((1, 5, 3))
    over = ("branch", "value", "point")
    return xr.Dataset(
        {name: (over, points, {"units": "rad", "long_name": "angle"}) for name in NAMES}
        | {"settled": (("branch", "value"), np.ones((1, 5), dtype=bool))},
        coords={"branch": ["fresh"], "value": ("value", values, {"units": "N m"})},
        attrs={"parameter": parameter, "quantities": json.dumps(NAMES), "section": "x"},
    )


def test_the_figure_has_the_orbits_over_the_points(branch):
    found = orbits_in_section(branch, Stroboscope(), NAMES)
    figure = figure_bifurcation(diagram(), orbits=found)
    for axes, name in zip(figure.axes, NAMES, strict=True):
        (line,) = (one for one in axes.lines if one.get_label() == "orbit, stable")
        np.testing.assert_allclose(line.get_xdata(), found["value"])
        np.testing.assert_allclose(line.get_ydata(), found[name].values[:, 0])
        assert line.get_linestyle() == "-" and line.get_zorder() > 2.0
    assert figure.axes[-1].get_xlabel() == "amplitude of motor [N m]"
    assert KEY in figure.get_supxlabel()


def test_orbits_over_something_else_are_refused(branch):
    with pytest.raises(InvalidParameterError, match="with its points in the section"):
        figure_bifurcation(diagram(), orbits=branch)
    found = orbits_in_section(branch, Stroboscope(), NAMES)
    with pytest.raises(InvalidParameterError, match=r"over drives\.motor\.frequency as the diagram"):
        figure_bifurcation(diagram("drives.motor.frequency"), orbits=found)
