"""What is run: grids, zipped lists, samples and tolerances, and what is refused before anything is."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from antenna_pin import load_scenario, run_study, simulate
from antenna_pin.apps.cli.study import said_of_time
from antenna_pin.base.units import any_quantity
from antenna_pin.errors import AntennaPinError
from antenna_pin.studies.sweep import design_of, driver, jobs, load_study, run_seconds
from antenna_pin.studies.sweep.responses import ResponseSpec, evaluate
from antenna_pin.trajectory import Counts, Outcome

SAMPLED = """
[parameters.play]
key = "clearance.bore.radial_clearance"
between = ["0.1 mm", "0.4 mm"]
[parameters.radius]
key = "clearance.bore.bearing_radius"
tolerance = { nominal = "10 mm", plus = "15 um", minus = "-3 um", sigmas = 2.5 }
[parameters.restitution]
key = "clearance.bore.normal.restitution"
distribution = { name = "beta", a = 6, b = 2 }
"""


def test_a_grid_runs_through_its_last_parameter_first(write):
    design = design_of(write())
    assert design.sizes == {"play": 3, "rate": 4}
    assert design.values(5) == {"play": "0.2 mm", "rate": "2000.0 Hz"}
    assert len(set(design.seeds.tolist())) == design.count == 12


def test_zipped_parameters_go_together(write):
    zipped = """
    [parameters.play]
    key = "clearance.bore.radial_clearance"
    values = ["0.1 mm", "0.2 mm", "0.3 mm"]
    zip = "pair"
    [parameters.rate]
    key = "output.rate"
    values = ["1 kHz", "2 kHz", "3 kHz"]
    zip = "pair"
    [parameters.length]
    key = "duration"
    values = ["1 ms", "2 ms"]
    """
    design = design_of(write(zipped))
    assert design.sizes == {"pair": 3, "length": 2}
    assert design.values(3) == {"play": "0.2 mm", "rate": "2 kHz", "length": "2 ms"}


@pytest.mark.parametrize("method", ["random", "latin-hypercube", "sobol"])
def test_samples_have_their_distributions(write, method):
    study = write(SAMPLED, f'sampling = {{ method = "{method}", count = 1024 }}')
    design = design_of(study)
    columns = {c.name: np.array([v.number for v in c.settings.values]) for c in design.columns}
    half, middle = 9e-6, 10.006e-3
    laws = {
        "play": stats.uniform(1e-4, 3e-4),
        "radius": stats.truncnorm(-2.5, 2.5, loc=middle, scale=half / 2.5),
        "restitution": stats.beta(6, 2),
    }
    for name, law in laws.items():
        # Kolmogorov's distance of 1024 random samples is above 0.06 once in a thousand.
        assert stats.kstest(columns[name], law.cdf).statistic < (0.06 if method == "random" else 0.01)
    # A part outside its limits, by more than round-off, is never assembled.
    assert np.abs(columns["radius"] - middle).max() <= half * (1 + 1e-12)
    again = design_of(study)
    assert [again.values(k) for k in range(9)] == [design.values(k) for k in range(9)]


def test_every_number_reaches_the_scenario_as_it_is(write):
    """Values travel as text with their unit, so that the key checks what they are; nothing is rounded."""
    study = write(SAMPLED, 'sampling = { method = "random", count = 50 }')
    design, base = design_of(study), study.base()
    for run in range(design.count):
        made = base.with_overrides(design.overrides(run, base)).clearance["bore"]
        numbers = [column.settings.values[run].number for column in design.columns]
        assert [made.radial_clearance, made.bearing_radius] == numbers[:2]


def test_one_number_of_an_array(write):
    parameter = """
    [parameters.pull]
    key = "mechanism.gravity[2]"
    values = [-1, "-9.81 m/s**2"]
    """
    study = write(parameter)
    made = study.base().with_overrides(design_of(study).overrides(1, study.base()))
    assert made.mechanism.gravity == (0.0, 0.0, -9.81)


@pytest.mark.parametrize(
    ("value", "found"),
    [
        ("0.2 mm", (0.0002, "m")),
        ("30 deg", (pytest.approx(np.pi / 6, rel=1e-15), "rad")),
        ("2 kHz", (2000.0, "Hz")),
        ("3 N", (3.0, "N")),
        (4, (4.0, "")),
        ("50 %", (0.5, "1")),
        ("steel", None),
        (True, None),
        ("1 dB", None),
    ],
)
def test_a_quantity_of_any_unit(value, found):
    assert any_quantity(value) == found


PLAY = '[parameters.play]\nkey = "clearance.bore.radial_clearance"\n'

REFUSED = {
    "unknown key": (
        '[parameters.play]\nkey = "clearance.bore.radial_clearence"\nvalues = ["0.1 mm"]',
        "run 0 (play = 0.1 mm): scenario impact_pair: clearance.bore.radial_clearence is unknown; "
        "did you mean radial_clearance?",
    ),
    "empty list": (PLAY + "values = []", "parameters.play.values must hold a value at least"),
    "empty range": (
        PLAY + 'start = "0.2 mm"\nstop = "0.2 mm"\ncount = 3',
        "parameters.play.start must be a range that rises, got '0.2 mm' to '0.2 mm'",
    ),
    "outside of what a law allows": (
        '[parameters.e]\nkey = "clearance.bore.normal.restitution"\nvalues = [0.5, 1.2, 1.3]',
        "run 1 (e = 1.2): scenario impact_pair: clearance.bore.normal.restitution must be in [0, 1], got 1.2",
    ),
    "another dimension": (
        PLAY + 'values = ["0.1 mm", "0.1 s"]',
        "run 1 (play = 0.1 s): scenario impact_pair: clearance.bore.radial_clearance must be a length [m]",
    ),
    "cannot be built": (
        '[parameters.at]\nkey = "initial.joints.bore.journal_position"\n'
        'values = [["0 m", "0 m", "0 m"], ["5 mm", "0 m", "0 m"]]',
        "run 1 (at = ",
    ),
    "two of one key": (
        PLAY
        + 'values = ["0.1 mm"]\n[parameters.more]\nkey = "clearance.bore.radial_clearance"\nvalues = [1]',
        "parameters.more.key must be a different key, got that of play",
    ),
    "lengths of zipped lists": (
        PLAY
        + 'values = ["0.1 mm"]\nzip = "a"\n'
        + '[parameters.t]\nkey = "duration"\nvalues = [1, 2]\nzip = "a"',
        "parameters.t must have as many values as play, 1, got 2",
    ),
    "distribution": (
        PLAY + 'distribution = { name = "nrm" }',
        "parameters.play.distribution.name: distribution of scipy.stats 'nrm' is unknown; did you mean norm?",
    ),
    "its parameters": (
        PLAY + 'distribution = { name = "norm", mean = 1 }',
        "parameters.play.distribution must be of parameters that norm takes (loc, scale)",
    ),
    "no width": (
        PLAY + 'distribution = { name = "norm", loc = "1 mm", scale = "0 mm" }',
        "parameters.play.distribution.scale must be positive, got '0 mm'",
    ),
    "shapes of it": (
        PLAY + 'distribution = { name = "beta", a = -1, b = 2 }',
        "parameters.play.distribution must be of parameters that beta allows, got a = -1, b = 2",
    ),
    "one value in two units": (
        PLAY + 'values = ["0.1 mm", "100 um"]',
        "parameters.play.values[1] must be another value than those before it, got '100 um'",
    ),
    "a key within another's table": (
        PLAY
        + 'values = ["0.1 mm"]\n[parameters.all]\nkey = "clearance.bore"\n'
        + 'values = [{ radial_clearance = "1 mm" }]',
        "parameters.all.key must not lie within play's clearance.bore.radial_clearance, nor contain it",
    ),
    "a key that is none": (
        "[parameters.e]\nkey = 3\nvalues = [1]",
        "parameters.e.key must be a key of the scenario, or an array of keys, got 3",
    ),
    "a number of 400 digits": (
        PLAY + f"values = [1{'0' * 400}]",
        "clearance.bore.radial_clearance must be a length [m]",
    ),
    "too many": (
        PLAY + 'start = "0.1 mm"\nstop = "0.2 mm"\ncount = 1000000\n'
        '[parameters.t]\nkey = "duration"\nstart = 1\nstop = 2\ncount = 1000000',
        "must be of at most 10000000 runs, got 1000000000000",
    ),
    "what the engine cannot take": (
        '[parameters.e]\nkey = "integrator.engine"\nvalues = ["pinocchio", "compiled"]',
        "run 1 (e = compiled): engine 'compiled': joint 'bore' has its gaps measured by coal",
    ),
    "no sampling": (PLAY + "between = [1, 2]", "sampling is missing; play has a distribution"),
    "two ways": (PLAY + "between = [1, 2]\nvalues = [1]", "parameters.play must have exactly one of values,"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_refused_before_anything_runs(write, tmp_path, what):
    parameters, said = REFUSED[what]
    with pytest.raises(AntennaPinError) as refusal:
        run_study(write(parameters), tmp_path / "trial.study")
    assert said in str(refusal.value) and "\n" not in str(refusal.value)
    assert not (tmp_path / "trial.study").exists()


@pytest.mark.parametrize(
    ("response", "said"),
    [
        ('a = { measure = "peak_forse" }', "measure 'peak_forse' is unknown; did you mean peak_force?"),
        ('a = { measure = "peak_force", of = "boer" }', "contact or joint with play 'boer' is unknown"),
        ('a = { measure = "pointing" }', "must have its reference"),
        ('a = { measure = "base_turn", of = "x" }', "base_turn has no of"),
        ('a = { function = "nowhere.py:f" }', "a: function must name a file that can be read from"),
        ('a = { function = "nowhere.at.all:f" }', "a: module nowhere.at.all cannot be imported"),
        ('a = { function = "own.py:text" }', "own.py:text must return a number, got 'three'"),
        ('a = { function = "own.py:ends" }', "own.py:ends must return a number, got the exit 3"),
        ('a = { function = "own.py:huge" }', "own.py:huge must return a number, got 1000"),
        ('a = { function = "own.py:flag" }', "own.py:flag must return a number, got true"),
        ('a = { function = "own.py:turned" }', "own.py:turned must return a number, got 1j (complex)"),
        ('a = { function = "own.py:row" }', "own.py:row must return a number, got array([1.]) (ndarray)"),
        (
            'a = { function = "own.py:lonely" }',
            "responses.a: lonely must be a function of 1 argument (run), got",
        ),
        ('a = { function = "math:nothing" }', "math must have a function 'nothing'"),
        ('a = { function = "own.py:wrong" }', "own.py:wrong raises AttributeError"),
        (
            'a = { function = "own.py:changes" }',
            "own.py:changes must not change the run",
        ),
    ],
)
def test_refused_responses(write, tmp_path, response, said):
    (tmp_path / "own.py").write_text(
        "def wrong(run):\n    return run.nothing\n\n\ndef text(run):\n    return 'three'\n\n\n"
        "def ends(run):\n    raise SystemExit(3)\n\n\ndef huge(run):\n    return 10**400\n"
        "def flag(run):\n    return True\n\n\ndef turned(run):\n    return 1j\n\n\n"
        "def row(run):\n    return run.data['q'].values[0, :1] ** 0\n\n\ndef lonely():\n    return 1.0\n"
        "def changes(run):\n    run.data['q'][:] = 0.0\n    return 0.0\n"
    )
    text = (
        'scenario = "impact_pair"\nset.duration = "2 ms"\n{more}{parameters}\n[responses]\n' + response + "\n"
    )
    text = text.replace("{ m", "{{ m").replace("{ f", "{{ f").replace(" }", " }}")
    with pytest.raises(AntennaPinError) as refusal:
        run_study(write(PLAY + 'values = ["0.1 mm"]', text=text), tmp_path / "trial.study")
    assert said in str(refusal.value)
    assert not (tmp_path / "trial.study").exists()


def test_numbers_are_those_of_single_runs(write, tmp_path):
    """Kept values, of a function of the user's own too, are what each run by itself gives, bit for bit."""
    (tmp_path / "own.py").write_text(  # which may do as it likes with what it is given
        "def both(run, seed):\n"
        "    run.data['peak_force'] = 0.0 * run.data['peak_force']\n"
        "    run.data.attrs.clear()\n"
        "    run.end.q[:] = 0.0\n"
        "    return seed + run.counts.accepted\n"
    )
    text = (
        'scenario = "impact_pair"\nresults = "all"\nset.duration = "2 ms"\n{more}{parameters}\n[responses]\n'
        'own = {{ function = "own.py:both" }}\nforce = {{ measure = "peak_force" }}\n'
    )
    table = run_study(write(PLAY + 'values = ["0.05 mm", "0.1 mm"]', text=text), tmp_path / "trial.study")
    for play in (5e-5, 1e-4):
        run = simulate(
            load_scenario("impact_pair", overrides={"duration": 2e-3}).with_overrides(
                {"clearance.bore.radial_clearance": play}
            )
        )
        one = table.sel(play=play)
        assert one["force"] == run.data["peak_force"].max() > 0.0
        assert one["own"] == float(int(one["seed"]) + run.counts.accepted)
        assert one["evaluations"] == run.counts.evaluations
    assert sorted(path.name for path in (tmp_path / "trial.study" / "runs").iterdir()) == [
        "000000.nc",
        "000001.nc",
    ]


