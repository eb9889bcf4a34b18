"""Gears with play, splines, belts and cables against closed forms; momentum, ledger, halves."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from antenna_pin import (
    Coupling,
    RunSettings,
    System,
    Urdf,
    build_mechanism,
    load_scenario,
    simulate,
)
from antenna_pin.dynamics import Workspace
from antenna_pin.elements import Belt, Cable, Gear, JointSpring, PrescribedMotion, Spline
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.studies.linear import modes

TIGHT = RunSettings(rtol=1e-12, output_rate=400.0)
LINK = (
    '<link name="{0}"><inertial><origin xyz="{2} 0 0"/><mass value="1"/>'
    '<inertia ixx="{1}" iyy="{1}" izz="{1}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="{3}"><parent link="{4}"/><child link="{0}_link"/><origin xyz="{1} 0 0" '
    'rpy="{2}"/><axis xyz="0 0 1"/><limit lower="-99" upper="99" effort="1e9" velocity="1e9"/></joint>'
)
#: Moments of inertia of input and output [kg m^2].
INPUT, OUTPUT = 0.01, 0.04


def _discs(base: str = "fixed", kind: str = "continuous", **more) -> System:
    """Two balanced discs on one axis."""
    text = LINK.format("base", 0.5, 0) + JOINT.format("a", 0, "0 0 0", kind, "base")
    text += JOINT.format("b", 0, "0 0 0", kind, "base")
    text += LINK.format("a_link", INPUT, 0) + LINK.format("b_link", OUTPUT, 0)
    urdf = Urdf.from_text(f'<robot name="discs">{text}</robot>', "discs.urdf")
    return System(build_mechanism(urdf, base, (0, 0, 0)), **more)


def _skew(base: str = "free", **more) -> System:
    """Unbalanced bodies on skew axes, the last one on the second."""
    text = LINK.format("base", 0.5, 0.1)
    for name, on, turned in (
        ("a", "base", "0.4 0.1 0"),
        ("b", "base", "-0.3 0.8 0"),
        ("c", "b_link", "1 0 0"),
    ):
        text += JOINT.format(name, 0.3, turned, "continuous", on) + LINK.format(f"{name}_link", 0.05, 0.1)
    urdf = Urdf.from_text(f'<robot name="skew">{text}</robot>', "skew.urdf")
    return System(build_mechanism(urdf, base, (0, 0, 0)), **more)


def _geared(element: Gear | Spline | Belt | Cable) -> dict[str, dict[str, object]]:
    return {"gears": {"g": element}}


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
@pytest.mark.parametrize("side", ["output", "input"])
def test_a_gear_is_free_in_its_play_and_an_oscillator_in_mesh(side: str, engine: str) -> None:
    """x = in / r - out goes free over the play, half a swing in mesh, and back: with the reduced inertia."""
    ratio, play, k = -3.0, 0.02, 50.0
    by = 1.0 if side == "output" else abs(ratio)
    gear = Gear(input="a", output="b", ratio=ratio, stiffness=k / by**2, play=play * by, side=side)
    rate = np.array([0.6, -0.1])
    settings = RunSettings(rtol=1e-12, output_rate=400.0, engine=engine)
    run = simulate(_discs(elements=_geared(gear)), v=rate, duration=1.5, settings=settings)
    t, angle, rates = (run.data[name].values for name in ("time", "motion_angle", "motion_rate"))
    x, start = angle[:, 0] / ratio - angle[:, 1], rate[0] / ratio - rate[1]
    omega = math.sqrt(k * (1.0 / (INPUT * ratio**2) + 1.0 / OUTPUT))
    # From the middle of the play to its end, half a swing, and to the other end.
    speed, lag, swing, across = abs(start), 0.5 * play / abs(start), math.pi / omega, play / abs(start)
    inside = np.mod(t + lag, swing + across)
    number = np.floor((t + lag) / (swing + across))
    sign = np.where(number % 2 == 0, 1.0, -1.0) * math.copysign(1.0, start)
    free = inside <= across
    expected = sign * np.where(
        free, speed * inside - 0.5 * play, 0.5 * play + speed / omega * np.sin(omega * (inside - across))
    )
    assert number.max() >= 5
    # The tolerance of the steps over ten swings.
    assert np.abs(x - expected).max() < 1e-9
    carried = ratio * INPUT * rates[:, 0] + OUTPUT * rates[:, 1]
    assert np.abs(carried - carried[0]).max() < 1e-12
    assert np.abs(run.data.energy_error).max() < 1e-11
    torque = run.data.element_effort.values[:, 0] * by
    depth = np.maximum(np.abs(expected) - 0.5 * play, 0.0)
    assert np.abs(np.abs(torque) - k * depth).max() < 1e-7  # k times the error of x


@pytest.mark.parametrize(("ratio", "side"), [(4.0, "output"), (-2.5, "input"), (0.5, "output")])
def test_the_housing_takes_what_input_and_output_get(ratio: float, side: str) -> None:
    """On parallel axes the torque on the input times -ratio is that on the output; the base gets -(sum)."""
    system = _discs(
        "free", elements=_geared(Gear(input="a", output="b", ratio=ratio, stiffness=7.0, side=side))
    )
    y = system.state(_placed(system, 0.3, -0.1), np.zeros(8))
    workspace, rates = Workspace(system), np.zeros(system.model.nv + system.manifold.nx)
    workspace.derivative(0.0, y, rates)
    given, got = workspace.tau[6], workspace.tau[7]
    assert got == pytest.approx(-ratio * given, rel=1e-14)
    assert np.abs(workspace.tau[:6]).max() == 0.0
    # About one axis the base turns by what the housing takes, and goes nowhere.
    assert 0.5 * rates[5] == pytest.approx(-(given + got), rel=1e-12)
    assert np.abs(rates[:5]).max() < 1e-15


def _placed(system: System, a: float, b: float) -> np.ndarray:
    q = system.neutral()
    for name, angle in (("a", a), ("b", b)):
        q[system.mechanism.joint(name).q] = math.cos(angle), math.sin(angle)
    return q


ELEMENTS = {
    "gear": Gear(input="a", output="b", ratio=-2.0, stiffness=40.0, damping=0.2, play=0.02, offset=0.01),
    "friction": Gear(
        input="a", output="b", ratio=3.0, stiffness=40.0, play=0.02, efficiency=0.8, efficiency_back=0.6
    ),
    "error": Gear(
        input="a",
        output="c",
        ratio=2.0,
        stiffness=40.0,
        damping=0.1,
        error_angle=(0.0, 0.3, 0.5, 0.8, 1.0),
        error=(0.0, 0.002, 0.003, -0.002, 0.0),
    ),
    "spline": Spline(input="b", output="c", stiffness=30.0, damping=0.1, play=0.05),
    "belt": Belt(input="a", output="c", input_radius=0.1, output_radius=0.2, stiffness=900.0, pretension=4.0),
    "crossed": Belt(
        input="a", output="b", input_radius=0.1, output_radius=0.2, stiffness=900.0, crossed=True, damping=2.0
    ),
    "cable": Cable(input="a", output="b", input_radius=0.1, output_radius=0.1, stiffness=900.0, slack=0.02),
}


@pytest.mark.parametrize("name", ELEMENTS)
def test_all_kinds_keep_momentum_and_the_ledger(name: str) -> None:
    """Between joints of skew axes, on one parent or not, on a free base; both engines agree."""
    system = _skew(elements=_geared(ELEMENTS[name]))
    v = np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.4, 2.0, -1.0, 1.5])
    runs = [
        simulate(
            system, v=v, duration=1.0, settings=RunSettings(rtol=1e-11, output_rate=100.0, engine=engine)
        )
        for engine in ("compiled", "pinocchio")
    ]
    for run in runs:
        assert run.completed
        for what in ("linear", "angular"):
            momentum = run.data[f"{what}_momentum"].values
            assert np.abs(momentum - momentum[0]).max() <= 1e-9 * np.abs(momentum).max()
        assert np.abs(run.data.energy_error).max() < 1e-8 * float(run.data.kinetic_energy[0])
        assert np.abs(run.data.element_effort).max() > 0.1
        assert np.diff(run.data.element_loss.values[:, 0]).min() >= -1e-12  # nothing is gained by losses
    # Errors of the steps grow by the same factor in both.
    assert runs[0].data.q.values[-1] == pytest.approx(runs[1].data.q.values[-1], abs=1e-9)


@pytest.mark.parametrize(("rate", "torque", "share"), [(2.0, -1.0, 0.8), (2.0, 1.0, 0.6), (-2.0, 1.0, 0.8)])
def test_efficiency_is_that_of_the_direction_of_power(rate: float, torque: float, share: float) -> None:
    """Power that leaves is the share of what enters; rounding off counts (slow / rate)^2 / 2 of the loss."""
    gear = Gear(
        input="a", output="b", ratio=3.0, stiffness=10.0, efficiency=0.8, efficiency_back=0.6, slow_rate=1e-6
    )
    system = _discs(elements=_geared(gear))
    # The mesh gives the input ``torque``, by its deflection; the output turns at the ratio.
    y = system.state(_placed(system, -torque * 3.0 * 3.0 / 10.0, 0.0), [rate, rate / 3.0])
    workspace, rates = Workspace(system), np.zeros(system.model.nv + system.manifold.nx)
    workspace.derivative(0.0, y, rates)
    powers = workspace.tau * [rate, rate / 3.0]
    entering, leaving = -powers.min(), powers.max()
    assert leaving == pytest.approx(share * entering, rel=1e-12)
    assert rates[system.model.nv + system.element_x[0]] == pytest.approx(entering - leaving, rel=1e-12)


def test_a_transmission_error_shakes_the_output() -> None:
    """An input at constant rate, e = A sin(n in): the output is the forced oscillator of the mesh."""
    n, size, rate, k = 5, 1e-3, 2.0, 60.0
    angles = tuple(2.0 * math.pi * j / (n * 240.0) for j in range(241))
    error = (*(size * math.sin(n * one) for one in angles[:-1]), 0.0)
    gear = Gear(input="a", output="b", stiffness=k, error_angle=angles, error=error)
    drives = {"turn": PrescribedMotion(joint="a", rate=rate)}
    # Starts on the forced motion: out = rate t - B sin(n rate t).
    forced = size * k / (k - OUTPUT * (n * rate) ** 2)
    v = [rate, rate - forced * n * rate]
    run = simulate(_discs(drives=drives, elements=_geared(gear)), v=v, duration=5.0, settings=TIGHT)
    t = run.data.time.values
    expected = rate * t - forced * np.sin(n * rate * t)
    # A spline of steps h = 2 pi / 240 errs by h^4 / 384 = 1e-9 of the size; the steps' own tolerance.
    assert np.abs(run.data.motion_angle.values[:, 1] - expected).max() < 1e-9


def test_a_cable_pulls_and_never_pushes() -> None:
    """A drum that runs ahead takes the slack, gives its share of momentum in half a swing, and is left."""
    cable = Cable(input="a", output="b", input_radius=0.1, output_radius=0.1, stiffness=900.0, slack=0.02)
    run = simulate(_discs(elements=_geared(cable)), v=[2.0, 0.0], duration=1.0, settings=TIGHT)
    # An elastic impact of two rotors: the difference of rates is turned round.
    common = INPUT * 2.0 / (INPUT + OUTPUT)
    assert run.data.motion_rate.values[-1] == pytest.approx([2.0 * common - 2.0, 2.0 * common], abs=1e-10)
    assert run.data.element_effort.values.max() <= 0.0
    behind = simulate(_discs(elements=_geared(cable)), v=[-2.0, 0.0], duration=1.0, settings=TIGHT)
    assert np.abs(behind.data.motion_rate.values[-1] - [-2.0, 0.0]).max() == 0.0


def test_small_motions_know_whether_the_mesh_is_closed() -> None:
    """Open, nothing swings; closed, the mesh does, with the reduced inertia."""
    gear = Gear(input="a", output="b", ratio=2.0, stiffness=50.0, play=0.02, offset=-0.03)
    held = {"w": JointSpring(joint="a", stiffness=1e-3)}
    system = _discs(elements=_geared(gear), springs=held)
    closed = modes(system, q=_placed(system, 0.0, 0.0)).frequency
    stiffness = 50.0 * np.array([[0.25, -0.5], [-0.5, 1.0]]) + np.diag([1e-3, 0.0])
    swings = np.linalg.eigvals(stiffness / np.array([[INPUT], [OUTPUT]]))
    assert closed.max() == pytest.approx(math.sqrt(swings.max()) / math.tau, rel=1e-9)
    opened = modes(system, q=_placed(system, 0.0, 0.03)).frequency
    assert opened.max() == pytest.approx(math.sqrt(1e-3 / INPUT) / math.tau, rel=1e-6)


def test_a_gear_counts_whole_turns() -> None:
    """Wound up by three turns of the input, the mesh pulls by them: angles are with their turns."""
    gear = Gear(input="a", output="b", ratio=10.0, stiffness=2.0)
    system = _discs(elements=_geared(gear))
    angle = 6.0 * math.pi + 0.1
    y = system.state(_placed(system, angle, 0.0), np.zeros(2), {"a": angle})
    workspace, rates = Workspace(system), np.zeros(system.model.nv + system.manifold.nx)
    workspace.derivative(0.0, y, rates)
    assert workspace.tau[1] == pytest.approx(2.0 * angle / 10.0, rel=1e-14)


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_planetary_and_differential_hold_three_joints(engine: str) -> None:
    """(1 + r) c = s + r g all along, torques in the ratios of the multipliers, momentum kept."""
    r = 2.5
    coupling = Coupling.planetary(carrier="c", sun="a", ring="b", ratio=r)
    system = _skew(couplings={"p": coupling}, springs={"s": JointSpring(joint="b", stiffness=5.0)})
    q, v = system.neutral(), np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.4, 2.0, -1.0, 0.0])
    v[8] = (v[6] + r * v[7]) / (1.0 + r)
    settings = RunSettings(rtol=1e-11, output_rate=50.0, engine=engine)
    run = simulate(system, q=q, v=v, duration=2.0, settings=settings)
    a, b, c = run.data.motion_angle.values.T
    assert np.abs((1.0 + r) * c - a - r * b).max() < 1e-12
    for what in ("linear", "angular"):
        momentum = run.data[f"{what}_momentum"].values
        assert np.abs(momentum - momentum[0]).max() <= 1e-9 * np.abs(momentum).max()
    assert np.abs(run.data.energy_error).max() < 1e-9
    half = Coupling.differential(carrier="c", first="a", second="b")
    assert half.led(0.4, 0.2) == pytest.approx(0.3)
    assert half.leading(0.3, 0.2) == pytest.approx(0.4)


def test_a_differential_shares_torque_and_the_housing_takes_the_rest() -> None:
    """Balanced discs: a torque on one side accelerates all by the reduced inertia; lambda from the third."""
    text = LINK.format("base", 0.5, 0)
    for name, x in (("a", 0.1), ("b", -0.2), ("c", 0.3)):
        text += JOINT.format(name, x, "0 0 0", "revolute", "base") + LINK.format(f"{name}_link", OUTPUT, 0)
    mechanism = build_mechanism(Urdf.from_text(f'<robot name="d">{text}</robot>', "d"), "fixed", (0, 0, 0))
    couplings = {"d": Coupling.differential(carrier="c", first="a", second="b")}
    system = System(mechanism, couplings=couplings)
    y = system.state(system.neutral(), np.zeros(3))
    workspace = Workspace(system)
    tau = np.array([1.0, 0.0, 0.0])
    found = workspace.acceleration(0.0, y, tau)
    # I qdd = tau - lambda (1/2, 1/2, -1), with qdd_c = (qdd_a + qdd_b) / 2: lambda = tau_a / 2 / (3 / 2).
    share = 1.0 / 3.0
    expected = np.array([1.0 - 0.5 * share, -0.5 * share, share]) / OUTPUT
    assert found == pytest.approx(expected, rel=1e-12)


def test_gears_of_a_scenario(tmp_path: Path) -> None:
    """A table by its name, with units; its numbers are set and said as others'."""
    text = LINK.format("base", 0.5, 0) + JOINT.format("a", 0.1, "0 0 0", "continuous", "base")
    text += JOINT.format("b", -0.2, "0 0 0", "continuous", "base")
    text += LINK.format("a_link", INPUT, 0) + LINK.format("b_link", OUTPUT, 0)
    (tmp_path / "discs.urdf").write_text(f'<robot name="discs">{text}</robot>')
    (tmp_path / "scenario.toml").write_text(
        'format = 1\nduration = "0.1 s"\ndefault_case = "all"\n[mechanism]\nurdf = "discs.urdf"\n'
        'base = "fixed"\n[gears.drive]\ninput = "a"\noutput = "b"\nratio = 50\nstiffness = "2 kN*m/rad"\n'
        'play = "0.5 mrad"\n[cases.all]\n'
    )
    from antenna_pin import build_system

    system = build_system(load_scenario(tmp_path / "scenario.toml", overrides=["gears.drive.damping=3"]))
    gear = system.families["gears"]["drive"]
    assert gear == Gear(input="a", output="b", ratio=50, stiffness=2e3, play=0.5e-3, damping=3.0)
    for more, says in (
        ("gears.drive.output=c", "output.*'c'"),
        ("gears.drive.output=a", "output must be another joint than the input"),
        ("gears.drive.efficiency=1.2", r"efficiency must be in \(0, 1\]"),
        ("gears.drive.joint=a", "joint is unknown"),
    ):
        with pytest.raises(AntennaPinError, match=says):
            build_system(load_scenario(tmp_path / "scenario.toml", overrides=[more]))


