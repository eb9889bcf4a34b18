"""Laws of a journal in a bore: along a line, and over an arc."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from michell_disc import michell_disc
from scipy.optimize import brentq
from scipy.special import lambertw

from antenna_pin.analysis.law_studies import (
    differing_factor,
    elastic_laws_of_joint,
    force_table,
    laws_left_out,
)
from antenna_pin.contact import (
    ESDU78035,
    MATERIALS,
    NORMAL_LAWS,
    BaiZhao,
    BaiZhaoElastic,
    DubowskyFreudenstein,
    Goldsmith,
    HertzLine,
    Johnson,
    LiuFoundation,
    Pereira,
    Persson,
    Radzimovsky,
    cylinder,
    effective_modulus,
    is_elastic,
    kernels,
)

R_I, R_J, L = 0.010, 0.0098, 0.050
STEEL = MATERIALS["steel"]
E = effective_modulus(STEEL, STEEL)
DR = R_I - R_J
JOINT = {"length": L, "journal_radius": R_J, "bearing_radius": R_I, "modulus": E}
LOGARITHMIC = [
    law(**JOINT) for law in (HertzLine, Johnson, Radzimovsky, Goldsmith, DubowskyFreudenstein, ESDU78035)
]
by_name = pytest.mark.parametrize("law", LOGARITHMIC, ids=lambda law: type(law).__name__)


# --- the solver of the implicit laws ---


@settings(deadline=None, derandomize=True, max_examples=500)
@given(st.floats(1e-300, 0.3678))
def test_the_larger_root_is_lamberts_function(ratio):
    """w exp(-w) = ratio: w = -W_{-1}(-ratio)."""
    w = cylinder.log_ratio(ratio)
    # The root is as ill-conditioned as a square root near 1/e; SciPy's loses digits there too.
    assert w == pytest.approx(float(-lambertw(-ratio, -1).real), rel=1e-13, abs=0.0)


@settings(deadline=None, derandomize=True)
@given(st.floats(-14.0, -3.0))
def test_the_larger_root_near_its_end(power):
    """w - 1 = sqrt(2 u) + 2 u / 3 + O(u^1.5), u = -1 - ln(ratio)."""
    ratio = (1.0 - 10.0**power) / math.e
    u = -1.0 - math.log(ratio)
    w = cylinder.log_ratio(ratio)
    assert w - 1.0 == pytest.approx(math.sqrt(2.0 * u) + 2.0 * u / 3.0, abs=u**1.5 + 3e-16)


def test_beyond_the_turn_over_the_root_stays_there():
    for ratio in (1.0 / math.e, 0.37, 1.0, 1e300):
        assert cylinder.log_ratio(ratio) == pytest.approx(1.0, abs=2e-8)  # square root of the round-off


@by_name
def test_force_and_depth_are_inverse(law):
    for share in (1e-12, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999):
        depth = share * law.depth_limit
        # Where the depth turns over the force is the less certain.
        assert law.depth(law.elastic_force(depth)) == pytest.approx(depth, rel=2e-13, abs=0.0)
    assert law.depth(0.0) == 0.0


@by_name
def test_force_is_the_branch_below_the_turn_over(law):
    """Against a root search on the published formula between zero and the load that turns it over."""
    peak = law.elastic_force(law.depth_limit)
    for depth in (1e-7, 5e-6, 0.7 * law.depth_limit):
        if depth >= law.depth_limit:
            continue
        root = brentq(lambda f, d=depth: law.depth(f) - d, 1e-9, peak, xtol=1e-12, rtol=1e-15)
        assert law.elastic_force(depth) == pytest.approx(root, rel=1e-10, abs=0.0)


@by_name
def test_beyond_its_range_the_kernel_holds_the_force(law):
    peak = law.elastic_force(law.depth_limit)
    for share in (1.0 + 1e-9, 1.5, 100.0):
        held = kernels.elastic_force(law.code(), share * law.depth_limit)
        assert held == pytest.approx(peak, rel=1e-7, abs=0.0)
    # The published depth does turn over there.
    assert law.depth(1.01 * peak) < law.depth_limit
    assert law.depth(0.99 * peak) < law.depth_limit


def test_johnson_turns_over_at_four_over_e_squared_of_the_play():
    assert Johnson(**JOINT).depth_limit == pytest.approx(4.0 * math.exp(-2.0) * DR, rel=1e-12, abs=0.0)


def test_published_formulas():
    """Depth under a load, written out."""
    load = 2e4
    f, s = load / L, 1.0 / (math.pi * E)
    radius = R_I * R_J / DR
    width = {k: k * math.sqrt(f * radius / E) for k in (1.6, 4.0 / math.sqrt(math.pi))}
    for law, expected in (
        (HertzLine(**JOINT), 2.0 * f / (math.pi * E) * (math.log(math.pi * E * DR / f) - 1.0)),
        (Johnson(**JOINT), f * s * (math.log(4.0 * math.pi * E * DR / f) - 1.0)),
        (
            Radzimovsky(**JOINT, width_factor=1.6),
            f * s * (2.0 / 3.0 + math.log(4.0 * R_I / width[1.6]) + math.log(4.0 * R_J / width[1.6])),
        ),
        (
            Radzimovsky(**JOINT),
            f * s * (2.0 / 3.0 + math.log(16.0 * R_I * R_J / width[4.0 / math.sqrt(math.pi)] ** 2)),
        ),
        (Goldsmith(**JOINT), load * s / L * (math.log(L**3 / (load * radius * s)) + 1.0)),
        (DubowskyFreudenstein(**JOINT), load * s / L * (math.log(L**3 * DR / (load * R_I * R_J * s)) + 1.0)),
        (ESDU78035(**JOINT), load * s / L * (math.log(4.0 * L * DR / (load * s)) + 1.0)),
    ):
        assert law.depth(load) == pytest.approx(expected, rel=1e-12, abs=0.0)


# --- conformal laws ---


def test_liu_foundation_in_numbers():
    """Force over the whole bearing of the antenna at four depths, four digits computed elsewhere."""
    law = LiuFoundation(**JOINT)
    for depth, force in ((1e-7, 14.1), (1e-6, 446.0), (5e-6, 4932.0), (2e-5, 38090.0)):
        assert law.elastic_force(depth) == pytest.approx(force, rel=2e-3 if depth < 5e-6 else 2e-4)


def test_foundation_energy_joins_at_its_switch():
    """Series and closed form meet at a depth of 0.3 plays."""
    law = LiuFoundation(**JOINT)
    one, other = (law.elastic_energy(0.3 * DR * (1.0 + k)) for k in (-1e-9, 1e-9))
    slope = law.elastic_force(0.3 * DR) * 0.6e-9 * DR
    assert other - one == pytest.approx(slope, rel=1e-5)  # 1e-14 of the energy


@pytest.mark.parametrize("depth", [1e-7, 1e-6, 1e-5, 1e-4])
def test_bai_and_zhaos_stiffness_is_the_tangent_of_lius_law(depth):
    """K_n depth for n = 1: the tangent stiffness used as a secant, 1.5 times Liu's force at small depth."""
    liu, law = LiuFoundation(**JOINT), BaiZhaoElastic(**JOINT)
    h = 1e-4 * depth
    tangent = (liu.elastic_force(depth + h) - liu.elastic_force(depth - h)) / (2.0 * h)
    assert law.elastic_force(depth) == pytest.approx(tangent * depth, rel=1e-7, abs=0.0)  # h^2
    ratio = law.elastic_force(depth) / liu.elastic_force(depth)
    assert ratio == pytest.approx(1.5 - 0.5 * depth / (DR + depth), rel=1e-12, abs=0.0)


