"""A start is the assembly next to the pose that is drawn; axes that point opposite ways are one line."""

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin import Closure, System, Urdf, build_mechanism, simulate
from antenna_pin.dynamics import assembled
from antenna_pin.dynamics.constraints import Anchor, Constraints
from antenna_pin.elements import PrescribedMotion
from antenna_pin.errors import MechanismError
from antenna_pin.scenario import load_scenario
from antenna_pin.scenario.assemble import build_system, scenario_facts

# A platform on three legs of two bars in the plane; the motors turn the first bars.
BAR = 0.5
ANGLES = np.radians([90.0, 210.0, 330.0])
FEET = 0.6 * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
TIPS = 0.2 * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
INERTIA = '<inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/>'
INERTIAL = f'<inertial><mass value="1"/>{INERTIA}</inertial>'


def wrapped(angle):
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


def bars(x, y, turn):
    """Closed form: the directions of first and second bars with the platform in a pose, None out of reach."""
    c, s = np.cos(turn), np.sin(turn)
    ends = np.array([x, y]) + TIPS @ np.array([[c, s], [-s, c]])
    way = ends - FEET
    length = np.linalg.norm(way, axis=1)
    if (length >= 2.0 * BAR).any():
        return None
    first = np.arctan2(way[:, 1], way[:, 0]) + np.arccos(length / (2.0 * BAR))
    rest = way - BAR * np.column_stack([np.cos(first), np.sin(first)])
    return first, np.arctan2(rest[:, 1], rest[:, 0])


FIRST, SECOND = bars(0.0, 0.0, 0.0)


def coordinates(x, y, turn):
    """Angles of the tree's joints in a pose, from the one that is drawn: a_k, b_k, plate."""
    first, second = bars(x, y, turn)
    a = wrapped(first - FIRST)
    return np.concatenate([a, wrapped(second - SECOND - a), [wrapped(turn - second[0] + SECOND[0])]])


def hinge(name, parent, child, x, y, turn):
    return (
        f'<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{x:.17g} {y:.17g} 0" rpy="0 0 {turn:.17g}"/><axis xyz="0 0 1"/></joint>'
    )


def platform(positions):
    """The platform drawn in its middle pose, its motors starting where they are told."""
    parts = ['<link name="ground"/>', f'<link name="plate">{INERTIAL}</link>']
    for k, (x, y) in enumerate(FEET):
        parts += [f'<link name="u{k}">{INERTIAL}</link><link name="l{k}">{INERTIAL}</link>']
        parts += [hinge(f"a{k}", "ground", f"u{k}", x, y, FIRST[k])]
        parts += [hinge(f"b{k}", f"u{k}", f"l{k}", BAR, 0.0, SECOND[k] - FIRST[k])]
    parts += [hinge("plate", "l0", "plate", BAR, 0.0, -SECOND[0])]
    urdf = Urdf.from_text(f'<robot name="rrr">{"".join(parts)}</robot>', "rrr")
    loops = {
        f"c{k}": Closure(
            kind="revolute",
            first=Anchor.at(f"l{k}", (BAR, 0.0, 0.0)),
            second=Anchor.at("plate", (*(TIPS[k] - TIPS[0]), 0.0)),
        )
        for k in (1, 2)
    }
    motors = {f"a{k}": PrescribedMotion(joint=f"a{k}", position=float(at)) for k, at in enumerate(positions)}
    return System(build_mechanism(urdf, "fixed"), closures=loops, drives=motors)


def found(system):
    q, _ = assembled(system, system.neutral())
    names = [*(f"a{k}" for k in range(3)), *(f"b{k}" for k in range(3)), "plate"]
    pairs = [q[system.mechanism.joint(name).q] for name in names]
    return np.array([np.arctan2(sine, cosine) for cosine, sine in pairs])


def test_a_platform_whose_motors_start_elsewhere_lands_on_the_nearest_assembly():
    """Not further away than the pose in closed form that its motors' angles are those of; mostly on it."""
    rng, poses = np.random.default_rng(0), []
    while len(poses) < 40:
        pose = (*rng.uniform(-0.3, 0.3, 2), rng.uniform(-1.0, 1.0))
        if bars(*pose) is not None:
            poses.append(pose)
    same = 0
    for pose in poses:
        known = coordinates(*pose)
        here = found(platform(known[:3]))
        assert np.abs(wrapped(here[:3] - known[:3])).max() < 1e-11  # residuals are below 1e-12
        assert np.linalg.norm(here) < np.linalg.norm(known) + 1e-9
        same += float(np.abs(wrapped(here - known)).max()) < 1e-8
    assert same >= 30


