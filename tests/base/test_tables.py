"""Tables of numbers from text: one course as spreadsheets and programs write it, and what is refused."""

import csv
import io
import json
import math
import re
import shutil
import subprocess
from pathlib import Path

import pytest

import antenna_pin
from antenna_pin import load_scenario
from antenna_pin.base.files import marked_encoding
from antenna_pin.base.tables import BadTableError, TextLayout, read_cells, write_csv
from antenna_pin.errors import ScenarioError
from antenna_pin.scenario._layers import read_table

TIMES = (0.0, 0.05, 0.1, 0.15)
VALUES = (0.0, 0.0377, -0.0748, 0.1104)
ROWS = list(zip(("0.00", "0.05", "0.10", "0.15"), ("0.0000", "0.0377", "-0.0748", "0.1104"), strict=True))
COLUMNS, UNITS = ("time", "values"), ("s", ("rad", "m"))


def rows(sep=",", form="{}", rows=ROWS):
    return "".join(sep.join(form.format(cell) for cell in row) + "\n" for row in rows)


def comma(text):
    return text.replace(".", ",")


@pytest.mark.parametrize(
    "text",
    [
        "time,values\n" + rows(),
        "Time,VALUES\n" + rows(),
        '"time","values"\n' + rows(form='"{}"'),
        "time, values\n" + rows(", "),
        "time\tvalues\n" + rows("\t"),
        "  time   values\n" + rows("    "),
        "time;values\n" + comma(rows(";")),
        "time values\n" + comma(rows(" ")),
        "time\tvalues\n" + comma(rows("\t")),
        "time [s];values [m]\n" + comma(rows(";")),
        "time [s],values [m]\n" + rows(),
        "time [s]  values [m]\n" + rows("  "),
        "Time/s,Values / m\n" + rows(),
        "time (s)\tvalues (m)\n" + rows("\t"),
        "time,values\ns,m\n" + rows(),
        "time,values\n[s],[m]\n" + rows(),
        "time,values,\n" + rows().replace("\n", ",\n"),
        "time,values\n" + rows() + "\n\n,\n",
        "sep=,\ntime,values\n" + rows(),
        "sep=;\n" + "time;values\n" + comma(rows(";")),
        "# time,values\n" + rows(),
        "# made on a rig\n# time values\n" + rows(" "),
        rows(),
        comma(rows(";")),
        "time,values\n" + rows(form="{}D+00"),
        "time,current,values\n" + "".join(f"{t},0.1,{x}\n" for t, x in ROWS),
        ",time,values\n" + "".join(f"{k},{t},{x}\n" for k, (t, x) in enumerate(ROWS)),
        "values,time\n" + "".join(f"{x},{t}\n" for t, x in ROWS),
        "\ufefftime,values\r\n" + rows().replace("\n", "\r\n"),
        "time,values\n\n# a remark\n" + rows(),
    ],
)
def test_one_course_however_it_is_written(text):
    assert read_table(text, COLUMNS, UNITS)[0] == (TIMES, VALUES)


@pytest.mark.parametrize(
    ("header", "motion", "time", "value"),
    [
        ("time [ms],values [mm]", "translation", 1e-3, 1e-3),
        ("Time/ms;Values/deg", "rotation", 1e-3, math.pi / 180),
        ("time (min)\tvalues (°)", "rotation", 60.0, math.pi / 180),
        ("time,values [µm]", "translation", 1.0, 1e-6),
        ("time,values", None, 1.0, 1.0),
    ],
)
def test_units_of_the_header_are_used(header, motion, time, value):
    """And they say whether the joint turns or slides, as text in a scenario does."""
    sep = next(sign for sign in ";\t," if sign in header)
    (times, values), said = read_table(f"{header}\n{rows(sep)}", COLUMNS, UNITS)
    assert said == motion
    assert times == pytest.approx([time * t for t in TIMES], rel=2e-16)
    assert values == pytest.approx([value * x for x in VALUES], rel=2e-16)


