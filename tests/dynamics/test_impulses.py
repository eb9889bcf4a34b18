"""Impulses at joints and at stops: laws of impact, and the mass matrix of Pinocchio."""

import numpy as np
import pinocchio as pin
import pytest
from branches import TREE, closed

from antenna_pin import System, Urdf, build_mechanism
from antenna_pin.dynamics import Push, Workspace, impulse, push_apart
from antenna_pin.dynamics.impulse import apart

JOINTS = ("j1", "j3", "j5", "j6")


def moving(kind, seed):
    """A system, alone or with a loop closed, in motion; with its mass matrix and its joints' places in v."""
    if kind is None:
        system = System(build_mechanism(Urdf.from_text(TREE, "branches.urdf"), "free"))
        random, nv = np.random.default_rng(seed), system.model.nv
        q = pin.integrate(system.model, system.neutral(), random.normal(size=nv))
        y = system.state(q, random.normal(size=nv))
    else:
        system, y = closed(kind, seed)
    mass = pin.crba(system.model, system.model.createData(), y[: system.model.nq])
    mass = np.triu(mass) + np.triu(mass, 1).T
    places = [system.mechanism.joint(name).v.start for name in JOINTS]
    return Workspace(system), y, mass, places


def rows_of(workspace, y):
    """What loops hold: the rows whose rates stay zero, (rows, nv)."""
    if workspace.constraints is None:
        return np.zeros((0, workspace.model.nv))
    workspace.constraints.residuals(0.0, y, workspace.program)
    return workspace.constraints.every_row.copy()


@pytest.mark.parametrize("kind", [None, "spherical", "revolute"])
@pytest.mark.parametrize("seed", range(4))
def test_stops_struck_at_once_push_only_and_by_newtons_law(kind, seed):
    """Rates off the stops end at e times those into them, or above where a stop has no part in it."""
    workspace, y, mass, places = moving(kind, seed)
    nq, nv = workspace.model.nq, workspace.model.nv
    v = y[nq : nq + nv]
    pushes = [Push(at, -float(np.sign(v[at])), e) for at, e in zip(places, (0.0, 0.4, 0.8, 1.0), strict=True)]
    own = np.array([one.way * np.eye(nv)[one.at] for one in pushes])
    found = push_apart(workspace, 0.0, y, pushes)
    least = np.array([one.restitution for one in pushes]) * -(own @ v)
    rates, held = own @ found.velocity, rows_of(workspace, y)
    assert found.rates == pytest.approx(rates, abs=1e-12)
    assert np.all(found.pushes >= 0.0) and np.all(rates >= least - 1e-10)
    # Complementary: a stop from which a joint goes faster has not pushed.
    assert found.pushes * (rates - least) == pytest.approx(np.zeros(4), abs=1e-9)
    assert np.count_nonzero(found.pushes) >= 2
    assert held @ found.velocity == pytest.approx(np.zeros(len(held)), abs=1e-10)
    # What changes the momenta is the stops' impulses and those of the rows that hold.
    rest = mass @ (found.velocity - v) - own.T @ found.pushes
    along = held.T @ np.linalg.lstsq(held.T, rest, rcond=None)[0]
    assert rest == pytest.approx(along, abs=1e-9)
    lost = 0.5 * v @ mass @ v - 0.5 * found.velocity @ mass @ found.velocity
    assert lost == pytest.approx(-0.5 * found.pushes @ (rates + own @ v), rel=1e-9)
    again = push_apart(workspace, 0.0, y, pushes[::-1])
    assert again.velocity == pytest.approx(found.velocity, abs=1e-9)
    assert again.pushes[::-1] == pytest.approx(found.pushes, abs=1e-9)


@pytest.mark.parametrize("kind", [None, "spherical"])
def test_an_impulse_gives_joints_rates_at_the_least_change_of_kinetic_energy(kind):
    """By the Lagrange multipliers of all rows at once."""
    workspace, y, mass, places = moving(kind, 5)
    nq, nv = workspace.model.nq, workspace.model.nv
    v, wanted = y[nq : nq + nv], {places[0]: 0.7, places[2]: -0.2}
    velocity, _, forces = impulse(workspace, 0.0, y, wanted)
    rows = np.vstack([rows_of(workspace, y), np.eye(nv)[list(wanted)]])
    goal = np.concatenate([np.zeros(len(rows) - 2), list(wanted.values())])
    full = np.block([[mass, -rows.T], [rows, np.zeros((len(rows), len(rows)))]])
    expected = np.linalg.lstsq(full, np.concatenate([mass @ v, goal]), rcond=None)[0]
    assert velocity == pytest.approx(expected[:nv], abs=1e-10)
    assert forces == pytest.approx(expected[-2:], abs=1e-10)


def test_joints_of_branches_from_a_fixed_base_are_apart_and_joints_of_one_are_not():
    mechanism = build_mechanism(Urdf.from_text(TREE, "branches.urdf"), "fixed")
    system = System(mechanism)
    workspace, y = Workspace(system), system.state(system.neutral(), np.zeros(system.model.nv))
    place = {name: system.mechanism.joint(name).v.start for name in JOINTS}
    assert apart(workspace, 0.0, y, [place["j1"], place["j5"]], ())
    assert not apart(workspace, 0.0, y, [place["j1"], place["j3"]], ())
