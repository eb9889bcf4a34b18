"""Pressures of Hertz, Persson and the ball in its socket; the static rating of ISO 76."""

import math

import numpy as np
import pytest
from michell_disc import michell_disc
from scipy.integrate import quad
from scipy.special import eval_legendre

from antenna_pin.contact import (
    LARGEST_HALF_ANGLE,
    MATERIALS,
    Material,
    ball_in_socket,
    ball_load_limit,
    effective_modulus,
    hertz_line,
    hertz_point,
    line_shear,
    persson_line,
    persson_load,
    persson_pressure,
    point_shear,
    raceway_ellipse,
    socket_contact,
    static_rating,
)
from antenna_pin.errors import InvalidParameterError

STEEL = Material(young=207e9, poisson=0.3)
E = effective_modulus(STEEL, STEEL)


def test_hertzs_line_closes_the_gap_of_two_cylinders():
    """An ellipse of pressure of half-width a bends both surfaces by x^2 p0 / (E* a), the gap of x^2 / 2 R."""
    load, curvature = 3e4, 1.0 / 0.0099 - 1.0 / 0.01
    found = hertz_line(load, curvature, E)
    assert 0.5 * math.pi * found.pressure * found.half_width == pytest.approx(load, rel=1e-14)
    assert 2.0 * found.pressure / (E * found.half_width) == pytest.approx(curvature, rel=1e-14)


def test_greatest_shear_below_a_line_and_a_circle():
    """The golden ratio below a line; table 4.1 of Johnson (1985) below ellipses, two digits printed."""
    share, depth = line_shear()
    assert depth**2 == pytest.approx(0.5 * (math.sqrt(5.0) - 1.0), rel=1e-15)
    z = depth + np.array([-1e-4, 0.0, 1e-4])
    below = z * (1.0 - z / np.sqrt(1.0 + z * z))
    assert share == pytest.approx(below[1], rel=1e-15) and below.argmax() == 1
    for ratio, printed in (
        (1.0, (0.310, 0.48)),
        (0.8, (0.32, 0.53)),
        (0.4, (0.325, 0.67)),
        (1e-4, (0.300, 0.786)),
    ):
        assert point_shear(ratio, 0.3) == pytest.approx(printed, abs=6e-3)


def test_hertzs_ellipse_between_circle_and_line():
    """A circle has (6 F E*^2 / pi^3 R^2)^(1/3); a long ellipse's middle is a line under its local load."""
    circle = hertz_point(100.0, 100.0, 100.0, E)
    assert circle.pressure == pytest.approx(
        (6.0 * 100.0 * E**2 * 100.0**2 / math.pi**3) ** (1 / 3), rel=1e-13
    )
    assert circle.half_length == pytest.approx((0.75 * 100.0 / (100.0 * E)) ** (1 / 3), rel=1e-13)
    long = hertz_point(100.0, 100.0, 1e-6, E)
    # Load per length in the middle of the ellipse: pi p0 b / 2. The line has the curvature across alone.
    line = hertz_line(0.5 * math.pi * long.pressure * long.half_width, 100.0, E)
    assert long.pressure == pytest.approx(float(line.pressure), rel=1e-6)  # (b/a)^2 ln(a/b) here


@pytest.mark.parametrize("half_angle", [1e-3, 0.5, 1.2, 1.47])
def test_perssons_pressure_carries_its_load(half_angle):
    """The integral of p cos(phi) R over the arc is f."""
    total, _ = quad(
        lambda angle: float(persson_pressure(half_angle, angle)) * math.cos(angle),
        -half_angle,
        half_angle,
        epsabs=0.0,
        epsrel=1e-11,
    )
    assert total == pytest.approx(1.0, rel=1e-9)  # of the quadrature at the root at both ends


def test_perssons_pressure_is_the_plane_solution():
    peak, load = michell_disc(1.0, 1000)
    assert float(persson_pressure(1.0)) == pytest.approx(peak / load, rel=1e-4)  # what 1000 terms leave out


def test_perssons_line_between_hertz_and_full_contact():
    """Hertz's to 1e-6 under a small load; f / R times 0.5996 on an arc of 169 deg under a large one."""
    outer, play = 0.01, 2e-5
    inner, radius = outer - play, math.sqrt(outer * (outer - play))
    load = 1e-7 * E * play
    small = persson_line(load, radius, play, E)
    hertz = hertz_line(load, 1.0 / inner - 1.0 / outer, E)
    assert float(small.pressure) == pytest.approx(float(hertz.pressure), rel=1e-6)
    assert float(small.half_width) == pytest.approx(float(hertz.half_width), rel=1e-6)
    large = persson_line(1e9 * E * play, radius, play, E)
    assert float(large.half_angle) == pytest.approx(LARGEST_HALF_ANGLE, rel=1e-8)
    full = float(persson_pressure(LARGEST_HALF_ANGLE))
    assert float(large.pressure) == pytest.approx(full * 1e9 * E * play / radius, rel=1e-8)
    # Roots found at every load between: the load over the arc found is the load.
    loads = E * play * np.geomspace(1e-6, 1e4, 40)
    arcs = persson_line(loads, radius, play, E).half_angle
    assert persson_load(arcs) * E * play == pytest.approx(loads, rel=1e-11)


