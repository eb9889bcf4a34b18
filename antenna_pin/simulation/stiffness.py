"""Runs whose explicit steps are held short by something that has long decayed, told of early.

An explicit step is stable only if it is not much longer than the fastest decay or swing of the equations,
whether or not that has died out. Where this is what holds steps, an implicit method takes them as long as the
motion is smooth. It is told of a run that makes little way if, at two states far apart, its steps are as long
as the largest eigenvalue of the Jacobian lets them be stable, and the modes of which this is true are at rest
to the tolerance: what swings or decays visibly needs such steps for its own sake, and no method helps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.readable import readable
from antenna_pin.base.records import PROGRAM, words_of
from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import System, Workspace, acting_in, kernels
from antenna_pin.dynamics.blocks import InPython
from antenna_pin.elements import Motion
from antenna_pin.integrate import Method
from antenna_pin.simulation.scales import scale_vector

__all__ = ["Stiffness"]

Array = NDArray[np.float64]

# Trial steps before the first state, and from one look to the next. Not wall time: what a run says
# would hang on what else the machine does.
_FIRST, _WINDOW = 50, 400
_FEW = 10_000  # steps to the end that are not worth an advice
# From a look that finds nothing to the next, in trial steps made: if steps are not held, and if they are, but
# by a mode that is not at rest, which a burst may have stirred just then.
_BETWEEN, _AGAIN = 1.4, 1.1
# Step times eigenvalue: explicit methods are stable up to 2.5 to 6, and control holds steps about there.
# Where the mean step is longer than that, the state is one of a moment, such as a blow.
_STABLE, _UNSTABLE = 1.5, 8.0
# Amplitude of a mode, in tolerances, that nobody sees: where stability holds steps, it is kept at 0.3 to
# 25 (bursts and decays, order 5 and 8); one that is really there is of another order than the tolerance.
_AT_REST = 100.0
_DIFFERENCE = 1e-8  # of a component's scale: round-off and curvature of a difference weigh alike


class _Place(NamedTuple):
    """A state of the run, and what its equations depend on besides."""

    made: int
    t: float
    y: Array
    memory: Array
    program: Array


class Stiffness:
    """Looks whether a run is held up by stiffness.

    Args:
        workspace: What the run works on.
        method: Of its integration; nothing is looked for with one of fixed steps, or an implicit one.
        settings: Of the run.
        end: Of the run [s].

    Attributes:
        words: What was found; empty if nothing.
    """

    def __init__(self, workspace: Workspace, method: Method, settings: RunSettings, end: float) -> None:
        """Begin without a look."""
        self.words = ""
        self._run, self._end, self._method, self._settings = workspace, end, method, settings
        self._over = method.implicit or not method.adaptive
        self._mark: _Place | None = None
        self._next = 0

    def look(self, t: float, y: Array, made: int) -> bool:
        """Look at the state that the run has come to, if it is time to; return whether anything is found now.

        Args:
            t: Time [s].
            y: State [q, v, x].
            made: Trial steps made so far.
        """
        mark = self._mark
        if self._over or made < (_FIRST if mark is None else mark.made + _WINDOW):
            return False
        here = _Place(made, t, y.copy(), self._run.memory.copy(), self._run.program.copy())
        self._mark = here
        if mark is None or t <= mark.t or made < self._next:
            return False
        step = (t - mark.t) / (made - mark.made)
        if self._end - t < _FEW * step:
            return False
        eigenvalue, share = self._fastest(here, step)
        if not share.any() or not self._fastest(mark, step)[1].any():
            self._next = int((_AGAIN if eigenvalue else _BETWEEN) * made)
            return False
        self._over, rate = True, abs(eigenvalue)
        self.words = (
            f"stiff: {self._what(here, share, rate)} is done within {readable(1.0 / rate, 's', 2)}, and "
            f"steps of {self._settings.method} are held to some {readable(step, 's', 2)} for it; take "
            "integrator.method = 'radau5'"
        )
        return True

    def _work(self, place: _Place) -> Workspace:
        workspace = Workspace(self._run.system, place.memory)
        workspace.program[:] = place.program
        return workspace

    def _fastest(self, place: _Place, step: float) -> tuple[complex, Array]:
        """Return the largest eigenvalue of the Jacobian [1/s], and the velocities' shares in its mode, (nv,).

        A mode's energy of motion is shared out by v_j (M v)_j, which leaves nothing to a base that only
        reacts. The eigenvalue is zero where no mode holds steps of a size [s] by being unstable; the shares
        are where those that do are not at rest.
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
        # How far the fast modes are from where they come to rest.
        flow = np.concatenate([y[nq : nq + nv], rates[0]])[columns]
        fast = np.flatnonzero(step * np.abs(values) >= _STABLE)
        amplitudes = np.linalg.lstsq(vectors, flow.astype(complex), rcond=None)[0][fast] / values[fast]
        sizes = np.concatenate([np.zeros(nv), y[nq:]])[columns]
        tolerances = self._settings.rtol * (scales[columns] + np.abs(sizes))
        apart = np.abs(vectors[:, fast] * amplitudes) / tolerances[:, None]
        if not apart.max() < _AT_REST:
            return complex(values[largest]), nothing[1]
        mode = vectors[nv : 2 * nv, largest]
        mass = np.array(pin.crba(workspace.model, workspace.data, y[:nq]))
        mass = np.triu(mass) + np.triu(mass, 1).T
        return complex(values[largest]), np.abs(np.real(np.conj(mode) * (mass @ mode)))

    def _what(self, place: _Place, share: Array, rate: float) -> str:
        """Return in words what is stiff: the joint that moves most in the mode, and what acts there."""
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

    def _steepest(self, place: _Place, joint: str, rate: float) -> str:
        """Return in words the element at a joint whose effort changes most in a mode of a rate [1/s]."""
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


def _effort(system: System, place: _Place, block: int, y: Array) -> float:
    """Return the effort of an element of a system at a joint [N m] or [N]."""
    nq = int(place.program[: words_of(PROGRAM)].view(PROGRAM)["nq"][0])
    given = next((one for one in system.callables if one.block == block), None)
    if isinstance(given, InPython):
        angle, rate, _, _ = kernels.joint_motion(place.program, block, y, nq)
        return float(given.given(place.t, angle, rate)[0])
    return float(kernels.element_state(place.program, block, place.t, y, nq)[0])
