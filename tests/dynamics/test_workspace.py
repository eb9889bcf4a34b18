"""What a workspace does to states: steps of configurations."""

import numpy as np
import pytest

from antenna_pin import build_system, load_scenario
from antenna_pin.dynamics import Workspace


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
