"""Derivatives of a system's rates along displacements of a state, compiled.

A displacement is laid out as [way (nv), rate (nv), bristles, logarithm of approach speeds (contacts), of
effective masses (contacts), time]; ways are in the coordinates of velocities.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import kernel
from antenna_pin.engine._step_kernels import derivative
from antenna_pin.integrate._manifold_kernels import move_by_velocity, space_of


@kernel
def write_slopes(
    t: float,
    y: Any,
    ways: Any,
    steps: Any,
    weights: Any,
    layout: Any,
    bristles: Any,
    numbers: Any,
    rows: Any,
    kept: Any,
    out: Any,
) -> None:
    """Write central differences of the rates along displacements.

    Args:
        t: Time [s].
        y: State.
        ways: Displacements, row by row, (k, displacement).
        steps: Of the differences, over a displacement, (k,).
        weights: Of the differences at 1, 2, ... steps, of each kind, (kinds, points).
        layout: Of the manifold.
        bristles: Their places in x, (bristles,).
        numbers: The system; its contact memory is as it was in the end.
        rows: Scratch, (2, size).
        kept: Scratch, MEMORY, (contacts,).
        out: To write to, (kinds, k, nv + nx).
    """
    space = space_of(layout)
    nq, nv, n = space.nq, space.nv, space.nv + space.nx
    memory, contacts = numbers.memory, numbers.memory.shape[0]
    speeds = 2 * nv + bristles.shape[0]
    step, state, rates = numbers.step, rows[0], rows[1, :n]
    for c in range(contacts):
        kept[c].approach_speed = memory[c].approach_speed
        kept[c].effective_mass = memory[c].effective_mass
    for k in range(ways.shape[0]):
        way = ways[k]
        for kind in range(out.shape[0]):
            for i in range(n):
                out[kind, k, i] = 0.0
        for point in range(weights.shape[1]):
            for side in (1.0, -1.0):
                h = side * (point + 1.0) * steps[k]
                for i in range(nq + n):
                    state[i] = y[i]
                for i in range(nv):
                    step[i] = h * way[i]
                move_by_velocity(layout, rows, 0, step)
                for i in range(nv):
                    state[nq + i] += h * way[nv + i]
                for i in range(bristles.shape[0]):
                    state[nq + nv + bristles[i]] += h * way[2 * nv + i]
                for c in range(contacts):
                    memory[c].approach_speed = kept[c].approach_speed * math.exp(h * way[speeds + c])
                    memory[c].effective_mass = kept[c].effective_mass * math.exp(
                        h * way[speeds + contacts + c]
                    )
                derivative(t + h * way[speeds + 2 * contacts], state, numbers, rates)
                for kind in range(out.shape[0]):
                    weight = side * weights[kind, point] / steps[k]
                    for i in range(n):
                        out[kind, k, i] += weight * rates[i]
    for c in range(contacts):
        memory[c].approach_speed = kept[c].approach_speed
        memory[c].effective_mass = kept[c].effective_mass