def test_runs_are_compared_with_a_full_reference(write, tmp_path, monkeypatch):
    """Another start is off by that at once; a lean one, without series, is refused before anything runs."""
    text = (
        'scenario = "pendulum"\ncase = "ideal"\nset.duration = "1 ms"\nreference.case = "ideal"\n{more}\n'
        'responses.off = {{ measure = "deviation_maximum", of = "hinge angle" }}\n{parameters}'
    )
    starts = '[parameters.start]\nkey = "initial.joints.hinge.angle"\nvalues = [0.3, 0.5]\n'
    reference = 'reference.set."initial.joints.hinge.angle" = 0.3\n'
    with pytest.raises(AntennaPinError, match='reference: output.form must be "full" for runs to be comp'):
        run_study(
            write(starts, reference + 'reference.set."output.form" = "lean"', text), tmp_path / "lean.study"
        )
    table = run_study(write(starts, reference, text), tmp_path / "full.study")
    # In 1 ms gravity turns one by some 5e-6 rad more than the other.
    assert table["off"].values == pytest.approx([0.0, 0.2], abs=1e-5)
    # A signal that comes in the reference's run leaves a part, with which nothing is compared.
    study, run = (
        driver.prepare(write(starts, reference, text)),
        simulate(load_scenario("pendulum"), duration=1e-3),
    )
    stopped = SimpleNamespace(outcome=Outcome.INTERRUPTED)
    made = iter([run, stopped])
    monkeypatch.setattr(jobs, "simulate", lambda *_: next(made))
    monkeypatch.setattr(driver, "simulate", lambda *_, **__: stopped)
    jobs._reference.cache_clear()
    with pytest.raises(KeyboardInterrupt):
        jobs.do_jobs(study.work, [study.job(0)])
    with pytest.raises(KeyboardInterrupt):
        driver.trial(study)


