"""Quantities as people write them."""

import math
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from antenna_pin.base import units
from antenna_pin.base.units import QuantityError, any_quantity, describe_unit, matching_unit, quantity, shown
from antenna_pin.errors import ScenarioError

PLACE = "my.toml: clearance.hinge.radial_clearance"

FINITE = st.floats(allow_nan=False, allow_infinity=False)


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [
        (0.2, "m", 0.2),
        (3, "m", 3.0),
        (np.float32(0.5), "m", 0.5),
        (np.int64(7), "kg", 7.0),
        ("0.2 mm", "m", 0.0002),
        ("9.8 mm", "m", 0.0098),  # 9.8 * 0.001 is another float
        ("9.8mm", "m", 0.0098),
        ("  +.5e1   um ", "m", 5e-6),
        ("1 µm", "m", 1e-6),
        ("-3 in", "m", -0.0762),
        ("10 N*m", "N*m", 10.0),
        ("10 N m", "N*m", 10.0),
        ("10 N·m", "N*m", 10.0),
        ("5 s", "s", 5.0),
        ("10 us", "s", 1e-5),
        ("1 kHz", "Hz", 1000.0),
        ("2 1/s", "Hz", 2.0),
        ("207 GPa", "Pa", 207e9),
        ("1e11 N/m**1.5", "N/m**1.5", 1e11),
        ("1e11 N/m^1.5", "N/m**1.5", 1e11),
        ("1e11 N/m**(3/2)", "N/m**1.5", 1e11),
        ("9.81 m/s²", "m/s**2", 9.81),
        ("180 deg", "rad", math.pi),
        ("0.5", "rad", 0.5),  # the radian may be left out
        ("2 1/s", "rad/s", 2.0),
        ("60 rpm", "rad/s", 2.0 * math.pi),
        ("3 N*m", "N*m/rad", 3.0),
        ("0.9", "1", 0.9),
        ("90 %", "1", 0.9),
        ("0.9", "-", 0.9),
        ("7 N/mm", ("N*m/rad", "N/m"), 7000.0),
        ("0 mm", "m", 0.0),
        ("1e-400 m", "m", 0.0),
    ],
)
def test_quantity_is_read_in_si(value, unit, expected):
    # Exact but for the factors with pi, which are rounded once more.
    tolerance = 2e-16 if unit in ("rad", "rad/s") else 0.0
    assert quantity(value, unit, PLACE) == pytest.approx(expected, rel=tolerance, abs=0.0)


