"""Step of a Runge-Kutta method on a manifold: trial, error, acceptance or rejection without trace."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.records import CIRCLE, PLANE, RIGID, ROTATION, VECTOR
from antenna_pin.errors import InvalidParameterError
from antenna_pin.integrate import explicit_kernels as explicit
from antenna_pin.integrate import kernels, manifold_kernels
from antenna_pin.integrate import radau_kernels as radau
from antenna_pin.integrate.methods import Method, newton_of

# --- state space --------------------------------------------------------------------------------------------

Array = NDArray[np.float64]

#: Configuration spaces of joints: kind -> (code, numbers in q, numbers in v).
KINDS = {
    "vector": (VECTOR, 1, 1),
    "circle": (CIRCLE, 2, 1),
    "plane": (PLANE, 4, 3),
    "rotation": (ROTATION, 4, 3),
    "rigid": (RIGID, 7, 6),
}


def _laid_out(nq: int, nv: int, nx: int, factors: NDArray[Any]) -> NDArray[np.int64]:
    """Return a space as flat numbers."""
    head = np.array([(nq, nv, nx, len(factors))], dtype=manifold_kernels.SPACE)
    return np.concatenate([head.view(np.int64), factors.view(np.int64)])


@dataclass(frozen=True, slots=True, eq=False)
class Manifold:
    """A product of configuration spaces, in order, and ``nx`` plain numbers behind.

    Kinds: ``vector`` (one number), ``circle`` (cos, sin), ``plane`` (x, y, cos, sin), ``rotation``
    (quaternion xyzw), ``rigid`` (position, quaternion). Velocities are in body axes: Pinocchio's conventions.

    Attributes:
        kinds: Kind of each factor.
        nx: How many plain numbers follow q and v in a state.
        nq: Numbers in a configuration.
        nv: Numbers in a velocity.
        size: Numbers in a state [q, v, x].
        layout: The space as the kernels take it: ``SPACE``, and a ``FACTOR`` for each joint.
    """

    kinds: tuple[str, ...]
    nx: int = 0
    nq: int = field(init=False, repr=False)
    nv: int = field(init=False, repr=False)
    size: int = field(init=False, repr=False)
    layout: NDArray[np.int64] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Lay the factors out."""
        factors, i, j = [], 0, 0
        for kind in self.kinds:
            if kind not in KINDS:
                raise InvalidParameterError("Manifold", "kinds", f"of {sorted(KINDS)}", kind)
            code, nq, nv = KINDS[kind]
            factors.append((code, i, j, nv))
            i += nq
            j += nv
        layout = _laid_out(i, j, self.nx, np.array(factors, dtype=manifold_kernels.FACTOR))
        for name, value in (("nq", i), ("nv", j), ("size", i + j + self.nx), ("layout", layout)):
            object.__setattr__(self, name, value)

    def part(self, factors: Sequence[int]) -> NDArray[np.int64]:
        """Return the layout of some factors only, without the plain numbers."""
        every = self.layout[manifold_kernels.SPACE_WORDS :].view(manifold_kernels.FACTOR)
        return _laid_out(self.nq, self.nv, 0, every[list(factors)])

    def compose(self, q: ArrayLike, u: ArrayLike) -> Array:
        """Return q o exp(u): the configuration reached from q by the chart coordinates u, (nq,).

        Args:
            q: Configuration, (nq,).
            u: Chart coordinates, (nv,): position [m] in the axes of the parent, rotation vector [rad] in body
                axes.
        """
        rows = np.zeros((3, self.size))
        rows[0, : self.nq], rows[1, : self.nv] = q, u
        manifold_kernels.retract(self.layout, rows, 0, rows, 1, rows, 2)
        return rows[2, : self.nq].copy()

    def chart_rate(self, q: ArrayLike, u: ArrayLike, v: ArrayLike) -> Array:
        """Return the rate of u for velocity v at q o exp(u), (nv,)."""
        rows = np.zeros((3, self.size))
        rows[0, : self.nq], rows[0, self.nq : self.nq + self.nv] = self.compose(q, u), v
        rows[1, : self.nv] = u
        manifold_kernels.chart_rate(self.layout, rows, 1, rows, 0, rows, 2)
        return rows[2, : self.nv].copy()

    def bracket(self, v: ArrayLike, ways: ArrayLike) -> Array:
        """Return the bracket [v, w] with tangent vectors w, (nv, k).

        Neighbours q o exp(w) of a motion q' = q v move by w' = dv - [v, w] beside it, dv the difference of
        velocities.

        Args:
            v: Velocity, (nv,).
            ways: In the coordinates of velocities, by columns, (nv, k).
        """
        velocity, columns = np.array(v, dtype=float), np.array(ways, dtype=float).T.copy()
        out = np.zeros_like(columns)
        for way, found in zip(columns, out, strict=True):
            manifold_kernels.write_bracket(self.layout, velocity, way, found)
        return np.asarray(out.T)


# --- steps --------------------------------------------------------------------------------------------------


class InitialValueProblem(Protocol):
    """Protocol of the integrated system: a manifold and the derivative on it."""

    @property
    def manifold(self) -> Manifold:
        """The state space."""

    def derivative(self, t: float, y: Array, rates: Array) -> None:
        """Write [acceleration (nv), rate of x (nx)] at t [s] and y into rates."""


