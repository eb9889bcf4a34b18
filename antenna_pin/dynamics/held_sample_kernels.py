"""Accelerations, constraint forces and residuals at the samples of a run, compiled."""

from __future__ import annotations

from typing import NamedTuple

from antenna_pin.base.records import Floats, Records
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import kernel
from antenna_pin.dynamics.constraints.factor_kernels import factorize
from antenna_pin.dynamics.constraints.force_kernels import write_holding
from antenna_pin.dynamics.constraints.layout_kernels import PLACE_WORDS, applied_in, found_in, plan_of
from antenna_pin.dynamics.constraints.loaded_kernels import solve
from antenna_pin.dynamics.constraints.rows_kernels import write_rows
from antenna_pin.dynamics.sample_kernels import SampleArrays, SystemArrays
from antenna_pin.mechanism.mass_kernels import mass_and_bias
from antenna_pin.mechanism.room_kernels import BodyRoom
from antenna_pin.mechanism.tree_kernels import PLACE


@by_address
class ConstraintArrays(NamedTuple):
    """Constraints, and room for their solution."""

    plan: Floats  # the constraints
    work: Floats  # their work array
    mass: Floats  # mass matrix, (nv, nv), scratch
    bias: Floats  # (nv,), scratch
    room: Records[BodyRoom]  # arrays for the tree's dynamics, ROOM, (bodies + 1,)
    # of :func:`antenna_pin.dynamics.constraints.force_kernels.least_forces`, (2 rows (rows + 1),), scratch
    least: Floats
    multipliers: Floats  # (rows,), scratch
    applied: Floats  # actions of elements on links on bodies at the samples, (n, 6 bodies), or (n, 0)


@by_address
class Holding(NamedTuple):
    """Constraint forces and motion of a system at n samples."""

    rates: Floats  # generalized accelerations, and behind them powers of motions, (n, nv + nx)
    closures: Floats  # force [N] and moment [N m] of each closure, (n, closures, 2, 3)
    joints: Floats  # forces of motions, of couplings' followers, and of holding elements, (n, all)
    residuals: Floats  # largest of positions [m], [rad] and of rates [m/s], [rad/s], (n, 4)


@kernel
def observe_held(
    start: int,
    last: int,
    samples: SampleArrays,
    whole: SystemArrays,
    constraints: ConstraintArrays,
    forces: Floats,
    out: Holding,
) -> None:
    """Solve the constraints at samples start to last.

    Args:
        start: First sample.
        last: One behind the last.
        samples: :class:`antenna_pin.dynamics.sample_kernels.SampleArrays`.
        whole: ``SystemArrays``; its program is that of these samples.
        constraints: ``ConstraintArrays``.
        forces: Generalized forces of the elements, (n, nv).
        out: ``Holding``, to write to.
    """
    plan, work = constraints.plan, constraints.work
    found = found_in(plan, work)
    places = work[: PLACE_WORDS * (plan_of(plan).bodies + 1)].view(PLACE)
    for i in range(start, last):
        t, y = samples.times[i], samples.states[i]
        write_rows(t, y, whole.program, plan, work)
        mass_and_bias(whole.tree, places, whole.gravity, constraints.room, constraints.mass, constraints.bias)
        factorize(plan, work, constraints.mass)
        first_applied, end_applied = applied_in(plan)
        for k in range(first_applied, end_applied):
            work[k] = constraints.applied[i, k - first_applied]
        solve(y, whole.program, plan, work, forces[i], constraints.bias, out.rates[i])
        write_holding(plan, work, constraints.least, constraints.multipliers, out.closures[i], out.joints[i])
        residuals = out.residuals[i]
        residuals[0], residuals[1], residuals[2], residuals[3] = (
            found.gap,
            found.turn,
            found.speed,
            found.spin,
        )
