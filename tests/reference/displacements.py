"""States in which all moves and touches, displacements by one unit, systems with numbers displaced."""

import functools

import numpy as np

from antenna_pin import RunSettings, build_system
from antenna_pin.scenario import with_number
from antenna_pin.studies.nonlinear.perturbed_system import ParameterSlopes
from antenna_pin.studies.nonlinear.vector_field import VectorField
from antenna_pin.studies.sensitivity.parameters import parameters_of

TIME = 0.123


def press(field, y, joint, rng, tilt=1.0):
    """Take a journal from its middle along no axis into the wall; say what touches."""
    system, workspace = field.system, field.workspace
    own = system.mechanism.joint(joint.name).v
    first = system.contact_names.index(joint.contact_names[0])
    direction = rng.normal(size=own.stop - own.start) * field.units.position[own]
    direction[3:] *= tilt
    if hasattr(joint.geometry, "slider_length"):
        direction[0] *= 0.01  # not out of its guide, along x
    for size in np.geomspace(0.3, 300.0, 200):
        there, way = y.copy(), np.zeros(system.model.nv)
        way[own] = size * direction
        workspace.retract(there, way)
        gaps = np.array([workspace.along_normal(there, first + k)[1] for k in range(joint.contacts)])
        deep = gaps / joint.geometry.radial_clearance
        if deep.min() < -1e-2:  # differences of the whole are worth little at less
            y[:] = there
            workspace.memory["touching"][first : first + joint.contacts] = deep < -1e-3
            return
    raise AssertionError(f"{joint.name} never touches")


def anywhere(system, seed, tilt=1.0):
    """Return a field, and a state in which everything moves and all joints with play touch."""
    field, rng = VectorField(system, RunSettings(engine="compiled")), np.random.default_rng(seed)
    nq, nv, units = system.model.nq, system.model.nv, field.units
    with_play = [system.mechanism.joint(joint.name).v for joint in system.clearances]
    y, way = system.state(system.neutral(), 0.3 * rng.normal(size=nv)), 0.3 * rng.normal(size=nv)
    for own in with_play:
        way[own] = 0.0
    field.workspace.retract(y, way)
    memory = field.workspace.memory
    memory["approach_speed"], memory["effective_mass"] = 0.05, 1.3
    for joint, own in zip(system.clearances, with_play, strict=True):
        press(field, y, joint, rng, tilt)
        y[nq:][own] = 3.0 * rng.normal(size=own.stop - own.start) * units.rate[own]
    y[nq + nv + field.bristles] = 0.01 * rng.normal(size=len(field.bristles)) * units.bristle
    system.turn_on(y)
    return field, y


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
    return system, ParameterSlopes(system, [functools.partial(built_at, one) for one in parameters], keys)


def along_one(field, y, seed):
    """Yield the derivatives of accelerations, then of rates of x, along one random displacement: twice each.

    The first is put together from parts; the second is by differences, with the step at which sixth and
    fourth order agree best. Both are over the largest of the second [-].
    """
    nv, ways = field.system.model.nv, ways_of(field)[:, :-1]
    way = ways @ np.random.default_rng(seed).normal(size=ways.shape[1])
    found = field._tangents.rates(TIME, y, way[:, None], np.full(1, 1e-4))[0, :, 0]
    steps = 10.0 ** np.arange(-2.0, -6.5, -0.5)
    tried = [field._near.over(field.rates, TIME, y, way, step) for step in steps]
    for block in (slice(nv), slice(nv, None)):
        sixth, _ = min(tried, key=lambda two: np.abs(two[0][block] - two[1][block]).max(initial=0.0))
        largest = np.abs(sixth[block]).max(initial=1e-300)
        yield found[block] / largest, sixth[block] / largest
