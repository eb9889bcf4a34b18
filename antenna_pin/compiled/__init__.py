"""Numba's internals: decorators of kernels, stored machine code, calls by address."""
