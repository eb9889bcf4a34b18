"""Controllers of one's own: when they are asked and what of, what is kept, parts of runs, what is refused."""

import dataclasses
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from controlled_wheel import KINDS, PERIOD, PLAIN, WHEEL, rig, run_of
from value_classes import dataclasses_of

from antenna_pin import Outcome, RunSettings, System, Trajectory, simulate
from antenna_pin.base.state import State
from antenna_pin.elements import ConstantDrive
from antenna_pin.elements.control import Controller, Instants, kept, remembered
from antenna_pin.errors import AntennaPinError, FileFormatError
from antenna_pin.run.simulation import Event, Set, Time


@dataclass
class Counter(Controller):
    """Commands the number of its instant, and keeps when it was asked."""

    period: float = PERIOD
    phase: float = 0.0
    delay: float = 0.0
    delay_periods: float = 0.0
    commands: tuple[str, ...] = ("motor",)
    signals: tuple[str, ...] = ("seen", "before")
    state: Any = field(default_factory=lambda: {"asked": 0})

    def update(self, now):
        self.state["asked"] += 1
        now.note(seen=now.angle("joint"), before=now.command("motor"))
        return {"motor": float(now.tick)}


def ran(controllers, duration=0.1, events=(), system=None, **more):
    settings = RunSettings(output_rate=1000.0)
    return simulate(
        system or rig(), duration=duration, controllers=controllers, events=events, settings=settings, **more
    )


def test_instants_are_decimals():
    """A hundred periods of 0.01 s are 1 s, and three of 0.1 s what is written 0.3."""
    for period, count, time in ((0.01, 100, 1.0), (0.1, 3, 0.3), (0.001, 1100, 1.1)):
        assert Instants(Counter(period=period)).tick(count) == time
    late = Instants(Counter(period=0.1, phase=0.05, delay_periods=2.5))
    assert (late.tick(2), late.write(2)) == (0.25, 0.5)
    assert (late.first_from(0.25), late.first_from(0.2501), late.first_from(0.0)) == (2, 3, 0)


@pytest.mark.parametrize(
    ("late", "expected"),
    [({}, 0.0), ({"delay_periods": 1.0}, 1.0), ({"delay_periods": 2.0}, 2.0), ({"delay": 0.03}, 3.0)],
    ids=str,
)
def test_a_command_is_written_so_many_periods_later(late, expected):
    """What is in force after instant k is k less the delay; what it sees then is what was before it."""
    run = ran({"c": Counter(**late)})
    for k in range(int(expected) + 1, 10):
        time = k * PERIOD
        torque = run.data.drive_torque.sel(drive="motor")
        assert float(torque.sel(time=time + 0.004, method="nearest")) == k - expected
        # A sample at the instant has what holds from then on.
        assert float(torque.sel(time=time, method="nearest")) == k - expected
        before = run.data.tick_signal.sel(signal="c.before").values
        assert before[k] == max(0.0, k - 1 - expected)


def test_until_the_first_command_the_drive_does_what_it_says():
    run = ran({"c": Counter(phase=0.02, delay=0.005)}, system=rig(torque=7.0))
    torque = run.data.drive_torque.sel(drive="motor").values
    assert (torque[:25] == 7.0).all()
    assert torque[26] == 0.0


def test_all_are_asked_before_anything_is_written():
    """The second sees the command of the first as it was; events of the instant come before both."""
    urdf = rig().mechanism
    both = System(
        urdf,
        drives={
            "motor": ConstantDrive(joint="joint", value=5.0),
            "other": ConstantDrive(joint="joint", value=0.0),
        },
    )

    @dataclass
    class Follower(Counter):
        commands: tuple[str, ...] = ("other",)
        signals: tuple[str, ...] = ("saw",)

        def update(self, now):
            now.note(saw=now.command("motor"))
            return {"other": now.command("motor")}

    at = Event(name="set", when=Time(0.05), action=Set("drives.motor.value", 9.0))
    run = ran({"first": Counter(), "second": Follower()}, system=both, events=[at])
    signals = run.data.tick_signal.sel(signal="second.saw").values[run.data.tick_controller.values == 1]
    assert signals.tolist() == [5.0, 0.0, 1.0, 2.0, 3.0, 9.0, 5.0, 6.0, 7.0, 8.0, 9.0]
    assert np.isnan(run.data.tick_signal.sel(signal="second.saw").values[::2]).all()


