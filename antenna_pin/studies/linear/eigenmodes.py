"""Natural frequencies, damping ratios and shapes of small motions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig, eigh, null_space
from scipy.optimize import linear_sum_assignment

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array, Complex
from antenna_pin.studies.linear.linearisation import Linearisation

Kind = Literal["rigid", "free", "elastic", "unstable"]
"""A motion of all as one rigid body, one that nothing resists, a vibration, one that runs away."""

# Of stiffnesses scaled to ones on their diagonal: what is round-off. Asymmetry that is none.
_SLACK, _SYMMETRIC = 1e-11, 1e-8
# Eigenvalues over the largest that count as zero, of a moving state, whose zeros are multiple.
_ZERO = 1e-7


@dataclass(frozen=True, slots=True, eq=False)
class Eigen:
    """Eigenvalues and shapes."""

    frequency: Array  # undamped, in rising order; 0 where nothing resists or where it runs away, (n,) [rad/s]
    kind: tuple[Kind, ...]  # of each mode, (n,)
    # in the directions left free, to unit modal mass, (k, n); complex about a state that moves
    shape: Complex
    # the two eigenvalues of each mode with damping and friction, (n, 2) [1/s]; NaN where the damped motion
    # has no pair for it
    roots: Complex
    others: Complex  # eigenvalues with damping that no mode has: of bristles, and of what is left

    @property
    def modulus(self) -> Array:
        """Modulus of the damped eigenvalues: the geometric mean of both, (n,) [rad/s]."""
        return np.asarray(np.sqrt(np.abs(self.roots[:, 0]) * np.abs(self.roots[:, 1])))

    @property
    def damping_ratio(self) -> Array:
        """Damping ratio, above 1 without oscillation, (n,) [-]; NaN at frequency 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(-0.5 * self.roots.sum(axis=1).real / self.modulus)


@takes()
def solve(linear: Linearisation) -> Eigen:
    """Return the modes of small motions about a state.

    About a state at rest, motions of all as one rigid body and those that nothing resists are taken out
    exactly before the eigenvalues are computed.
    """
    return _at_rest(linear) if linear.still else _in_motion(linear)


def _at_rest(linear: Linearisation) -> Eigen:
    mass, stiffness = linear.mass, linear.undamped_stiffness
    rigid = linear.rigid
    slack = _slack(stiffness, linear.damping, rigid)
    loose = np.hstack([rigid, slack])
    rest = null_space(loose.T @ mass) if loose.shape[1] else np.eye(len(mass))
    kinds: list[Kind] = [*(("rigid",) * rigid.shape[1]), *(("free",) * slack.shape[1])]
    squares, shapes = np.zeros(0), np.zeros((len(mass), 0))
    if rest.shape[1]:
        squares, own, flutter = _squares(rest.T @ stiffness @ rest, rest.T @ mass @ rest)
        shapes = rest @ own
        least = _SLACK * float(np.abs(squares).max())
        for square, runs_away in zip(squares, flutter | (squares < -least), strict=True):
            kinds.append("unstable" if runs_away else "free" if square <= least else "elastic")
        squares = np.where(np.abs(squares) <= least, 0.0, squares)
    if loose.shape[1]:
        root = np.linalg.cholesky(loose.T @ mass @ loose)
        loose = loose @ np.linalg.inv(root).T
    whole = np.hstack([loose, shapes])
    values = np.concatenate([np.zeros(loose.shape[1]), squares])
    roots, others = _paired(linear, rest, shapes)
    roots = np.vstack([np.zeros((loose.shape[1], 2)), roots])
    frequency = np.sqrt(np.maximum(values, 0.0))
    return Eigen(frequency, tuple(kinds), _signed(whole), roots, others)


