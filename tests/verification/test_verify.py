"""Requirements of a sled against closed forms: corners, searches, probabilities, resuming, files."""

import csv
import json

import numpy as np
import pytest
from scipy import optimize

from antenna_pin.run.simulation import simulate
from antenna_pin.scenario import load_scenario
from antenna_pin.studies.sweep import Here
from antenna_pin.studies.verification import facts_of, load_verification, save_verification, verify
from antenna_pin.trajectory import code_digest, result

MASS, END, AMPLITUDE = 2.0, 1.0, 2.0
# Of a run at rtol = 1e-9 or so over smooth forces, relative.
SMOOTH = 1e-8


def way(push, frequency):
    """Position after one second: F t^2 / 2 m + A (w t - sin w t) / (m w^2)."""
    omega = 2.0 * np.pi * frequency
    return push * END**2 / (2.0 * MASS) + AMPLITUDE * (omega * END - np.sin(omega * END)) / (MASS * omega**2)


def test_worst_of_a_monotone_requirement_is_its_corner(sled):
    """The way grows with the push, whatever the frequency; its margin is that of the closed form."""
    path = sled(
        "[requirements.far]\nquantity = 'final_position'\nof = 'slide'\nat_least = '0.9 m'\n"
        "over = 'worst-case'\nvaries = ['push']\nruns = 10\n"
    )
    shown = verify(load_verification(path), path.parent / "out").demonstrations["far"]
    assert shown.overrides == {"drives.push.value": "3.0 N"}
    assert not shown.inside and shown.verdict == "met"
    assert shown.result == pytest.approx(way(3.0, 0.2), rel=SMOOTH)
    assert shown.margin == pytest.approx(way(3.0, 0.2) - 0.9, rel=1e-6)


def test_search_beats_every_corner_of_a_requirement_that_is_not_monotone(sled):
    """The sine's part of the way has its maximum at 0.5 Hz, between the limits."""
    path = sled(
        "[requirements.near]\nquantity = 'final_position'\nof = 'slide'\nat_most = '1.2 m'\n"
        "over = 'worst-case'\nvaries = ['frequency']\nruns = 40\n"
        "[requirements.corners]\nquantity = 'final_position'\nof = 'slide'\nat_most = '1.2 m'\n"
        "over = 'corners'\nvaries = ['frequency']\n"
    )
    found = verify(load_verification(path), path.parent / "out").demonstrations
    best = optimize.minimize_scalar(lambda f: -way(4.0, f), bounds=(0.05, 1.5), method="bounded")
    corner = max(way(4.0, 0.05), way(4.0, 0.2), way(4.0, 1.5))
    assert found["near"].inside and found["near"].result > corner + 1e-3
    assert found["near"].result == pytest.approx(-best.fun, abs=1e-5)
    # Corners alone come with the nominal run, which may be worse than both.
    assert found["corners"].result == pytest.approx(corner, rel=SMOOTH)
    assert found["near"].verdict == "falls short" and found["near"].margin < 0.0


def test_probability_of_a_study_is_the_closed_one(sled):
    """Of a push even between 3 and 5 N the way passes its bound above 4.8 N: one of ten fails."""
    bound, rare = float(way(4.8, 0.2)), float(way(4.998, 0.2))
    text = (
        f"[requirements.likely]\nquantity = 'final_position'\nof = 'slide'\nat_most = {bound!r}\n"
        "over = 'study'\nvaries = ['push']\nprobability = 0.8\nruns = 150\n"
        f"[requirements.rare]\nquantity = 'final_position'\nof = 'slide'\nat_most = {rare!r}\n"
        "over = 'study'\nvaries = ['push']\nprobability = 0.99\nruns = 60\nmethod = 'subset'\n"
    )
    found = verify(load_verification(sled(text)), sled(text).parent / "out").demonstrations
    likely, rare = found["likely"].probability, found["rare"].probability
    assert likely.low < 0.1 < likely.high < 0.2 and found["likely"].verdict == "met"
    assert rare.low < 0.001 < rare.high and rare.runs < 300


class _Interrupted(Here):
    """Executor that is interrupted after some points."""

    def __init__(self, most):
        self.most = most

    def each(self, call, shared, batches):
        for done in super().each(call, shared, batches):
            if self.most == 0:
                raise KeyboardInterrupt
            self.most -= 1
            yield done


