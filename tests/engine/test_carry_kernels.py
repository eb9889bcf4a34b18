"""How carry_along goes along a step, by its single kernels: time under the integral, and error sums."""

from types import SimpleNamespace

import numpy as np
import pytest
from plain_kernels import inner

from antenna_pin.integrate import Manifold
from antenna_pin.run.engine import carry_kernels


@pytest.mark.parametrize("grade", [-1, 0, 1])
@pytest.mark.parametrize("origin", [0.0, 0.4, 0.85])
def test_time_goes_once_through_a_step_at_the_speed_that_is_said(grade, origin):
    """From 0 to 1, whatever the instant of the change before or behind; its speed is the derivative."""
    place = inner(carry_kernels, "_place")
    assert place(0.0, grade, origin)[0] == pytest.approx(0.0, abs=1e-15)
    assert place(1.0, grade, origin)[0] == pytest.approx(1.0, abs=1e-15)
    for s in (0.1, 0.5, 0.9):
        # A polynomial of second degree, of which central differences are exact to round-off.
        slope = (place(s + 0.05, grade, origin)[0] - place(s - 0.05, grade, origin)[0]) / 0.1
        assert place(s, grade, origin)[1] == pytest.approx(slope, rel=1e-12)
        assert slope >= 0.0


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
