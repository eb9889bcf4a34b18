"""What a report says of where its numbers come from repeats them."""

import shlex
import tomllib
from pathlib import Path

import numpy as np
import pytest

from antenna_pin import Trajectory, load_scenario, models_path, simulate
from antenna_pin.scenario import list_scenarios, scenario_toml
from antenna_pin.show.report import report, report_command, run_command
from antenna_pin.show.report._runs import reported

CASES = [(one.name, case.name) for one in list_scenarios() for case in one.cases]


@pytest.mark.parametrize(("name", "case"), CASES)
def test_a_scenario_written_out_loads_as_the_same(name, case, tmp_path):
    before = load_scenario(name, case=case)
    (tmp_path / "scenario.toml").write_text(scenario_toml(before), encoding="utf-8")
    (tmp_path / before.mechanism.urdf).write_text(before.urdf_text, encoding="utf-8")
    after = load_scenario(tmp_path)
    own = {name: True for name in ("name", "case", "description", "overrides", "folder")}
    own["flexible"] = {"__all__": {"file", "places", "reading"}}  # whose numbers are written out
    assert after.model_dump(exclude=own) == before.model_dump(exclude=own)


def test_a_table_of_torques_is_written_with_its_numbers(tmp_path):
    table = {"kind": "table", "time": [0.0, 1.0], "torque": [0.0, 0.5], "joint": "elevation"}
    before = load_scenario("bai2020", overrides={"drives.push": table})
    written = tomllib.loads(scenario_toml(before))
    assert written["drives"]["push"]["torque"] == [0.0, 0.5] and "file" not in written["drives"]["push"]


def test_the_command_repeats_the_run(cli, tmp_path, play):
    saved = play.save(tmp_path / "a run.nc")
    (run,) = reported([saved])
    words = shlex.split(run_command(run))
    assert words[:5] == ["antenna-pin", "run", "bai2020", "--case", "case3"]
    assert words[5:7] == ["--set", "duration=0.1"]
    words[words.index(str(saved))] = str(tmp_path / "again.nc")
    assert cli(*words[1:], "-q").code == 0
    again = Trajectory.load(tmp_path / "again.nc")
    assert np.array_equal(again.data["q"].values, play.data["q"].values)


def test_a_scenario_of_ones_own_is_named_by_its_path(tmp_path):
    folder = tmp_path / "my rig"
    folder.mkdir()
    for name in ("scenario.toml", "pendulum.urdf"):
        (folder / name).write_text((models_path() / "pendulum" / name).read_text())
    run = simulate(load_scenario(folder), duration=0.01)
    (one,) = reported(run)
    words = shlex.split(run_command(one))
    assert Path(words[2]) == folder and load_scenario(words[2]).name == "my rig"
    assert f"duration={run.data['time'].values[-1]!r}".replace("np.float64(", "").rstrip(")") in words
    assert report_command([one]) is None


def test_the_report_says_how_it_was_made(cli, tmp_path, play, shown):
    saved, out = play.save(tmp_path / "case3.nc"), tmp_path / "report.html"
    options = ("--title", "Two words", "--no-figures", "--no-recordings", "--window", "20 ms")
    said = cli("report", saved, "--out", out, *options)
    assert (said.code, said.err) == (0, "") and said.out.startswith(f"saved {out}")
    first = out.read_text(encoding="utf-8")
    page = shown(first)
    words = shlex.split(page.said("provenance")["repeat this report"])
    assert cli(*words[1:]).code == 0
    assert out.read_text(encoding="utf-8") == first  # to the byte
    assert page.text("//h1") == "Two words"


def test_versions_scenario_and_urdf_are_there_in_full(ideal, play, shown):
    page = shown(report([ideal, play], figures=False, recordings=False).html)
    rows = page.rows("versions")
    assert {"python", "numpy", "pin"} <= rows.keys() and len(rows["numpy"]) == 3
    sources = [part.text_content() for part in page.tree.xpath("//pre[@class='source']")]
    assert scenario_toml(play.scenario) in sources and play.scenario.urdf_text.strip() in [
        s.strip() for s in sources
    ]
    assert page.said("provenance")["runs finished (UTC)"].startswith("case1 20")


def test_what_is_wrong_is_said_in_one_line(cli, tmp_path, play):
    saved = play.save(tmp_path / "case3.nc")
    for words, message in (
        ([tmp_path / "none.nc", "--out", tmp_path / "r.html"], "no such file"),
        ([saved, "--out", tmp_path / "r.pdf"], "must end in .html"),
        ([saved, "--out", tmp_path / "no" / "r.html"], "does not exist"),
        ([saved, "--out", tmp_path / "r.html", "--window", "5 m"], "--window must be a time"),
    ):
        said = cli("report", *words)
        assert said.code == 2 and message in said.err and said.err.count("\n") == 1
