"""Forward dynamics by the shim against ``pin.aba``."""

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin.compiled.calls import call_back
from antenna_pin.dynamics.by_pinocchio import machine_code_of

AXIS = np.array([1.0, -2.0, 0.5]) / np.linalg.norm([1.0, -2.0, 0.5])
#: Joints that the shim has compiled, in two orders, so that each is a root, a branch and an end.
COMMON = [
    pin.JointModelFreeFlyer(),
    pin.JointModelRX(),
    pin.JointModelRUBY(),
    pin.JointModelFreeFlyer(),
    pin.JointModelRevoluteUnaligned(AXIS),
    pin.JointModelRY(),
    pin.JointModelRUBX(),
    pin.JointModelRZ(),
    pin.JointModelRUBZ(),
]


def tree_of(joints):
    """Return a tree with a branch at every third body, of random placements and inertias."""
    model = pin.Model()
    pin.seed(2)
    for number, joint in enumerate(joints):
        parent = number if number % 3 else number // 2
        made = model.addJoint(parent, joint, pin.SE3.Random(), f"joint {number}")
        model.appendBodyToJoint(made, pin.Inertia.Random(), pin.SE3.Random())
    model.armature = np.linspace(0.0, 0.1, model.nv)
    return model


@pytest.mark.parametrize(
    "joints",
    [COMMON, COMMON[::-1], [*COMMON, pin.JointModelSpherical()], [pin.JointModelPZ(), *COMMON]],
    ids=["common", "reversed", "with a ball", "on a slide"],
)
def test_accelerations_are_those_of_the_bindings_to_the_last_bit(shim, joints):
    """The last two by the library's own function: a joint is not among the common ones."""
    model, rng = tree_of(joints), np.random.default_rng(3)
    nq, nv = model.nq, model.nv
    y, effort, acceleration = np.zeros(nq + nv), np.zeros(nv), np.zeros(nv)
    found = machine_code_of(model, y, effort, acceleration, np.zeros((nv, nv)), np.zeros(nv))
    assert found is not None
    evaluator, address, _ = found
    data = model.createData()
    for _ in range(50):
        y[:nq] = pin.integrate(model, pin.neutral(model), rng.normal(size=nv))
        y[nq:], effort[:] = rng.normal(size=nv), rng.normal(size=nv)
        assert call_back(address, 0.0, evaluator.address) == 0
        assert acceleration.tobytes() == pin.aba(model, data, y[:nq], y[nq:], effort).tobytes()
