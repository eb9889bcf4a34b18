"""Largest efforts of touching elements, compiled, located in the dense output."""

from __future__ import annotations

from typing import Annotated

from antenna_pin.base.records import Floats, Record, Records, layout
from antenna_pin.compiled.decorators import deferred, kernel
from antenna_pin.dynamics.kernels import PARAMETERS, element_at, element_state, head_of
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.elements import kernels as elements
from antenna_pin.integrate.kernels import STATE_ROW, DenseStep, dense_state

# Equal parts of a step with evaluations of the effort at their ends; largest number of interpolations, and
# distance of two of them [-] at which they end: the error of the effort is its square.
_PARTS, _VERTICES, _CLOSE = 4, 12, 1e-5


class TouchRecord(Record):
    """A side of an element that touches, or a drive, and its largest effort."""

    block: int  # in the program
    side: int  # its bit in the element's mode; 0: a drive
    effort: float  # largest so far [N m] ([N])
    time: float  # of the largest [s]
    looks: Annotated[Floats, _PARTS + 1]  # efforts in a step, scratch


TOUCH = layout(TouchRecord)


@kernel
def keep_efforts(
    t: float, h: float, touches: Records[TouchRecord], step: DenseStep, numbers: Numbers
) -> None:
    """Update the largest effort of each touching side by the step from t [s].

    Args:
        t: Begin of the step [s].
        h: Size of the step [s].
        touches: TOUCH, (n,), updated.
        step: Manifold's layout, dense output, stepper's rows, number of the row of the start, scratch.
        numbers: System in numbers.
    """
    program = numbers.program
    for k in range(touches.shape[0]):
        own = touches[k]
        e = element_at(program, own.block)
        if elements.mode(e.kind, program, own.block + PARAMETERS) & own.side == 0 or e.on == 0.0:
            continue
        top = 0
        for part in range(_PARTS + 1):
            own.looks[part] = _effort(t, h, part / _PARTS, own.block, step, program)
            if own.looks[part] > own.looks[top]:
                top = part
        theta, effort = _largest(top, t, h, own, step, program)
        if effort > own.effort:
            own.effort = effort
            own.time = t + theta * h


@deferred
def _largest(
    top: int, t: float, h: float, own: TouchRecord, step: DenseStep, program: Floats
) -> tuple[float, float]:
    """Return fraction and size of the largest effort, by successive parabolas near a node."""
    looks, most = own.looks, own.looks[top]
    middle, centre = top / _PARTS, min(max(top, 1), _PARTS - 1) / _PARTS
    left, right = centre - 1.0 / _PARTS, centre + 1.0 / _PARTS
    below, above = looks[round(left * _PARTS)], looks[round(right * _PARTS)]
    if centre != middle:
        # The largest value may lie between an end of the step and the next node.
        beside = looks[round(centre * _PARTS)]
        theta = centre + _vertex(left - centre, right - centre, below - beside, above - beside)
        if not min(middle, centre) < theta < max(middle, centre):
            return middle, most
        effort = _effort(t, h, theta, own.block, step, program)
        if not effort > most:
            return middle, most
        left, below, right, above = middle, most, centre, beside
        if centre < middle:
            left, below, right, above = centre, beside, middle, most
        middle, most = theta, effort
    for _ in range(_VERTICES):
        theta = middle + _vertex(left - middle, right - middle, below - most, above - most)
        if not left < theta < right or abs(theta - middle) < _CLOSE:
            break
        effort = _effort(t, h, theta, own.block, step, program)
        if (theta < middle) == (effort > most):
            right, above = (middle, most) if effort > most else (theta, effort)
        else:
            left, below = (middle, most) if effort > most else (theta, effort)
        if effort > most:
            middle, most = theta, effort
    return middle, most


@deferred
def _effort(t: float, h: float, theta: float, block: int, step: DenseStep, program: Floats) -> float:
    """Return the size of an element's effort within a step [N m] ([N])."""
    space, dense, work, start, out = step
    dense_state(theta, space, dense, work, start, out)
    effort, _, _ = element_state(program, block, t + theta * h, out[STATE_ROW], head_of(program).nq)
    return abs(effort)


@kernel
def _vertex(back: float, on: float, below: float, above: float) -> float:
    """Return the vertex of the parabola through (0, 0), (back, below), (on, above)."""
    bend = above * back - below * on
    if bend == 0.0:
        return 0.0
    return 0.5 * (above * back * back - below * on * on) / bend
