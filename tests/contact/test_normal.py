"""Normal contact laws: what every law must be, whatever its elastic part and its dissipation."""

import itertools
import math
import re

import numpy as np
import pytest
from scipy.integrate import quad

from antenna_pin.contact import (
    CustomNormal,
    DampedContact,
    Hertz,
    HertzLine,
    Johnson,
    LankaraniNikravesh,
    NoDissipation,
    NormalLaw,
    Pereira,
    Persson,
    cylinder,
    damping,
    kernels,
    pin_joint,
)

from .conftest import DIMENSIONS

DEPTHS = np.geomspace(1e-9, 5e-5, 25)

# At the onset, where there is no depth yet, these push with D v_0: their named discontinuity.
DISCONTINUOUS = {damping.viscous}
MASS_LAWS = {damping.secant, damping.secant_loading}


def is_discontinuous(law):
    """A damper over the square root of the secant stiffness is as constant as that is."""
    spring, kernel = law.parts.elastic, law.parts.dissipation.kernel
    linear = spring.kernel in (cylinder.logarithmic_force, cylinder.persson_force, pin_joint.pin_joint_force)
    linear |= spring.kernel is Hertz.kernel and spring.exponent == 1.0
    return kernel in DISCONTINUOUS or (kernel in MASS_LAWS and linear)


def test_is_a_normal_law(normal_laws):
    assert len(normal_laws) > 150 and all(isinstance(law, NormalLaw) for law in normal_laws)


def test_no_force_and_no_energy_without_depth(normal_laws):
    for law, depth in itertools.product(normal_laws, (0.0, -0.0, -1e-12, -1e-3)):
        assert [law.force(depth, rate, 0.1) for rate in (-1.0, 0.0, 1.0)] == [0.0] * 3, law
        assert law.elastic_force(depth) == law.elastic_energy(depth) == 0.0, law


def test_force_begins_at_zero_or_with_its_named_discontinuity(normal_laws):
    """Nothing at 1e-40 m, or what the damper has already there."""
    for law in normal_laws:
        small, large = (law.force(depth, 0.1, 0.1) for depth in (1e-40, 1e-5))
        if is_discontinuous(law):
            assert law.code()[10] > 0.0 and small > 1e-4 * large, law
        else:
            # The slowest is Tsuji's damper on Hertz, with the fourth root of the depth: (1e-35)^(1/4).
            assert small < 1e-8 * large, law


def test_never_adhesive(normal_laws):
    for law in normal_laws:
        for depth in (*DEPTHS, min(1e-3, law.depth_limit), min(1e-1, law.depth_limit)):
            for rate in (-1e3, -1.0, -0.1, 0.0, 0.1):
                assert 0.0 <= law.force(depth, rate, 0.1) < math.inf, (law, depth, rate)


def test_what_is_not_elastic_takes_energy(normal_laws):
    """(force - elastic force) rate is never negative, also where the force is cut off; zero at rest."""
    for law, depth in itertools.product(normal_laws, DEPTHS):
        elastic = law.elastic_force(depth)
        assert law.force(depth, 0.0, 0.1) == elastic, (law, depth)
        for rate in (-1.0, -0.07, -1e-4, 1e-4, 0.1, 1.0):
            assert (law.force(depth, rate, 0.1) - elastic) * rate >= 0.0, (law, depth, rate)


def test_stiffens_with_depth_and_resists_closing(normal_laws):
    for law in normal_laws:
        forces, closing = (np.array([law.force(d, rate, 0.1) for d in DEPTHS]) for rate in (0.0, 0.1))
        assert (np.diff(forces) > 0.0).all() and (closing >= forces).all(), law


