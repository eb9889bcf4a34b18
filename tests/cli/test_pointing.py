"""``antenna-pin pointing``: its table, its JSON, and what it refuses."""

import json
import re

import numpy as np
import pytest

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.analysis import error_components, pointing_error, pointing_indices

LOOKS = ("--body", "reflector", "--boresight", "1,0,0")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The antenna with an ideal joint, shorter and coarser, and with play; one sample; no antenna named."""
    folder = tmp_path_factory.mktemp("results")
    ideal = simulate(load_scenario("bai2020", case="case1", overrides=["output.rate=500"]), duration=0.08)
    ideal.save(folder / "case1.nc")
    for case in ("case3", "case4"):
        overrides = ["clearance.elevation.geometry=closed-form"]
        run = simulate(load_scenario("bai2020", case=case, overrides=overrides), duration=0.1)
        run.save(folder / f"{case}.nc")
    start = run.data.isel(time=[0], episode=slice(0, 0))
    Trajectory(start, run.outcome, run.message, run.counts, run.scenario).save(folder / "one.nc")
    bare = run.scenario.model_copy(update={"pointing": None})
    Trajectory(run.data, run.outcome, run.message, run.counts, bare).save(folder / "bare.nc")
    return folder


def test_table_of_a_run(cli, results):
    windows = ("--window", "10 ms", "--drift-spacing", "5 ms", "--period", "0.02")
    said = cli("pointing", results / "case3.nc", "--ideal", results / "case1.nc", *windows)
    assert (said.code, said.err) == (0, "")
    for words in (
        "case3: pointing error of reflector against",
        "boresight",
        "half-cone",
        "APE largest [",
        "RPE 99.7 % [",
        "PRE: reproducibility error: difference of the means over two windows in different",
        "99.7 %: not exceeded for that share of the time",
        "case3.nc: compared up to the end of the ideal run at 0.08 s",
        "error of the ideal attitude between its samples: some ",
    ):
        assert words in said.out
    assert all(line == line.rstrip() for line in said.out.splitlines())


def test_units_suit_the_angles(cli, results):
    """The antenna swings by degrees in 0.1 s, the play turns it by less than a milliradian."""
    said = cli("pointing", results / "case3.nc", "--direction", "1,0,0")
    assert "APE largest [mrad]" in said.out or "APE largest [deg]" in said.out
    arguments = ("pointing", results / "case3.nc", "--ideal", results / "case1.nc")
    told = re.search(r"APE largest \[(mrad|µrad)\] *(\S+)", cli(*arguments).out)
    exact = json.dumps(json.loads(cli(*arguments, "--json").out))
    # Printed to four digits; the same number stands among those for programs, in rad.
    number = float(told[2]) * {"mrad": 1e-3, "µrad": 1e-6}[told[1]]
    known = [float(one) for one in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", exact)]
    assert any(one == pytest.approx(number, rel=5e-4, abs=0.0) for one in known)


def test_json_is_what_the_python_api_says(cli, results):
    said = cli(
        "pointing", results / "case4.nc", "--direction", "1,0,0.1", "--window", "20 ms", "--json", *LOOKS
    )
    found = json.loads(said.out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    from antenna_pin.analysis import Antenna, Command

    run = Trajectory.load(results / "case4.nc")
    antenna = Antenna(body="reflector", boresight=(1, 0, 0))
    errors = pointing_error(run, antenna=antenna, command=Command(direction=(1, 0, 0.1)))
    expected = pointing_indices(errors["time"].values, error_components(errors), window=0.02)
    assert list(found["indices"]) == ["APE", "MPE", "RPE"]
    for kind, entry in found["indices"].items():
        for name in ("cross", "up", "half-cone"):
            one = expected.sel(index=kind, component=name)
            assert entry["extreme"][name] == one["extreme"].item()
            assert entry["level"]["temporal"][name] == one["level"].sel(interpretation="temporal").item()
        assert entry["highest"]["half-cone"] is None  # a length has no sign
    assert (found["window"], found["periods"], found["against"]) == (0.02, None, "direction in world axes")


def test_several_runs_tell_every_interpretation(cli, results):
    said = cli("pointing", results / "case3.nc", results / "case4.nc", "--direction", "1,0,0")
    assert "case3, case4: pointing error" in said.out
    for words in ("APE 99.7 %, temporal [", "APE 99.7 %, ensemble [", "APE 99.7 %, mixed ["):
        assert words in said.out


def test_the_scenario_is_completed_by_options(cli, results, refused):
    """Another boresight of the same link; another link needs its own."""
    ideal = ("--ideal", results / "case1.nc", "--json")
    same = json.loads(cli("pointing", results / "case3.nc", *ideal).out)
    other = json.loads(cli("pointing", results / "case3.nc", *ideal, "--boresight", "0,1,0").out)
    bare = json.loads(cli("pointing", results / "bare.nc", *ideal, *LOOKS, "--up", "0,0,1").out)
    assert same["body"] == other["body"] == bare["body"] == "reflector"
    # About y elevation is a cross error for boresight x, and clocking for boresight y.
    extreme = [one["indices"]["APE"]["extreme"] for one in (same, other)]
    np.testing.assert_allclose(extreme[0]["cross"], extreme[1]["boresight"], rtol=1e-12)
    line = refused(cli("pointing", results / "case3.nc", *ideal, "--body", "shaft1"))
    assert (
        line
        == "antenna-pin: pointing: --body must be given with --boresight, an axis of that link, got 'shaft1'"
    )


def test_one_sample_has_an_absolute_error_only(cli, results, refused):
    ideal = ("--ideal", results / "case1.nc")
    found = json.loads(cli("pointing", results / "one.nc", *ideal, "--json").out)
    assert list(found["indices"]) == ["APE"]
    line = refused(cli("pointing", results / "one.nc", *ideal, "--window", "1 ms"))
    assert "window must be at most the run's 0 s, got 0.001" in line


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "there is nothing to compare with; add --ideal FILE or --direction X,Y,Z"),
        *(
            (("--direction", text), f"--direction must be three numbers such as 1,0,0, got '{text}'")
            for text in ("1,0", "1,0,0,0", "x,0,1", "1,x,0", "1,0,x", "1,,0", "1 m,0,0", ",,", "1;0;0")
        ),
        (("--direction", "0,0,0"), "direction must be three finite numbers, not all zero"),
        (("--direction", "1,0,0", "--window", "1 m"), "--window must be a time [s], got '1 m' (length)"),
        (("--direction", "1,0,0", "--window", "1"), "window must be at most the run's 0.1 s, got 1.0"),
        (("--direction", "1,0,0", "--period", "1 s"), "window must be given with drift_spacing or periods"),
        (("--direction", "1,0,0", "--confidence", "2"), "confidence must be above 0 and at most 1, got 2.0"),
        (("--direction", "1,0,0", "--body", "dish", "--boresight", "1,0,0"), "link 'dish' is unknown"),
    ],
)
def test_refusals_take_one_line(cli, results, options, message, refused):
    assert message in refused(cli("pointing", results / "case3.nc", *options))


def test_a_run_whose_scenario_names_no_antenna(cli, results, refused):
    bare, ideal = results / "bare.nc", ("--direction", "1,0,0")
    assert refused(cli("pointing", bare, *ideal)).endswith("add --body and --boresight")
    assert refused(cli("pointing", bare, *ideal, "--body", "reflector")).endswith("; add --boresight")
    assert refused(cli("pointing", bare, *ideal, "--boresight", "1,0,0")).endswith("; add --body")
