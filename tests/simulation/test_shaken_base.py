"""A shaken base: a mass on a spring against closed forms, loads, ledger, engines, two halves, refusals."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from antenna_pin import RunSettings, System, Urdf, build_mechanism, load_scenario, simulate
from antenna_pin.analysis import base_loads, quantity, shaken_link
from antenna_pin.dynamics import assembled
from antenna_pin.elements import JointSpring, SineShake, SweepShake
from antenna_pin.errors import AntennaPinError
from antenna_pin.mechanism import with_shaken_base

STIFFNESS, DAMPING, MASS, FIXTURE, LEVER = 2000.0, 6.0, 0.5, 2.0, 0.15
OMEGA, ZETA = math.sqrt(STIFFNESS / MASS), DAMPING / (2 * math.sqrt(STIFFNESS * MASS))
G = 9.80665
RIG = f"""<robot name="rig">
  <link name="fixture"><inertial><mass value="{FIXTURE}"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="fixture"/><child link="mass"/><origin xyz="0 0 0.05"/>
    <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <link name="mass"><inertial><origin xyz="0 0 0.1"/><mass value="{MASS}"/>
    <inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""
SCENARIO = f"""format = 1
duration = "1 s"
[mechanism]
urdf = "rig.urdf"
base = "fixed"
gravity = [0, 0, -{G}]
[springs.slide]
stiffness = {STIFFNESS}
damping = {DAMPING}
[integrator]
rtol = 1e-12
"""
SINE = '[shake.x]\nkind = "sine"\ndirection = [1, 0, 0]\nacceleration = "1 g"\nfrequency = "8 Hz"\n'


@pytest.fixture
def scenario(tmp_path):
    """Write and load a scenario of the rig, with tables behind it."""
    (tmp_path / "rig.urdf").write_text(RIG)

    def load(tables=SINE, **overrides):
        path = tmp_path / "scenario.toml"
        path.write_text(SCENARIO + tables)
        return load_scenario(path, overrides=overrides)

    return load


def closed_form(t):
    """Relative displacement under a = -G sin(w t) of a mass that begins to move with the base."""
    w = 2 * math.pi * 8
    swing = G / (OMEGA**2 - w**2 + 2j * ZETA * OMEGA * w)  # of z'' + ... = G sin(w t)
    steady = (swing * np.exp(1j * w * t)).imag
    damped = OMEGA * math.sqrt(1 - ZETA**2)
    first, rate = -swing.imag, -(1j * w * swing).imag
    free = first * np.cos(damped * t) + (rate + ZETA * OMEGA * first) / damped * np.sin(damped * t)
    return steady + np.exp(-ZETA * OMEGA * t) * free


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_a_mass_on_a_spring_on_a_base_that_swings(scenario, engine):
    """Displacement, force and moment at the base, and the work that is put in, against closed forms."""
    run = simulate(scenario(**{"integrator.engine": engine}))
    data, t = run.data, run.data.time.values
    z = data.q.values[:, 1]
    expected = closed_form(t)
    assert np.abs(z - expected).max() < 1e-9 * np.abs(expected).max()  # steps good to 1e-12, 250 of them
    base, mass = (quantity(run, f"body_acceleration[{one}].x").values for one in ("fixture", "mass"))
    assert base == pytest.approx(-G * np.sin(2 * math.pi * 8 * t), abs=1e-10 * G)
    loads = base_loads(run)
    force, moment = loads.force.values, loads.moment.values
    needed = FIXTURE * base + MASS * mass
    assert np.abs(force[:, 0] - needed).max() < 1e-10 * np.abs(needed).max()
    assert np.abs(force[:, 2] - (FIXTURE + MASS) * G).max() < 1e-12 * G * 2.5
    about = LEVER * MASS * mass - z * MASS * G
    assert np.abs(moment[:, 1] - about).max() < 1e-10 * np.abs(about).max()
    assert np.abs(data.drive_torque.values[:, 0] - force[:, 0]).max() < 1e-10 * np.abs(force).max()
    # Work of the base: the integral of force times velocity, which steps have to 1e-9.
    assert float(np.abs(data.energy_error).max()) < 1e-8 * float(data.kinetic_energy.max())
    assert shaken_link(run) == "fixture"


def test_a_sweep_up_and_down_against_an_independent_solution(scenario):
    """Its own formulas of the base's acceleration, SciPy's DOP853 from junction to junction."""
    given = {"start_frequency": 5.0, "end_frequency": 20.0, "octaves_per_minute": 40.0, "dwell": 0.2}
    keys = "".join(f"{name} = {value}\n" for name, value in given.items())
    table = f'[shake.x]\nkind = "sweep"\ndirection = [1, 0, 0]\nacceleration = 2.0\nback = true\n{keys}'
    run = simulate(scenario(table, duration=7.0))
    first, last = (2 * math.pi * f for f in (5.0, 20.0))
    halves = round((last - first) / (math.log(2.0) * 40.0 / 60.0) / math.pi)
    growth = (last - first) / (halves * math.pi)
    up = math.log(4.0) / growth
    stays = math.ceil(0.2 * last / math.pi)
    ends = [0.0, up, up + stays * math.pi / last, 2 * up + stays * math.pi / last, 7.0]
    parts = [(first, growth, 1), (last, 0.0, (-1) ** halves), (last, -growth, (-1) ** (halves + stays))]
    parts.append((first, 0.0, (-1) ** (2 * halves + stays)))

    def base(s, omega, rate, sign):
        w = omega * math.exp(rate * s)
        phase = omega * math.expm1(rate * s) / rate if rate else omega * s
        # x = 2 / w^2 sin(phase), w' = rate w.
        return sign * (
            (8 * rate**2 / w**2 - 2.0) * math.sin(phase) + (-8 * rate / w + 2 * rate / w) * math.cos(phase)
        )

    t, y, found = run.data.time.values, np.zeros(2), []
    for (omega, rate, sign), a, b in zip(parts, ends[:-1], ends[1:], strict=True):

        def slope(s, y, own=(omega, rate, sign)):
            return [y[1], -base(s, *own) - OMEGA**2 * y[0] - 2 * ZETA * OMEGA * y[1]]

        here = t[(t >= a) & (t < b)] if b < 7.0 else t[t >= a]
        options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-16, "max_step": 0.01}
        times = np.union1d(here - a, [b - a])
        solved = solve_ivp(slope, (0.0, b - a), y, t_eval=times, **options)
        found.append(solved.y[0][np.isin(times, here - a)])
        y = solved.y[:, -1]
    expected = np.concatenate(found)
    z = run.data.q.values[:, 1]
    assert np.abs(z - expected).max() < 1e-9 * np.abs(expected).max()  # steps good to 1e-12, thousands