def _squares(stiffness: Array, mass: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return squared frequencies in rising order, mass-normalized shapes, and flags of flutter.

    Forces that derive from no potential, such as that of a flange that lifts off one side, may make the
    stiffness unsymmetric; squares may be complex then, and the motion grows.
    """
    if np.abs(stiffness - stiffness.T).max() <= _SYMMETRIC * np.abs(stiffness).max(initial=0.0):
        squares, shapes = eigh(0.5 * (stiffness + stiffness.T), mass)
        return squares, shapes, np.zeros(len(squares), dtype=bool)
    values, vectors = eig(stiffness, mass)
    order = np.argsort(values.real)
    values, shapes = values[order], vectors[:, order].real
    flutter = np.abs(values.imag) > 1e-6 * np.abs(values)
    shapes = shapes / np.sqrt(np.einsum("ij,ik,kj->j", shapes, mass, shapes))
    return values.real, shapes, flutter


def _slack(stiffness: Array, damping: Array, rigid: Array) -> Array:
    """Return directions without stiffness or damping, other than rigid ones, (k, n)."""
    k = len(stiffness)
    both = np.vstack([_scaled(stiffness), _scaled(damping)])
    if rigid.shape[1]:
        both = both @ (np.eye(k) - rigid @ rigid.T)
        both = np.vstack([both, rigid.T])
    _, values, right = np.linalg.svd(both, full_matrices=len(both) < k)
    free = int(np.count_nonzero(values <= _SLACK)) + k - len(values)
    return np.asarray(right[k - free :].T) if free else np.zeros((k, 0))


def _scaled(matrix: Array) -> Array:
    """Return rows over their largest number, free of units."""
    largest = np.abs(matrix).max(axis=1, initial=0.0)[:, None]
    noise = 1e-14 * float(largest.max(initial=0.0))
    return np.asarray(np.where(largest > noise, matrix / np.where(largest > noise, largest, 1.0), 0.0))


def _paired(linear: Linearisation, rest: Array, shapes: Array) -> tuple[Complex, Complex]:
    """Return the damped eigenvalues of each shape, (n, 2), and the unpaired ones."""
    k, n = len(linear.mass), rest.shape[1]
    if n == 0:
        return np.zeros((0, 2), dtype=complex), np.zeros(0, dtype=complex)
    bristles = linear.bristles[0].shape[1]
    into = np.zeros((2 * n + bristles, 2 * k + bristles))
    out = np.zeros((2 * k + bristles, 2 * n + bristles))
    left = np.linalg.solve(rest.T @ linear.mass @ rest, rest.T @ linear.mass)
    into[:n, :k], into[n : 2 * n, k : 2 * k] = left, left
    out[:k, :n], out[k : 2 * k, n : 2 * n] = rest, rest
    into[2 * n :, 2 * k :], out[2 * k :, 2 * n :] = np.eye(bristles), np.eye(bristles)
    values, vectors = eig(into @ linear.state_matrix @ out)
    return _assigned(values, rest @ vectors[:n], shapes.astype(complex), linear.mass)


def _assigned(values: Complex, places: Complex, shapes: Complex, mass: Array) -> tuple[Complex, Complex]:
    """Return the two eigenvalues of most similar shapes for each shape."""
    n = shapes.shape[1]
    roots = np.full((n, 2), np.nan, dtype=complex)
    size = np.sqrt(np.abs(np.einsum("ij,ik,kj->j", places.conj(), mass, places)))
    likeness = np.abs(shapes.conj().T @ mass @ places) / np.where(size > 0.0, size, 1.0)
    tiny = 1e-12 * float(np.abs(values).max(initial=0.0))
    pairs = [i for i, value in enumerate(values) if value.imag > tiny]
    lone = [i for i, value in enumerate(values) if abs(value.imag) <= tiny]
    which, own = linear_sum_assignment(-likeness[:, pairs]) if pairs else (np.zeros(0, int), np.zeros(0, int))
    for mode, pair in zip(which, own, strict=True):
        value = values[pairs[pair]]
        roots[mode] = value, value.conjugate()
    used = {pairs[i] for i in own}
    open_ones = [mode for mode in range(n) if np.isnan(roots[mode, 0])]
    slots = [mode for mode in open_ones for _ in range(2)]
    if slots and lone:
        rows, columns = linear_sum_assignment(-likeness[np.ix_(slots, lone)])
        found: dict[int, list[complex]] = {}
        for row, column in zip(rows, columns, strict=True):
            found.setdefault(slots[row], []).append(complex(values[lone[column]].real))
            used.add(lone[column])
        for mode, two in found.items():
            if len(two) == 2:
                roots[mode] = sorted(two, key=lambda value: -value.real)
    others = [values[i] for i in (*pairs, *lone) if i not in used]
    return roots, np.array(others, dtype=complex)


def _in_motion(linear: Linearisation) -> Eigen:
    """Return the modes about a state that moves, or with forces that have no potential."""
    k = len(linear.mass)
    # Where a free base is does not matter, but how it moves.
    first = linear.rigid.shape[1]
    whole = linear.undamped_matrix[first:, first:]
    values, vectors = eig(whole)
    tiny = _ZERO * float(np.abs(values).max(initial=0.0))
    places = np.vstack([np.zeros((first, len(values))), vectors[: k - first]])
    speeds = vectors[k - first : 2 * k - first]
    kept: list[tuple[complex, Complex, Kind]] = []
    for value, place, speed in zip(values, places.T, speeds.T, strict=True):
        if value.imag > tiny:
            # The base's part follows from its velocity, in axes that turn with it.
            shape = place.astype(complex)
            if first:
                shape[:first] = _base_place(linear, complex(value), speed[:first])
            inner = _inner(linear, place)
            alone = inner <= 1e-9 * _inner(linear, shape)
            kept.append((complex(value), shape, "rigid" if alone else "elastic"))
        elif abs(value.imag) <= tiny and value.real > tiny:
            kept.append((complex(value.real), place.astype(complex), "unstable"))
    kept.sort(key=lambda one: (one[2] != "unstable", abs(one[0].imag)))
    shape = np.array([one[1] for one in kept], dtype=complex).reshape(-1, k).T
    norms = np.sqrt(np.maximum(np.einsum("ij,ik,kj->j", shape.conj(), linear.mass, shape).real, 1e-300))
    shape = _signed(shape / norms)
    frequency = np.array([one[0].imag for one in kept])
    damped, places = eig(linear.state_matrix[first:, first:])
    moved = np.vstack([np.zeros((first, len(damped))), places[: k - first]]).astype(complex)
    if first:
        for j, value in enumerate(damped):
            if abs(value) > tiny:
                moved[:first, j] = _base_place(linear, complex(value), places[k - first : k, j])
    roots, others = _assigned(damped, moved, shape, linear.mass)
    return Eigen(frequency, tuple(one[2] for one in kept), shape, roots, others)


def _base_place(linear: Linearisation, value: complex, speed: Complex) -> Complex:
    """Return a free base's displacement by its velocity: (lambda + D) s = w."""
    first = len(speed)
    rows = value * np.eye(first) + linear.drift[:first, :first]
    # Singular where the motion is one of axes that turn alone; then any place will do.
    return np.asarray(np.linalg.lstsq(rows, speed, rcond=1e-9)[0])


def _inner(linear: Linearisation, shape: Complex) -> float:
    return float((shape.conj() @ linear.mass @ shape).real)


def _signed(shape: Array | Complex) -> Complex:
    """Return shapes whose largest component is real and positive."""
    found = np.array(shape, dtype=complex)
    for column in found.T:
        if column.size and np.abs(column).max() > 0.0:
            largest = column[int(np.argmax(np.abs(column)))]
            column *= np.abs(largest) / largest
    return found
