"""What ``run``, ``info`` and ``sweep`` say of what ships; ``python tests/cli/test_answers.py`` writes it.

Numbers stand with two digits: other processors and orders of addition change none of them by as much, but for
errors of round-off, which stand as a sign. Times of the machine stand as one too.
"""

import math
import re
import subprocess
import sys
from pathlib import Path

import pytest

from antenna_pin import load_scenario, load_study, simulate
from antenna_pin.analysis import answer
from antenna_pin.apps.cli._tables import say_answer

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
# Shipped studies whose values are chosen, each run for so long.
GRIDS = {"bai2020": "20 ms", "chen2021": "15 ms", "you2010": "40 ms"}


def rounded(text):
    """Return a text with numbers of two digits, and signs for round-off and for the machine's time."""
    text = re.sub(
        r"\n {4,}", " ", text.replace("\N{NO-BREAK SPACE}", " ")
    )  # where lines part hangs on digits
    for before, machine, after in (
        ("simulated in ", r".*? s(?: \(and .*?\))?", ", "),
        (" ", r"[\d,]+", " steps"),
        ("balance closes to ", r".*?", " of the "),
        ("momentum kept to ", r".*?\(angular\)", ""),
        ("held to ", r"\S+", " "),
        ("closed to ", r".*", ""),
        (" runs completed, ", r"\S+", " s each"),
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


def swept(name, folder, run):
    """Return what a sweep of a grid says; where columns end hangs on digits."""
    out = Path(folder) / f"{name}.study"
    told = run(
        "sweep", f"{name}/clearances", "--workers", "0", "--set", f"set.duration={GRIDS[name]}",
        "--out", str(out), "--no-progress",
    )  # fmt: skip
    told = re.sub(r"\N{BOX DRAWINGS LIGHT HORIZONTAL}+", "---", told.replace(str(out), f"{name}.study"))
    return re.sub(r" +$", "", re.sub(r"(?<=\S) {2,}", "  ", rounded(told)), flags=re.MULTILINE)


@pytest.mark.parametrize("name", GRIDS)
def test_what_is_said_of_a_shipped_grid(name, cli, tmp_path):
    """A row for each run, values against responses."""

    def run(*arguments):
        done = cli(*arguments)
        assert done.code == 0, done.err
        return done.out

    told = swept(name, tmp_path, run)
    assert told == (TEXTS / f"sweep_{name}.txt").read_text(encoding="utf-8")
    study = load_study(f"{name}/clearances")
    runs = math.prod(len(one.values) for one in study.parameters.values())
    assert f"clearances: {runs} runs completed" in told
    head = told.splitlines()[1]
    assert all(one in head for one in (*study.parameters, *study.responses))


@pytest.mark.parametrize("name", CASES)
def test_an_answer_fits_into_twelve_lines_of_a_screen(name, monkeypatch, capsys):
    """Lines are folded by us, not by the screen, and what matters least is left for ``info --all``."""
    run = simulate(load_scenario(name, overrides=[f"duration={CASES[name][-1]!r}"]))
    whole = [line.about.split()[0] for line in answer(run).lines]
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    for columns in (80, 100, 200):
        monkeypatch.setenv("COLUMNS", str(columns))
        say_answer(run)
        told = capsys.readouterr().out.splitlines()
        assert len(told) < _LINES and max(map(len, told)) <= columns
        assert [line.split()[0] for line in told if re.match(r"  \S", line)] == whole


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
    command = [sys.executable, "-m", "antenna_pin.apps.cli", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


if __name__ == "__main__":
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        for name in CASES:
            ran, told = said(name, folder, _command)
            (TEXTS / f"{name}.txt").write_text(f"{ran}---\n{told}", encoding="utf-8")
        for name in GRIDS:
            (TEXTS / f"sweep_{name}.txt").write_text(swept(name, folder, _command), encoding="utf-8")
