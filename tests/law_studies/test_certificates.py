"""The instruments themselves: integrated impacts against what is known of them, and the table."""

import dataclasses
import math
import re

import numpy as np
import pytest

from antenna_pin.analysis.law_studies import (
    closed_form_peak_depth,
    closed_form_restitution,
    impact_of_pair,
    impact_on_wall,
    largest_errors,
    restitution_table,
)
from antenna_pin.contact import (
    CustomNormal,
    DampedContact,
    ExactDamping,
    Hertz,
    Johnson,
    KuwabaraKono,
    LankaraniNikravesh,
    LiuFoundation,
)

DIMENSIONS = {"length": 0.025, "journal_radius": 0.0098, "bearing_radius": 0.01, "modulus": 1.1374e11}
LAW = LankaraniNikravesh(stiffness=1e9, restitution=0.7)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
def test_elastic_impact_reaches_the_closed_form(exponent):
    """All kinetic energy becomes spring energy, and comes back; for a linear spring in half a period."""
    law, mass, speed = Hertz(stiffness=1e8, exponent=exponent), 0.4, 0.2
    impact = impact_on_wall(law, mass=mass, speed=speed)
    depth = ((exponent + 1.0) * mass * speed**2 / (2.0 * law.stiffness)) ** (1.0 / (exponent + 1.0))
    assert impact.restitution == pytest.approx(1.0, abs=1e-10)  # integration
    assert impact.peak_depth == pytest.approx(depth, rel=1e-10, abs=0.0)
    assert impact.peak_force == pytest.approx(law.stiffness * depth**exponent, rel=1e-10, abs=0.0)
    assert impact.dissipated == pytest.approx(0.0, abs=1e-10)
    if exponent == 1.0:
        assert impact.duration == pytest.approx(math.pi * math.sqrt(mass / law.stiffness), rel=1e-10)


def test_a_pair_meets_like_its_effective_mass_meets_a_wall():
    wall = impact_on_wall(LAW, mass=0.75, speed=0.3)
    for masses, speeds in (((1.0, 3.0), (0.3, 0.0)), ((3.0, 1.0), (-1.0, -1.3)), ((1.5, 1.5), (0.1, -0.2))):
        pair = impact_of_pair(LAW, masses=masses, speeds=speeds)
        for name in ("restitution", "peak_depth", "peak_force", "duration", "dissipated"):
            assert getattr(pair, name) == pytest.approx(getattr(wall, name), rel=1e-8, abs=0.0), name


def test_energy_lost_is_that_of_the_hysteresis_loop():
    """The loop of force over depth, integrated with the trapezium rule along the motion."""
    mass, speed = 0.4, 0.2
    impact = impact_on_wall(LAW, mass=mass, speed=speed)
    depth, rate, lost, h = 0.0, speed, 0.0, impact.duration / 40000
    while depth >= 0.0:
        half = rate - 0.5 * h * LAW.force(depth, rate, speed) / mass
        middle = depth + 0.5 * h * rate
        force = LAW.force(middle, half, speed)
        lost += h * (force - LAW.elastic_force(middle)) * half
        depth, rate = depth + h * half, rate - h * force / mass
    assert impact.dissipated == pytest.approx(lost, rel=1e-6)  # h^2


def test_a_users_own_law_is_integrated_too():
    own = CustomNormal(force=LAW.force, elastic_force=LAW.elastic_force, elastic_energy=LAW.elastic_energy)
    ours, theirs = (impact_on_wall(law, mass=0.4, speed=0.2) for law in (LAW, own))
    assert theirs.restitution == pytest.approx(ours.restitution, rel=1e-10)
    assert theirs.peak_force == pytest.approx(ours.peak_force, rel=1e-10)


def test_peak_depth_of_any_elastic_law_stores_what_the_closed_form_says():
    mass, speed = 0.4, 0.1
    for elastic in (Hertz(stiffness=1e9), Johnson(**DIMENSIONS), LiuFoundation(**DIMENSIONS)):
        law = DampedContact(elastic=elastic, dissipation=ExactDamping(restitution=0.5))
        chi = law.dissipation.hysteresis
        depth = closed_form_peak_depth(law, mass=mass, speed=speed)
        energy = mass * speed**2 * (1.0 / chi - math.log1p(chi) / chi**2)
        assert law.elastic_energy(depth) == pytest.approx(energy, rel=1e-12, abs=0.0)


def test_peak_depth_is_continuous_in_the_damping():
    """Where the closed form changes to its series."""
    depths = []
    for restitution in np.linspace(0.95, 0.99, 41):
        law = DampedContact(elastic=Hertz(stiffness=1e9), dissipation=ExactDamping(restitution=restitution))
        depths.append(closed_form_peak_depth(law, mass=0.4, speed=0.1))
    second = np.diff(depths, 2)
    assert np.abs(second).max() < 3.0 * np.abs(second).min() + 1e-14 * depths[0]


def test_laws_that_end_or_have_no_closed_form():
    """No depth beyond the range of a law; none said where there is no closed form."""
    law = Johnson(**DIMENSIONS)
    limit = law.elastic_energy(law.depth_limit)
    assert closed_form_peak_depth(law, mass=1.0, speed=math.sqrt(2.02 * limit)) == math.inf
    assert closed_form_peak_depth(law, mass=1.0, speed=math.sqrt(1.98 * limit)) < law.depth_limit
    law = KuwabaraKono(stiffness=1e9, damping=1e3)
    assert closed_form_restitution(law, mass=1.0, speed=0.1) is None
    assert closed_form_peak_depth(law, mass=1.0, speed=0.1) is None


