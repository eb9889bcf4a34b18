"""Joints with play in closed loops: runs that converge, the ideal mechanism's start, the limit of no play."""

import json
import math

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import body_motion

QUARTER = 3e-3  # [s] of a turn at 5000 rpm
SWING = 0.05 / 0.12  # largest sine of the rod's angle


def slider_crank(case="planar", duration=QUARTER, **settings):
    overrides = ["output.rate=10 kHz", "clearance.pin.geometry=closed-form"]
    overrides += [f"{key.replace('__', '.')}={value}" for key, value in settings.items()]
    return simulate(load_scenario("slider_crank", case=case, overrides=overrides), duration=duration)


@pytest.mark.parametrize("case", ["planar", "3d-friction"])
def test_impacts_of_the_slider_crank_converge(case):
    """Over the first quarter turn, against a tolerance of 1e-13: impacts have not yet made errors grow."""
    fine, run = (slider_crank(case, integrator__rtol=rtol) for rtol in (1e-13, 1e-11))
    assert len(run.data.onset_time) == len(fine.data.onset_time) > 3
    assert run.data.onset_time.values == pytest.approx(fine.data.onset_time.values, abs=1e-11)
    assert run.data.peak_force.values == pytest.approx(fine.data.peak_force.values, rel=1e-6)
    times = np.intersect1d(run.data.time, fine.data.time)
    ends = [body_motion(one, "slider").sel(time=times) for one in (run, fine)]
    # 0.17 m and 25 m/s: 1e-6 of the play, and 1e-5 of the impacts' speeds of 1 m/s.
    assert ends[0].position.values == pytest.approx(ends[1].position.values, abs=5e-10)
    assert ends[0].velocity.values == pytest.approx(ends[1].velocity.values, abs=1e-5)
    assert json.loads(run.data.attrs["conservation"])["energy_error_relative"] < 1e-9


def test_a_loop_tends_to_the_ideal_one_as_the_play_goes():
    """The slider is off by play and depth, along the rod at most, as seen along its guide: of first order."""
    ideal = body_motion(slider_crank("ideal", duration=4 * QUARTER), "slider").position
    plays, off = [4e-4, 2e-4, 1e-4, 5e-5], []
    for play in plays:
        run = slider_crank(
            "flores",
            duration=4 * QUARTER,
            clearance__pin__radial_clearance=play,
            clearance__pin__normal__restitution=0.3,
        )
        place = body_motion(run, "slider").position.sel(time=ideal.time)
        off.append(float(np.abs(place - ideal).max()))
        reach = play + float(run.data.peak_depth.max())
        assert off[-1] <= reach / math.sqrt(1.0 - SWING**2)
        assert off[-1] > 0.9 * play  # it uses all of its play
    order = np.polyfit(np.log(plays), np.log(off), 1)[0]
    # Less than 1 by the depth, which hardly depends on the play.
    assert 0.9 < order <= 1.0