@pytest.mark.parametrize(
    ("given", "unit", "meaning"),
    [
        ({"measure": "peak_force"}, "N", "largest normal force"),
        ({"measure": "peak_force", "of": "bore"}, "N", "largest normal force, bore"),
        ({"measure": "peak_effort", "units": "N"}, "N", "largest size of the torque that holds the motion"),
        (
            {"measure": "deviation_rms", "of": "a angle"},
            "rad",
            "root mean square deviation from the reference, a angle",
        ),
        ({"measure": "pointing"}, "rad", "largest APE of the pointing error, half-cone"),
        (
            {
                "measure": "pointing",
                "index": "RPE",
                "component": "cross",
                "value": "level",
                "confidence": 0.95,
            },
            "rad",
            "95 % level of the RPE of the pointing error, cross",
        ),
        ({"function": "own.py:f", "units": "kg"}, "kg", "own.py:f"),
        ({"function": "own.py:f", "title": "mass"}, "", "mass"),
    ],
)
def test_a_response_is_called_what_it_is(given, unit, meaning):
    """In figures and tables: what is largest or which level, of what; in whose unit."""
    response = ResponseSpec(**given)
    assert response.unit == unit and response.meaning.startswith(meaning)


@pytest.mark.parametrize(
    "responses",
    [
        'responses = ["own.py:turns", "impacts"]\n{more}{parameters}',
        '{more}{parameters}\n[responses]\nturns = "own.py:turns"\nimpacts = "impacts"',
        '{more}{parameters}\n[responses]\nturns.measure = "own.py:turns"\nimpacts.measure = "impacts"',
    ],
)
def test_a_function_stands_where_a_measure_may(write, tmp_path, responses):
    """In a list, as a text and as a measure it is the number of each run that it is as a function."""
    (tmp_path / "own.py").write_text("def turns(run):\n    return run.data.sizes['episode']\n")
    text = 'scenario = "impact_pair"\nset.duration = "2 ms"\n' + responses
    table = run_study(write(PLAY + 'values = ["0.05 mm", "0.1 mm"]', text=text), tmp_path / "a.study")
    assert (table["turns"] == table["impacts"]).all() and (table["turns"] > 0).all()


