"""Orders of a wheel against signals that are known, and against the imbalance of a wheel."""

from __future__ import annotations

import numpy as np
import pytest

from antenna_pin.analysis import LOAD_AXES, SpeedRecord, speed_records, wheel_orders
from antenna_pin.errors import AntennaPinError
from antenna_pin.run.simulation import simulate
from antenna_pin.scenario import load_scenario
from antenna_pin.studies.verification import measured_orders

ORDERS = np.array([0.37, 1.0, 2.31, 4.9])
# (order, axis): as of a wheel in Masterson et al., forces in kg m, moments in kg m^2.
COEFFICIENTS = np.array(
    [
        [2e-7, 2e-7, 0.0, 1e-8, 1e-8, 0.0],
        [1e-5, 1e-5, 3e-7, 2e-6, 2e-6, 0.0],
        [6e-7, 4e-7, 5e-7, 9e-8, 9e-8, 0.0],
        [1e-6, 8e-7, 2e-6, 1e-7, 2e-7, 0.0],
    ]
)


def _record(speed: float, gain: float = 1.0, growth: float = 0.0, turns: float = 30.0) -> SpeedRecord:
    """A record that begins at a speed, with phases of its own; the third order's gain apart."""
    time = np.linspace(0.0, 2.0 * np.pi * turns / speed, int(64 * turns))
    angle, rate = speed * time + 0.5 * growth * time**2, speed + growth * time
    phases = np.random.default_rng(3).uniform(0.0, 6.0, COEFFICIENTS.shape)
    scaled = COEFFICIENTS * np.array([1.0, 1.0, gain, 1.0])[:, None]
    turned = ORDERS[None, :, None] * angle[:, None, None] + phases
    loads = (rate**2)[:, None] * (scaled * np.sin(turned)).sum(axis=1)
    return SpeedRecord(angle, rate, loads + [0.0, 0.0, -7.0, 0.0, 0.2, 0.0])


@pytest.mark.parametrize("growth", [0.0, 30.0], ids=["steady", "run-up"])
def test_known_orders_are_found(growth):
    """Harmonics and coefficients of a sum of sines, phases too; nothing is left, on a run-up neither."""
    records = [_record(speed, growth=growth) for speed in (200.0, 310.0, 405.0, 520.0, 600.0)]
    found = wheel_orders(records, count=4)
    # Least squares of signals without noise: round-off of amplitudes of up to 3.6 N beside a weight of 7 N.
    assert found["order"].values == pytest.approx(ORDERS, rel=1e-9)
    assert found["coefficient"].values == pytest.approx(COEFFICIENTS, rel=1e-6, abs=1e-15)
    assert not found["resonant"].values.any()
    assert found["rest"].values.max() < 1e-9
    given = wheel_orders(records, harmonics=ORDERS)
    assert given["coefficient"].values == pytest.approx(COEFFICIENTS, rel=1e-9, abs=1e-16)


def test_a_resonance_is_flagged_and_left_out():
    """An order that a structure amplifies threefold at one speed keeps its coefficient, and says where."""
    speeds = (200.0, 310.0, 405.0, 520.0, 600.0)
    records = [_record(speed, gain=3.0 if speed == 405.0 else 1.0) for speed in speeds]
    found = wheel_orders(records, harmonics=ORDERS)
    assert found["coefficient"].values == pytest.approx(COEFFICIENTS, rel=1e-9, abs=1e-16)
    flagged = found["resonant"]
    assert flagged.sel(order=2.31, speed=405.0, method="nearest").values.tolist() == [True] * 5 + [False]
    assert int(flagged.sum()) == 5


def test_imbalance_of_a_wheel():
    """On a fixed satellite: C_1 = U_s of 10 g mm and U_d of 100 g mm^2, by the wheel's mass and inertia."""
    scenario = load_scenario("reaction_wheel", "ideal", {"mechanism.base": "fixed"})
    found = measured_orders(scenario, "shaft", ["1000 rpm", "5000 rpm"], count=4)
    # What is found is the spin itself, beside round-off.
    assert found["order"].values == pytest.approx([1.0], rel=1e-9)
    expected = {"fx": 1e-5, "fy": 1e-5, "fz": 0.0, "mx": 1e-7, "my": 1e-7, "mz": 0.0}
    own = dict(zip(LOAD_AXES, found["coefficient"].values[0], strict=True))
    # Runs to a tolerance of 1e-10.
    assert own == pytest.approx(expected, rel=1e-8, abs=1e-18)


def test_wheel_on_soft_bearings_passes_its_resonance():
    """The force is U_s w^2 / (1 - w^2 / w_n^2): flagged where that is far from one, by a quarter."""
    stiffness, mass = 1.2e6, 3.0
    bearing = {"kind": "stiffness", "replace": True, "damping_time": 5e-4}
    bearing |= {"radial": stiffness, "axial": stiffness, "tilt": 1e4}
    changes = {"mechanism.base": "fixed", "bearings.shaft": bearing}
    scenario = load_scenario("reaction_wheel", "bearings", changes)
    speeds = [60.0, 90.0, 120.0, 150.0, 180.0, 560.0, 640.0]
    found = measured_orders(scenario, "shaft", speeds, harmonics=[1.0])
    over = np.array(speeds) * np.sqrt(mass / stiffness)
    damped = 5e-4 * np.array(speeds)
    gain = np.abs((1.0 + 1j * damped) / (1.0 - over**2 + 1j * damped))
    radial = found["amplitude"].sel(axis="fx").values[0] / (1e-5 * np.array(speeds) ** 2)
    assert radial == pytest.approx(gain, rel=1e-2)
    flagged = found["resonant"].sel(axis="fx").values[0]
    assert flagged.tolist() == (np.maximum(gain / np.median(gain), np.median(gain) / gain) > 1.25).tolist()
    assert flagged[-2:].all() and not flagged[:4].any()


def test_refusals():
    """One line each: too few speeds, a wheel that stands, too coarse samples, no such joint."""
    with pytest.raises(AntennaPinError, match="records must be 3 or more, at different speeds, got 2"):
        wheel_orders([_record(200.0), _record(300.0)])
    coarse = SpeedRecord(*(one[::16] for one in _record(200.0)))
    with pytest.raises(AntennaPinError, match="sampled 8 times in a turn or more: raise output.rate"):
        wheel_orders([coarse] * 3)
    with pytest.raises(AntennaPinError, match="of 2 turns or more"):
        wheel_orders([_record(200.0, turns=1.5)] * 3)
    run = simulate(load_scenario("reaction_wheel", "ideal"), duration=0.01)
    with pytest.raises(AntennaPinError, match="joint 'shat' is unknown; did you mean shaft"):
        speed_records(run, "shat")
    still = simulate(
        load_scenario("reaction_wheel", "ideal", {"initial.joints.shaft.rate": 0}), duration=0.01
    )
    with pytest.raises(AntennaPinError, match="of a joint that turns one way all the time"):
        speed_records(still, "shaft")
    scenario = load_scenario("reaction_wheel", "ideal")
    with pytest.raises(AntennaPinError, match="speeds must be positive speeds that rise"):
        measured_orders(scenario, "shaft", ["3000 rpm", "1000 rpm"])
