"""Universal files (58) as records; written by the library that reads them."""

import numpy as np
import pytest

from antenna_pin.errors import AntennaPinError

from .conftest import closed_form, data_of, problem_of

pyuff = pytest.importorskip("pyuff")

TIME = np.arange(201) * 0.005
ANGLE = closed_form(TIME)


def function(node, way, data, unit="NONE", kind=1):
    """Return a set of number 58: of even times, in double precision."""
    return {
        "type": 58, "binary": 0, "func_type": kind, "rsp_node": node, "rsp_dir": way, "ref_node": 1,
        "ref_dir": 0, "id1": "swing", "data": data, "x": TIME, "num_pts": 201, "abscissa_spacing": 1,
        "abscissa_min": 0.0, "abscissa_inc": 0.005, "ord_data_type": 6 if np.iscomplexobj(data) else 4,
        "abscissa_spec_data_type": 17, "abscissa_axis_units_lab": "s", "ordinate_spec_data_type": 8,
        "ordinate_axis_units_lab": unit, "orddenom_spec_data_type": 0,
    }  # fmt: skip


def write(*sets):
    def made(path):
        pyuff.UFF(str(path)).write_sets(list(sets), mode="overwrite")

    return made


def units(code):
    return pyuff.prepare_164(
        units_code=code, units_description="", temp_mode=1, length=1.0, force=1.0, temp=1.0, temp_offset=0.0,
        return_full_dict=True,
    )  # fmt: skip


def write_binary(path, *sets):
    """Write sets whose numbers are bytes behind eleven lines of text; the library's own writer does not."""
    content = b""
    for one in sets:
        write(one)(path)
        head = path.read_bytes().splitlines()[2:13]
        data = one["data"].astype("<f8").tobytes()
        kind = f"    58b     1     2{11:12d}{len(data):12d}{0:6d}{0:6d}{0:12d}{0:12d}"
        content += b"\n".join([b"    -1", kind.encode(), *head, data, b"    -1", b""])
    path.write_bytes(content)


@pytest.mark.parametrize("binary", [False, True], ids=["text", "binary"])
@pytest.mark.parametrize("suffix", [".uff", ".unv"])
def test_functions_of_time_are_columns_by_node_and_direction(tmp_path, binary, suffix):
    sets = [function(3, 1, np.cos(TIME)), function(12, -6, np.degrees(ANGLE), "deg")]
    spectrum = function(12, 2, np.ones(201) + 1j, kind=4)

    def made(path):
        write_binary(path, *sets) if binary else write(*sets, spectrum)(path)

    problem = problem_of(tmp_path, made, f"swing{suffix}", column='column = "12RZ-"')
    time, angle = data_of(problem)
    np.testing.assert_allclose(time, TIME, rtol=0.0, atol=1e-7)  # an increment in single precision
    # Text has 13 digits or fewer of each number, as the format says.
    np.testing.assert_allclose(angle, ANGLE, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize(
    ("sets", "column", "words"),
    [
        ([function(3, 1, ANGLE)], "12RZ-", "swing.uff: column '12RZ-' is unknown; known: 3X+"),
        (
            [function(3, 4, ANGLE), function(3, 4, ANGLE)],
            "3RX+",
            "swing.uff: 3RX+ must be one function of time, got sets 1 and 2; give a file with one of them",
        ),
        (
            [function(3, 4, ANGLE, kind=4)],
            "3RX+",
            "swing.uff must hold a function of time (58, time response), got sets of 58",
        ),
        (
            [units(5), function(3, 4, ANGLE)],
            "3RX+",
            "columns.angle: the file's unit must be that of an angle [rad], got 'of code 5'; known are rad,",
        ),
        (
            [function(3, 4, ANGLE, "m/s^2")],
            "3RX+",
            "the file's unit must be that of an angle [rad], got 'm/s^2'; give its unit with the key unit",
        ),
    ],
)
def test_what_is_wrong_with_a_universal_file_is_one_line(tmp_path, sets, column, words):
    with pytest.raises(AntennaPinError) as refused:
        problem_of(tmp_path, write(*sets), "swing.uff", column=f'column = "{column}"')
    assert words in str(refused.value) and "records.swing" in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("content", ["", "time,angle\n0,1\n", "    -1\n    58\nnothing\n    -1\n"])
def test_what_is_no_universal_file_is_refused(tmp_path, content):
    with pytest.raises(AntennaPinError, match="records.swing: swing.uff ") as refused:
        problem_of(tmp_path, content, "swing.uff", column='column = "1X+"')
    assert "\n" not in str(refused.value)


def test_si_units_of_a_file_are_taken(tmp_path):
    _, angle = data_of(
        problem_of(tmp_path, write(units(1), function(0, 0, ANGLE)), "s.uff", column='column = "0"')
    )
    np.testing.assert_allclose(angle, ANGLE, rtol=0.0, atol=1e-11)
