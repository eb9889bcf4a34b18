"""Displacements carried by a run's stages: what they are off by, by three of them."""

from types import SimpleNamespace

import numpy as np
import pytest
from plain_kernels import inner
from scipy.linalg import expm

from antenna_pin import RunSettings, System, Urdf, build_mechanism
from antenna_pin.elements import JointSpring
from antenna_pin.integrate import METHODS, Manifold
from antenna_pin.run.engine import carry_kernels
from antenna_pin.run.engine.carry_kernels import _grade, _place
from antenna_pin.run.engine.carrying import Steps, third_order
from antenna_pin.studies.nonlinear.vector_field import VectorField

ADAPTIVE = [one for one in METHODS.values() if one.adaptive and not one.implicit]


@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda one: one.name)
def test_three_stages_of_a_method_are_of_third_order(method):
    """Of ``w' = (1 + t) w``, whose solution is exp(t + t^2 / 2): an error that goes with the fourth power."""
    nodes, last = method.nodes, method.last
    weights, asked = third_order(nodes, last)
    assert asked.sum() == 3 and asked[last] == 0

    def off(h):
        slopes = np.zeros(len(nodes))
        for i in np.flatnonzero(asked).tolist():
            slopes[i] = (1.0 + h * nodes[i]) * (1.0 + h * weights[i] @ slopes)
        return abs(1.0 + h * weights[last] @ slopes - np.exp(h + 0.5 * h**2))

    # The next term of the error, of relative size h.
    assert np.log2(off(0.02) / off(0.01)) == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("method", ADAPTIVE, ids=lambda one: one.name)
@pytest.mark.parametrize("away", [0.0, 0.3, 4.0])
def test_roots_of_time_from_an_onset_and_to_a_release_are_polynomials(method, away):
    """``(t - since)^0.5`` and ``(until - t)^0.5``, whose integrals all these methods have to round-off."""
    t, h = 2.0, 0.5
    since, until = t - away * h, t + (1.0 + away) * h
    exact = h**1.5 / 1.5 * ((1.0 + away) ** 1.5 - away**1.5)
    for grade, function in (
        (_grade(t, h, np.inf, since), lambda time: time - since),
        (_grade(t, h, until, -np.inf), lambda time: until - time),
        # Of both the nearer one counts.
        (_grade(t, h, until, since - 0.5 * h), lambda time: until - time),
    ):
        total = 0.0
        for node, weight in zip(method.nodes, method.weights[method.last], strict=True):
            place, speed = _place(node, *grade)
            total += weight * speed * h * np.sqrt(max(function(t + place * h), 0.0))
        # The root of what is left of a cancellation at the very instant: its weight there is nought.
        assert total == pytest.approx(exact, rel=1e-14)
    assert _grade(t, h, np.inf, -np.inf) == (0, 0.0)


CART = """<robot name="rail"><link name="rail"/>
<link name="cart"><inertial><mass value="2"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>
<limit lower="-9" upper="9" effort="9" velocity="9"/></joint></robot>"""


def test_tangents_of_a_damped_oscillator_are_propagated_by_its_matrix_exponential():
    """With their error estimates, and with the energy that the damper takes: by the balance of energy."""
    mass, stiffness, damping = 2.0, 50.0, 3.0  # [kg], [N/m], [N s/m]
    spring = JointSpring(joint="slide", stiffness=stiffness, damping=damping)
    mechanism = build_mechanism(Urdf.from_text(CART, "rail.urdf"), base="fixed")
    field = VectorField(System(mechanism, springs={"slide": spring}), RunSettings(engine="compiled"))
    carrying, h = field.stage_propagation(), 0.01  # [s]
    over_step = expm(h * np.array([[0.0, 1.0], [-stiffness / mass, -damping / mass]]))
    energy = np.diag([stiffness, mass])  # twice that of [position, velocity], as a quadratic form
    states = np.array([[0.1, 0.3], over_step @ [0.1, 0.3], over_step @ over_step @ [0.1, 0.3]])
    y = np.array([field.system.state(one[:1], one[1:]) for one in states])
    ways, off = np.zeros((2, field.displacement, 2))
    ways[:2], off[:2] = np.eye(2), [[1e-3, 2e-3], [-3e-3, 5e-3]]
    found = carrying.along((0.0, h, y[0]), ways, off, until=np.inf, since=-np.inf)
    # By all stages, of eighth order: round-off of differences.
    assert found.ways[:2] == pytest.approx(over_step @ np.hstack([ways, off])[:2], abs=1e-12)
    lost = states[0] @ energy - states[1] @ energy @ over_step
    assert found.books[0] == pytest.approx(lost, abs=1e-10)
    steps = Steps(h * np.arange(2), np.full(2, h), np.full(2, -np.inf), np.array([np.inf]), y[:2])
    done, end, rest, books = carrying.along_all(steps, ways, off, np.ones(field.displacement), 1e-6)
    assert done == 2
    assert end[:2] == pytest.approx(over_step @ over_step @ ways[:2], abs=1e-12)
    # By three stages, of third order: (5 h)^4 / 24 of them in each step.
    assert rest[:2] == pytest.approx(over_step @ over_step @ off[:2], abs=1e-8)
    lost = states[0] @ energy - states[2] @ energy @ over_step @ over_step
    assert books[0] == pytest.approx(lost, abs=1e-10)


def test_error_sums_of_displacements_have_their_own_places():
    """Behind ways those of rates, then bristles: the stage's share of how far two orders part. CarryRoom."""
    nv, nx, d, h, speed, weight = 3, 5, 2, -0.2, 0.7, 0.4
    bristles = np.array([1, 4, 2])
    rng = np.random.default_rng(5)
    both = rng.normal(size=(2, d, nv + nx))
    v = rng.normal(size=nv)
    room = SimpleNamespace(
        tangent=SimpleNamespace(layout=Manifold(("rotation",), nx).layout, bristles=bristles),
        tableau=SimpleNamespace(weights=np.full((3, 3), weight), last=2),
        now=rng.normal(size=(d, 2 * nv + 3)),
        few=np.zeros((1, 2 * nv + 3)),
        slopes=np.zeros((3, d, 2 * nv + 3)),
        bracket=np.zeros(nv),
        rough=np.zeros((1, 2 * nv + 3)),
        books=np.zeros((1, nx)),
    )
    y = np.concatenate([[0.0, 0.0, 0.0, 1.0], v, np.zeros(nx)])
    inner(carry_kernels, "_note")(1, h, speed, y, both, room)
    moving = np.concatenate([np.arange(nv), nv + bristles])
    part = h * speed * weight
    assert not room.rough[0, :nv].any()
    assert room.rough[0, nv:] == pytest.approx(abs(part) * abs(both[1] - both[0])[0, moving], rel=1e-14)
    assert room.books[0] == pytest.approx(part * both[0, 0, nv:], rel=1e-14)
    assert room.slopes[1, :, nv:] == pytest.approx(speed * both[0][:, moving], rel=1e-14)
    ways = room.now[:, nv : 2 * nv] - np.cross(v, room.now[:, :nv])
    assert room.slopes[1, :, :nv] == pytest.approx(speed * ways, rel=1e-13)