def test_the_estimate_of_a_run_is_that_of_the_runs(write, monkeypatch):
    """By a clock of the test's own: a run of T takes 0.1 s and 2 s per millisecond, of T = 1 ms to 8 ms.

    The mean of the first, the middle and the last run; what no run is long enough for is made in full.
    """
    study = write('[parameters.t]\nkey = "duration"\nvalues = ["1 ms", "4 ms", "8 ms"]')
    now, made, even = [0.0], [], True

    def simulated(scenario, duration):
        made.append(duration)
        slow = 2e3 * duration if even else 2e3 * max(duration - 3e-4, 0.0)
        now[0] += 0.1 + slow + 40.0 * (len(made) == 1)  # the first one is compiled
        counts = Counts(wall_seconds=slow, compile_seconds=40.0 * (len(made) == 1))
        return SimpleNamespace(counts=counts, outcome=Outcome.COMPLETED)

    monkeypatch.setattr(driver, "simulate", simulated)
    monkeypatch.setattr(driver, "time", SimpleNamespace(perf_counter=lambda: now[0]))
    exact = 0.1 + 2.0 * (1 + 4 + 8) / 3
    assert run_seconds(driver.prepare(study)) == pytest.approx((exact, exact, exact), rel=1e-12)
    assert max(made) < 2e-3
    even, made[:] = False, []  # nothing takes time up to 0.3 ms: what comes then is within the bounds
    found, true = run_seconds(driver.prepare(study)), 0.1 + 2.0 * (0.7 + 3.7 + 7.7) / 3
    assert 2.0 * found.least < true <= found.most * (1.0 + 1e-12)
    said = said_of_time(3, found, 2)
    assert re.fullmatch(r"some [\d.]+ to [\d.]+ s a run, .* some [\d.]+.s to [\d.]+.s on 2 cores", said), said


