"""Central differences of two orders whose step is made finer while the orders disagree, compiled.

:func:`differentiated` makes the loop of a function: it begins with :func:`clear`, adds the values on the spot
and at each neighbour (:func:`add`, in the order of :func:`place_at`), and settles parts of these
(:func:`settle`). A trial has a row for each kind of differences, the finest order first, one for how the
function bends, and one for what it is on the spot. Where the farthest neighbours on both sides are that to
the bit nothing changes, and the others need not be examined.

Where a kink is much nearer than their step, central differences of all orders agree on the middle of two
derivatives: they part by as small a part of the jump as that distance is of the step, and by more the finer
the step is, until it straddles the kink no more. Differences of even order see the whole jump. So the bend
counts, as in :mod:`antenna_pin.base.calculus`, and the second order is kept off by it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from antenna_pin.base.records import Floats, Ints
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import composed, inlined

#: How often a step is made finer at most, and by how much; and with what a part begins to be settled.
OFTEN, FINER, BEGIN = 8, 8.0, (-1.0, -1.0, True)
#: Difference of the orders over the derivative that is good enough.
_GOOD = 1e-10
_UNSURE = 16.0 * float(np.finfo(float).eps)
# By how much more the orders may differ with a finer step where one yet finer is worth trying: next to a jump
# they differ by the same share of the derivative until it is straddled no more.
_NO_BETTER = 2.0
_LEAST = 1e-300  # what a derivative that is zero counts as
# Of half the jump of a slope on the spot: of the value there, and of those at 1, 2 and 3 steps on both sides.
# What a smooth function has of the second and fourth order goes (:mod:`antenna_pin.base.calculus`).
_BEND = np.array([-20.0, 15.0, -6.0, 1.0]) / 12.0


@inlined
def clear(trial: Floats, count: int) -> None:
    """Begin a trial of so many values."""
    for kind in range(trial.shape[0]):
        for i in range(count):
            trial[kind, i] = 0.0


@inlined
def place_at(turn: int, points: int) -> int:
    """Return the offsets of a difference in steps: 0, then pairs, farthest first."""
    away = points - (turn - 1) // 2
    return 0 if turn == 0 else (away if turn % 2 == 1 else -away)


@inlined
def add(values: Floats, count: int, place: int, weights: Floats, trial: Floats) -> bool:
    """Add the values at ``place`` steps to a trial, by ``weights``, (kinds, points).

    Returns:
        Whether any of them is another than on the spot.
    """
    kinds, away, moves = weights.shape[0], abs(place), False
    bend, middle = _BEND[away], kinds + 1
    if away == 0:
        for i in range(count):
            trial[kinds, i] += bend * values[i]
            trial[middle, i] = values[i]
        return False
    for kind in range(kinds):
        weight = weights[kind, away - 1] if place > 0 else -weights[kind, away - 1]
        if weight != 0.0:
            for i in range(count):
                trial[kind, i] += weight * values[i]
    for i in range(count):
        trial[kinds, i] += bend * values[i]
        # Written so that what is no number moves.
        moves = moves or not values[i] == trial[middle, i]
    return moves


@inlined
def rests(turn: int, moves: bool, count: int, trial: Floats) -> bool:
    """Return whether the function is constant, by its farthest pair of values."""
    if turn != 2 or moves:
        return False
    clear(trial, count)
    return True


@inlined
def _judge(trial: Floats, values: Floats, step: float, part: tuple[int, int]) -> tuple[float, float]:
    """Return difference of two orders and largest derivative in part of the values.

    Where the function bends by more than that, the second order becomes what differs by the bend. What the
    round-off of values makes of it does not count: it is all there is where a derivative is zero.
    """
    first, last = part
    largest, off, size, bends = 0.0, 0.0, 0.0, trial.shape[0] - 2
    for i in range(first, last):
        size = max(size, abs(values[i]))
        for kind in range(bends + 1):
            trial[kind, i] /= step
    noise = _UNSURE * size / step
    for i in range(first, last):
        largest = max(largest, abs(trial[0, i]))
        apart, bend = abs(trial[0, i] - trial[1, i]), abs(trial[bends, i])
        if bend > max(apart, noise):
            trial[1, i] = trial[0, i] + bend
            apart = bend
        off = max(off, apart)
    return max(off - noise, 0.0), largest


@inlined
def settle(
    trial: Floats,
    values: Floats,
    step: float,
    part: tuple[int, int],
    so_far: tuple[float, float, bool],
    out: Floats,
) -> tuple[float, float, bool]:
    """Rate a trial's part and store the best, until finer steps are pointless.

    Parts are settled by themselves: the round-off of one is no reason to take a finer step of another. Next
    to a kink a trial's derivative may be near zero by chance, and by how much orders differ is small beside
    earlier trials but not as a share; next to a jump it grows with the derivative and is the same share.

    Args:
        trial: It.
        values: The last that was added.
        step: Of the trial.
        part: First value, and the one behind the last.
        so_far: What the last trial has returned; :data:`BEGIN` before the first.
        out: To write to, (kinds, values).

    Returns:
        By how much the orders of what is kept differ, over the largest derivative, by how much those of any
        trial at least, and whether a finer step is worth trying: none is good yet, and the last was about as
        good as the best.
    """
    share, least, goes_on = so_far
    if not goes_on:
        return share, least, goes_on
    off, largest = _judge(trial, values, step, part)
    own, (first, last) = off / max(largest, _LEAST), part
    if share < 0.0 or own < share:
        share = own
        for kind in range(out.shape[0]):
            for i in range(first, last):
                out[kind, i] = trial[kind, i]
    least = off if least < 0.0 else min(off, least)
    near = own <= _NO_BETTER * share or off <= _NO_BETTER * least
    return share, least, share > _GOOD and near


def differentiated(evaluate: Callable[..., None]) -> Any:
    """Return the loop that differentiates a function, to be compiled into a kernel.

    Its arguments are the first step, the bounds of three parts of the values that are settled by themselves,
    arrays of values, weights and trial, that to write to, (kinds, values), and those of the function.

    Args:
        evaluate: Compiled function of displacement and further arguments, which writes the values.
    """

    @composed
    def differentiate(
        step: float,
        parts: tuple[int, int, int, int],
        arrays: tuple[Floats, Floats, Floats],
        out: Floats,
        *arguments: object,
    ) -> None:
        values, weights, trial = arrays
        points, count = weights.shape[1], parts[3]
        first, second, third = BEGIN, BEGIN, BEGIN
        for _ in range(OFTEN):
            clear(trial, count)
            moves = False
            for turn in range(2 * points + 1):
                place = place_at(turn, points)
                evaluate(place * step, *arguments)
                moves = add(values, count, place, weights, trial) or moves
                if rests(turn, moves, count, trial):
                    break
            first = settle(trial, values, step, (parts[0], parts[1]), first, out)
            second = settle(trial, values, step, (parts[1], parts[2]), second, out)
            third = settle(trial, values, step, (parts[2], parts[3]), third, out)
            if not (first[2] or second[2] or third[2]):
                break
            step /= FINER

    return differentiate


# --- numbers of a flat array that depend on parameters ------------------------------------------------------


@by_address
class Words(NamedTuple):
    """Numbers of an array that go with parameters."""

    first: Ints  # where those of each parameter begin, and the end, (parameters + 1,)
    at: Ints  # where they stand in the array, (words,)
    slopes: Floats  # by how much they change, (words,)
    was: Floats  # what they are undisplaced, scratch, (words,)


@inlined
def note_words(array: Floats, words: Words, m: int) -> None:
    """Note what the numbers of parameter m are before they are displaced."""
    for i in range(words.first[m], words.first[m + 1]):
        words.was[i] = array[words.at[i]]


@inlined
def displace_words(array: Floats, words: Words, m: int, h: float) -> None:
    """Displace them by h times their change, from what was noted."""
    for i in range(words.first[m], words.first[m + 1]):
        array[words.at[i]] = words.was[i] + h * words.slopes[i]


@inlined
def put_back_words(array: Floats, words: Words, m: int) -> None:
    """Put them back as they were noted."""
    for i in range(words.first[m], words.first[m + 1]):
        array[words.at[i]] = words.was[i]