FLOOR = np.radians([-10.0, 10.0, 110.0, 130.0, 230.0, 250.0])
PLATE = np.radians([-50.0, 50.0, 70.0, 170.0, 190.0, 290.0])
FLOOR = np.column_stack([np.cos(FLOOR), np.sin(FLOOR), np.zeros(6)])
PLATE = 0.6 * np.column_stack([np.cos(PLATE), np.sin(PLATE), np.zeros(6)])


def hexapod(height, lengths):
    """A platform on six legs, drawn upright with no length; their slides start at the lengths given."""
    parts = [f'<link name="ground"/><link name="plate">{INERTIAL}</link>']
    parts += ['<joint name="plate" type="floating"><parent link="ground"/><child link="plate"/>']
    parts += [f'<origin xyz="0 0 {height}"/></joint>']
    for k, (x, y, _) in enumerate(FLOOR):
        parts += [
            f'<link name="x{k}"/><link name="u{k}">{INERTIAL}</link><link name="s{k}">{INERTIAL}</link>'
        ]
        parts += [
            hinge(f"p{k}", "ground", f"x{k}", x, y, 0.0).replace('axis xyz="0 0 1"', 'axis xyz="1 0 0"')
        ]
        parts += [
            hinge(f"r{k}", f"x{k}", f"u{k}", 0.0, 0.0, 0.0).replace('axis xyz="0 0 1"', 'axis xyz="0 1 0"')
        ]
        parts += [
            f'<joint name="l{k}" type="prismatic"><parent link="u{k}"/><child link="s{k}"/>'
            '<axis xyz="0 0 1"/><limit lower="0" upper="9" effort="1" velocity="1"/></joint>'
        ]
    loops = {
        f"c{k}": Closure(
            kind="spherical", first=Anchor.at(f"s{k}"), second=Anchor.at("plate", tuple(map(float, tip)))
        )
        for k, tip in enumerate(PLATE)
    }
    motors = {f"l{k}": PrescribedMotion(joint=f"l{k}", position=float(at)) for k, at in enumerate(lengths)}
    urdf = Urdf.from_text(f'<robot name="hexapod">{"".join(parts)}</robot>', "hexapod")
    return System(build_mechanism(urdf, "fixed"), closures=loops, drives=motors)


def test_a_hexapod_that_is_drawn_without_legs_stands_as_it_is_told():
    """In the pose that its legs' lengths are those of, turned by 42 deg; Newton alone once came to 71."""
    rng = np.random.default_rng(5)
    for height, up in [(0.25, 0.9), (0.9, 0.6)] * 4:
        place, turn = rng.uniform(-0.2, 0.2, 3) + [0.0, 0.0, up], rng.uniform(-0.5, 0.5, 3)
        ends = place + [0.0, 0.0, height] + PLATE @ pin.exp3(turn).T
        system = hexapod(height, np.linalg.norm(ends - FLOOR, axis=1))
        q, _ = assembled(system, system.neutral())
        pose = pin.XYZQUATToSE3(q[system.mechanism.joint("plate").q])
        # Residuals of 1e-12 m, in a pose that is no singular one.
        assert [*pose.translation, *pin.log3(pose.rotation)] == pytest.approx([*place, *turn], abs=1e-9)


def test_whole_turns_of_a_motor_are_the_motions():
    """A motor at minus 3.5 rad starts there, though its joint is drawn at zero and turns without end."""
    known = coordinates(0.1, -0.1, 0.3)
    assert wrapped(found(platform(known[:3] + [0.0, 2.0 * np.pi, -4.0 * np.pi])) - known) == pytest.approx(
        np.zeros(7), abs=1e-10
    )


