"""What a workspace does to states: steps of configurations, and the rates of what contacts integrate."""

import dataclasses

import numpy as np
import pytest
from displacements import anywhere

from antenna_pin import System, build_system, load_scenario
from antenna_pin.contact import CustomNormal, Hertz
from antenna_pin.dynamics import Workspace, observed


@pytest.mark.parametrize("turn", [*(10.0 ** np.arange(-18.0, 1.0, 0.5)), 0.0, -1e-13, -2.5])
def test_a_step_in_a_plane_is_that_of_a_screw_however_small_its_turn(turn):
    """Of a turn of 1e-13 rad Pinocchio's own keeps three digits of the way, for what it divides cancels.

    A body with one velocity in its own axes goes along a circle: by sin w / w of the way along it and
    (1 - cos w) / w across, here of numbers with more digits.
    """
    system = build_system(load_scenario("pendulum", case="planar"))
    hinge = system.mechanism.joint(system.clearances[0].name)
    way = np.zeros(system.model.nv)
    way[hinge.v] = 3e-13, -7e-13, turn
    q = np.zeros(system.model.nq)
    q[hinge.q] = 0.0, 0.0, np.cos(0.4), np.sin(0.4)
    y = np.concatenate([q, np.zeros(system.model.nv)])
    Workspace(system).retract(y, way)
    u, v, w = (np.longdouble(one) for one in way[hinge.v])
    along = np.sin(w) / w if turn else np.longdouble(1)
    across = 2 * np.sin(w / 2) ** 2 / w if turn else np.longdouble(0)
    ahead, aside = along * u - across * v, across * u + along * v
    c, s = (np.longdouble(one) for one in q[hinge.q][2:])
    expected = [float(c * ahead - s * aside), float(s * ahead + c * aside)]
    # Round-off of a dozen operations, of the length of the way: its parts may cancel in one of the axes.
    np.testing.assert_allclose(y[hinge.q][:2], expected, rtol=0.0, atol=1e-15 * np.hypot(3e-13, 7e-13))
    np.testing.assert_allclose(y[hinge.q][2:], [np.cos(0.4 + turn), np.sin(0.4 + turn)], rtol=0.0, atol=4e-16)


BRISTLES = {
    "law": "lugre",
    "static": 0.2,
    "dynamic": 0.1,
    "stribeck_speed": 0.01,
    "bristle_stiffness": 1e5,
    "replace": True,
}


@pytest.mark.parametrize(
    ("model", "case", "overrides"),
    [
        ("bai2020", "case3", {"clearance.elevation.geometry": "closed-form"}),
        ("bai2020", "case3", {"clearance.elevation": {"geometry": "closed-form", "friction": BRISTLES}}),
        (
            "spherical_pendulum",
            "swing",
            {f"clearance.{one}.geometry": "closed-form" for one in ("upper", "lower")},
        ),
    ],
    ids=["friction", "bristles", "two joints"],
)
def test_contacts_integrate_their_forces_and_losses(model, case, overrides):
    """Each in places of its own among x, behind the turned angles: force, and power of friction."""
    system = build_system(load_scenario(model, case=case, overrides=overrides))
    field, y = anywhere(system, 3)
    workspace, nv = field.workspace, system.model.nv
    rates = np.zeros(nv + system.manifold.nx)
    workspace.derivative(0.0, y, rates)
    found = observed(system, np.zeros(1), y[None], workspace.memory[None].copy(), [workspace.program])
    contact = {name: found.contact[name][0] for name in ("normal_force", "friction_force", "slip_speed")}
    places = system.impulse_x, system.lost_normal_x, system.lost_friction_x
    assert np.count_nonzero(contact["normal_force"]) >= len(system.clearances)
    assert rates[nv + system.impulse_x] == pytest.approx(contact["normal_force"], rel=1e-14)
    if not len(system.bristle_x):  # which store some of it
        power = contact["friction_force"] * contact["slip_speed"]
        assert rates[nv + system.lost_friction_x] == pytest.approx(power, rel=1e-12)
    own = np.sort(np.concatenate([*places, system.bristle_x]))
    assert own.tolist() == list(range(len(system.turn_x), len(system.turn_x) + len(own)))


def test_a_law_in_python_is_asked_for_the_contact_that_is_looked_at():
    """Or for all, of each joint: those that touch, of the gap in the table that is handed over."""
    built = build_system(load_scenario("spherical_pendulum", case="swing"))
    law = Hertz(stiffness=1e8)
    own = CustomNormal(force=law.force, elastic_force=law.elastic_force, elastic_energy=law.elastic_energy)
    joints = [dataclasses.replace(joint, radial=own) for joint in built.clearances]
    workspace = Workspace(System(built.mechanism, clearances=joints))
    table = workspace.table.copy()
    table["gap"], table["rate"] = (-1e-5, -4e-5), 0.0
    workspace.memory["touching"], workspace.memory["approach_speed"] = 1.0, 0.1
    force = 1e8 * np.array([1e-5, 4e-5]) ** 1.5
    for contact, expected in ((0, (force[0], -1.0)), (1, (-1.0, force[1])), (-1, force)):
        table["force"] = -1.0
        workspace.ask_laws(table, contact)
        assert table["force"] == pytest.approx(expected, rel=1e-13)
    workspace.memory["touching"] = 0.0
    workspace.ask_laws(table)
    assert not table["force"].any()
