"""Monitor of a run: limits, time estimate, stiffness, failures of users' functions."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.interruption import FunctionInterrupted
from antenna_pin.base.readable import lasting, number, readable
from antenna_pin.base.records import PROGRAM, words_of
from antenna_pin.base.settings import RunSettings
from antenna_pin.compiled.compile_time import compiling_so_far
from antenna_pin.dynamics import System, Workspace, acting_in, kernels
from antenna_pin.dynamics.blocks import InPython
from antenna_pin.elements import Motion
from antenna_pin.errors import FunctionError, LongRunWarning, StiffRunWarning
from antenna_pin.integrate import Method, Stepper
from antenna_pin.mechanism.inertia import mass_matrix
from antenna_pin.run.simulation.constraints import CourseChecks
from antenna_pin.run.simulation.events import Event
from antenna_pin.run.simulation.function_checks import RepeatabilityCheck, failure_in, functions_in_kernels
from antenna_pin.run.simulation.steps import StepControl, StepCounts, scale_vector
from antenna_pin.trajectory import Outcome

Array = NDArray[np.float64]

# --- time estimate ------------------------------------------------------------------------------------------

_FIRST_WALL = 2.5  # [s] of wall time to the first estimate; each later one after twice the time
_LONG = 60.0  # [s] of remaining wall time that is not reported
# Trial steps, or [s] of wall time, for a reliable pace: the first steps load compiled code.
_STEPS, _PATIENCE = 100, 15.0
_OTHER = 4.0  # times longer or shorter than the last report: reported again
_ALIKE = 2.0  # ratio of estimates up to which they count as equal
# Share of the tolerance of a step beyond which round-off limits the step.
_NOISE = 0.1
_TURN = 0.05  # [rad] of turn of a joint in a step beyond which steps follow its turns
_LAST_DIGIT = float(np.finfo(float).eps)
_TRIES = 4


class TimeEstimate:
    """Remaining wall time of a run, by its pace since the last estimate.

    Estimates are made at times of the clock; the motion does not depend on them.

    Attributes:
        left: Remaining wall time as last reported, by the pace since the last estimate [s]; NaN before the
            first report.
        range: Smallest and largest remaining time, by the fastest pace so far, by that since the last
            estimate, and by the mean pace.
        step: Progress per trial step at the present pace [s].
        rejected: Share of trial steps that were rejected, likewise [-].
        relocated: Share of trial steps repeated to end at an event, likewise [-].
    """

    def __init__(self, end: float) -> None:
        """Begin without an estimate."""
        self.left, self.step = math.nan, 0.0
        self.range = math.nan, math.nan
        self._best, self._tried = 0.0, 0
        self.rejected = self.relocated = 0.0
        self._end = end
        self._told = math.nan
        self._before = self._start = 0.0
        self._began = self._next = math.nan
        self._mark = 0.0, StepCounts(0, 0, 0, 0, 0.0)

    def begin(self, t: float, counts: StepCounts) -> None:
        """Start the clock at t [s], with the counts of a run that continues."""
        self._mark, self._start = (t, counts), t
        self._began, self._next, self._tried = counts.wall, counts.wall + _FIRST_WALL, counts.tried

    def update(self, t: float, counts: StepCounts) -> bool:
        """Update the estimate at t [s], if due; return whether to report it."""
        if not counts.wall >= self._next or self._end == math.inf:
            return False
        then, way = self._mark[1], self.measure(t, counts)
        self._mark = t, counts
        self._next = self._began + 2.0 * (counts.wall - self._began)
        if then.wall == self._began:
            return False
        rests = counts.tried - self._tried >= _STEPS or counts.wall - self._began >= _PATIENCE
        left = self._left(t, way, counts.wall - then.wall)
        # By two estimates, or by the mean pace: a burst of impacts or events is soon over.
        others = self._before, self._left(t, t - self._start, counts.wall - self._began)
        sure = max(others) > _LONG
        self._best = max(self._best, way / (counts.wall - then.wall))
        known = left, others[1], self._left(t, self._best, 1.0)
        self._before = left
        whole = counts.wall + left
        if not (rests and sure and left > _LONG) or self._told / _OTHER <= whole <= self._told * _OTHER:
            return False
        self.left, self._told = left, whole
        self.range = min(known), max(known)
        return True

    def _left(self, t: float, way: float, wall: float) -> float:
        """Return the wall time left from t [s], by progress and its wall time [s]."""
        return (self._end - t) * wall / way if way > 0.0 else math.inf

    def measure(self, t: float, counts: StepCounts) -> float:
        """Measure the pace since the last estimate, at t [s]; return the progress since [s]."""
        before, then = self._mark
        tried, way = max(counts.tried - then.tried, 1), t - before
        self.step = way / tried
        self.rejected = (counts.rejected - then.rejected) / tried
        self.relocated = (counts.relocated - then.relocated) / tried
        return way

    def text(self, t: float) -> str:
        """Return the time left at t [s] as text."""
        took = lasting(self._mark[1].wall - self._began)
        if math.isinf(self.left):
            return f"at t = {t:.9g} s of {self._end:g} s, after {took}, the run makes no way at all"
        least, most = self.range
        if most <= _ALIKE * least:
            how_long = f"{lasting(self.left)} at its present pace"
        elif math.isinf(most):
            how_long = f"{lasting(least)} or more, as its pace changes"
        else:
            how_long = f"{lasting(least)} to {lasting(most)}, as its pace changes"
        return (
            f"at t = {t:.9g} s of {self._end:g} s, after {took}, the run will take another {how_long}, with "
            f"steps of {number(self.step, 2)} s"
        )


def noise_text(run: Workspace, settings: RunSettings, t: float, y: Array, step: float) -> str:
    """Return as text that accelerations are noise; empty if they are not.

    A change of time and state in their last digits may change accelerations by so much that a step of a usual
    size cannot keep its tolerance.
    """
    system = run.system
    workspace = Workspace(system, run.memory)
    workspace.program[:] = run.program
    nq, nv = workspace.model.nq, workspace.model.nv
    speeds = y[nq : nq + nv]
    scales = scale_vector(system, settings.scales)[nv : 2 * nv]
    rates = np.zeros((1 + _TRIES, nv + workspace.manifold.nx))
    workspace.derivative(t, y, rates[0])
    draw = np.random.default_rng(0)
    for row in rates[1:]:
        signs = draw.choice((-1.0, 1.0), 1 + len(y))
        workspace.derivative(t * (1.0 + signs[0] * _LAST_DIGIT), y * (1.0 + signs[1:] * _LAST_DIGIT), row)
    apart = np.abs(rates[1:, :nv] - rates[0, :nv]).max(axis=0)
    shares = step * apart / (settings.rtol * (scales + np.abs(speeds)))
    worst, fastest = int(np.argmax(shares)), int(np.argmax(np.abs(speeds)))
    if not shares[worst] > _NOISE:
        return ""
    return (
        f"no step meets its tolerance: the acceleration of {system.names_v[worst]} changes by "
        f"{number(float(apart[worst]), 2)} where time and state change by their last digits; largest is the "
        f"velocity {system.names_v[fastest]} = {number(float(speeds[fastest]), 3)}: start slower, or use "
        f"smooth laws and drives"
    )


def turning_text(run: Workspace, y: Array, step: float) -> str:
    """Return as text that steps follow a fast joint; empty if they do not."""
    nq, system = run.model.nq, run.system
    rates = {
        name: float(np.abs(y[nq : nq + run.model.nv][slot.v]).max())
        for name, slot in system.mechanism.joints.items()
        if slot.turns
    }
    fastest = max(rates, key=rates.__getitem__, default="")
    if not fastest or not rates[fastest] * step > _TURN:
        return ""
    return (
        f"joint {fastest!r} turns at {number(rates[fastest], 3)} rad/s, and steps follow its turns, "
        f"{number(2.0 * math.pi / (rates[fastest] * step), 2)} for each"
    )


# --- stiffness ----------------------------------------------------------------------------------------------

# Trial steps before the first state, and between two checks. Not wall time: the advice of a run
# would depend on the load of the machine.
_FIRST_STEPS, _WINDOW = 50, 400
_FEW = 10_000  # steps to the end that are not worth an advice
# Ratio of trial steps at a check without result and the next: if steps are not limited, and if they are,
# but by a mode that is not at rest, perhaps excited by a burst just then.
_BETWEEN, _AGAIN = 1.4, 1.1
# Step times eigenvalue: explicit methods are stable up to 2.5 to 6, and control holds steps about there.
# If the mean step is longer, the state is momentary, such as an impact.
_STABLE, _UNSTABLE = 1.5, 8.0
# Amplitude of a mode at rest, in tolerances: where stability limits steps, it stays at 0.3 to
# 25 (bursts and decays, order 5 and 8); a physical mode is of another order than the tolerance.
_AT_REST = 100.0
_DIFFERENCE = 1e-8  # of a component's scale: round-off and curvature of a difference weigh alike


class _StiffState(NamedTuple):
    """State of the run, with contact memory and program."""

    tried: int
    t: float
    y: Array
    memory: Array
    program: Array


class Stiffness:
    """Detection of runs whose explicit steps are limited by stability.

    An explicit step is stable only if it is not much longer than the fastest decay or oscillation of the
    equations, even after that has died out. Where stability limits the steps, an implicit method takes them
    as long as the motion is smooth. The advice is given to a slow run if, at two distant states, its steps
    are as long as the largest eigenvalue of the Jacobian permits, and the modes that limit them are at rest
    to the tolerance: visible decays or oscillations need such steps for themselves, and no method helps.

    Args:
        method: Method of integration; fixed steps and implicit methods are not checked.

    Attributes:
        text: Description of the stiffness; empty if none.
    """

    def __init__(self, workspace: Workspace, method: Method, settings: RunSettings, end: float) -> None:
        """Begin without a state."""
        self.text = ""
        self._run, self._end, self._method, self._settings = workspace, end, method, settings
        self._over = method.implicit or not method.adaptive
        self._mark: _StiffState | None = None
        self._next = 0

    def check(self, t: float, y: Array, tried: int) -> bool:
        """Check the present state, if due; return whether stiffness has been detected now."""
        mark = self._mark
        if self._over or tried < (_FIRST_STEPS if mark is None else mark.tried + _WINDOW):
            return False
        here = _StiffState(tried, t, y.copy(), self._run.memory.copy(), self._run.program.copy())
        self._mark = here
        if mark is None or t <= mark.t or tried < self._next:
            return False
        step = (t - mark.t) / (tried - mark.tried)
        if self._end - t < _FEW * step:
            return False
        eigenvalue, share = self._fastest(here, step)
        if not share.any() or not self._fastest(mark, step)[1].any():
            self._next = int((_AGAIN if eigenvalue else _BETWEEN) * tried)
            return False
        self._over, rate = True, abs(eigenvalue)
        self.text = (
            f"stiff: {self._what(here, share, rate)} is done within {readable(1.0 / rate, 's', 2)}, and "
            f"steps of {self._settings.method} are held to some {readable(step, 's', 2)} for it; take "
            "integrator.method = 'radau5'"
        )
        return True

    def _work(self, place: _StiffState) -> Workspace:
        workspace = Workspace(self._run.system, place.memory)
        workspace.program[:] = place.program
        return workspace

    def _fastest(self, place: _StiffState, step: float) -> tuple[complex, Array]:
        """Return the largest eigenvalue [1/s], and the velocities' shares in its mode, (nv,).

        A mode's energy of motion is shared out by v_j (M v)_j, which leaves nothing to a base that only
        reacts. The eigenvalue is zero where no mode holds steps of a size [s] by being unstable; the shares
        are zero too if the limiting modes are not at rest.
        """
        workspace = self._work(place)
        manifold, nv = workspace.manifold, workspace.model.nv
        scales = scale_vector(workspace.system, self._settings.scales)
        columns = [*range(2 * nv), *(2 * nv + int(k) for k in workspace.coupled)]
        nq, y = manifold.nq, place.y
        jacobian = np.zeros((2 * nv + manifold.nx, len(columns)))
        jacobian[:nv, nv : 2 * nv] = np.eye(nv)
        rates = np.zeros((2, nv + manifold.nx))
        workspace.derivative(place.t, y, rates[0])
        for k, column in enumerate(columns):
            size = _DIFFERENCE * scales[column]
            moved = y.copy()
            if column < nv:
                moved[:nq] = manifold.compose(y[:nq], size * np.eye(nv)[column])
            else:
                moved[nq - nv + column] += size
            workspace.derivative(place.t, moved, rates[1])
            jacobian[nv:, k] = (rates[1] - rates[0]) / size
        square = jacobian[columns]
        nothing = 0.0j, np.zeros(nv)
        if not np.isfinite(square).all():
            return nothing
        values, vectors = np.linalg.eig(square)
        largest = int(np.argmax(np.abs(values)))
        if not _STABLE <= step * abs(values[largest]) <= _UNSTABLE:
            return nothing
        # Distance of the fast modes from rest.
        flow = np.concatenate([y[nq : nq + nv], rates[0]])[columns]
        fast = np.flatnonzero(step * np.abs(values) >= _STABLE)
        amplitudes = np.linalg.lstsq(vectors, flow.astype(complex), rcond=None)[0][fast] / values[fast]
        sizes = np.concatenate([np.zeros(nv), y[nq:]])[columns]
        tolerances = self._settings.rtol * (scales[columns] + np.abs(sizes))
        apart = np.abs(vectors[:, fast] * amplitudes) / tolerances[:, None]
        if not apart.max() < _AT_REST:
            return complex(values[largest]), nothing[1]
        mode = vectors[nv : 2 * nv, largest]
        mass = mass_matrix(workspace.model, workspace.data, y[:nq])
        return complex(values[largest]), np.abs(np.real(np.conj(mode) * (mass @ mode)))

    def _what(self, place: _StiffState, share: Array, rate: float) -> str:
        """Return as text the joint that moves most in the mode, and the element there."""
        system = self._run.system
        shares = {name: float(share[slot.v].sum()) for name, slot in system.mechanism.joints.items()}
        joint = max(shares, key=shares.__getitem__, default="")
        if not joint or not shares[joint] > 0.0:
            return "a motion"
        touching = [
            name
            for name, memory in zip(system.contact_names, place.memory, strict=True)
            if memory["touching"] and name.startswith(f"{joint}.")
        ]
        acting = f"contact {', '.join(touching)}" if touching else self._steepest(place, joint, rate)
        return f"the motion of joint {joint!r}{f' under {acting}' if acting else ''}"

    def _steepest(self, place: _StiffState, joint: str, rate: float) -> str:
        """Return the label of a joint's element whose effort changes most in a mode."""
        system = self._run.system
        nq, slot = system.model.nq, system.mechanism.joint(joint)
        way = np.zeros(system.model.nv)
        way[slot.v] = _DIFFERENCE
        moved = place.y.copy()
        moved[:nq] = system.manifold.compose(place.y[:nq], way / rate)
        moved[nq : nq + len(way)] += way
        found = {
            one.label: abs(
                _effort(system, place, one.block, moved) - _effort(system, place, one.block, place.y)
            )
            for one in acting_in(system)
            if one.element.acts_at == joint and not isinstance(one.element, Motion)
        }
        most = max(found, key=found.__getitem__, default="")
        return most if most and found[most] > 0.0 else ""


