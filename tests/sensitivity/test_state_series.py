"""What a result says of neighbours' states: displaced in place it is what systems that are built say."""

import dataclasses
import functools
import math
import re

import numpy as np
import pytest

from antenna_pin import RunSettings, System, build_mechanism, build_system, load_scenario
from antenna_pin.base.changes import JointChange, LinkChange
from antenna_pin.dynamics.constraints import CLOSURES, Closure
from antenna_pin.elements import CallableDrive, CallableForce, Motor
from antenna_pin.joints.geometry import CylindricalClearance
from antenna_pin.run.simulation.loop import Run
from antenna_pin.scenario.assemble import initial_state
from antenna_pin.studies.nonlinear.chart import StatePerturbation
from antenna_pin.studies.nonlinear.perturbed_system import ParameterSlopes, PerturbedParameters
from antenna_pin.studies.sensitivity.state_series import StateSeries
from antenna_pin.studies.sensitivity.tangent_run import PerturbedSamples
from antenna_pin.trajectory.schema import VARIABLES
from tests.reference import every_kind

WAYS = ("elements", "joints", "bodies", "axes")
PLAY = {"contact": "impact_pair", "planar": "impact_pair", "spherical": "impact_pair", "rest": "slider"}


def given(t, angle, rate):
    """Drive a joint."""
    return math.cos(t) - angle - rate


def wind(t, pose, twist):
    """Drag a link."""
    return np.array([*(-0.3 * twist[:3]), math.cos(t), 0.0, 0.0])


def scaled(one, s):
    """Return what has numbers with all of them larger by one part, but for what 1 is a bound of."""
    more = {
        field.name: value * (1.0 + 0.3 * s)
        for field in dataclasses.fields(one)
        if field.init and isinstance(value := getattr(one, field.name), float) and value != 1.0
    }
    return dataclasses.replace(one, **more)


def with_elements(system, s):
    """Return the system with other numbers of elements."""
    families = {
        table: {name: scaled(one, s) for name, one in elements.items()}
        for table, elements in system.families.items()
    }
    drives, springs = families.pop("drives"), families.pop("springs")
    return remade(system, drives=drives, springs=springs, elements=families)


def with_joints(system, s):
    """Return the system with other joints with play, closures and couplings."""
    clearances = [
        dataclasses.replace(
            one,
            geometry=scaled(one.geometry, 0.01 * s),
            radial=scaled(one.radial, s),
            axial=None if one.axial is None else scaled(one.axial, s),
            offset=one.offset + 1e-3 * s,
        )
        for one in system.clearances
    ]
    closures = {
        name: Closure(
            kind=one.kind,
            first=dataclasses.replace(one.first, origin=one.first.origin + [0.1 * s, 0.0, 0.2 * s]),
            second=one.second,
        )
        for name, one in system.closures.items()
    }
    couplings = {name: scaled(one, s) for name, one in system.couplings.items()}
    return remade(system, clearances=clearances, closures=closures, couplings=couplings)


def with_bodies(system, s):
    """Return the system with other masses, places of joints and gravity."""
    urdf, mechanism = system.mechanism.urdf, system.mechanism
    links = {
        name: LinkChange(mass=1.0 + 0.3 * s, centre_of_mass=(0.1 + 0.02 * s, 0.05, 0.01 * s))
        for name in mechanism.bodies
        if name.endswith("_link")
    }
    joints = [name for name in mechanism.joints if f"{name}_link" in mechanism.bodies]
    origins = {name: JointChange(origin_xyz=(0.3 + 0.1 * s, 0.02 * s, 0.0)) for name in joints}
    gravity = (1.0 + 0.5 * s) * system.model.gravity.linear
    return remade(
        system, build_mechanism(urdf.variant(links=links, origins=origins), mechanism.base, gravity)
    )


def with_axes(system, s):
    """Return the system with the axes of its hinges tilted."""
    urdf, mechanism, gravity = system.mechanism.urdf, system.mechanism, system.model.gravity.linear
    origins = {
        name: JointChange(axis=(0.2 * s, 0.1 * s, 1.0))
        for name, one in mechanism.joints.items()
        if f"{name}_link" in mechanism.bodies
    }
    return remade(system, build_mechanism(urdf.variant(origins=origins), mechanism.base, gravity))


def remade(system, mechanism=None, **more):
    """Return the system made anew with some of its parts others."""
    parts = {
        "clearances": system.clearances,
        "drives": system.drives,
        "springs": system.springs,
        "closures": system.closures,
        "couplings": system.couplings,
        "elements": {
            table: own for table, own in system.families.items() if table not in ("drives", "springs")
        },
    }
    return System(mechanism or system.mechanism, **{**parts, **more})