@pytest.mark.parametrize(
    ("value", "unit", "reason"),
    [
        ("0.2 N", "m", "must be a length [m], got '0.2 N' (force)"),
        ("0.2", "m", "must be a length [m], got '0.2' (no unit); write '0.2 m'"),
        ("0.2 mmm", "m", "must be a length [m], got '0.2 mmm' (unit 'mmm' is unknown; known are m, mm"),
        (
            "0,2,1 mm",
            "m",
            "must be a length [m], got '0,2,1 mm' (unit ',2,1 mm' is unknown; known are m, mm,",
        ),
        (
            "1,234 mm",
            "m",
            "must be a length [m], got '1,234 mm' (a comma of decimals or of thousands); write 1.234 or 1234",
        ),
        ("3 Nm", "m", "must be a length [m], got '3 Nm' (torque)"),
        ("1 mil", "rad", "must be an angle [rad], got '1 mil' (length)"),
        ("3 rev/min", "Hz", "must be a frequency [Hz], got '3 rev/min' (angular rate)"),
        ("2 lbm*in", "N*m", "must be a torque [N*m], got '2 lbm*in' (kg*m)"),
        ("5 kg", "N", "must be a force [N], got '5 kg' (mass); a weight is 'kgf'"),
        ("5 kg-cm", "N*m", "must be a torque [N*m], got '5 kg-cm' (kg*m); a weight is 'kgf*cm'"),
        ("5 foo", "N*m", "must be a torque [N*m], got '5 foo' (unit 'foo' is unknown; known are N*m, mN*m,"),
        ("short", "m", "must be a length [m], got 'short'; write a number and its unit: '1 m'"),
        ("", "1", "must be a pure number, got ''; write a number"),
        ("1 m +", "m", "must be a length [m], got '1 m +' (unit 'm +' is unknown; known are m, mm"),
        ("3 kg/m**2", "m", "must be a length [m], got '3 kg/m**2' (kg/m**2)"),
        ("3 kg*g", "N", "must be a force [N], got '3 kg*g' (kg**2)"),
        ("3 g", "m", "must be a length [m], got '3 g' (mass)"),
        (True, "m", "must be a length [m], got true"),
        (None, "m", "must be a length [m], got None"),
        ([1.0], "m", "must be a length [m], got [1.0]"),
        ({}, "m", "must be a length [m], got a table"),
        (1j, "m", "must be a length [m], got 1j"),
        (math.nan, "m", "must be a length [m], got nan (not finite)"),
        (-math.inf, "m", "must be a length [m], got -inf (not finite)"),
        ("nan m", "m", "must be a length [m], got 'nan m' (not finite)"),
        ("inf", "1", "must be a pure number, got 'inf' (not finite)"),
        ("1e400 m", "m", "must be a length [m], got '1e400 m' (not finite)"),
        ("1e308 km", "m", "must be a length [m], got '1e308 km' (not finite)"),
        ("60 rpm", "Hz", "must be a frequency [Hz], got '60 rpm' (angular rate)"),
        ("1 rad/s", "Hz", "must be a frequency [Hz], got '1 rad/s' (angular rate)"),
        ("1 kHz", "rad/s", "must be an angular rate [rad/s], got '1 kHz' (frequency)"),
        ("0.9 rad", "1", "must be a pure number, got '0.9 rad' (angle)"),
        ("5 dB", "1", "must be a pure number, got '5 dB' (unit 'dB' is unknown)"),
        ("20 degC", "1/K", "must be a coefficient of thermal expansion [1/K], got '20 degC' (unit 'degC' is"),
        ("1e11 N/m", "N/m**1.5", "must be a stiffness [N/m**1.5], got '1e11 N/m' (stiffness)"),
        (
            "3 m",
            ("N*m/rad", "N/m"),
            "must be a torsional stiffness [N*m/rad] or a stiffness [N/m], got '3 m' (length)",
        ),
        ("2 __import__('os')", "m", "must be a length [m], got \"2 __import__('os')\" (unit"),
        ("x\ny", "m", "must be a length [m], got 'x\\ny'; write a number and its unit: '1 m'"),
    ],
)
def test_what_is_no_quantity_is_refused(value, unit, reason):
    with pytest.raises(QuantityError) as refusal:
        quantity(value, unit, PLACE)
    assert str(refusal.value).startswith(f"{PLACE} {reason}")
    assert "\n" not in str(refusal.value)
    assert str(refusal.value) == f"{PLACE} {refusal.value.reason}"
    assert isinstance(refusal.value, ScenarioError)
    assert isinstance(refusal.value, ValueError)


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [
        ("2 g", "m/s**2", 2 * 9.80665),
        ("0.04 g^2/Hz", "m**2/s**3", 0.04 * 9.80665**2),
        ("0.04 g**2/Hz", "m**2/s**3", 0.04 * 9.80665**2),
        ("2 g", "kg", 2e-3),
    ],
)
def test_g_is_gravity_where_an_acceleration_is_asked_for(value, unit, expected):
    assert quantity(value, unit, PLACE) == pytest.approx(expected, rel=1e-15)  # of the square


_LBF, _OZF, _INCH, _FOOT, _DEG = 4.4482216152605, 4.4482216152605 / 16, 0.0254, 0.3048, math.pi / 180


