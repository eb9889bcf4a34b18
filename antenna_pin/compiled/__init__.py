"""All that knows Numba's inside: decorators of kernels, machine code kept in files, calls by address."""
