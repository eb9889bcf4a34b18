"""Every law of the registries, built from example parameters: a law that is added is tested unasked."""

import itertools

import pytest

from antenna_pin.contact import (
    DISSIPATIONS,
    FRICTION_LAWS,
    NORMAL_LAWS,
    DampedContact,
    Hertz,
    Johnson,
    LiuFoundation,
    is_elastic,
    law_parameters,
)

# What each parameter is tried at. A new parameter of a new law needs its example here.
EXAMPLES = {
    "stiffness": (3.7e9,),
    "exponent": (1.0, 1.5),
    "restitution": (0.3, 0.9),
    "slope": (0.5,),
    "damping": (300.0,),
    "effective_mass": (0.7,),
    "full_damping_depth": (2e-6,),
    "length": (0.025,),
    "journal_radius": (0.0098,),
    "bearing_radius": (0.01,),
    "modulus": (1.1374e11,),
    "width_factor": (1.6, 2.2568),
    "static": (0.15,),
    "dynamic": (0.10,),
    "static_speed": (0.1,),
    "dynamic_speed": (1.0,),
    "stribeck_speed": (0.05,),
    "coefficient_of_friction": (0.2,),
    "lower_speed": (1e-4,),
    "upper_speed": (1e-3,),
    "transition_speed": (0.02,),
    "regularisation_speed": (1e-3,),
    "decay": (2.0,),
    "viscous": (0.0, 0.03),
    "transition_force": (40.0,),
    "bristle_stiffness": (1e5,),
    "bristle_damping": (30.0,),
    "dwell_time": (0.2,),
    "direction_speed": (0.0,),
    "shape": (1.0, 2.0),
}

DIMENSIONS = {"length": 0.025, "journal_radius": 0.0098, "bearing_radius": 0.01, "modulus": 1.1374e11}


def instances(laws, wanted=lambda law: True):
    for name, law in laws.items():
        parameters = list(law_parameters(law))
        for values in itertools.product(*(EXAMPLES[p] for p in parameters)):
            given = dict(zip(parameters, values, strict=True))
            label = "-".join([name, *(f"{v:.3g}" for p, v in given.items() if len(EXAMPLES[p]) > 1)])
            made = law(**given)
            if wanted(made):
                yield pytest.param(made, id=label)


ELASTIC = {name: law for name, law in NORMAL_LAWS.items() if is_elastic(name)}


def combinations():
    """Every dissipation beside a point law, a logarithmic one and a conformal one."""
    for elastic in (Hertz(stiffness=3.7e9), Johnson(**DIMENSIONS), LiuFoundation(**DIMENSIONS)):
        for parameter in instances(DISSIPATIONS):
            law = DampedContact(elastic=elastic, dissipation=parameter.values[0])
            yield pytest.param(law, id=f"{type(elastic).__name__}-{parameter.id}")


def made(parameters):
    """Laws of parameters: where a law costs less than its test, one test is of all."""
    return [parameter.values[0] for parameter in parameters]


@pytest.fixture(scope="session")
def normal_laws():
    return made([*instances(NORMAL_LAWS), *combinations()])


@pytest.fixture(params=instances(ELASTIC))
def elastic_law(request):
    return request.param


@pytest.fixture(scope="session")
def dissipations():
    return made(instances(DISSIPATIONS))


@pytest.fixture(scope="session")
def restitution_laws():
    """Laws of the form f(depth) (1 + chi rate / approach speed)."""
    return made(instances(NORMAL_LAWS, lambda law: hasattr(law, "hysteresis")))


@pytest.fixture(scope="session")
def power_laws(restitution_laws):
    """Those of them whose f(depth) is K depth^n."""
    return [law for law in restitution_laws if hasattr(law, "stiffness")]


@pytest.fixture(params=instances(FRICTION_LAWS, lambda law: law.states == 0))
def friction_law(request):
    return request.param


@pytest.fixture(params=instances(FRICTION_LAWS, lambda law: law.states > 0))
def bristle_law(request):
    return request.param
