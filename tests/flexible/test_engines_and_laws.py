"""Flexible links in both engines and under every contact law."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.contact import FRICTION_LAWS, NORMAL_LAWS, is_elastic, law_parameters
from antenna_pin.contact.registry import ALIASES

# What laws ask for beside a restitution.
VISCOUS = "stiffness = 1e11, damping = 1e6"
OTHERS = {
    "marhefka-orin": "slope = 0.3",
    "ye": "stiffness = 1e8, restitution = 0.8",
    "pant-wijeyewickrema": "stiffness = 1e8, restitution = 0.8",
    "kelvin-voigt": "stiffness = 1e8, damping = 1e3",
    "kuwabara-kono": VISCOUS,
    "adams-impact": f"{VISCOUS}, full_damping_depth = 1e-6",
}
FRICTION = {
    "coefficient_of_friction": 0.1,
    "static": 0.15,
    "dynamic": 0.1,
    "static_speed": 0.001,
    "dynamic_speed": 0.01,
    "lower_speed": 1e-4,
    "upper_speed": 1e-3,
    "transition_speed": 1e-3,
    "regularisation_speed": 1e-3,
    "stribeck_speed": 5e-3,
    "decay": 100.0,
    "bristle_stiffness": 1e5,
    "bristle_damping": 50.0,
    "dwell_time": 0.05,
}


def run(case: str, engine: str, *overrides: str, duration: float = 0.04) -> Trajectory:
    changes = ["clearance.elevation.geometry=closed-form", f"integrator.engine={engine}", *overrides]
    return simulate(load_scenario("bai2020", case=case, overrides=changes), duration=duration)


def kept(found: Trajectory) -> None:
    assert found.completed, found.message
    ledger = found.summary()["conservation"]
    assert ledger["energy_error_relative"] < 1e-6
    assert ledger["linear_momentum_drift_relative"] < 1e-8
    assert ledger["angular_momentum_drift_relative"] < 1e-8
    assert found.data.sizes["episode"] > 0
    assert float(found.data["peak_deflection"].max()) > 0.0


# Of laws that differ in the number before the damping alone, chi, one.
ALIKE = {alias.name for alias in ALIASES if alias.dissipation.startswith("hysteresis.")} - {
    "flores",
    "pant-wijeyewickrema",
    "bai-zhao",
}


def in_turn(laws):
    """Laws with engines that take turns."""
    return list(zip(laws, itertools.cycle(("pinocchio", "compiled")), strict=False))


NORMAL = [name for name in NORMAL_LAWS if name not in ALIKE]


@pytest.mark.parametrize(("law", "engine"), in_turn(NORMAL))
def test_every_normal_law_meets_a_flexible_dish(law: str, engine: str):
    given = OTHERS.get(law, "" if is_elastic(law) else "restitution = 0.8")
    table = ", ".join(filter(None, [f"law = '{law}'", given, "replace = true"]))
    kept(run("flexible", engine, f"clearance.elevation.normal={{{table}}}"))


@pytest.mark.parametrize(("law", "engine"), in_turn(FRICTION_LAWS))
def test_every_friction_law_meets_a_flexible_dish(law: str, engine: str):
    asked = [name for name, one in law_parameters(FRICTION_LAWS[law]).items() if name in FRICTION]
    table = ", ".join([f"law = '{law}'", *(f"{name} = {FRICTION[name]}" for name in asked), "replace = true"])
    kept(run("flexible", engine, f"clearance.elevation.friction={{{table}}}"))


@pytest.mark.parametrize(
    ("case", "tight"), [("flexible-ideal", 1e-12), ("petals-ideal", 1e-12), ("petals", 1e-9)]
)
def test_both_engines_bend_alike(case: str, tight: float):
    """To round-off without contact; with play to what some impacts make of it."""
    ideal = "ideal" in case
    ours, theirs = (
        simulate(
            load_scenario(
                "bai2020",
                case=case,
                overrides={
                    "integrator.engine": engine,
                    **({} if ideal else {"clearance.elevation.geometry": "closed-form"}),
                },
            ),
            duration=0.05,
        )
        for engine in ("compiled", "pinocchio")
    )
    times = np.arange(1, 50) / 1e3
    found: list[Any] = [
        one.data["deflection"].sel(time=times, method="nearest").values for one in (ours, theirs)
    ]
    assert np.abs(found[0] - found[1]).max() < tight  # of 1e-4 rad and more
    lost = [one.data["total_elastic_loss"].values for one in (ours, theirs)]
    assert lost[0] == pytest.approx(lost[1], rel=1e-5, abs=1e-12)