def test_elastic_force_is_smooth_within_its_range(elastic_law):
    """The second difference over h^2 has a limit: force and slope are continuous."""
    for depth in (1e-7, 3e-6, 4e-5):
        seconds = []
        for h in (0.02 * depth, 0.01 * depth):
            low, middle, high = (elastic_law.elastic_force(depth + k * h) for k in (-1, 0, 1))
            seconds.append((high - 2.0 * middle + low) / h**2)
        size = elastic_law.elastic_force(depth) / depth**2
        # It changes with h^2 relative to what it is: by half a per cent here. Round-off is 1e-12 of the size.
        assert seconds[1] == pytest.approx(seconds[0], rel=0.005, abs=1e-10 * size)


def test_energy_is_the_integral_of_the_elastic_force(elastic_law):
    """Over the whole range of the law, also where its force has a pole just beyond."""
    limit = elastic_law.depth_limit
    shares = [limit * share for share in (1e-3, 0.1, 0.25, 0.5, 0.9, 0.98, 1.0) if math.isfinite(limit)]
    for depth in (1e-8, 3e-6, 5e-5, *(shares or (2e-4, 1e-2))):
        # In -ln(depth), in which every law is smooth at depth zero; quad is then exact to round-off.
        work = 0.0
        for ends in ((0.0, 1e-3), (1e-3, 0.05), (0.05, 1.0), (1.0, 45.0)):
            part, _ = quad(
                lambda u, d=depth: d * math.exp(-u) * elastic_law.elastic_force(d * math.exp(-u)),
                *ends,
                epsabs=1e-14 * work,
                epsrel=1e-13,
                limit=200,
            )
            work += part
        assert elastic_law.elastic_energy(depth) == pytest.approx(work, rel=1e-12, abs=0.0)


@pytest.mark.parametrize(
    "law", [Persson(**DIMENSIONS), Johnson(**DIMENSIONS)], ids=lambda x: type(x).__name__
)
def test_energy_in_the_kernel_goes_on_as_the_force_does_beyond_the_range(law):
    """There the force is held; a trial step may get there."""
    code, limit = law.code(), law.depth_limit
    more = kernels.elastic_energy(code, 1.5 * limit) - kernels.elastic_energy(code, limit)
    assert more == pytest.approx(0.5 * limit * kernels.elastic_force(code, limit), rel=1e-12, abs=0.0)
    assert kernels.elastic_force(code, 1.5 * limit) == pytest.approx(
        kernels.elastic_force(code, limit), rel=1e-7
    )


def test_a_law_refuses_a_depth_beyond_its_range(normal_laws):
    """Up to the limit itself it speaks, beyond it says so; the kernels go on for trial steps."""
    for law in normal_laws:
        limit = law.depth_limit
        if math.isinf(limit):
            assert law.elastic_force(1.0) > law.elastic_force(0.5) > 0.0, law
            continue
        name = type(law.parts.elastic).__name__
        beyond = math.nextafter(limit, 1.0)
        message = f"^{name}: depth must be at most depth_limit = {re.escape(f'{limit:g}')} m, got {beyond!r}$"
        assert law.force(limit, 0.0, 0.1) == law.elastic_force(limit) > 0.0, law
        assert law.elastic_energy(limit) > 0.0, law
        for quantity, state in (
            (law.force, (beyond, 0.0, 0.1)),
            (law.elastic_force, (beyond,)),
            (law.elastic_energy, (beyond,)),
        ):
            with pytest.raises(ValueError, match=message):
                quantity(*state)
        assert kernels.elastic_force(law.code(), beyond) > 0.0, law


def test_parts_make_the_law_again(normal_laws):
    for law in normal_laws:
        assert (law.parts.code() == law.code()).all(), law
        assert law.depth_limit == law.parts.elastic.depth_limit, law


