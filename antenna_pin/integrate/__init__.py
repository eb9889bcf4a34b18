"""Lie-group Runge-Kutta methods: a derivative, a manifold and the group operation, nothing else."""

from antenna_pin._lazy import only_public
from antenna_pin.integrate.collocation import NODES, Propagator
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
    "Propagator",
    "Stepper",
    "method_named",
    "newton_of",
]

only_public(__name__)
