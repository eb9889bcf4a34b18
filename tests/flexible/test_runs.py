"""Runs of flexible links: closed forms over time, ledgers, the rigid limit, refusals in one line."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from flexible_links import KINDS, MODES

from antenna_pin import AntennaPinError, RunSettings, System, Urdf, build_mechanism, load_scenario, simulate
from antenna_pin.analysis import elastic_motion, modal_energy, said_of_spin
from antenna_pin.mechanism.flexible import EffectiveMode, EffectiveModes, split
from antenna_pin.scenario.assemble import build_system

BLOCK = """<robot name="block">
  <link name="block">
    <inertial><mass value="8"/><inertia ixx="1" iyy="0.7" izz="0.7" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
</robot>"""


def block(base: Any, ratio: float, frequency: float = 15.0) -> System:
    """A block of 8 kg whose mode shifts 2 kg of it along y, through its mass centre."""
    urdf = Urdf.from_text(BLOCK, "block")
    mode = EffectiveMode(frequency=frequency, damping_ratio=ratio, mass=2.0, direction=(0.0, 1.0, 0.0))
    made = split(EffectiveModes(modes={"shift": mode}), "block", urdf.mass_properties("block"), "block")
    mechanism = build_mechanism(urdf.with_parts("block", made), base, (0.0, 0.0, 0.0))
    return System(mechanism, elastic={part.name: part for part in made.parts})


@pytest.mark.parametrize(("base", "factor"), [("fixed", 1.0), ("free", np.sqrt(8.0 / 6.0))])
def test_a_mode_swings_as_the_closed_form_says(base: Any, factor: float):
    """Of its own frequency where the hub is held, of omega / sqrt(1 - m/M) where it floats.

    Fifty periods at rtol 1e-12: a relative error of the frequency of 1e-9 would be 3e-7 of phase.
    """
    system = block(base, 0.0)
    omega, q = 2.0 * np.pi * 15.0 * factor, system.neutral()
    q[-1] = 1e-3
    run = simulate(system, duration=50.0 / 15.0, q=q, settings=RunSettings(rtol=1e-12))
    times, found = run.data["time"].values, run.data["deflection"].values[:, 0]
    assert np.abs(found - 1e-3 * np.cos(omega * times)).max() < 1e-3 * 1e-7
    # The phase over all periods gives the frequency: where cosine passes zero, its slope is one.
    last = int(np.argmin(np.abs(found[-100:]))) + len(found) - 100
    phase = np.arccos(found[last] / 1e-3)
    turned = omega * times[last] / (2.0 * np.pi)
    whole = min(
        (n + s * phase / (2.0 * np.pi) for n in range(80) for s in (1, -1)), key=lambda x: abs(x - turned)
    )
    assert whole / times[last] == pytest.approx(omega / (2.0 * np.pi), rel=1e-9, abs=0.0)


def test_free_decay_has_the_damping_ratio_asked_for():
    """The energy against the held hub falls by exp(-4 pi zeta) from period to period; all of it is booked."""
    ratio, system = 0.005, block("fixed", 0.005)
    q = system.neutral()
    q[-1] = 1e-3
    run = simulate(system, duration=2.0, q=q, settings=RunSettings(rtol=1e-11))
    damped = 2.0 * np.pi * 15.0 * np.sqrt(1.0 - ratio**2)
    period = 2.0 * np.pi / damped
    energy = np.interp(
        [0.0, 29.0 * period], run.data["time"].values, np.log(modal_energy(run)[:, 0])
    )  # the logarithm falls in steps, twice a period: at whole periods it is on its line
    found = (energy[0] - energy[1]) / (4.0 * np.pi * 29.0) * np.sqrt(1.0 - ratio**2)
    assert found == pytest.approx(ratio, rel=1e-4, abs=0.0)
    left = modal_energy(run)[:, 0]
    lost = run.data["dissipation_elastic"].values[:, 0]
    # rtol counts against lengths of 1 m, the deflection is a thousandth of it.
    assert np.abs(left + lost - left[0]).max() < 1e-8 * left[0]
    assert float(run.data["total_elastic_loss"][0]) == pytest.approx(lost[-1], rel=1e-15)
    assert "spring" not in run.data.dims


@KINDS
def test_energy_and_momentum_are_kept_with_play(overrides: dict[str, Any]):
    """Elastic parts' energy and loss are entries of their own, without which the balance does not close."""
    run = simulate(load_scenario("bai2020", case="case3", overrides=overrides), duration=0.1)
    data = run.data
    assert run.completed
    kept = run.summary()["conservation"]
    assert kept["energy_error_relative"] < 1e-7
    assert kept["linear_momentum_drift_relative"] < 1e-9
    assert kept["angular_momentum_drift_relative"] < 1e-9
    stored = data["kinetic_energy"] + data["contact_energy"] + data["elastic_energy"].sum("elastic_part")
    lost = sum(data[f"dissipation_{name}"].sum(("contact",)) for name in ("normal", "friction"))
    own = data["dissipation_elastic"].sum("elastic_part")
    balance = stored - stored[0] - data["drive_work"].sum("drive") + lost + own
    assert np.abs(balance - data["energy_error"]).max() < 1e-15
    assert float(own[-1]) > 10.0 * kept["energy_error"]
    assert not data["spring_energy"].any()
    assert list(data["joint"].values) == ["azimuth", "elevation"]


