"""A fit that does not fit says so first; what a record or a run lacks is no traceback."""

import math

import numpy as np
import pytest

import antenna_pin.studies.fit.runs as runs
import antenna_pin.studies.fit.search as search
from antenna_pin.errors import AntennaPinError
from antenna_pin.studies.fit import Problem, load_fit, open_fit, run_fit
from antenna_pin.studies.fit.diagnostics import DifferenceGrowth

from .conftest import TIME, closed_form

NOISE = 1e-4  # as the column's sd [rad]


def record(factor=1.0, late=0.0, noise=1.0):
    scatter = noise * NOISE * np.random.default_rng(3).standard_normal(len(TIME))
    return {"angle": factor * closed_form(TIME - late) + scatter}


def said(write, start="30 N*m/rad", **parts):
    fit = run_fit(load_fit(write(**parts).folder / "fit.fit.toml", [f"parameters.stiffness.start={start}"]))
    return fit, "\n".join(fit.verdict)


def test_a_good_fit_has_no_verdict(write):
    fit, words = said(write, columns=record())
    assert words == "" and fit.trusted and fit.bands.noise == "given"
    assert fit.bands.chance > 1e-3


def test_noise_half_as_large_again_widens_the_bands_by_as_much(write):
    fit, words = said(write, columns=record(noise=1.5))
    plain = run_fit(write(columns=record()))
    assert not fit.trusted and words.startswith("the model does not fit the records: chi2 is ")
    assert "bands are widened by 1." in words
    root = math.sqrt(fit.bands.chi2 / fit.bands.freedoms)
    assert root == pytest.approx(1.5, rel=0.2)  # 4 standard deviations of a chi2 of 200
    # The slopes are those of two fits a noise apart; Student's t of 200 is within 1 % of the normal one.
    np.testing.assert_allclose(fit.bands.sd, root * plain.bands.sd, rtol=0.02)


@pytest.mark.parametrize(
    ("start", "wrong", "cause"),
    [
        (
            "30 N*m/rad",
            {"factor": 1e3},
            "  may be the unit of swing.angle: the record is 1000 times as large",
        ),
        (
            "39 N*m/rad",
            {"factor": -1.0},
            "  may be the sign of swing.angle: the record goes against the model",
        ),
        ("39 N*m/rad", {"late": -0.05}, "  may be the clock of swing: 5"),
        ("5 N*m/rad", {}, "  may be a wrong valley of the sum of squares: search from many points, [starts]"),
    ],
)
def test_a_fit_far_beyond_chance_has_no_bands_and_names_what_may_be_wrong(write, start, wrong, cause):
    fit, words = said(write, start, columns=record(**wrong))
    assert not fit.trusted and fit.bands.chi2 > 100.0 * fit.bands.freedoms
    assert "the values have no bands" in words and cause in words
    assert np.isnan(fit.bands.sd).all() and fit.lines()[0] == fit.verdict[0]


@pytest.mark.slow
def test_many_starts_come_before_pieces_where_a_valley_is_likely(write, monkeypatch):
    """What is not straight from afar may be a valley's side: pieces are dear, and lead to no other valley."""

    def grown(*curves):
        return DifferenceGrowth(0.5, 0.1) if curves[-1] > 1.0 else None

    monkeypatch.setattr(search, "difference_growth", grown)
    fit, words = said(write, "5 N*m/rad", columns=record())
    assert "[starts]" in words and not any("pieces" in one for one in fit.notes)
    more = "starts = { count = 2, keep = 1 }"
    fit, words = said(write, "5 N*m/rad", columns={"angle": record()["angle"] ** 2}, more=more)
    assert "[starts]" not in words and any("give it pieces" in one for one in fit.notes)


def test_the_command_says_it_first_and_ends_with_a_code_of_its_own(cli, write, tmp_path):
    write(columns=record(factor=1e3))
    answer = cli("fit", str(tmp_path / "fit.fit.toml"), "--out", str(tmp_path / "a.nc"), "--no-progress")
    assert answer.code == 5 and answer.out.startswith("the ")
    table = open_fit(tmp_path / "a.nc")
    assert "the model does not fit" in table.attrs["verdict"] and table.attrs["chance"] < 1e-6


