"""Springs with hysteresis and harness tables: loop areas, energy, what they store, both engines."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import PchipInterpolator
from wheel import INERTIA, wheel_text, wheel_urdf

from antenna_pin import RunSettings, build_system, load_scenario, simulate
from antenna_pin.dynamics import System
from antenna_pin.elements import (
    BoucWen,
    ConstantSpring,
    HarnessSpring,
    JointSpring,
    MaxwellSlip,
    PrescribedMotion,
    TableSpring,
)
from antenna_pin.errors import AntennaPinError
from antenna_pin.mechanism import build_mechanism
from antenna_pin.run.simulation import Event, Set, Time
from antenna_pin.show.plot import allowed_figures, figure_hysteresis
from antenna_pin.studies.linear import modes
from antenna_pin.trajectory import Trajectory

TIGHT = RunSettings(rtol=1e-12, output_rate=50.0)
# Work of a motion [J]: 1e-12 of some J in each of some hundred steps.
LED = 1e-9
ANGLES = (-1.0, -0.4, 0.1, 0.6, 1.0)
UP = (1.5, 0.9, 0.2, -1.1, -2.0)
BACK = (1.8, 1.3, 0.5, -0.7, -1.5)


def _wheel(spring, **more):
    mechanism = build_mechanism(wheel_urdf("revolute"), "fixed")
    return System(mechanism, springs={"s": spring}, **more)


def _swung(spring, duration, amplitude=0.8, settings=TIGHT, frequency=0.5):
    """A joint led to and fro by a motion, with the spring."""
    motion = PrescribedMotion(joint="axle", amplitude=amplitude, frequency=frequency)
    rate = [2.0 * math.pi * frequency * amplitude]
    return simulate(
        _wheel(spring, drives={"m": motion}), q=[0.0], v=rate, duration=duration, settings=settings
    )


def _ledger(run):
    return float(np.abs(run.data["energy_error"]).max())


BOUC_WEN = BoucWen(joint="axle", alpha=0.2, stiffness=5.0, yield_angle=0.1, beta=0.6, gamma=0.3, exponent=1.5)


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_bouc_wen_against_another_integrator(engine):
    """A wheel swings on it: the same equations by SciPy, restarted where the wheel turns back."""
    spring = BOUC_WEN
    settings = RunSettings(rtol=1e-12, engine=engine)
    run = simulate(_wheel(spring), q=[0.0], v=[2.0], duration=3.0, settings=settings)

    def rates(t, y):
        q, v, z, lost = y
        stiff = spring.stiffness * spring.yield_angle * (1 - spring.alpha)
        yields = abs(z) ** spring.exponent * (spring.beta * abs(v) * math.copysign(1.0, z) + spring.gamma * v)
        torque = -spring.alpha * spring.stiffness * q - stiff * z
        return [v, torque / INERTIA, (v - yields) / spring.yield_angle, stiff * z * yields]

    def turns(t, y):
        return y[1]

    turns.terminal = True
    t, y, ends = 0.0, [0.0, 2.0, 0.0, 0.0], []
    while t < 3.0:
        turns.direction = -np.sign(y[1]) if abs(y[1]) > 1e-9 else np.sign(rates(t, y)[1]) * -1.0
        found = solve_ivp(rates, (t, 3.0), y, rtol=1e-12, atol=1e-13, events=turns, method="DOP853")
        ends.append(found)
        t, y = found.t[-1], found.y[:, -1]
    # Both integrate to 1e-12 a step, over some hundred steps of a motion of size 1.
    assert float(run.data["motion_angle"][-1, 0]) == pytest.approx(y[0], abs=1e-9)
    assert float(run.data["motion_rate"][-1, 0]) == pytest.approx(y[1], abs=1e-9)
    assert float(run.data["dissipation_damper"][-1, 0]) == pytest.approx(y[3], abs=1e-9)
    assert len(ends) == 3  # it has turned back twice
    assert _ledger(run) < 1e-9


def test_bouc_wen_passes_zero_without_an_error_of_the_step():
    """Back from its turn z falls with the way, to zero, and from there grows as on the way up; n = 1."""
    reach, width = 0.8, 0.2
    spring = BoucWen(joint="axle", alpha=0.1, stiffness=4.0, yield_angle=width)
    run = _swung(spring, 1.5, reach, settings=RunSettings(rtol=1e-8, output_rate=50.0))
    time, q = run.data["time"].values, run.data["motion_angle"].values[:, 0]
    most = 1.0 - np.exp(-reach / width)
    zero = reach - width * most
    back = np.where(q > zero, most - (reach - q) / width, np.exp(-(zero - q) / width) - 1.0)
    z = np.where(time <= 0.5, 1.0 - np.exp(-q / width), back)
    stored = 0.5 * 4.0 * (0.1 * q**2 + 0.9 * (width * z) ** 2)
    # A step over the kink has an error of 2e-9; those that end there follow the motion to round-off.
    np.testing.assert_allclose(run.data["spring_energy"], stored, rtol=0, atol=1e-13)


@pytest.mark.parametrize("outside", ["hold", "extend"])
@pytest.mark.parametrize("interpolation", ["cubic", "linear"])
def test_a_table_conserves_energy_within_and_beyond(outside, interpolation):
    """A wheel thrown through both ends of the table: its energy is that of the table's integral."""
    table = TableSpring(joint="axle", angle=ANGLES, torque=UP, outside=outside, interpolation=interpolation)
    run = simulate(_wheel(table), q=[0.0], v=[3.2], duration=4.0, settings=TIGHT)
    q, v = run.data["motion_angle"].values[:, 0], run.data["motion_rate"].values[:, 0]
    assert q.max() > 1.05 and q.min() < -1.05
    curve = PchipInterpolator(ANGLES, UP) if interpolation == "cubic" else None

    def torque(x):
        inside = min(max(x, -1.0), 1.0)
        value = float(curve(inside)) if curve else float(np.interp(inside, ANGLES, UP))
        if outside == "extend":
            end = 1e-9 if x < 0 else -1e-9
            slope = (
                float(curve(inside, 1))
                if curve
                else (np.interp(inside + end, ANGLES, UP) - np.interp(inside, ANGLES, UP)) / end
            )
            value += slope * (x - inside)
        return value

    for k in (int(q.argmax()), int(q.argmin())):
        given = quad(torque, 0.0, q[k], points=[a for a in ANGLES if a != 0], limit=200, epsabs=1e-12)[0]
        # Of the quadrature, and of a slope by a difference of 1e-9 over 0.5 rad.
        assert 0.5 * INERTIA * (v[k] ** 2 - 3.2**2) == pytest.approx(given, abs=3e-7 if not curve else 1e-9)
    # The curvature jumps at points: a step over one has the error that its tolerance allows.
    assert _ledger(run) < 1e-9


