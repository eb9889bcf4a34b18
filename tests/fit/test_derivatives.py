"""Derivatives of a fit by the variational equation: those of closed forms, those of differences of runs."""

import numpy as np
import pytest

from antenna_pin.errors import ScenarioError
from antenna_pin.studies.fit import Problem, load_fit, run_fit
from antenna_pin.studies.fit.problem import DerivativeLog
from antenna_pin.studies.fit.sensors import compared_numbers, compared_slopes
from antenna_pin.studies.fit.specs import ColumnSpec

from .conftest import DAMPER, DAMPING, STIFFNESS, closed_form

EQUATION = 'jacobian = "equation"'
CLOCK = """
[parameters.shift]
key = "records.swing.clock_shift"
start = "0.01 s"
between = ["0 s", "0.1 s"]
[parameters.gain]
key = "records.swing.columns.angle.gain"
start = 1.05
[parameters.offset]
key = "records.swing.columns.angle.offset"
start = "0.01 rad"
"""


def slope(function, value, step=None):
    """Return a derivative of fourth order."""
    h = 1e-3 * value if step is None else step
    ends = [function(value + k * h) for k in (1, -1, 2, -2)]
    return (8.0 * (ends[0] - ends[1]) - (ends[2] - ends[3])) / (12.0 * h)


def test_slopes_are_those_of_the_closed_form(write):
    time = np.linspace(0.0, 0.9, 91)
    problem = Problem(write(time, {"angle": closed_form(time)}, parameters=DAMPER + CLOCK, more=EQUATION))
    values = np.array([STIFFNESS, DAMPING, 0.02, 1.1, 0.03])
    searched = problem.unknowns.to_search(values)
    found, why = problem._by_equation(values)
    assert not why
    at = time + 0.02
    expected = np.column_stack(
        [
            1.1 * slope(lambda k: closed_form(at, stiffness=k), STIFFNESS) * STIFFNESS,
            1.1 * slope(lambda c: closed_form(at, damping=c), DAMPING) * problem.scale[1],
            1.1 * slope(lambda d: closed_form(time + d), 0.02) * problem.scale[2],
            closed_form(at) * problem.scale[3],
            np.full(len(time), problem.scale[4]),
        ]
    )
    # Runs of rtol 1e-10, dense output between steps, over a clock's step of 1 us: 1e-6 of the largest.
    np.testing.assert_allclose(found, 1e4 * expected, atol=2e-6 * np.abs(1e4 * expected).max())
    np.testing.assert_allclose(problem.unknowns.from_search(searched), values, rtol=1e-14)


@pytest.mark.slow
def test_both_find_the_same(write):
    time = np.linspace(0.0, 0.3, 61)
    record = time, {"angle": closed_form(time)}
    by_runs = run_fit(write(*record, parameters=DAMPER))
    by_equation = run_fit(write(*record, parameters=DAMPER, more=EQUATION))
    # Where the search ends hangs on derivatives by what they are off over what is left of residuals, next to
    # nothing: both are at the least sum to the tolerance of 1e-8 of it, far within what the noise leaves.
    apart = (by_equation.values - by_runs.values) / by_runs.bands.sd
    assert np.abs(apart).max() < 1e-3
    np.testing.assert_allclose(by_equation.bands.sd, by_runs.bands.sd, rtol=1e-4)
    assert by_equation.notes[0].startswith("derivatives by the variational equation, within ")
    assert by_equation.problem.derived.differences == 0
    assert by_equation.data().attrs["derivatives"] in by_equation.notes[0]
    assert by_runs.data().attrs["derivatives"] == "differences of runs"


def test_pieces_have_those_of_differences(write):
    """How a piece's end goes with its start, and with what is fitted, is in the joints' derivatives."""
    time = np.linspace(0.0, 1.0, 101)
    plan = write(
        time,
        {"angle": closed_form(time)},
        parameters=DAMPER,
        more=f"{EQUATION}\ndifference_step = 1e-4",
        record='pieces = { length = "0.25 s" }',
    )
    problem = Problem(plan)
    whole = np.concatenate([problem.start, 0.01 * np.arange(6)])
    found, why = problem._by_equation(whole)
    assert not why
    runs = problem._by_runs(problem.unknowns.to_search(whole))
    # Central differences of steps of 1e-4 err by third derivatives, a hundred times the square of that over
    # a swing of several turns of phase, and by 1e-10 of a run over the step.
    assert np.abs(found - runs).max() < 1e-5 * np.abs(runs).max()