@pytest.mark.parametrize(
    ("angle", "noise"),
    [
        (np.full(201, 0.3), "given"),
        (-closed_form(TIME), "correlated"),
    ],
)
def test_a_record_that_drives_the_only_parameter_to_its_bound_is_saved(write, tmp_path, angle, noise):
    plan = write(columns={"angle": angle}, more=f'noise = "{noise}"')
    fit = run_fit(plan, tmp_path / "a.nc")
    assert fit.trusted == (noise != "given") and (tmp_path / "a.nc").is_file()


def test_a_parameter_without_effect_is_said_not_to_be_told(write):
    plan = write(columns=record())
    key = "mechanism.links.stand.mass"
    settings = [
        f"parameters.stiffness.key={key}", "parameters.stiffness.start=2 kg",
        'parameters.stiffness.between=["1 kg", "3 kg"]',
        'set.mechanism.links.stand={mass = "1 kg", inertia = [1.0, 1.0, 1.0]}',
    ]  # fmt: skip
    fit = run_fit(load_fit(plan.folder / "fit.fit.toml", settings))
    assert fit.lines()[0].endswith("no band: not identifiable from the records")


# --- runs that die ---


def test_a_run_that_dies_is_a_trial_that_cannot_be_made(write, monkeypatch):
    """The search steps back, comes to where it would have come to, and says how many died."""
    plan = write(columns=record())
    expected, made = run_fit(plan), runs.PreparedScenario.run

    died = []

    def dying(self, *asked):
        stiffness = self.scenario.springs["hinge"].stiffness
        if abs(stiffness - 30.0) > 0.1 and len(died) < 2:  # the first steps of the search, and none aside
            died.append(stiffness)
            raise ValueError("f(a) and f(b) must have different signs")
        return made(self, *asked)

    monkeypatch.setattr(runs.PreparedScenario, "run", dying)
    fit = run_fit(plan)
    assert abs(died[1] - 30.0) < 0.5 * abs(died[0] - 30.0)
    assert fit.values == pytest.approx(expected.values, rel=1e-4)
    (note,) = (one for one in fit.notes if "runs failed" in one)
    assert note.endswith("the first: the run died of ValueError: f(a) and f(b) must have different signs")
    assert note.startswith(f"note: 2 of {fit.runs} runs failed")


def test_a_first_run_that_dies_is_one_line(write, monkeypatch):
    problem = Problem(write())

    def dying(self, *asked):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr(runs.PreparedScenario, "run", dying)
    with pytest.raises(AntennaPinError, match="records.swing: the run died of ZeroDivisionError"):
        problem.residuals(problem.start)


# --- what is refused before any run ---


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("records.swing.time_format=%f%f", "time_format must be iso, or a pattern of different directives"),
        ("records.swing.encoding=undefined", "records.swing.encoding must be a text encoding"),
        ("tolerance=1e-30", "tolerance must be 1e-15 or more"),
        ("records.swing.columns.angle.sd=1e-300", "sd must be 1e-15 of the largest reading or more"),
        ("records.swing.pieces.length=1e-12 s", "pieces.length must be 0.00498 s or more, for a row in each"),
        ('records.swing.columns.angle.filter={corner = "1e-9 Hz"}', "filter.corner must be 0.01 Hz or more"),
    ],
)
def test_numbers_that_lead_nowhere_are_refused(write, setting, words):
    folder = write().folder
    with pytest.raises(AntennaPinError) as refused:
        Problem(load_fit(folder / "fit.fit.toml", [setting]))
    assert words in str(refused.value) and "\n" not in str(refused.value)


def test_a_cell_beyond_any_size_is_refused(write):
    angle = closed_form(TIME)
    angle[2] = 1e308
    with pytest.raises(
        AntennaPinError, match=r"columns.angle must be at most 1e\+100 in size, got 1e\+308 in row 3"
    ):
        Problem(write(columns={"angle": angle}))


def test_what_the_fit_reads_is_not_written_over(write, tmp_path):
    plan = write()
    with pytest.raises(AntennaPinError, match="swing.csv: must not be a file that the fit reads"):
        plan.check_output(tmp_path / "swing.csv")
    plan.check_output(tmp_path / "other.toml")
    kept = tmp_path / "kept.csv"
    kept.write_text("time,angle\n", encoding="utf-8")
    record = next(iter(plan.records.values())).model_copy(update={"file": kept.name})
    with pytest.raises(AntennaPinError, match="kept.csv: must not be a file that the fit reads"):
        plan.model_copy(update={"validation": {"kept": record}}).check_output(kept)
