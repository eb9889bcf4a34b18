"""Numba aimed at the baseline before any test compiles: what comes first decides for the whole process."""

import antenna_pin.compiled.jit  # noqa: F401 - by its import