def _effort(system: System, place: _StiffState, block: int, y: Array) -> float:
    """Return the effort of an element at a joint [N m] or [N]."""
    nq = int(place.program[: words_of(PROGRAM)].view(PROGRAM)["nq"][0])
    given = next((one for one in system.callables if one.block == block), None)
    if isinstance(given, InPython):
        angle, rate, _, _ = kernels.joint_motion(place.program, block, y, nq)
        return float(given.values(place.t, angle, rate)[0])
    return float(kernels.element_state(place.program, block, place.t, y, nq)[0])


# --- monitor ------------------------------------------------------------------------------------------------

# Share of rejected steps, or of steps that end at an event, beyond which they explain a slow run.
_MANY = 0.2
_WAY_OUT = "; integrator.max_wall_time ends a run in time and saves its results"


def _without_compiling(counts: StepCounts) -> StepCounts:
    return counts._replace(wall=counts.wall - compiling_so_far())


class Monitor:
    """Checks of a run between its steps; the run is not changed."""

    def __init__(self, workspace: Workspace, control: StepControl, events: Sequence[Event]) -> None:
        """Begin without a check."""
        self._workspace, self._control = workspace, control
        self._estimate = TimeEstimate(control.end)
        self._slow, self._began = "", 0.0
        self._repeatable = RepeatabilityCheck(workspace, events)
        self._courses = CourseChecks(workspace)
        self._stiffness = Stiffness(workspace, control.method, control.settings, control.end)

    @property
    def advice(self) -> str:
        """Advice to the user; empty if none."""
        return self._stiffness.text

    def text(self, outcome: Outcome) -> str:
        """Return the part of the advice for the message of an outcome."""
        why = self.advice or self._slow
        return "" if outcome is Outcome.COMPLETED or not why else f"; {why}"

    def begin(self, t: float, y: Array, counts: StepCounts) -> None:
        """Check the first state: time [s], [q, v, x], and the counts so far."""
        self._began = counts.wall
        self._estimate.begin(t, _without_compiling(counts))
        self._repeatable.check(t, y, 0)
        self._courses.check(t, counts.tried)

    def check(self, t: float, y: Array, counts: StepCounts, interrupted: bool) -> tuple[Outcome | None, str]:
        """Return the reason to end the run, None to continue, and its text."""
        limit = self._control.limit(counts.tried, t, counts.wall - self._began)
        if self._stiffness.check(t, y, counts.tried):
            warnings.warn(f"at t = {t:.9g} s the run is {self.advice}", StiffRunWarning, stacklevel=2)
        if self._estimate.update(t, _without_compiling(counts)):
            known = self._slow or self.advice
            why = self._why(t, y)
            said = "the cause was reported before" if why == known else why
            warnings.warn(f"{self._estimate.text(t)}: {said}{_WAY_OUT}", LongRunWarning, stacklevel=2)
        elif limit is Outcome.NO_PROGRESS:
            self._estimate.measure(t, _without_compiling(counts))
            self._why(t, y)
        words = self._repeatable.check(t, y, counts.evaluations)
        if words:
            return Outcome.FUNCTION_WITH_MEMORY, words
        words = self._courses.check(t, counts.tried)
        if words:
            return Outcome.REFUSED, words
        return Outcome.INTERRUPTED if interrupted else limit, ""

    @contextmanager
    def guarded(self, stop: Callable[[Outcome, str], bool]) -> Iterator[None]:
        """End the run where a user's function fails or is interrupted; its record stays whole.

        Args:
            stop: Function that ends the run, with outcome and text.
        """
        try:
            yield
        except FunctionError as error:
            stop(Outcome.FUNCTION_FAILED, f", {error.seen}")
        except FunctionInterrupted:
            stop(Outcome.INTERRUPTED, "")

    def failure_in(self, stepper: Stepper, h: float) -> FunctionError | None:
        """Return the failure of a function in kernels, in a step of size h [s]."""
        called = functions_in_kernels(self._repeatable.functions)
        return failure_in(called, self._workspace.program, stepper, h) if called else None

    def _why(self, t: float, y: Array) -> str:
        """Return the cause of a slow run as text, as far as known."""
        pace, settings = self._estimate, self._control.settings
        if not self.advice and self._control.method.adaptive:
            self._slow = noise_text(self._workspace, settings, t, y, pace.step)
            if not self._slow:
                self._slow = turning_text(self._workspace, y, pace.step)
            if not self._slow and pace.rejected > _MANY:
                self._slow = (
                    f"{100.0 * pace.rejected:.0f} % of its steps are rejected, as by a force that jumps: "
                    "friction that is not zero at rest, a drive that switches"
                )
            elif not self._slow and pace.relocated > _MANY:
                share = 100.0 * pace.relocated
                self._slow = f"{share:.0f} % of its steps end at an event or where a contact changes"
        usual = "loosen integrator.rtol" if self._control.method.adaptive else "take a longer integrator.step"
        if settings.engine == "pinocchio":
            usual += ", or take integrator.engine = 'compiled'"
        return self.advice or self._slow or usual

    def end(self, outcome: Outcome) -> tuple[Outcome | None, str]:
        """Return the reason that invalidates a finished run, None if valid, and its text."""
        if outcome in (Outcome.INTERRUPTED, Outcome.FUNCTION_WITH_MEMORY, Outcome.FUNCTION_FAILED):
            return None, ""  # a run that continues is checked later; the others are invalid already
        words = self._repeatable.end()
        return (Outcome.FUNCTION_WITH_MEMORY if words else None), words
