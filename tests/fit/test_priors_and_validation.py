"""Knowledge beside the records: priors, derived numbers, records that only judge; tests of residuals."""

import numpy as np
import pytest

from antenna_pin.errors import AntennaPinError
from antenna_pin.studies.fit import Problem, load_fit, run_fit
from antenna_pin.studies.fit.diagnostics import residual_tests as judged
from antenna_pin.studies.fit.specs import evaluate, names_in

from .conftest import DAMPING, STIFFNESS, TIME, closed_form, written

NOISE = 1e-4
DAMPER = """
[parameters.damping]
key = "springs.hinge.damping"
start = "0.15 N*m*s/rad"
between = ["0 N*m*s/rad", "1 N*m*s/rad"]
"""


def measured(seed=5):
    return {"angle": closed_form(TIME) + NOISE * np.random.default_rng(seed).standard_normal(len(TIME))}


def with_prior(mean, sd, jacobian="differences"):
    text = f'prior = {{ mean = "{mean} N*m*s/rad", sd = "{sd} N*m*s/rad" }}'
    return {"columns": measured(), "parameters": DAMPER + text, "more": f'jacobian = "{jacobian}"'}


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """Return the fit of the record alone."""
    return run_fit(written(tmp_path_factory.mktemp("plain"), columns=measured(), parameters=DAMPER))


@pytest.mark.parametrize("jacobian", ["differences", "equation"])
def test_a_prior_is_one_more_measurement(write, plain, jacobian):
    """Information adds up, and the value is the weighted mean: of a linear problem with a normal prior."""
    sd, mean = float(plain.bands.sd[1]), float(plain.values[1]) + 2.0 * float(plain.bands.sd[1])
    fit = run_fit(write(**with_prior(mean, sd, jacobian)))
    inverse = np.linalg.inv(plain.bands.covariance)
    inverse[1, 1] += 1.0 / sd**2
    # The problem is bent by some standard errors over the value, 1e-3, of each standard error.
    np.testing.assert_allclose(fit.bands.covariance, np.linalg.inv(inverse), rtol=1e-2)
    assert fit.values[1] == pytest.approx(0.5 * (plain.values[1] + mean), abs=0.02 * sd)
    assert fit.bands.freedoms == plain.bands.freedoms + 1
    # Two standard errors between two equals: 2^2 / 2 = 2 more.
    assert fit.bands.chi2 - plain.bands.chi2 == pytest.approx(2.0, rel=0.02)


def test_a_prior_far_from_the_record_pulls_no_farther_than_it_weighs(write, plain):
    fit = run_fit(write(**with_prior(0.4, 1e3)))
    assert fit.values[1] == pytest.approx(plain.values[1], rel=1e-9)
    with pytest.raises(AntennaPinError, match="parameters.damping.prior.sd must be of start's unit"):
        write(parameters=DAMPER + 'prior = { mean = "0.2 N*m*s/rad", sd = "0.1 N" }')


# --- derived numbers ---

EXCESS = """
[parameters.excess]
start = "0.1 N*m*s/rad"
between = ["0 N*m*s/rad", "1 N*m*s/rad"]
[derived.damping]
key = "springs.hinge.damping"
value = "stiffness / 400 + excess"
unit = "N*m*s/rad"
"""


@pytest.mark.parametrize("jacobian", ["differences", "equation"])
def test_a_derived_number_is_fitted_through_its_parameters(write, plain, jacobian):
    """Damping of stiffness / 400 + excess: both are found, and the derived one has the direct fit's band."""
    fit = run_fit(write(columns=measured(), parameters=EXCESS, more=f'jacobian = "{jacobian}"'))
    assert fit.values[0] == pytest.approx(plain.values[0], rel=1e-7)
    assert fit.values[0] / 400.0 + fit.values[1] == pytest.approx(plain.values[1], rel=1e-6)
    assert fit.lines()[-1].split(None, 1) == plain.lines()[-1].split(None, 1)
    assert fit.scenario().springs["hinge"].damping == pytest.approx(DAMPING, rel=0.05)


