"""Dampers beside the spring: closed forms where they are linear oscillators in disguise, and their shapes."""

import math
import re

import numpy as np
import pytest

from antenna_pin.analysis.law_studies import (
    closed_form_peak_depth,
    closed_form_restitution,
    impact_of_pair,
    impact_on_wall,
)
from antenna_pin.contact import (
    AdamsDamping,
    AdamsImpact,
    DampedContact,
    Hertz,
    Jankowski,
    JankowskiDamping,
    Johnson,
    KelvinVoigt,
    KelvinVoigtDamping,
    KuwabaraKono,
    KuwabaraKonoDamping,
    Tsuji,
    TsujiDamping,
    exact_hysteresis,
    kernels,
)
from antenna_pin.contact.damping import damping_ratio

from .conftest import DIMENSIONS

MASSES = (0.02, 1.3, 70.0)
ASKED = list(zip([0.05, 0.3, 0.6, 0.9, 1.0], [*MASSES, *MASSES], strict=False))


def agree(law, mass, speed, tolerance=1e-9):
    """Closed form and integration of an impact on a wall and of a free pair."""
    restitution = closed_form_restitution(law, mass=mass, speed=speed)
    depth = closed_form_peak_depth(law, mass=mass, speed=speed)
    wall = impact_on_wall(law, mass=mass, speed=speed)
    pair = impact_of_pair(law, masses=(2.0 * mass, 2.0 * mass), speeds=(speed, 0.0))
    # The integration's error; it is cut where the force is cut off, to which there is a kink.
    assert [wall.restitution, pair.restitution] == pytest.approx([restitution] * 2, abs=tolerance)
    assert wall.peak_depth == pytest.approx(depth, rel=1e-8, abs=0.0)
    return restitution


@pytest.mark.parametrize(("asked", "mass"), ASKED)
@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_tsuji_is_a_linear_oscillator_in_disguise(asked, exponent, mass):
    """At every speed and with every power law the same restitution, that of an oscillator cut off at zero."""
    law = Tsuji(stiffness=1e9, restitution=asked, exponent=exponent, effective_mass=mass)
    zeta = -math.log(asked) / math.sqrt(math.pi**2 + math.log(asked) ** 2)
    expected = math.exp(-zeta * (math.pi - 2.0 * math.asin(zeta)) / math.sqrt(1.0 - zeta**2))
    for speed in (0.003, 0.5):
        assert agree(law, mass, speed, 1e-7) == pytest.approx(expected, rel=1e-12, abs=0.0)
    assert damping_ratio(asked) == pytest.approx(zeta, rel=1e-15, abs=0.0)


@pytest.mark.parametrize(("asked", "mass"), ASKED)
@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_jankowski_loses_on_the_way_in_only(asked, exponent, mass):
    law = Jankowski(stiffness=1e9, restitution=asked, exponent=exponent, effective_mass=mass)
    for speed in (0.003, 0.5):
        agree(law, mass, speed)
    inward = law.force(1e-6, 0.1, 0.1) > law.elastic_force(1e-6) or asked == 1.0
    assert inward and law.force(1e-6, -0.1, 0.1) == law.elastic_force(1e-6)


def test_what_docstrings_say_tsuji_and_jankowski_deliver():
    for cls in (TsujiDamping, JankowskiDamping):
        text = " ".join(cls.__doc__.split())
        said = re.findall(r"(0\.\d+) for (0\.\d+)", text)
        assert len(said) == 2
        for delivered, asked in said:
            dissipation = cls(restitution=float(asked), effective_mass=1.0)
            law = DampedContact(elastic=Hertz(stiffness=1e9), dissipation=dissipation)
            got = closed_form_restitution(law, mass=1.0, speed=0.1)
            assert got == pytest.approx(float(delivered), abs=0.51 * 10.0 ** -(len(delivered) - 2))


@pytest.mark.parametrize("cls", [Tsuji, Jankowski])
@pytest.mark.parametrize("mass", MASSES)
def test_a_law_without_a_mass_takes_that_of_the_contact(cls, mass):
    """In the kernel, in integrated impacts and in closed form it is the law that is given this mass."""
    free = cls(stiffness=1e9, restitution=0.6)
    given = cls(stiffness=1e9, restitution=0.6, effective_mass=mass)
    for rate in (-0.05, 0.0, 0.1):
        force = kernels.normal_force(free.code(), 2e-6, rate, 0.1, mass)
        assert force == given.force(2e-6, rate, 0.1)
        # A mass of the law's own goes before that of the contact.
        assert kernels.normal_force(given.code(), 2e-6, rate, 0.1, 3.0 * mass) == force
    assert agree(free, mass, 0.1, 1e-7) == agree(given, mass, 0.1, 1e-7)


def test_a_law_without_a_mass_has_no_force_apart_from_a_contact():
    rule = "effective_mass must be given for a force apart from a joint, whose contacts have one, got None"
    for law in (
        Jankowski(stiffness=1e9, restitution=0.6),
        DampedContact(elastic=Johnson(**DIMENSIONS), dissipation=TsujiDamping(restitution=0.6)),
    ):
        for depth in (1e-6, 0.0):
            with pytest.raises(ValueError, match=f"^{type(law).__name__}: {rule}$"):
                law.force(depth, 0.1, 0.1)
        assert law.elastic_force(1e-6) > 0.0 and law.elastic_energy(1e-6) > 0.0


