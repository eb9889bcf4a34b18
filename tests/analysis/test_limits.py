"""Limits of a URDF that a run has passed."""

import numpy as np
import xarray as xr

from antenna_pin.analysis import said_of_limits

URDF = """<robot name="r"><joint name="arm" type="{kind}">
<limit lower="-0.5" upper="0.5" effort="1" velocity="1"/></joint></robot>"""


def run(angles, kind="revolute"):
    return xr.Dataset(
        {"motion_angle": (("time", "joint"), np.array(angles)[:, None])},
        coords={"time": 0.1 * np.arange(len(angles)), "joint": ["arm"]},
        attrs={"urdf": URDF.format(kind=kind), "form": "full"},
    )


def plain(line):
    return line.replace("\N{NO-BREAK SPACE}", " ").replace("\N{MINUS SIGN}", "-")


def test_a_joint_past_its_limit_is_named_with_place_and_time():
    (line,) = said_of_limits(run([0.0, 0.4, 0.6, 0.7, 0.2]))
    said = "joint 'arm' passes its limit of 0.5 rad at 0.2 s, by up to 0.2 rad: limits are not simulated"
    assert plain(line) == said
    (below,) = said_of_limits(run([0.0, -0.8]))
    assert "limit of -0.5 rad" in plain(below)
    assert said_of_limits(run([0.0, 0.5 + 1e-12, -0.5])) == ()
    (around,) = said_of_limits(run([0.0, 9.0], kind="continuous"))
    assert around.endswith("it is continuous, which has none")
    assert said_of_limits(run([0.0, 9.0]).assign_attrs(urdf="<limit")) == ()


def test_a_lean_result_tells_of_the_end():
    lean = (
        run([0.0]).drop_vars("motion_angle").assign(final_angle=("joint", [-0.75])).assign_attrs(form="lean")
    )
    (line,) = said_of_limits(lean)
    assert (
        plain(line) == "joint 'arm' ends beyond its limit of -0.5 rad, by 0.25 rad: limits are not simulated"
    )
    assert said_of_limits(lean.assign(final_angle=("joint", [0.5]))) == ()
