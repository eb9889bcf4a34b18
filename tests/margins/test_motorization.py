"""Motorization margins against hand calculations, and worst cases against corners."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from antenna_pin import AntennaPinError, Scenario, System, Urdf, build_mechanism, load_scenario
from antenna_pin.dynamics import ConstantDrive, JointSpring
from antenna_pin.dynamics.constraints import Anchor, Closure, Coupling
from antenna_pin.elements import Gear, HarnessSpring, Motor, StickingFriction
from antenna_pin.scenario import models_path
from antenna_pin.scenario.assemble import joint_play
from antenna_pin.scenario.assemble.temperature import axial_load
from antenna_pin.studies.margins import FACTOR_SETS, margin

G = 9.81
LINK = (
    '<link name="{0}"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="{3} 0 0"/>'
    '<axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>'
)
BAR = f'<robot name="bar"><link name="bus"/>{LINK.format("bar")}'
BAR += JOINT.format("hinge", "bus", "bar", 0) + "</robot>"
SCENARIO = """format = 1
title = "hinge"
duration = 1
[mechanism]
urdf = "bar.urdf"
base = "fixed"
[drives.motor]
joint = "hinge"
kind = "constant"
value = 30
[springs.coil]
joint = "hinge"
stiffness = 2
[springs.tension]
kind = "between-points"
first = { link = "world", point = [-0.5, 0, 0] }
second = { link = "bar", point = [1, 0, 0] }
free_length = 1.5
stiffness = 10
"""


def _bar(gravity: float = G, **more: object) -> System:
    mechanism = build_mechanism(Urdf.from_text(BAR, "bar"), "fixed", (0.0, -gravity, 0.0))
    return System(mechanism, **more)  # type: ignore[arg-type]


def test_hinge_by_hand():
    """Spring, Coulomb friction under load, harness, weight, adhesion, acceleration: the formula."""
    harness = HarnessSpring(
        joint="hinge",
        angle=(-2.0, 2.0),
        torque=(-0.3, -0.5),
        torque_back=(0.1, 0.2),
        reversal=0.01,
        interpolation="linear",
    )
    friction = StickingFriction(joint="hinge", coulomb=0.1, static=0.15, coefficient=0.2, radius=0.01)
    system = _bar(
        drives={"motor": ConstantDrive(joint="hinge", value=60.0)},
        springs={"coil": JointSpring(joint="hinge", stiffness=3.0, rest_angle=0.2), "harness": harness},
        elements={"frictions": {"bush": friction}},
    )
    found = margin(
        system,
        "hinge",
        travel=(-1.0, 1.0),
        count=11,
        by_measurement={"bush": True, "harness": False},
        additional={"H_D": 0.05},
        acceleration=0.5,
        delivered_torque=0.3,
    )
    phi = found.data["position"].values
    spring, weight = -3.0 * (phi - 0.2), -2.0 * G * 0.5 * np.cos(phi)
    dry, cable = 0.15 + 0.2 * 0.01 * 2.0 * G, 0.3 + 0.05 * (phi + 2.0)
    resists = 1.1 * np.maximum(-weight, 0.0) + 1.2 * np.maximum(-spring, 0.0) + 1.5 * dry + 3.0 * cable
    minimum = 2.0 * (resists + 3.0 * 0.05) + 1.25 * 0.5 * (2.0 * 0.25 + 0.1) + 0.3
    drives = 60.0 + 0.8 * np.maximum(spring, 0.0)
    # Round-off of the pose.
    assert found.data["minimum_torque"].values == pytest.approx(minimum, rel=1e-12)
    assert found.margin == pytest.approx(drives / minimum - 1.0, rel=1e-10)
    k = int(np.argmin(drives / minimum))
    assert (found.smallest, found.position) == pytest.approx(
        (drives[k] / minimum[k] - 1.0, phi[k]), rel=1e-10
    )
    back = margin(system, "hinge", travel=(1.0, -1.0), count=11, available={"motor": 60.0})
    # On the way down the harness helps on neither way by its sign: its other table, and the weight drives.
    cable = 0.1 + 0.025 * (back.data["position"].values + 2.0)
    own = back.data["resistance"].sel(source="springs.harness").values
    assert own == pytest.approx(cable, rel=1e-10)
    second = margin(system, "hinge", travel=(-1.0, 1.0), count=11, factors="aiaa-s-114")
    bare = 2.0 * (np.maximum(-weight, 0.0) + np.maximum(-spring, 0.0) + dry + 0.3 + 0.05 * (phi + 2.0))
    assert second.data["minimum_torque"].values == pytest.approx(bare, rel=1e-12)
    assert "second hand" in FACTOR_SETS["aiaa-s-114"].source


def test_four_bar_by_virtual_work():
    """A parallelogram: all bars turn as the crank does or not at all, and each source has that share."""
    text = f'<robot name="p"><link name="ground"/>{LINK.format("crank")}{LINK.format("rod")}'
    text += LINK.format("rocker") + JOINT.format("crank", "ground", "crank", 0)
    text += JOINT.format("pin", "crank", "rod", 1) + JOINT.format("knee", "rod", "rocker", 2) + "</robot>"
    closure = Closure(
        kind="revolute",
        first=Anchor.at("world", point=(2.0, 0.0, 0.0)),
        second=Anchor.at("rocker", point=(-1.0, 0.0, 0.0)),
    )
    mechanism = build_mechanism(Urdf.from_text(text, "p"), "fixed", (0.0, -G, 0.0))
    system = System(
        mechanism,
        closures={"pivot": closure},
        drives={"motor": ConstantDrive(joint="crank", value=300.0)},
        springs={"coil": JointSpring(joint="pin", stiffness=5.0)},
        elements={"frictions": {"dry": StickingFriction(joint="knee", coulomb=0.7)}},
    )
    q = np.array([0.6, -0.6, 0.6])
    from antenna_pin.dynamics import assembled

    start, _ = assembled(system, q, held=["crank"])
    assert start[:2] == pytest.approx(q[:2], abs=1e-9)  # the branch of the parallelogram
    found = margin(system, "crank", travel=(0.3, 1.2), count=7, q=start)
    phi = found.data["position"].values
    # Rod and rocker: the rod goes with the crank's end, the rocker's centre as the crank's, back to front.
    lifted = 2.0 * G * (0.5 + 1.0 + (1.0 - 0.5 + 0.0)) * np.cos(phi)
    spring, dry = 5.0 * phi, 0.7
    by_source = found.data["resistance"]
    assert by_source.sel(source="springs.coil").values == pytest.approx(spring, rel=1e-10)
    assert by_source.sel(source="frictions.dry").values == pytest.approx(np.full(7, dry), rel=1e-10)
    weight = by_source.sel(source="gravity").values
    minimum = 2.0 * (1.1 * weight + 1.2 * spring + 3.0 * dry)
    assert found.margin == pytest.approx(300.0 / minimum - 1.0, rel=1e-10)
    assert weight == pytest.approx(lifted + 2.0 * 2.0 * G * 0.5 * np.cos(phi), rel=1e-10)


def test_motor_behind_a_coupling():
    """A motor at a rotor that turns n times: K_t i n less the back-EMF's share, its cogging as a loss."""
    text = f'<robot name="g"><link name="bus"/>{LINK.format("bar")}{LINK.format("rotor")}'
    text += JOINT.format("hinge", "bus", "bar", 0) + JOINT.format("shaft", "bus", "rotor", 0)
    text = text.replace('name="shaft" type="revolute"', 'name="shaft" type="continuous"') + "</robot>"
    ratio, kt, resistance, volts, cogging, speed = 40.0, 0.05, 2.0, 28.0, 0.004, 0.3
    motor = Motor(
        joint="shaft", value=volts, torque_constant=kt, resistance=resistance, cogging=cogging, cycles=6
    )
    system = System(
        build_mechanism(Urdf.from_text(text, "g"), "fixed"),
        drives={"motor": motor},
        couplings={"train": Coupling(follower="shaft", leader="hinge", multiplier=ratio)},
        elements={"frictions": {"dry": StickingFriction(joint="shaft", coulomb=0.01)}},
    )
    found = margin(system, "hinge", travel=(0.0, 1.0), count=3, rate=speed)
    torque = ratio * kt * (volts - kt * ratio * speed) / resistance
    minimum = 2.0 * (3.0 * ratio * 0.01 + 1.5 * ratio * cogging)
    assert found.margin == pytest.approx(np.full(3, torque / minimum - 1.0), rel=1e-10)
    assert str(found.data["symbol"].sel(source="drives.motor cogging").item()) == "H_M"


