"""``antenna-pin sensitivity``: what it prints, writes and refuses."""

import csv
import json

import pytest

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
    shown = [line.strip() for line in lines[4:] if line.strip()]
    assert len(shown) == 2 and all(line.startswith(name) for line, name in zip(shown, names[:2], strict=True))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((SPEED, "--method", "guess"), "--method must be one of runs, quick-runs, equation, got 'guess'"),
        ((SPEED, f"{SPEED}=1 m/s"), f"KEY must be named once each, got {SPEED} twice"),
        ((SPEED, "--most", "0"), "--most must be 1 or more, got 0"),
        (("clearance.boar.offset",), "is unknown"),
        (("initial.joints.bore.journal_velocity[1]=5 kg",), "must be a speed [m/s], got '5 kg'"),
    ],
)
def test_what_is_refused(cli, arguments, said):
    """In one line."""
    refused = cli("sensitivity", "impact_pair", *PLAIN, *arguments)
    assert refused.code == 2 and len(refused.err.splitlines()) == 1 and said in refused.err
