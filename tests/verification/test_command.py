"""The command: exit codes, numbers as JSON and CSV, and a report that needs nothing but itself."""

import json
import math
import re

import pytest
from typer.testing import CliRunner

from antenna_pin.apps.cli import app
from antenna_pin.run.simulation import simulate
from antenna_pin.scenario import load_scenario
from antenna_pin.studies.verification import measured_orders, point_text, result_text

FAR = "[requirements.far]\ntext = 'far & away'\nquantity = 'final_position'\nof = 'slide'\nat_least = '{}'\n"
WHEEL = """format = 1
scenario = "reaction_wheel"
case = "ideal"
[set.mechanism]
base = "fixed"
[requirements.imbalance]
quantity = "order_coefficient"
of = "shaft"
axis = "fx"
speeds = ["1000 rpm", "3000 rpm"]
positions = 3
at_most = "10.001 g*mm"
at_least = "9.999 g*mm"
"""
AT_ONCE = ["--workers", "0", "--no-progress"]


def call(*words):
    return CliRunner().invoke(app, ["verify", *map(str, words), *AT_ONCE], catch_exceptions=False)


def test_exit_codes_say_whether_all_are_met(sled):
    """0 met, 1 short, 2 refused with one line; bounds change nothing of what was computed."""
    out = sled("").parent / "out"
    met = call(sled(FAR.format("0.5 m")), "--output", out, "--json", "--no-report")
    assert met.exit_code == 0 and json.loads(met.stdout)["met"] is True
    table = out.parent / "matrix.csv"
    short = call(sled(FAR.format("5 m")), "--output", out, "--csv", table, "--no-report")
    assert short.exit_code == 1 and "falls short" in short.stdout
    assert table.read_text().splitlines()[1].endswith("falls short")
    refused = call(sled(FAR.format("5 s")), "--output", out)
    assert refused.exit_code == 2 and refused.stdout == "" and refused.stderr.count("\n") == 1
    assert "requirements.far.at_least must be a length" in refused.stderr
    assert len((out / "points").glob("*").__next__().joinpath("journal").read_text().splitlines()) == 5


def test_report_is_one_page_with_every_number_and_its_file(sled):
    """It fetches nothing, escapes what a file says, and names matrix, worst case, command and digest."""
    out = sled("").parent / "out"
    assert (
        call(sled(FAR.format("0.5 m") + "over = 'corners'\n"), "--output", out, "--no-figures").exit_code == 0
    )
    page = (out / "report.html").read_text()
    assert not re.search(r'(?:src|href)="(?!#|data:)', page)
    facts = json.loads((out / "verification.json").read_text())
    for text in ("far &amp; away", "worst/far.toml", facts["digest"], "<span>verify</span>", "Not covered"):
        assert text in page
    assert "push 3\N{NO-BREAK SPACE}N, " in page and "Hz (worst/far.toml)" in page and "energy" in page
    assert 'data-label="worst result"' in page  # as a phone shows the matrix
    assert "antenna-pin stress" not in page  # nothing touches
    nominal = load_scenario(out / "nominal.toml")
    assert simulate(nominal).data["final_position"].item() == facts["requirements"][0]["nominal"]
    assert facts["requirements"][0]["integrity"]["outcome"] == "COMPLETED"


def test_every_table_of_an_analysis_is_in_a_file_with_its_command(tmp_path, monkeypatch):
    """The command in the file gives the margin of the report; orders and loops name their calls."""
    path = tmp_path / "wheel.requirements.toml"
    path.write_text(WHEEL)
    out = tmp_path / "out"
    assert call(path, "--output", out).exit_code == 0
    kept = json.loads((out / "analyses.json").read_text())
    (orders,) = kept["tables"]
    assert orders["made_by"] == (
        'measured_orders(load_scenario("nominal.toml"), "shaft", ["1000 rpm", "3000 rpm"], count=3)'
    )
    monkeypatch.chdir(out)
    found = measured_orders(load_scenario("nominal.toml"), "shaft", ["1000 rpm", "3000 rpm"], count=3)
    assert orders["rows"][0][0] == f"{found['order'].values[0]:.6g}" == "1"
    page = (out / "report.html").read_text()
    assert "Orders of shaft" in page and "measured_orders" in page and "9.9" in page


def test_shipped_verifications_are_listed():
    """Each with its title; each can be loaded."""
    found = CliRunner().invoke(app, ["verify"], catch_exceptions=False)
    assert found.exit_code == 0
    assert {line.partition(":")[0] for line in found.stdout.splitlines()} >= {
        "gimbal/pointing",
        "reaction_wheel/disturbance",
        "solar_array/deployment",
    }


@pytest.mark.parametrize("words, said", [(["--workers", "-1"], "'--workers': must be zero or more, got -1")])
def test_wrong_options_are_refused(sled, words, said):
    """One line."""
    path = sled(FAR.format("1 m"))
    found = CliRunner().invoke(app, ["verify", str(path), *words], catch_exceptions=False)
    assert found.exit_code == 2 and said in found.stderr


@pytest.mark.parametrize(
    ("bound", "value", "expected"),
    [
        ({"unit": "deg", "size": math.pi / 180.0}, math.radians(41.354), "41.35 deg"),
        ({"unit": "N*m", "size": 1.0}, 0.06, "0.06 N m"),
        ({"unit": "m/s^2", "size": 1.0}, -0.1, "−0.1 m/s²"),
        ({}, 0.06, "60 mrad"),
        ({"unit": "deg", "size": math.pi / 180.0}, None, "–"),
    ],
)
def test_results_are_printed_in_the_unit_of_their_bound(bound, value, expected):
    found = result_text({"units": "rad", "bound_unit": bound}, value)
    assert found.replace("\N{NO-BREAK SPACE}", " ") == expected


def test_points_are_printed_with_four_digits_and_prefixes():
    values = {"a": "1.60385352e-05 m", "b": "0.0305811181 N*m/A", "c": "steel", "d": "20 degC", "e": "3"}
    found = point_text({"worst_values": values}).replace("\N{NO-BREAK SPACE}", " ")
    assert found == "a 16.04 µm, b 0.03058 N m/A, c steel, d 20 degC, e 3"
