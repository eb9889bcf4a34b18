"""Of a direction only the ratio of its numbers counts, whatever their size, wherever one is given."""

import numpy as np
import pytest

from antenna_pin import Urdf, build_mechanism
from antenna_pin.analysis import Antenna, Orbit
from antenna_pin.base.directions import A_DIRECTION, direction, unit
from antenna_pin.dynamics.constraints import Anchor
from antenna_pin.errors import AntennaPinError
from antenna_pin.joints.geometry import SphericalClearance
from antenna_pin.mechanism import JointChange, frame_aligning_z
from antenna_pin.mechanism.flexible import EffectiveMode, MassProperties, Petals
from antenna_pin.show.record.mechanism_view import Boresight

SIZES = (1e200, 1e-200, 1e-310, 1.7e308)
WAY = np.array([0.0, 0.5, 1.0])
LINK = MassProperties.of(10.0, np.zeros(3), np.eye(3))
BODY = '<inertial><mass value="1"/><inertia ixx="1" iyy="2" izz="2" ixy="0" ixz="0" iyz="0"/></inertial>'
URDF = (
    f'<robot name="pair"><link name="a">{BODY}</link><link name="b">{BODY}</link><joint name="j" '
    'type="{}"><parent link="a"/><child link="b"/><axis xyz="{}"/></joint></robot>'
)
DISH = {
    "petals": 4,
    "mass": 1.0,
    "focal_length": 1.0,
    "hub_radius": 0.1,
    "rim_radius": 0.5,
    "vertex": (0, 0, 0),
}


def _urdf(way, kind="continuous"):
    return Urdf.from_text(URDF.format(kind, " ".join(map(repr, way.tolist()))), "u.urdf")


def _pinocchio(way, **variant):
    return build_mechanism(_urdf(way).variant(**variant)).model


def _of_tree(model):
    """What the joint's axis makes of the mass matrix, seen through Pinocchio."""
    import pinocchio as pin

    return pin.crba(model, model.createData(), pin.neutral(model))[-1, :6]


DOORS = {
    "urdf": lambda way: _urdf(way).axis("j"),
    "urdf of a free joint": lambda way: _urdf(way).variant(joints={"j": "free"}).axis("j"),
    "pinocchio": lambda way: _of_tree(_pinocchio(way)),
    "a planar joint": lambda way: build_mechanism(_urdf(way).variant(joints={"j": "planar"})).joint("j").axis,
    "a joint's change": lambda way: (
        _urdf(WAY[::-1]).variant(origins={"j": JointChange(axis=tuple(way))}).axis("j")
    ),
    "frame": frame_aligning_z,
    "closure": lambda way: Anchor.at("a", axis=tuple(way)).rotation,
    "across a closure": lambda way: Anchor.at("a", axis=(1.0, 0.0, 0.0), across=tuple(way)).rotation,
    "boresight": lambda way: Antenna(body="b", boresight=tuple(way)).axes.as_matrix(),
    "up": lambda way: Antenna(body="b", boresight=(1.0, 0.0, 0.0), up=tuple(way)).axes.as_matrix(),
    "orbit": lambda way: Orbit(rate=1.0, normal=tuple(way), nadir=(1e-170, 0, 0)).axes([1.0]).as_matrix(),
    "mode": lambda way: EffectiveMode(direction=tuple(way), mass=1.0, frequency=1.0).part("m", LINK).axis,
    "dish": lambda way: Petals(**DISH, boresight=tuple(way), frequency=1.0).placement,
    "recording": lambda way: Boresight("b", way, ["b"]).axis,
    "journal": lambda way: (
        SphericalClearance(socket_radius=1e-2, ball_radius=9e-3).contacts(np.zeros(3), way)[0].normal
    ),
}


@pytest.mark.parametrize("door", DOORS)
def test_the_size_of_a_direction_does_not_count(door):
    expected = DOORS[door](WAY)
    for size in SIZES:
        assert DOORS[door](size * WAY) == pytest.approx(expected, rel=1e-12, abs=1e-12)  # round-off
    for none in (0.0 * WAY, np.array([np.nan, 0.0, 1.0]), np.array([0.0, np.inf, 0.0])):
        with pytest.raises(AntennaPinError):
            DOORS[door](none)


@pytest.mark.parametrize("given", [(0, 0, 0), (1, 2), "x", (1, np.inf, 0), (np.nan, 1, 0), (1, "a", 0), None])
def test_what_is_no_direction_is_refused(given):
    with pytest.raises(AntennaPinError, match=f"here: way must be {A_DIRECTION}"):
        direction(given, "here", "way")


def test_no_square_of_a_direction_is_made():
    """Numbers that no float holds are no direction."""
    assert unit([5e-324, 0.0, 0.0]).tolist() == [1.0, 0.0, 0.0]
    assert unit([3e300, -4e300]).tolist() == pytest.approx([0.6, -0.8], rel=1e-15)
    with pytest.raises(AntennaPinError, match="axis must be"):
        JointChange(axis=(10**400, 0, 0))
