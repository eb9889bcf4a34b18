"""The solar array and the reaction wheel under models/: what their READMEs promise."""

import tomllib

import numpy as np
import pytest

from antenna_pin import build_system, load_scenario, models_path, simulate

CASES = [
    (model, case)
    for model in ("reaction_wheel", "solar_array")
    for case in tomllib.loads((models_path() / model / "scenario.toml").read_text())["cases"]
]


@pytest.mark.parametrize(("model", "case"), CASES)
def test_the_readme_names_every_case(model, case):
    assert f"| `{case}` |" in (models_path() / model / "README.md").read_text()


def assert_momentum_stays(run, share):
    assert run.completed, run.message
    for name, scale in (("linear_momentum", "momentum_scale"), ("angular_momentum", "angular_momentum_scale")):
        momentum = run.data[name].values
        assert np.abs(momentum - momentum[0]).max() < share * float(run.data[scale].max())


# --- reaction wheel ------------------------------------------------------------------------------------------

WHEEL, SATELLITE, SPIN = 3.0, 100.0, 100 * np.pi
STATIC, DYNAMIC = 1e-5, 1e-7
ACROSS, ALONG, BODY = 0.009, 0.015, 8.0


def swing(run, index, turns=5):
    """Amplitude of a velocity at the wheel's speed, over its last turns, beside a slow drift."""
    time = run.data.time.values - run.data.time.values[-1]
    late = time >= -turns * 0.02
    time, values = time[late], run.data.v.values[late, index]
    columns = [time**0, time, time**2, np.cos(SPIN * time), np.sin(SPIN * time)]
    return np.hypot(*np.linalg.lstsq(np.stack(columns, axis=-1), values, rcond=None)[0][3:])


@pytest.fixture(scope="module")
def rigid():
    return simulate(load_scenario("reaction_wheel", case="ideal"))


def test_a_rigid_shaft_carries_m_e_w2(rigid):
    """The satellite's velocity swings by m e w / (M + m), so that the force is m e w^2 M / (M + m)."""
    assert_momentum_stays(rigid, 1e-9)
    # The satellite has turned by some microradians, and the wheel's speed swings as little.
    assert swing(rigid, 0) == pytest.approx(STATIC * SPIN / (SATELLITE + WHEEL), rel=1e-4)
    assert swing(rigid, 1) == pytest.approx(STATIC * SPIN / (SATELLITE + WHEEL), rel=1e-4)


def test_a_tilted_axis_of_inertia_turns_the_satellite(rigid):
    """The torque D w^2 goes round with the wheel; what it turns is both bodies, less the wheel's gyration."""
    rate = DYNAMIC * SPIN / (BODY + ACROSS - ALONG)
    # As above.
    assert swing(rigid, 3) == pytest.approx(rate, rel=1e-4)
    assert swing(rigid, 4) == pytest.approx(rate, rel=1e-4)


def test_bearings_enlarge_the_force(rigid):
    """A rotor on springs below its critical speed: 1 / (1 - (w / w_n)^2) of the rigid one's."""
    scenario = load_scenario("reaction_wheel", case="bearings")
    run = simulate(scenario)
    assert_momentum_stays(run, 1e-7)
    radial = build_system(scenario).families["bearings"]["shaft"].stiffness[0, 0]
    critical = radial * (WHEEL + SATELLITE) / (WHEEL * SATELLITE)
    enlarged = 1 / (1 - SPIN**2 / critical)
    # A third of a per cent; found to a tenth of that.
    assert swing(run, 0) / swing(rigid, 0) - 1 == pytest.approx(enlarged - 1, rel=0.1)