def test_shipped_studies_can_be_built():
    """The first and the last run of each."""
    from antenna_pin.studies.sweep import list_studies, prepare
    from antenna_pin.studies.sweep.jobs import check_jobs

    assert len(list_studies()) >= 1
    for name in list_studies():
        prepared = prepare(load_study(name))
        ends = (0, prepared.design.count - 1)
        assert check_jobs(prepared.work, [prepared.job(run) for run in ends]) == []


def test_a_response_that_is_no_number_of_a_run_is_said_of_it(write, tmp_path):
    (tmp_path / "own.py").write_text(
        "def late(run):\n    return float(run.data.peak_force[0]) * float('nan')\n"
    )
    text = (
        'scenario = "impact_pair"\nset.duration = "2 ms"\n{more}{parameters}\n[responses]\n'
        'own = {{ function = "own.py:late" }}\n'
    )
    table = run_study(write(PLAY + 'values = ["0.1 mm"]', text=text), tmp_path / "trial.study")
    assert np.isnan(table["own"].values).all()
    assert "response own: it is nan for this run, not a number" in str(table["message"].values.ravel()[0])


def test_measures_of_a_contact_are_of_its_own_blows():
    """And of a joint of all its contacts'; of one that never touched nothing."""
    run = simulate(load_scenario("bai2020", case="case3"), duration=0.05)
    data = run.data
    release = np.nan_to_num(data["release_time"].values, nan=0.05)
    columns = {
        "peak_force": (data["peak_force"].values, np.max),
        "peak_depth": (data["peak_depth"].values, np.max),
        "impulse": (data["impulse"].values, np.sum),
        "dissipated": (data["dissipated"].values, np.sum),
        "contact_time": (release - data["onset_time"].values, np.sum),
        "impacts": (np.ones(len(release)), np.sum),
    }
    names = [str(name) for name in data["contact"].values]
    of = {name: data["episode_contact"].values == k for k, name in enumerate(names)}
    of |= {"elevation": np.ones(len(release), dtype=bool), None: np.ones(len(release), dtype=bool)}
    assert 2 <= sum(mine.any() for name, mine in of.items() if name in names)
    for measure, (values, over) in columns.items():
        for name, mine in of.items():
            found = evaluate("a", ResponseSpec(measure=measure, of=name), "", run, None, 0)
            expected = over(values[mine]) if mine.any() else 0.0
            assert found == pytest.approx(expected, rel=1e-14, abs=0.0), (measure, name)