FOUR_BAR = """<robot name="fourbar"><link name="ground"/>{links}
<joint name="a" type="continuous"><parent link="ground"/><child link="crank"/><axis xyz="0 -1 0"/></joint>
<joint name="b" type="continuous"><parent link="crank"/><child link="coupler"/><origin xyz="0.2 0 0"/>
<axis xyz="0 -1 0"/></joint><joint name="d" type="continuous"><parent link="ground"/><child link="rocker"/>
<origin xyz="0.4 0 0"/><axis xyz="0 -1 0"/></joint></robot>"""
LOOP = """format = 1
duration = "0.3 s"
[mechanism]
urdf = "a.urdf"
base = "fixed"
gravity = [0, 0, -9.81]
[closures.c]
kind = "{kind}"
first = {{ link = "coupler", point = [0.4, 0, 0], axis = [0, -1, 0]{across} }}
second = {{ link = "rocker", point = [0.2, 0, 0], axis = [0, {sign}, 0]{across} }}
[initial.joints]
a = {{ position = {a}, guess = true }}
b = {{ position = {b}, guess = true }}
d = {{ position = {d}, guess = true }}
"""


@pytest.fixture
def four_bar(tmp_path):
    links = "".join(f'<link name="{name}">{INERTIAL}</link>' for name in ("crank", "coupler", "rocker"))
    (tmp_path / "a.urdf").write_text(FOUR_BAR.format(links=links))

    def made(sign, kind="revolute", across="", a=0.5, b=-0.5, d=0.5):
        text = LOOP.format(sign=sign, kind=kind, across=across, a=a, b=b, d=d)
        (tmp_path / "scenario.toml").write_text(text)
        return load_scenario(tmp_path)

    return made


@pytest.mark.parametrize("across", ["", ", across = [1, 0, 0.2]"])
@pytest.mark.parametrize("kind", ["revolute", "cylindrical", "planar", "prismatic", "universal", "fixed"])
def test_an_axis_given_the_other_way_is_the_same_axis(four_bar, kind, across):
    """Of a line the closure is that of equal signs; a universal one has no parallel axes and keeps its."""
    equal, opposite = (build_system(four_bar(sign, kind, across)).closures["c"] for sign in (-1, 1))
    sign = 1.0 if kind in ("revolute", "cylindrical", "planar", "prismatic") else -1.0
    assert np.array_equal(opposite.first.rotation, equal.first.rotation)
    assert opposite.second.rotation[:, 2] == pytest.approx(sign * equal.second.rotation[:, 2], abs=0.0)
    assert np.array_equal(opposite.second.rotation, equal.second.rotation) == (sign > 0.0)
    assert scenario_facts(four_bar(-1))["closures"]["c"]["turned"] is False


def test_a_loop_with_opposite_axes_moves_as_with_equal_ones_and_says_so(four_bar):
    """Bit for bit, forces included; and where the start is far from the guess, which joints are."""
    runs = [simulate(four_bar(sign, a=0.9, b=-0.5, d=0.5)) for sign in (-1, 1)]
    for name in ("q", "closure_force"):
        assert np.array_equal(*(run.data[name].values for run in runs))
    facts = scenario_facts(four_bar(1, a=0.9, b=-0.5, d=1.3))
    assert facts["closures"]["c"]["turned"] is True
    crank, coupler, rocker = (facts["start"][name] for name in "abd")
    x = 0.2 * np.cos(crank) + 0.4 * np.cos(crank + coupler) - 0.4 - 0.2 * np.cos(rocker)
    z = 0.2 * np.sin(crank) + 0.4 * np.sin(crank + coupler) - 0.2 * np.sin(rocker)
    assert max(abs(x), abs(z)) < 1e-12
    away = {"a": abs(crank - 0.9), "b": abs(coupler + 0.5), "d": abs(rocker - 1.3)}
    assert {name: one["turn"] for name, one in facts["moved"].items()} == pytest.approx(
        {name: angle for name, angle in away.items() if angle > np.radians(10.0)}, rel=1e-12
    )
    assert facts["moved"]


def test_opposite_axes_given_in_python_are_refused_at_once(four_bar, monkeypatch):
    """Nothing turns them: no search is made for a start that there cannot be."""
    system = build_system(four_bar(-1))
    loop = system.closures["c"]
    turned = Closure(
        kind="revolute", first=loop.first, second=Anchor.at("rocker", (0.2, 0.0, 0.0), (0.0, 1.0, 0.0))
    )
    looks, residuals = [], Constraints.residuals

    def counted(*given):
        looks.append(0)
        return residuals(*given)

    monkeypatch.setattr(Constraints, "residuals", counted)
    odd = System(system.mechanism, closures={"c": turned})
    with pytest.raises(
        MechanismError, match="closure 'c' lacks 3.142 rad.*its axes point opposite ways: turn one"
    ):
        assembled(odd, odd.neutral())
    assert len(looks) < 200  # Newton's method once, not twelve times
