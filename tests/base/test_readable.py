"""Numbers as people read them, and a run at a glance."""

import dataclasses
import math

import lxml.html
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from antenna_pin import Outcome, load_scenario, simulate
from antenna_pin.base.readable import number, prefixed, printed_unit, readable

NBSP, MINUS = "\N{NO-BREAK SPACE}", "\N{MINUS SIGN}"


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.0002, "m", "0.2 mm"),
        (9.8e-3, "m", "9.8 mm"),
        (50e-6, "m", "50 µm"),
        (1530.2, "N", "1530 N"),
        (15300.0, "N", "15.3 kN"),
        (207e9, "Pa", "207 GPa"),
        (0.25, "rad", "0.25 rad"),
        (-1.2e-4, "rad/s^2", f"{MINUS}0.12 mrad/s²"),
        (2400.0, "kg", "2400 kg"),
        (0.01, "m^2", "0.01 m²"),  # a prefix would be squared, too
        (3.2e-5, "kg*m**2/s", "3.2×10⁻⁵ kg m²/s"),
        (1e-8, "1", "1×10⁻⁸"),
        (5.0, "s", "5 s"),
        (1000.0, "Hz", "1000 Hz"),
        (0.0, "N", "0 N"),
        (None, "m", "–"),
        (math.nan, "m", "–"),
        (-math.inf, "1", f"{MINUS}∞"),
        (99999.5, "1", "1×10⁵"),  # rounded first
        (0.99996, "m", "1 m"),
    ],
)
def test_a_quantity_is_read_at_a_glance(value, unit, text):
    assert readable(value, unit).replace(NBSP, " ") == text


@given(st.floats(min_value=1e-30, max_value=1e30), st.sampled_from([3, 4, 6]))
def test_a_number_keeps_its_digits(value, digits):
    mantissa, _, power = number(value, digits).partition("×10")
    exponent = int(power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")) or 0)
    # Rounded to so many digits: half a unit of the last one.
    assert float(mantissa) * 10.0**exponent == pytest.approx(value, rel=0.501 * 10.0 ** (1 - digits), abs=0.0)


def test_one_prefix_serves_a_row_by_its_middle_value():
    assert prefixed("s", [3.2e-4, 3.4e-4, 0.42]) == (1e3, "ms")
    assert prefixed("N", [None, math.nan, 0.0, 1.2e-3]) == (1e3, "mN")
    # With a prefix the smallest would need a power of ten: then none is taken.
    assert prefixed("J", [3.4e-14, 7.0e-8]) == (1.0, "J")
    assert prefixed("m", []) == (1.0, "m")
    assert printed_unit("rad/s**2") == "rad/s²" and printed_unit("1") == ""


@pytest.fixture(scope="module")
def run():
    return simulate(load_scenario("bai2020", case="case3"), duration=0.05)


def test_a_run_shows_itself_in_a_notebook(run):
    tree = lxml.html.fromstring(run._repr_html_())
    folds = {one.find("summary").text.strip(): one for one in tree.xpath(".//details")}
    contacts, motion = (
        [[cell.text for cell in row] for row in folds[name].xpath(".//tr")] for name in ("contacts", "motion")
    )
    forces = [row[contacts[0].index("peak force")] for row in contacts[1:]]
    peak = run.data["peak_force"].values.max()
    assert readable(float(peak), "N") in forces
    angle = run.data["motion_angle"].sel(joint="elevation").values[-1]
    assert ["elevation", readable(float(angle), "rad")] in [row[:2] for row in motion]
    episodes = sum(int(row[contacts[0].index("impacts")]) for row in contacts[1:])
    assert episodes == run.data.sizes["episode"]
    assert len(tree.xpath(".//svg[@role='img']/path[title]")) == 2  # a line for each joint
    assert list(folds)[-1] == "data"
    assert "completed" in tree.text_content()


def test_the_sketch_keeps_peaks_and_stays_small(run):
    """A line is thinned to the least and largest value of 120 columns; its height is the range of all."""
    tree = lxml.html.fromstring(run._repr_html_())
    lines = [path.get("d") for path in tree.xpath(".//svg[@role='img']/path[title]")]
    heights = np.array([float(p.split(",")[1]) for d in lines for p in d[1:].split("L")])
    assert heights.min() == 8.0 and heights.max() == 128.0
    assert max(d.count("L") for d in lines) <= 2 * 120 + 1


def test_what_others_wrote_is_escaped_and_an_early_end_is_red(run):
    data = run.data.assign_attrs(title="<b>&", case="<i>")
    cut = dataclasses.replace(run, data=data, outcome=Outcome.INTERRUPTED, message="<script>")
    shown = cut._repr_html_()
    assert "&lt;b&gt;&amp;, case &lt;i&gt;" in shown and "<script>" not in shown
    tree = lxml.html.fromstring(shown)
    assert tree.xpath(".//dd[@class='bad']")[0].text == "<script>"
    assert ".bad{color:var(--bad)" in shown and "--bad:#b3261e" in shown


def test_one_sample_has_no_sketch(run):
    start = dataclasses.replace(run, data=run.data.isel(time=[0], episode=slice(0, 0)))
    assert (
        'role="img"' not in start._repr_html_() and f"{readable(0.05, 's')} simulated" in start._repr_html_()
    )
