"""The shipped cases with flexible links: their numbers, and that they run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from antenna_pin import load_scenario, simulate
from antenna_pin.mechanism.flexible import MassProperties
from antenna_pin.scenario import list_scenarios
from antenna_pin.scenario.assemble import build_system, urdf_variant

CASES = [
    ("bai2020", "flexible", "case3"),
    ("bai2020", "flexible-ideal", "case1"),
    ("bai2020", "petals", "case3"),
    ("bai2020", "petals-ideal", "case1"),
    *(("bai2020", f"nod-{f}hz", "case3") for f in (5, 10, 20, 35, 50)),
    ("you2010", "wings", "planar"),
    ("you2010", "wings-ideal", "ideal"),
]


@pytest.mark.parametrize(("name", "case", "rigid"), CASES, ids=[case for _, case, _ in CASES])
def test_a_flexible_case_is_its_rigid_one_but_for_what_bends(name: str, case: str, rigid: str):
    flexible, other = load_scenario(name, case=case), load_scenario(name, case=rigid)
    told = {"case", "description", "flexible"}
    assert flexible.model_dump(exclude=told) == other.model_dump(exclude=told)
    link = next(iter(flexible.flexible.values())).link
    whole = MassProperties.of_moments(_moments(urdf_variant(flexible), link))
    before = urdf_variant(other).mass_properties(link)
    assert whole.mass == pytest.approx(before.mass, rel=1e-12, abs=0.0)
    assert np.abs(whole.inertia - before.inertia).max() < 1e-12 * before.inertia.max()
    run = simulate(flexible, duration=0.02)
    assert run.completed
    assert run.summary()["conservation"]["energy_error_relative"] < 1e-7


def _moments(urdf: Any, link: str) -> np.ndarray:
    total = urdf.mass_properties(link).moments
    for joint in urdf.robot.joints:
        if joint.parent == link and joint.child.endswith("_body"):
            total = total + urdf.mass_properties(joint.child).moved(urdf.placement(joint.name)).moments
    return np.asarray(total)


def test_no_flexible_case_is_left_out():
    shipped = {(one.name, case.name) for one in list_scenarios() for case in one.cases}
    flexible = {(n, c) for n, c in shipped if load_scenario(n, case=c).flexible}
    assert flexible == {(name, case) for name, case, _ in CASES}


def test_the_modes_take_a_quarter_of_the_dish():
    rigid = urdf_variant(load_scenario("bai2020", case="case1")).mass_properties("reflector")
    parts = build_system(load_scenario("bai2020", case="flexible")).elastic
    # To the four digits that the file gives.
    assert parts["reflector_nod"].moved == pytest.approx(0.25 * rigid.inertia[1, 1], rel=3e-4)
    assert parts["reflector_bend"].moved == pytest.approx(0.25 * rigid.mass, rel=3e-4)


def test_the_wings_are_cantilevers():
    """Frequencies and participations of a uniform beam, from its characteristic equation."""
    wing = load_scenario("you2010", case="wings").flexible["left_wing"].build()
    mass, length = 8.0, 1.2
    roots = [brentq(lambda x: np.cos(x) * np.cosh(x) + 1.0, *span) for span in ((1.0, 3.0), (4.0, 6.0))]
    for k, root in enumerate(roots):
        ratio = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))

        def shape(s: float, root: float = root, ratio: float = ratio) -> float:
            x = root * s
            return float(np.cosh(x) - np.cos(x) - ratio * (np.sinh(x) - np.sin(x)))

        size = np.sqrt(quad(lambda s: shape(s) ** 2, 0.0, 1.0)[0])
        across = quad(shape, 0.0, 1.0)[0] / size
        turning = quad(lambda s: s * shape(s), 0.0, 1.0)[0] / size
        wanted = [np.sqrt(mass) * across, 0, 0, 0, 0, -np.sqrt(mass) * length * turning]
        assert wing.factors[k] == pytest.approx(wanted, rel=1e-5, abs=1e-12)  # six digits in the file
        assert wing.frequency[k] == pytest.approx(3.0 * (root / roots[0]) ** 2, rel=1e-5)
