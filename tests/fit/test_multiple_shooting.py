"""The two ways to derivatives, of mechanisms with contacts: by the variational equation and by runs."""

from pathlib import Path

import numpy as np
import pytest
from hinge_record import FIT, TIMES, TRUTH, write_record
from planar_joint import record

from antenna_pin.base.state import State
from antenna_pin.contact.onset import NO_APPROACH
from antenna_pin.studies.fit import Problem, load_fit
from antenna_pin.studies.fit.problem import central_differences
from antenna_pin.studies.fit.runs import difference_from_origin, piece_start, prepared_scenario

EXAMPLES = Path(__file__).parents[2] / "scripts" / "examples"

PAIR = """
scenario = "impact_pair"
case = "planar"
[set]
duration = "16.1 ms"
integrator.engine = "compiled"
clearance.bore.geometry = "closed-form"
clearance.bore.normal = { replace = true, law = "lankarani-nikravesh", stiffness = 1e10, restitution = 0.8 }
[parameters.play]
key = "clearance.bore.radial_clearance"
start = "0.1 mm"
[parameters.stiffness]
key = "clearance.bore.normal.stiffness"
start = "1e10 N/m**1.5"
[parameters.restitution]
key = "clearance.bore.normal.restitution"
start = 0.8
[records.test]
file = "test.csv"
[records.test.columns.x]
of = "journal_position[bore].x"
unit = "um"
sd = "0.5 um"
[records.test.columns.force]
of = "joint_force[bore].x"
unit = "N"
sd = "5 N"
"""


def pair(folder):
    """Write four impacts of two bodies, whose rows do not fall on an onset, at 1 ms: there is no slope."""
    time = 4e-5 * (np.arange(400) + 0.37)
    rows = np.column_stack([time, 0.0 * time, 0.0 * time])
    np.savetxt(folder / "test.csv", rows, delimiter=",", header="time,x,force", comments="")
    return PAIR


def joint(folder):
    """Write the first blows of a planar joint with friction."""
    write_record(folder / "test.csv", record(*TRUTH.values(), TIMES), 0)
    return FIT.replace("[records.test]\n", '[records.test]\nwindow = ["0 s", "25 ms"]\n')


@pytest.mark.slow
@pytest.mark.parametrize("made", [pair, joint])
def test_both_make_the_same_of_a_noise_to_a_hundred_thousandth_of_bands(tmp_path, made):
    text = made(tmp_path).replace("[set]", 'jacobian = "equation"\n[set]\nintegrator.rtol = 1e-12', 1)
    (tmp_path / "a.fit.toml").write_text(text)
    problem = Problem(load_fit(tmp_path / "a.fit.toml"))
    there = problem.start
    by_equation, why = problem._by_equation(there)
    assert not why
    searched, bounds = problem.unknowns.to_search(there), problem.unknowns.bounds()

    def residuals(ends):
        return problem.residuals_at([problem.unknowns.from_search(one) for one in ends])

    fine, coarse = (central_differences(residuals, searched, *bounds, h) for h in (3e-5, 6e-5))
    by_runs = (4.0 * fine - coarse) / 3.0
    noise = np.random.default_rng(0).standard_normal(len(by_runs))
    answers, bands = [], []
    for slopes in (by_equation, by_runs):
        answers.append(np.linalg.lstsq(slopes, noise)[0])
        bands.append(np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes))))
    apart = np.abs(answers[0] - answers[1]) / bands[1]
    # Differences of runs of 1e-12 over 3e-5 of a number err by 1e-7 of that, and by what is bent near an
    # onset, of force like depth^1.5; numbers that hang together make ten times that of it.
    assert apart.max() < 1e-5
    np.testing.assert_allclose(bands[0], bands[1], rtol=1e-5)


def hinge_in_pieces(length, **more):
    """Return the hinge of the examples in pieces: noise takes starts of these into the wall."""
    settings = {"records.test.pieces.length": length, "difference_step": 1e-4}
    settings["set.integrator.rtol"] = 1e-11  # at 1e-10 differences are off by up to 1e-4 for it
    return Problem(load_fit(EXAMPLES / "hinge.fit.toml", settings | more))


def test_a_piece_that_starts_in_the_wall_touches_it():
    in_pieces = hinge_in_pieces("2 ms", **{"records.test.window": ["6 ms", "12 ms"]})
    (rig,) = in_pieces._prepared.record_tests
    play = float(in_pieces.first[0])
    system = prepared_scenario(rig, tuple(in_pieces.first.tolist())).system
    assert {State.from_json(origin).memory[0, 0] for origin in rig.origins} == {0.0, 1.0}
    for origin in rig.origins:
        begun = piece_start(rig.begun, origin, np.zeros(6), system)
        away, touches = np.hypot(*begun.q[:2]), State.from_json(origin).memory[0, 0] == 1.0
        assert touches == (away > play) == (begun.memory[0, 0] == 1.0) == (len(begun.contacts) == 1)
        if touches:
            continue
        q = np.array([*(1.001 * play / away * begun.q[:2]), *begun.q[2:]])
        pushed = piece_start(rig.begun, origin, difference_from_origin(rig.begun, origin, q, begun.v), system)
        assert pushed.memory[0, 0] == 1.0 and len(pushed.contacts) == 1
        assert pushed.memory[0, 1] == NO_APPROACH  # its onset lies before the piece


@pytest.mark.slow
def test_how_deep_and_fast_a_piece_starts_in_the_wall_moves_all_behind_it():
    in_pieces = hinge_in_pieces("4 ms", jacobian="equation")
    found, why = in_pieces._by_equation(np.concatenate([in_pieces.first, in_pieces.states]))
    assert not why
    whole = in_pieces.unknowns.to_search(np.concatenate([in_pieces.first, in_pieces.states]))
    runs = in_pieces._by_runs(whole)
    off = np.linalg.norm(found - runs, axis=0) / np.linalg.norm(runs, axis=0)
    # The error of differences: of the square of their step by parameters, of 1e-5 error scales by starts.
    assert off.max() < 3e-5
