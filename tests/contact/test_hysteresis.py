"""Hysteresis damping: what each factor is, and what an impact makes of it."""

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from antenna_pin.analysis.law_studies import (
    closed_form_peak_depth,
    closed_form_restitution,
    impact_of_pair,
    impact_on_wall,
)
from antenna_pin.contact import (
    DISSIPATIONS,
    DampedContact,
    ExactDamping,
    ExactRestitution,
    FloresDamping,
    GonthierDamping,
    Hertz,
    HertzLine,
    Johnson,
    LankaraniNikravesh,
    LiuFoundation,
    MarhefkaOrinDamping,
    PantWijeyewickremaDamping,
    Persson,
    delivered_restitution,
    exact_hysteresis,
    law_parameters,
)
from antenna_pin.contact.hysteresis import HysteresisDamping, stored_share

from .conftest import DIMENSIONS

FACTORS = {name: cls for name, cls in DISSIPATIONS.items() if issubclass(cls, HysteresisDamping)}

# The factors as the literature has them, evaluated by hand at c_r = 0.6.
AT_SIX_TENTHS = {
    "hunt-crossley": 1.5 * 0.4,
    "herbert-mcwhannell": 6 * 0.4 / (0.2**2 + 3),
    "lee-wang": 0.75 * 0.4,
    "lankarani-nikravesh": 0.75 * 0.64,
    "gonthier": 0.64 / 0.6,
    "zhiying-qishao": 0.75 * 0.64 * math.exp(0.8),
    "ye": 1.5 * 0.4 / 0.6,
    "flores": 1.6 * 0.4 / 0.6,
    "gharib-hurmuzlu": 1 / 0.6,
    "hu-guo": 1.5 * 0.4 / 0.6,
    "carvalho-martins": 1.5 * 0.4 * 10.4 / 6.4,
    "pant-wijeyewickrema": 1.5 * 0.64 / 0.36,
}


def delivery(cls, asked):
    """What an impact makes of a law of this form."""
    chi = cls(restitution=asked).hysteresis
    return delivered_restitution(chi, approach_only=cls.approach_only)


def test_every_factor_is_checked_below():
    assert set(FACTORS) == {*AT_SIX_TENTHS, "exact-restitution"}


@pytest.mark.parametrize("name", AT_SIX_TENTHS)
def test_docstring_formulas(name):
    law = DISSIPATIONS[name](restitution=0.6)
    assert law.hysteresis == pytest.approx(AT_SIX_TENTHS[name], rel=1e-14, abs=0.0)  # round-off


@pytest.mark.parametrize("name", FACTORS)
def test_full_restitution_has_no_damping(name):
    expected = 1.0 if name == "gharib-hurmuzlu" else 0.0
    assert FACTORS[name](restitution=1.0).hysteresis == expected


@pytest.mark.parametrize("name", FACTORS)
def test_less_restitution_is_more_damping(name):
    factors = [FACTORS[name](restitution=c).hysteresis for c in np.linspace(0.05, 1.0, 39)]
    assert (np.diff(factors) < 0.0).all()


# --- what a factor delivers ---


@settings(deadline=None, derandomize=True)
@given(st.floats(0.01, 1.0))
def test_exact_factor_delivers_what_is_asked_for(restitution):
    assert delivered_restitution(exact_hysteresis(restitution)) == pytest.approx(
        restitution,
        rel=1e-14,  # round-off
        abs=0.0,
    )


@settings(deadline=None, derandomize=True)
@given(st.floats(1e-12, 1e3))
def test_delivered_restitution_solves_its_equation(chi):
    c = delivered_restitution(chi)
    assert 0.0 < c <= 1.0 and c <= 1.0 / chi
    if chi > 0.1 and 1.0 - chi * c > 1e-6:
        left, right = chi * (1.0 + c), math.log((1.0 + chi) / (1.0 - chi * c))
        # What 1 - chi c loses, it loses relative to itself.
        assert left == pytest.approx(right, abs=2e-16 * (2.0 + left + 2.0 / (1.0 - chi * c)), rel=2e-15)
    elif chi <= 0.1:
        # 1 - c = chi (2/3 + ...): from the series of the equation.
        assert 1.0 - c == pytest.approx(2.0 / 3.0 * chi, rel=chi, abs=2e-16)


def test_small_damping_loses_two_thirds_of_the_factor():
    assert exact_hysteresis(1.0 - 1e-9) == pytest.approx(1.5e-9, rel=1e-6, abs=0.0)  # 1 - c has 8 digits
    assert exact_hysteresis(1.0) == 0.0
    assert delivered_restitution(0.0) == 1.0


