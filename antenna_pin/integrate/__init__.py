"""Lie-group Runge-Kutta methods: a derivative, a manifold and the group operation, nothing else."""

from antenna_pin.base.lazy import exported

exported(__name__)
