"""Pulses and directions of thrusters: as documented, by closed forms."""

import math

import numpy as np
import pytest

from antenna_pin.elements import Thruster
from antenna_pin.errors import InvalidParameterError


def thruster(**more):
    """A jet of 2.5 N along z."""
    return Thruster(**{"at": ("hull", (0.1, 0.2, 0.3)), "direction": (0, 0, 1), "thrust": 2.5, **more})


@pytest.mark.parametrize(
    ("limits", "least"),
    [
        ({"minimum_on_time": 0.03}, 0.03),
        ({"minimum_impulse": 0.1}, 0.04),  # over 2.5 N
        ({"minimum_on_time": 0.03, "minimum_impulse": 0.1}, 0.04),
        ({"minimum_on_time": 0.05, "minimum_impulse": 0.1}, 0.05),
    ],
)
def test_the_shortest_pulse_is_the_longer_of_both_limits(limits, least):
    assert thruster(**limits).minimum == pytest.approx(least, rel=1e-15)
    just = thruster(starts=(0.1,), durations=(least,), **limits)
    assert just.pulses == ((0.1, 0.1 + least),)
    with pytest.raises(InvalidParameterError, match=rf"durations\[0\] must be {least:g} s or more"):
        thruster(starts=(0.1,), durations=(0.99 * least,), **limits)


def test_short_pulses_are_lengthened_where_that_is_asked_for():
    jet = thruster(
        starts=(0.1, 0.5), durations=(0.01, 0.2), minimum_on_time=0.03, minimum_impulse=0.1,
        short_pulses="lengthen",
    )  # fmt: skip
    assert jet.minimum == 0.04
    assert jet.pulses == ((0.1, 0.1 + 0.04), (0.5, 0.5 + 0.2))


def test_a_pulse_is_on_from_its_start_up_to_its_end():
    jet = thruster(starts=(0.0, 0.5), durations=(0.25,))
    assert jet.edges == (0.25, 0.5, 0.75)
    on = [jet.from_now_on(t)["firing"] for t in (0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 1.0)]
    assert on == [1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]
    # A pulse may begin where the one before ends, and no sooner.
    assert thruster(starts=(0.0, 0.25), durations=(0.25,)).pulses[1] == (0.25, 0.5)
    with pytest.raises(InvalidParameterError, match=r"starts\[1\] must be at 0.25 s or later"):
        thruster(starts=(0.0, 0.125), durations=(0.25,))


def test_errors_of_direction():
    """By angle and azimuth as documented; drawn ones with the standard deviation that is given."""
    tilted = thruster(misalignment=0.1, azimuth=0.5)
    x, y, z = tilted.way
    # About z the first axis that is most across it is x, and y comes next.
    np.testing.assert_allclose(
        (x, y, z), (np.sin(0.1) * np.cos(0.5), np.sin(0.1) * np.sin(0.5), np.cos(0.1)), rtol=0, atol=1e-15
    )
    drawn = np.array([thruster(misalignment=0.01, seed=seed).way for seed in range(400)])
    # Of 400 normal numbers: a standard deviation is good to 1 in sqrt(800), here three of these.
    np.testing.assert_allclose(drawn[:, :2].std(axis=0), 0.01, rtol=3.0 / np.sqrt(800.0))
    np.testing.assert_allclose(np.linalg.norm(drawn, axis=1), 1.0, rtol=1e-15)
    assert thruster(misalignment=0.01, seed=5).way == thruster(misalignment=0.01, seed=5).way


@pytest.mark.parametrize("direction", [(0, 0, 1), (3, -4, 0), (1, 2, 2), (-1, 1, 1), (0.2, -0.3, 0.9)])
@pytest.mark.parametrize("azimuth", [0.0, 0.7, -2.0])
def test_the_azimuth_is_counted_right_handed_from_the_axis_most_across(direction, azimuth):
    """By Rodrigues' rotation: about the direction, of one that is tilted towards that axis."""
    d = np.array(direction) / np.linalg.norm(direction)
    axis = np.eye(3)[np.argmin(np.round(np.abs(d), 12))]
    across = axis - (axis @ d) * d
    tilted = math.cos(0.1) * d + math.sin(0.1) * across / np.linalg.norm(across)
    turned = (
        math.cos(azimuth) * tilted
        + math.sin(azimuth) * np.cross(d, tilted)
        + (1.0 - math.cos(azimuth)) * (d @ tilted) * d
    )
    jet = thruster(direction=direction, misalignment=0.1, azimuth=azimuth)
    np.testing.assert_allclose(jet.way, turned, rtol=0, atol=4e-16 * 8)  # round-off of eight sums


def test_a_drawn_error_has_the_two_angles_of_its_seed():
    """The first towards the axis most across the direction, the second right-handed from it."""
    for seed in range(5):
        first, second = 0.01 * np.random.default_rng(seed).normal(size=2)
        size = math.hypot(first, second)
        expected = math.sin(size) * first / size, math.sin(size) * second / size, math.cos(size)
        # Round-off of numbers of size 1e-2, and of the cosine.
        np.testing.assert_allclose(
            thruster(misalignment=0.01, seed=seed).way, expected, rtol=1e-13, atol=1e-16
        )


def test_words_tell_pulses_and_their_impulse():
    text = thruster(starts=(0.1, 0.5), durations=(0.1, 0.3), throttle=0.25, misalignment=0.01, seed=3).words()
    assert "2 pulses of 0.4 s in all, 1 N s" in text.replace("\u00a0", " ")
    assert "throttle 0.25" in text and "(drawn, seed 3)" in text