def test_a_run_ends_where_its_table_does():
    table = TableSpring(joint="axle", angle=ANGLES, torque=UP, outside="refuse")
    run = simulate(_wheel(table), q=[0.0], v=[3.2], duration=4.0, settings=TIGHT)
    assert float(run.data["motion_angle"][-1, 0]) == pytest.approx(1.0, abs=1e-10)
    assert "spring 's' has no torque beyond 1" in repr(run)
    with pytest.raises(
        AntennaPinError, match=r"spring 's': angle must be a table that covers the start, at 1.2"
    ):
        simulate(_wheel(table), q=[1.2], v=[0.0], duration=0.1)


def test_heat_of_a_harness_is_what_lies_between_its_tables():
    """Rate does not count: on a way z is 1 - 2 exp(-way / delta), and the heat of a cycle H z on the way."""
    reach, reversal = 0.8, 0.02
    half = [0.5 * (back - up) for up, back in zip(UP, BACK, strict=True)]
    curve = PchipInterpolator(ANGLES, half)

    def both_ways(x):
        left_out = math.exp((-reach - x) / reversal) + math.exp((x - reach) / reversal)
        return float(curve(x)) * (2.0 - 2.0 * left_out)

    points = [-0.7, *ANGLES[1:-1], 0.7]
    area = quad(both_ways, -reach, reach, points=points, epsabs=1e-13, limit=400)[0]
    harness = HarnessSpring(
        joint="axle", angle=ANGLES, torque=UP, torque_back=BACK, reversal=reversal, start=1.0
    )
    run = _swung(harness, 5.0)
    time, heat = run.data["time"].values, run.data["dissipation_damper"].values[:, 0]
    # From turn to turn, where nothing moves: interpolation does no harm.
    each = float(np.diff(heat[np.searchsorted(time, [2.5 - 1e-12, 4.5 - 1e-12])])[0])
    assert each == pytest.approx(area, rel=1e-8)
    assert _ledger(run) < LED


