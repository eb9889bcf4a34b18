"""A base that is shaken, in its URDF: joints in front of the root, and what is refused."""

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin import Urdf, build_mechanism
from antenna_pin.elements import SineShake
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism import with_shaken_base

BASE = (
    '<link name="base"><inertial><origin xyz="0.1 0 0"/><mass value="{0}"/>'
    '<inertia ixx="{1}" iyy="{1}" izz="{1}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
ARM = (
    '<joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/>'
    '<origin xyz="0.3 0 0" rpy="0.2 0 0"/><axis xyz="0 0 1"/></joint>'
    '<link name="arm"><inertial><mass value="1"/>'
    '<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)


def rig(mass=2.0, root="base"):
    text = (BASE.format(mass, 0.01 if mass else 0.0) + ARM).replace('"base"', f'"{root}"')
    return Urdf.from_text(f'<robot name="rig">{text}</robot>', "rig.urdf")


def along(*way, joint="x"):
    return SineShake(joint=joint, direction=way, frequency=5.0, displacement=1e-3)


def about(*way, joint="turn", point=None):
    return SineShake(joint=joint, axis=way, point=point, frequency=5.0, displacement=1e-3)


def test_at_rest_everything_is_where_it_was():
    """And each joint moves the base as its motion says: along, or about an axis through a point."""
    shakes = {
        "turn": about(0, 1, 0, point=(0.5, 0.0, 0.2)),
        "x": along(2, 0, 0),
        "z": along(0, 0, 1, joint="z"),
    }
    plain, shaken = (build_mechanism(one, "fixed") for one in (rig(), with_shaken_base(rig(), shakes)))
    assert list(shaken.joints) == ["x", "z", "turn", "hinge"]  # what slides comes first
    for q, expected in (
        (np.zeros(3), np.eye(4)),
        ((0.3, -0.2, 0.0), pin.SE3(np.eye(3), np.array([0.3, 0.0, -0.2])).homogeneous),
        ((0.0, 0.0, 0.4), turned(0.4, (0.5, 0.0, 0.2))),
    ):
        for link in ("base", "arm"):
            before = placed(plain, link, [1.0, 0.0])
            after = placed(shaken, link, [*q, 1.0, 0.0])
            assert after == pytest.approx(expected @ before, abs=1e-15)


def turned(angle, point):
    turn = pin.SE3(pin.exp3(np.array([0.0, angle, 0.0])), np.zeros(3))
    shift = pin.SE3(np.eye(3), np.array(point))
    return (shift * turn * shift.inverse()).homogeneous


def placed(mechanism, link, q):
    data = mechanism.model.createData()
    pin.framesForwardKinematics(mechanism.model, data, np.array(q, dtype=float))
    return data.oMf[mechanism.frame(link)].homogeneous


REFUSED = {
    "no mass": (rig(0.0), {"x": along(1, 0, 0)}, "must have a mass, got none at 'base'"),
    "the world": (rig(root="world"), {"x": along(1, 0, 0)}, "must have another name than 'world'"),
    "a name": (rig(), {"it": along(1, 0, 0, joint="hinge")}, "name 'hinge' is needed"),
    "one way twice": (
        rig(),
        {"x": along(1, 0, 0), "again": along(-3, 0, 0, joint="again")},
        "directions in which a base is shaken must be independent, which those of x, again are not",
    ),
    "four ways": (
        rig(),
        {f"s{k}": along(1, k, k * k, joint=f"s{k}") for k in range(4)},
        "must be independent",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_shaken_is_refused_in_one_line(name):
    urdf, shakes, words = REFUSED[name]
    with pytest.raises(MechanismError) as error:
        with_shaken_base(urdf, shakes)
    assert words in str(error.value)
    assert "\n" not in str(error.value)
