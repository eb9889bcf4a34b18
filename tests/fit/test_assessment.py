"""What the records of a fit can tell, and which experiment tells more, of a model that is run."""

import numpy as np
import pytest

from antenna_pin.errors import ScenarioError, UnknownNameError
from antenna_pin.show.plot import table_figures
from antenna_pin.show.report import report
from antenna_pin.studies.fit import Problem, run_fit
from antenna_pin.studies.fit.assessment import (
    certain,
    experiments_table,
    identifiability_table,
    open_experiments,
    open_identifiability,
    sizes_of,
    slopes_at,
    tells,
    values_in,
)
from antenna_pin.studies.fit.experiments import Trial, eliminate, load_experiments
from antenna_pin.studies.fit.identifiability import design
from antenna_pin.studies.fit.run_service import RunService
from antenna_pin.trajectory import save_table

from .conftest import DAMPER, FIT, closed_form

CLOCK = """
[parameters.shift]
key = "records.swing.clock_shift"
start = "1 ms"
between = ["0 s", "10 ms"]
"""
FILE = """
criterion = "c"
wanted = "damping"
total = 4
[experiments.again]
[experiments.larger]
set = { "initial.joints.hinge.angle" = "0.2 rad" }
[experiments.four]
repeat = 4
[experiments.better]
columns.angle = { of = "motion_angle[hinge]", sd = "5e-5 rad" }
[experiments.slower]
times = { until = "1 s", rate = "100 Hz" }
"""


@pytest.fixture
def asked(tmp_path):
    path = tmp_path / "next.toml"
    path.write_text(FILE)
    return load_experiments(path)


def test_experiments_tell_what_more_of_the_same_would(write, asked):
    """The motion is linear in its amplitude: twice of it is as good as four records, or half the noise."""
    plan = write(parameters=DAMPER)
    problem = Problem(plan)
    values = np.array([40.0, 0.2])
    known = slopes_at(problem, values)
    made = {name: Trial(plan, name, one, values).slopes() for name, one in asked.experiments.items()}
    assert np.array_equal(made["again"], known)
    sizes = sizes_of(problem, values)
    assert sizes.tolist() == [40.0, 0.5]  # of the one searched by its logarithm the value
    found = design(made, problem.names, sizes, known=known, criterion="c", wanted="damping")
    half = dict(zip(found.experiments, found.half / found.before, strict=True))
    assert half["again"] == pytest.approx(np.full(2, np.sqrt(0.5)), rel=1e-12)
    assert half["four"] == pytest.approx(np.full(2, np.sqrt(0.2)), rel=1e-12)
    # Of one motion at twice the amplitude, integrated apart at rtol = 1e-10, by differences of 1e-4.
    assert half["larger"] == pytest.approx(half["four"], rel=1e-5)
    assert half["better"] == pytest.approx(half["four"], rel=1e-9)
    # Half of the samples tell half as much, but for the ends.
    assert half["slower"] == pytest.approx(np.full(2, np.sqrt(1.0 / 1.5)), rel=0.01)
    assert found.experiments[-2:] == ("again", "slower")


def test_a_clock_that_is_set_anew_tells_nothing_of_the_last_one_and_costs_what_it_explains(write, asked):
    plan = write(time=np.linspace(0.0, 0.9, 181), columns=_late(), parameters=DAMPER + CLOCK)
    values = np.array([40.0, 0.2, 1e-3])
    slopes = Trial(plan, "again", asked.experiments["again"], values).slopes()
    assert not slopes[:, 2].any()
    known = Problem(plan).jacobian(values)
    # What is left of the others is at right angles to what the clock explains: to round-off of 1e-16 in sums.
    cosines = slopes[:, :2].T @ known[:, 2] / np.linalg.norm(known[:, 2])
    assert np.abs(cosines / np.linalg.norm(known[:, :2], axis=0)).max() < 1e-12
    assert np.linalg.norm(slopes[:, 0]) < 0.9 * np.linalg.norm(known[:, 0])


def _late():
    return {"angle": closed_form(np.linspace(0.0, 0.9, 181) + 1e-3)}


def test_without_eliminates_what_a_column_of_zeros_cannot_explain():
    slopes = np.column_stack([np.arange(1.0, 5.0), np.zeros(4)])
    assert np.array_equal(eliminate(slopes, np.array([1])), slopes)


def test_two_springs_side_by_side_are_told_together_only(write):
    """The motion has the sum of their stiffnesses."""
    twin = '[parameters.twin]\nkey = "springs.twin.stiffness"\nstart = "10 N*m/rad"\n'
    plan = write(parameters=twin, text=_with_twin())
    found = tells(Problem(plan))
    assert not found.rank.determined.any()
    (said,) = found.together
    # From 30 and 10 N m/rad: one per cent of the one is three of the other.
    assert said.endswith("twin by 1 %, stiffness by −0.33 %") or said.endswith(
        "stiffness by 1 %, twin by −3 %"
    )


def _with_twin():
    return FIT.replace(
        "springs.hinge = {{ stiffness = 40.0, damping = 0.2 }}",
        "springs.hinge = {{ stiffness = 40.0, damping = 0.2 }}\n"
        'springs.twin = {{ joint = "hinge", stiffness = 10.0 }}',
    )


