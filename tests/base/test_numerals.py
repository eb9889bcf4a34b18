"""What is a number in text is the same everywhere: files, tables, quantities, options."""

import pytest
from typer.testing import CliRunner

from antenna_pin.apps.cli import app
from antenna_pin.base.readable import bare, decimal_in, whole_in
from antenna_pin.base.tables import BadTableError
from antenna_pin.base.units import QuantityError, quantity
from antenna_pin.mechanism.flexible.modal_files import BadModalTableError, read_modal_table
from antenna_pin.scenario._layers import read_table

CSV = "frequency,tx,ty,tz,rx,ry,rz\n{},1,0,0,0,0,0\n"
NONE = [
    "1_0",
    "\u0661\u0668",
    "\uff11",
    "infinity",
    "-inf",
    "nan",
    "2,000",
    "0x10",
    "0x1p3",
    "1e",
    "1e400",
    "",
]
NONE += ["", "1 2"]


@pytest.mark.parametrize("text", NONE)
def test_what_is_no_number_is_none_anywhere(text):
    assert decimal_in(text) is None
    assert whole_in(text) is None
    assert bare(text) == text
    with pytest.raises(QuantityError):
        quantity(text or "x", "s", "place")
    with pytest.raises(BadTableError, match="line 3: time must be a finite number"):
        read_table(f'time,torque\n0,1\n"{text}",1\n', ("time", "torque"), ("s", "N*m"))
    with pytest.raises(BadModalTableError, match="line 2: frequency must be a finite number"):
        read_modal_table(CSV.format(f'"{text}"'))


@pytest.mark.parametrize("text", ["1_0", "\uff11", "infinity", "nan", "2,000", "1e400"])
def test_what_is_no_number_is_no_option(text):
    for arguments in (
        ("lyapunov", "pendulum", "--count"),
        ("pointing", "no.nc", "--body", "b", "--confidence"),
        ("contact", "scenarios", "--penetration"),
    ):
        ended = CliRunner().invoke(app, [*arguments, text])
        assert ended.exit_code == 2
        assert text in ended.stderr and len(ended.stderr.splitlines()) == 1


@pytest.mark.parametrize("text", ["1", " +1. ", "-.5", "1e3", "1E-400"])
def test_what_is_a_number_is_the_one_of_python(text):
    assert decimal_in(text) == bare(text) == float(text)


def test_ends_of_a_range_may_be_infinite_in_a_urdf_only():
    assert decimal_in("-Infinity", infinite=True) == -float("inf")
    assert decimal_in("nan", infinite=True) is None
