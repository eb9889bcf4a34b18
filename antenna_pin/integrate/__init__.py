"""Lie-group Runge-Kutta methods: a derivative, a manifold and the group operation, nothing else."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.integrate.collocation import NODES, Propagated, Propagator
    from antenna_pin.integrate.implicit import newton_of
    from antenna_pin.integrate.manifold import KINDS, Manifold
    from antenna_pin.integrate.methods import METHODS, Method, method_named
    from antenna_pin.integrate.stepper import Problem, Stepper

__all__ = [
    "KINDS",
    "METHODS",
    "NODES",
    "Manifold",
    "Method",
    "Problem",
    "Propagated",
    "Propagator",
    "Stepper",
    "method_named",
    "newton_of",
]

loaded_when_used(
    __name__,
    {
        "collocation": "NODES Propagated Propagator",
        "implicit": "newton_of",
        "manifold": "KINDS Manifold",
        "methods": "METHODS Method method_named",
        "stepper": "Problem Stepper",
    },
)
