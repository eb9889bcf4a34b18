"""Joints with play of every geometry and backend, and states that press on them."""

import itertools

import numpy as np
import pinocchio as pin
import pytest
from hinge_shapes import antenna_hinge

from antenna_pin.contact import LankaraniNikravesh, VelocityBased
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import PlanarClearance

GEOMETRIES = {
    "revolute": antenna_hinge(),
    "small flange": antenna_hinge(flange_radius=0.011),
    "planar": PlanarClearance(bearing_radius=0.010, journal_radius=0.0098),
}
BORE = LankaraniNikravesh(stiffness=1e11, restitution=0.9)
FLANGE = LankaraniNikravesh(stiffness=3e8, restitution=0.8, exponent=1.2)
FRICTION = VelocityBased(static=0.15, dynamic=0.10, static_speed=0.01, dynamic_speed=0.1)
BACKENDS = ("closed-form", "coal")


def make_joint(geometry="revolute", **changes):
    given = dict(radial=BORE, axial=FLANGE, friction=FRICTION, backend="closed-form") | changes
    return ClearanceJoint(name="hinge", geometry=GEOMETRIES.get(geometry, geometry), **given)


@pytest.fixture(params=list(itertools.product(GEOMETRIES, BACKENDS)), ids=lambda p: f"{p[0]}, {p[1]}")
def joint(request):
    geometry, backend = request.param
    return make_joint(geometry, backend=backend)


@pytest.fixture
def joint_maker():
    return make_joint


def random_states(joint, count, seed):
    """Poses that touch here and there, turned any way about the axis, and twists; the axis is z."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        offset = rng.uniform(-3e-4, 3e-4, 3)
        turn = rng.uniform(-3.0, 3.0)
        if joint.planar:
            yield (
                np.array([offset[0], offset[1], np.cos(turn), np.sin(turn)]),
                rng.normal(size=3) * [0.02, 0.02, 1.0],
            )
            continue
        tilt = rng.uniform(-1.0, 1.0, 2) * 6e-3
        rotation = pin.exp3(np.array([*tilt, 0.0])) @ pin.exp3(np.array([0.0, 0.0, turn]))
        yield (
            np.array([*offset, *pin.Quaternion(rotation).coeffs()]),
            rng.normal(size=6) * [0.02, 0.02, 0.02, 0.5, 0.5, 1.0],
        )


@pytest.fixture
def states():
    return random_states
