"""Sliders in guides that end, square and round: what they must keep, and closed forms of how they move."""

import json
import math

import numpy as np
import pytest

from antenna_pin import ClearanceJoint, RunSettings, System, simulate
from antenna_pin.analysis import slider_scenarios
from antenna_pin.contact import Hertz, LankaraniNikravesh, NoFriction, Tanh
from antenna_pin.dynamics import JointSpring
from antenna_pin.elements import PointSpring
from antenna_pin.joints.geometry import CylindricalClearance, PrismaticClearance
from antenna_pin.mechanism import Urdf, build_mechanism

GUIDED = """<robot name="guided">{body}
<joint name="slide" type="prismatic"><parent link="{parent}"/><child link="carriage"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<link name="carriage"><inertial><origin xyz="{centre}"/><mass value="1"/>
<inertia ixx="2e-3" iyy="2e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
BODY = """<link name="body"><inertial><origin xyz="0.1 0 0"/><mass value="8"/>
<inertia ixx="0.3" iyy="0.2" izz="0.4" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
SIDES = dict(slider_width=0.04, slider_height=0.06)
KEY = dict(key_width=4e-3, keyway_width=4.2e-3, key_reach=0.012)


def square(play, **lengths):
    return PrismaticClearance(
        guide_width=0.04 + 2.0 * play, guide_height=0.06 + 2.0 * play, **SIDES, **lengths
    )


def rod(play, **more):
    return CylindricalClearance(bearing_radius=0.02, journal_radius=0.02 - play, **more)


def system_of(shape, law, friction=None, *, free=False, gravity=(0, 0, 0), centre="0 0 0", **more):
    text = GUIDED.format(
        body=BODY if free else '<link name="ground"/>', parent="body" if free else "ground", centre=centre
    )
    urdf = Urdf.from_text(text, "guided")
    if shape is None:
        return System(build_mechanism(urdf, "free" if free else "fixed", gravity=gravity), **more)
    joint = ClearanceJoint(
        name="slide", geometry=shape, radial=law, friction=friction or NoFriction(), maximum_depth=1e-3,
        backend=more.pop("backend", "closed-form"),
    )  # fmt: skip
    mechanism = build_mechanism(
        urdf.variant(joints={"slide": "free"}), "free" if free else "fixed", gravity=gravity
    )
    return System(mechanism, clearances=[joint], **more)


SHAPES = {
    "short guide": square(2e-4, slider_length=0.12, guide_length=0.05),
    "slider passes a mouth": square(2e-4, slider_length=0.05, guide_length=0.06, corner_radius=0.002),
    "sharp, passes a mouth": square(2e-4, slider_length=0.05, guide_length=0.06),
    "rod in a short guide": rod(2e-4, slider_length=0.12, guide_length=0.05),
    "rod passes a mouth": rod(2e-4, slider_length=0.05, guide_length=0.06),
    "key": rod(2e-4, slider_length=0.05, guide_length=0.06, **KEY),
}


def thrown(shape, backend="closed-form", elastic=True, duration=0.06, **settings):
    law = Hertz(stiffness=1e9) if elastic else LankaraniNikravesh(stiffness=1e9, restitution=0.7)
    friction = None if elastic else Tanh(coefficient_of_friction=0.2, transition_speed=0.01)
    system = system_of(shape, law, friction, free=True, backend=backend)
    v = np.array([0.1, 0.0, -0.05, 0.2, -0.3, 0.1, 0.03, 0.05, 0.25, 0.25, -0.2, 1.0])
    return simulate(system, duration=duration, v=v, settings=RunSettings(rtol=1e-10, **settings))


@pytest.mark.parametrize("elastic", [True, False])
@pytest.mark.parametrize("name", SHAPES)
def test_momentum_is_kept_and_the_ledger_closes(name, elastic):
    run = thrown(SHAPES[name], elastic=elastic)
    assert run.completed, run.message
    assert run.data.sizes["episode"] > 3
    kept = json.loads(run.data.attrs["conservation"])
    # Some thousand steps at 1e-10.
    assert kept["linear_momentum_drift_relative"] < 1e-9
    assert kept["angular_momentum_drift_relative"] < 1e-9
    assert kept["energy_error"] < 1e-7 * run.data["kinetic_energy"].values.max()


@pytest.mark.parametrize("name", ["short guide", "key"])
def test_engines_and_coal_agree(name):
    runs = [
        thrown(SHAPES[name], duration=0.01),
        thrown(SHAPES[name], duration=0.01, engine="pinocchio"),
        thrown(SHAPES[name], "coal", duration=0.01),
    ]
    assert runs[0].data.sizes["episode"] > 0
    for other in runs[1:]:
        assert other.data["v"].values[-1] == pytest.approx(runs[0].data["v"].values[-1], abs=1e-9)
    assert float(runs[2].data.attrs["gap_difference"]) < 1e-15