def test_an_order_is_kept_by_a_difference_at_zero(write):
    """A record whose damping is below stiffness / 100 is met at the edge: the excess stands at its bound."""
    fit = run_fit(write(columns=measured(), parameters=EXCESS.replace("400", "100")))
    assert fit.values[1] == pytest.approx(0.0, abs=1e-9)
    assert fit.scenario().springs["hinge"].damping >= fit.values[0] / 100.0
    assert not fit.trusted  # 0.4 for 0.2


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("stiffness +", "derived.damping.value must be made of parameters, numbers"),
        ("__import__('os')", "derived.damping.value must be made of parameters, numbers"),
        ("stifness + excess", "derived.damping.value"),
        ("log(-stiffness) + excess", "must be finite, got none for excess = 0.1, stiffness = 30"),
    ],
)
def test_expressions_that_are_none_are_refused(write, value, words):
    with pytest.raises(AntennaPinError) as refused:
        write(parameters=EXCESS.replace("stiffness / 400 + excess", value))
    assert words in str(refused.value)


def test_expressions_are_arithmetic():
    assert names_in("a * max(b, 2) ** -c") == ("a", "b", "c")
    assert evaluate("a * max(b, 2) ** -c / 4", {"a": 3.0, "b": 1.0, "c": 1.0}) == 0.375


# --- validation ---

OTHER = """
[validation.{name}]
file = "{name}.csv"
[validation.{name}.columns.angle]
of = "motion_angle[hinge]"
sd = "1e-4 rad"
"""


def test_a_record_that_was_not_fitted_judges_the_fit(write, plain, tmp_path):
    for name, damping, seed in (("same", DAMPING, 8), ("other", 1.1 * DAMPING, 9)):
        angle = closed_form(TIME, STIFFNESS, damping)
        angle += NOISE * np.random.default_rng(seed).standard_normal(len(TIME))
        rows = np.column_stack([TIME, angle])
        np.savetxt(tmp_path / f"{name}.csv", rows, delimiter=",", header="time,angle", comments="")
    text = OTHER.format(name="same") + OTHER.format(name="other")
    fit = run_fit(write(columns=measured(), parameters=DAMPER + text))
    same, other = fit.validation
    # Chi2 of 201 numbers is 201 to 4 times the root of 402.
    assert same.numbers == 201 and abs(same.chi2 - 201.0) < 4.0 * np.sqrt(402.0)
    assert other.chi2 > 1000.0 and other.words().endswith(
        "the values do not hold for it, or its sd is too small"
    )
    np.testing.assert_array_equal(fit.values, plain.values)  # it has no part in them
    assert "validation by same: chi2 " in fit.data().attrs["validation"]
    plan = write(columns=measured(), parameters=OTHER.format(name="lost"))
    with pytest.raises(AntennaPinError, match="lost.csv"):
        run_fit(plan)


# --- tests of residuals ---


def test_chances_of_white_normal_noise_are_spread_evenly():
    found = [judged(np.random.default_rng(k).standard_normal(200)) for k in range(400)]
    for chances in np.array([(one.runs_chance, one.normal_chance) for one in found]).T:
        # Of 400 a share of a half is 200 +- 10: four of that; runs come in whole numbers.
        assert abs(np.count_nonzero(chances < 0.5) - 200) < 55


def test_runs_and_tails_show_what_a_correlation_does_not(write):
    noise = np.random.default_rng(2).standard_normal(400)
    # Signs in pairs of pairs: the next one is known as often as not, by the four before always.
    sizes = np.abs(noise) * np.tile([1.0, 1.0, -1.0, -1.0], 100)
    assert abs(judged(sizes).correlation) < 0.1 and judged(np.sort(sizes)).runs == 2
    outliers = measured()
    outliers["angle"][::40] += 5.0 * NOISE
    fit = run_fit(write(columns=outliers, more='noise = "estimated"'))
    assert any('outliers count less by loss = "soft_l1"' in note for note in fit.notes)
    assert judged(np.ones(50)) is None and judged(noise[:10]) is None


def test_a_problem_counts_its_priors(write):
    problem = Problem(write(**with_prior(0.2, 0.1)))
    assert problem.count == 202 == len(problem.residuals(problem.start))
    assert problem.rows.curve_numbers()[-1] == 1
    assert load_fit(problem.plan.folder / "fit.fit.toml").parameters["damping"].prior_numbers() == (0.2, 0.1)
