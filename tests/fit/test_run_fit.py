"""What a fit finds: closed forms, another code's records, other valleys, bands, its end after a break."""

import numpy as np
import pytest
import xarray as xr
from hinge_record import FIT, TIMES, TRUTH, write_record
from planar_joint import record
from scipy.signal import lfilter

from antenna_pin import load_scenario
from antenna_pin.errors import OutputError
from antenna_pin.studies.fit import Problem, load_fit, open_fit, run_fit
from antenna_pin.studies.fit.run_service import RunService, RunStore

from .conftest import DAMPER, DAMPING, FIRST, STIFFNESS, TIME, closed_form, written
from .conftest import FIT as FIT_OF_PENDULUM


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """Return stiffness and damping of an exact record, fitted."""
    return run_fit(written(tmp_path_factory.mktemp("exact"), parameters=DAMPER))


def test_spring_and_damper_of_a_pendulum_are_those_of_the_closed_form(found):
    # The record is exact but for its 17 digits; the runs err by some 1e-9 of the amplitude at rtol = 1e-10,
    # and the search ends where a step changes nothing to 1e-8 of the sum of squares.
    np.testing.assert_allclose(found.values, [STIFFNESS, DAMPING], rtol=1e-6)
    assert found.converged
    assert np.abs(found.residuals).max() < 1e-2
    sides = []
    for step in 1e-4 * np.diag([STIFFNESS, DAMPING]):
        ahead, behind = (closed_form(TIME, *([STIFFNESS, DAMPING] + sign * step)) for sign in (1, -1))
        sides.append((ahead - behind) / (2.0 * step.sum()) / 1e-4)
    slopes = np.column_stack(sides)
    # Differences of steps of 1e-4 err by the square of that times third derivatives, some 1e-6 in all.
    np.testing.assert_allclose(found.slopes, slopes, atol=1e-4 * np.abs(slopes).max())
    np.testing.assert_allclose(found.bands.covariance, np.linalg.inv(slopes.T @ slopes), rtol=1e-3)


def test_estimated_noise_scales_the_bands_and_not_the_values(write):
    noise = 5e-4 * np.random.default_rng(0).standard_normal(201)
    columns = {"angle": closed_form(TIME) + noise}
    estimated = run_fit(write(columns=columns, more='noise = "estimated"'))
    folder = write(columns=columns).folder
    given = run_fit(load_fit(folder / "fit.fit.toml", ["records.swing.columns.angle.sd=5e-4 rad"]))
    np.testing.assert_allclose(given.values, estimated.values, rtol=1e-8)  # the search's tolerance
    # The noise is five times what the file says, known to 1 / sqrt(2 * 200) from 201 rows: 4 sigma of that.
    assert (estimated.bands.sd / given.bands.sd)[0] == pytest.approx(1.0, rel=4.0 / np.sqrt(400.0))


def test_clock_gain_and_offset_of_a_record_are_found(write):
    time = np.linspace(0.0, 0.8, 161)
    own = """
[parameters.shift]
key = "records.swing.clock_shift"
start = "0.01 s"
between = ["0 s", "0.1 s"]
[parameters.gain]
key = "records.swing.columns.angle.gain"
start = 1.0
[parameters.offset]
key = "records.swing.columns.angle.offset"
start = "0 rad"
between = ["-0.1 rad", "0.1 rad"]
"""
    columns = {"angle": 1.1 * closed_form(time + 0.03) + 0.02}
    plan = write(time, columns, parameters=own)
    found = run_fit(plan)
    # As for the closed form above.
    np.testing.assert_allclose(found.values, [STIFFNESS, 0.03, 1.1, 0.02], rtol=1e-5)
    problem = Problem(plan)
    problem.jacobian(problem.start)
    assert problem.runs == 5  # gain and offset take no runs: the middle, and two for stiffness and clock each


