"""Short runs that recordings are made of."""

import base64
import functools

import numpy as np
import pytest
import umsgpack

from antenna_pin import load_scenario, simulate
from antenna_pin.show import record as made

#: As in the package; equal recordings are made once.
record = functools.cache(made.record)


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


def doubles(text):
    """Return packed 64-bit numbers, (n,)."""
    return np.frombuffer(base64.b64decode(text), dtype="<f8")


def floats(text, width):
    """Return packed 32-bit numbers, (n, width)."""
    return np.frombuffer(base64.b64decode(text), dtype="<f4").reshape(-1, width)


def commands_of(recording):
    """Yield the commands that build the scene, each with its path."""
    for text in recording.data["commands"]:
        command = umsgpack.unpackb(base64.b64decode(text))
        yield command["path"].lstrip("/").removeprefix("meshcat/"), command


def placed(recording):
    """Return the placements of all things in the scene, (4, 4), by path."""
    return {
        path: np.array(command["matrix"]).reshape(4, 4).T
        for path, command in commands_of(recording)
        if command["type"] == "set_transform"
    }


def drawn_meshes(recording):
    """Return the vertices (n, 3) [m] of triangles in the scene, by path."""
    found = {}
    for path, command in commands_of(recording):
        for geometry in command.get("object", {}).get("geometries", ()):
            position = geometry.get("data", {}).get("attributes", {}).get("position")
            if position is not None:
                array = np.frombuffer(position["array"].data, dtype="<f4").reshape(-1, 3)
                found[path] = array.astype(float)
    return found


def shapes_in(recording):
    """Return the sizes of simple shapes in the scene, by path."""
    found = {}
    for path, command in commands_of(recording):
        for shape in command.get("object", {}).get("geometries", ()):
            found[path] = shape
    return found
