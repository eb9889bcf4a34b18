"""``antenna-pin vibration``: tables, files, figures and refusals."""

import csv
import json

import pytest

from antenna_pin import load_scenario, simulate


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """A result of the tight panel, swept fast."""
    path = tmp_path_factory.mktemp("vibration") / "swept.nc"
    changes = {"shake.y.octaves_per_minute": 20, "output.rate": 200.0}
    simulate(load_scenario("shaker", case="tight", overrides=changes), duration=10.0).save(path)
    return path


def test_a_response_is_told_of_both_ways(cli, printed, swept, tmp_path):
    lines = printed(cli("vibration", "response", swept, "--plot", tmp_path / "swept.png")).splitlines()
    assert lines[0] == "tight: body_acceleration[tip].y over the base's acceleration"
    assert [line.split()[0] for line in lines[3:5]] == ["up", "down"]
    assert (tmp_path / "swept.png").is_file()
    as_json = json.loads(cli("vibration", "response", swept, "--json").out)
    assert as_json["shake"] == "y"
    assert {row["way"] for row in as_json["response"]} == {1, -1}


def test_the_base_moves_what_it_carries(cli, swept, tmp_path):
    """Force over acceleration, far below the resonance: 5.2 kg, and a little of it enlarged."""
    said = cli(
        "vibration", "response", swept, "--of", "base_force.y", "--to", "body_acceleration[fixture].y",
        "--csv", tmp_path / "mass.csv",
    )  # fmt: skip
    assert said.code == 0, said.err
    rows = list(csv.DictReader((tmp_path / "mass.csv").read_text().splitlines()))
    near = min(rows, key=lambda row: abs(float(row["frequency"]) - 6.5))
    # 4 kg, and of 1.2 kg: rigidly 0.41 kg, by the mode 0.79 kg enlarged by 1/(1 - (6.5/11.8)^2) = 1.44.
    assert float(near["gain"]) == pytest.approx(4.41 + 0.789 * 1.435, rel=0.05)


def test_densities_and_shocks_have_tables(cli, printed, swept):
    density = printed(cli("vibration", "density", swept, "--band", "6,9", "--segment", "2 s"))
    assert density.splitlines()[1].split()[:2] == ["from", "[Hz]"]
    options = ("--quality", "25", "--of", "body_acceleration[fixture].y")
    assert "Q = 25" in printed(cli("vibration", "shock", swept, *options))


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("density --band 9", "--band must be two frequencies such as 20,200"),
        ("density --segment 20Hz", "--segment must be a time [s]"),
        ("shock --of tip", "name 'tip' is unknown"),
        ("shock --quality 0.1", "quality must be above 0.5"),
        ("response --periods 1", "periods must be 2 or more"),
    ],
)
def test_refusals(cli, refused, swept, command, words):
    name, *options = command.split()
    assert words in refused(cli("vibration", name, swept, *options))


def test_the_figure_of_a_response_is_of_a_swept_base_alone(cli, swept, tmp_path):
    options = ("--to", "body_acceleration[fixture].y", "--plot", tmp_path / "response.png")
    said = cli("vibration", "response", swept, *options)
    assert said.code == 2 and "the figure is of a swept base" in said.err
    assert said.out == ""  # refused before anything is printed


def test_json_and_csv_hold_the_same_rows(cli, swept, tmp_path):
    """Rows of each analysis in a file, and in an object that also says what they are of."""
    for command, key, facts in (
        ("response", "response", {"shake"}),
        ("density", "density", {"of", "units", "bands"}),
        ("shock", "spectrum", {"of", "units", "quality"}),
    ):
        file = tmp_path / f"{command}.csv"
        said = cli("vibration", command, swept, "--json", "--csv", file)
        assert said.code == 0, said.err
        found = json.loads(said.out)
        assert facts < found.keys(), command
        rows = list(csv.DictReader(file.read_text().splitlines()))
        assert len(rows) > 10
        for row, one in zip(rows, found[key], strict=True):
            assert row.keys() == one.keys()
            for name, text in row.items():
                assert text == "" if one[name] is None else float(text) == one[name]