@pytest.mark.parametrize(
    ("spelled", "unit", "factor"),
    [
        ("Nm, N.m, N·m, N⋅m, N∙m, N-m, N m", "N*m", 1.0),
        ("mNm, mN.m, mN·m, mN-m, mN m", "N*m", 1e-3),
        ("kNm", "N*m", 1e3),
        ("Ncm, N-cm", "N*m", 1e-2),
        ("Nmm", "N*m", 1e-3),
        ("Nm/rad", "N*m/rad", 1.0),
        ("Nm/deg, N·m/°", "N*m/rad", 1 / _DEG),
        ("Nm/arcmin", "N*m/rad", 60 / _DEG),
        ("Nms/rad, Nm·s/rad, N.m.s/rad, Nm s/rad", "N*m*s/rad", 1.0),
        ("lbf*in, in-lb, in-lbf, lb-in, in·lb, inlb", "N*m", _LBF * _INCH),
        ("lb-ft, ft-lb, ftlb, ft-lbf", "N*m", _LBF * _FOOT),
        ("oz-in, ozf-in, in-oz, ozin", "N*m", _OZF * _INCH),
        ("lb, lbs, lbf", "N", _LBF),
        ("lb/in", "N/m", _LBF / _INCH),
        ("kgf, kp", "N", 9.80665),
        ("kgfcm, kgf-cm", "N*m", 0.0980665),
        ("lb*in^2, lb-in², lbm*in**2, lb in2", "kg*m**2", 0.45359237 * _INCH**2),
        ("lbm, lb", "kg", 0.45359237),
        ("gcm2, g-cm², gcm^2, gcm², g·cm², g cm2", "kg*m**2", 1e-7),
        ("kgm2, kg*m2, kg.m2, kg·m², kg m²", "kg*m**2", 1.0),
        ("kg/m3, kg/m³, kg m-3", "kg/m**3", 1.0),
        ("m/s2, m·s⁻², m s-2", "m/s**2", 1.0),
        ("g²/Hz, g2/Hz", "m**2/s**3", 9.80665**2),
        ("(m/s²)²/Hz, (m/s2)^2/Hz", "m**2/s**3", 1.0),
        ("(rad/s²)²/Hz, rad²/s⁴/Hz, rad2/s4/Hz", "rad**2/s**3", 1.0),
        ("(deg/s²)²/Hz, (deg/s2)^2/Hz", "rad**2/s**3", _DEG**2),
        ("rev", "rad", math.tau),
        ("rev/min, rpm, r/min, RPM", "rad/s", math.tau / 60),
        ("mil", "m", 2.54e-5),
        ("ksi", "Pa", 1e3 * _LBF / _INCH**2),
        ("Msi", "Pa", 1e6 * _LBF / _INCH**2),
        ("µm, μm, um", "m", 1e-6),
        ("meter per second, meter/second", "m/s", 1.0),
    ],
)
def test_units_are_understood_as_data_sheets_spell_them(spelled, unit, factor):
    """A pound or an ounce is a weight where a force is asked for, a mass where a mass is."""
    for name in spelled.split(", "):
        for blank in ("", " ", "\N{THIN SPACE}", "\N{NO-BREAK SPACE}"):
            # Factors of pint are products of some floats.
            assert quantity(f"3{blank}{name}", unit, PLACE) == pytest.approx(3 * factor, rel=1e-15), name


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("0,2 mm", 0.2), ("1,25 mm", 1.25), ("-0,5mm", -0.5), ("0,125 mm", 0.125), ("1,2345 mm", 1.2345),
        ("1,5e3 mm", 1500.0), ("\N{MINUS SIGN}5 mm", -5.0), ("0.2 mil", 0.2 * 0.0254),
    ],
)  # fmt: skip
def test_a_decimal_comma_is_one_where_it_can_be_nothing_else(text, number):
    assert quantity(text, "m", PLACE) == float(Decimal(repr(number)) / 1000)
    assert any_quantity(text) == (quantity(text, "m", PLACE), "m")


def test_a_spelling_is_the_same_quantity_where_no_unit_is_asked_for():
    assert any_quantity("3 Nm") == any_quantity("3 N*m") == (3.0, "N*m")
    assert any_quantity("2 gcm2") == (2e-7, "kg*m**2")
    for text, unit in (
        ("5 in-lb", "N*m"),
        ("5 lb/in", "N/m"),
        ("5 lb-in²", "kg*m**2"),
        ("5 g²/Hz", "m**2/s**3"),
    ):
        assert any_quantity(text) == (quantity(text, unit, PLACE), unit)