@pytest.mark.slow
def test_an_interrupted_fit_by_the_equation_goes_on_bit_for_bit(write, tmp_path):
    time = np.linspace(0.0, 0.2, 21)
    plan = write(
        time,
        {"angle": closed_form(time)},
        parameters=DAMPER,
        more=EQUATION,
        record='pieces = { length = "0.1 s" }',
    )
    whole = run_fit(plan)
    assert whole.runs > 10

    def until(runs):
        if runs >= whole.runs // 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_fit(plan, tmp_path / "fit.nc", progress=until)
    made = []
    found = run_fit(plan, tmp_path / "fit.nc", progress=made.append)
    # What was made before was not made again.
    assert made[0] > whole.runs // 2
    assert found.runs == whole.runs
    for name in ("values", "residuals", "slopes", "states", "notes"):
        np.testing.assert_array_equal(getattr(found, name), getattr(whole, name))


@pytest.mark.slow
def test_what_the_equation_cannot_is_told_and_left_to_runs(write):
    """A start next to the end of what a scenario allows has no neighbour to build."""
    at_zero = DAMPER.replace("0.5 N*m*s/rad", "0 N*m*s/rad").replace(
        '"0 N*m*s/rad"\n', '"0 N*m*s/rad"\nbetween = ["0 N*m*s/rad", "1 N*m*s/rad"]\n'
    )
    time = np.linspace(0.0, 0.1, 31)
    found = run_fit(write(time, {"angle": closed_form(time)}, parameters=at_zero, more=EQUATION))
    derived = found.problem.derived
    assert derived.differences > 0 and "damping" in derived.why
    assert derived.why in found.notes[-1]
    np.testing.assert_allclose(found.values, [STIFFNESS, DAMPING], rtol=1e-4)


def test_words_say_by_what():
    assert DerivativeLog(3, 0, "", 2e-6).words() == (
        "the variational equation, within 2e-06 of differences of runs where it began"
    )
    assert DerivativeLog(0, 2, "a graze").words() == "differences of runs, not the equation: a graze"
    assert DerivativeLog(2, 1, "a graze", 2e-6).words().endswith("; 1 of 3 times by these: a graze")


@pytest.mark.parametrize(
    "more",
    [{"compare": "rms"}, {"compare": "spectrum", "spectrum": {"edges": [5.0, 20.0, 45.0], "segment": 0.5}}],
    ids=["rms", "spectrum"],
)
def test_slopes_of_statistics_are_those_of_differences(more):
    column = ColumnSpec(of="motion_angle[hinge]", sd=1.0, **more)
    time, draws = np.linspace(0.0, 2.0, 401), np.random.default_rng(3)
    values, ways = draws.standard_normal(401), draws.standard_normal((401, 2))
    found = compared_slopes(column, time, values, ways)
    for k, way in enumerate(ways.T):
        expected = slope(
            lambda s, way=way: compared_numbers(column, "rad", time, values + s * way), 0.0, 1e-4
        )
        # Fourth order at 1e-4 errs by 1e-16 of fifth derivatives, and by round-off over the step.
        np.testing.assert_allclose(found[:, k], expected, rtol=1e-9, atol=1e-10)


def test_blows_are_none_of_the_equation(write):
    blows = 'compare = "blows"\nblows = { level = "1 mrad", edges = ["1 mrad", "10 mrad", "1 rad"] }'
    plan = write()
    text = (plan.folder / "fit.fit.toml").read_text().replace('sd = "1e-4 rad"', blows)
    (plan.folder / "fit.fit.toml").write_text(text)
    with pytest.raises(ScenarioError, match='jacobian must be "differences" where blows are compared'):
        load_fit(plan.folder / "fit.fit.toml", [EQUATION.replace(" ", "")])


@pytest.mark.parametrize(
    ("parts", "way_out"),
    [
        ({"record": 'pieces = { length = "0.25 s" }'}, "leave the pieces out"),
        ({"more": EQUATION}, 'take jacobian = "differences"'),
    ],
    ids=["pieces", "equation"],
)
def test_what_counts_from_a_runs_start_is_refused_where_runs_begin_anew(write, parts, way_out):
    folder = write(**parts).folder
    text = (folder / "fit.fit.toml").read_text()
    text = text.replace('of = "motion_angle[hinge]"', 'of = "dissipation_damper[hinge]"')
    (folder / "fit.fit.toml").write_text(text.replace('sd = "1e-4 rad"', 'sd = "1 mJ"'))
    with pytest.raises(ScenarioError) as refused:
        Problem(load_fit(folder / "fit.fit.toml"))
    assert "columns.angle must follow from the state of a moment" in str(refused.value)
    assert str(refused.value).endswith(f"as dissipation_damper[hinge] does; {way_out}")
