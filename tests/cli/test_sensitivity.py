"""``antenna-pin sensitivity``: what it prints, writes and refuses."""

import csv
import json

import pytest

from antenna_pin.studies.sensitivity import open_sensitivities

PLAIN = ("--set", "integrator.engine=compiled", "--set", "clearance.bore.geometry=closed-form")
PAIR = ("sensitivity", "impact_pair", *PLAIN, "--duration", "2 ms", "--method", "quick-runs")
SPEED = "initial.joints.bore.journal_velocity[0]"


def test_an_impact_that_is_faster(cli):
    """A contact lasts as the Hertzian one does: force goes with speed^1.2, its impulse with speed itself."""
    said = json.loads(cli(*PAIR, SPEED, "--json").out)
    assert said["parameters"] == [{"key": SPEED, "value": 0.1, "unit": "m/s", "scale": 0.1}]
    rows = {row["result"]: row for row in said["results"]}
    for name, power in (("max peak_force", 1.2), ("sum impulse", 1.0), ("sum dissipated", 2.0)):
        # Differences of runs at 1e-12, of second order with steps of 1e-4.
        assert rows[name][f"per 1 % of {SPEED}"] == pytest.approx(
            0.01 * power * rows[name]["value"], rel=1e-6
        )


def test_the_table_and_the_file(cli, tmp_path):
    """Those that change most come first; a file has all of them."""
    file = tmp_path / "moved.csv"
    cli(*PAIR, SPEED, "--csv", str(file))
    with file.open(newline="") as stream:
        names = [row["result"] for row in csv.DictReader(stream)]
    lines = cli(*PAIR, SPEED, "--most", "2").out.splitlines()
    assert lines[0] == f"(1) {SPEED} = 0.1 m/s"
    *shown, known = [line.strip() for line in lines[4:] if line.strip()]
    assert len(shown) == 2 and all(line.startswith(name) for line, name in zip(shown, names[:2], strict=True))
    assert known.startswith("derivatives of velocities go like exp(") and known.endswith(
        "known to 1% to the end"
    )


def test_the_dataset_and_its_figure(cli, tmp_path):
    """They are written, the dataset reads back with what the table has, and pieces say where they begin."""
    out, plot = tmp_path / "moved.nc", tmp_path / "moved.svg"
    said = json.loads(cli(*PAIR, SPEED, "--out", str(out), "--plot", str(plot), "--json").out)
    table = open_sensitivities(out)
    assert [str(one) for one in table["result"].values] == [row["result"] for row in said["results"]]
    assert 0.01 * table["change"].values[0, 0] == said["results"][0][f"per 1 % of {SPEED}"]
    assert plot.stat().st_size > 1000
    assert said["growth"][0]["believed"] is None and said["refused"] == []


def test_pieces_on_the_command_line(cli):
    """Each is told to its own end: of two, the speed at the start of the second acts in it alone."""
    said = json.loads(cli(*PAIR, SPEED, "--pieces", "1.5 ms", "--json").out)
    assert said["results"] == [] and said["growth"][0]["key"] == SPEED


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((SPEED, "--method", "guess"), "--method must be one of runs, quick-runs, equation, got 'guess'"),
        ((SPEED, f"{SPEED}=1 m/s"), f"KEY must be named once each, got {SPEED} twice"),
        ((SPEED, "--most", "0"), "--most must be 1 or more, got 0"),
        ((SPEED, "--pieces", "1 s"), "pieces must be at most the run's"),
        ((SPEED, "--start", "nowhere.json"), "--start must be a file with a state"),
        ((SPEED, "--out", "moved.csv"), "must end in .nc"),
        (("clearance.boar.offset",), "is unknown"),
        (("initial.joints.bore.journal_velocity[1]=5 kg",), "must be a speed [m/s], got '5 kg'"),
    ],
)
def test_refusals(cli, refused, arguments, said):
    assert said in refused(cli("sensitivity", "impact_pair", *PLAIN, *arguments))