def plain_socket(edge, rings=40, terms=1500):
    """Load and peak pressure by rings of constant pressure and plain sums of Legendre's polynomials."""
    nu, n = 0.3, np.arange(terms, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        ball = n * (n * n + 2 * n - 1 + 2 * nu) / (n - 1) - (n + 1) * (n - 2 + 4 * nu)
    ball /= 2 * (n * n + n + 1) + 2 * nu * (2 * n + 1)
    hollow = n * (n + 3 - 4 * nu) - (n + 1) * (n * n - 2 + 2 * nu) / (n + 2)
    hollow /= 2 * (n * n + n + 1) - 2 * nu * (2 * n + 1)
    s = (ball + hollow) / (4.0 * (1.0 - nu))  # over R / E*: 2 G is E / (1 + nu) = 2 (1 - nu) E*
    s *= 2.0
    s[0], s[1] = ((1 - 2 * nu) / (1 + nu) + 0.5) / (2.0 * (1.0 - nu)), 0.0
    ends = edge * np.sin(0.5 * math.pi * np.arange(rings + 1) / rings)
    middles, cosine = 0.5 * (ends[1:] + ends[:-1]), np.cos(ends)
    poly = eval_legendre(np.arange(terms + 1)[:, None], cosine[None, :])
    inside = np.empty((terms, rings))
    inside[0] = cosine[:-1] - cosine[1:]
    rise = poly[2:] - poly[:-2]
    inside[1:] = (rise[:, :-1] - rise[:, 1:]) / (2 * n[1:, None] + 1)
    moments = (n + 0.5)[:, None] * inside
    opening = eval_legendre(n[None, :], np.cos(middles)[:, None]) @ (s[:, None] * moments)
    system = np.vstack([np.hstack([opening, -np.cos(middles)[:, None]]), np.zeros(rings + 1)])
    system[-1, -2] = 1.0
    p = np.linalg.solve(system, np.append(-np.ones(rings), 0.0))[:-1]
    return math.pi * float(p @ (np.sin(ends[1:]) ** 2 - np.sin(ends[:-1]) ** 2)), float(p[0])


def test_a_ball_in_its_socket_by_a_second_method():
    found = socket_contact(0.8, (207e9, 0.3), (207e9, 0.3))
    load, peak = plain_socket(0.8)
    # Rings of constant pressure and a series cut off: some 1e-3, which falls with their number.
    assert (found.load, found.pressure) == pytest.approx((load, peak), rel=3e-3)


def test_a_ball_in_its_socket_tends_to_hertz():
    """The difference falls as the square of the half-angle."""
    loads = np.array([1e-5, 1e-2])
    outer, play = 0.01, 1e-4
    curvature = play / (outer * (outer - play))
    radius = math.sqrt(outer * (outer - play))
    force = loads * E * radius * play
    found, hertz = (
        ball_in_socket(force, radius, play, STEEL, STEEL),
        hertz_point(force, curvature, curvature, E),
    )
    excess = (found.pressure / hertz.pressure - 1.0) / (found.half_width / radius) ** 2
    assert excess[0] > 0.5 and excess[1] == pytest.approx(excess[0], rel=0.05)  # next order, angle^2


def test_static_ratings_are_those_of_iso_76():
    """Factor f_0 over D cos(alpha) / d_m of radial ball bearings, ISO 76:2006, table 1, as printed."""
    modulus = 207e9 / (2.0 * (1.0 - 0.3**2))
    for gamma, printed in ((0.05, 15.7), (0.08, 16.3), (0.09, 16.5), (0.1, 16.4), (0.12, 15.9), (0.15, 15.2)):
        limits = [
            ball_load_limit(raceway_ellipse(0.01, conformity, sign * gamma, modulus))
            for conformity, sign in ((0.52, 1.0), (0.53, -1.0))
        ]
        radial, _ = static_rating(8, 0.0, min(limits))
        assert radial / (8 * 10.0**2) == pytest.approx(printed, abs=0.051)


def test_refusals():
    with pytest.raises(InvalidParameterError, match="load must be zero or more, got -1"):
        hertz_line(-1.0, 1.0, E)
    with pytest.raises(InvalidParameterError, match="half_angle must be in .* where the load is infinite"):
        persson_load(1.5)
    with pytest.raises(
        InvalidParameterError, match=r"yield_strength must be at most ultimate_strength = 2e\+08 Pa"
    ):
        Material(young=2e11, poisson=0.3, yield_strength=3e8, ultimate_strength=2e8)


def test_every_strength_and_expansion_of_a_material_has_a_source():
    for name, one in MATERIALS.items():
        for number in ("yield_strength", "ultimate_strength", "hardness", "expansion"):
            own = {"yield_strength": one.strength_source, "ultimate_strength": one.strength_source}
            source = own.get(number, getattr(one, f"{number}_source", ""))
            assert (getattr(one, number) is None) == (source == "") or number == "ultimate_strength", (
                name,
                number,
            )
