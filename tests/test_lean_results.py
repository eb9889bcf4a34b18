"""A lean result: the numbers of the full one without its series, and readers that say what they lack."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.analysis import body_poses, impacts, load_statistics, scenario_shares
from antenna_pin.errors import FileFormatError
from antenna_pin.show.plot import figure_motion
from antenna_pin.show.record import record
from antenna_pin.show.report import report
from antenna_pin.trajectory.schema import VARIABLES


@pytest.fixture(scope="module")
def both():
    """The antenna at its first impacts, with a damper, in both forms."""
    changes = ["clearance.elevation.geometry=closed-form", "springs.d={joint = 'azimuth', damping = 0.1}"]
    return [
        simulate(
            load_scenario("bai2020", case="case3", overrides=[*changes, f"output.form={form}"]), duration=0.05
        )
        for form in ("full", "lean")
    ]


def test_a_lean_result_is_the_full_one_without_its_series(both, tmp_path):
    full, lean = both
    assert full.data.sizes["episode"] > 0 and lean.summary()["contacts"]
    assert set(lean.data.data_vars) == {
        name for name in full.data.data_vars if "time" not in full.data[name].dims
    }
    assert "time" not in lean.data.variables
    for name in lean.data.variables:
        xr.testing.assert_identical(full.data[name].drop_vars("time", errors="ignore"), lean.data[name])
    one, other = full.summary(), lean.summary()
    assert {**one, "counts": 0} == {**other, "counts": 0}
    again = Trajectory.load(lean.save(tmp_path / "lean.nc"))
    xr.testing.assert_identical(again.data.drop_attrs(), lean.data.drop_attrs())
    assert again.summary() == other
    assert again.end == full.end
    assert (tmp_path / "lean.nc").stat().st_size < 0.5 * full.save(tmp_path / "full.nc").stat().st_size


def test_final_numbers_are_those_of_the_series(both):
    data = both[0].data
    for final, series in (
        ("final_angle", "motion_angle"),
        ("final_rate", "motion_rate"),
        ("total_work", "drive_work"),
        ("total_gross_work", "drive_gross_work"),
        ("total_normal_loss", "dissipation_normal"),
        ("total_friction_loss", "dissipation_friction"),
        ("total_damper_loss", "dissipation_damper"),
    ):
        assert np.array_equal(data[final].values, data[series].values[-1])
        assert np.all(data[final].values != 0.0) or "loss" in final
    assert np.array_equal(data["peak_acceleration"], np.abs(data["motion_acceleration"]).max("time"))


@pytest.mark.parametrize(
    "read",
    [impacts, load_statistics, scenario_shares, body_poses, figure_motion, record, report],
    ids=lambda read: read.__name__,
)
def test_who_needs_series_says_so_in_one_line(both, read):
    with pytest.raises(FileFormatError, match=r"needs the series of case3.*output\.form = 'full'") as refusal:
        read((both[1],) if read is figure_motion else both[1])
    assert "\n" not in str(refusal.value)


def test_figures_of_a_lean_result_are_none_and_say_so(both):
    plot = both[1].plot
    assert dir(plot) == [] and repr(plot) == "<no figures: the run has no series>"
    assert "<tr>" not in plot._repr_html_()
    with pytest.raises(FileFormatError, match="needs the series of case3"):
        plot()


def test_the_command_line_writes_and_shows_a_lean_result(cli):
    said = cli("run", "impact_pair", "--duration", "2 ms", "--lean", "--out", "lean.nc", "--no-progress")
    assert said.code == 0, said.err
    assert cli("info", "lean.nc").code == 0
    refused = cli("plot", "lean.nc", "--out", "figures")
    assert refused.code == 2 and "needs the series" in refused.err and len(refused.err.splitlines()) == 1


def test_a_result_holds_what_its_schema_says(both):
    for variable in both[0].data.data_vars.values():
        declared = VARIABLES[variable.name]
        assert variable.dims == declared.dims
        assert variable.attrs["units"] == declared.units and variable.attrs["long_name"] == declared.meaning


def test_contacts_say_where_they_are(both):
    data = both[0].data
    for name, joint, kind, end in zip(
        *(data[of].values for of in ("contact", "contact_joint", "contact_kind", "contact_end")), strict=True
    ):
        assert name == f"{joint}.{kind}{end}"
    assert list(data["contact_kind"].values) == ["radial", "radial", "axial", "axial"]