def tableau_of(method: Method) -> explicit.Tableau:
    """Return a method in numbers."""
    return explicit.Tableau(
        nodes=method.nodes,
        weights=method.weights,
        errors=method.errors,
        polynomials=method.polynomials,
        last=method.last,
        adaptive=int(method.adaptive),
        course=np.zeros(1, explicit.COURSE),
    )


class Stepper:
    """A state, and trial steps from it.

    ``attempt`` computes a trial step into ``y``; ``accept`` makes it the state; without ``accept`` the state
    and its derivative stay what they were, however many trials were made (the first stage is kept apart).

    Steps of an implicit method are as long as the solution is smooth, whatever decays. Its Jacobian, by
    differences, is that of the step's start. A problem may name the plain numbers that its derivative depends
    on as ``coupled``, places in x; else it is taken to depend on all.

    Args:
        problem: The differential equation.
        method: The method.
        scales: Absolute size of one unit of tolerance per component of [u, v, x], (2 nv + nx,): the error
            of a step counts against rtol (scale + ``|value|``); an infinite scale leaves a component out.
        rtol: Relative tolerance [-].
    """

    def __init__(self, problem: InitialValueProblem, method: Method, scales: Array, rtol: float) -> None:
        """Allocate the work space once."""
        self.problem = problem
        self.method = method
        self.manifold = problem.manifold
        self.scales = np.ascontiguousarray(scales, dtype=float)
        self.rtol = rtol
        size, nv, nx = self.manifold.size, self.manifold.nv, self.manifold.nx
        stages = method.stages
        self.work = np.zeros((stages + kernels.EXTRA_ROWS, size))
        self.y = self.work[stages + kernels.STATE]
        self._rates = self.work[stages + kernels.RATES, : nv + nx]
        self.start_row = stages + kernels.START
        self.start = self.work[self.start_row]
        self.dense = np.zeros((method.polynomials.shape[1], size))
        #: Room for a state of the dense output, and for a step's end while that is made, (2, size).
        self.out, self.kept = np.zeros((2, size)), np.zeros((2, size))
        #: The method in numbers; of an implicit one also what solves its equations.
        self.tableau = tableau_of(method)
        self.newton: Any = None
        if method.implicit:
            coupled: Any = getattr(problem, "coupled", range(nx))
            columns = np.array([*range(2 * nv), *(2 * nv + k for k in sorted(coupled))], dtype=np.int64)
            self.newton = newton_of(method, 2 * nv + nx, columns)
        self.t = 0.0
        self.h = 0.0
        self.evaluations = 0
        self.has_dense = False

    def _derive(self, t: float) -> None:
        """Evaluate the derivative of the state in ``y``."""
        self.problem.derivative(t, self.y, self._rates)

    def _begin(self) -> None:
        """Make the state in ``y``, which was evaluated, the start."""
        self.has_dense = False
        kernels.begin(self.method.stages, self.manifold.layout, self.work)
        if self.newton is not None:
            self.newton.progress["fresh"] = 0

    def restart(self, t: float, y: Array) -> None:
        """Make (t, y) the state and evaluate its derivative."""
        self.t = t
        self.y[:] = y
        self._derive(t)
        self.evaluations += 1
        self._begin()

    def refresh(self) -> None:
        """Evaluate the derivative at the present state again, after the problem itself has changed."""
        self.restart(self.t, self.start)

    def rates(self, t: float, y: Array) -> Array:
        """Return [acceleration (nv), rate of x (nx)] of any state, losing the trial step."""
        self.y[:] = y
        self._derive(t)
        self.has_dense = False
        return self._rates.copy()

    def attempt(self, h: float) -> float:
        """Try a step [s]; return its scaled error, 0 if fixed, 10 if unsolved."""
        self.h, self.has_dense = h, False
        layout, work, scales, rtol = self.manifold.layout, self.work, self.scales, self.rtol
        newton, stages, tableau = self.newton, self.method.stages, self.tableau

        def go_on() -> int:
            if newton is None:
                return int(explicit.go_on(self.t, h, tableau, layout, work))
            return int(radau.go_on(self.t, h, stages, layout, work, scales, rtol, newton))

        if newton is None:
            explicit.set_out(tableau)
        else:
            newton.progress["phase"] = radau.BEGIN
        course = tableau.course[0] if newton is None else newton.progress[0]
        while (asked := go_on()) == explicit.ASK:
            self._derive(float(course.t))
            self.evaluations += 1
        if asked == explicit.FAILED:
            return radau.NOT_SOLVED
        self._derive(self.t + h)
        self.evaluations += 1
        if newton is None:
            return float(explicit.error_of(h, tableau, layout, work, scales, rtol))
        return float(newton.progress[0].error)

    def prepare_dense(self) -> None:
        """Compute the dense output of the last trial step, with its additional stages."""
        if self.has_dense:
            return
        tableau, layout, work = self.tableau, self.manifold.layout, self.work
        explicit.set_out_dense(tableau, layout, work, self.kept)
        while (
            explicit.go_on_dense(self.t, self.h, tableau, layout, work, self.dense, self.kept) == explicit.ASK
        ):
            self._derive(float(tableau.course[0].t))
            self.evaluations += 1
        self.has_dense = True

    def interpolate(self, theta: float, out: Array) -> None:
        """Write the state at fraction theta of the last trial step into out."""
        kernels.dense_state(theta, self.manifold.layout, self.dense, self.work, self.start_row, self.out)
        out[:] = self.out[0]

    def accept(self) -> None:
        """Make the trial step the state."""
        self.t += self.h
        self._begin()
