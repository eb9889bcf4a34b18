"""End stops in runs: closed forms of bounces, what they keep and lose, where they touch."""

import dataclasses

import numpy as np
import pytest

from antenna_pin import RunSettings, simulate
from antenna_pin.contact import delivered_restitution
from antenna_pin.dynamics import System
from antenna_pin.elements import EndStop, RigidStop
from antenna_pin.errors import AntennaPinError
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.run.simulation import Event, Set, Time

G = 9.81
TIGHT = RunSettings(rtol=1e-11, max_step=0.05, output_rate=50.0)

BODIES = """<robot name="two"><link name="base"><inertial><origin xyz="0.1 0 0.05"/><mass value="3"/>
<inertia ixx="0.4" iyy="0.5" izz="0.6" ixy="0.01" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="{type}"><parent link="base"/><child link="arm"/><origin xyz="0.2 0 0"/>
<axis xyz="0 0 1"/><limit lower="-9" upper="9" effort="1e9" velocity="1e9"/></joint>
<link name="arm"><inertial><origin xyz="0.3 0.1 0"/><mass value="2"/>
<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0.01" iyz="0"/></inertial></link></robot>"""


def system(kind, base, *stops, gravity=(0.0, 0.0, 0.0), **more):
    """A base and a body on a joint along or about z."""
    urdf = Urdf.from_text(BODIES.format(type=kind), "two.urdf")
    named = {f"s{k}": stop for k, stop in enumerate(stops)}
    return System(build_mechanism(urdf, base, gravity), elements={"stops": named}, **more)


def falling(stop, **more):
    """A body of 2 kg that falls onto a stop."""
    return system("prismatic", "fixed", stop, gravity=(0.0, 0.0, -G), **more)


def changes(run, what):
    """When a change happened that is called so."""
    names = np.array(run.data.change.values, dtype=str)
    return run.data.change_time.values[np.char.endswith(names, what)]


def test_a_body_on_an_elastic_stop_bounces_at_the_times_of_the_closed_form():
    """Free flight of 2 v0 / g, half an oscillation and more in touch; depth to g / w^2 + sqrt(..)."""
    stiffness, height = 8000.0, 0.1
    run = simulate(
        falling(EndStop(joint="j", lower=0.0, stiffness=stiffness, law="elastic")),
        q=[height],
        v=[0.0],
        duration=1.0,
        settings=TIGHT,
    )
    omega, first = np.sqrt(stiffness / 2.0), np.sqrt(2.0 * height / G)
    speed = G * first
    touch = 2.0 / omega * (np.pi - np.arctan(speed * omega / G))
    on = first + np.arange(4) * (touch + 2.0 * first)
    # Tight tolerances leave 1e-8 s of a second; found: 3e-11 s.
    assert changes(run, "lower: on")[:3] == pytest.approx(on[:3], abs=1e-8)
    assert changes(run, "lower: off")[:3] == pytest.approx(on[:3] + touch, abs=1e-8)
    turns = np.array([name.endswith("turns") for name in run.data.change.values])
    deepest = G / omega**2 + np.sqrt((G / omega**2) ** 2 + (speed / omega) ** 2)
    assert -run.data.change_angle.values[turns] == pytest.approx(deepest, rel=1e-9)
    assert np.abs(run.data.energy_error).max() < 1e-9