def test_an_impact_beyond_the_range_of_a_law_is_refused():
    """It would go on with a force held; with damping the same speed stays within."""
    law = Johnson(**DIMENSIONS)
    speed = math.sqrt(2.2 * law.elastic_energy(law.depth_limit))
    with pytest.raises(ValueError, match=r"^impact: speed must be lower, for the law ends at depth_limit = "):
        impact_on_wall(law, mass=1.0, speed=speed)
    damped = DampedContact(elastic=law, dissipation=ExactDamping(restitution=0.5))
    impact = impact_on_wall(damped, mass=1.0, speed=speed)
    assert impact.restitution == pytest.approx(0.5, abs=1e-9)
    assert 0.5 * law.depth_limit < impact.peak_depth < law.depth_limit


def test_table_of_what_the_laws_deliver():
    """Closed form against both integrations, for every dissipation that takes a restitution: to 1e-6."""
    asked = (0.05, 0.3, 0.9, 1.0)
    rows = restitution_table(asked=asked)
    names = {row.dissipation for row in rows}
    assert names >= {"exact-restitution", "flores", "tsuji", "jankowski", "gharib-hurmuzlu"}
    assert len(rows) == len(asked) * len(names)
    for row in rows:
        assert row.on_wall == pytest.approx(row.closed_form, abs=1e-6)
        assert row.of_pair == pytest.approx(row.closed_form, abs=1e-6)
        assert row.depth_on_wall == pytest.approx(row.closed_form_depth, rel=1e-6)
        if row.dissipation == "exact-restitution":
            assert row.on_wall == pytest.approx(row.asked, abs=1e-9)


def test_the_pair_of_a_table_meets_as_the_mass_meets_the_wall(monkeypatch):
    """Of the same effective mass and approach speed, one three times the other, their centre at rest."""
    seen, impact = [], impact_of_pair

    def watched(law, *, masses, speeds):
        seen.append((np.array(masses), np.array(speeds)))
        return impact(law, masses=masses, speeds=speeds)

    monkeypatch.setattr("antenna_pin.analysis.law_studies.impacts.impact_of_pair", watched)
    restitution_table(["flores"], (0.5,), mass=0.7, speed=0.2)
    ((masses, speeds),) = seen
    assert 1.0 / np.sum(1.0 / masses) == pytest.approx(0.7, rel=1e-15)
    assert speeds[0] - speeds[1] == pytest.approx(0.2, rel=1e-15)
    assert masses @ speeds == pytest.approx(0.0, abs=1e-16)
    assert masses[0] / masses[1] == pytest.approx(3.0, rel=1e-15)


def test_largest_errors_of_a_table():
    """Of the worst row, whichever of wall and pair is further off; without closed forms there is nothing."""
    rows = restitution_table(["flores"], (0.5, 0.9))
    off, deeper = largest_errors(rows)
    assert 0.0 < off < 1e-9 and 0.0 < deeper < 1e-9  # integration
    worse = dataclasses.replace(rows[0], of_pair=rows[0].closed_form + 0.01)
    deep = dataclasses.replace(rows[1], depth_on_wall=1.2 * rows[1].closed_form_depth)
    assert largest_errors([worse, deep]) == pytest.approx((0.01, 0.2), rel=1e-12)
    none = dataclasses.replace(rows[0], closed_form=math.nan, closed_form_depth=math.nan)
    assert all(map(math.isnan, largest_errors([none])))


def test_table_without_integration_is_quick_and_leaves_them_out():
    rows = restitution_table(["lankarani-nikravesh", "flores"], (0.0, 0.5), simulate=False)
    # Flores refuses zero.
    assert [(row.dissipation, row.asked) for row in rows] == [
        ("lankarani-nikravesh", 0.0),
        ("lankarani-nikravesh", 0.5),
        ("flores", 0.5),
    ]
    assert all(math.isnan(row.on_wall) and math.isnan(row.of_pair) for row in rows)
    assert rows[1].closed_form == pytest.approx(0.7252, abs=5e-5)


REFUSED = {
    "impact_on_wall: mass must be positive and finite [kg], got 0.0": lambda: impact_on_wall(
        LAW, mass=0.0, speed=1.0
    ),
    "impact_on_wall: speed must be positive and finite [m/s], got -1.0": lambda: impact_on_wall(
        LAW, mass=1.0, speed=-1.0
    ),
    "impact_of_pair: speeds must be such that the bodies approach, got (0.0, 0.1)": lambda: impact_of_pair(
        LAW, masses=(1.0, 1.0), speeds=(0.0, 0.1)
    ),
    "impact_of_pair: mass must be positive and finite [kg], got inf": lambda: impact_of_pair(
        LAW, masses=(1.0, math.inf), speeds=(0.1, 0.0)
    ),
    "closed_form_restitution: mass must be positive and finite [kg], got nan": lambda: (
        closed_form_restitution(LAW, mass=math.nan, speed=1.0)
    ),
}


@pytest.mark.parametrize("message", REFUSED)
def test_refusals(message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        REFUSED[message]()


def test_table_refuses_a_dissipation_that_takes_no_restitution():
    with pytest.raises(ValueError, match=r"which take a restitution, got 'kelvin-voigt'$"):
        restitution_table(["kelvin-voigt"])
    with pytest.raises(ValueError, match=r"restitution must be in \(0, 1\]; .* dead, got 1\.5$"):
        restitution_table(["flores"], (1.5,))