def test_the_rigid_dish_is_the_limit_of_stiff_modes():
    """What is left of a mode driven far below its frequency is its deflection, of the order omega^-2."""

    def end(frequency: float | None) -> float:
        overrides: dict[str, Any] = {"integrator.rtol": 1e-11}
        if frequency is not None:
            nod = {"frequency": frequency, "damping_ratio": 0.3, "inertia": 0.17, "direction": [0, 1, 0]}
            overrides["flexible.reflector"] = {"kind": "modes", "modes": {"nod": nod}}
        run = simulate(load_scenario("bai2020", case="case1", overrides=overrides), duration=0.3)
        return float(run.data["final_angle"].sel(joint="elevation"))

    rigid = end(None)
    errors = np.abs([end(frequency) - rigid for frequency in (40.0, 80.0, 160.0)])
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.abs(orders - 2.0).max() < 0.05, (errors, orders)


def test_a_hub_that_spins_near_a_parts_frequency_is_said():
    spinning = {"initial.base.angular_velocity": [0.0, 0.0, 40.0]}
    run = simulate(load_scenario("bai2020", case="case1", overrides={**MODES, **spinning}), duration=0.01)
    # 40 rad/s over 2 pi 15 Hz, and a little more of what the azimuth adds.
    assert float(elastic_motion(run)["spin_ratio"].max()) == pytest.approx(0.424, abs=0.01)
    assert "soften with spin" in said_of_spin(run)
    spinning = {"initial.base.angular_velocity": [0.0, 0.0, 100.0]}
    run = simulate(load_scenario("bai2020", case="case1", overrides={**MODES, **spinning}), duration=0.01)
    assert "runs away" in said_of_spin(run)
    assert (
        said_of_spin(simulate(load_scenario("bai2020", case="case1", overrides=MODES), duration=0.01)) == ""
    )


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (
            {"flexible.reflector.modes.rock.frequency": "-3 Hz"},
            "flexible.reflector.modes.rock.frequency must be positive",
        ),
        (
            {"flexible.reflector.modes.rock": {**MODES["flexible.reflector"]["modes"]["rock"], "mass": 9.0}},
            "reflector_rock must be lighter than its link, 8.005 kg, got 9 kg",
        ),
        (
            {"flexible.reflector.modes.rock.place": [1, 1, 1]},
            "reflector_rock takes too much inertia: the hub would have principal moments of inertia",
        ),
        (
            {"flexible.reflector.modes.rock.frequency": "600 Hz"},
            "flexible.reflector.modes.rock.frequency must be below half of output.rate = 1000 Hz",
        ),
        (
            {"springs.reflector_rock": {"joint": "azimuth", "damping": 1.0}},
            "springs.reflector_rock: must have another name",
        ),
        (
            {"flexible.other": {**MODES["flexible.reflector"], "link": "reflectr"}},
            "link 'reflectr' is unknown; did you mean reflector?",
        ),
    ],
)
def test_bad_input_is_one_clear_line(overrides: dict[str, Any], said: str):
    with pytest.raises(AntennaPinError) as error:
        scenario = load_scenario("bai2020", case="case1", overrides=MODES)
        build_system(scenario.with_overrides(overrides))
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_negative_stiffness_is_refused():
    with pytest.raises(AntennaPinError, match="stiffness must be positive"):
        EffectiveMode(stiffness=-1.0, mass=1.0, direction=(1.0, 0.0, 0.0))
