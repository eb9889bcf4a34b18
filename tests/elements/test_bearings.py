"""Ball bearings by their numbers and by their balls, and what is refused of them."""

import math

import numpy as np
import pytest

from antenna_pin import AntennaPinError, System, Urdf, build_mechanism
from antenna_pin.contact.pressure import raceway_ellipse
from antenna_pin.elements import AxialPreload, BallBearing, JointFriction, StiffnessBearing, moved
from antenna_pin.elements.ball_bearing import groove_contact, in_series, point_stiffness
from antenna_pin.errors import InvalidParameterError

BALLS = {
    "joint": "axle",
    "count": 12,
    "ball_diameter": 6e-3,
    "pitch_diameter": 40e-3,
    "contact_angle": math.radians(15.0),
    "preload": 50.0,
}
SOFTNESS = 2.0 * (1.0 - 0.3**2) / 2.06e11


def test_equal_curvatures_are_a_ball_on_a_plane():
    """delta^3 = 9 Q^2 eta^2 / (16 R), Hertz's closed form."""
    radius = 7e-3
    expected = math.sqrt(16.0 * radius / 9.0) / SOFTNESS
    assert point_stiffness(1 / radius, 1 / radius, SOFTNESS) == pytest.approx(expected, rel=1e-14, abs=0.0)


@pytest.mark.parametrize("uneven", [1e-6, 1e-3, 0.3, 0.9, 0.97])
def test_the_ellipse_of_contact_bears_its_load(uneven):
    """Hertz's pressure over the ellipse sinks surfaces in as their curvatures ask for: by quadrature.

    Under p0 sqrt(1 - (x/a)^2 - (y/b)^2) both surfaces together sink in by eta p0 a b / 2 times the integral
    of (1 - x^2 / (a^2 + w) - y^2 / (b^2 + w)) / sqrt((a^2 + w)(b^2 + w) w) over all w > 0 (Johnson, 3.61).
    """
    from scipy.integrate import quad
    from scipy.optimize import brentq

    first, second = 200.0 * (1.0 + uneven), 200.0 * (1.0 - uneven)

    def integral(a, b, over):
        # w = u^2 takes the root away.
        def part(u):
            return 2.0 / math.sqrt((a * a + u * u) * (b * b + u * u)) / over(u * u)

        return quad(part, 0.0, np.inf, epsabs=0.0, epsrel=1e-12)[0]

    # Curvatures are in the ratio of the integrals over x^2 and y^2; a lies along the flatter way.
    def lack(b):
        return integral(1.0, b, lambda w: 1.0 + w) * first - integral(1.0, b, lambda w: b * b + w) * second

    b = brentq(lack, 1e-2, 1.0, xtol=1e-14)
    # With a = 1: depth = c I0 and second / 2 = c I1, c = eta p0 a b / 2 and load = 2/3 pi p0 a b; scaled to
    # any a, depth^1.5 over load is a-free.
    c = 0.5 * second / integral(1.0, b, lambda w: 1.0 + w)
    depth = c * integral(1.0, b, lambda w: 1.0)
    load = 2.0 / 3.0 * math.pi * 2.0 * c / SOFTNESS
    # Quadrature's own error, and the root's.
    assert point_stiffness(first, second, SOFTNESS) == pytest.approx(load / depth**1.5, rel=1e-9, abs=0.0)


def test_springs_in_series():
    """Depths under one load add up."""
    first, second, load = 2e9, 7e9, 300.0
    depth = (load / first) ** (2 / 3) + (load / second) ** (2 / 3)
    assert in_series(first, second) == pytest.approx(load / depth**1.5, rel=1e-14, abs=0.0)


def test_the_outer_raceway_is_stiffer():
    """It bends with the ball, the inner one against it."""
    gamma = 0.15
    assert groove_contact(6e-3, 0.52, -gamma, SOFTNESS) > groove_contact(6e-3, 0.52, gamma, SOFTNESS)


