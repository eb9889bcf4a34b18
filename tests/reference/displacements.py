"""Displacements by one unit of everything that rates depend on."""

import numpy as np

TIME = 0.123


def ways_of(field):
    """Return displacements by one unit of everything that rates depend on, by columns, and one of all."""
    own, every = field.parts[-2], np.eye(field.displacement)
    scale = np.concatenate([*field.units, np.ones(field.displacement - sum(map(len, field.units)))])
    scale[-1] = 1e-3
    ways = np.delete(every * scale, np.arange(field.displacement)[own], axis=1)
    return np.column_stack([ways, ways.sum(axis=1)])