@pytest.mark.parametrize(
    "shape",
    [square(1e-3, slider_length=0.1), square(1e-3, slider_length=0.1, guide_length=0.04),
     rod(1e-3, slider_length=0.1, guide_length=0.04)],
    ids=["square", "short guide", "rod"],
)  # fmt: skip
def test_a_slider_that_falls_flat_bounces_as_a_mass_on_springs(shape):
    """m x'' = m g - K x while it touches: for (2 / w)(pi - atan(v w / g)) after a fall with v^2 = 2 g h."""
    g, stiffness = 9.80665, 1e6
    run = simulate(
        system_of(shape, Hertz(stiffness=stiffness, exponent=1.0), gravity=(g, 0, 0)),
        duration=0.1,
        settings=RunSettings(rtol=1e-12),
    )
    feet = 2 if isinstance(shape, CylindricalClearance) else 4
    w, v = math.sqrt(feet * stiffness), math.sqrt(2.0 * g * 1e-3)
    touches, flight = 2.0 / w * (math.pi - math.atan(v * w / g)), 2.0 * v / g
    data = run.data
    onset = np.unique(np.round(data["onset_time"].values, 9))
    expected = v / g + (touches + flight) * np.arange(onset.size)
    assert onset.size >= 3
    assert onset == pytest.approx(expected, abs=2e-9)  # rounded to a nanosecond
    kinds = slider_scenarios(run)
    lands = "surface" if feet == 4 else "line"
    share = kinds["share"].sel(wall="+x" if feet == 4 else "bore")
    assert float(share.sel(kind=lands)) > 0.02
    # At the very onset gaps are zero but for round-off.
    assert float(share.sel(kind=[lands, "none"]).sum()) > 0.98


@pytest.mark.parametrize("over", [1.05, 0.9])
def test_a_drawer_jams_beyond_half_its_length_over_friction(over):
    """Pulled by F at e off its axis, N = F e / L at each mouth: friction 2 mu N holds where e > L / (2 mu).

    There it creeps at what the tanh law leaves: 2 mu e tanh(v / v_t) = L cos a + w sin a at the tilt a.
    Below, it goes with F (1 - 2 mu e / L) / m.
    """
    mu, slow, length, pull = 0.25, 1e-3, 0.04, 20.0
    offset = over * length / (2.0 * mu)
    # A line of a kilometre: neither force nor direction changes on the way.
    line = PointSpring(
        first=("ground", (offset, 0.0, 1000.0)), second=("carriage", (offset, 0.0, 0.0)),
        stiffness=pull / 1000.0, free_length=0.0,
    )  # fmt: skip
    system = system_of(
        square(5e-5, slider_length=0.3, guide_length=length),
        LankaraniNikravesh(stiffness=1e9, restitution=0.2),
        Tanh(coefficient_of_friction=mu, transition_speed=slow),
        springs={"line": line},
    )
    run = simulate(system, duration=0.1, settings=RunSettings(rtol=1e-9))
    assert run.completed, run.message
    rate = run.data["slide_rate"].values[:, 0]
    if over < 1.0:
        half = rate.size // 2
        gained = (rate[-1] - rate[half]) / (run.data["time"].values[-1] - run.data["time"].values[half])
        # Tilted by 2.5 mrad, w sin a is 0.25 % of L; of a difference of 1 to 0.9.
        assert gained == pytest.approx(pull * (1.0 - over), rel=0.05)
        return
    tilt = float(run.data["journal_tilt"].values[-1, 0])
    hold = (length * math.cos(tilt) + 0.0401 * math.sin(tilt)) / (2.0 * mu * offset)
    # Depths of a micrometre over 40 mm, tenfold by atanh so near to one.
    assert rate[-1] == pytest.approx(slow * math.atanh(hold), rel=2e-3)


def test_a_rod_turns_freely_and_a_key_holds_it():
    """Within the play of the key: asin of 0.1 mm over 12 mm, and a little for the depth."""
    turned = {}
    for name in ("rod passes a mouth", "key"):
        data = thrown(SHAPES[name]).data
        x, y, z, w = (data["journal_attitude"].values[:, 0, k] for k in range(4))
        turned[name] = np.abs(2.0 * np.arctan2(z, w)).max()
    assert turned["rod passes a mouth"] > 0.05
    assert turned["key"] < 1.2 * 1e-4 / 0.012 + 0.004  # eccentric by the rod's play of 0.2 mm beside it


@pytest.mark.parametrize("make", [square, rod])
def test_with_less_play_the_joint_tends_to_the_ideal_one(make):
    """The way along the guide on a body that tumbles: what is off goes with the play."""
    springs = {"coil": JointSpring(joint="slide", stiffness=400.0, rest_angle=0.0)}
    v = np.array([0.0, 0.0, 0.0, 0.3, -0.5, 0.2])
    ideal = simulate(
        system_of(None, None, free=True, springs=springs), duration=0.05, v=np.append(v, 0.3),
        settings=RunSettings(rtol=1e-10),
    ).data["v"].values[-1][:6]  # fmt: skip
    off = []
    for play in (2e-4, 1e-5):
        key = dict(key_width=4e-3, keyway_width=4e-3 + play, key_reach=0.012) if make is rod else {}
        system = system_of(
            make(play, slider_length=0.1, guide_length=0.05, **key),
            LankaraniNikravesh(stiffness=1e10, restitution=0.3),
            free=True,
            springs=springs,
        )
        run = simulate(system, duration=0.05, v=np.concatenate([v, [0, 0, 0.3, 0, 0, 0]]),
                       settings=RunSettings(rtol=1e-8))  # fmt: skip
        assert run.completed, run.message
        off.append(np.abs(run.data["v"].values[-1][:6] - ideal).max())
    assert off[1] < 0.25 * off[0]
    assert off[1] < 1e-3
