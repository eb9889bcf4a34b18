"""Files as loggers, spreadsheets and MATLAB lay them out: each the same record as the plain one."""

import datetime

import numpy as np
import pytest
import xarray as xr

from antenna_pin.errors import AntennaPinError

from .conftest import ANGLE, TIME, data_of, matlab_7_3, problem_of


def comma(number, digits=12):
    return f"{number:.{digits}f}".replace(".", ",")


def logger():
    """Return what a data logger with a comma for a point writes: lines on itself, names, units, rows."""
    head = ["Recorder;3.1;Kanal;2", "Prüfstand;Nr. 7", "", "Zeit;Temperatur;Winkel;", "[ms];[°C];[deg];"]
    rows = [
        f"{comma(1e3 * t)};{comma(20.5)};{comma(np.degrees(a), 15)};"
        for t, a in zip(TIME, ANGLE, strict=True)
    ]
    return "\r\n".join([*head, *rows]) + "\r\n"


LOGGER = 'delimiter = ";"\ndecimal = ","\nskip = 3\nunits_row = true\ntime = "Zeit"'


@pytest.mark.parametrize("encoding", ["latin-1", "utf-16", "utf-8"])
def test_a_loggers_text_is_read_with_its_units(tmp_path, encoding):
    record = f'{LOGGER}\nencoding = "{encoding}"'
    problem = problem_of(tmp_path, logger(), encoding=encoding, record=record, column='column = "Winkel"')
    time, angle = data_of(problem)
    # Written with 12 digits of ms and 15 of degrees.
    np.testing.assert_allclose(time, TIME, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(angle, ANGLE, rtol=0.0, atol=1e-15)


def test_a_text_of_blanks_without_names_or_times(tmp_path):
    """Rows that begin and end with blanks, behind remarks, at an even rate."""
    rows = "".join(f"  {k:4d}   {a:.17g}  \n" for k, a in enumerate(ANGLE))
    problem = problem_of(
        tmp_path, f"% a remark\n{rows}", "swing.dat",
        record='delimiter = " "\ncomment = "%"\nnames = ["row", "angle"]\nrate = "200 Hz"',
    )  # fmt: skip
    time, angle = data_of(problem)
    np.testing.assert_array_equal(time, np.arange(201) / 200.0)
    np.testing.assert_array_equal(angle, ANGLE)


@pytest.mark.parametrize(
    ("pattern", "given", "digits"),
    [
        ("iso", "%Y-%m-%d %H:%M:%S", 9),
        ("iso", "%Y-%m-%dT%H:%M:%S+02:00", 0),
        ("%d.%m.%Y %H:%M:%S,%f", "%d.%m.%Y %H:%M:%S", 7),
        ("%H:%M:%S", "%H:%M:%S", 3),
    ],
)
def test_time_stamps_count_from_the_first_row(tmp_path, pattern, given, digits):
    """Over a change of second, to as many digits as are written: Python's own reading ends at six."""
    begin = datetime.datetime(2026, 5, 4, 23, 58, 59)
    sign = "," if "," in pattern else "."
    lines = ["clock\tangle"]
    for k, angle in enumerate(ANGLE):
        nanoseconds = (k * 5_000_000 if digits else k * 1_000_000_000) + 120_000_000 * (digits > 0)
        second = begin + datetime.timedelta(seconds=nanoseconds // 10**9)
        stamp = second.strftime(given)
        if digits:
            stamp += f"{sign}{nanoseconds % 10**9:09d}"[: digits + 1]
        lines.append(f"{stamp}\t{angle:.17g}")
    record = f'delimiter = "\\t"\ntime = "clock"\ntime_format = "{pattern}"'
    more = "" if digits else '\n[records.swing.set]\nduration = "201 s"\n'
    problem = problem_of(tmp_path, "\n".join(lines), record=record + more)
    time, angle = data_of(problem)
    # A difference of fractions of a second.
    np.testing.assert_allclose(time, TIME if digits else np.arange(201.0), rtol=0.0, atol=1e-15)
    np.testing.assert_array_equal(angle, ANGLE)


def test_matlab_files_of_version_7_3_are_read(tmp_path):
    """HDF5 with a row of user's bytes in front; vectors have two dimensions, structures are groups."""

    def write(path):
        with matlab_7_3(path) as file:
            rig = file.create_group("rig")
            rig.attrs["MATLAB_class"] = np.bytes_("struct")
            rig["t"], rig["angle"] = TIME[None, :] * 1e3, ANGLE[:, None]
            file["title"] = np.frombuffer(b"swing", dtype="u1").astype("u2")
            for name, of in (("rig/t", "double"), ("rig/angle", "double"), ("title", "char")):
                file[name].attrs["MATLAB_class"] = np.bytes_(of)
            file.create_group("#refs#")

    record = 'time = "rig.t"\ntime_unit = "ms"'
    problem = problem_of(tmp_path, write, "swing.mat", record=record, column='column = "rig.angle"')
    time, angle = data_of(problem)
    np.testing.assert_allclose(time, TIME, rtol=2e-16)  # thousand times and a thousandth
    np.testing.assert_array_equal(angle, ANGLE)
    with pytest.raises(AntennaPinError, match=r"swing.mat: column 'title' is unknown; known: rig.angle, "):
        problem_of(tmp_path, write, "swing.mat", record=record, column='column = "title"')


def test_units_and_dates_of_netcdf_files_count(tmp_path):
    def write(path):
        when = np.datetime64("2026-05-04T10:00:00") + (TIME * 1e9).astype("timedelta64[ns]")
        angle = ("time", np.degrees(ANGLE), {"units": "deg"})
        xr.Dataset({"angle": angle}, {"time": when}).to_netcdf(path, engine="h5netcdf")

    time, angle = data_of(problem_of(tmp_path, write, "swing.nc"))
    np.testing.assert_allclose(time, TIME, rtol=0.0, atol=1e-9)  # whole nanoseconds
    np.testing.assert_allclose(angle, ANGLE, rtol=4e-16)  # degrees and back


@pytest.mark.parametrize(
    ("made", "words"),
    [
        ({"record": ""}, "swing.csv is not UTF-8 text (byte 24); give encoding = "),
        (
            {"record": 'encoding = "latin-1"\ntime = "Zeit"'},
            "the names of columns must be in the first line that counts, got Zeit, Winkel in line 4; give "
            'delimiter = ";" and skip = 3',
        ),
        (
            {"record": LOGGER.replace('decimal = ","', 'decimal = "."') + '\nencoding = "latin-1"'},
            "line 6: Zeit must be a number, got '0,000000000000'; ",
        ),
        (
            {"record": LOGGER.replace("units_row = true", "") + '\nencoding = "latin-1"'},
            "line 5: Zeit must be a number, got '[ms]'; if it is a unit, give units_row = true",
        ),
        (
            {"record": LOGGER + '\nencoding = "latin-1"', "column": 'column = "Temperatur"'},
            "records.swing.columns.angle: the file's unit must be that of an angle [rad], got '°C'; "
            "known are rad, deg, arcmin and others; give its unit ",
        ),
        ({"record": LOGGER + '\nencoding = "latin1000"'}, "encoding must be a text encoding of Python"),
        ({"record": 'delimiter = ","\ndecimal = ","'}, "delimiter must differ from decimal, got ','"),
        ({"record": 'rate = "1 kHz"\ntime = "Zeit"'}, "time must be left out with rate"),
        ({"record": 'time_format = "iso"\ntime_unit = "s"'}, "time_unit must be left out with time_format"),
        (
            {"record": LOGGER + '\nencoding = "latin-1"\ntime_format = "iso"'},
            "line 6: Zeit must be a time stamp of the time_format ISO 8601, got '0.000000000000'",
        ),
    ],
)  # fmt: skip
def test_what_does_not_fit_the_file_is_said_in_one_line(tmp_path, made, words):
    with pytest.raises(AntennaPinError) as refused:
        problem_of(tmp_path, logger(), encoding="latin-1", **({"column": 'column = "Winkel"'} | made))
    assert words in str(refused.value) and "\n" not in str(refused.value)


def test_names_in_a_remark_are_those_of_the_columns(tmp_path):
    """As numpy.savetxt writes them if it is not told otherwise."""

    def write(path):
        np.savetxt(path, np.column_stack([TIME, ANGLE]), delimiter=",", header="time,angle")

    for record in ("", 'names = ["time", "angle"]'):
        _, angle = data_of(problem_of(tmp_path, write, record=record))
        np.testing.assert_array_equal(angle, ANGLE)


def test_delimiter_decimal_sign_and_units_are_found_out(tmp_path):
    """A heading's unit is the file's; ``unit`` comes before it."""
    rows = "".join(
        f"{comma(1e3 * t)};{comma(np.degrees(a), 15)};\n" for t, a in zip(TIME, ANGLE, strict=True)
    )
    content = f"time (ms);Angle [deg];\n{rows};;\n"
    time, angle = data_of(problem_of(tmp_path, content))
    np.testing.assert_allclose(time, TIME, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(angle, ANGLE, rtol=0.0, atol=1e-15)
    content = content.replace("[deg]", "[furlongs]")
    _, angle = data_of(problem_of(tmp_path, content, column='unit = "deg"'))
    np.testing.assert_allclose(angle, ANGLE, rtol=0.0, atol=1e-15)


def test_what_is_of_texts_is_refused_beside_other_files(tmp_path):
    def write(path):
        xr.Dataset({"angle": ("time", ANGLE)}, {"time": TIME}).to_netcdf(path, engine="h5netcdf")

    with pytest.raises(AntennaPinError, match="delimiter must be left out for swing.nc, which is no t"):
        problem_of(tmp_path, write, "swing.nc", record='decimal = ","\ndelimiter = ";"')
