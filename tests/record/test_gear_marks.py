"""Marks of gears and belts in recordings: circles that turn with their links, strands as long as they are."""

import math

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.show.record import record

from .conftest import floats, shapes_in


def tracks_of(run, **more):
    """Return the tracks of gears by name, (frames, 3, 4)."""
    actor = record(run, fps=50, **more).data["actors"][0]
    found = {}
    for track in actor["tracks"]:
        if track["name"].startswith("gears."):
            data = floats(track["data"], 12).reshape(-1, 3, 4)
            found[track["name"]] = data
    return found


def seen(data):
    """Whether a part is drawn in its size, not as a speck, at each key frame."""
    return np.linalg.norm(data[:, :, 0], axis=1) > 0.5


def test_circles_tell_whether_teeth_mesh():
    """Of the two circles in one place one is seen, and which goes by the mode of the samples."""
    run = simulate(load_scenario("pointing_gear"), duration=1.0)
    found = tracks_of(run)
    assert len(found) == 4
    for joint in ("motor", "dish"):
        (apart, meshing) = (found[f"gears.train {joint} circle {colour}"] for colour in ("7A5C2E", "E69F00"))
        assert np.array_equal(seen(apart), ~seen(meshing))
        assert seen(apart).any() and seen(meshing).any()


@pytest.mark.parametrize(("crossed", "name"), [(True, "root_first"), (False, "root_first")])
def test_strands_are_tangents_of_their_pulleys(crossed, name):
    """Crossed ones are sqrt(L^2 - (r + s)^2) long, others sqrt(L^2 - (r - s)^2), however links stand."""
    scenario = load_scenario(
        "solar_array", case="ideal", overrides=[f"gears.{name}.crossed={str(crossed).lower()}"]
    )
    run = simulate(scenario, duration=0.5)
    found = tracks_of(run)
    far = math.hypot(0.8, 0.025)  # from axis to axis
    length = math.sqrt(far**2 - (0.1 + 0.05 * (1 if crossed else -1)) ** 2)
    for side in ("plus", "minus"):
        # As it starts the pretension keeps both taut; uncrossed one is wound up, the other slack.
        taut, slack = (found[f"gears.{name} {side} {colour}"] for colour in ("E69F00", "B8C4CE"))
        assert np.array_equal(seen(taut), ~seen(slack))
        assert seen(taut).all() if crossed else seen(taut).all() == (side == "plus")
        drawn = np.where(seen(taut)[:, None], taut[:, :, 2], slack[:, :, 2])
        # A thin cylinder of 1 m is drawn out to it; key frames are single precision.
        assert np.linalg.norm(drawn, axis=1) == pytest.approx(length, rel=1e-6)
    shapes = shapes_in(record(run, fps=50))
    for strand in ("plus", "minus"):
        for colour in ("E69F00", "B8C4CE"):
            part = shapes[f"gears/gears.{name} {strand} {colour}/part"]
            assert part["height"] == 1.0 and 0.0 < part["radiusTop"] == part["radiusBottom"] < 0.02 * length