def test_a_robust_loss_is_not_moved_by_a_few_wild_rows(write):
    wild = closed_form(TIME) + 1e-4 * np.random.default_rng(1).standard_normal(201)
    wild[::20] += 0.05
    plain = run_fit(write(columns={"angle": wild}))
    robust = run_fit(write(columns={"angle": wild}, more='loss = "cauchy"'))
    assert abs(plain.values[0] - STIFFNESS) > 10.0 * abs(robust.values[0] - STIFFNESS)
    assert robust.bands.low[0] < STIFFNESS < robust.bands.high[0]


def test_many_starts_find_the_lowest_of_many_valleys(write):
    valleys = "difference_step = 1e-5\n[starts]\ncount = 16\nkeep = 3"
    far = {"parameters.stiffness.start": "3 N*m/rad"}
    folder = write(more=valleys).folder
    alone = load_fit(folder / "fit.fit.toml", {"starts": {"replace": True, "count": 2, "keep": 1}} | far)
    single = run_fit(alone.model_copy(update={"starts": None}))
    assert abs(single.values[0] / STIFFNESS - 1.0) > 0.1  # another valley: the phase is off by whole turns
    many = run_fit(load_fit(folder / "fit.fit.toml", far))
    assert many.values[0] == pytest.approx(STIFFNESS, rel=1e-6)
    costs = [one.cost for one in many.searches]
    assert costs == sorted(costs) and costs[0] < 1e-3 * costs[-1]


def test_play_stiffness_restitution_friction_of_another_codes_joint(tmp_path):
    """scripts/bench/fit_coverage.py has a hundred of them."""
    write_record(tmp_path / "test.csv", record(*TRUTH.values(), TIMES), 0)
    (tmp_path / "joint.fit.toml").write_text(FIT)
    found = run_fit(load_fit(tmp_path / "joint.fit.toml"))
    truth = np.array([*TRUTH.values()])
    # Of four bands of 95 % one fails in 5 of 100 draws each; 4 sigma fails in 3 of 10000.
    assert np.all(np.abs(found.values - truth) < 4.0 * found.bands.sd)
    # The mean of 900 squares of normal numbers is 1 to sqrt(2 / 900); 4 sigma of that.
    assert found.bands.chi2 / found.bands.freedoms == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / 900.0))


@pytest.mark.slow
def test_pieces_find_what_one_run_does_not(write):
    """From a spring a quarter as stiff the phase is off by turns; over a quarter of a second it is not."""
    time, far = np.linspace(0.0, 1.0, 101), 'parameters.stiffness.start="10 N*m/rad"'
    columns = {"angle": closed_form(time)}
    folder = write(time, columns).folder
    single = run_fit(load_fit(folder / "fit.fit.toml", [far]))
    write(time, columns, record='pieces = { length = "0.25 s" }')
    pieces = run_fit(load_fit(folder / "fit.fit.toml", [far]))
    assert abs(single.values[0] - STIFFNESS) > 10.0
    # As for the closed form: a run in pieces is one run.
    assert pieces.values[0] == pytest.approx(STIFFNESS, rel=1e-6)
    assert pieces.states.shape == (6,)  # three starts that are free, each of an angle and its rate
    # Pieces that are held together a hundred times as well as rows are known tell as much as one run, but for
    # the square of that.
    held = run_fit(write(time, columns, record='pieces = { length = "0.5 s", weight = 1e6 }'))
    whole = run_fit(write(time, columns))
    assert held.bands.sd[0] == pytest.approx(whole.bands.sd[0], rel=1e-3)


# --- on the disk ---


def test_an_interrupted_fit_goes_on_bit_for_bit(found, write, tmp_path):
    plan = write(parameters=DAMPER)

    def until_seven(runs):
        if runs == 7:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_fit(plan, tmp_path / "fit.nc", progress=until_seven)
    assert (tmp_path / "fit.nc.parts").is_dir() and not (tmp_path / "fit.nc").exists()
    again = []
    resumed = run_fit(plan, tmp_path / "fit.nc", progress=again.append)
    assert len(again) == found.runs - 7  # those of before are not run again
    for name in ("values", "residuals", "slopes"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(found, name))
    assert not (tmp_path / "fit.nc.parts").exists()
    xr.testing.assert_identical(open_fit(tmp_path / "fit.nc").drop_attrs(), resumed.data().drop_attrs())


