"""Every law of the registries, built from example parameters: a law that is added is tested unasked."""

import itertools

import pytest

from antenna_pin.contact import FRICTION_LAWS, NORMAL_LAWS, law_parameters
from antenna_pin.errors import InvalidParameterError

# What each parameter is tried at. A new parameter of a new law needs its example here.
EXAMPLES = {
    "stiffness": (3.7e9,),
    "exponent": (1.0, 10 / 9, 1.5, 2.0, 3.0),
    "restitution": (0.3, 0.9, 1.0),
    "static": (0.15,),
    "dynamic": (0.10,),
    "static_speed": (0.1,),
    "dynamic_speed": (1.0,),
    "coefficient_of_friction": (0.2,),
    "lower_speed": (1e-4,),
    "upper_speed": (1e-3,),
    "transition_speed": (0.02,),
    # Lines and arcs: the antenna's journal in its bearing.
    "length": (0.05,),
    "journal_radius": (9.8e-3,),
    "bearing_radius": (10e-3,),
    "modulus": (1.1374e11,),
    "width_factor": (2.25676,),
    # Dissipation that is not set by a restitution.
    "slope": (0.5,),
    "damping": (2e3,),
    "effective_mass": (0.7,),
    "full_damping_depth": (1e-6,),
    # Friction, also with bristles.
    "regularisation_speed": (1e-3,),
    "stribeck_speed": (5e-3,),
    "viscous": (0.1,),
    "shape": (2.0,),
    "decay": (3.0,),
    "transition_force": (1.0,),
    "bristle_stiffness": (1e5,),
    "bristle_damping": (50.0,),
    "dwell_time": (0.1,),
    "direction_speed": (1e-3,),
}


def instances(laws):
    for name, law in laws.items():
        parameters = list(law_parameters(law))
        for values in itertools.product(*(EXAMPLES[p] for p in parameters)):
            given = dict(zip(parameters, values, strict=True))
            label = "-".join([name, *(f"{v:.3g}" for p, v in given.items() if len(EXAMPLES[p]) > 1)])
            try:
                made = law(**given)
            except InvalidParameterError:
                continue  # some laws hold for some of the examples only; test_registry wants one of each
            yield pytest.param(made, id=label)


# Laws whose elastic part is a power of the depth and whose dissipation is hysteresis damping.
POWER_LAWS = {name: NORMAL_LAWS[name] for name in ("hertz", "lankarani-nikravesh")}
# Laws of the slip speed alone that reach their coefficient and rest without force.
SPEED_LAWS = {name: FRICTION_LAWS[name] for name in ("none", "velocity-based", "ambrosio", "tanh")}


@pytest.fixture(params=instances(POWER_LAWS))
def normal_law(request):
    return request.param


@pytest.fixture(params=instances(SPEED_LAWS))
def friction_law(request):
    return request.param


@pytest.fixture(params=instances(NORMAL_LAWS))
def any_normal_law(request):
    return request.param


@pytest.fixture(params=instances(FRICTION_LAWS))
def any_friction_law(request):
    return request.param