def test_gears_lose_a_share_of_what_they_transmit():
    """Two stages of 8 and 5 between motor and bar: (1 / eta - 1) of the resistances beyond each."""
    text = (
        f'<robot name="g"><link name="bus"/>{LINK.format("bar")}{LINK.format("shaft")}{LINK.format("rotor")}'
    )
    for joint, link in (("hinge", "bar"), ("middle", "shaft"), ("motor", "rotor")):
        text += JOINT.format(joint, "bus", link, 0)
    text = text.replace('-3"', '-300"').replace('"3"', '"300"') + "</robot>"
    dry = {"hinge": 0.9, "middle": 0.02, "motor": 0.001}
    system = System(
        build_mechanism(Urdf.from_text(text, "g"), "fixed"),
        drives={"motor": ConstantDrive(joint="motor", value=1.0)},
        springs={"coil": JointSpring(joint="hinge", stiffness=2.0)},
        elements={
            "frictions": {name: StickingFriction(joint=name, coulomb=value) for name, value in dry.items()},
            "gears": {
                "slow": Gear(input="middle", output="hinge", ratio=5.0, stiffness=1e5, efficiency=0.8),
                "fast": Gear(input="motor", output="middle", ratio=8.0, stiffness=1e5, efficiency=0.9),
            },
        },
    )
    found = margin(system, "hinge", travel=(0.5, 1.0), count=3, delivered_torque=0.4)
    beyond = 0.9 + 2.0 * found.data["position"].values + 0.4
    slow = 0.25 * beyond
    fast = (beyond + slow + 5.0 * 0.02) / 9.0
    own = found.data["resistance"]
    # Gears store energy as the coil winds up: T T' / k = 2 x 2 / 1e5.
    assert own.sel(source="gears.slow").values == pytest.approx(slow, abs=1e-4)
    assert own.sel(source="gears.fast").values == pytest.approx(fast, abs=1e-4)
    assert own.sel(source="frictions.motor").values == pytest.approx(np.full(3, 0.04), rel=1e-4)


