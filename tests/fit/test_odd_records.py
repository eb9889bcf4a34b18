"""Records as they come off a bench: what is wrong with them is one line, with file, place, value, way out."""

import numpy as np
import pytest
import xarray as xr
from scipy.io import savemat

from antenna_pin.errors import AntennaPinError
from antenna_pin.studies.fit import Problem, run_fit

from .conftest import ANGLE, TIME, matlab_7_3, problem_of


def text(time=TIME, angle=ANGLE, head="time,angle"):
    rows = "\n".join(f"{t:.17g},{a:.17g}" for t, a in zip(time, angle, strict=True))
    return f"{head}\n{rows}\n"


def netcdf(path):
    xr.Dataset({"angle": ("sample", ANGLE), "t": ("sample", TIME)}).to_netcdf(path, engine="h5netcdf")


def matlab(path):
    savemat(path, {"angle": ANGLE})


def emptied(*rows):
    angle = ANGLE.copy()
    angle[list(rows)] = np.nan
    return angle


@pytest.mark.parametrize(
    ("content", "parts", "words"),
    [
        (
            text(head="time,angle,angle").replace("\n0,", "\n0,7,", 1),
            {},
            "swing.csv: line 1: angle must be the name of one column, got it of columns 2 and 3; give "
            "each column its own name",
        ),
        ("", {}, "swing.csv must have a header with time, angle, got nothing"),
        ("time,angle\n", {}, "swing.csv must have 2 rows at least, got 0"),
        (
            "time,angle\n0,000,0,1\n0,005,0,2\n",
            {},
            "swing.csv: line 2: must have 2 values, got 4; if commas are in numbers, have the file written "
            "with another delimiter",
        ),
        (
            text(1e3 * TIME),
            {},
            "must end with the run, at 1 s, or before, got a row at 1000 s; give a window, a clock_shift or "
            "a longer duration, or a time_unit if they are no seconds",
        ),
        (
            text(),
            {"record": 'time_unit = "ms"'},
            "records.swing must reach beyond a hundredth of its run of 1 s, got its last row at 0.001 s; "
            "give time_unit or rate as they are, or a shorter duration, or a window",
        ),
        (
            text(angle=emptied(*range(7, 20), 30)),
            {},
            "got none in row 8, at 0.035 s and 13 others up to row 31; give a window, or",
        ),
    ],
    ids=[
        "name twice", "empty", "header only", "decimal commas",
        "ms as s", "s as ms", "holes",
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_text_is_one_line(tmp_path, content, parts, words):
    with pytest.raises(AntennaPinError) as refused:
        problem_of(tmp_path, content, **parts)
    said = str(refused.value)
    assert words in said and "records.swing" in said and "\n" not in said


def test_a_text_of_a_spreadsheet_is_read_with_the_mark_in_front(tmp_path):
    problem = problem_of(tmp_path, "\ufeff" + text())
    np.testing.assert_array_equal(problem.predictions(problem.start)["data"], ANGLE)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
def test_utf_16_is_known_by_the_mark_in_front(tmp_path, encoding):
    """Without one there is nothing to tell it by but its zeros."""
    content = text() if encoding == "utf-16" else "\ufeff" + text()
    problem = problem_of(tmp_path, content, encoding=encoding)
    np.testing.assert_array_equal(problem.predictions(problem.start)["data"], ANGLE)
    bare = "utf-16-le" if encoding == "utf-16" else encoding
    with pytest.raises(AntennaPinError) as refused:
        problem_of(tmp_path, text(), encoding=bare)
    assert "swing.csv" in str(refused.value) and "\n" not in str(refused.value)


@pytest.mark.parametrize(("write", "name"), [(netcdf, "swing.nc"), (matlab, "swing.mat")])
def test_a_file_without_times_says_what_it_has(tmp_path, write, name):
    with pytest.raises(AntennaPinError) as refused:
        problem_of(tmp_path, write, name)
    said = str(refused.value)
    assert f"{name} must have a column of times, got no 'time' but angle" in said
    assert said.endswith("give time, the name of theirs, or rate, how many rows a second has")
    way_out = problem_of(tmp_path, write, name, record='rate = "200 Hz"')
    np.testing.assert_array_equal(way_out.predictions(way_out.start)["data"], ANGLE)


@pytest.mark.parametrize("of_7_3", [False, True])
def test_structures_within_structures_are_read(tmp_path, of_7_3):
    def write(path):
        if not of_7_3:
            savemat(path, {"test": {"rig": {"t": TIME, "angle": ANGLE}, "note": "first"}})
            return
        with matlab_7_3(path) as file:
            rig = file.create_group("test/rig")
            rig["t"], rig["angle"] = TIME[None, :], ANGLE[:, None]

    parts = {"record": 'time = "test.rig.t"', "column": 'column = "test.rig.angle"'}
    problem = problem_of(tmp_path, write, "swing.mat", **parts)
    np.testing.assert_array_equal(problem.predictions(problem.start)["data"], ANGLE)
    with pytest.raises(AntennaPinError, match=r"'test.angle' is unknown; did you mean test.rig.angle\?"):
        problem_of(tmp_path, write, "swing.mat", **(parts | {"column": 'column = "test.angle"'}))


def test_a_sensor_that_is_dead_or_at_its_end_is_noted(write):
    """No curve with noise repeats itself row after row."""
    (dead,) = Problem(write(columns={"angle": np.full(201, 0.02)})).notes
    assert dead.endswith("swing.csv: angle is the same in all 201 rows: is its sensor connected?")
    high = ANGLE >= 0.05
    note = (
        f"note: records.swing: swing.csv: angle stays at its largest value in {np.count_nonzero(high)} "
        f"rows, first from row 1 to {np.flatnonzero(~high)[0]}: if that is as far as its sensor goes, empty "
        'them and give gaps = "skip"'
    )
    found = run_fit(write(columns={"angle": np.minimum(ANGLE, 0.05)}))
    assert found.notes[0] == note and note in found.data().attrs["notes"]


def test_what_only_looks_odd_is_not_noted(write):
    """Four rows alike at the top, many alike on the way."""
    angle = ANGLE.copy()
    angle[1:4] = angle[0]
    angle[100:120] = 0.01
    assert not Problem(write(columns={"angle": angle})).notes


def test_a_servos_log_with_units_in_its_names_is_read(tmp_path):
    """As a public data set of a four-bar linkage lays its records out (DaRUS, doi 10.18419/darus-4152)."""
    head = "% Time s, Goal Current mA, Present Current mA, Present Position rad"
    rows = "\n".join(f"{t:.17g}, 0.0, 2.69, {a:.17g}" for t, a in zip(TIME, ANGLE, strict=True))
    parts = {"record": 'time = "% Time s"', "column": 'column = "Present Position rad"'}
    problem = problem_of(tmp_path, f"{head}\n{rows}\n", "output.00.txt", **parts)
    np.testing.assert_array_equal(problem.predictions(problem.start)["data"], ANGLE)


def test_a_fit_that_is_refused_leaves_nothing_on_the_disk(write, tmp_path):
    """Else the same command, put right, is told of the unfinished part of another fit."""
    with pytest.raises(AntennaPinError, match="must end with the run"):
        run_fit(write(1e3 * TIME, {"angle": ANGLE}), tmp_path / "fit.nc")
    assert not list(tmp_path.glob("fit.nc*"))
    assert run_fit(write(), tmp_path / "fit.nc").converged
