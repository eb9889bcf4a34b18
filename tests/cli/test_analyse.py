"""``antenna-pin analyse`` and ``impacts``: tables, JSON, CSV, and what is said of little."""

import csv
import json

import numpy as np
import pytest

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.analysis import deviation, impacts, load_statistics
from antenna_pin.trajectory import Outcome


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The antenna with an ideal joint and with play, and a run of one sample."""
    folder = tmp_path_factory.mktemp("results")
    overrides = ["clearance.elevation.geometry=closed-form"]
    ideal = simulate(load_scenario("bai2020", case="case1"), duration=0.08)
    play = simulate(load_scenario("bai2020", case="case3", overrides=overrides), duration=0.1)
    ideal.save(folder / "case1.nc")
    simulate(load_scenario("bai2020", case="case1"), duration=2.0).save(folder / "long.nc")
    play.save(folder / "case3.nc")
    start = play.data.isel(time=[0], episode=slice(0, 0))
    one = Trajectory(start, Outcome.INTERRUPTED, Outcome.INTERRUPTED.value, play.counts)
    one.save(folder / "one.nc")
    return folder


def test_tables_of_a_run(cli, results):
    said = cli("analyse", results / "case3.nc", "--ideal", results / "case1.nc")
    assert (said.code, said.err) == (0, "")
    for words in (
        "case3: deviation from the ideal run",
        "elevation angle [rad]",
        "case3: impacts and load",
        "median restitution delivered [-]",
        "case3: settling into lasting contact",
        "apart for no more than 1 ms from [s]",
        "no frequency stands out",
        "compared with the ideal run up to its end at 0.08 s",
    ):
        assert words in said.out
    assert all(line == line.rstrip() for line in said.out.splitlines())


def test_json_is_what_the_python_api_says(cli, results):
    said = cli("analyse", results / "case3.nc", "--ideal", results / "case1.nc", "--json")
    found = json.loads(said.out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    run, ideal = (Trajectory.load(results / f"{case}.nc") for case in ("case3", "case1"))
    angle = next(one for one in found["deviation"] if one["of"] == "elevation angle")
    assert angle["maximum"] == deviation(run, ideal)["elevation angle"].maximum
    loads = load_statistics(run)
    of = {one["of"]: one for one in found["loads"]}
    assert of["elevation"]["impulse"] == loads["joint_impulse"].item()
    assert of["elevation.radial+"]["episodes"] == int(loads["episodes"].values[0])
    assert of["elevation.axial+"]["mean_force_in_contact"] is None  # it never touches
    assert sum(one["impacts"] for one in found["impacts"]) == run.data.sizes["episode"]
    assert found["settling"][0]["joint"] == "elevation"
    assert {one["of"] for one in found["frequencies"]} >= {"elevation acceleration", "base acceleration x"}


def test_the_longest_gap_may_have_a_unit_or_none(cli, refused, results):
    for text in ("0.2 ms", "0.0002"):
        found = json.loads(cli("analyse", results / "case3.nc", "--longest-gap", text, "--json").out)
        assert found["settling"][0]["longest_gap"] == pytest.approx(2e-4, rel=1e-12)
    said = cli("analyse", results / "case3.nc", "--longest-gap", "2 mm")
    assert "--longest-gap must be a time [s], got '2 mm' (length)" in refused(said)


def test_what_can_be_said_of_little(cli, results):
    ideal = cli("analyse", results / "long.nc")
    assert ideal.code == 0
    assert "no joint with clearance: no impacts, loads and settling" in ideal.out
    assert "case1: dominant frequencies [Hz] (amplitude), resolution 0.5 Hz" in ideal.out
    row = next(line for line in ideal.out.splitlines() if line.startswith(" elevation acceleration"))
    assert float(row.split()[3]) == pytest.approx(1.0, abs=0.02)  # the drive's frequency [Hz]
    one = cli("analyse", results / "one.nc", "--ideal", results / "case1.nc")
    assert one.code == 0
    assert "the run ended early: stopped by the user; the results so far are saved" in one.out
    assert "one sample: no deviation, no frequencies" in one.out
    assert "elevation does not settle: one sample is no time to settle in" in one.out


def test_an_ideal_run_with_contacts_is_refused(cli, refused, results):
    said = cli("analyse", results / "case1.nc", "--ideal", results / "case3.nc")
    rule = "ideal must be a run without contacts (a case whose joints are all ideal)"
    assert refused(said) == f"antenna-pin: deviation: {rule}, got 'case3 with play in elevation'"


def test_impacts_are_listed_in_order(cli, results):
    run = Trajectory.load(results / "case3.nc")
    said = cli("impacts", results / "case3.nc")
    assert said.code == 0
    lines = [line for line in said.out.splitlines() if line.strip().startswith("elevation.")]
    assert len(lines) == run.data.sizes["episode"]
    strongest = cli("impacts", results / "case3.nc", "--strongest", "1")
    assert f"{run.data['peak_force'].values.max():.6g}" in strongest.out
    assert strongest.out.count("elevation.") == 1


def test_csv_reads_back_to_the_last_digit(cli, results, tmp_path):
    said = cli("impacts", results / "case3.nc", "--csv", "impacts.csv")
    assert said.out == "saved impacts.csv\n"
    table = impacts(Trajectory.load(results / "case3.nc"))
    with (tmp_path / "impacts.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["contact"] for row in rows] == list(table["contact"].values)
    for column, name in (("approach speed [m/s]", "approach_speed"), ("restitution [-]", "restitution")):
        read = np.array([float(row[column]) if row[column] else np.nan for row in rows])
        assert np.array_equal(read, table[name].values, equal_nan=True)
    assert [row["ended"] == "1" for row in rows] == table["ended"].values.tolist()


def test_no_impacts_to_list(cli, refused, results):
    line = refused(cli("impacts", results / "case1.nc"))
    assert "the run has no joint with clearance and so no impacts; take a case that has one" in line
    one = cli("impacts", results / "one.nc")
    assert (one.code, one.out) == (0, "")
    assert one.err.endswith("one.nc: no impacts\n")
    assert "must end in .csv" in refused(cli("impacts", results / "case3.nc", "--csv", "impacts.txt"))
    joint = refused(cli("impacts", results / "case3.nc", "--joint", "azimuth"))
    assert "clearance joint 'azimuth' is unknown; known: elevation" in joint