@pytest.fixture
def hinge(tmp_path: Path) -> Scenario:
    """A hinge with a coil, and a spring to a point whose arm and length depend on that point."""
    (tmp_path / "bar.urdf").write_text(BAR)
    (tmp_path / "hinge.toml").write_text(SCENARIO)
    return load_scenario(tmp_path / "hinge.toml")


def test_worst_case_of_a_monotone_margin_is_its_corner(hinge: Scenario):
    """Stiff coil and low supply, as text with units; the named case runs."""
    found = margin(
        hinge,
        "hinge",
        travel=(0.1, 1.0),
        count=2,
        cases={"cold": {"springs.coil.rest_angle": -0.1}, "hot": {}},
        ranges={"drives.motor.value": ("25 N*m", "31 N*m"), "springs.coil.stiffness": (1.5, 2.5)},
        search=True,
    )
    corners = [one for one in found.cases if one.origin == "corner"]
    assert len(corners) == 8
    assert found.worst.margin == min(one.margin for one in corners)
    assert found.worst.name == "cold, drives.motor.value=25, springs.coil.stiffness=2.5"
    assert found.worst_scenario is not None
    again = margin(found.worst_scenario, "hinge", travel=(0.1, 1.0), count=2)
    assert again.smallest == pytest.approx(found.worst.margin, rel=1e-12)


def test_search_beats_the_corners_of_a_margin_that_is_not_monotone(hinge: Scenario):
    """The spring resists by k a b sin(phi) (l_0 / l - 1): nothing at b = 0 and l = l_0, most in between."""
    phi, key = 0.5 * np.pi, "springs.tension.first.point[0]"
    far = -np.sqrt(1.5**2 - 1.0)
    found = margin(hinge, "hinge", travel=[0.4 * np.pi, phi], count=2, ranges={key: (far, 0.0)}, search=True)
    corners = [one.margin for one in found.cases if one.origin == "corner"]
    assert found.worst.margin < min(corners) - 1e-3
    assert found.worst.origin == "search"
    b = -np.linspace(far, 0.0, 4001)

    def minimum(place: float) -> np.ndarray:
        length = np.sqrt(1.0 + b**2 + 2.0 * b * np.cos(place))
        pull = 10.0 * (length - 1.5) * b * np.sin(place) / length
        resists, helps = np.maximum(-pull, 0.0), np.maximum(pull, 0.0)
        return (30.0 + 0.8 * helps) / (2.0 * 1.2 * (resists + 2.0 * place)) - 1.0

    least = min(minimum(place).min() for place in (0.4 * np.pi, phi))
    # The search ends at a thousandth of the range, where the margin is flat.
    assert found.worst.margin == pytest.approx(least, abs=1e-4) or found.worst.margin <= least + 1e-4


