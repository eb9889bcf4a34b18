"""References: derivatives, limits that are reached and kept, ends, and what follows them."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from antenna_pin import System, Urdf, build_mechanism, load_scenario, simulate
from antenna_pin.base.settings import RunSettings
from antenna_pin.elements import (
    REFERENCES,
    Chirp,
    Constant,
    PDController,
    Polynomial,
    PrescribedMotion,
    Ramp,
    RestToRest,
    SCurve,
    Sine,
    Sines,
    Sum,
    Table,
    Trapezoid,
)
from antenna_pin.errors import AntennaPinError, InvalidParameterError, ScenarioError

SLEWS = {
    "trapezoid": Trapezoid(end=2.0, rate=0.5, acceleration=0.3),
    "triangle": Trapezoid(begin=1.0, end=0.9, rate=0.5, acceleration=0.3, deceleration=0.1, start=0.2),
    "s-curve of seven parts": SCurve(end=2.0, rate=0.5, acceleration=0.3, jerk=1.0),
    "s-curve that reaches no limit": SCurve(end=-0.05, rate=0.5, acceleration=0.3, jerk=1.0),
    "s-curve that reaches no rate": SCurve(end=0.5, rate=5.0, acceleration=0.3, jerk=1.0),
    "s-curve that reaches no acceleration": SCurve(end=3.0, rate=0.05, acceleration=3.0, jerk=1.0),
    "cubic": RestToRest(end=1.0, duration=2.0, shape="cubic"),
    "quintic": RestToRest(end=1.0, duration=2.0),
    "septic": RestToRest(begin=0.5, end=-1.0, duration=2.0, start=0.3, shape="septic"),
    "cycloid": RestToRest(begin=0.5, end=1.0, duration=2.0, shape="cycloid"),
}
OTHERS = {
    "constant": Constant(value=0.7),
    "ramp": Ramp(begin=0.1, rate=0.2, start=0.5, duration=1.0),
    "polynomial": Polynomial(coefficients=(0.1, -0.2, 0.3, 0.05), start=0.4),
    "sine": Sine(mean=0.2, amplitude=0.5, frequency=0.7, phase=0.3),
    "linear chirp": Chirp(amplitude=0.5, first=0.5, last=2.0, duration=3.0, start=0.5, phase=0.2),
    "falling chirp": Chirp(amplitude=0.5, first=2.0, last=0.5, duration=3.0, spacing="logarithmic"),
    "chirp of one frequency": Chirp(amplitude=1.0, first=1.0, last=1.0, duration=1.0, spacing="logarithmic"),
    "sines": Sines(amplitudes=(0.1, 0.2), frequencies=(0.5, 1.3), phases=(0.0, 1.0)),
    "spline that comes again": Table(time=(0, 1, 2, 3), values=(0, 1, -1, 0), periodic=True),
    "cubics": Table(time=(-1, 1, 2, 9), values=(0, 1, -1, 0), interpolation="cubic"),
}
EVERY = {**SLEWS, **OTHERS, "sum": Sum(parts=(SLEWS["cycloid"], OTHERS["sine"]))}


def known_everywhere(reference):
    """Times at which it is looked at, none where a derivative jumps."""
    times = np.linspace(-0.4, 8.0, 211) + 1e-4
    jumps = np.array([*reference.instants, *range(10)])  # where tables have their points
    return times[np.abs(times[:, None] - jumps).min(axis=1) > 1e-3]


def test_every_kind_is_here():
    assert {type(one) for one in EVERY.values()} == set(REFERENCES.values())


@pytest.mark.parametrize("name", EVERY)
def test_rate_and_acceleration_are_the_derivatives(name):
    """By central differences of fourth order: the rest is h^4 times a fifth derivative."""
    at, h = EVERY[name].over_time(), 1e-3
    for t in known_everywhere(EVERY[name]):
        value, rate, acceleration = at(t)
        for k, exact in ((0, rate), (1, acceleration)):
            far, near = (at(t + n * h)[k] - at(t - n * h)[k] for n in (2, 1))
            assert exact == pytest.approx((8.0 * near - far) / (12.0 * h), abs=1e-7), (t, k)
        assert math.isfinite(value)


@pytest.mark.parametrize("name", SLEWS)
def test_a_slew_goes_from_rest_at_its_begin_to_rest_at_its_end(name):
    slew = SLEWS[name]
    assert slew.at(slew.start - 1.0) == (slew.begin, 0.0, 0.0)
    for t in (slew.start + slew.duration + 1e-9, 1e3, 1e9):
        assert slew.at(t) == (slew.end, 0.0, 0.0)
    # The last part ends where it is to but for round-off, in place and rate.
    value, rate, _ = slew.at((slew.start + slew.duration) * (1.0 - 1e-15))
    assert value == pytest.approx(slew.end, abs=1e-12) and rate == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", SLEWS)
def test_the_area_under_the_rate_is_the_way(name):
    slew, at = SLEWS[name], SLEWS[name].over_time()
    inner = [t for t in slew.instants if slew.start < t < slew.start + slew.duration]
    area, _ = quad(lambda t: at(t)[1], slew.start, slew.start + slew.duration, points=inner, epsabs=1e-12)
    assert area == pytest.approx(slew.end - slew.begin, abs=1e-10)


@pytest.mark.parametrize("name", [name for name in SLEWS if hasattr(SLEWS[name], "rate")])
def test_limits_are_kept_and_one_of_them_is_always_reached(name):
    """Else it would not be the fastest: bang-bang in its highest derivative, cut off by the others."""
    slew, at = SLEWS[name], SLEWS[name].over_time()
    t = np.unique(np.concatenate([np.linspace(slew.start, slew.start + slew.duration, 4001), slew.instants]))
    _, rate, acceleration = np.abs(np.array([at(one) for one in t])).T
    assert rate.max() <= slew.rate * (1.0 + 1e-12)
    assert acceleration.max() <= slew.acceleration * (1.0 + 1e-12)
    sizes = [abs(highest) for _, highest in slew.phases() if highest != 0.0]
    if isinstance(slew, SCurve):
        assert sizes == [slew.jerk] * len(sizes)
        reaches = (
            rate.max() >= slew.rate * (1.0 - 1e-9),
            acceleration.max() >= slew.acceleration * (1.0 - 1e-9),
        )
        said = ("no limit" not in name and "no rate" not in name, "seven" in name or "no rate" in name)
        assert reaches == said
    else:
        assert (rate.max() >= slew.rate * (1.0 - 1e-12)) == (name == "trapezoid")


def test_durations_of_a_trapezoid_and_an_s_curve_in_closed_form():
    """way / v + v / a, and with a jerk a / j more."""
    assert SLEWS["trapezoid"].duration == pytest.approx(2.0 / 0.5 + 0.5 / 0.3, rel=1e-14)
    assert SLEWS["s-curve of seven parts"].duration == pytest.approx(2.0 / 0.5 + 0.5 / 0.3 + 0.3, rel=1e-14)
    # Of a way too short for any limit: four parts of (way / 2 j)^(1/3).
    short = SLEWS["s-curve that reaches no limit"]
    assert short.duration == pytest.approx(4.0 * (0.05 / 2.0) ** (1.0 / 3.0), rel=1e-14)


@pytest.mark.parametrize("name", ["linear chirp", "falling chirp"])
def test_the_angle_of_a_chirp_is_the_integral_of_its_frequency(name):
    chirp = OTHERS[name]

    def frequency(s):
        share = min(s / chirp.duration, 1.0)
        if chirp.spacing == "linear":
            return chirp.first + (chirp.last - chirp.first) * share
        return chirp.first * (chirp.last / chirp.first) ** share

    for t in (0.8, 1.9, 3.4, 5.0):
        turns, _ = quad(frequency, 0.0, t - chirp.start, points=[chirp.duration], epsabs=1e-13, limit=200)
        value = chirp.amplitude * math.sin(2.0 * math.pi * turns + chirp.phase)
        assert chirp.at(t)[0] == pytest.approx(value, abs=1e-11)
    assert OTHERS["falling chirp"].octaves_a_minute == pytest.approx(-40.0, rel=1e-14)


def test_a_spline_that_comes_again_is_smooth_where_it_does():
    again = OTHERS["spline that comes again"]
    before, after = again.at(3.0 - 1e-9), again.at(3.0 + 1e-9)
    assert before == pytest.approx(after, abs=1e-7)
    assert again.at(1.3 + 5 * 3.0) == pytest.approx(again.at(1.3), abs=1e-12)


HINGE = """<robot name="r"><link name="base"/><link name="bar"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="0.4" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="axle" type="continuous"><parent link="base"/><child link="bar"/><axis xyz="0 0 1"/></joint>
</robot>"""


def hinge():
    """A body of 0.4 kg m^2 about its hinge, and nothing else."""
    return build_mechanism(Urdf.from_text(HINGE, "r.urdf"), "fixed")


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize("name", ["s-curve of seven parts", "cycloid", "linear chirp", "sum"])
def test_the_torque_that_holds_a_motion_is_inertia_times_its_acceleration(engine, name):
    reference = EVERY[name]
    system = System(hinge(), drives={"motor": PrescribedMotion(joint="axle", follows=reference)})
    settings = RunSettings(engine=engine)
    angle, rate, _ = reference.at(0.0)
    run = simulate(system, duration=4.0, q=[math.cos(angle), math.sin(angle)], v=[rate], settings=settings)
    assert run.completed
    at = reference.over_time()
    exact = np.array([at(t) for t in run.data["time"].values])
    assert run.data["motion_angle"].values[:, 0] == pytest.approx(exact[:, 0], abs=1e-12)
    assert run.data["drive_torque"].values[:, 0] == pytest.approx(0.4 * exact[:, 2], abs=1e-12)


def test_a_controller_follows_what_a_motion_does():
    """With inertia I, I e'' + kd e' + kp e = I r'' for the lack e: by the linear system's own solution."""
    slew = SLEWS["quintic"]
    kp, kd, inertia = 40.0, 4.0, 0.4
    controller = PDController(joint="axle", kp=kp, kd=kd, follows=slew)
    settings = RunSettings(rtol=1e-12)
    run = simulate(System(hinge(), drives={"pd": controller}), duration=3.0, settings=settings)
    at = slew.over_time()
    decay = kd / (2.0 * inertia)
    omega = math.sqrt(kp / inertia - decay**2)
    for t in (0.6, 1.7, 2.9):

        def answer(s, t=t):
            return at(s)[2] * math.exp(-decay * (t - s)) * math.sin(omega * (t - s)) / omega

        lack, _ = quad(answer, 0.0, t, points=[0.5, 1.0, 1.5, 2.0], epsabs=1e-14, limit=500)
        angle = float(np.interp(t, run.data["time"], run.data["motion_angle"][:, 0]))
        assert at(t)[0] - angle == pytest.approx(lack, abs=1e-6)  # of the interpolation between samples


def test_two_halves_are_one_run_in_the_middle_of_a_slew():
    system = System(hinge(), drives={"pd": PDController(joint="axle", kp=40.0, kd=4.0, follows=EVERY["sum"])})
    whole = simulate(system, duration=1.0)
    half = simulate(system, duration=0.37)
    rest = simulate(system, duration=0.63, start=half.end)
    assert whole.end.q.tobytes() == rest.end.q.tobytes() and whole.end.x.tobytes() == rest.end.x.tobytes()


SCENARIO = """
format = 1
duration = "1 s"
[mechanism]
urdf = "r.urdf"
base = "fixed"
[references.slew]
kind = "s-curve"
end = "90 deg"
rate = "60 deg/s"
acceleration = "120 deg/s^2"
jerk = "600 deg/s^3"
[references.points]
kind = "table"
file = "points.csv"
[references.both]
kind = "sum"
parts = ["slew", "points"]
[drives.motor]
kind = "motion"
joint = "axle"
follows = "both"
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "r.urdf").write_text(HINGE)
    (tmp_path / "points.csv").write_text("time,values\n0,0\n1,0.1\n2,0\n")
    (tmp_path / "scenario.toml").write_text(SCENARIO)
    return tmp_path