@pytest.mark.parametrize(
    ("given", "q", "acts"),
    [
        ({"torque": 0.3}, 5.0, 0.3),
        ({"torque": 0.3, "upper": 1.0}, 1.0 + 5e-4, 0.15),
        ({"torque": -0.3, "lower": 0.2, "upper": 1.0}, 0.5, -0.3),
        ({"torque": -0.3, "lower": 0.2}, 0.1, 0.0),
    ],
)
def test_constant_torque_within_its_ends(given, q, acts):
    spring = ConstantSpring(joint="axle", **given)
    assert spring.own_kernel("effort")(0.0, q, 0.0) == pytest.approx(acts, abs=1e-12)


def test_a_tape_unrolls():
    """Work of a constant torque over the way to its end is all the energy that the wheel has then."""
    spring = ConstantSpring(joint="axle", torque=0.5, upper=1.0, ramp=0.01)
    run = simulate(_wheel(spring), q=[0.0], v=[0.0], duration=3.0, settings=TIGHT)
    rate = float(run.data["motion_rate"][-1, 0])
    assert 0.5 * INERTIA * rate**2 == pytest.approx(0.5 * 1.005, rel=1e-10)
    assert float(run.data["spring_energy"][-1]) == pytest.approx(0.0, abs=1e-12)
    assert _ledger(run) < 1e-11


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (
            lambda: BoucWen(joint="a", alpha=1.5, stiffness=1.0, yield_angle=1.0),
            "alpha must be from 0 to 1, got 1.5",
        ),
        (
            lambda: BoucWen(joint="a", alpha=0.5, stiffness=1.0, yield_angle=1.0, gamma=0.9),
            "gamma must be at most beta = 0.5 in size",
        ),
        (
            lambda: BoucWen(joint="a", alpha=0.5, stiffness=1.0, yield_angle=1.0, start=2.0),
            "start must be at most 1 in size, where z ends, got 2.0",
        ),
        (lambda: TableSpring(joint="a", angle=(0.0, 0.0), torque=(1.0, 2.0)), r"angle\[1\] must be above"),
        (
            lambda: HarnessSpring(
                joint="a", angle=(0.0, 1.0), torque=(1.0, 2.0), torque_back=(1.0, 1.5), reversal=0.1
            ),
            r"torque_back\[1\] must be at least torque there, 2.0",
        ),
        (
            lambda: ConstantSpring(joint="a", torque=1.0, lower=1.0, upper=0.5),
            "upper must be above lower = 1",
        ),
    ],
)
def test_refusals(make, says):
    with pytest.raises(ValueError, match=says):
        make()


# --- Maxwell ---


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_heat_of_slipping_springs_is_the_loop_in_closed_form(engine):
    """4 s (X - s/k) of each that slips, in a cycle of amplitude X; one is never bent as far."""
    springs = MaxwellSlip(joint="axle", stiffness=(4.0, 2.0, 1.0), slip=(0.4, 1.0, 5.0))
    settings = RunSettings(rtol=1e-12, output_rate=50.0, engine=engine)
    run = _swung(springs, 6.0, settings=settings)
    time, heat = run.data["time"].values, run.data["dissipation_damper"].values[:, 0]
    each = np.diff(heat[np.searchsorted(time, [2.0 - 1e-12, 4.0 - 1e-12])])[0]
    assert each == pytest.approx(4.0 * 0.4 * (0.8 - 0.1) + 4.0 * 1.0 * (0.8 - 0.5), rel=1e-9)
    assert _ledger(run) < LED
    # Skeleton: up to the first turn each is bent by the angle, at most as far as it can be.
    first = time <= 0.5
    q = run.data["motion_angle"].values[first, 0]
    stored = 0.5 * (4.0 * np.minimum(q, 0.1) ** 2 + 2.0 * np.minimum(q, 0.5) ** 2 + q**2)
    np.testing.assert_allclose(run.data["spring_energy"].values[first], stored, rtol=0, atol=1e-12)


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_a_wheel_slips_once_and_then_swings_for_ever(engine):
    """It stops after I v1^2 / 2 s of slip, and swings from there by s/k: it grazes slipping in each swing."""
    k, s, v0 = 3.0, 0.6, 1.5
    springs = MaxwellSlip(joint="axle", stiffness=(k,), slip=(s,))
    settings = RunSettings(rtol=1e-12, output_rate=50.0, engine=engine)
    run = simulate(_wheel(springs), q=[0.3], v=[v0], duration=8.0, settings=settings)
    reach, omega = s / k, math.sqrt(k / INERTIA)
    v1 = math.sqrt(v0**2 - k * reach**2 / INERTIA)
    begin = math.asin(reach * omega / v0) / omega
    end = begin + INERTIA * v1 / s
    middle = 0.3 + INERTIA * v1**2 / (2.0 * s)
    time, q = run.data["time"].values, run.data["motion_angle"].values[:, 0]
    later = time > end
    expected = middle + reach * np.cos(omega * (time - end))
    np.testing.assert_allclose(q[later], expected[later], rtol=0, atol=1e-9)
    assert float(run.data["dissipation_damper"][-1, 0]) == pytest.approx(0.5 * INERTIA * v1**2, rel=1e-8)
    assert _ledger(run) < 1e-10


