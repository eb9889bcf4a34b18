"""``antenna-pin stress`` and ``antenna-pin tolerance``: tables, files, figures and refusals."""

import csv
import json

import pytest

from antenna_pin import load_scenario, simulate

FIT = ("--set", "materials.steel.expansion=11.7e-6", "--set", "clearance.hinge.fit=20 H7/f7")


@pytest.fixture(scope="module")
def impact(tmp_path_factory):
    """The first impact of the pendulum's journal, with a yield limit."""
    path = tmp_path_factory.mktemp("stress") / "impact.nc"
    changes = {"materials.steel.yield_strength": "300 MPa"}
    simulate(load_scenario("pendulum", overrides=changes), duration=0.006).save(path)
    return path


def test_stress_has_a_table_notes_and_a_figure(cli, printed, impact, tmp_path):
    said = printed(cli("stress", impact, "--plot", tmp_path / "stress.png"))
    assert (
        said.splitlines()[0] == "contact: contact stress at its peak; margin = 0.93 limit / (1 pressure) - 1"
    )
    assert "hinge.radial+, hinge.radial-: Hertz, line" in said and "limit of steel" in said
    assert "never touched: hinge.axial+, hinge.axial-" in said and "PV [MPa m/s]" in said
    assert (tmp_path / "stress.png").is_file()


def test_stress_in_numbers_is_the_table(cli, impact, tmp_path):
    found = json.loads(cli("stress", impact, "--factor", "1.25", "--json").out)
    row = next(one for one in found["surfaces"] if one["place"] == "hinge.radial+")
    assert row["margin"] == pytest.approx(0.93 * 300e6 / (1.25 * row["pressure"]) - 1.0, rel=1e-12)
    assert cli("stress", impact, "--csv", tmp_path / "stress.csv").code == 0
    rows = list(csv.DictReader((tmp_path / "stress.csv").read_text().splitlines()))
    assert float(rows[0]["pressure"]) == row["pressure"]


def test_surfaces_of_a_file_are_used(cli, impact, tmp_path):
    path = tmp_path / "surfaces.toml"
    path.write_text('[joints.hinge]\nbearing_material = "bronze-c93200"\npv_limit = "0.1 MPa*m/s"\n')
    found = json.loads(cli("stress", impact, "--surfaces", path, "--json").out)
    assert found["surfaces"][0]["material"] == "bronze-c93200"
    assert found["bushings"][0]["share"] == pytest.approx(found["bushings"][0]["pv"] / 1e5, rel=1e-12)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--surfaces", "none.toml"), "none.toml: must be an existing TOML file of surfaces"),
        (("--joint", "hing"), "clearance joint 'hing' is unknown"),
        (("--factor", "0"), "factor must be positive and finite, got 0"),
        (("--plot", "a.gif"), "--plot must be a file that ends in .png, .pdf, .svg"),
    ],
)
def test_refusals_of_stress(cli, refused, impact, options, words):
    assert words in refused(cli("stress", impact, *options))


def test_tolerance_of_a_fit_at_a_temperature(cli, printed, tmp_path):
    aluminium = (
        "--set",
        "clearance.hinge.journal_material=aluminium-7075-t6",
        "--set",
        "temperature=60 degC",
    )
    said = printed(cli("tolerance", "pendulum", *FIT, *aluminium, "--plot", tmp_path / "play.png"))
    assert "20 H7/f7    0 to +21   -41 to -20" in said
    assert "less than the 3 required by ECSS-E-ST-33-01C (2009)" in said
    assert "195.8 degC" in said  # 20.5 um over 10 mm and the difference of expansions
    assert (tmp_path / "play.png").is_file()
    assert "at least the 0.7 of --least-ratio" in printed(
        cli("tolerance", "pendulum", *FIT, *aluminium, "--least-ratio", "0.7")
    )


def test_tolerance_of_a_chain(cli, tmp_path):
    """Two uniform dimensions make a triangle, a quarter of whose base lies below zero: 1/8."""
    pin = 'pin={nominal=0.05005, plus=5e-5, minus=-5e-5, distribution="uniform"}'
    bush = 'bush={nominal=0.05, plus=5e-5, minus=-5e-5, coefficient=-1, distribution="uniform"}'
    chain = f"tolerances.end={{least=0, dimensions={{{pin}, {bush}}}}}"
    (found,) = json.loads(cli("tolerance", "pendulum", "--set", chain, "--json").out)["chains"]
    ends = (found["worst_case_least"], found["worst_case_largest"])
    assert ends == pytest.approx((-5e-5, 1.5e-4), abs=1e-12)
    assert found["probability_below_least"] == pytest.approx(0.125, abs=1e-7)  # of a cell of the convolution
    assert found["mean_over_tolerance"] == pytest.approx(0.25, rel=1e-9)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--set", "clearance.hinge.fit=20 H7/p6"), "fit must leave play"),
        (("--capability", "0"), "'--capability': must be positive, got 0"),
        ((*FIT, "--plot", "a.png", "--coldest", "3 mm"), "--coldest must be a temperature [K], got '3 mm'"),
        ((*FIT, "--plot", "a.png", "--hottest", "-70 degC"), "--hottest must be above --coldest = -60 degC"),
    ],
)
def test_refusals_of_tolerance(cli, tmp_path, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    said = cli("tolerance", "pendulum", *options)
    assert said.code == 2 and words in said.err and said.err.count("\n") == 1
    assert said.out == ""  # refused before anything is printed
