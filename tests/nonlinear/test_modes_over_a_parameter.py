"""Elements with modes over a parameter: diagrams and studies are the runs that they are made of."""

import numpy as np
import pytest

from antenna_pin import build_system, run_study, simulate
from antenna_pin.errors import AntennaPinError
from antenna_pin.studies.nonlinear import Stroboscope, bifurcation, carried
from antenna_pin.studies.sweep import load_study

TABLES = """
[springs.way]
stiffness = 4.0
damping = 0.1
[drives.motor]
joint = "way"
kind = "sine"
amplitude = 2.0
frequency = 0.5
[frictions.rub]
joint = "way"
coulomb = 0.6
static = 0.8
[stops.end]
joint = "way"
kind = "rigid"
upper = 0.3
restitution = 0.6
[output]
rate = "20 Hz"
"""
AMPLITUDE, POINTS, CUT = "drives.motor.amplitude", 32, 8


def along(scenario, key, values):
    """Where the last point is at each value; each begins half a period behind that of the one before."""
    state, points = None, []
    for value in values:
        changed, span = scenario.with_overrides({key: value}), (POINTS + CUT) * 2.0
        if state is None:
            run = simulate(changed, duration=span + 1.0)
        else:
            run = simulate(changed, start=carried(state, build_system(changed)), duration=span)
        state = run.end
        points.append(float(run.data["q"].sel(time=state.reached - 1.0, method="nearest")[0]))
    return np.array(points)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "values"),
    [
        pytest.param(AMPLITUDE, [2.0, 1.5, 0.5, 0.3], marks=pytest.mark.slow),
        ("stops.end.upper", [0.3, 0.32, 0.35]),
    ],
)
def test_a_branch_goes_on_with_the_modes_it_has(rig, key, values):
    """A joint that sticks sticks on where it does: another place than where a fresh start has it."""
    scenario = rig(TABLES)
    found = bifurcation(
        scenario,
        key,
        values,
        Stroboscope(),
        ["q[way]"],
        branches=("fresh", "forward"),
        count=POINTS,
        transient=CUT,
    )
    fresh, forward = found["q[way]"].values[:, :, -1]
    # Runs of one stretch or of several have the same steps but for what is cut at their ends.
    assert forward == pytest.approx(along(scenario, key, values), abs=1e-8)
    alone = [along(scenario, key, [value])[0] for value in values]
    assert fresh == pytest.approx(np.array(alone), abs=1e-8)
    if key == AMPLITUDE:
        assert abs(forward[-1]) > 1e-3 and forward[-1] == pytest.approx(forward[-2], abs=1e-9)
        assert fresh[-1] == 0.0  # a force below what holds it moves nothing


def test_a_state_goes_over_with_what_its_elements_keep(rig):
    """A joint at rest on a stop is at rest on it where it has moved to; one beyond a stop is refused."""
    tables = TABLES.replace("restitution = 0.6", "restitution = 0.0")
    tables = tables.replace('kind = "sine"', 'kind = "constant"')
    tables = tables.replace("amplitude", "value").replace("frequency = 0.5\n", "")
    scenario = rig(tables)
    rests = simulate(scenario, duration=10.0).end
    assert rests.q[0] == pytest.approx(0.3, abs=1e-12) and dict(rests.adjusted)["stops.end.mode"] == 2.0
    there = carried(rests, build_system(scenario.with_overrides({"stops.end.upper": 0.25})))
    assert there.q[0] == pytest.approx(0.25, abs=1e-12) and dict(there.adjusted)["stops.end.mode"] == 2.0
    free = simulate(scenario, duration=0.5).end
    assert free.q[0] > 0.1
    with pytest.raises(AntennaPinError, match="position of way must be within its rigid stop, upper = 0.1"):
        carried(free, build_system(scenario.with_overrides({"stops.end.upper": 0.1})))
    soft = {"joint": "way", "upper": 0.3, "stiffness": 1e3, "law": "elastic", "replace": True}
    scenario = scenario.with_overrides({"stops.end": soft})
    free = simulate(scenario, duration=0.5).end
    there = carried(free, build_system(scenario.with_overrides({"stops.end.upper": 0.1})))
    assert dict(there.adjusted)["stops.end.mode"] == 2.0  # one that gives way is pressed in
    again = dict(carried(there, build_system(scenario)).adjusted)
    assert again["stops.end.mode"] == again["stops.end.approach"] == 0.0


def test_a_study_is_the_runs_that_it_is_made_of(rig, tmp_path):
    """Each begins in the modes that a start has, whatever the run before it has left."""
    scenario = rig(TABLES, duration="6 s")
    text = (
        'scenario = "scenario.toml"\nresults = "all"\n'
        f'[parameters.force]\nkey = "{AMPLITUDE}"\nvalues = [2.0, 0.3, 1.5]\n'
        '[responses]\nlast = { function = "own.py:last" }\n'
    )
    (tmp_path / "own.py").write_text("def last(run):\n    return float(run.data['q'].values[-1, 0])\n")
    (tmp_path / "some.study.toml").write_text(text)
    table = run_study(load_study(tmp_path / "some.study.toml"), tmp_path / "some.study")
    for value in (2.0, 0.3, 1.5):
        run = simulate(scenario.with_overrides({AMPLITUDE: value}))
        assert float(table["last"].sel(force=value)) == float(run.data["q"].values[-1, 0])