def test_jankowskis_damping_has_the_right_slope_at_full_restitution():
    """exp(-zeta pi / 2) = 1 - c: xi = sqrt(5) (1 - c) / pi, to first order."""
    loss = 1e-6
    xi = JankowskiDamping(restitution=1.0 - loss, effective_mass=1.0).damping_ratio
    assert xi == pytest.approx(math.sqrt(5.0) * loss / math.pi, rel=2e-6, abs=0.0)


@pytest.mark.parametrize(
    ("zeta", "mass"), list(zip([0.0, 0.05, 0.5, 1.0, 1.7], [*MASSES, *MASSES], strict=False))
)
def test_kelvin_voigt_in_closed_form(zeta, mass):
    """Also where it creeps back: an overdamped contact ends, since it does not pull."""
    stiffness = 1e7
    law = KelvinVoigt(stiffness=stiffness, damping=2.0 * zeta * math.sqrt(stiffness * mass))
    restitution = agree(law, mass, 0.1)
    if zeta == 1.0:
        assert restitution == pytest.approx(math.exp(-2.0), rel=1e-12, abs=0.0)
    if zeta == 0.0:
        assert restitution == 1.0


def test_kelvin_voigt_jumps_at_the_onset():
    law = KelvinVoigt(stiffness=1e7, damping=300.0)
    assert law.force(1e-300, 0.2, 0.2) == pytest.approx(60.0, rel=1e-14, abs=0.0)
    assert law.force(0.0, 0.2, 0.2) == 0.0
    assert law.exponent == 1.0


def test_kuwabara_and_kono_lose_with_the_fifth_root_of_the_speed():
    """1 - c goes as v^(1/5) while it is small."""
    law = KuwabaraKono(stiffness=1e10, damping=2e4)
    speeds = (1e-4, 32e-4)
    losses = [1.0 - impact_on_wall(law, mass=1.0, speed=speed).restitution for speed in speeds]
    assert losses[0] < 0.01
    assert losses[1] / losses[0] == pytest.approx(2.0, rel=0.02)  # the next order, of the loss itself
    assert closed_form_restitution(law, mass=1.0, speed=0.1) is None
    assert closed_form_peak_depth(law, mass=1.0, speed=0.1) is None


def test_adams_damping_grows_in_with_its_slope():
    law = AdamsImpact(stiffness=1e9, damping=500.0, full_damping_depth=1e-5)

    def damper(depth):
        return law.force(depth, 0.1, 0.1) - law.elastic_force(depth)

    assert damper(1e-5) == pytest.approx(50.0, rel=1e-12, abs=0.0)
    assert damper(3e-5) == pytest.approx(50.0, rel=1e-12, abs=0.0)
    assert damper(0.5e-5) == pytest.approx(25.0, rel=1e-12, abs=0.0)
    # Zero slope at both ends of the STEP.
    assert damper(1e-9) < 50.0 * 3.1e-8
    assert 50.0 - damper(1e-5 - 1e-9) < 50.0 * 3.1e-8


def test_an_overdamped_adams_contact_ends():
    law = AdamsImpact(stiffness=1e9, damping=1e5, full_damping_depth=1e-7)
    impact = impact_on_wall(law, mass=0.4, speed=0.1)
    assert 0.0 < impact.restitution < 0.2


@pytest.mark.parametrize(
    "damping",
    [
        TsujiDamping(restitution=0.7, effective_mass=0.4),
        JankowskiDamping(restitution=0.7, effective_mass=0.4),
        KelvinVoigtDamping(damping=400.0),
        KuwabaraKonoDamping(damping=1e6),
        AdamsDamping(damping=400.0, full_damping_depth=1e-6),
    ],
    ids=lambda d: type(d).__name__,
)
def test_dampers_work_beside_a_logarithmic_law(damping):
    """No closed form; but it loses energy, and the ledger of the wall closes: (1 - c^2) of it."""
    law = DampedContact(elastic=Johnson(**DIMENSIONS), dissipation=damping)
    impact = impact_on_wall(law, mass=0.4, speed=0.05)
    assert 0.2 < impact.restitution < 0.99
    assert impact.dissipated == pytest.approx(0.5 * 0.4 * 0.05**2 * (1.0 - impact.restitution**2), rel=1e-12)


def test_tsujis_damper_is_the_square_root_of_the_secant_stiffness():
    elastic, depth = Johnson(**DIMENSIONS), 3e-6
    law = DampedContact(elastic=elastic, dissipation=TsujiDamping(restitution=0.5, effective_mass=2.0))
    expected = math.sqrt(5.0) * damping_ratio(0.5) * math.sqrt(2.0 * elastic.elastic_force(depth) / depth)
    damper = law.force(depth, 0.01, 0.1) - elastic.elastic_force(depth)
    assert damper == pytest.approx(expected * 0.01, rel=1e-12, abs=0.0)


def test_no_finite_damping_stops_a_body_dead():
    with pytest.raises(ValueError, match=r"^TsujiDamping: restitution must be in \(0, 1\]; .*, got 0.0$"):
        TsujiDamping(restitution=0.0, effective_mass=1.0)


def test_hysteresis_and_oscillator_agree_for_little_damping():
    """Both lose to first order what the damper takes: 1 - c = zeta pi for the oscillator, 2/3 chi."""
    asked = 1.0 - 1e-4
    oscillator = Tsuji(stiffness=1e9, restitution=asked, effective_mass=1.0)
    assert closed_form_restitution(oscillator, mass=1.0, speed=0.1) == pytest.approx(asked, abs=1e-8)
    assert exact_hysteresis(asked) == pytest.approx(1.5e-4, rel=1e-3)
    assert np.isfinite(oscillator.force(1e-6, -10.0, 0.1))
