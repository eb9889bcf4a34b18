"""Where the pieces of a record start, before anything is fitted: along the record, not along one run.

With start values for its numbers a run loses the record: where the motion is chaotic, and where it comes to
a stop before or behind the record. So numbers and state go along the record together, as one knows them from
the rows so far: from where a piece has come to, both are moved as the next one's rows want it, each as far as
it is not known yet (an extended Kalman filter whose state has the numbers in it: Jazwinski 1970, Stochastic
Processes and Filtering Theory, chapter 8).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.state import State
from antenna_pin.errors import ScenarioError
from antenna_pin.fit.one_piece import Curve, Piece
from antenna_pin.fit.runs import Rig
from antenna_pin.fit.unknowns import Unknowns

__all__ = ["Along", "Known", "followed"]

Array = NDArray[np.float64]

# Standard deviations: of a number before any row is seen, in its size; of a state that nothing is known of,
# in error scales; and what straight lines leave out of a state that is known from the piece before.
_NUMBER, _STATE, _BENT = 1.0, 1.0, 1e-2
# How often a record is followed at most, and the standard deviation of a number before another time.
_PASSES, _AGAIN = 2, 0.1


class Known(NamedTuple):
    """What is known of a fit's numbers so far, as a search has them.

    Attributes:
        at: Their values, (p,).
        covariance: (p, p).
    """

    at: Array
    covariance: Array

    @classmethod
    def before(cls, unknowns: Unknowns) -> Known:
        """Return what is known before any row is seen."""
        return cls(unknowns.searched(unknowns.start), _NUMBER**2 * np.eye(unknowns.count))


class Along(NamedTuple):
    """Where following a record has come to.

    Attributes:
        origins: State in which each piece starts but the first, as text.
        known: What is known of the numbers behind it.
    """

    origins: tuple[str, ...]
    known: Known


def followed(
    rig: Rig,
    unknowns: Unknowns,
    own: Sequence[int],
    known: Known,
    curves: Sequence[Curve],
    shift: float,
    place: str,
) -> Along:
    """Follow a record in pieces.

    Args:
        rig: The record's test, its pieces known.
        unknowns: Parameters of the fit.
        own: Which of them are the rig's values.
        known: What is known of them.
        curves: Of the columns.
        shift: Of its clock [s].
        place: Of the record, for messages.

    Raises:
        ScenarioError: A piece's run does not come to its end.
    """
    best: _Pass | None = None
    for _ in range(_PASSES):
        made = _once(rig, unknowns, own, known, curves, shift)
        if isinstance(made, str):
            if best is None:
                raise ScenarioError(f"{place}: {made}")
            break
        if best is None or made.lost < best.lost:
            best = made
        if best.lost == 0 or best is not made:
            break
        known = Known(made.known.at, _AGAIN**2 * np.eye(unknowns.count))
    assert best is not None
    return Along(best.origins, best.known)


class _Pass(NamedTuple):
    """A record followed once.

    Attributes:
        origins: As of :class:`Along`.
        known: Likewise.
        lost: How many of its pieces were not found.
    """

    origins: tuple[str, ...]
    known: Known
    lost: int


def _once(
    rig: Rig, unknowns: Unknowns, own: Sequence[int], known: Known, curves: Sequence[Curve], shift: float
) -> _Pass | str:
    """Follow a record once, or return why there is no run."""
    origins: list[str] = []
    state: State | None = None
    spread, lost, p = np.zeros((0, 0)), 0, unknowns.count
    for piece in range(len(rig.pieces) - 1):
        one = Piece(rig, unknowns, own, curves, shift, piece, known.at, state)
        n = one.size
        whole = np.zeros((p + n, p + n))
        whole[:p, :p] = known.covariance
        if state is not None:
            whole[: len(spread), : len(spread)] = spread
            whole[p:, p:] += _BENT**2 * np.eye(n)
        found = one.found(whole)
        if found.lost and n:
            again = one.found(_apart(known, n))
            found = again if again.cost < found.cost else found
        if found.failed:
            return found.failed
        if state is not None:
            origins.append(found.first.to_json())
        lost, state = lost + found.lost, found.end
        if found.lost:  # it says from where to go on, and nothing for sure
            known = known._replace(at=found.at[:p])
            spread = _apart(known, len(found.ahead) - p)
        else:
            known, spread = Known(found.at[:p], found.covariance[:p, :p]), found.ahead
    return _Pass(tuple(origins), known, lost)


def _apart(known: Known, n: int) -> Array:
    """Return the covariance of numbers, with that of a state of n coordinates of which nothing is known."""
    p = len(known.at)
    whole = _STATE**2 * np.eye(p + n)
    whole[:p, :p] = known.covariance
    return whole
