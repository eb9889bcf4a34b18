"""``antenna-pin export fmu``: options of names take several words, refusals one line."""

import zipfile

import pytest

pytest.importorskip("pythonfmu3")


def test_options_take_words_up_to_the_next(cli, printed):
    said = cli(
        *("export", "fmu", "pendulum", "--case", "ideal"),
        *("--outputs", "hinge.angle", "hinge.rate", "--outputs", "kinetic_energy"),
        *("--inputs", "springs.hinge.stiffness", "springs.hinge.damping", "--out", "a.fmu"),
    )
    assert printed(said) == "saved a.fmu\n"
    description = zipfile.ZipFile("a.fmu").read("modelDescription.xml").decode()
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
def test_refusals(cli, refused, words, says, tmp_path):
    assert says in refused(cli("export", "fmu", *words))
    assert not list(tmp_path.iterdir())