def test_docstring_formula_of_bai_and_zhao():
    depth, rate, first = 5e-6, 0.01, 0.02
    k = math.pi * E / 8.0 * math.sqrt(2.0 * depth * (3.0 * DR + 2.0 * depth) ** 2 / (DR + depth) ** 3)
    damping = 0.75 * (1.0 - 0.9**2) * math.exp(0.2) * rate / first
    for n in (1.0, 1.5):
        law = BaiZhao(**JOINT, restitution=0.9, exponent=n)
        assert law.force(depth, rate, first) == pytest.approx(
            L * k * depth**n * (1.0 + damping), rel=1e-12, abs=0.0
        )
    with pytest.raises(ValueError, match=r"^BaiZhao: exponent must be 1 or 1\.5, got 2\.0$"):
        BaiZhao(**JOINT, restitution=0.9, exponent=2.0)
    with pytest.raises(ValueError, match=r"^BaiZhao: restitution must be in \[0, 1\], got 2\.0$"):
        BaiZhao(**JOINT, restitution=2.0)


@pytest.mark.parametrize("play", [0.005, 0.2, 0.349535, 0.349545, 1.0, 10.0])
def test_docstring_formula_of_pereira(play):
    """In millimetres and newtons, over the range of the fit; 5 nm on both sides of where its branches meet.

    There the branches differ by 5e-6 in the force: another limit shows.
    """
    modulus, depth = E * 1e-6, 5e-3
    y = 1.51 * math.log(1000.0 * play) ** -0.151 if play < 0.34954 else 0.0151 * play + 1.151
    expected = (0.965 * play + 0.0965) * 1e3 * L * modulus / play * depth ** (y * play**-0.005)
    law = Pereira(length=L, modulus=E, journal_radius=0.02, bearing_radius=0.02 + 1e-3 * play)
    # The play is a difference of two radii: 1e-16 of 20 mm is 1e-12 of 5 um.
    assert law.elastic_force(1e-3 * depth) == pytest.approx(expected, rel=1e-9, abs=0.0)


