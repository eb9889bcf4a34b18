"""Lie-group Runge-Kutta methods: a derivative, a manifold and the group operation, nothing else."""

from antenna_pin.integrate.manifold import Manifold
from antenna_pin.integrate.methods import METHODS, Method, method_named
from antenna_pin.integrate.stepper import Problem, Stepper

__all__ = ["METHODS", "Manifold", "Method", "Problem", "Stepper", "method_named"]
