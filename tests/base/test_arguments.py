"""Arguments of a wrong kind are refused in one line; text with a unit is read."""

import dataclasses
import importlib
import inspect
import math
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal, Protocol

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from antenna_pin import AntennaPinError, RunSettings, System, load_scenario, simulate
from antenna_pin.analysis import scenario_rows
from antenna_pin.base.arguments import fits, rule_of, takes
from antenna_pin.base.parameters import parameters_of
from antenna_pin.base.rules import Positive
from antenna_pin.dynamics.constraints import Closure
from antenna_pin.elements import (
    DRIVES,
    GEARS,
    REFERENCES,
    SPRINGS,
    JointSpring,
    MaxwellSlip,
    PointSpring,
    SineDrive,
)
from antenna_pin.errors import InvalidParameterError
from antenna_pin.joints.geometry import PlanarClearance
from antenna_pin.run.simulation import Angle, Event, Gap, Set, Stop, Time

#: What people build systems of in Python, and call.
ROOMS = {
    "antenna_pin": (
        "ClearanceJoint Closure ErrorScales RunSettings System build_mechanism build_system "
        "load_scenario load_study open_study run_study simulate"
    ),
    "antenna_pin.scenario.assemble": "initial_state",
    "antenna_pin.dynamics.constraints": "Anchor",
    "antenna_pin.dynamics": "assembled",
    "antenna_pin.studies.linear": "modes",
    "antenna_pin.contact": None,
    "antenna_pin.elements": None,
    "antenna_pin.joints.geometry": "PlanarClearance PrismaticClearance RevoluteClearance SphericalClearance",
    "antenna_pin.run.simulation": "Angle Event Force Gap Jump Rate Set Time",
    "antenna_pin.show.record": "record",
    "antenna_pin.show.report": "report",
}
WRONG = (None, {}, {"a": 1}, [], [1, "b"], "x", True, object(), (None,), float, b"x", 1j)


class Thing:
    """What nobody takes."""


def _public():
    for room, names in ROOMS.items():
        module = importlib.import_module(room)
        for name in names.split() if names else module.__all__:
            one = getattr(module, name)
            if names or (inspect.isclass(one) and hasattr(one, "__dataclass_fields__")):
                yield pytest.param(one, id=f"{room}.{name}")


@pytest.mark.parametrize("one", list(_public()))
def test_what_is_of_a_wrong_kind_is_refused_in_one_line(one):
    """All that must be given is wrong; then each of the others is. A Python error from inside fails here."""
    parameters = inspect.signature(one).parameters.values()
    plain = [p for p in parameters if p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)]
    optional = [p.name for p in plain if p.default is not p.empty]
    for wrong in WRONG:
        several = (wrong,) if any(p.kind is p.VAR_POSITIONAL for p in parameters) else ()
        needed = {p.name: wrong for p in plain if p.default is p.empty}
        for name in ["", *optional]:
            given = {**needed, **({name: Thing()} if name else {})}
            try:
                one(*several, **given)
            except AntennaPinError as error:
                assert "\n" not in str(error), (wrong, name)
                assert len(str(error)) < 1200, (wrong, name)
            else:  # some take text, none at all, or any number of things
                assert not name, (wrong, name)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (
            lambda: simulate(_pendulum(), events={"a": 1}),
            "simulate: events must be a sequence of Event, got a",
        ),
        (
            lambda: simulate(_pendulum(), progress=lambda: None),
            "simulate: progress must be a function of 1 argument, got one of ()",
        ),
        (
            lambda: simulate(_pendulum(), duration="1 kg"),
            "simulate: duration must be a time [s], got '1 kg' (mass)",
        ),
        (
            lambda: Time([0.1]),
            "Time: instants must be a number or text, in s or with a unit, got [0.1] (list)",
        ),
        (
            lambda: JointSpring(joint="a", stiffness="1 N/m", damping="1 N*m*s/rad"),
            "JointSpring: damping must be for a sliding joint, as stiffness is, got '1 N*m*s/rad' (turning)",
        ),
        (lambda: Angle("a", "1 s"), "Angle: value must be an angle [rad] or a length [m], got '1 s' (time)"),
        (lambda: Event(name="a", when=Time(1), action="stop"), "Event: action must be a Mark, a Stop, a Set"),
        (lambda: System([]), "System: mechanism must be a Mechanism, got [] (list)"),
        (lambda: System(_mechanism(), springs=["a"]), "System: springs must be a mapping of names to"),
        (
            lambda: Closure(kind="planar", first=None, second=None),
            "Closure: first must be an Anchor, got None",
        ),
        (
            lambda: JointSpring(joint="a", stiffness="1 N"),
            "JointSpring: stiffness must be a torsional stiffness [N*m/rad] or a stiffness [N/m], got '1 N'",
        ),
        (lambda: RunSettings(method=["rk4"]), "RunSettings: method must be rk4, bogacki-shampine-32,"),
    ],
)
def test_refusals_name_parameter_rule_and_value(call, says):
    with pytest.raises(InvalidParameterError) as error:
        call()
    assert str(error.value).startswith(says)