def test_cells_units_and_names_of_odd_tables():
    """Holes, names with a slash, and units of both kinds of joints."""
    # As text with a unit is: 9.8 times 0.001 is not 0.0098 in floats.
    (_, values), _ = read_table("time,values [mm]\n0,9.8\n1,1.1\n", COLUMNS, UNITS)
    assert values == (0.0098, 0.0011)
    with pytest.raises(
        BadTableError, match=r"torque must be for a turning joint, as angle is, got 'N' \(sliding"
    ):
        read_table("angle [deg],torque [N]\n0,1\n1,2\n", ("angle", "torque"), (("rad", "m"), ("N*m", "N")))
    cells = read_cells("a;b\n1;2\n;\n3;4\n;\n", ("a", "b"), TextLayout(holes=True))
    assert cells.text == {"a": ["1", "", "3"], "b": ["2", "", "4"]}
    assert cells.lines == [2, 3, 4]
    cells = read_cells("time/s,force/left,force/N\n1,2,3\n", ("time", "force/left", "force"))
    assert cells.text == {"time": ["1"], "force/left": ["2"], "force": ["3"]}
    assert cells.units == {"time": "s", "force": "N"}


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("time;values\n0;1,234\n1;5\n", "line 2: values must be a number in one reading, got '1,234'"),
        ("time;values\n0;1,234\n1;1.5\n", "line 2: values must be a finite number, got '1,234'"),
        ("time;values\n0;1,234,567\n1;5\n", "line 2: values must be a finite number, got '1,234,567'"),
        ("time,values\n0,00,0,5\n1,00,0,7\n", "line 2: must have 2 values, got 4; if commas are"),
        ('time,values\n"0,5","0,5"\n', "line 2: time must be a finite number, got '0,5'; a decimal"),
        ("time,values\n0,10 mm\n1,2 mm\n", "line 2: values must be a finite number, got '10 mm'; units"),
        ("time,values\n0,=1+1\n1,2\n", "line 2: values must be a finite number, got '=1+1'"),
        ("time,values\n0,1\n0.5,nan\n", "line 3: values must be a finite number, got 'nan'"),
        ("time,values\n0,1\n0,2\n", "line 3: time must increase strictly, got 0.0 after 0.0"),
        ("time,values\n1,1\n0,2\n", "line 3: time must increase strictly, got 0.0 after 1.0"),
        ("time,values,values\n0,1,2\n1,2,3\n", "line 1: values must be the name of one column, got it of"),
        ("time,Values,VALUES\n0,1,2\n1,2,3\n", "line 1: values must be the name of one column, got it of"),
        ("0,1,2\n1,2,3\n", "line 1: the header must have time,values, got '0,1,2'"),
        ("time [N],values\n0,1\n1,2\n", "the unit of column time must be that of a time [s], got 'N'"),
        ("time,values [kg]\n0,1\n1,2\n", "the unit of column values must be that of an angle [rad] or"),
        ("time [furlongs],values\n0,1\n1,2\n", "the unit of column time must be that of a time [s]"),
        ("time,values\n0,1\n1,2,3\n", "line 3: must have 2 values, got 3"),
        ("time,values\n", "line 1: must have at least 2 rows of numbers, got 0"),
    ],
)  # fmt: skip
def test_what_can_be_read_in_two_ways_or_not_at_all_is_refused(text, says):
    with pytest.raises(BadTableError) as refused:
        read_table(text, COLUMNS, UNITS)
    assert str(refused.value).startswith(says) and "\n" not in str(refused.value)


URDF = """<robot name="crane"><link name="rail"/>
<joint name="trolley" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>
<limit lower="-9" upper="9" effort="1e6" velocity="99"/></joint>
<link name="cart"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
</link></robot>"""
SCENARIO = """format = 1
duration = "0.1 s"
[mechanism]
urdf = "a.urdf"
base = "fixed"
{}
"""
REFERENCE = """[references.course]
kind = "table"
file = "course.csv"
[drives.trolley]
kind = "motion"
follows = "course"
"""