@pytest.mark.parametrize("half_angle", [0.7, 1.0, 1.3])
def test_perssons_load_is_the_plane_solution(half_angle):
    depth = DR * (1.0 / math.cos(half_angle) - 1.0)
    load = Persson(**JOINT).elastic_force(depth) / (2.0 * E * DR * L)
    assert load == pytest.approx(0.5 * michell_disc(half_angle, 800)[1], rel=2e-4)  # what 800 terms leave out


def test_perssons_load_tends_to_hertz_for_a_narrow_arc():
    """a^2 = 4 f R / (pi E*) with a = R eps: f = pi E* eps^2 dR / 4."""
    angle = 1e-3
    depth = DR * 0.5 * angle**2
    expected = math.pi * E * angle**2 * DR / 4.0 * L
    assert Persson(**JOINT).elastic_force(depth) == pytest.approx(expected, rel=1e-5)  # eps^2


def test_perssons_arc_cannot_pass_its_largest():
    """The load is infinite at a half-angle of 84.8 degrees; the law is used up to just before."""
    law = Persson(**JOINT)
    angle = math.degrees(math.acos(DR / (DR + law.depth_limit)))
    assert 84.0 < angle < 84.8
    forces = [law.elastic_force(share * law.depth_limit) for share in (0.5, 0.9, 1.0)]
    assert (np.diff(forces) > 0.0).all()


# --- side by side ---


def test_a_law_says_nothing_beyond_its_range():
    laws = elastic_laws_of_joint(
        bearing_radius=R_I, journal_radius=R_J, length=L, bearing=STEEL, journal=STEEL
    )
    table = force_table(laws, (6e-5, 2e-4))
    assert math.isnan(table["hertz-line"][0]) and math.isnan(table["johnson"][1])
    assert math.isfinite(table["johnson"][0]) and math.isfinite(table["liu-foundation"][1])


def test_what_is_left_out_says_why():
    """A law holds or is refused, and every elastic law is one or the other."""
    joint = {"bearing_radius": 0.1, "journal_radius": 0.08, "length": L, "bearing": STEEL, "journal": STEEL}
    refused = laws_left_out(**joint)
    assert set(refused) | set(elastic_laws_of_joint(**joint)) == set(filter(is_elastic, NORMAL_LAWS))
    assert not set(refused) & set(elastic_laws_of_joint(**joint))
    assert "for which the law was fitted" in str(refused["pereira"])


def test_by_how_much_forces_differ_is_of_those_that_are_known():
    assert differing_factor([2.0, math.nan, 8.0, 4.0]) == 4.0
    assert differing_factor([2.0, math.nan]) is None