def test_a_scenario_names_what_is_followed(folder):
    from antenna_pin import build_system

    motor = build_system(load_scenario(folder / "scenario.toml")).drives["motor"]
    degree = math.radians(1.0)
    slew = SCurve(end=90 * degree, rate=60 * degree, acceleration=120 * degree, jerk=600 * degree)
    points = Table(time=(0, 1, 2), values=(0, 0.1, 0), file="points.csv")
    assert isinstance(motor.follows, Sum) and motor.follows.parts[1] == points
    assert motor.follows.parts[0].terms() == pytest.approx(slew.terms(), rel=1e-14)
    assert motor.words(False).startswith("motion an S-curve slew from 0\N{NO-BREAK SPACE}rad to 1.57")


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("drives.motor.follows=slow", "reference 'slow' is unknown; did you mean slew"),
        ("references.both.parts=['slew', 'both']", "must not lead back to 'both'"),
        ("references.both.parts=['slow']", "reference 'slow' is unknown"),
        ("references.slew.rate='1 m/s'", "must be for a turning joint"),
        ("references.slew.jerk=0", "must be positive"),
        ("references.points.values=[1, 2]", "must have either file, or time and values"),
    ],
)
def test_refusals(folder, override, said):
    with pytest.raises(AntennaPinError, match=said):
        load_scenario(folder / "scenario.toml", overrides=[override])