def test_preload_is_the_axial_force_of_all_balls():
    """Z Q sin(alpha) with Q from how far the grooves are apart."""
    bearing = BallBearing(**BALLS)
    balls = bearing.balls()
    way = np.hypot(balls[:, 4], balls[:, 5])
    load = bearing.hertz * (way - balls[:, 6]) ** 1.5
    # The elongation is a difference of lengths 300 times as large: 1e-13.
    assert (load * balls[:, 5] / way).sum() == pytest.approx(50.0, rel=1e-11, abs=0.0)
    assert bearing.loaded_angle > bearing.contact_angle


@pytest.mark.parametrize("arrangement", ["back-to-back", "face-to-face"])
def test_a_pair_is_two_rows_in_parallel(arrangement):
    """Each row's stiffness moved to the middle, one of them turned round."""
    spread = 0.02
    pair = BallBearing(**BALLS, arrangement=arrangement, spread=spread).stiffness
    row = BallBearing(**BALLS).stiffness
    # Turned round about x: y, z and the tilt about y change sign.
    flip = np.diag([1.0, -1.0, -1.0, 1.0, -1.0])
    other = flip @ row @ flip
    # A row takes load along +z on the inner ring; back to back that is the lower one.
    lower, upper = (row, other) if arrangement == "back-to-back" else (other, row)
    expected = moved(lower, 0.5 * spread) + moved(upper, -0.5 * spread)
    assert pair == pytest.approx(expected, rel=1e-12, abs=1e-12 * np.abs(expected).max())
    assert abs(pair[0, 4]) < 1e-12 * pair[0, 0]


def test_back_to_back_is_stiffer_in_tilt_than_face_to_face():
    """Its lines of load meet the axis further apart."""
    back, face = (
        BallBearing(**BALLS, arrangement=one, spread=0.02).stiffness
        for one in ("back-to-back", "face-to-face")
    )
    assert back[3, 3] > 2.0 * face[3, 3]
    assert back[:3, :3] == pytest.approx(face[:3, :3], rel=1e-12, abs=1e-6)


def test_axial_stiffness_of_a_row_is_the_slope_of_its_load():
    """d F / d z between preloads, by how far the inner ring moves from one to the other."""
    change = 1e-4
    low, high = (BallBearing(**BALLS | {"preload": 50.0 * (1.0 + s * change)}) for s in (-1.0, 1.0))
    moves = high.balls()[0, 5] - low.balls()[0, 5]
    slope = 2.0 * 50.0 * change / moves
    # Second differences: change^2.
    assert BallBearing(**BALLS).stiffness[2, 2] == pytest.approx(slope, rel=1e-7, abs=0.0)


def test_a_reference_point_moves_along_the_axis():
    """A radial spring at a height is a coupling and a tilt stiffness below."""
    spring = StiffnessBearing(joint="axle", radial=1e6).stiffness
    found = moved(spring, -0.03)
    assert (found[0, 4], found[1, 3], found[3, 3]) == pytest.approx((3e4, -3e4, 900.0), rel=1e-14, abs=0.0)
    assert moved(found, 0.03) == pytest.approx(spring, rel=1e-14, abs=1e-9)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"radial": 1e6, "tilt": 10.0, "coupling": 4e3}, "coupling must be no larger than"),
        ({}, "radial must be above zero, or axial or tilt, or matrix given"),
        ({"matrix": tuple(np.eye(5).ravel()), "radial": 1.0}, "matrix must be omitted if radial is given"),
        (
            {"matrix": tuple(np.diag([1.0, 1, 1, 1, -1]).ravel())},
            "matrix must be without negative eigenvalues",
        ),
        ({"matrix": tuple((np.eye(5) + np.eye(5, k=1)).ravel())}, "matrix must be symmetric"),
        ({"radial": 1.0, "damping_time": 1.0, "damping_matrix": (0.0,) * 25}, "omitted if damping_time is"),
        ({"radial": math.nan}, "radial must be"),
    ],
)
def test_matrices_that_no_bearing_has(changes, said):
    """Energy would be made."""
    with pytest.raises(InvalidParameterError, match=said):
        StiffnessBearing(joint="axle", **changes)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"count": 2}, "count must be 3 or more"),
        ({"count": 21}, "ball_diameter must be below"),
        ({"inner_conformity": 0.5}, "inner_conformity must be above 0.5"),
        ({"contact_angle": 1.6}, "contact_angle must be below a right angle"),
        ({"preload": 1e9}, "preload must be small"),
        ({"spread": 0.01}, "spread must be left out of a single row"),
    ],
)
def test_bearings_that_cannot_be_built(changes, said):
    """Balls that overlap, grooves tighter than balls."""
    with pytest.raises(InvalidParameterError, match=said):
        BallBearing(**BALLS | changes)