def test_text_with_a_unit_is_taken_wherever_a_unit_is_declared():
    spring = JointSpring(joint="j", stiffness="0.4 N*m/rad", damping="2 mNm·s/rad", rest_angle="90 deg")
    assert (spring.stiffness, spring.damping) == (0.4, 0.002)
    assert spring.rest_angle == pytest.approx(math.pi / 2, rel=1e-15)
    assert JointSpring(joint="j", stiffness="0.4 N/mm").stiffness == 400.0
    assert Angle("a", "0.5 rad") == Angle("a", 0.5)
    assert Angle("a", "20 mm").value == 0.02
    assert MaxwellSlip(joint="j", stiffness=("1 Nm/rad", 2.0), slip=("3 mNm", 4.0)).slip == (0.003, 4.0)
    assert PlanarClearance(bearing_radius="5.1 mm", journal_radius="5 mm").bearing_radius == 0.0051


def test_every_declared_number_of_elements_takes_its_unit():
    """Also that of a sliding joint; elements that need more than numbers and a joint aside."""
    made = 0
    for cls in {*DRIVES.values(), *SPRINGS.values(), *GEARS.values(), *REFERENCES.values()}:
        needed = {one.name for one in dataclasses.fields(cls) if one.default is dataclasses.MISSING}
        declared = parameters_of(cls)
        for sliding in (False, True):
            units = {
                name: one.sliding if sliding and one.sliding else one.unit for name, one in declared.items()
            }
            single = {name for name in units if not declared[name].sizes and "**" not in units[name]}
            given = {name: f"0.5 {units[name]}" for name in needed & single}
            try:
                one = cls(**given, **({"joint": "a"} if "joint" in needed else {}))
            except (TypeError, InvalidParameterError) as error:  # a field that is no number, or left out
                assert "got '0.5" not in str(error)
                continue
            made += 1
            assert all(getattr(one, name) == 0.5 for name in given), cls
    assert made > 15


def _pendulum():
    return load_scenario("pendulum")


def _mechanism():
    from antenna_pin import build_system

    return build_system(_pendulum()).mechanism


def test_text_with_a_unit_is_read_as_scenarios_read_it():
    """One run of each: the same to the last bit, and the same in the result's own scenario."""
    plain = simulate(_pendulum(), duration=0.002, settings=RunSettings(output_rate=2000.0, max_step=1e-3))
    text = simulate(
        _pendulum(), duration="2 ms", settings=RunSettings(output_rate="2 kHz", max_step="1 ms"),
        checkpoint="1 h", events=[],
    )  # fmt: skip
    assert text.end == plain.end
    assert text.scenario == plain.scenario
    assert Time("0.1 s", 0.2).instants == (0.1, 0.2)
    assert Gap("a", "0.1 mm").value == 1e-4
    assert RunSettings(output_times=("1 ms", 2)).output_times == (0.001, 2.0)
    drive = SineDrive(joint="a", amplitude=1.0, frequency="1 kHz")
    assert (drive.frequency, drive.phase) == (1000.0, 0.0)
    ends = {"first": ("a", (0, 0, 0)), "second": ("b", (0, 0, 0))}
    assert PointSpring(free_length="5 mm", stiffness="2 N/mm", **ends).stiffness == 2000.0


class _Named(Protocol):
    name: str

    def called(self) -> int: ...


class _Yes:
    name = "a"

    def called(self):
        return 1


@pytest.mark.parametrize(
    ("hint", "good", "bad", "rule"),
    [
        (float, (1, 1.5, np.float32(2), np.int64(3), np.array(1.0)), (True, "1", None, 1j, []), "a number"),
        (int, (1, np.int32(2)), (1.5, True, "1"), "a whole number"),
        (bool, (True, np.bool_(False)), (1, 0.0, "yes"), "true or false"),
        (float | None, (None, 1.0), ("a", [], True), "a number"),
        (Sequence[float], ([1, 2.0], (), np.zeros(3)), ("12", {1: 2}, [1, "a"], 3), "a sequence of numbers"),
        (tuple[float, float], ((1, 2), [1.0, 2.0]), ((1,), (1, "a"), 3, "ab"), "2 of numbers"),
        (Mapping[str, float], ({"a": 1}, {}), ([], {"a": "b"}, {1: 1.0}), "a mapping of names to numbers"),
        (ArrayLike, ([1, 2], 3.0, np.eye(2), []), ("a", {}, None, ["a"], Thing(), 1j), "an array of numbers"),
        (NDArray[np.complex128], (np.ones(2) * 1j,), ("a", None), "an array of numbers"),
        (Iterable[int], ({1: "a"}, [1]), ({"a": 1}, ["a"], 3), "a sequence of whole numbers"),
        (Callable[[float], float], (abs, Thing), (3, "a", None), "a function"),
        (Literal["a", "b"], ("a", "c"), (1, None, ["a"]), "'a' or 'b'"),  # which text is the owner's to say
        (_Named, (_Yes(),), (Thing(), 3), "a _Named"),
        (Stop | Set, (Stop(), Set("a.b", 1.0)), (Stop, "stop"), "a Stop or a Set"),
        (Any, (None, 1, "a", Thing()), (), None),
    ],
)  # fmt: skip
def test_what_fits_a_type(hint, good, bad, rule):
    assert [one for one in good if not fits(one, hint)] == []
    assert [one for one in bad if fits(one, hint)] == []
    if rule:
        assert rule_of(hint) == rule


