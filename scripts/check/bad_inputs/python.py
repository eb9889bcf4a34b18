"""Bad inputs: calls in Python."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any, cast

import numpy as np
from bad_inputs.case import FILES, Case
from bad_inputs.results import write_result

from antenna_pin import ErrorScales, RunSettings, Scenario, System, Trajectory, Urdf, load_scenario, simulate
from antenna_pin.base.units import quantity
from antenna_pin.contact import Hertz, LankaraniNikravesh, Tanh
from antenna_pin.joints.geometry import PlanarClearance, RevoluteClearance, SphericalClearance
from antenna_pin.mechanism import build_mechanism
from antenna_pin.run.simulation import Time
from antenna_pin.show.record import record
from antenna_pin.show.report import report


def _load(**more: Any) -> Scenario:
    return load_scenario("scenario.toml", **more)


def _scenario(**overrides: Any) -> Scenario:
    return _load(overrides={k.replace("__", "."): v for k, v in overrides.items()})


def _run() -> Trajectory:
    return Trajectory.load("run.nc")


def _simulated(**more: Any) -> Trajectory:
    return simulate(_scenario(), **more)


def _set(**settings: Any) -> Trajectory:
    return _simulated(settings=RunSettings(**settings))


def _pair() -> Urdf:
    return Urdf.load("pair.urdf")


def _built(**more: Any) -> Any:
    return build_mechanism(_pair(), **more)


_DEEP = functools.reduce(lambda value, _: {"a": value}, range(2000), cast(Any, 1.0))
_ITSELF: dict[str, Any] = {}
_ITSELF["a"] = _ITSELF
_HUGE = 10**5000
_SIZES = dict.fromkeys(("bearing_radius", "bearing_length", "axial_clearance"), 1.0)
_from_clearances, _socket = RevoluteClearance.from_clearances, SphericalClearance
_tanh = functools.partial(Tanh, transition_speed=1.0)
_SIZES |= dict.fromkeys(("bearing_outer_radius", "flange_radius"), 2.0)

_CALLS: Mapping[str, tuple[Callable[[], Any], str]] = {
    "scenario: number for a name": (lambda: load_scenario("3"), "3"),
    "scenario: name with a null": (lambda: load_scenario("a\0b"), ""),
    "scenario: name with a surrogate": (lambda: load_scenario("a\ud800"), ""),
    "scenario: name of 100,000 letters": (lambda: load_scenario("a" * 100_000), "letters"),
    "scenario: case of no name": (lambda: _load(case=""), "case"),
    "override: object": (lambda: _scenario(title=object()), "must be a number"),
    "override: None": (lambda: _scenario(title=None), "must be a number"),
    "override: bytes": (lambda: _scenario(title=b"a"), "must be a number"),
    "override: complex": (lambda: _scenario(duration=1j), "must be a number"),
    "override: nan": (lambda: _scenario(duration=math.nan), "not finite"),
    "override: integer of 5,000 digits": (lambda: _scenario(duration=_HUGE), "duration"),
    "override: tables 2,000 deep": (lambda: _scenario(drives=_DEEP), "deep"),
    "override: a table in itself": (lambda: _scenario(drives=_ITSELF), "deep"),
    "override: NumPy matrix": (lambda: _scenario(mechanism__gravity=np.eye(3)), "gravity"),
    "override: NumPy dates": (lambda: _scenario(duration=np.datetime64("2020-01-01")), "duration"),
    "override: empty key": (lambda: _load(overrides={"": 1}), "keys joined by dots"),
    "override: key with a line end": (lambda: _load(overrides={"a\nb": 1}), "a\\nb"),
    "override: text without =": (lambda: _load(overrides="rtol"), "overrides must be"),
    "scenario JSON: none": (lambda: Scenario.model_validate_json(""), "JSON"),
    "scenario JSON: nested": (lambda: Scenario.model_validate_json("[" * 10_000), "JSON"),
    "scenario JSON: a number": (lambda: Scenario.model_validate_json("3"), ""),
    "scenario: a list": (lambda: Scenario.model_validate([]), ""),
    "scenario: nothing": (lambda: Scenario(), "duration is missing"),
    "settings: rtol 5": (lambda: RunSettings(rtol=5), "rtol must be"),
    "settings: rtol below round-off": (lambda: RunSettings(rtol=1e-18), "round-off"),
    "settings: rtol nan": (lambda: RunSettings(rtol=math.nan), "rtol must be"),
    "settings: rtol text": (lambda: RunSettings(rtol="small"), "rtol must be"),
    "settings: rtol of 5,000 digits": (lambda: RunSettings(rtol=_HUGE), "rtol must be"),
    "settings: min_step > max_step": (lambda: RunSettings(min_step=1.0, max_step=0.1), "min_step must be"),
    "settings: scales 1": (lambda: RunSettings(scales=1), "scales must be"),
    "settings: scales None": (lambda: RunSettings(scales=None), "scales must be"),
    "settings: steps of half": (lambda: RunSettings(max_steps=1.5), "max_steps must be"),
    "settings: steps zero": (lambda: RunSettings(max_steps=0), "max_steps must be"),
    "settings: method": (lambda: RunSettings(method="euler"), "method must be"),
    "settings: rate infinite": (lambda: RunSettings(output_rate=math.inf), "output_rate must be"),
    "scales: angle zero": (lambda: ErrorScales(angle=0.0), "angle must be"),
    "scales: angle true": (lambda: ErrorScales(angle=True), "angle must be"),
    "simulate: nothing": (lambda: simulate(None), "model must be"),
    "simulate: a file that is not there": (lambda: simulate("nothing.toml"), "nothing.toml"),
    "simulate: duration nan": (lambda: _simulated(duration=math.nan), "duration must be"),
    "simulate: duration of mass": (lambda: _simulated(duration="1 kg"), "duration must be a time"),
    "simulate: events a table": (lambda: _simulated(events={"a": 1}), "events must be"),
    "simulate: events of numbers": (lambda: _simulated(events=[1]), "events must be"),
    "event: times in a list": (lambda: Time([0.1]), "instants must be"),
    "system: no mechanism": (lambda: System(None), "mechanism must be"),
    "simulate: duration true": (lambda: _simulated(duration=True), "duration must be"),
    "simulate: duration of 5,000 digits": (lambda: _simulated(duration=_HUGE), "duration must be"),
    "simulate: duration without end": (lambda: _simulated(duration=1e30), "in a run of"),
    "simulate: q of text": (lambda: _simulated(q=["a"]), "q must"),
    "simulate: q of one": (lambda: _simulated(q=[0.0]), "q must"),
    "simulate: q nan": (lambda: _simulated(q=[math.nan] * 14), "q must"),
    "simulate: v of one": (lambda: _simulated(v=[0.0]), "v must"),
    "simulate: v infinite": (lambda: _simulated(v=[math.inf] * 12), "v must"),
    "simulate: angles of no joint": (lambda: _simulated(angles={"x": 0.0}), "x"),
    "simulate: start and q": (lambda: _simulated(start=_run().end, q=[0.0]), "omitted if start"),
    "simulate: start of another": (lambda: simulate(load_scenario("pendulum"), start=_run().end), ""),
    "simulate: step without end": (lambda: _set(method="rk4", step=1e-20), "step must be"),
    "simulate: samples without end": (lambda: _set(output_rate=1e12), "output_rate must be"),
    "load: not there": (lambda: Trajectory.load("no.nc"), "no such file"),
    "load: a folder": (lambda: Trajectory.load("."), ""),
    "load: a null": (lambda: Trajectory.load("a\0"), ""),
    "save: no folder": (lambda: _run().save("no/run.nc"), "does not exist"),
    "save: a folder": (lambda: _run().save("."), "got a folder"),
    "save: a null": (lambda: _run().save("a\0.nc"), "file"),
    "URDF: empty text": (lambda: Urdf.from_text("", "u"), "not well-formed"),
    "URDF: surrogate": (lambda: Urdf.from_text("<robot name='\ud800'/>", "u"), "not well-formed"),
    "URDF: null": (lambda: Urdf.from_text("<robot name='\0'/>", "u"), "not well-formed"),
    "URDF: not there": (lambda: Urdf.load("no.urdf"), "cannot be read"),
    "URDF: a folder": (lambda: Urdf.load("."), "cannot be read"),
    "URDF: impossible link": (lambda: Urdf.load("pair.urdf", ["x"]), "'x'"),
    "URDF: joint unknown": (lambda: _pair().joint("x"), "'x'"),
    "URDF: kind of a variant": (lambda: _pair().variant({"hinge": "x"}), "'x'"),
    "URDF: joint of a variant": (lambda: _pair().variant({"x": "free"}), "'x'"),
    "URDF: mass of a link without": (lambda: _pair().mass_properties("x"), "'x'"),
    "mechanism: base": (lambda: _built(base="x"), "base"),
    "mechanism: gravity of two": (lambda: _built(gravity=(0.0, 1.0)), "gravity"),
    "mechanism: gravity nan": (lambda: _built(gravity=(0.0, 0.0, math.nan)), "gravity"),
    "law: stiffness negative": (lambda: Hertz(stiffness=-1.0), "stiffness must be"),
    "law: restitution": (lambda: LankaraniNikravesh(stiffness=1.0, restitution=2.0), "restitution must be"),
    "law: friction negative": (
        lambda: _tanh(coefficient_of_friction=-1),
        "coefficient_of_friction must be",
    ),
    "geometry: ball larger than socket": (lambda: _socket(socket_radius=1.0, ball_radius=2.0), "must be"),
    "geometry: journal larger": (lambda: PlanarClearance(bearing_radius=1.0, journal_radius=2.0), "must be"),
    "geometry: clearance nan": (lambda: _from_clearances(**_SIZES, radial_clearance=math.nan), "must be"),
    "record: a file": (lambda: record("run.nc"), ""),
    "record: speed": (lambda: record(_run(), speed=math.inf), "speed"),
    "record: view": (lambda: record(_run(), view="side"), "view"),
    "record: megabytes": (lambda: record(_run(), max_megabytes=-1.0), "max_megabytes"),
    "report: nothing": (lambda: report([]), ""),
    "report: a missing file": (lambda: report(["no.nc"]), "no such file"),
    "report: window": (lambda: report([_run()], window=0.0), "window"),
    "quantity: a list": (lambda: quantity([1], "m", "here"), "here must be a length"),
    "quantity: None": (lambda: quantity(None, "m", "here"), "here must be a length"),
    "quantity: complex": (lambda: quantity(1j, "m", "here"), "here must be a length"),
    "quantity: 5,000 digits": (lambda: quantity(_HUGE, "m", "here"), "here must be a length"),
}


def cases() -> Iterator[Case]:
    """Yield all of them."""
    files = FILES | {"run.nc": write_result}
    for name, (call, says) in _CALLS.items():
        yield Case("python", name, says, call, files)