def test_a_preload_of_nothing():
    """It says what to give."""
    with pytest.raises(InvalidParameterError, match="force must be above or below zero"):
        AxialPreload(joint="axle", force=0.0, stiffness=1e5)


# --- friction by preload ------------------------------------------------------------------------------------

AXLE = """<robot name="axle"><link name="box"/><link name="shaft"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="axle"
type="revolute"><parent link="box"/><child link="shaft"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
PAIR = BALLS | {"arrangement": "back-to-back", "spread": 0.04}


def _with_friction(pair, /, **numbers):
    mechanism = build_mechanism(Urdf.from_text(AXLE, "axle").variant(joints={"axle": "free"}), "fixed")
    friction = JointFriction(joint="axle", **numbers)
    return System(mechanism, springs={"rub": friction}, elements={"bearings": {"pair": pair}})


@pytest.mark.parametrize("preload", [20.0, 50.0, 130.0])
def test_friction_of_a_preloaded_pair_is_that_of_its_preload(preload):
    """Measured at 50 N it is T0 (P / 50 N)^n; by Palmgren 2 z (P / C0a)^y 0.9 P cot(alpha) d_m."""
    pair = BallBearing(**PAIR | {"preload": preload})
    found = _with_friction(pair, bearing="pair", friction=8e-3, at_preload=50.0, preload_exponent=4.0 / 3.0)
    expected = 8e-3 * (preload / 50.0) ** (4.0 / 3.0)
    assert found.springs["rub"].friction == pytest.approx(expected, rel=1e-15, abs=0.0)
    # All that acts is that of the number: runs and small motions read nothing else.
    same = _with_friction(pair, friction=found.springs["rub"].friction)
    assert found.program.tobytes() == same.program.tobytes()
    # ISO 76: 4200 MPa in the middle of the tighter contact, that of the inner raceway.
    gamma = 6e-3 * math.cos(PAIR["contact_angle"]) / 40e-3
    ellipse = raceway_ellipse(6e-3, 0.52, gamma, 1.0 / SOFTNESS)
    rating = 12 * math.sin(PAIR["contact_angle"])
    rating *= (4.2e9 * math.pi * ellipse.half_length * ellipse.half_width / 1.5) ** 3
    load = 0.9 * preload / math.tan(PAIR["contact_angle"])
    expected = 2.0 * 2e-3 * (preload / rating) ** 0.25 * load * 40e-3
    palmgren = {"bearing": "pair", "palmgren_factor": 2e-3, "preload_exponent": 1.25}
    found = _with_friction(pair, **palmgren).springs["rub"]
    assert found.friction == pytest.approx(expected, rel=1e-13, abs=0.0)
    assert f"of bearing pair at {preload:g}\N{NO-BREAK SPACE}N" in found.words()


@pytest.mark.parametrize(
    ("bearing", "numbers", "said"),
    [
        ({}, {"friction": 1.0, "at_preload": 50.0}, "at_preload must be left out without bearing"),
        ({}, {"bearing": "pair", "friction": 1.0}, "at_preload must be given"),
        (
            {},
            {"bearing": "pair", "at_preload": 1.0, "palmgren_factor": 1.0},
            "palmgren_factor must be left out",
        ),
        ({}, {"bearing": "pear"}, "bearing 'pear' is unknown; known: pair"),
        ({"contact_angle": 0.0}, {"bearing": "pair"}, "contact_angle must be above zero"),
    ],
)
def test_friction_by_preload_refuses(bearing, numbers, said):
    """Numbers that nothing reads, a bearing that there is not, and a preload that is no load."""
    with pytest.raises(AntennaPinError, match=said):
        _with_friction(BallBearing(**PAIR | bearing), **numbers)