def test_a_decorated_function_stays_what_it_was():
    @takes(reach="m")
    def far(name: str, *ways: float, reach: "float | str" = 1.0, unknown: "NotThere" = None) -> float:  # noqa: F821
        """Say how far."""
        return sum(ways) + reach

    assert far("a", 1, 2, reach="5 mm", unknown=object()) == 3.005
    assert far.__doc__ == "Say how far."
    assert typing.get_type_hints(far, localns={"NotThere": int})["ways"] is float
    with pytest.raises(InvalidParameterError, match="far: ways must be a number, got 'b'"):
        far("a", 1, "b")
    with pytest.raises(TypeError, match="missing a required argument"):  # Python's own, of the call itself
        far()


def test_what_fitted_once_does_not_let_others_pass():
    """Neither a type that fits by its unit, nor by its rule, nor by what it holds."""

    @takes(reach="m")
    def far(reach: "float | str", size: Positive = 1.0, ways: Sequence[float] = ()) -> float:
        """Return it."""
        return reach

    assert [far("5 mm"), far(1.0, 2.0, [3.0]), far("6 mm")] == [0.005, 1.0, 0.006]
    for wrong in ({"reach": "5 s"}, {"size": -2.0}, {"ways": ["a"]}, {"reach": [1.0]}):
        with pytest.raises(InvalidParameterError, match=f"far: {next(iter(wrong))} must be"):
            far(**{"reach": 1.0, "size": 2.0, "ways": [3.0], **wrong})


#: Rooms whose functions people call with values of their own; the others' are called by these.
CALLED = (
    "analysis antenna_pin assemble contact linear mechanism nonlinear plot record report "
    "scenario simulation law_studies sweep"
)

#: Without a check, for `antenna-pin list` is not to wait for NumPy: they take a name and refuse others by it.
#: One that hands on what is no name is checked by whom it hands it to.
UNCHECKED = ("scenario_cases", "scenario_summary", "scenario_named")


def _functions():
    for room in CALLED.split():
        module = importlib.import_module("antenna_pin" if room == "antenna_pin" else f"antenna_pin.{room}")
        for name in module.__all__:
            function = getattr(module, name)
            if (
                name not in UNCHECKED
                and inspect.isfunction(function)
                and inspect.signature(function).parameters
            ):
                yield pytest.param(function, id=f"{room}.{name}")


@pytest.mark.parametrize("function", list(_functions()))
def test_a_function_names_itself_the_argument_and_what_it_got(function):
    """Of what no function takes, as its first argument."""
    first, *others = inspect.signature(function).parameters.values()
    several = first.kind is first.VAR_POSITIONAL
    needed = {
        one.name: Thing() for one in others if one.default is one.empty and one.kind is not one.VAR_KEYWORD
    }
    if first.kind is first.KEYWORD_ONLY:
        needed[first.name] = Thing()
    place = f"{function.__name__}: {first.name} must be "
    with pytest.raises(AntennaPinError) as error:
        function(*([] if first.kind is first.KEYWORD_ONLY else [Thing()]), **needed)
    assert str(error.value).startswith(place) or several
    assert "(Thing)" in str(error.value)


def test_what_an_iterator_gives_is_looked_at_as_it_comes():
    with pytest.raises(InvalidParameterError, match="scenario_rows: pairs must be a .*, got one of 3"):
        scenario_rows(k for k in (3, 4))


def test_arrays_are_told_where_numpy_names_them_by_aliases(monkeypatch):
    """From NumPy 2.5 on both are aliases of their own (PEP 695), whose parts nobody sees.

    Then arrays would be refused that are asked for, and a union take any.
    """
    from typing_extensions import TypeAliasType, TypeVar

    from antenna_pin.base import arguments

    kind = TypeVar("kind")
    either = TypeAliasType("ArrayLike", ArrayLike)
    array = TypeAliasType("NDArray", np.ndarray[Any, np.dtype[kind]], type_params=(kind,))
    monkeypatch.setattr(arguments, "ArrayLike", either)
    monkeypatch.setattr(arguments, "_ARRAYS", (np.ndarray, array))
    for hint in (either, array[np.float64], Literal["x"] | either):
        assert fits([[1.0, 0.0], [0.0, 1.0]], hint) and fits(np.eye(3), hint)
        assert not fits({}, hint) and not fits(object(), hint)
    assert not fits(np.eye(3), Thing | None)
    assert rule_of(array[np.float64]) == "an array of numbers"
    assert rule_of(either | str) == "an array of numbers or text"
