"""``antenna-pin fit``: its answer, its files, its refusals."""

import shutil
from pathlib import Path

import pytest

from antenna_pin.studies.fit import open_fit

EXAMPLES = Path(__file__).resolve().parents[2] / "scripts" / "examples"


@pytest.fixture
def hinge(tmp_path, monkeypatch):
    for name in ("hinge.fit.toml", "hinge.csv"):
        shutil.copy(EXAMPLES / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_answer_is_short_and_its_files_are_there(cli, hinge):
    said = cli("fit", "hinge.fit.toml", "--write-scenario", "fitted.toml", "--no-progress")
    assert said.code == 0, said.err
    lines = said.out.splitlines()
    assert len(lines) <= 12
    assert lines[0].startswith("play         0.1")
    assert lines[-2:] == ["saved hinge.nc", "saved fitted.toml"]
    table = open_fit(hinge / "hinge.nc")
    assert table.attrs["command"].startswith("antenna-pin fit hinge.fit.toml")
    assert list(table["parameter"].values) == ["play", "stiffness", "restitution", "friction"]
    names = {path.name for path in hinge.iterdir()}
    assert names == {"fitted.toml", "hinge.csv", "hinge.fit.toml", "hinge.nc"}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["hinge.fit.toml", "--record", "test"], "--record must be given with --write-scenario"),
        (
            ["hinge.fit.toml", "--record", "tset", "--write-scenario", "a.toml"],
            "--record must be one of test, got tset",
        ),
        (["hinge.fit.toml", "--workers", "-1"], "'--workers': must be zero or more, got -1"),
        (["hinge.fit.toml", "--out", "a.txt"], "a.txt: the output's name must end in .nc; try a.nc"),
        (["hing.fit.toml"], "'hing.fit.toml' is unknown"),
        (["hinge.fit.toml", "--set", "los=huber"], "los is unknown; did you mean loss?"),
    ],
)
def test_refusals_are_one_line_before_any_run(cli, refused, hinge, options, words):
    assert words in refused(cli("fit", *options))
    assert not list(hinge.glob("*.nc*"))