def test_friction_of_a_warm_pair_on_a_free_base_under_other_names(tmp_path: Path):
    """Temperature opens a fit and presses a pair on, and its friction follows; names change no bit."""
    folder = models_path() / "gimbal"
    found = {}
    for name in ("azimuth", "pan-1"):
        for file in ("gimbal.urdf", "scenario.toml"):
            text = (folder / file).read_text().replace("azimuth", name)
            play = 'bearing_radius = "7.515 mm"\nradial_clearance = "15 um"\n'
            (tmp_path / file).write_text(text.replace(play, 'fit = "15 H7/g6"\n'))
        cold = load_scenario(tmp_path / "scenario.toml").with_overrides(
            {
                "mechanism.base": "free",
                "materials.steel.expansion": 11.7e-6,
                "materials.bronze.expansion": 18e-6,
                f"bearings.{name}.spread": "10 mm",
                f"temperature.bearings.{name}.shaft_material": "titanium-6al-4v",
                f"temperature.bearings.{name}.housing_material": "aluminium-7075-t6",
            }
        )
        warm = cold.with_overrides({"temperature.all": "40 degC"})
        found[name] = [margin(one, name, travel=(-1.5, 1.5), count=2) for one in (cold, warm)]
    at_20, at_40 = found["azimuth"]
    for one, other in zip(found["azimuth"], found["pan-1"], strict=True):
        assert one.data["minimum_torque"].values.tobytes() == other.data["minimum_torque"].values.tobytes()
    # Half of the housing's growth over the shaft's presses each row on.
    bearing = cold.families["bearings"]["pan-1"].build()
    preload = axial_load(bearing, 0.5 * 10e-3 * (23.4e-6 - 8.6e-6) * 20.0)
    friction = [
        one.data["resistance"].sel(source="springs.azimuth_friction").values for one in (at_20, at_40)
    ]
    assert friction[0] == pytest.approx(0.03, rel=1e-10)
    assert friction[1] == pytest.approx(0.03 * (preload / 150.0) ** 1.33, rel=1e-10)
    # Twice the factor 3 of what friction adds, and of what the gear loses of it: the harness resists too.
    added = (at_40.data["minimum_torque"] - at_20.data["minimum_torque"]).values[-1]
    assert added == pytest.approx(2.0 * 3.0 * (friction[1] - friction[0])[-1] / 0.9, rel=1e-8)
    # 15 H7/g6 has 6 to 35 um in diameter at 20 degC.
    radius = 7.5e-3 + 0.5 * 9e-6, 7.5e-3 - 0.5 * 11.5e-6
    grown = radius[0] * (1.0 + 20.0 * 18e-6) - radius[1] * (1.0 + 20.0 * 11.7e-6)
    assert joint_play(warm, "elevation").radial == pytest.approx(grown, rel=1e-12)


def test_refusals(hinge: Scenario):
    """One line each: nothing that drives, names, classes, keys."""
    with pytest.raises(AntennaPinError, match="something must drive the function along its travel"):
        margin(_bar(), "hinge", travel=(-0.5, 0.5), count=3)
    with pytest.raises(AntennaPinError, match="source 'coyl' is unknown; did you mean springs.coil"):
        margin(hinge, "hinge", travel=(0.1, 1.0), count=2, by_measurement=["coyl"])
    with pytest.raises(AntennaPinError, match="class of resistance 'F' is unknown"):
        margin(hinge, "hinge", travel=(0.1, 1.0), count=2, additional={"F": 1.0})
    with pytest.raises(
        AntennaPinError, match="set of factors 'ecss' is unknown; did you mean ecss-e-st-33-01c"
    ):
        margin(hinge, "hinge", travel=(0.1, 1.0), count=2, factors="ecss")
    with pytest.raises(AntennaPinError, match="two numbers that rise"):
        margin(hinge, "hinge", travel=(0.1, 1.0), count=2, ranges={"springs.coil.stiffness": (3.0, 2.0)})
    with pytest.raises(AntennaPinError, match="coils"):
        margin(hinge, "hinge", travel=(0.1, 1.0), count=2, ranges={"springs.coils.x": (1.0, 2.0)})