def test_another_fits_notebook_is_refused(write, tmp_path):
    plan = write()
    store = RunStore(tmp_path / "fit.nc")
    Problem(plan, RunService(store=store))
    store.close()
    other = write(parameters=DAMPER)
    with pytest.raises(OutputError, match="of another fit; what differs: records; name another result"):
        run_fit(other, tmp_path / "fit.nc")


def test_the_scenario_with_the_values_found_loads(found, tmp_path):
    path = found.write_scenario(tmp_path / "fitted.toml")
    spring = load_scenario(path).springs["hinge"]
    assert (spring.stiffness, spring.damping) == tuple(found.values)
    head = path.read_text().splitlines()
    assert head[0] == "# Fitted by antenna-pin fit fit to swing.csv; this is record swing."
    assert head[1].startswith("# stiffness  40 N m/rad")
    assert load_scenario(path).initial.joints["hinge"].angle == FIRST


def test_lmfit_reports_what_was_found(found):
    parameters = found.result().params
    assert parameters["damping"].value == found.values[1]
    assert parameters["damping"].stderr == found.bands.sd[1]
    small = abs(found.bands.covariance[0, 1]) < 0.1 * np.prod(found.bands.sd)
    assert small or "C(stiffness, damping)" in found.report()
    residuals = found.minimizer().userfcn(parameters)
    np.testing.assert_array_equal(residuals, found.residuals)


def test_noise_that_hangs_together_is_told_of_and_counts_where_asked(write):
    """Of an offset in noise of AR(1) the variance is (1 + rho) / (1 - rho) that in white noise.

    Andrews' 49 lags of 4001 rows lose 9 % of it (Bartlett's weights) and are known to 13 %: three of that.
    """
    rho, time = 0.8, np.linspace(0.0, 1.0, 4001)
    white = 1e-4 * np.random.default_rng(11).standard_normal(time.size)
    noise = lfilter([np.sqrt(1.0 - rho**2)], [1.0, -rho], white)
    offset = '[parameters.zero]\nkey = "records.swing.columns.angle.offset"\nstart = "0 rad"'

    def fitted(noise, kind):
        columns = {"angle": closed_form(time) + noise}
        return run_fit(write(time, columns, parameters=offset, more=f'noise = "{kind}"'))

    plain, kept = fitted(noise, "given"), fitted(noise, "correlated")
    assert (kept.bands.sd[1] / plain.bands.sd[1]) ** 2 == pytest.approx((1.0 + rho) / (1.0 - rho), rel=0.48)
    np.testing.assert_array_equal(kept.values, plain.values)
    assert plain.bands.widening == pytest.approx(np.max(kept.bands.sd / plain.bands.sd))
    assert plain.notes[-1].startswith("note: residuals of swing.angle hang together in time: bands are up ")
    assert not kept.notes
    assert not fitted(white, "given").notes


def test_joints_of_pieces_are_no_part_of_what_hangs_together(write):
    problem = Problem(write(record='pieces = { length = "0.25 s" }'))
    joints = problem.count - 201
    np.testing.assert_array_equal(problem.rows.curve_numbers(), [0] * 201 + list(range(1, joints + 1)))


def test_runs_whose_ledger_is_open_are_counted_and_told_of(write):
    """At an order of 5 and a tolerance of 1e-6 none closes to 1e-15."""
    strict = 'integrator.rtol = 1e-6\nintegrator.method = "dormand-prince-54"'
    text = FIT_OF_PENDULUM.replace("integrator.rtol = 1e-10", strict)
    assert not any("balance" in note for note in run_fit(write(text=text)).notes)
    found = run_fit(write(text=text.replace(strict, f"{strict}\nintegrator.ledger_tolerance = 1e-15")))
    (note,) = (note for note in found.notes if "balance" in note)
    runs = found.problem.runs
    assert note.startswith(
        f"note: the energy or momentum of {runs} of {runs} runs does not balance, those with the fitted "
        "values among them: at t = "
    )
    np.testing.assert_allclose(found.values, [STIFFNESS], rtol=1e-4)  # and fitted all the same
