"""Functions of a user's that cannot be asked, and what stands in their place, are refused when given."""

import math

import pytest

from antenna_pin.contact import CustomFriction, CustomNormal, LankaraniNikravesh, NoFriction
from antenna_pin.elements import CallableDrive, CallableMotion
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import PlanarClearance
from antenna_pin.run.simulation import Event, Jump


def of_one(a):
    return a


def of_three(depth, rate, speed):
    return depth


LAW = {"force": of_three, "elastic_force": of_one, "elastic_energy": of_one}
GEOMETRY = PlanarClearance(bearing_radius=0.01, journal_radius=0.009)


def joint(**parts):
    return ClearanceJoint(**{"name": "hole", "geometry": GEOMETRY, "radial": CustomNormal(**LAW), **parts})


class NoQuery:
    query = 3


REFUSED = {
    "drive of one": (
        lambda: CallableDrive(joint="j", torque=math.sin),
        "torque must be a function of 3 arguments (t",
    ),
    "drive of three": (lambda: CallableDrive(joint="j", torque=3), "torque must be a function, got 3"),
    "motion": (
        lambda: CallableMotion(joint="j", position=of_three, velocity=of_one, acceleration=of_one),
        "position must be a function of 1 argument (t), got one of (depth, rate, speed)",
    ),
    "law": (
        lambda: CustomNormal(**{**LAW, "force": of_one}),
        "force must be a function of 3 arguments (depth, ",
    ),
    "friction": (
        lambda: CustomFriction(coefficient=of_three),
        "coefficient must be a function of 1 argument",
    ),
    "event": (
        lambda: Event(name="e", when=lambda: 1.0),
        "when must be a function of 1 argument (moment), got",
    ),
    "jump": (lambda: Jump(lambda: 1.0), "change must be a function of 1 argument (moment), got one of ()"),
    "name of a law": (lambda: joint(radial="hertz"), "radial must be a NormalLaw, got 'hertz'"),
    "class of laws": (lambda: joint(radial=LankaraniNikravesh), "radial must be a NormalLaw, got <class"),
    "class of shapes": (
        lambda: joint(geometry=PlanarClearance),
        "geometry must be a ClearanceGeometry, got <",
    ),
    "class of frictions": (lambda: joint(friction=NoFriction), "friction must be a FrictionLaw, got <class"),
    "backend": (
        lambda: joint(backend=NoQuery()),
        "NoQuery: query must be a function of 4 arguments (pose, table",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_asked_is_refused_when_made(case):
    make, said = REFUSED[case]
    with pytest.raises(InvalidParameterError) as refusal:
        make()
    assert said in str(refusal.value)
