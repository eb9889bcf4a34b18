"""Contact scenarios of poses made to show each of them, and poses that sit on the border between two.

Of revolute joints: ``contact_scenario``, ``scenario_in``.
"""

import itertools
import math

import pytest

from antenna_pin.joints.geometry import AxialScenario, RadialScenario
from antenna_pin.joints.geometry import revolute_kernels as revolute

R, A = RadialScenario, AxialScenario
PRESS = 1e-6  # [m], deeper than any scenario is sensitive to


def tilted(angle):
    return [math.sin(angle), 0.0, math.cos(angle)]


# Radial play 0.2 mm, bearing 50 mm long: offset x [m] and tilt about y [rad] that show a radial scenario.
RADIAL = {
    R.NONE: (1.0e-4, 1e-6),
    # Off centre and tilted: at the + end x is 0.1 mm + 25 mm * 4.3 mrad = 0.2075 mm, at the other nearly 0.
    R.ONE_POINT: (1.0e-4, 4.3e-3),
    # Centred and tilted across: 25 mm * 8.3 mrad = 0.2075 mm, on opposite sides.
    R.TWO_POINTS: (0.0, 8.3e-3),
    # Pressed along the whole length.
    R.LINE: (2.0e-4 + PRESS, 1e-6),
}


def axial_play(scenario, tilt):
    """Axial clearance and axial offset of the journal [m] that show an axial scenario at a given tilt.

    The edge (radius 12 mm) of a tilted flange takes 12 mm * tilt of the play at both ends.
    """
    edge = 0.012 * math.sin(tilt)
    return {
        A.NONE: (3e-4, 0.0),
        A.ONE_POINT: (3e-4, -(3e-4 - edge) - min(PRESS, edge)),
        A.TWO_POINTS: (0.5 * edge, 0.0),
        A.SURFACE: (3e-4, -(3e-4 + edge) - PRESS),
    }[scenario]


@pytest.mark.parametrize(("radial", "axial"), list(itertools.product(R, A)), ids=lambda s: s.name.lower())
def test_every_pair_of_scenarios(radial, axial, joint):
    """Bai and Zhao count 13 of these; a journal may also sit deep enough for the others."""
    x, tilt = RADIAL[radial]
    play, z = axial_play(axial, tilt)
    shape = joint(axial_clearance=play)
    assert shape.scenario([x, 0.0, z], tilted(tilt)) == (radial, axial)
    # The other way round: mirrored in x, and in z.
    assert shape.scenario([-x, 0.0, z], tilted(-tilt)) == (radial, axial)
    assert shape.scenario([x, 0.0, -z], tilted(-tilt)) == (radial, axial)


def test_centred_touches_nothing(joint):
    assert joint().scenario([0, 0, 0], [0, 0, 1]) == (R.NONE, A.NONE)


def test_a_gap_of_zero_is_no_penetration(joint):
    shape = joint(axial_clearance=0.0)
    assert shape.scenario([0, 0, 0], [0, 0, 1]) == (R.NONE, A.NONE)
    assert shape.scenario([0, 0, 1e-12], [0, 0, 1]) == (R.NONE, A.SURFACE)


def test_parallel_and_pressed_is_a_line_and_a_surface(joint):
    assert joint().scenario([2.1e-4, 0, 2.1e-4], [0, 0, 1]) == (R.LINE, A.SURFACE)


@pytest.mark.parametrize(("x", "tilt"), [(2.05e-4, 1e-4), (2.2e-4, 5e-4)])
def test_both_ends_on_the_same_side_is_a_line(x, tilt, joint):
    """Bore and journal are straight: with both ends pressed on the same side the middle is pressed too."""
    shape = joint()
    assert all(c.gap < 0.0 for c in shape.contacts([x, 0, 0], tilted(tilt))[:2])
    assert shape.scenario([x, 0, 0], tilted(tilt))[0] == R.LINE


@pytest.mark.parametrize("end", [1.0, -1.0])
def test_opposite_sides_are_two_points_even_where_the_middle_is_pressed(end, joint):
    """From one side of the bore, at one end, through the wall at the other end on the other side."""
    play, half = 2e-4, 0.025
    middle, across = 1.05 * play, end * 2.1 * play
    shape, axis = joint(), tilted(math.asin(across / math.hypot(half, across)))
    gaps = [c.gap for c in shape.contacts([middle, 0, 0], axis)[:2]]
    # But for the tilt of 0.017 rad, whose square is 3e-4 of the bore's radius of 50 plays.
    assert sorted(gaps) == pytest.approx([-2.15 * play, -0.05 * play], abs=0.03 * play)
    assert shape.scenario([middle, 0, 0], axis)[0] == R.TWO_POINTS


def test_ends_pressed_aside_of_a_free_middle_are_two_points(joint):
    """Off centre by half the play and tilted across that: the ends press 62 degrees to either side of it."""
    play, half = 2e-4, 0.025
    shape, angle = joint(), math.atan(0.95 * play / half)
    pose = [0.5 * play, 0.0, 0.0], [0.0, math.sin(angle), math.cos(angle)]
    gaps = [c.gap for c in shape.contacts(*pose)[:2]]
    # But for the tilt of 8 mrad, whose square is 6e-5 of the bore's radius of 50 plays.
    assert gaps == pytest.approx([(1.0 - math.hypot(0.5, 0.95)) * play] * 2, abs=0.01 * play)
    assert shape.scenario(*pose)[0] == R.TWO_POINTS


def test_scenarios_do_not_depend_on_the_azimuth(joint):
    shape = joint(axial_clearance=1e-5)
    for turn in (0.3, 1.9, 4.4):
        c, s = math.cos(turn), math.sin(turn)
        for x, tilt in RADIAL.values():
            expected = shape.scenario([x, 0, 2e-6], tilted(tilt))
            sine = math.sin(tilt)
            assert shape.scenario([c * x, s * x, 2e-6], [c * sine, s * sine, math.cos(tilt)]) == expected


@pytest.mark.parametrize("flange_radius", [0.014, 0.011])
def test_a_flange_is_a_surface_once_its_whole_edge_is_pressed(flange_radius, joint):
    """The far side of the smaller edge lies higher than the near side by its diameter times the tilt."""
    tilt = 1e-3
    edge = min(0.012, flange_radius) * math.sin(tilt)
    for share, expected in ((-0.01, A.NONE), (0.01, A.ONE_POINT), (0.99, A.ONE_POINT), (1.01, A.SURFACE)):
        shape = joint(flange_radius=flange_radius)
        z = -(2e-4 - edge) - share * 2.0 * edge
        assert shape.scenario([0, 0, z], tilted(tilt))[1] == expected, share


def test_the_scenarios_have_the_numbers_of_the_kernels():
    numbers = (revolute.NONE, revolute.ONE_POINT, revolute.TWO_POINTS, revolute.EXTENDED)
    assert [int(each) for each in RadialScenario] == [int(number) for number in numbers]
    assert [int(each) for each in AxialScenario] == [int(number) for number in numbers]