def test_an_interrupted_verification_goes_on_where_it_was(sled):
    """Points are evaluated once; the numbers are those of a verification that nothing interrupted."""
    path = sled(
        "[requirements.far]\nquantity = 'final_position'\nof = 'slide'\nat_least = '0.9 m'\n"
        "over = 'corners'\n"
    )
    whole = verify(load_verification(path), path.parent / "whole")
    parts = path.parent / "parts"
    with pytest.raises(KeyboardInterrupt):
        verify(load_verification(path), parts, executor=_Interrupted(3))
    again = verify(load_verification(path), parts)
    # Nominal, four ends, four corners: three were there.
    assert whole.made == whole.points == 9 and again.made == 6
    one, other = ({**facts_of(each), "finished": ""} for each in (whole, again))
    for facts in (one, other):
        for each in facts["requirements"]:
            assert each["integrity"].pop("steps") > 0
    assert one == other


def test_points_of_other_code_are_evaluated_anew(sled, tmp_path, monkeypatch):
    """A checkout is identified by its sources, an installed package by its version."""
    folder = tmp_path / "checkout" / "antenna_pin" / "trajectory"
    folder.mkdir(parents=True)
    (folder / "result.py").write_text("a = 1")
    monkeypatch.setattr(result, "__file__", str(folder / "result.py"))
    path = sled("[requirements.far]\nquantity = 'final_position'\nof = 'slide'\nat_least = '0.1 m'\n")
    made = []
    for project, line in (("", "a = 1"), ("", "a = 2"), ("x", "a = 2"), ("x", "a = 2"), ("x", "a = 3")):
        if project:
            (tmp_path / "checkout" / "pyproject.toml").write_text(project)
        (folder / "result.py").write_text(line)
        code_digest.cache_clear()
        made.append(verify(load_verification(path), tmp_path / "out").made)
    code_digest.cache_clear()
    assert made == [5, 0, 5, 0, 5]


def test_another_bound_needs_no_run_and_another_quantity_only_its_own(sled):
    """Bounds are no part of what is kept; a new requirement evaluates its points anew."""
    text = (
        "[requirements.far]\nquantity = 'final_position'\nof = 'slide'\nat_least = '{}'\nover = 'corners'\n"
    )
    out = sled("").parent / "out"
    first = verify(load_verification(sled(text.format("0.7 m"))), out)
    second = verify(load_verification(sled(text.format("2 m"))), out)
    assert first.made == 9 and second.made == 0 and first.met and not second.met
    more = "[requirements.fast]\nquantity = 'final_slide_rate'\nof = 'slide'\nat_most = '9 m/s'\n"
    third = verify(load_verification(sled(text.format("0.7 m") + more)), out)
    # The nominal point and the ends of each number, for its sensitivities; no corner.
    assert third.made == 5


def test_worst_case_is_a_scenario_file_that_runs(sled):
    """What stands in worst/far.toml gives the very number of the matrix; CSV and JSON agree."""
    path = sled(
        "[requirements.far]\nquantity = 'final_position'\nof = 'slide'\nat_least = '0.7 m'\n"
        "over = 'corners'\n"
    )
    out = path.parent / "out"
    result = verify(load_verification(path), out)
    facts = facts_of(result, "antenna-pin verify sled.requirements.toml")
    save_verification(result, facts, out)
    run = simulate(load_scenario(out / "worst" / "far.toml"))
    assert float(run.data["final_position"].sel(sliding_joint="slide")) == facts["requirements"][0]["result"]
    (row,) = csv.DictReader((out / "matrix.csv").read_text().splitlines())
    kept = json.loads((out / "verification.json").read_text())["requirements"][0]
    assert float(row["result"]) == kept["result"] and row["verdict"] == "met"
    assert row["worst_case"].startswith("drives.push.value=3")


def test_effects_name_the_largest_and_sum_as_a_budget(sled):
    """One number at a time: 0.25 m by the push; the frequency's by its own formula."""
    path = sled("[requirements.far]\nquantity = 'final_position'\nof = 'slide'\nat_least = '0.5 m'\n")
    facts = facts_of(verify(load_verification(path), path.parent / "out"))
    push = next(one for one in facts["effects"] if one["number"] == "push")
    other = next(one for one in facts["effects"] if one["number"] == "frequency")
    assert push["high"] - push["nominal"] == pytest.approx(0.25, rel=1e-7)
    assert other["low"] == pytest.approx(way(4.0, 0.05), rel=SMOOTH)
    (budget,) = facts["budget"]
    sizes = [abs(push["change"]), abs(other["change"])]
    assert budget["largest"] == ("push" if sizes[0] > sizes[1] else "frequency")
    assert budget["sum"] == pytest.approx(sum(sizes)) and budget["root_sum_square"] == pytest.approx(
        np.hypot(*sizes)
    )
