"""Momenta of a state against those of its bodies, one by one, from Pinocchio's placements and twists."""

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin import System, Urdf, build_mechanism, load_scenario
from antenna_pin.dynamics import Workspace, audit
from antenna_pin.scenario.assemble import build_system


def bodies(model, q, v):
    """Momentum and angular momentum about the common mass centre of each joint's body, world axes."""
    data = model.createData()
    pin.forwardKinematics(model, data, q, v)
    centre = pin.centerOfMass(model, data, q)
    linear, angular = [], []
    for i in range(1, model.njoints):
        inertia, place = model.inertias[i], data.oMi[i]
        spin = place.rotation @ data.v[i].angular
        lever = place.rotation @ inertia.lever
        momentum = inertia.mass * (place.rotation @ data.v[i].linear + np.cross(spin, lever))
        own = place.rotation @ inertia.inertia @ place.rotation.T @ spin
        linear.append(momentum)
        angular.append(own + np.cross(place.translation + lever - centre, momentum))
    return np.array(linear), np.array(angular)


@pytest.mark.parametrize("base", ["free", "fixed"])
def test_momenta_are_the_sums_over_the_bodies_and_their_scales_leave_out_the_base(base):
    """A heavy bus that drifts would hide the error of a light reflector: it has no part in the scale."""
    system = build_system(load_scenario("bai2020", case="case3", overrides=[f"mechanism.base={base}"]))
    model, rng = system.model, np.random.default_rng(4)
    for _ in range(5):
        q = pin.integrate(model, system.neutral(), rng.normal(size=model.nv))
        v = rng.normal(size=model.nv)
        workspace = Workspace(system)
        y = system.state(q, v)
        workspace.measure(y)
        found = audit(workspace, y)
        linear, angular = bodies(model, q, v)
        moving = slice(1 if base == "free" else 0, None)
        # Round-off of sums over a few bodies.
        assert found.linear == pytest.approx(linear.sum(axis=0), rel=1e-12, abs=1e-12 * found.linear_scale)
        assert found.angular == pytest.approx(angular.sum(axis=0), rel=1e-12, abs=1e-12 * found.angular_scale)
        assert found.linear_scale == pytest.approx(
            np.linalg.norm(linear[moving], axis=1).sum(), rel=1e-12, abs=0.0
        )
        assert found.angular_scale == pytest.approx(
            np.linalg.norm(angular[moving], axis=1).sum(), rel=1e-12, abs=0.0
        )


def test_the_mass_that_an_impact_sees_does_not_depend_on_gravity():
    """It is the response to a force; what the bodies do without it is taken off."""
    masses = []
    for gravity in ([0.0, 0.0, 0.0], [1.0, -2.0, -9.81]):
        overrides = ["mechanism.base=fixed", f"mechanism.gravity={gravity}"]
        system = build_system(load_scenario("bai2020", case="case3", overrides=overrides))
        rng = np.random.default_rng(6)
        q = pin.integrate(system.model, system.neutral(), 0.01 * rng.normal(size=system.model.nv))
        y = system.state(q, np.zeros(system.model.nv))
        masses.append([Workspace(system).effective_mass(y, c) for c in range(len(system.contact_names))])
    # Accelerations of 10 m/s^2 beside those of 0.1 under a newton: round-off.
    assert masses[1] == pytest.approx(masses[0], rel=1e-11, abs=0.0)


TREE = """
<robot name="tree">
  <link name="bus"><inertial><origin xyz="0.1 -0.2 0.3"/><mass value="7"/>
    <inertia ixx="3" iyy="4" izz="5" ixy="0.2" ixz="-0.1" iyz="0.3"/></inertial></link>
  {links}
</robot>
"""
LINK = """
  <link name="{name}"><inertial><origin xyz="0.3 0.1 -0.2"/><mass value="2"/>
    <inertia ixx="0.3" iyy="0.4" izz="0.5" ixy="0.02" ixz="-0.01" iyz="0.03"/></inertial></link>
  <joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{name}"/>
    <origin xyz="0.5 -0.4 0.2" rpy="0.3 -0.5 0.7"/><axis xyz="{axis}"/>{limit}</joint>
"""


@pytest.mark.parametrize("base", ["free", "fixed"])
def test_energies_are_pinocchio_s_for_every_kind_of_joint(base):
    kinds = ["revolute", "continuous", "prismatic", "planar", "floating"]
    limit = '<limit effort="1" velocity="1" lower="-9" upper="9"/>'
    limits = {"revolute": limit, "prismatic": limit}
    links = "".join(
        LINK.format(
            name=kind,
            kind=kind,
            parent=parent,
            axis="0 0 1" if kind == "planar" else "0.6 0 -0.8",
            limit=limits.get(kind, ""),
        )
        for kind, parent in zip(kinds, ["bus", *kinds[:-1]], strict=True)
    )
    urdf = Urdf.from_text(TREE.format(links=links), "tree.urdf")
    system = System(build_mechanism(urdf, base, (1.0, -2.0, 3.0)))
    model, data, rng = system.model, system.model.createData(), np.random.default_rng(5)
    for _ in range(5):
        q = pin.integrate(model, system.neutral(), rng.normal(size=model.nv))
        v = rng.normal(size=model.nv)
        found = audit(Workspace(system), system.state(q, v))
        # Round-off of sums over a few bodies.
        assert found.kinetic == pytest.approx(pin.computeKineticEnergy(model, data, q, v), rel=1e-12, abs=0.0)
        assert found.gravity == pytest.approx(pin.computePotentialEnergy(model, data, q), rel=1e-12, abs=0.0)
        momentum = pin.computeCentroidalMomentum(model, data, q, v)
        both = np.concatenate([found.linear, found.angular])
        assert both == pytest.approx(momentum.vector, rel=1e-12, abs=1e-12 * np.abs(both).max())