def test_a_huge_integer_is_not_finite():
    with pytest.raises(QuantityError, match=r"\(not finite\)"):
        quantity(10**400, "m", PLACE)


@given(number=FINITE)
def test_bare_numbers_are_taken_as_they_are(number):
    assert quantity(number, "m", PLACE) == number


@given(number=FINITE)
def test_si_text_reads_back_exactly(number):
    assert quantity(f"{number!r} N/m**1.5", "N/m**1.5", PLACE) == number


@given(
    number=st.decimals(-(10**6), 10**6, allow_nan=False, places=9),
    unit=st.sampled_from([("mm", -3), ("um", -6), ("km", 3), ("m", 0), ("cm", -2)]),
)
def test_decimal_prefixes_are_rounded_once(number, unit):
    name, power = unit
    assert quantity(f"{number} {name}", "m", PLACE) == float(number * Decimal(10) ** power)


@given(number=st.floats(-1e200, 1e200), factor=st.sampled_from([("inch", "0.0254"), ("h", "3600")]))
def test_units_convert_by_their_definition(number, factor):
    name, si = factor
    wanted = "m" if name == "inch" else "s"
    exact = Fraction(repr(number)) * Fraction(si)
    assert quantity(f"{number!r} {name}", wanted, PLACE) == float(exact)


@settings(max_examples=40)
@given(text=st.text(max_size=20))
def test_any_text_is_read_or_refused_in_one_line(text):
    try:
        number = quantity(text, "m", PLACE)
    except QuantityError as refusal:
        assert len(str(refusal).splitlines()) == 1
    else:
        assert math.isfinite(number)


@pytest.mark.parametrize(
    ("value", "expected"), [("1 N*m", "N*m"), ("1 lbf", "N"), (1.0, None), ("1 s", None), (True, None)]
)
def test_matching_unit(value, expected):
    assert matching_unit(value, ("N*m", "N")) == expected


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("m", "a length [m]"),
        ("-", "a pure number"),
        ("N/m**1.1", "a stiffness [N/m**1.1]"),
        (("rad", "m"), "an angle [rad] or a length [m]"),
    ],
)
def test_describe_unit(unit, expected):
    assert describe_unit(unit) == expected


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (True, "true"),
        (0.1, "0.1"),
        ("a\nb", "'a\\nb'"),
        ({"a": 1}, "a table"),
        ((1.0, 2.0), "[1.0, 2.0]"),
        (list(range(100)), "an array"),
        ("x" * 100, "'" + "x" * 56 + "..."),
    ],
)
def test_shown_is_short_and_on_one_line(value, expected):
    assert shown(value) == expected


def test_an_unknown_si_unit_is_a_mistake_of_the_caller():
    with pytest.raises(ValueError, match="'mmm' is not a unit"):
        quantity("1 m", "mmm", PLACE)


def test_pint_is_imported_on_first_use_only():
    code = "import sys\nfrom antenna_pin.base.units import quantity\nquantity(1, 'm', '')\n"
    subprocess.run([sys.executable, "-c", code + "sys.exit('pint' in sys.modules)"], check=True)


def test_units_that_are_known_without_pint_are_those_of_pint():
    names = [*units._COHERENT, *units._SCALED, *units._CYCLES, *units._KINDS, "", "N/m**1.5", "N*s/m**2.11"]
    names += ["N/m**1.3333333333333", "kg*m/s**2/rad", "1/s", "rad**2*m**-3", "Pa*m**2*s**0.5"]
    for name in names:
        assert units.common_unit(name) == units._parsed(name), name


@pytest.mark.parametrize("name", ["Nm", "m/", "mm**2", "m**101", "m**-10*s**11", "m m", "s*", "2", "m**"])
def test_of_other_units_pint_is_asked(name):
    """And whatever is none is refused there, with all that makes a unit too large."""
    assert units.common_unit(name) is None