@pytest.mark.parametrize(
    ("law", "more", "expected"),
    [
        ("exact-restitution", {"restitution": 0.5}, 0.5),
        ("flores", {"restitution": 0.5}, delivered_restitution(1.6)),
        ("kelvin-voigt", {"damping": 5.0}, None),
    ],
)
@pytest.mark.parametrize("kind", ["revolute", "continuous"])
def test_a_free_base_comes_back_with_the_restitution_of_the_law(kind, law, more, expected):
    """Without outside forces, about the axis through both bodies' frames: the law's own restitution.

    Of Kelvin and Voigt exp[-zeta (pi - 2 asin zeta) / sqrt(1 - zeta^2)], cut off where it would pull; the
    joint turns but little in the touch, so that its reduced inertia stays.
    """
    stiffness = 4e4
    stop = EndStop(joint="j", upper=0.3, stiffness=stiffness, law=law, **more)
    made = system(kind, "free", stop)
    v = np.array([0.0] * 6 + [0.5])
    settings = RunSettings(rtol=1e-11, max_step=0.004, output_rate=50.0)
    run = simulate(made, v=v, duration=0.9, settings=settings)
    names = list(run.data.change.values)
    on, off = (next(k for k, name in enumerate(names) if name.endswith(end)) for end in (": on", ": off"))
    ratio = -float(run.data.change_rate[off]) / float(run.data.change_rate[on])
    if expected is None:
        place = made.mechanism.joint("j").v.start
        inverse = np.linalg.inv(_mass(made, run, on))[place, place]
        zeta = 0.5 * more["damping"] * np.sqrt(inverse / stiffness)
        expected = np.exp(-zeta * (np.pi - 2.0 * np.arcsin(zeta)) / np.sqrt(1.0 - zeta**2))
    # The reduced inertia changes by parts in a thousand over the depth.
    assert ratio == pytest.approx(expected, rel=2e-3)
    for name in ("linear_momentum", "angular_momentum"):
        moved = run.data[name].values - run.data[name].values[0]
        assert np.abs(moved).max() < 1e-11
    assert np.abs(run.data.energy_error).max() < 1e-9
    assert float(run.data.total_element_loss[0]) > 0.0


def test_the_upper_side_has_the_law_that_is_said_of_it_alone():
    """Elastic above, half an oscillation long; half the rate comes back below; as two stops are."""
    stiffness, speed, mass = 4e4, 0.7, 2.0
    below = {"stiffness": 1e4, "restitution": 0.5}
    upper = {"upper_stiffness": stiffness, "upper_law": "elastic"}
    one = EndStop(joint="j", lower=0.0, upper=0.3, **below, **upper)
    two = (
        EndStop(joint="j", lower=0.0, **below),
        EndStop(joint="j", upper=0.3, stiffness=stiffness, law="elastic"),
    )
    runs = [
        simulate(system("prismatic", "fixed", *stops), q=[0.1], v=[speed], duration=2.0, settings=TIGHT)
        for stops in ((one,), two)
    ]
    on, off = (changes(runs[0], f"upper: {what}") for what in ("on", "off"))
    # Tight tolerances leave 1e-9 s of a touch; found: 1e-12 s.
    assert off[:1] - on[:1] == pytest.approx(np.pi * np.sqrt(mass / stiffness), abs=1e-9)
    rates = runs[0].data.change_rate.values
    names = [name.partition(": ")[2] for name in runs[0].data.change.values]
    assert [rates[names.index(f"{side}: off")] for side in ("upper", "lower")] == pytest.approx(
        [-speed, 0.5 * speed], rel=1e-8
    )
    # Steps are cut alike; a stop that is off adds a zero.
    assert np.abs(runs[0].data.q.values[-1] - runs[1].data.q.values[-1]).max() < 1e-12
    assert one.words(True).endswith("; above stiffness 40\xa0kN/m, elastic")


def test_a_rigid_stop_may_send_back_less_above_than_below():
    """Blows at 0.2 s above, with a quarter of the rate, and 1.2 s later below, with half of that."""
    stop = RigidStop(joint="j", lower=0.0, upper=0.3, restitution=0.5, upper_restitution=0.25)
    run = simulate(system("prismatic", "fixed", stop), q=[0.1], v=[1.0], duration=2.0, settings=TIGHT)
    assert changes(run, "upper: bounces") == pytest.approx([0.2], abs=1e-11)
    assert changes(run, "lower: bounces") == pytest.approx([1.4], abs=1e-10)
    assert float(run.data.v.values[-1, 0]) == pytest.approx(0.125, rel=1e-12)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"upper_law": "kelvin-voigt"}, "upper_damping must be given; law kelvin-voigt needs it"),
        ({"upper_damping": 1.0}, "upper_damping must be left out: law exact-restitution takes restitution"),
        ({"upper_restitution": 1.5}, r"upper_restitution must be in \(0, 1\]; .*, got 1.5"),
        ({"upper_exponent": 1.5, "upper": None}, "upper_exponent must be left out where there is no upper"),
    ],
)
def test_an_upper_side_that_cannot_be_is_refused_by_name(more, said):
    given = {"lower": 0.0, "upper": 1.0, "stiffness": 1e4, "restitution": 0.5} | more
    with pytest.raises(AntennaPinError, match=said):
        EndStop(joint="j", **given)


