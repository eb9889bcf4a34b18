"""``antenna-pin export fmu``: options of names take several words, refusals one line."""

import zipfile

import pytest
from typer.testing import CliRunner

from antenna_pin.cli import app

pytest.importorskip("pythonfmu3")


def export(*words):
    return CliRunner().invoke(app, ["export", "fmu", *words])


def test_options_take_words_up_to_the_next(tmp_path):
    path = tmp_path / "pendulum.fmu"
    told = export(
        *("pendulum", "--case", "ideal"),
        *("--outputs", "hinge.angle", "hinge.rate", "--outputs", "kinetic_energy"),
        *("--inputs", "springs.hinge.stiffness", "springs.hinge.damping", "--out", str(path)),
    )
    assert told.exit_code == 0, told.output
    assert told.output == f"saved {path}\n"
    description = zipfile.ZipFile(path).read("modelDescription.xml").decode()
    for name in ("hinge.angle", "hinge.rate", "kinetic_energy", "springs.hinge.damping"):
        assert f'name="{name}"' in description


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("pendulum",), "outputs must be one name or more"),
        (("pendulum", "--outputs", "hinge.angel"), "did you mean hinge.angle"),
        (("pendulum", "--outputs", "hinge.angle", "--inputs", "motor"), "'motor' is unknown"),
        (("pendulum", "--outputs", "hinge.angle", "--out", "x.zip"), "must end in .fmu"),
        (("pendulm", "--outputs", "hinge.angle"), "did you mean pendulum"),
    ],
)
def test_refusals(words, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    told = export(*words)
    assert told.exit_code == 2 and says in told.output and told.output.count("\n") == 1
    assert not list(tmp_path.iterdir())
