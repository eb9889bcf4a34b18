"""A system whose derivative is compiled as a whole, the tree's dynamics included."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import System, Workspace
from antenna_pin.engine.step_kernels import Numbers, Tableau, attempt, derivative, prepare_dense
from antenna_pin.errors import MechanismError
from antenna_pin.integrate import Method, Stepper
from antenna_pin.mechanism import PLACE, TreeDynamics
from antenna_pin.records import POSE

__all__ = ["Compiled", "CompiledStepper", "check_compiled"]

Array = NDArray[np.float64]


def check_compiled(system: System) -> None:
    """Refuse a system that the compiled engine cannot take; say why, and the way out.

    Raises:
        MechanismError: Of what happens in Python.
    """
    way_out = "or take integrator.engine = 'pinocchio'"
    for joint in system.clearances:
        if not joint.compiled:
            raise MechanismError(
                f"engine 'compiled': joint {joint.name!r} has a law in Python; compile its functions with "
                f"numba.njit, {way_out}"
            )
        if joint.backend != "closed-form":
            backend = joint.backend if isinstance(joint.backend, str) else type(joint.backend).__name__
            raise MechanismError(
                f"engine 'compiled': joint {joint.name!r} has its gaps measured by {backend}, which is not "
                f"compiled; set its geometry to 'closed-form', {way_out}"
            )
    for at in (one.element.joint for one in system.callables):
        raise MechanismError(
            f"engine 'compiled': what acts at joint {at!r} is a function in Python; compile it "
            f"with numba.njit, {way_out}"
        )


class Compiled:
    """A workspace's system in numbers, for the compiled steps of one run.

    Args:
        workspace: What the run works on; its contact memory, program and contact table are used.

    Raises:
        MechanismError: The system is not one that can be compiled (:func:`check_compiled`), or its tree in
            numbers deviates from Pinocchio's.
    """

    def __init__(self, workspace: Workspace) -> None:
        """Compare the tree with Pinocchio's and lay the numbers out."""
        system = workspace.system
        check_compiled(system)
        dynamics, plan = TreeDynamics(system.mechanism), system.plan
        self.numbers = Numbers(
            program=workspace.program,
            work=workspace.work,
            tree=dynamics.tree,
            gravity=dynamics.gravity,
            room=dynamics.room(),
            places=np.zeros(len(dynamics.tree) + 1, PLACE),
            plan=np.zeros(0) if plan is None else plan.words,
            held=np.zeros(0 if plan is None else plan.size),
            mass=np.zeros((dynamics.nv, dynamics.nv)),
            bias=np.zeros(dynamics.nv),
            step=np.zeros(dynamics.nv),
            pose=np.zeros(1, POSE),
            table=np.zeros_like(workspace.table),
            own=workspace.table,
            memory=workspace.memory,
            rates=np.zeros((2, dynamics.nv + system.manifold.nx)),
            force=np.zeros(dynamics.nv),
            moved=np.zeros(system.manifold.size),
            flag=np.zeros(1, dtype=np.int64),
            booked=-1 if plan is None else dynamics.nq + dynamics.nv + int(system.projection_x[0]),
        )


class CompiledStepper(Stepper):
    """A stepper each of whose steps is one call of compiled code.

    Args:
        workspace: What the run works on.
        compiled: Its system in numbers.
        method: The method.
        scales: As for :class:`antenna_pin.integrate.Stepper`.
        rtol: Likewise.
    """

    def __init__(
        self, workspace: Workspace, compiled: Compiled, method: Method, scales: Array, rtol: float
    ) -> None:
        """Allocate the work space once."""
        super().__init__(workspace, method, scales, rtol)
        self.numbers = compiled.numbers
        self.tableau = Tableau(
            nodes=method.nodes,
            weights=method.weights,
            errors=method.errors,
            polynomials=method.polynomials,
            last=method.last,
            adaptive=int(method.adaptive),
        )
        #: Room for a step's end while its dense output is made.
        self.kept = np.zeros((2, self.manifold.size))
        y, rates, numbers = self.y, self._rates, self.numbers
        self._derivative = lambda t: derivative(t, y, numbers, rates, False)

    def attempt(self, h: float) -> float:
        """Try a step of size h [s]; return its scaled error."""
        error = attempt(
            self.t,
            h,
            self.tableau,
            self.manifold.layout,
            self.work,
            self.scales,
            self.rtol,
            self.numbers,
        )
        self.evaluations += self.method.last
        self.h = h
        self.has_dense = False
        return float(error)

    def prepare_dense(self) -> None:
        """Compute the dense output of the last trial step."""
        if self.has_dense:
            return
        self.evaluations += prepare_dense(
            self.t,
            self.h,
            self.tableau,
            self.manifold.layout,
            self.work,
            self.dense,
            self.kept,
            self.numbers,
        )
        self.has_dense = True