@pytest.mark.slow
def test_slipping_springs_swing_out_to_rest_with_damping():
    """They hold what the last swing has left them: at rest nothing happens any more, and nothing creeps."""
    springs = MaxwellSlip(joint="axle", stiffness=(3.0, 6.0), slip=(0.6, 0.3))
    system = System(
        build_mechanism(wheel_urdf("revolute"), "fixed"),
        springs={"s": springs, "d": JointSpring(joint="axle", damping=3.0)},
    )
    run = simulate(system, q=[0.0], v=[2.0], duration=600.0)
    q = run.data["motion_angle"].values[:, 0]
    assert q[-1] == pytest.approx(q[-len(q) // 4], abs=1e-12)
    assert abs(float(run.data["motion_rate"][-1, 0])) < 1e-12


def test_slipping_springs_that_are_off_do_nothing():
    """Switched on again they pull no more than slips."""
    springs = MaxwellSlip(joint="axle", stiffness=(4.0, 2.0), slip=(0.4, 1.0), rest_angle=0.2)
    off = _wheel(dataclasses.replace(springs, on=False))
    run = simulate(
        off,
        q=[0.0],
        v=[1.0],
        duration=3.0,
        settings=TIGHT,
        events=[Event(name="on", when=Time(1.5), action=Set("springs.s.on", True))],
    )
    time, rate = run.data["time"].values, run.data["motion_rate"].values[:, 0]
    np.testing.assert_allclose(rate[time < 1.5], 1.0, rtol=0, atol=1e-14)
    # From 1.5 rad on both slip until the wheel stands.
    slipping = (time > 1.5) & (time < 1.5 + INERTIA / 1.4)
    np.testing.assert_allclose(
        rate[slipping], 1.0 - 1.4 / INERTIA * (time[slipping] - 1.5), rtol=0, atol=1e-10
    )
    assert _ledger(run) < 1e-10


# --- with the rest ---


def test_modes_swing_on_the_stiffness_of_the_start():
    """At rest Bouc-Wen is a spring of stiffness k, slipping springs are all of them, a table has a slope."""
    wen = BoucWen(joint="axle", alpha=0.2, stiffness=5.0, yield_angle=0.1)
    slip = MaxwellSlip(joint="axle", stiffness=(4.0, 2.0), slip=(0.4, 1.0))
    table = TableSpring(joint="axle", angle=(-1.0, 1.0), torque=(3.0, -3.0))
    for spring, stiffness in ((wen, 5.0), (slip, 6.0), (table, 3.0)):
        found = modes(_wheel(spring), q=[0.0])
        # Of central differences of sixth order.
        assert 2.0 * math.pi * found.frequency[-1] == pytest.approx(math.sqrt(stiffness / INERTIA), rel=1e-9)


@pytest.mark.parametrize("kind", ["table", "harness"])
def test_tables_stand_in_files(tmp_path, kind):
    """As those of drives; what is wrong is told with file and line."""
    (tmp_path / "wheel.urdf").write_text(wheel_text("revolute"))
    both = kind == "harness"
    rows = [*zip(ANGLES, UP, BACK, strict=True)] if both else [*zip(ANGLES, UP, strict=True)]
    header = "angle,torque,torque_back" if both else "angle,torque"
    lines = [header, *(",".join(map(repr, row)) for row in rows)]
    (tmp_path / "cable.csv").write_text("\n".join(lines))
    (tmp_path / "scenario.toml").write_text(
        'format = 1\nduration = "1 s"\n[mechanism]\nurdf = "wheel.urdf"\nbase = "fixed"\n'
        f'[springs.axle]\nkind = "{kind}"\nfile = "cable.csv"\n' + ("reversal = 0.1\n" if both else "")
    )
    spring = build_system(load_scenario(tmp_path / "scenario.toml")).springs["axle"]
    assert spring.angle == ANGLES and spring.torque == UP
    assert not both or spring.torque_back == BACK
    assert "of cable.csv: 5 points from" in spring.words(slides=False)
    (tmp_path / "cable.csv").write_text("\n".join([*lines, lines[-1]]))
    with pytest.raises(AntennaPinError, match=r"line 7: angle must increase strictly, got 1.0 after 1"):
        load_scenario(tmp_path / "scenario.toml")
    with pytest.raises(AntennaPinError, match=r"must have either file, or angle.* and torque.*, got both"):
        load_scenario(tmp_path / "scenario.toml", overrides=["springs.axle.angle=[0, 1]"])


def test_results_tell_the_torque_and_a_figure_shows_it(tmp_path):
    """Also read back: what a table stores may be below zero."""
    spring = TableSpring(joint="axle", angle=ANGLES, torque=UP)
    run = _swung(spring, 0.5)
    angle = run.data["motion_angle"].values[:, 0]
    np.testing.assert_allclose(
        run.data["spring_torque"].values[:, 0], PchipInterpolator(ANGLES, UP)(angle), rtol=0, atol=1e-12
    )
    assert run.data["traced_joint"].values.tolist() == ["axle"]
    run.save(tmp_path / "run.nc")
    assert float(Trajectory.load(tmp_path / "run.nc").data["spring_energy"].min()) < 0.0
    assert "hysteresis" in [one.figure.name for one in allowed_figures([run])]
    (axes,) = figure_hysteresis([run]).axes
    drawn = axes.lines[0].get_xydata()
    np.testing.assert_allclose(drawn[:, 0], angle, rtol=0, atol=1e-12)


def test_what_says_how_a_spring_starts_is_not_set_later():
    set_start = Event(name="late", when=Time(0.1), action=Set("springs.s.start", 0.5))
    with pytest.raises(AntennaPinError, match="'start'"):
        simulate(_wheel(BOUC_WEN), q=[0.0], v=[1.0], duration=0.2, events=[set_start])


def _loops(amplitude, rtol, engine):
    """A wheel that turns without end led to and fro with a spring that slips at 0.12 N m, three times."""
    spring = MaxwellSlip(joint="axle", stiffness=(6.0,), slip=(0.12,))
    motion = PrescribedMotion(joint="axle", amplitude=amplitude, frequency=1.0)
    system = System(
        build_mechanism(wheel_urdf("continuous"), "fixed"), springs={"s": spring}, drives={"m": motion}
    )
    settings = RunSettings(rtol=rtol, output_rate=20.0, engine=engine)
    v = [2.0 * math.pi * amplitude]
    return simulate(system, q=[1.0, 0.0], v=v, duration=3.3, settings=settings)


def _check_loops(amplitude, rtol, engine="compiled"):
    run = _loops(amplitude, rtol, engine)
    assert run.completed
    times = run.data.time.values.tolist()
    work = run.data.drive_work.values[:, 0]
    cycle = work[times.index(2.25)] - work[times.index(1.25)]
    # Between two turning points the wheel's own energy is that again; works are led to round-off.
    assert cycle == pytest.approx(4.0 * 0.12 * (amplitude - 0.02), abs=1e-12)


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
def test_a_loop_that_begins_where_it_turns_back_but_for_round_off(engine):
    """Dense output is zero at a step's beginning to another last digit than the state itself."""
    _check_loops(0.0981, 1e-9, engine)


@pytest.mark.parametrize("amplitude", np.linspace(0.021, 0.4, 4))
def test_loops_of_any_size(amplitude):
    _check_loops(float(amplitude), 1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("rtol", [1e-8, 1e-9, 1e-10, 1e-11, 1e-12])
def test_loops_of_sixty_sizes(rtol):
    """Of these two to six found no end of their first slip."""
    for amplitude in np.linspace(0.021, 0.4, 60).tolist():
        _check_loops(amplitude, rtol)