def test_controllers_of_several_periods_meet_at_one_instant():
    """Ten periods of 3 ms and one of 30 ms: no step is made between what is one instant."""
    run = ran({"fast": Counter(period=0.003), "slow": Other(period=0.03)}, system=two_drives())
    times, which = run.data.tick_time.values, run.data.tick_controller.values
    assert set(times[which == 1].tolist()) <= set(times[which == 0].tolist())
    assert run.data.ticks.values.tolist() == [34, 4]


@dataclass
class Other(Counter):
    commands: tuple[str, ...] = ("other",)

    def update(self, now):
        return {"other": 0.0}


def two_drives():
    drives = {name: ConstantDrive(joint="joint", value=0.0) for name in ("motor", "other")}
    return System(rig().mechanism, drives=drives)


def test_a_run_works_on_a_copy():
    one = Counter()
    ran({"c": one})
    assert one.state == {"asked": 0}


def test_it_is_what_events_would_set():
    """The same commands, set at the same instants, are the same motion bit for bit."""
    asked = run_of(KINDS["one period late"], duration=0.2)
    commands = asked.data.tick_signal.sel(signal="loop.command motor").values
    events = [
        Event(name=f"{k}", when=Time(float(time) + PERIOD), action=Set("drives.motor.value", float(torque)))
        for k, (time, torque) in enumerate(zip(asked.data.tick_time.values, commands, strict=True))
    ]
    done = simulate(rig(), duration=0.2, events=events, settings=RunSettings(output_rate=1.0 / PERIOD))
    # Time and period are added here in binary numbers: up to an ulp of time apart.
    there = done.data.q.sel(time=asked.data.time.values, method="nearest")
    assert there.values == pytest.approx(asked.data.q.values, abs=1e-15)


# --- parts of runs ----------------------------------------------------------------------------------------

NOISY = dataclasses.replace(
    KINDS["two and a half periods late"],
    sensor=dataclasses.replace(PLAIN.sensor, noise=1e-3, seed=2),
    upper=3.0,
    lower=-3.0,
)


@dataclass
class Random(Controller):
    """Draws from a generator of its own, with every kind of thing in its state."""

    period: float = PERIOD
    commands: tuple[str, ...] = ("motor",)
    state: Any = field(
        default_factory=lambda: {
            "draw": np.random.default_rng(3),
            "list": [1, (2.5, None)],
            "array": np.zeros((2, 2)),
            7: "text",
        }
    )

    def update(self, now):
        self.state["array"][0, 1] += now.rate("joint")
        self.state["list"].append(now.tick)
        return {"motor": float(self.state["draw"].standard_normal()) - self.state["array"][0, 1]}


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize("controller", [NOISY, Random()], ids=["pid", "own"])
@pytest.mark.parametrize("split", [0.25, 0.253125], ids=["at an instant", "in the middle of a period"])
def test_two_halves_are_one_bit_for_bit(controller, split, engine):
    settings = RunSettings(output_rate=1000.0, engine=engine)
    told = {"controllers": {"c": controller}, "settings": settings}
    whole = simulate(rig(), duration=0.5, **told)
    first = simulate(rig(), duration=split, **told)
    state = State.from_json(first.end.to_json())
    assert state == first.end
    second = simulate(rig(), start=state, duration=0.5 - split, **told)
    assert second.end == whole.end
    common = np.isin(second.data.time.values, whole.data.time.values)
    for name in ("q", "v", "drive_torque"):
        there = whole.data[name].sel(time=second.data.time.values[common]).values
        assert (there == second.data[name].values[common]).all()
    ticks = np.concatenate([first.data.tick_signal.values, second.data.tick_signal.values])
    np.testing.assert_array_equal(ticks, whole.data.tick_signal.values)


STOPS: list[float] = []


@dataclass
class Stopped(Random):
    """Ctrl-C comes in the middle of its work, at each of some instants once."""

    def update(self, now):
        answer = super().update(now)
        if STOPS and now.time >= STOPS[0]:
            STOPS.pop(0)
            raise KeyboardInterrupt
        return answer


def test_a_run_that_is_stopped_and_resumed_is_one(tmp_path):
    """What it had half done when it was stopped is undone; commands that wait to be written are kept."""
    told = {"controllers": {"c": Stopped(), "d": dataclasses.replace(NOISY, acts_on="other")}}
    told["settings"] = RunSettings(output_rate=1000.0)
    whole = simulate(two_drives(), duration=0.5, **told)
    STOPS.extend([0.1, 0.2, 0.41])
    out = tmp_path / "run.nc"
    run = simulate(two_drives(), duration=0.5, out=out, **told)
    for _ in range(3):
        assert run.outcome is Outcome.INTERRUPTED
        run = simulate(two_drives(), out=out, resume=True, **told)
    assert run.end == whole.end
    np.testing.assert_array_equal(run.data.tick_signal.values, whole.data.tick_signal.values)
    np.testing.assert_array_equal(run.data.drive_torque.values, whole.data.drive_torque.values)