def _mass(made, run, change):
    """Mass matrix where a change happened, without its reflected parts: of velocities."""
    import pinocchio as pin

    at = int(np.searchsorted(run.data.time.values, float(run.data.change_time[change])))
    model = made.mechanism.model
    mass = pin.crba(model, model.createData(), run.data.q.values[at])
    return np.triu(mass) + np.triu(mass, 1).T


def test_sides_count_whole_turns():
    """A joint without end meets a stop at 7.5 rad after more than a turn, at the first go."""
    stop = RigidStop(joint="j", upper=7.5, restitution=0.0)
    run = simulate(system("continuous", "fixed", stop), v=[3.0], duration=3.0, settings=TIGHT)
    assert list(run.data.change.values) == ["stop s0: upper: rests"]
    assert float(run.data.change_time[0]) == pytest.approx(2.5, abs=1e-12)
    assert float(run.data.motion_angle[-1, 0]) == pytest.approx(7.5, abs=1e-12)


def test_small_motions_are_those_of_the_touch():
    """Pressed in, a spring; off the stop, a free body."""
    from antenna_pin.studies.linear import modes

    made = falling(EndStop(joint="j", lower=0.0, stiffness=2000.0, law="elastic"))
    touching, free = (modes(made, q=[place]).frequency for place in (-2.0 * G / 2000.0, 0.1))
    assert touching == pytest.approx([np.sqrt(1000.0) / (2.0 * np.pi)], rel=1e-9)
    assert free == pytest.approx([0.0], abs=1e-9)


@pytest.mark.parametrize("law", ["exact-restitution", "carvalho-martins"])
@pytest.mark.parametrize("begins", ["pressed in", "switched on", "moved"])
def test_without_an_onset_a_stop_presses_out_by_its_elastic_part(law, begins):
    """At rest in a depth d, free on a slider: off after a quarter of an oscillation, with d sqrt(K / m)."""
    stiffness, depth, mass, at = 8000.0, 0.01, 2.0, 0.01
    stop = EndStop(joint="j", lower=0.0, stiffness=stiffness, law=law, restitution=0.5)
    events = ()
    if begins == "switched on":
        stop = dataclasses.replace(stop, on=False)
        events = (Event(name="on", when=Time(at), action=Set("stops.s0.on", True)),)
    elif begins == "moved":
        stop = dataclasses.replace(stop, lower=-1.0)
        events = (Event(name="moved", when=Time(at), action=Set("stops.s0.lower", 0.0)),)
    made, settings = system("prismatic", "fixed", stop), RunSettings(rtol=1e-8, max_step=0.05)
    run = simulate(made, q=[-depth], v=[0.0], duration=0.04, settings=settings, events=events)
    omega = np.sqrt(stiffness / mass)
    begin = at if events else 0.0
    # The tolerance of the run leaves 1e-8 of both.
    assert changes(run, "lower: off") == pytest.approx([begin + 0.5 * np.pi / omega], abs=1e-8)
    assert float(run.data.v.values[-1, 0]) == pytest.approx(depth * omega, rel=1e-6)


@pytest.mark.parametrize("law", ["exact-restitution", "carvalho-martins"])
@pytest.mark.parametrize("other", [False, True], ids=["same side", "other side"])
def test_a_stop_that_was_off_while_it_touched_has_no_onset(law, other):
    """Hit, switched off in the touch and on again deeper in: the rate of the hit scales no damping any more.

    It presses out by its elastic part: the greatest speed follows from the energy when it is switched on.
    """
    stiffness, mass, rate = 8000.0, 2.0, 0.3
    gap = 0.004 if other else 10.0
    stop = EndStop(joint="j", lower=0.0, upper=gap, stiffness=stiffness, law=law, restitution=0.5)
    if other:  # it touches below, flies past the upper side while it is off, and is switched on there
        q, v, off, on = [-0.001], [rate], 1e-4, 0.02
    else:
        q, v, off, on = [0.001], [-rate], 0.01, 0.03
    events = tuple(
        Event(name=str(t), when=Time(t), action=Set("stops.s0.on", value))
        for t, value in ((off, False), (on, True))
    )
    settings = RunSettings(rtol=1e-9, max_step=0.01, output_rate=1e4)
    run = simulate(
        system("prismatic", "fixed", stop), q=q, v=v, duration=0.15, settings=settings, events=events
    )
    where, speed = (np.interp(on, run.data.time, run.data[name].values[:, 0]) for name in ("q", "v"))
    depth = where - gap if other else -where
    expected = np.sqrt(speed**2 + stiffness / mass * depth**2)
    greatest = np.abs(run.data.v.values[run.data.time.values > on]).max()
    assert depth > 1e-3
    assert greatest == pytest.approx(expected, rel=1e-6)
    assert len(changes(run, "upper: off" if other else "lower: off")) == 1


