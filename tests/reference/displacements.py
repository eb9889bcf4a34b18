"""Displacements by one unit of everything that rates depend on, and systems whose numbers are displaced."""

import functools

import numpy as np

from antenna_pin import build_system
from antenna_pin.nonlinear.numbers import Numbers
from antenna_pin.scenario import with_number
from antenna_pin.sensitivity.parameters import parameters_of

TIME = 0.123


def ways_of(field):
    """Return displacements by one unit of everything that rates depend on, by columns, and one of all."""
    own, every = field.parts[-2], np.eye(field.displacement)
    scale = np.concatenate([*field.units, np.ones(field.displacement - sum(map(len, field.units)))])
    scale[-1] = 1e-3
    ways = np.delete(every * scale, np.arange(field.displacement)[own], axis=1)
    return np.column_stack([ways, ways.sum(axis=1)])


def with_numbers(scenario, keys):
    """Return the system of a scenario, and how its numbers go with some keys."""
    parameters = parameters_of(scenario, keys, "test")

    def built_at(one, s):
        return build_system(with_number(scenario, one.key, one.value + s * one.scale))

    system = build_system(scenario)
    return system, Numbers(system, [functools.partial(built_at, one) for one in parameters], keys)