def test_a_run_is_not_gone_on_with_by_other_controllers(tmp_path):
    STOPS.append(0.1)
    told = {"settings": RunSettings(output_rate=1000.0), "out": tmp_path / "run.nc"}
    simulate(rig(), duration=0.5, controllers={"c": Stopped()}, **told)
    with pytest.raises(FileFormatError, match="must be of a run with these controllers"):
        simulate(rig(), controllers={"c": NOISY}, resume=True, **told)


def test_results_keep_the_instants(tmp_path):
    run = ran({"c": NOISY})
    run.save(tmp_path / "run.nc")
    read = Trajectory.load(tmp_path / "run.nc")
    np.testing.assert_array_equal(read.data.tick_signal.values, run.data.tick_signal.values)
    lean = simulate(
        rig(),
        duration=0.1,
        controllers={"c": NOISY},
        settings=RunSettings(output_rate=1e3, output_form="lean"),
    )
    assert "tick" not in lean.data.sizes
    assert lean.data.ticks.values.tolist() == [11]


@dataclass
class _Inner:
    number: float = 0.1


@dataclass
class _Outer:
    inner: _Inner = field(default_factory=_Inner)
    numbers: np.ndarray = field(default_factory=lambda: np.array([1e-300, math.pi, math.inf]))


def test_memory_is_exact():
    state = _Outer(_Inner(0.1 + 0.2))
    back = remembered(kept(state), _Outer())
    assert back.inner == state.inner
    assert back.numbers.tobytes() == state.numbers.tobytes()


# --- refusals ---------------------------------------------------------------------------------------------


@dataclass
class Given(Counter):
    answer: Any = None

    def update(self, now):
        if now.time < 0.045:
            return {}
        return self.answer(now)


def fails(now):
    raise ValueError("the sun is gone")


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (fails, "gave the error ValueError: the sun is gone (test_controllers.py, line"),
        (lambda now: {"motor": math.nan}, "gave nan"),
        (lambda now: {"moter": 1.0}, "gave one called 'moter'"),
        (lambda now: 3.0, "gave"),
        (lambda now: {"motor": now.angle("hinge")}, "'hinge'"),
        (lambda now: {"motor": now.base_rate()[0]}, "asked of a free base only"),
        (lambda now: now.note(speed=1.0) or {}, "gave one called 'speed'"),
    ],
)
def test_one_that_fails_ends_the_run_which_keeps_what_it_has(answer, said):
    run = ran({"c": Given(answer=answer)})
    assert run.outcome is Outcome.FUNCTION_FAILED
    assert "at t = 0.05 s, controller 'c': update of instant 5, t = 0.05 s" in run.message
    assert said in run.message
    assert "\n" not in run.message
    assert run.data.time.values[-1] == 0.05
    assert len(run.data.tick_time) == 5


@pytest.mark.parametrize(
    ("controllers", "said"),
    [
        ({"c": Counter(commands=("moter",))}, "actuator 'moter' is unknown; did you mean motor?"),
        ({"c": Counter(commands=())}, "commands must be one name or more of what it commands"),
        ({"c": Counter(period=-1.0)}, "controller 'c': period must be positive and finite [s], got -1.0"),
        ({"c": Counter(state={1, 2})}, "controller 'c': state must be numbers, texts, arrays"),
        ({"c": Counter(), "d": Counter()}, "of another actuator than controller 'c'"),
        ({"c": "nothing"}, "controllers must be"),
    ],
    ids=str,
)
def test_refused_before_a_step(controllers, said):
    with pytest.raises(AntennaPinError) as error:
        ran(controllers)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_wheel_is_turned_by_what_is_commanded():
    """Impulse of the commands is the wheel's momentum: each for one period."""
    run = ran({"c": Counter()})
    expected = sum(range(10)) * PERIOD / WHEEL
    assert run.data.motion_rate.values[-1, 0] == pytest.approx(expected, rel=1e-13)


def test_pid_needs_no_joint_where_it_is_its_own(tmp_path):
    named = run_of(dataclasses.replace(PLAIN, measures="angle joint"))
    assert (named.data.q.values == run_of(PLAIN).data.q.values).all()


def test_only_states_of_controllers_change():
    """Whoever keeps a state between instants writes to it; what it was set to stays."""
    states = {one.__name__ for one in dataclasses_of("control") if not one.__dataclass_params__.frozen}
    assert states == {"BangBangState", "PidState"}
