"""Whether runs show what a paper's figures show."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin.show.plot import PAPERS


def run(case, peak):
    values = np.array([[0.0], [float(peak)], [0.0]])
    return case, xr.Dataset(
        {"motion_acceleration": (("time", "joint"), values, {"units": "rad/s^2"})},
        coords={"time": [0.0, 0.1, 0.2], "joint": ["elevation"]},
        attrs={"case": case},
    )


@pytest.mark.parametrize(
    ("peaks", "agrees"),
    [((30.0, 40.0, 50.0), True), ((33.0, 32.0, 32.0), False), ((30.0, 31.0, 50.0), False)],
)
def test_peaks_have_to_rise_from_case_to_case_to_be_seen(peaks, agrees):
    """Figure 13 of Bai and Zhao: the larger the axial clearance, the higher the peaks."""
    figure = next(one for one in PAPERS["bai2020"] if one.number == 13)
    cases = ("case1", "case2-planar", "case3", "case4", "case5")
    runs = [run(case, peak) for case, peak in zip(cases, (5.8, 5.9, *peaks), strict=True)]
    assert figure.judge(runs) is agrees
    assert PAPERS["you2010"][0].judge([]) is None
