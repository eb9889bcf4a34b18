"""Friction of a joint by the bristle laws of contacts, compiled: torques stand for coefficients.

That by the load of the joint is added where rows are solved, as that of joints that hold what they stick
(:mod:`antenna_pin.dynamics.constraints.loaded_kernels`).
"""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.contact.bristle_kernels import bristle, gonthier_kink
from antenna_pin.contact.friction_kernels import FRICTION_SIZE, GONTHIER
from antenna_pin.elements.hook_kernels import Motion, Own, Powered


class PackedBristleFriction(Record):
    """Friction of bristles; its law stands behind."""

    reach: float  # deflection of bristles at Coulomb friction [rad] ([m])
    stiffness: float  # of the bristles [N m/rad] ([N/m])
    viscous: float  # [N m s/rad] ([N s/m])
    start: float  # deflection at the start, as a share of ``reach``
    share: float  # by how much a load adds to all of it [1/N m] ([1/N])
    radial: float  # torque of the load over radial force [m] ([-])
    axial: float  # over axial force [m] ([-])
    bending: float  # over moment [-] ([1/m])
    middle: float  # of the bearing along the axis [m]


LAYOUT = layout(PackedBristleFriction)
SIZE = words_of(LAYOUT)
# Among what it integrates.
HEAT = 0
BEND = 1
DWELL = 2
# From its record: whether it is on, the last number of its head.
_ON = -1


@inlined
def _bent(words: Floats, at: int, rate: float, own: Own) -> tuple[float, float, float, float]:
    """Torque of the bristles, their deflection, the rate of that, and of the dwell."""
    numbers = record(words[at : at + SIZE], LAYOUT)
    law = words[at + SIZE : at + SIZE + FRICTION_SIZE]
    y, i = own
    z = numbers.reach * (numbers.start + y[i + BEND])
    dwell = y[i + DWELL] if law[0] == GONTHIER else 0.0
    bend = z, 0.0, 0.0
    force, _, _, moves, _, _, dwells = bristle(law, 1.0, (rate, 0.0, 0.0), bend, bend, dwell)
    return force, z, moves, dwells


@inlined
def effort_of(words: Floats, at: int, motion: Motion, own: Own) -> float:
    """Torque [N m], or force [N], without that of a load."""
    _, _, rate = motion
    force, _, _, _ = _bent(words, at, rate, own)
    return float(force - record(words[at : at + SIZE], LAYOUT).viscous * rate)


@inlined
def write_rates_of(words: Floats, at: int, motion: Powered, own: Own, rates: Floats, x: int) -> None:
    """Power that is lost [W], and the rates of deflection and dwell [1/s]."""
    numbers = record(words[at : at + SIZE], LAYOUT)
    _, rate, power = motion
    _, z, moves, dwells = _bent(words, at, rate, own)
    rates[x + HEAT] = -power - numbers.stiffness * z * moves
    rates[x + BEND] = moves / numbers.reach
    if words[at + SIZE] == GONTHIER:
        rates[x + DWELL] = dwells


@inlined
def stored_of(words: Floats, at: int, angle: float, own: Own) -> float:
    """Energy stored in the bristles [J]."""
    numbers = record(words[at : at + SIZE], LAYOUT)
    y, i = own
    z = numbers.reach * (numbers.start + y[i + BEND])
    return float(0.5 * numbers.stiffness * z * z)


@inlined
def kink_of(words: Floats, at: int, k: int, motion: Motion, own: Own) -> float:
    """Return the rate, or of Gonthier's law its functions k, zero at kinks.

    Where the joint turns back the rate of the bristles changes.
    """
    law = words[at + SIZE : at + SIZE + FRICTION_SIZE]
    _, _, rate = motion
    if law[0] != GONTHIER:
        return float(rate)
    numbers = record(words[at : at + SIZE], LAYOUT)
    y, i = own
    return gonthier_kink(law, k, rate, numbers.reach * (numbers.start + y[i + BEND]), y[i + DWELL])


@inlined
def bearing(words: Floats, at: int) -> tuple[float, float, float, float]:
    """Return the weights of the load and the middle of the bearing [m].

    Weights are over radial force, axial force [m] and moment [-].
    """
    numbers = record(words[at : at + SIZE], LAYOUT)
    return float(numbers.radial), float(numbers.axial), float(numbers.bending), float(numbers.middle)


@inlined
def rub(words: Floats, at: int, rate: float, own: Own) -> float:
    """Torque by load, with its sign [-]."""
    share = words[at + _ON] * record(words[at : at + SIZE], LAYOUT).share
    if share == 0.0:
        return 0.0
    force, _, _, _ = _bent(words, at, rate, own)
    return float(share * force)