CONTROLLED = """
format = 1
duration = "1 s"
[mechanism]
urdf = "r.urdf"
base = "fixed"
[references.slew]
kind = "rest-to-rest"
end = "1 rad"
duration = "0.8 s"
[drives.motor]
kind = "constant"
joint = "axle"
value = 0
[controllers.pointing]
kind = "pid"
acts_on = "motor"
period = "10 ms"
kp = 40
kd = 4
feedforward_acceleration = 0.4
follows = "slew"
"""


def test_a_sampled_controller_follows_it_at_its_instants(folder):
    """Its recorded reference is that of the slew, and of both a number and a name one is refused."""
    path = folder / "controlled.toml"
    path.write_text(CONTROLLED)
    run = simulate(load_scenario(path))
    assert run.completed
    at = RestToRest(end=1.0, duration=0.8).over_time()
    data = run.data
    column = list(data["signal"].values).index("pointing.reference")
    times, seen = data["tick_time"].values, data["tick_signal"].values[:, column]
    assert len(times) >= 99 and seen == pytest.approx([at(t)[0] for t in times], abs=1e-15)
    half = simulate(load_scenario(path), duration=0.353)
    assert (
        simulate(load_scenario(path), duration=0.647, start=half.end).end.q.tobytes() == run.end.q.tobytes()
    )
    with pytest.raises(ScenarioError, match="must be left out with follows"):
        load_scenario(path, overrides=["controllers.pointing.reference=1"])
    with pytest.raises(AntennaPinError, match="reference 'slow' is unknown"):
        load_scenario(path, overrides=["controllers.pointing.follows=slow"])


def test_what_does_not_cover_a_run_or_is_of_another_joint_is_refused(folder):
    with pytest.raises(InvalidParameterError, match="a table that covers the run from 0 to 3 s"):
        simulate(load_scenario(folder / "scenario.toml", overrides=["duration=3"]))
    ways = [f"references.slew.{key}={value}" for key, value in (("end", "'1 m'"), ("rate", "'1 m/s'"))]
    ways += ["references.slew.acceleration=1", "references.slew.jerk=1"]
    with pytest.raises(ScenarioError, match="units must be those of a rotation"):
        simulate(load_scenario(folder / "scenario.toml", overrides=ways))
    with pytest.raises(InvalidParameterError, match="periodic table"):
        Table(time=(0, 1), values=(0, 1), periodic=True)
    with pytest.raises(InvalidParameterError, match="as many numbers as amplitudes"):
        Sines(amplitudes=(1, 2), frequencies=(1,), phases=(0, 0))