def test_couplings_of_three_joints_in_a_scenario(tmp_path: Path) -> None:
    """Tables by the names of the parts are those of Python; what they refuse is said by the table's keys."""
    text = LINK.format("base", 0.5, 0)
    for name in "abc":
        text += JOINT.format(name, 0.1, "0 0 0", "continuous", "base") + LINK.format(f"{name}_link", 0.1, 0)
    (tmp_path / "three.urdf").write_text(f'<robot name="three">{text}</robot>')
    head = 'format = 1\nduration = "0.1 s"\n[mechanism]\nurdf = "three.urdf"\nbase = "fixed"\n[couplings.c]\n'
    from antenna_pin import build_system

    planetary = 'kind = "planetary"\nsun = "a"\nring = "b"\nratio = 2.5\n'
    differential = 'kind = "differential"\ncarrier = "c"\nfirst = "a"\nsecond = "b"\n'
    for table, expected in (
        (planetary, Coupling.planetary(carrier="c", sun="a", ring="b", ratio=2.5)),
        (differential, Coupling.differential(carrier="c", first="a", second="b")),
    ):
        (tmp_path / "scenario.toml").write_text(head + table)
        assert build_system(load_scenario(tmp_path / "scenario.toml")).couplings == {"c": expected}
    for table, says in (
        (planetary.replace("2.5", "1"), r"couplings\.c\.ratio: must be ring over sun, above 1, got 1"),
        (planetary.replace('"b"', '"a"'), r"couplings\.c\.ring: must be a third joint, got 'a'"),
        (differential.replace('"a"', '"x"'), r"couplings\.c\.first.*'x'"),
        (differential + "offset = 1\n", r"couplings\.c\.offset"),
        (planetary.replace("planetary", "planet"), "couplings.c.kind must be one of ratio, differential, pl"),
    ):
        (tmp_path / "scenario.toml").write_text(head + table)
        with pytest.raises(AntennaPinError, match=says):
            build_system(load_scenario(tmp_path / "scenario.toml"))


@pytest.mark.parametrize(
    ("numbers", "says"),
    [
        ({"ratio": 0.0}, "Gear: ratio must be other than zero, got 0"),
        ({"efficiency": 1.5}, r"Gear: efficiency must be in \(0, 1\], got 1.5"),
        ({"error": (0.0, 1.0)}, "Gear: error_angle must be given beside error, got none"),
        ({"error_angle": (0, 1, 2, 3), "error": (0, 1, 2, 3)}, r"error\[3\] must be as the first, 0.0: the"),
        (
            {"error_angle": (0, 1, 1, 3), "error": (0, 1, 2, 0)},
            r"error_angle\[2\] must be above the one",
        ),
        ({"output": "a"}, "Gear: output must be another joint than the input, got 'a'"),
    ],
)
def test_bad_gears_are_refused_in_a_line(numbers: dict[str, object], says: str) -> None:
    with pytest.raises(InvalidParameterError, match=says):
        Gear(**{"input": "a", "output": "b", "stiffness": 1.0, **numbers})