def test_exact_factor_tends_to_that_of_gharib_and_hurmuzlu():
    assert exact_hysteresis(0.05) == pytest.approx(20.0, rel=1e-7, abs=0.0)  # 1 - exp(-21)
    assert exact_hysteresis(0.5) < 2.0


def test_what_docstrings_say_each_law_delivers():
    """Every "b for a" and "at least" of the docstrings."""
    said = 0
    for cls in FACTORS.values():
        text = " ".join((cls.__doc__ or "").split())
        for delivered, asked in re.findall(r"(0\.\d+) for (0\.\d+)", text):
            got = delivery(cls, float(asked))
            assert got == pytest.approx(float(delivered), abs=0.51 * 10.0 ** -(len(delivered) - 2)), cls
            said += 1
        for least in re.findall(r"at least (0\.\d+)", text):
            assert delivery(cls, 0.0) == pytest.approx(float(least), abs=5.1e-4)
            said += 1
    assert said > 25


def test_gonthier_below_a_third_and_carvalho_martins_above_stay_close():
    """Within 0.006 of the specified value for, from 0.05 on."""
    for asked in np.linspace(0.05, 1.0, 96):
        cls = GonthierDamping if asked < 1.0 / 3.0 else DISSIPATIONS["carvalho-martins"]
        assert delivered_restitution(cls(restitution=asked).hysteresis) == pytest.approx(asked, abs=0.006)


# --- against integrated impacts ---


@pytest.mark.parametrize("exponent", [1.0, 1.5])
@pytest.mark.parametrize("name", FACTORS)
def test_impacts_deliver_the_closed_form(name, exponent):
    """Fixed wall and free pair, two masses: closed form and integration agree to 1e-6, and depth too."""
    for mass, speed, asked in ((0.02, 0.5, 0.9), (70.0, 0.003, 0.2)):
        law = DampedContact(
            elastic=Hertz(stiffness=1e9 if exponent == 1.5 else 1e7, exponent=exponent),
            dissipation=FACTORS[name](restitution=asked),
        )
        expected = closed_form_restitution(law, mass=mass, speed=speed)
        wall = impact_on_wall(law, mass=mass, speed=speed)
        pair = impact_of_pair(law, masses=(3.0 * mass, 1.5 * mass), speeds=(0.4 * speed, -0.6 * speed))
        # Asked for: 1e-6. The integration's own error is 1e-10.
        assert wall.restitution == pytest.approx(expected, abs=1e-9)
        assert pair.restitution == pytest.approx(expected, abs=1e-9)
        depth = closed_form_peak_depth(law, mass=mass, speed=speed)
        assert wall.peak_depth == pytest.approx(depth, rel=1e-9, abs=0.0)
        assert pair.peak_depth == pytest.approx(depth, rel=1e-9, abs=0.0)


@pytest.mark.parametrize(
    "elastic",
    [law(**DIMENSIONS) for law in (HertzLine, Johnson, LiuFoundation, Persson)],
    ids=lambda law: type(law).__name__,
)
def test_the_closed_form_holds_for_any_elastic_law(elastic):
    for asked in (0.3, 0.9):
        law = DampedContact(elastic=elastic, dissipation=ExactDamping(restitution=asked))
        impact = impact_on_wall(law, mass=0.4, speed=0.1)
        assert impact.restitution == pytest.approx(asked, abs=1e-9)
        depth = closed_form_peak_depth(law, mass=0.4, speed=0.1)
        assert impact.peak_depth == pytest.approx(depth, rel=1e-9, abs=0.0)


@pytest.mark.parametrize(
    ("asked", "expected"), [(0.9, 0.90213), (0.7, 0.71368), (0.5, 0.52543), (0.3, 0.32813), (1.0, 1.0)]
)
def test_pant_and_wijeyewickrema_damp_in_the_approach_only(asked, expected):
    """Their spring gives back all that it has stored: c^2 / 2 is the share of m v^2 stored."""
    for elastic in (Hertz(stiffness=1e7, exponent=1.0), Johnson(**DIMENSIONS)):
        law = DampedContact(elastic=elastic, dissipation=PantWijeyewickremaDamping(restitution=asked))
        assert closed_form_restitution(law, mass=0.4, speed=0.1) == pytest.approx(expected, abs=6e-6)
        wall = impact_on_wall(law, mass=0.4, speed=0.1)
        assert wall.restitution == pytest.approx(expected, abs=6e-6)
        share = elastic.elastic_energy(wall.peak_depth) / (0.4 * 0.1**2)
        assert wall.restitution == pytest.approx(math.sqrt(2.0 * share), rel=1e-9, abs=0.0)