@pytest.fixture
def scenario(tmp_path):
    (tmp_path / "a.urdf").write_text(URDF)
    (tmp_path / "scenario.toml").write_text(SCENARIO.format(REFERENCE))
    return tmp_path


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_scenario_takes_a_table_of_any_encoding_with_a_mark(scenario, encoding):
    data = ("time [s];values [mm]\r\n" + comma(rows(";"))).encode(encoding)
    (scenario / "course.csv").write_bytes(data)
    assert marked_encoding(data) == (None if encoding == "utf-8" else encoding)
    course = load_scenario(scenario / "scenario.toml").references["course"]
    assert course.time == TIMES and course.values == tuple(float(f"{x}e-3") for x in VALUES)
    assert course.motion == "translation"


def test_a_unit_for_turns_is_refused_of_a_joint_that_slides(scenario):
    from antenna_pin import build_system

    (scenario / "course.csv").write_text("time,values [deg]\n" + rows())
    with pytest.raises(ScenarioError, match="course") as refused:
        build_system(load_scenario(scenario / "scenario.toml"))
    assert "turn" in str(refused.value) and "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("unit", "scale", "of", "factor"),
    [
        ("g", "", "acceleration", 9.80665),
        ("mm/s", "", "velocity", 1e-3),
        ("", "scale = 2", "displacement", 1.0),
    ],
)
def test_a_shaken_bases_course_has_the_unit_of_what_it_is_of(scenario, unit, scale, of, factor):
    shake = f'[shake.x]\nkind = "table"\nof = "{of}"\ndirection = [1, 0, 0]\nfile = "course.csv"\n{scale}\n'
    (scenario / "scenario.toml").write_text(SCENARIO.format(shake))
    (scenario / "course.csv").write_text(f"time,course{f' [{unit}]' if unit else ''}\n{rows()}")
    (course,) = load_scenario(scenario / "scenario.toml").shake.values()
    assert course.course == pytest.approx([factor * x for x in VALUES], rel=2e-16)
    if scale:
        (scenario / "course.csv").write_text(f"time,course [mm]\n{rows()}")
        with pytest.raises(ScenarioError, match="column course must be that of a pure number, got 'mm'"):
            load_scenario(scenario / "scenario.toml")


FORMULAS = ["=1+1", "+a", "-b", "@SUM(A1)", "\t=1", "\r=1", "\n=1", '=cmd|"/c calc"']


def test_no_cell_of_a_csv_file_is_a_formula():
    """Text that a spreadsheet evaluates has an apostrophe in front; numbers, as text too, stay."""
    stream = io.StringIO(newline="")
    values = [-1.5, "-1.5", -2, "+3e4", "hinge"]
    write_csv(stream, FORMULAS, [FORMULAS, [[text] for text in FORMULAS], values])
    head, texts, lists, numbers = csv.reader(io.StringIO(stream.getvalue(), newline=""))
    assert head == texts == lists == [f"'{text}" for text in FORMULAS]
    assert numbers == ["-1.5", "-1.5", "-2", "+3e4", "hinge"]


def test_a_column_is_read_by_the_name_that_it_was_written_by():
    stream = io.StringIO(newline="")
    write_csv(stream, ["time", "=1+1"], [(0.0, -0.25), (0.1, 0.5)])
    assert read_cells(stream.getvalue(), ["time", "=1+1"]).text["=1+1"] == ["-0.25", "0.5"]


def test_csv_is_written_in_one_place():
    """In Python by :func:`write_csv`; in the page of a report by its twin, which names the same signs."""
    root = Path(antenna_pin.__file__).parent
    writer = re.compile(r"csv\.(writer|DictWriter)")
    assert [file for file in root.rglob("*.py") if writer.search(file.read_text())] == [
        root / "base" / "tables.py"
    ]
    script = (root / "show/report/templates/unpack.js").read_text()
    line = re.search(r"const inert = .*", script)[0]
    if node := shutil.which("node"):
        said = f"{line} console.log(JSON.stringify({json.dumps(FORMULAS)}.map(inert)))"
        made = subprocess.run([node, "-e", said], capture_output=True, text=True, check=True).stdout
        assert json.loads(made) == [f"'{text}" for text in FORMULAS]