def gone(system, engine, start=None):
    """Return a few states of a run of a system, the first included."""
    y = every_kind.started(system) if start is None else start
    settings = RunSettings(engine=engine, rtol=1e-6, output_rate=2000.0)
    run = Run(system, system.state(*y), 1e-3, settings)
    run.advance()
    return run.samples.chunk, run.state, settings


def moved(system, numbers, chunk):
    """Return the states with displacements of no meaning, of which neighbours' are made."""
    rng, n, count = np.random.default_rng(1), len(chunk.times), numbers.count
    size = StatePerturbation(system, count).parts[-1].stop
    ways = 1e-4 * rng.normal(size=(n, size, count))
    books = 1e-3 * rng.normal(size=(n, system.manifold.nx, count))
    words = np.broadcast_to(numbers.slopes["program"], (n, *numbers.slopes["program"].shape))
    return PerturbedSamples(chunk, ways, books, np.zeros((n, count)), words)


def by_both(system, builds, engine, start=None):
    """Return the derivatives of the series of a few states in place and of systems that are built."""
    chunk, first, settings = gone(system, engine, start)
    numbers = ParameterSlopes(system, builds, WAYS[: len(builds)])
    displaced = moved(system, numbers, chunk)
    found = []
    for build in (False, True):
        beside = PerturbedParameters(system, settings, numbers, lambda k, s: builds[k](s))
        built = beside.builds.copy()
        if build:
            beside.builds[:], beside.by_program[:] = True, False
        told = StateSeries(
            beside, StatePerturbation(system, numbers.count), settings, first, np.ones(numbers.count)
        )
        found.append(told.series(displaced))
        here = told.series_at(chunk)
    return (*found, here, built)


def systems():
    """Yield name, system, engine and, if it is a scenario's, where it starts."""
    motor = {"torque_constant": 0.5, "resistance": 2.0, "cogging": 0.02, "cycles": 6, "cogging_phase": 0.4}
    at_once = Motor(joint="g", value=2.0, ratio=3.0, **motor)  # whose current follows at once
    drives = {**every_kind.DRIVES, "at once": at_once}
    yield "elements", every_kind.elements(drives, every_kind.FORCES), "compiled", None
    yield "modes", every_kind.with_modes(), "compiled", None
    yield "shaken", every_kind.shaken(), "compiled", None
    drag = CallableForce(at=("e_link", (0.0, 0.0, 0.0)), wrench=wind)
    python = every_kind.elements({"given": CallableDrive(joint="a", torque=given)}, {"wind": drag})
    yield "in Python", python, "pinocchio", None
    for kind in CLOSURES:
        yield f"{kind} closure", every_kind.closed(kind), "compiled", None
    for case, model in PLAY.items():
        scenario = load_scenario(model, case=case)
        geometry = {f"clearance.{joint}.geometry": "closed-form" for joint in scenario.clearance}
        scenario = scenario.with_overrides(geometry)
        system = build_system(scenario)
        yield case, system, "compiled", initial_state(scenario, system)
        if case == "rest":
            shape = CylindricalClearance(
                bearing_radius=0.02, journal_radius=0.02 - 5e-5, slider_length=0.1, guide_length=0.05
            )
            round_one = dataclasses.replace(system.clearances[0], geometry=shape)
            yield "round", remade(system, clearances=[round_one]), "compiled", initial_state(scenario, system)


SYSTEMS = {name: one for name, *one in systems()}


@pytest.mark.parametrize("name", SYSTEMS)
def test_in_place_says_what_is_built(name):
    """All series over numbers of elements, joints, bodies and axes, beside doubts.

    To 1e-9 of the largest number of their unit, from which round-off comes.
    """
    system, engine, start = SYSTEMS[name]
    changes = (with_elements, with_joints, with_bodies, with_axes)[: 4 if start is None else 2]
    builds = [functools.partial(change, system) for change in changes]
    in_place, of_builds, here, built = by_both(system, builds, engine, start)
    axes = [False] * 3 + [True] if start is None else [False] * 2
    assert built.tolist() == ([True] * len(builds) if name == "in Python" else axes)
    units = {key: set(re.split(", | or ", VARIABLES[key].units)) for key in in_place}
    rows = {key: np.abs(other).reshape(-1, len(builds)) for key, (other, _) in of_builds.items()}
    sizes = {
        key: np.fmax(rows[key].max(axis=0, initial=0.0), np.abs(here[key]).max(initial=0.0)) for key in rows
    }
    for key, (value, doubt) in in_place.items():
        other, rest = of_builds[key]
        size = np.max([sizes[one] for one in units if units[one] & units[key]], axis=0)
        assert (np.abs(value - other) - doubt - rest <= 1e-9 * size).all(), key
    assert (np.sum([one.sum(axis=0) for one in rows.values()], axis=0) > 0.0).all()
