"""Records from files: CSV, NetCDF and MAT alike, and what is wrong with them in one line, before any run."""

import numpy as np
import pytest
import xarray as xr
from scipy.io import savemat

from antenna_pin.errors import AntennaPinError, ScenarioError, UnknownNameError
from antenna_pin.studies.fit import Problem, load_fit

from .conftest import ANGLE, TIME, closed_form, problem_of


def test_files_of_all_kinds_are_one_record(write, tmp_path):
    from_text = Problem(write())
    xr.Dataset({"angle": ("time", ANGLE)}, {"time": TIME}).to_netcdf(tmp_path / "swing.nc", engine="h5netcdf")
    savemat(tmp_path / "swing.mat", {"rig": {"t": TIME * 1e3, "angle": np.degrees(ANGLE)}})
    from_netcdf = problem_of(tmp_path, name="swing.nc")
    from_mat = problem_of(
        tmp_path,
        name="swing.mat",
        record='time = "rig.t"\ntime_unit = "ms"',
        column='column = "rig.angle"\nunit = "deg"',
    )
    first = from_text.residuals(from_text.start)
    np.testing.assert_array_equal(from_netcdf.residuals(first[:0].tolist() + [30.0]), first)
    # Degrees and milliseconds there and back: round-off of 1 over a noise of 1e-4.
    np.testing.assert_allclose(from_mat.residuals([30.0]), first, atol=1e-9)


def test_a_window_and_skipped_rows_are_left_out(write):
    columns = {"angle": ANGLE.copy()}
    columns["angle"][50] = np.nan
    problem = Problem(write(columns=columns, record='window = ["0.1 s", "0.5 s"]\ngaps = "skip"'))
    seen = problem.predictions(problem.start)
    assert seen.sizes["row"] == 80  # 0.1 to 0.5 s in steps of 5 ms are 81, less one
    assert (float(seen["at"][0]), float(seen["at"][-1])) == (0.1, 0.5)


def spoilt(index, value):
    angle = ANGLE.copy()
    angle[index] = value
    return {"angle": angle}


def times(change):
    time = TIME.copy()
    change(time)
    return time


def swapped(time):
    time[[20, 21]] = time[[21, 20]]


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (
            {"columns": spoilt(7, np.nan)},
            "angle must be a number in each row, got none in row 8, at 0.035 s; give a ",
        ),
        (
            {
                "time": np.delete(TIME, slice(50, 60)),
                "columns": {"angle": closed_form(np.delete(TIME, slice(50, 60)))},
            },
            "must have no gaps, got none between 0.245 s and 0.3 s in rows 0.005 s apart; give a window, or",
        ),
        ({"time": times(swapped)}, "time must rise from row to row, got 0.1 s after 0.105 s in row 22"),
        (
            {"column": 'unit = "mm"'},
            "records.swing.columns.angle.unit must be that of an angle [rad], got 'mm'",
        ),
        ({"record": 'time_unit = "kg"'}, "records.swing.time_unit must be that of a time [s], got 'kg'"),
        ({"record": 'clock_shift = "0.5 s"'}, "must end with the run, at 1 s, or before, got a row at 1.5 s"),
        (
            {"record": 'clock_shift = "-0.5 s"'},
            "must begin at the run's start, 0 s, or later, got a row at -0.5 s",
        ),
        (
            {"record": 'window = ["2 s", "3 s"]'},
            "window must hold 2 rows at least of 0 s to 1 s, got 2 s to 3 s",
        ),
        (
            {"column": 'filter = { corner = "1 kHz" }'},
            "angle.filter.corner must be at most half of the record's 200 rows per second, got 1000 Hz; give",
        ),
        ({"column": 'column = "angel"'}, "swing.csv: column 'angel' is unknown; did you mean angle?"),
        ({"record": 'time = "clock"'}, "swing.csv: column 'clock' is unknown"),
        (
            {"record": 'delimiter = ";"'},
            "the names of columns must be in the first line that counts, got time, angle in line 1; "
            'give delimiter = ","',
        ),
    ],
)
def test_bad_records_are_refused_in_one_line(write, made, words):
    with pytest.raises(AntennaPinError) as refused:
        Problem(write(**made))
    assert words in str(refused.value) and "\n" not in str(refused.value)


def test_what_is_no_number_in_a_text_is_named_with_its_line(write, tmp_path):
    write()
    lines = (tmp_path / "swing.csv").read_text().splitlines()
    lines[3] = '0.01,"0,09"'
    (tmp_path / "swing.csv").write_text("\n".join(lines))
    with pytest.raises(
        ScenarioError, match="swing.csv: line 4: angle must be a number, got '0,09'; a decimal comma"
    ):
        problem_of(tmp_path)
    lines[3] = "0.01,0.1,7"
    (tmp_path / "swing.csv").write_text("\n".join(lines))
    with pytest.raises(ScenarioError, match="swing.csv: line 4: must have 2 values, got 3"):
        problem_of(tmp_path)
    write()
    (tmp_path / "swing.csv").unlink()
    with pytest.raises(
        ScenarioError, match="records.swing.file: .*no such file; paths start at the fit file's folder"
    ):
        problem_of(tmp_path)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (
            {"parameters.stiffness.key": "springs.hinge.stifness"},
            "springs.hinge.stifness is unknown; did you mean stiffness?",
        ),
        (
            {"parameters.stiffness.start": "30 N"},
            "parameters.stiffness.between[0] must be of start's unit [N], got '1 N*m/rad'",
        ),
        (
            {"parameters.stiffness.start": "200 N*m/rad"},
            "parameters.stiffness.start must be within the bounds",
        ),
        ({"parameters.stiffness.key": "records.swing.gain"}, "must be records.NAME.clock_shift, or"),
        ({"parameters.stiffness.key": "records.swung.clock_shift"}, "unknown; did you mean swing?"),
        (
            {"records.swing.columns.angle.sensor": "encoder"},
            "resolution is missing; a sensor of kind encoder must have it",
        ),
        ({"records.swing.columns.angle.link": "bar"}, "link must be left out of a sensor of kind variable"),
        (
            {"records.swing.columns.angle.of": "motion_angle[bar]"},
            "columns.angle.of: quantity motion_angle[bar]: joint 'bar' is",
        ),
        ({"parameters.stiffness.records": ["swung"]}, "did you mean swing?"),
        (
            {"records.swing.columns.angle.compare": "spectrum"},
            'spectrum is missing; compare = "spectrum" must have it',
        ),
        (
            {"records.swing.columns.angle.sd": "1 mm"},
            "columns.angle.sd must be an angle [rad], got '1 mm' (length)",
        ),
    ],
)
def test_a_fits_file_is_refused_in_one_line(write, settings, words):
    folder = write().folder
    with pytest.raises((ScenarioError, UnknownNameError)) as refused:
        Problem(load_fit(folder / "fit.fit.toml", settings))
    assert words in str(refused.value) and "\n" not in str(refused.value)