def test_a_base_that_turns_about_a_point():
    """Torque on a rigid body about a fixed axis: its moment of inertia there times the acceleration."""
    shake = SineShake(joint="turn", axis=(0, 0, 1), point=(0.4, 0.0, 0.0), frequency=5.0, displacement=0.02)
    urdf = with_shaken_base(Urdf.from_text(RIG, "rig"), {"turn": shake})
    system = System(
        build_mechanism(urdf.variant(joints={"slide": "locked"}), "fixed"), drives={"turn": shake}
    )
    q, v = assembled(system, system.neutral())
    assert v == pytest.approx([0.02 * 10 * math.pi], rel=1e-14)  # it begins as the motion says
    run = simulate(system, duration=0.2, q=q, v=v, settings=RunSettings(rtol=1e-10))
    t = run.data.time.values
    omega = 10 * math.pi
    inertia = 0.1 + 0.001 + (FIXTURE + MASS) * 0.4**2
    torque = -inertia * 0.02 * omega**2 * np.sin(omega * t)
    assert np.abs(run.data.drive_torque.values[:, 0] - torque).max() < 1e-12 * np.abs(torque).max()
    loads = base_loads(run)
    # About the base's own frame, a lever of 0.4 m away, and turned with it.
    r = np.array([-0.4, 0.0])
    angle = 0.02 * np.sin(omega * t)
    rate, bend = 0.02 * omega * np.cos(omega * t), -0.02 * omega**2 * np.sin(omega * t)
    across, outward = (FIXTURE + MASS) * r[0] * bend, -(FIXTURE + MASS) * r[0] * rate**2
    assert np.abs(loads.force.values[:, 1] - across).max() < 1e-12 * np.abs(across).max()
    assert np.abs(loads.force.values[:, 0] - outward).max() < 1e-11 * np.abs(outward).max()
    assert np.abs(loads.moment.values[:, 2] - 0.101 * bend).max() < 1e-11 * np.abs(0.101 * bend).max()
    assert run.data.q.values[:, 0] == pytest.approx(angle, abs=1e-12)  # to what rows are corrected


def test_ways_at_once_are_each_their_own():
    """Along x and y at once the mass that slides along x feels the first alone."""
    way = {"x": (1, 0, 0), "y": (0.0, 1.0, 0.0)}
    sweep = {"start_frequency": 5.0, "end_frequency": 15.0, "hertz_per_second": 10.0, "velocity": 0.1}
    shakes = {name: SweepShake(joint=name, direction=one, **sweep) for name, one in way.items()}
    ends = []
    for chosen in (["x"], ["x", "y"]):
        own = {name: shakes[name] for name in chosen}
        urdf = with_shaken_base(Urdf.from_text(RIG, "rig"), own)
        springs = {"slide": JointSpring(joint="slide", stiffness=STIFFNESS, damping=DAMPING)}
        system = System(build_mechanism(urdf, "fixed"), drives=own, springs=springs)
        q, v = assembled(system, system.neutral())
        run = simulate(system, duration=0.5, q=q, v=v, settings=RunSettings(rtol=1e-11))
        ends.append(run.data.q.values[-1, -1])
    assert ends[0] == pytest.approx(ends[1], rel=1e-8)  # steps differ


REFUSED = {
    "a free base": ({"mechanism.base": "free", "mechanism.gravity": [0, 0, 0]}, 'base must be "fixed"'),
    "units": ({"shake.x.acceleration": "3 rad/s^2"}, "units must be those of a translation"),
    "a gram": ({"shake.x.frequency": "8 g"}, "must be a frequency [Hz], got '8 g'"),
    "no direction": ({"shake.x.direction": [0, 0, 0]}, "shake.x.direction must be"),
    "a massless base": (
        {"mechanism.links.fixture.mass": 0, "mechanism.links.fixture.inertia": [0, 0, 0]},
        "mass",
    ),
    "a drive's name": ({"drives.x": {"kind": "constant", "joint": "slide", "value": 1}}, "another name"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_does_not_go_together_is_refused_in_one_line(scenario, name):
    changes, words = REFUSED[name]
    with pytest.raises(AntennaPinError) as error:
        simulate(scenario(**changes), duration=0.01)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_g_is_standard_gravity_where_an_acceleration_is_asked_for(scenario):
    assert scenario().shake["x"].acceleration == pytest.approx(G, rel=1e-15)
    assert scenario(**{"shake.x.acceleration": "500 mm/s^2"}).shake["x"].acceleration == 0.5
