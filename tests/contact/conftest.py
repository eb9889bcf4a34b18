"""Every law of the registries, built from example parameters: a law that is added is tested unasked."""

import itertools

import pytest

from antenna_pin.contact import FRICTION_LAWS, NORMAL_LAWS, law_parameters

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
}


def instances(laws):
    for name, law in laws.items():
        parameters = list(law_parameters(law))
        for values in itertools.product(*(EXAMPLES[p] for p in parameters)):
            given = dict(zip(parameters, values, strict=True))
            label = "-".join([name, *(f"{v:.3g}" for p, v in given.items() if len(EXAMPLES[p]) > 1)])
            yield pytest.param(law(**given), id=label)


@pytest.fixture(params=instances(NORMAL_LAWS))
def normal_law(request):
    return request.param


@pytest.fixture(params=instances(FRICTION_LAWS))
def friction_law(request):
    return request.param
