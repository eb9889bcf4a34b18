"""Runs whose ledger does not close, on the command line: exit code, a line in red, studies."""

from __future__ import annotations

import pytest
import typer

OPEN = ("--set", "integrator.ledger_tolerance=1e-15")  # more than any run closes to
RUN = ("run", "impact_pair", "--duration", "2 ms", "--out", "a.nc", "--no-progress")


@pytest.fixture
def colours(monkeypatch):
    """What was printed in a colour, by that."""
    found = {}
    said = typer.secho

    def secho(text, fg=None, **how):
        found.setdefault(fg, []).append(text)
        said(text, fg=fg, **how)

    monkeypatch.setattr(typer, "secho", secho)
    return found


def plain(text):
    return text.replace("\N{NO-BREAK SPACE}", " ")


def test_an_open_ledger_has_an_exit_code_and_a_line_in_red(cli, colours):
    said = cli(*RUN, *OPEN)
    assert said.code == 4
    (line,) = said.err.splitlines()
    assert line.startswith("antenna-pin: impact_pair")
    assert "the energy balance is off by" in line and "(the result is in a.nc)" in line
    assert colours["red"] == [line]
    assert "ledger open, 2 ms simulated" in plain(said.out) and "balance is off by" in said.out
    found = cli("info", "a.nc")
    assert found.code == 0 and "the energy balance is off by" in found.out
    everything = cli("info", "--all", "a.nc")
    assert "energy balance error that is explained [J]" in everything.out


def test_what_closes_is_said_to_and_ends_well(cli, colours):
    said = cli(*RUN)
    assert said.code == 0 and said.err == ""
    assert "balance closes to" in said.out and "red" not in colours
    switched_off = cli(*RUN, *OPEN, "--set", "integrator.ledger_alarm=false")
    assert switched_off.code == 0 and switched_off.err == ""
    assert "balance is off by" in switched_off.out  # and it is not said to be well


def test_a_tolerance_that_is_none_is_refused(cli):
    said = cli(*RUN, "--set", "integrator.ledger_tolerance=0")
    assert said.code == 2
    assert "integrator.ledger_tolerance must be positive, got 0" in said.err


STUDY = """
scenario = "impact_pair"
[set]
duration = "2 ms"
[parameters.tolerance]
key = "integrator.ledger_tolerance"
values = [1e-15, 1e-3]
[responses]
force = { measure = "peak_force" }
"""


def test_a_study_counts_such_runs_apart(cli, tmp_path):
    from antenna_pin.show.report import study_report
    from antenna_pin.studies.sweep import open_study

    (tmp_path / "trial.study.toml").write_text(STUDY)
    said = cli("sweep", "trial.study.toml", "--no-progress", "--workers", "1")
    assert said.code == 0, said.err
    assert "off by" not in said.err  # no warning for each
    shown = cli("study", "show", "trial.study")
    assert "LEDGER_OPEN" in shown.out and "does not balance" in shown.out
    table = open_study(tmp_path / "trial.study")
    assert table["outcome"].values.tolist() == ["LEDGER_OPEN", "COMPLETED"]
    assert table["force"].values[0] == table["force"].values[1] > 0.0  # its numbers are kept
    html = study_report(table, figures=False).html
    assert "2 of 2 runs made; 1 does not balance its energy or momentum" in html
