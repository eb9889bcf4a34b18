"""Short runs that recordings are made of."""

import base64

import pytest
import umsgpack

from antenna_pin import load_scenario, simulate


@pytest.fixture(scope="session")
def clearance_run():
    """The antenna with clearance: impacts at both ends of the bore within 50 ms."""
    return simulate(load_scenario("bai2020", case="case3"), duration=0.05)


@pytest.fixture(scope="session")
def ideal_run():
    return simulate(load_scenario("bai2020", case="case1"), duration=0.05)


@pytest.fixture(scope="session")
def planar_run():
    return simulate(load_scenario("pendulum", case="planar"), duration=0.1)


@pytest.fixture(scope="session")
def ball_run():
    return simulate(load_scenario("spherical_pendulum", case="swing"), duration=0.05)


def shapes_in(recording):
    """Return the sizes of simple shapes in the scene, by path."""
    found = {}
    for text in recording.data["commands"]:
        command = umsgpack.unpackb(base64.b64decode(text))
        for shape in command.get("object", {}).get("geometries", ()):
            found[command["path"].lstrip("/").removeprefix("meshcat/")] = shape
    return found
