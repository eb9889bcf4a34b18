"""Lines are told apart, with any of the common kinds of colour blindness too."""

import itertools

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from antenna_pin.show.plot._style import COLOURS, IDEAL, SEQUENTIAL, distinct
from antenna_pin.show.plot.study import _LIGHTEST

# How people without one kind of cone see linear RGB: Machado, Oliveira and Fernandes (2009), IEEE Trans. Vis.
# Comput. Graph. 15(6), table 1, severity 1.
SEEN = {
    "all cones": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
# Linear RGB of sRGB to CIE XYZ, and its white (IEC 61966-2-1).
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def lab(colour, seen):
    """CIE L*a*b* of a colour, as it is seen."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    xyz = TO_XYZ @ np.clip(np.asarray(seen) @ linear, 0.0, 1.0) / TO_XYZ.sum(axis=1)
    f = np.where(xyz > 216.0 / 24389.0, np.cbrt(xyz), (841.0 / 108.0) * xyz + 4.0 / 29.0)
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])


@pytest.mark.parametrize("kind", SEEN)
def test_no_two_colours_look_alike(kind):
    """A difference of 2.3 is just seen, and thin lines need several times as much; black is among them."""
    found = [lab(colour, SEEN[kind]) for colour in (*COLOURS, IDEAL["color"])]
    apart = [np.linalg.norm(one - other) for one, other in itertools.combinations(found, 2)]
    assert min(apart) > 15.0


def test_lines_beyond_the_palette_differ_by_their_dashes():
    looks = [distinct(number) for number in range(24)]
    assert len({str(look) for look in looks}) == 24
    assert all(look["linestyle"] != IDEAL["linestyle"] for look in looks)


def test_lines_of_a_study_are_seen_on_paper():
    """The lightest has a contrast of 2.5 to white at least, where graphics are asked for 3 (WCAG 1.4.11)."""
    channels = np.array(SEQUENTIAL(_LIGHTEST)[:3])
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    assert 1.05 / (linear @ [0.2126, 0.7152, 0.0722] + 0.05) > 2.5
