"""What holds a system at the samples of a run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import held_sample_kernels, sample_kernels
from antenna_pin.dynamics.program_parts import program_parts
from antenna_pin.dynamics.workspace import Workspace
from antenna_pin.errors import FunctionError
from antenna_pin.mechanism import ROOM

__all__ = ["held_samples"]

Array = NDArray[np.float64]


def held_samples(
    workspace: Workspace,
    samples: sample_kernels.Samples,
    whole: sample_kernels.Whole,
    sights: sample_kernels.Sights,
    programs: Sequence[Array],
    done: NDArray[Any],
    failures: dict[int, FunctionError],
) -> tuple[Array, Array, Array, Array]:
    """Return accelerations, closures' wrenches, couplings' forces, residuals at samples.

    Mass matrix and bias are the tree's own. What holds motions goes to efforts in ``sights``, what elements
    hold with to ``done``; of samples in ``failures`` all is not-a-number, and those are added there whose
    motions fail.
    """
    system, constraints = workspace.system, workspace.constraints
    assert constraints is not None
    plan, n, nv = constraints.plan, len(samples.times), system.model.nv
    own, holds = len(plan.motions) + len(plan.couplings), plan.holds
    out = held_sample_kernels.Holding(
        rates=np.zeros((n, nv + system.manifold.nx)),
        closures=np.zeros((n, len(plan.closures), 2, 3)),
        joints=np.zeros((n, own + len(holds))),
        residuals=np.zeros((n, 4)),
    )
    held = held_sample_kernels.Held(
        plan=plan.words,
        work=constraints.work,
        mass=np.zeros((nv, nv)),
        bias=np.zeros(nv),
        room=np.zeros(len(whole.tree) + 1, ROOM),
        least=constraints.least_room,
        multipliers=constraints.least,
        applied=sights.wrenches,
    )
    for first, last in _parts(programs, one_by_one=bool(system.callables or failures)):
        workspace.program[:] = programs[first]
        try:
            workspace.prepare_motions(samples.times[first], samples.states[first])
        except FunctionError as error:
            failures[first] = error
        if first in failures:
            for part in out:
                part[first] = np.nan
            continue
        held_sample_kernels.observe_held(first, last, samples, whole, held, sights.forces, out)
    names = plan.motions
    drives = list(system.drives)
    sights.efforts["effort"][:, [drives.index(name) for name in names]] = out.joints[:, : len(names)]
    others = [f"{table}.{name}" for table in system.others for name in system.families[table]]
    done["effort"][:, [others.index(name) for name in holds]] += out.joints[:, own:]
    return out.rates[:, :nv], out.closures, out.joints[:, len(names) : own], out.residuals


def _parts(programs: Sequence[Array], one_by_one: bool) -> Iterator[tuple[int, int]]:
    """Yield first and last of samples with one program, or of each sample."""
    return ((i, i + 1) for i in range(len(programs))) if one_by_one else program_parts(programs)
