r"""The first impact in a clearance joint that starts centred and at rest, in closed form.

Let :math:`A` be the inverse mass that the journal's centre has against the bearing's, across the axis, and
:math:`a` their relative acceleration under the drives with the joint open. The ideal joint holds them with
the force :math:`F = A^{-1} a`. Open, they cross the play :math:`c` and meet with :math:`v^2 = 2 a c`, and the
effective mass along the way is :math:`m = (n^T A n)^{-1}`. An elastic contact :math:`K \delta^{3/2}` then
peaks at

.. math:: \hat F = K^{2/5} \left(\tfrac54 m v^2\right)^{3/5} = K^{2/5} \left(\tfrac52 m a c\right)^{3/5}

and where the way is along the ideal force, so that :math:`m a = F`, at

.. math:: \frac{\hat F}{F} = \left[\frac{K (5c/2)^{3/2}}{F}\right]^{2/5} =
          \left(\frac{5 c}{2 \delta_F}\right)^{3/5}, \qquad K \delta_F^{3/2} = F

neither masses nor speed nor torques stand in it but through F. Two corrections: Lankarani and Nikravesh's
damping multiplies the peak by a number that depends on the restitution alone (0.974 for 0.95), and the load
goes on working over the depth, which multiplies it by (1 + depth / c)^(3/5).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from bench_tools import Array
from scipy.optimize import minimize_scalar

from antenna_pin import System
from antenna_pin.dynamics import acceleration


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstImpact:
    """What is expected of the first impact."""

    ideal_force: Array  # on the journal across the axis if the joint were ideal, in bearing axes, (2,) [N]
    acceleration: float  # of the journal's centre against the bearing's with the joint open [m/s^2]
    mass: float  # effective, along that acceleration [kg]
    approach_speed: float  # [m/s]
    onset: float  # [s]
    peak_force: float  # with both corrections [N]


def damped_over_elastic(restitution: float) -> float:
    """Return the peak force of a Lankarani-Nikravesh impact over that of Hertz's contact alone [-].

    With u the speed over the approach speed and chi = 3/4 (1 - restitution^2), the equation of motion
    m v dv = -K d^1.5 (1 + chi u) dd gives d^2.5 = 2.5 m v0^2 / K G(u), G the integral of s / (1 + chi s) from
    u to 1; the force over the elastic peak is (2 G)^0.6 (1 + chi u), largest while still closing.
    """
    chi = 0.75 * (1.0 - restitution**2)

    def force(u: float) -> float:
        if chi == 0.0:
            return float((1.0 - u * u) ** 0.6)
        g = (1.0 - u) / chi - math.log((1.0 + chi) / (1.0 + chi * u)) / chi**2
        return float((2.0 * g) ** 0.6 * (1.0 + chi * u))

    return -float(minimize_scalar(lambda u: -force(u), bounds=(0.0, 0.95), method="bounded").fun)


def first_impact(system: System, play: float, stiffness: float, restitution: float) -> FirstImpact:
    """Return what is expected of the first impact in a planar clearance joint.

    Args:
        system: With one planar clearance joint, centred and at rest at the start.
        play: c [m].
        stiffness: K [N/m^1.5].
        restitution: [-].
    """
    (joint,) = system.clearances
    slot = system.mechanism.joint(joint.name)
    across = slice(slot.v.start, slot.v.start + 2)
    q, v = system.neutral(), np.zeros(system.model.nv)
    upper = np.triu(pin.computeMinverse(system.model, system.model.createData(), q))
    inverse_mass = (upper + np.triu(upper, 1).T)[across, across]
    apart = acceleration(system, 0.0, q, v)[across]
    size = float(np.linalg.norm(apart))
    way = apart / size
    mass = 1.0 / float(way @ inverse_mass @ way)
    speed = math.sqrt(2.0 * size * play)
    peak = damped_over_elastic(restitution) * stiffness**0.4 * (1.25 * mass * speed**2) ** 0.6
    depth = (peak / stiffness) ** (2.0 / 3.0)
    return FirstImpact(
        ideal_force=-np.linalg.solve(inverse_mass, apart),
        acceleration=size,
        mass=mass,
        approach_speed=speed,
        onset=speed / size,
        peak_force=peak * (1.0 + depth / play) ** 0.6,
    )