def test_a_stop_that_was_off_has_the_onset_of_its_next_touch():
    """Pressed in at the start, off, on again between its sides: half of the next hit's rate comes back."""
    stop = EndStop(joint="j", lower=0.0, upper=0.004, stiffness=8000.0, restitution=0.5)
    events = [
        Event(name=str(t), when=Time(t), action=Set("stops.s0.on", value))
        for t, value in ((1e-4, False), (0.01, True))
    ]
    run = simulate(
        system("prismatic", "fixed", stop), q=[-0.001], v=[0.3], duration=0.07, settings=TIGHT, events=events
    )
    met = np.interp(0.01, run.data.time, run.data.v.values[:, 0])
    assert changes(run, "upper: off").size == 1
    assert float(run.data.v.values[-1, 0]) == pytest.approx(-0.5 * met, rel=1e-7)


def test_arms_of_a_fast_rotor_rest_on_their_stops():
    """Pressed on by 1e6 m/s^2, of which 1e-10 is left as round-off: no motion off the stops or into them.

    Nothing else turns the rotor: it goes on at its rate, with its momentum and its energy.
    """
    inertia = '<inertia ixx="{0}" iyy="{0}" izz="{0}" ixy="0" ixz="0" iyz="0"/>'
    arms, stops, rate = "", {}, 1000.0
    for k in range(6):
        turn, away = 0.7 + 1.03 * k, 0.3 + 0.07 * k
        arms += f"""<link name="l{k}"><inertial><origin xyz="{0.2 + 0.03 * k} 0 0"/>
            <mass value="{0.3 + 0.1 * k}"/>{inertia.format(0.01)}</inertial></link>
            <joint name="arm{k}" type="revolute"><parent link="hub"/><child link="l{k}"/><axis xyz="0 0 1"/>
            <origin xyz="{away * np.cos(turn)} {away * np.sin(turn)} 0" rpy="0 0 {turn}"/>
            <limit lower="-9" upper="9" effort="1e9" velocity="1e9"/></joint>"""
        stops[f"arm{k}"] = RigidStop(joint=f"arm{k}", lower=0.5, restitution=0.5)
    text = f"""<robot name="rotor"><link name="base"/><link name="hub"><inertial><mass value="5"/>
        {inertia.format(1.0)}</inertial></link><joint name="spin" type="revolute"><parent link="base"/>
        <child link="hub"/><axis xyz="0 0 1"/>
        <limit lower="-99" upper="99" effort="1e9" velocity="1e9"/></joint>{arms}</robot>"""
    mechanism = build_mechanism(Urdf.from_text(text, "rotor.urdf"), "fixed", (0.0, 0.0, 0.0))
    rotor = System(mechanism, elements={"stops": stops})
    slot = rotor.mechanism.joint("spin")
    q, v = np.full(7, 0.5), np.zeros(7)
    q[slot.q], v[slot.v] = 0.0, rate
    run = simulate(rotor, q=q, v=v, duration=0.01, settings=RunSettings(output_rate=1000.0))
    assert run.completed and not run.data.change.size
    angles = run.data.motion_angle.sel(joint=list(stops)).values
    assert angles == pytest.approx(np.full_like(angles, 0.5), abs=1e-13)
    turned = run.data.motion_angle.sel(joint="spin").values
    assert turned == pytest.approx(rate * run.data.time.values, rel=1e-12)
    assert np.abs(run.data.energy_error).max() < 1e-12 * run.data.kinetic_energy.values[0]
