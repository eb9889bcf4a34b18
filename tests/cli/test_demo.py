"""The first example of the README, without a checkout."""

import pytest

from antenna_pin import Trajectory


def test_what_the_runs_leave_goes_into_figures_and_report(cli, tmp_path, monkeypatch):
    calls = []
    monkeypatch.setattr("antenna_pin.apps.cli.demo.plot", lambda *given: calls.append(given))
    monkeypatch.setattr("antenna_pin.apps.cli.demo.report", lambda *given: calls.append(given))
    said = cli("demo", "--out", "a/b", "--duration", "2 ms")
    assert said.code == 0 and "case3" in said.out
    folder = (tmp_path / "a" / "b").relative_to(tmp_path)
    files = [folder / "case1.nc", folder / "case3.nc"]
    assert calls == [(files, folder), (files, folder / "report.html")]
    ends = {file.stem: Trajectory.load(file).data.time[-1].item() for file in files}
    assert ends == {"case1": 0.002, "case3": 0.002}


@pytest.mark.parametrize("given", [("--duration", "5 kg"), ("--duration", "0 s"), ("--out", "file")])
def test_refused_before_there_is_anything(cli, tmp_path, given):
    (tmp_path / "file").write_text("")
    said = cli("demo", *given)
    assert said.code == 2 and len(said.err.splitlines()) == 1
    assert [one.name for one in tmp_path.iterdir()] == ["file"]


@pytest.mark.slow
def test_all_of_it_is_there(cli, tmp_path):
    assert cli("demo", "--duration", "20 ms").code == 0
    assert (tmp_path / "demo" / "report.html").stat().st_size > 1e6
    assert len(list((tmp_path / "demo").glob("*.png"))) > 15
