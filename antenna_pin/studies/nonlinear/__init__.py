"""Nonlinear dynamics: Poincaré sections, bifurcation diagrams, periodic orbits, Lyapunov exponents."""

from antenna_pin.base.lazy import exported

exported(__name__)
