"""Distances by coal's machine code are those by its bindings, to the last bit, of every shape of joint."""

import math

import numpy as np
import pytest

from antenna_pin.base.records import CONTACT
from antenna_pin.compiled.native import Evaluator
from antenna_pin.contact import Hertz
from antenna_pin.errors import FunctionError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import (
    CylindricalClearance,
    PlanarClearance,
    PrismaticClearance,
    RevoluteClearance,
    SphericalClearance,
    pose_of,
)
from antenna_pin.joints.geometry.shape import closed_form

PLAY = 2e-4  # [m]
REVOLUTE = {
    "bearing_radius": 20e-3,
    "journal_radius": 20e-3 - PLAY,
    "bearing_length": 40e-3,
    "flange_distance": 40e-3 + 2.0 * PLAY,
    "flange_radius": 26e-3,
}
SLIDER = {
    "guide_width": 40e-3,
    "guide_height": 30e-3,
    "slider_width": 40e-3 - 2.0 * PLAY,
    "slider_height": 30e-3 - 2.0 * PLAY,
    "slider_length": 60e-3,
    "corner_radius": 2e-3,
}
#: Shapes, and how far their journals go along the axis [m]: sliders leave guides that end.
SHAPES = {
    "flanges": (RevoluteClearance(**REVOLUTE, bearing_outer_radius=25e-3), PLAY),
    "small flanges": (RevoluteClearance(**REVOLUTE, bearing_outer_radius=27e-3), PLAY),
    "planar": (PlanarClearance(bearing_radius=20e-3, journal_radius=20e-3 - PLAY), 0.0),
    "ball": (SphericalClearance(socket_radius=20e-3, ball_radius=20e-3 - PLAY), PLAY),
    "guide": (PrismaticClearance(**SLIDER, roll=0.1), 0.1),
    "guide that ends": (PrismaticClearance(**SLIDER, guide_length=50e-3), 0.1),
    "key": (
        CylindricalClearance(
            bearing_radius=20e-3,
            journal_radius=20e-3 - PLAY,
            slider_length=60e-3,
            guide_length=50e-3,
            key_width=5e-3,
            keyway_width=5e-3 + PLAY,
            key_reach=22e-3,
        ),
        0.1,
    ),
}


def poses(along, count):
    """Random poses about contact, every fifth with parallel axes, and one upside down."""
    rng = np.random.default_rng(53)
    for k in range(count):
        centre = rng.uniform(-1.5, 1.5, 3) * (PLAY, PLAY, along)
        lean = rng.uniform(-8e-3, 8e-3, 2) * (k % 5 > 0)
        yield pose_of(centre, (*lean, -1.0 if k == count - 1 else 1.0))


@pytest.mark.parametrize("name", SHAPES)
def test_both_ways_fill_the_same_rows(name, both_ways):
    shape, along = SHAPES[name]
    contacts = len(shape.contact_places)

    def table():
        backend = shape.coal(np.eye(3))
        rows = np.zeros((200, contacts), CONTACT)
        for k, pose in enumerate(poses(along, len(rows))):
            backend.query(pose, rows[k], 0)
        assert (backend.evaluator is None) == (table.way == 1)
        table.way += 1
        return rows

    table.way = 0
    native, python = both_ways(table)
    assert native.tobytes() == python.tobytes()
    # With what the closed form has, but for the journal upside down, whose flanges are elsewhere; coal is
    # 3 pm off with parallel axes at flanges.
    for row, pose in list(zip(native, poses(along, len(native)), strict=True))[:-1]:
        assert row["gap"] == pytest.approx(closed_form(shape, pose)["gap"], abs=4e-12)


def test_distributed_load_is_the_same_both_ways_and_that_of_the_closed_form(both_ways):
    """Strips and sectors, tilted and with the journal on the bore and a flange."""
    shape, _ = SHAPES["flanges"]
    law = Hertz(stiffness=1e8, exponent=1.0)

    def forces(backend):
        joint = ClearanceJoint(
            name="j", geometry=shape, radial=law, axial=law, backend=backend, load="distributed"
        )
        found = []
        for pose in poses(PLAY, 30):
            x, y, z = pose["axis"][0]
            q = np.array([*pose["centre"][0], -0.5 * y, 0.5 * x, 0.0, 0.0])
            q[6] = math.sqrt(1.0 - q[3] ** 2 - q[4] ** 2)
            contacts = joint.evaluate(q, np.zeros(6))
            found.append([*contacts.gap, *contacts.normal_force, *contacts.generalized_force])
        return np.array(found)

    native, python = both_ways(lambda: forces("coal"))
    assert native.tobytes() == python.tobytes()
    assert (native[:, 4:8] > 0.0).any(axis=0).all()  # each patch presses in some pose
    # Gaps agree to 4 pm (flanges at parallel axes), of a force of 1e8 N/m; levers of it are below 0.03 m.
    assert native == pytest.approx(forces("closed-form"), abs=4e-4, rel=1e-9)


def test_only_requested_rows_are_measured(both_ways):
    """A bit too many or too few in a request would show in a row of zeros."""
    shape, along = SHAPES["guide"]

    def rows():
        table = np.zeros(16, CONTACT)
        shape.coal(np.eye(3)).query(next(poses(along, 2)), table, 0, [1.0, 0.0] * 8)
        return table["gap"]

    native, python = both_ways(rows)
    assert native.tolist() == python.tolist()
    assert (native[1::2] == 0.0).all() and (native[::2] != 0.0).all()


def test_an_exception_in_machine_code_is_an_error_with_its_text(shim):
    shape, _ = SHAPES["flanges"]
    backend = shape.coal(np.eye(3))
    work = backend.work
    from antenna_pin.joints.geometry.coal_kernels import QUERY, SHAPE_AT

    work[:SHAPE_AT].view(QUERY)["answer"] = shim.fail
    with pytest.raises(FunctionError, match="asked to fail"):
        backend.query(pose_of((PLAY, 0.0, 0.0), (0.0, 0.0, 1.0)), np.zeros(4, CONTACT), 0)
    # What comes after is what it was.
    work[:SHAPE_AT].view(QUERY)["answer"] = shim.distances
    table = np.zeros(4, CONTACT)
    backend.query(pose_of((PLAY, 0.0, 0.0), (0.0, 0.0, 1.0)), table, 0)
    assert math.isclose(table["gap"][0], 0.0, abs_tol=1e-15)  # the journal lies on the bore: round-off


def test_an_object_that_is_not_the_bindings_has_no_address(shim):
    """A look-alike of Python's is refused, not read as an object of C++."""
    shape, _ = SHAPES["planar"]
    backend = shape.coal(np.eye(3))
    assert backend.work.shape == (backend.words,)
    (pair,) = backend.pairs()
    assert isinstance(shim.pairs([pair]), Evaluator)
    assert shim.pairs([pair._replace(functor=object())]) is None
    assert shim.pairs([pair._replace(request=pair.functor)]) is None
