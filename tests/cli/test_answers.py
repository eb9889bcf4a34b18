"""What ``run`` and ``info`` say of shipped cases; ``python tests/cli/test_answers.py`` writes it.

Numbers stand with two digits: other processors and orders of addition change none of them by as much, but for
errors of round-off, which stand as a sign. Times of the machine stand as one too.
"""

import re
import subprocess
import sys
from pathlib import Path

import pytest

TEXTS = Path(__file__).parent / "answers"
CASES = {
    "bai2020": ("--case", "case3", "--duration", "20 ms"),
    "you2010": ("--duration", "40 ms"),
    "chen2021": ("--duration", "15 ms"),
    "solar_array": ("--duration", "10 ms"),
    "pointing_gear": ("--duration", "100 ms"),
    "reaction_wheel": ("--duration", "2 ms"),
    "shaker": ("--duration", "200 ms"),
}
_LINES = 12


def rounded(text):
    """Return a text with numbers of two digits, and signs for round-off and for the machine's time."""
    text = re.sub(
        r"\n {5,}", " ", text.replace("\N{NO-BREAK SPACE}", " ")
    )  # where lines part hangs on digits
    for before, machine, after in (
        ("simulated in ", r".*? s(?: \(and .*?\))?", ", "),
        (" ", r"[\d,]+", " steps"),
        ("balance closes to ", r".*?", " of the "),
        ("momentum kept to ", r".*?\(angular\)", ""),
        ("held to ", r"\S+", " "),
        ("closed to ", r".*", ""),
    ):
        text = re.sub(f"({before}){machine}({after})", r"\1~\2", text)
    text = re.sub(r"[\d.]+×10⁻[⁰-⁹¹²³]+", "~", text)
    return re.sub(r"(?<![\w.])\d+\.\d+", lambda found: f"{float(found[0]):.2g}", text)


def said(name, folder, run):
    """Return what a run and ``info`` of its scenario say."""
    out = Path(folder) / f"{name}.nc"
    ran = run("run", name, *CASES[name], "--out", str(out), "--no-progress")
    ran = ran.replace(str(out), f"{name}.nc")
    return rounded(ran), rounded(run("info", name))


@pytest.mark.parametrize("name", CASES)
def test_what_is_said_of_a_shipped_case(name, cli, tmp_path):
    def run(*arguments):
        done = cli(*arguments)
        assert done.code == 0, done.err
        return done.out

    ran, told = said(name, tmp_path, run)
    assert f"{ran}---\n{told}" == (TEXTS / f"{name}.txt").read_text(encoding="utf-8")
    assert len(ran.splitlines()) <= _LINES


def _command(*arguments):
    command = [sys.executable, "-m", "antenna_pin.cli", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


if __name__ == "__main__":
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        for name in CASES:
            ran, told = said(name, folder, _command)
            (TEXTS / f"{name}.txt").write_text(f"{ran}---\n{told}", encoding="utf-8")