def test_each_dissipation_acts_in_the_phases_of_its_publication():
    """Two are published for the approach only; of all others the way back is weaker than the spring."""
    more = {"restitution": 0.6, "effective_mass": 0.7, "damping": 30.0, "full_damping_depth": 2e-6}
    more |= {"slope": 0.5}
    for name, cls in DISSIPATIONS.items():
        dissipation = cls(**{key: more[key] for key in law_parameters(cls)})
        law = DampedContact(elastic=Hertz(stiffness=3.7e9), dissipation=dissipation)
        elastic = law.elastic_force(3e-6)
        inward, outward = (law.force(3e-6, rate, 0.1) for rate in (0.05, -0.01))
        assert (inward > elastic) == (name != "none"), name
        assert (outward < elastic) == (name not in ("none", "jankowski", "pant-wijeyewickrema")), name


@settings(deadline=None, derandomize=True)
@given(st.floats(1e-9, 1e3))
def test_share_that_is_stored_is_the_integral_over_the_approach(chi):
    """U / (m v0^2) is that of x / (1 + chi x) over x from 0 to 1."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    # In y = ln(1 + chi x), where it is a difference of exponentials.
    top = math.log1p(chi)
    y = 0.5 * top * (1.0 + nodes)
    integral = 0.5 * top * (weights * np.expm1(y)).sum() / chi**2
    assert stored_share(chi) == pytest.approx(integral, rel=1e-13, abs=0.0)  # round-off
    assert delivered_restitution(chi, approach_only=True) == math.sqrt(2.0 * stored_share(chi))


def test_marhefka_and_orin_lose_with_the_speed():
    law = DampedContact(elastic=Hertz(stiffness=1e9), dissipation=MarhefkaOrinDamping(slope=0.5))
    for speed in (0.01, 0.1, 1.0):
        delivered = impact_on_wall(law, mass=0.4, speed=speed).restitution
        assert delivered == pytest.approx(delivered_restitution(0.75 * speed), abs=1e-9)
    # 1 - alpha v to first order, which is what it asks for.
    assert impact_on_wall(law, mass=0.4, speed=0.01).restitution == pytest.approx(1 - 0.5 * 0.01, abs=1e-4)


def test_the_factor_does_not_depend_on_what_it_is_used_with():
    for name in FACTORS:
        assert list(law_parameters(DISSIPATIONS[name])) == ["restitution"]
    law = FloresDamping(restitution=0.5)
    assert law.numbers(Johnson(**DIMENSIONS)) == law.numbers(Hertz(stiffness=1.0))


# --- refusals ---


@pytest.mark.parametrize("name", FACTORS)
def test_zero_restitution_is_refused_where_the_factor_is_infinite(name):
    finite = {"hunt-crossley", "herbert-mcwhannell", "lee-wang", "lankarani-nikravesh", "zhiying-qishao"}
    finite |= {"carvalho-martins"}
    if name in finite:
        assert 0.0 < FACTORS[name](restitution=0.0).hysteresis < 10.0 or name == "carvalho-martins"
        return
    message = r"restitution must be in \(0, 1\]; no finite damping of this form stops a body dead, got 0\.0$"
    with pytest.raises(ValueError, match=message):
        FACTORS[name](restitution=0.0)


@pytest.mark.parametrize("value", [-0.1, 1.1, math.nan])
def test_restitution_must_be_one(value):
    with pytest.raises(ValueError, match=r"^FloresDamping: restitution must be in \(0, 1\]; .*, got"):
        FloresDamping(restitution=value)
    with pytest.raises(ValueError, match=r"^ExactRestitution: restitution must be in \(0, 1\]; .*, got"):
        ExactRestitution(stiffness=1.0, restitution=value)
    with pytest.raises(ValueError, match=r"^exact_hysteresis: restitution must be in \(0, 1\], got"):
        exact_hysteresis(value)


def test_a_law_as_a_whole_refuses_under_its_own_name():
    with pytest.raises(ValueError, match=r"^ExactRestitution: restitution must be in \(0, 1\]; "):
        ExactRestitution(stiffness=1.0, restitution=0.0)
    assert LankaraniNikravesh(stiffness=1.0, restitution=0.0).hysteresis == 0.75
    with pytest.raises(ValueError, match=r"^MarhefkaOrinDamping: slope must be zero or more"):
        MarhefkaOrinDamping(slope=-1.0)
    with pytest.raises(ValueError, match="^delivered_restitution: hysteresis must be zero or more"):
        delivered_restitution(-1.0)