def test_any_dissipation_joins_any_elastic_law(elastic_law, dissipations):
    depth = 2e-6
    for dissipation in dissipations:
        law = DampedContact(elastic=elastic_law, dissipation=dissipation)
        assert law.elastic_force(depth) == elastic_law.elastic_force(depth), law
        assert law.elastic_energy(depth) == elastic_law.elastic_energy(depth), law
        if isinstance(dissipation, NoDissipation):
            assert law.force(depth, -0.3, 0.1) == elastic_law.force(depth, -0.3, 0.1), law
        elif getattr(dissipation, "restitution", 0.0) < 1.0:
            assert law.force(depth, 0.1, 0.1) > elastic_law.elastic_force(depth), law


def test_force_is_linear_in_the_rate_until_it_would_pull(restitution_laws):
    for law, ratio in itertools.product(restitution_laws, (-3.0, -0.7, 0.3, 1.0)):
        elastic = law.elastic_force(1e-5)
        chi = law.hysteresis if ratio > 0.0 or not law.dissipation.approach_only else 0.0
        round_off = 5e-16 * (1.0 + law.hysteresis) * elastic
        expected = elastic * max(0.0, 1.0 + chi * ratio)
        assert law.force(1e-5, 0.02 * ratio, 0.02) == pytest.approx(expected, abs=round_off), (law, ratio)


def test_elastic_force_is_the_power_law(power_laws):
    for law, depth in itertools.product(power_laws, DEPTHS):
        expected = law.stiffness * depth**law.exponent
        # Round-off of the power.
        assert law.elastic_force(depth) == pytest.approx(expected, rel=1e-15, abs=0.0), law


def test_docstring_formula_of_lankarani_nikravesh():
    law = LankaraniNikravesh(stiffness=2e9, restitution=0.8, exponent=1.3)
    depth, rate, first = 4e-6, -0.03, 0.07
    expected = 2e9 * depth**1.3 * (1.0 + 0.75 * (1.0 - 0.8**2) * rate / first)
    assert law.force(depth, rate, first) == pytest.approx(expected, rel=1e-15, abs=0.0)  # round-off
    assert law.hysteresis == pytest.approx(0.75 * 0.36, rel=1e-15, abs=0.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Hertz(stiffness=1.0, exponent=0.9), "Hertz: exponent must be in [1, 4], got 0.9"),
        (
            lambda: LankaraniNikravesh(stiffness=2.0, restitution=0.9, exponent=5.0),
            "LankaraniNikravesh: exponent must be in [1, 4], got 5.0",
        ),
        (
            lambda: HertzLine(**(DIMENSIONS | {"bearing_radius": 0.0098})),
            "HertzLine: bearing_radius must be above journal_radius = 0.0098 m, and finite, got 0.0098",
        ),
        (
            lambda: Pereira(**(DIMENSIONS | {"bearing_radius": 0.03})),
            "Pereira: bearing_radius must be such that the play is 5 um to 10 mm, for which the law was "
            "fitted, got 0.03",
        ),
        (
            lambda: DampedContact(elastic=3.0, dissipation=NoDissipation()),
            "DampedContact: elastic must be an elastic law such as Hertz, got 3.0",
        ),
        (
            lambda: DampedContact(elastic=Hertz(stiffness=1.0), dissipation=0.9),
            "DampedContact: dissipation must be a dissipation such as FloresDamping, got 0.9",
        ),
    ],
)
def test_refuses_what_is_no_law(make, message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        make()


def test_laws_are_frozen_and_made_by_name():
    """No law can be changed once it is checked, nor two of its parameters be swapped."""
    law = Hertz(stiffness=1e9)
    with pytest.raises(AttributeError):
        law.stiffness = 2e9
    with pytest.raises(TypeError):
        Hertz(1e9, 1.5)


def test_a_users_own_law_is_a_law():
    law = CustomNormal(
        force=lambda depth, rate, first: 5.0 * depth,
        elastic_force=lambda depth: 5.0 * depth,
        elastic_energy=lambda depth: 2.5 * depth**2,
    )
    assert isinstance(law, NormalLaw)
    assert law.force(2.0, 0.0, 1.0) == 10.0
    assert law.depth_limit == math.inf