@pytest.mark.slow
def test_a_fit_is_saved_with_bands_and_profiles_and_shows_itself(write, asked, tmp_path):
    rng = np.random.default_rng(3)
    time = np.linspace(0.0, 1.0, 201)
    plan = write(columns={"angle": closed_form(time) + 2e-3 * rng.standard_normal(201)}, parameters=DAMPER)
    plan = plan.model_copy(update={"noise": "estimated"})
    found = run_fit(plan)
    table, said = certain(found, profile=True)
    assert [line.split(" from ")[0] for line in said] == [
        "stiffness: by its profile",
        "damping: by its profile",
    ]
    # Known to 0.2 % and 2 %, frequency and decay are all but linear: profile and t agree to 2 % of the width.
    width = found.bands.high - found.bands.low
    ends = table["profile_end"].values
    assert (ends[:, 0] - found.bands.low) / width == pytest.approx(np.zeros(2), abs=0.02)
    assert (ends[:, 1] - found.bands.high) / width == pytest.approx(np.zeros(2), abs=0.02)
    truth = closed_form(time)
    inside = (table["band_low"].values <= truth) & (truth <= table["band_high"].values)
    assert inside.mean() > 0.5  # points of one curve hang together: most lie in, or most out
    new = (table["new_low"].values <= table["data"].values) & (
        table["data"].values <= table["new_high"].values
    )
    assert 0.90 <= new.mean() <= 0.99  # 95 % of 201, three spreads of a binomial
    problem = found.problem
    values, factor = values_in(table, problem, "swing.nc")
    assert np.array_equal(values, found.values) and factor == pytest.approx(400.0, rel=0.3)
    before = tells(problem, values, factor)
    assert before.error == pytest.approx(found.bands.sd, rel=1e-3)  # two ways to differences of one step
    files = {"swing.nc": table}
    units, titles = problem.unknowns.units, problem.unknowns.titles
    files["tells.nc"] = identifiability_table(before, units, titles, plan.scenario_of("swing"))
    made = {"again": slopes_at(problem, values)}
    ranked = design(made, problem.names, sizes_of(problem, values), known=made["again"])
    files["next.nc"] = experiments_table(ranked, None, values.tolist(), units, titles)
    for name, one in files.items():
        save_table(one, tmp_path / name)
    assert open_identifiability(tmp_path / "tells.nc")["determined"].values.tolist() == [1, 1]
    assert open_experiments(tmp_path / "next.nc").attrs["criterion"] == "D"
    names = [one.name for table in files.values() for one in table_figures(table)]
    assert names == ["fit", "correlation", "profiles", "identifiability", "experiments"]
    page = report([tmp_path / name for name in files])
    words = [section.title for section in page.sections]
    assert words[:3] == ["Fit: swing", "Identifiability: tells", "Which test next: next"]
    assert "interval of its profile" in page.html


def test_bad_experiments_are_refused_in_a_line(write, tmp_path, asked):
    plan = write(parameters=DAMPER)
    with pytest.raises(UnknownNameError, match=r"experiments\.x\.like"):
        Trial(plan, "x", asked.experiments["again"].model_copy(update={"like": "swin"}), np.ones(2))
    late = asked.experiments["larger"].model_copy(update={"set": {"initial.joints.hing.angle": 0.1}})
    with pytest.raises(ScenarioError, match=r"experiments\.x: .*hing"):
        Trial(plan, "x", late, np.array([40.0, 0.2]))
    for text, words in (
        ("", "experiments is missing"),
        ("[experiments]\n", "must hold one experiment at least"),
        ('criterion = "c"\n[experiments.a]\n', "wanted is missing"),
        ('criterion = "E"\ntotal = 3\n[experiments.a]\n', "has no plan; take D, c or A"),
        ('[experiments.a]\ntimes = { until = "1 ms", rate = "100 Hz" }\n', "must make 2 to 1000000 samples"),
        ("[experiments.a]\nlike = 3\n", "experiments.a.like"),
        ("[experiments.a]\nreapeat = 3\n", "did you mean repeat"),
    ):
        (tmp_path / "bad.toml").write_text(text)
        with pytest.raises(ScenarioError, match=words):
            load_experiments(tmp_path / "bad.toml")
    with pytest.raises(ScenarioError, match="no such file"):
        load_experiments(tmp_path / "none.toml")


def test_an_experiment_by_a_clock_that_is_ahead_begins_within_its_run(write, tmp_path):
    """Its samples are the same motion's at whatever shift: they begin late enough for the largest."""
    (tmp_path / "next.toml").write_text('[experiments.slower]\ntimes = { until = "0.8 s", rate = "100 Hz" }')
    experiments = load_experiments(tmp_path / "next.toml").experiments
    clock = CLOCK.replace('"1 ms"', '"-4 ms"').replace('["0 s", "10 ms"]', '["-10 ms", "0 ms"]')
    plan = write(parameters=DAMPER + clock, record='window = ["20 ms", "0.9 s"]')
    problem = Problem(plan)
    trial = Trial(plan, "slower", experiments["slower"], problem.start, RunService)
    # One trial of 81 samples, of which one column, the clock, is told apart and left out of what it tells.
    found = trial.slopes()
    assert found.shape == (81, 3) and np.all(found[:, list(problem.names).index("shift")] == 0.0)
    assert np.linalg.norm(found[:, 0]) > 0.0
