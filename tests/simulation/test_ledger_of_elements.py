"""Every kind of element: its energy balances, and the alarm goes off where it is misstated by a hundredth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from antenna_pin import Outcome, Scenario, System, Trajectory, load_scenario, simulate
from antenna_pin.elements import FAMILIES, CallableDrive, CallableElement, CallableForce, CallableMotion
from antenna_pin.errors import LedgerOpenWarning
from antenna_pin.run.simulation import recorder, variables
from antenna_pin.scenario.assemble import build_system, initial_state

LINK = """
  <link name="{name}">
    <inertial><origin xyz="0.3 0 0"/><mass value="2"/>
      <inertia ixx="0.05" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
"""
JOINT = """
  <joint name="{name}" type="{kind}">
    <parent link="hull"/><child link="{name}"/><origin xyz="0 {y} 0"/><axis xyz="{axis}"/>{limit}
  </joint>
"""
LIMIT = '<limit lower="-9" upper="9" effort="100" velocity="100"/>'
URDF = (
    '<robot name="rig"><link name="hull"><inertial><mass value="5"/>'
    '<inertia ixx="0.5" iyy="0.5" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    + "".join(LINK.format(name=name) for name in "abs")
    + JOINT.format(name="a", kind="revolute", y=0.5, axis="0 0 1", limit=LIMIT)
    + JOINT.format(name="b", kind="revolute", y=-0.5, axis="0 0 1", limit=LIMIT)
    + JOINT.format(name="s", kind="prismatic", y=0.0, axis="1 0 0", limit=LIMIT)
    + "</robot>"
)
#: Of each joint at the start.
MOVING = {"a": {"velocity": 1.0}, "b": {"velocity": -0.4}, "s": {"velocity": 0.5}}
BRISTLES = {"coulomb": 0.3, "stiffness": 20.0}
SWING = {"amplitude": 0.2, "frequency": 1.0, "phase": np.pi / 2}
MESH = {"input": "a", "output": "b"}
STRAND = {"input_radius": 0.1, "output_radius": 0.1, "stiffness": 500.0}
SHAKEN = {"direction": [1, 0, 0]}

#: An example of each kind, by family and kind; the scenario's tables besides where it needs any.
EXAMPLES: dict[tuple[str, str], dict[str, Any]] = {
    ("drives", "constant"): {"value": 0.5},
    ("drives", "sine"): {"amplitude": 0.5, "frequency": 1.0},
    ("drives", "table"): {"time": [0.0, 1.0], "torque": [0.2, -0.6]},
    ("drives", "pd"): {"kp": 4.0, "kd": 0.5, "angle": 0.5},
    ("drives", "motion"): {"rate": 1.0, "coefficients": [-0.5]},
    ("drives", "distance"): {
        "offset": [1.0, 0.5, 0.0],
        "amplitude": [0.3, 0.0, 0.0],
        "frequency": 1.0,
        "phase": [1.5707963267948966, 0.0, 0.0],
    },
    ("drives", "motor"): {"value": 3.0, "torque_constant": 0.5, "resistance": 2.0, "cogging": 0.2},
    ("springs", "spring"): {"stiffness": 5.0, "damping": 0.2},
    ("springs", "friction"): {"damping": 0.1, "friction": 0.2, "regularisation_speed": 0.05},
    ("springs", "between-points"): {
        "first": {"link": "hull", "point": [1.0, 1.0, 0.0]},
        "second": {"link": "a", "point": [0.3, 0.0, 0.0]},
        "free_length": 0.4,
        "stiffness": 20.0,
        "damping": 1.0,
    },
    ("springs", "bouc-wen"): {"alpha": 0.3, "stiffness": 4.0, "yield_angle": 0.1},
    ("springs", "maxwell-slip"): {"stiffness": [2.0, 4.0], "slip": [0.2, 0.1]},
    ("springs", "constant-torque"): {"torque": 0.5, "upper": 0.5, "ramp": 0.1},
    ("springs", "table"): {"angle": [-2.0, 0.0, 2.0], "torque": [3.0, 0.2, -3.0]},
    ("springs", "harness"): {
        "angle": [-2.0, 2.0],
        "torque": [1.0, -2.0],
        "torque_back": [1.5, -1.0],
        "reversal": 0.1,
    },
    ("stops", "compliant"): {"upper": 0.2, "stiffness": 100.0, "restitution": 0.5},
    ("stops", "rigid"): {"upper": 0.2, "restitution": 0.5},
    ("latches", "compliant"): {"angle": 0.2, "width": 0.02, "stiffness": 50.0, "damping": 0.5, "play": 0.01},
    ("latches", "rigid"): {"angle": 0.2, "width": 0.02},
    ("frictions", "sticking"): {"coulomb": 0.3},
    ("frictions", "dahl"): BRISTLES,
    ("frictions", "lugre"): {**BRISTLES, "damping": 0.1},
    ("frictions", "gonthier-bristle"): {
        **BRISTLES,
        "damping": 0.3,
        "static": 0.4,
        "stribeck_rate": 0.1,
        "dwell_time": 0.2,
    },
    ("gears", "gear"): {**MESH, "stiffness": 50.0, "damping": 0.5, "play": 0.05},
    ("gears", "spline"): {**MESH, "stiffness": 50.0, "damping": 0.5, "play": 0.05},
    ("gears", "rack"): {"input": "a", "output": "s", "radius": 0.2, "stiffness": 500.0, "damping": 5.0},
    ("gears", "belt"): {**MESH, **STRAND, "damping": 3.0, "pretension": 5.0},
    ("gears", "cable"): {**MESH, **STRAND, "damping": 3.0},
    ("bearings", "stiffness"): {"radial": 2e4, "axial": 2e4, "tilt": 100.0, "damping_time": 1e-3},
    ("bearings", "balls"): {
        "count": 9,
        "ball_diameter": "6 mm",
        "pitch_diameter": "40 mm",
        "contact_angle": 0.4,
        "preload": 50.0,
        "damping_time": 1e-6,
    },
    ("bearings", "preload"): {"force": 5.0, "stiffness": 2e3, "given_at": "centred"},
    ("shake", "sine"): {**SHAKEN, "frequency": 3.0, "displacement": 0.05},
    ("shake", "sweep"): {
        **SHAKEN,
        "start_frequency": 5.0,
        "end_frequency": 15.0,
        "hertz_per_second": 10.0,
        "displacement": 0.05,
    },
    ("shake", "random"): {
        **SHAKEN,
        "frequency": [2.0, 10.0],
        "density": [1.0, 1.0],
        "period": 2.0,
        "seed": 5,
    },
    ("shake", "table"): {**SHAKEN, "of": "velocity", "time": [0.0, 0.5, 1.0], "course": [0.0, 1.0, 0.0]},
    ("forces", "force"): {"at": {"link": "a", "point": [0.3, 0.0, 0.0]}, "force": [0.0, 2.0, 0.0]},
    ("forces", "thruster"): {
        "at": {"link": "hull", "point": [0.0, 0.3, 0.0]},
        "direction": [1, 0, 0],
        "thrust": 2.0,
        "starts": [0.1],
        "durations": [0.3],
    },
    ("forces", "gravity-gradient"): {"rate": 3.0},
}
#: A joint with play, in place of one without.
PLAY = {
    "model": "contact",
    "bearing_radius": "10 mm",
    "radial_clearance": "0.1 mm",
    "bearing_length": "20 mm",
    "axial_clearance": "4 mm",
    "bearing_outer_radius": "15 mm",
    "flange_radius": "20 mm",
    "journal_material": "steel",
    "bearing_material": "steel",
    "normal": {"law": "lankarani-nikravesh", "restitution": 0.9},
    "friction": {"law": "tanh", "coefficient_of_friction": 0.1, "transition_speed": "1 mm/s"},
    "geometry": "closed-form",
}
#: Tables of the scenario besides, where the rig as it is does not do.
BESIDES: dict[tuple[str, str], dict[str, Any]] = {
    ("bearings", "preload"): {"clearance.a": PLAY},
    ("drives", "distance"): {"initial.joints.s": {"guess": True, "velocity": 0.0}},
    ("forces", "gravity-gradient"): {"mechanism.base": "free"},
    ("forces", "thruster"): {"mechanism.base": "free"},
}
#: Joints that elements hang on if not "a"; names of tables that are none of a joint.
NAMES = {("drives", "distance"): "s", ("springs", "between-points"): "line"}
UNNAMED = {"gears": "mesh", "shake": "x", "forces": "outside"}

SCENARIO = """
format = 1
duration = "1 s"
[mechanism]
urdf = "rig.urdf"
base = "fixed"
gravity = [0.0, 0.0, 0.0]
[initial.joints]
a = { velocity = 1.0 }
b = { velocity = -0.4 }
s = { velocity = 0.5 }
[output]
rate = 100
"""
#: By how much an entry of the ledger is misstated.
WRONG = 1.01
#: Parts of the ledger: series of what is integrated; of what is stored, where a sample has it.
PARTS = {
    "works": ("drive_work", "force_work"),
    "losses": ("dissipation_damper", "element_loss", "force_loss"),
    "lost in contact": ("dissipation_normal",),
    "lost to friction in contact": ("dissipation_friction",),
}
STORED = {
    "springs": ("spring_energy", "element_energy", "force_energy"),
    "contacts": ("contact_energy",),
}


@pytest.fixture
def rig(tmp_path: Path) -> Scenario:
    (tmp_path / "rig.urdf").write_text(URDF)
    (tmp_path / "scenario.toml").write_text(SCENARIO)
    return load_scenario(tmp_path / "scenario.toml")


def with_element(rig: Scenario, family: str, kind: str) -> tuple[Scenario, dict[str, Any]]:
    """Return the rig with an element, and how it starts if not as the rig does."""
    name = NAMES.get((family, kind), UNNAMED.get(family, "a"))
    table = {"kind": kind, **EXAMPLES[family, kind]}
    scenario = rig.with_overrides({f"{family}.{name}": table, **BESIDES.get((family, kind), {})})
    if family != "bearings":
        return scenario, {}
    # Along the axis alone: all goes into the bearing, and a preload does not lift off.
    return scenario, {"v": pushed(scenario, 2, 0.02 if kind == "preload" else 0.2)}


def pushed(scenario: Scenario, axis: int, speed: float) -> np.ndarray:
    """Return the velocity at which the journal of joint "a" alone moves, along an axis of its own [m/s]."""
    system = build_system(scenario)
    v = np.zeros(system.model.nv)
    v[system.mechanism.joint("a").v.start + axis] = speed
    return v


def misstate(monkeypatch: pytest.MonkeyPatch, part: str) -> None:
    """Have all results state a part of the ledger by a hundredth too large, as a wrong kernel would.

    What is integrated along a run and what is stored act on nothing: the motion is the same.
    """
    if part in STORED:
        right = recorder.observed

        def observed(*given: Any) -> Any:
            found = right(*given)
            found.audit[part] *= WRONG
            return found

        monkeypatch.setattr(recorder, "observed", observed)
        return
    ledger = variables.SampleBlock.ledger.func

    def wrong(one: variables.SampleBlock) -> dict[str, Any]:
        names = PARTS.get(part, (part,))
        return {name: (WRONG if name in names else 1.0) * of for name, of in ledger(one).items()}

    monkeypatch.setattr(variables.SampleBlock, "ledger", property(wrong))


def parts_of(run: Trajectory) -> list[str]:
    """Return the parts of the ledger that change."""
    names = [(part, name) for part, of in (STORED | PARTS).items() for name in of if name in run.data]
    changes = ((part, np.ptp(run.data[name].values, axis=0).max(initial=0.0)) for part, name in names)
    return list(dict.fromkeys(part for part, change in changes if change > 0.0))


def check_alarm(model: Scenario | System, monkeypatch: pytest.MonkeyPatch, **how: Any) -> None:
    """Run it as it is, then with each part of its ledger that has moved misstated."""
    right = simulate(model, **how)
    assert right.outcome is Outcome.COMPLETED, right.message
    parts = parts_of(right)
    assert parts  # an element whose energy is nothing says nothing of the alarm
    for part in parts:
        with monkeypatch.context() as patch:
            misstate(patch, part)
            with pytest.warns(LedgerOpenWarning, match="the energy balance is off by"):
                wrong = simulate(model, **how)
        assert wrong.outcome is Outcome.LEDGER_OPEN, part
        assert not wrong.completed
        np.testing.assert_array_equal(wrong.data["q"].values, right.data["q"].values)  # all is kept


KINDS = [(table, kind) for table, family in FAMILIES.items() for kind in family.kinds]


@pytest.mark.parametrize(("family", "kind"), KINDS, ids=[".".join(one) for one in KINDS])
def test_an_element_whose_energy_is_misstated_opens_the_ledger(rig, family, kind, monkeypatch):
    """A kind that is registered is tried by itself: it needs an example above."""
    scenario, how = with_element(rig, family, kind)
    check_alarm(scenario, monkeypatch, **how)


def system_of(rig: Scenario, **elements: Any) -> tuple[System, dict[str, Any]]:
    """Return the rig with elements in Python, and where it starts."""
    built = build_system(rig)
    q, v = initial_state(rig, built)
    return System(built.mechanism, **elements), {"q": q, "v": v, "duration": 1.0}


def pulls(t: float, p: Any, links: Any, joints: Any, states: Any, whole: Any) -> None:
    """Pull two links together as a spring does, and say what is stored in it."""
    way = links[1].place - links[0].place
    links[0].force[:] = p[0] * way
    links[1].force[:] = -p[0] * way
    whole.energy = 0.5 * p[0] * (way @ way)


IN_PYTHON = {
    "CallableDrive": lambda: {"drives": {"a": CallableDrive(joint="a", torque=lambda t, a, r: -2.0 * a)}},
    "CallableMotion": lambda: {
        "drives": {
            "a": CallableMotion(
                joint="a", position=np.sin, velocity=np.cos, acceleration=lambda t: -np.sin(t)
            )
        }
    },
    "CallableElement": lambda: {
        "elements": {
            "forces": {
                "line": CallableElement(
                    act=pulls,
                    links=(("hull", (1.0, 1.0, 0.0)), ("a", (0.3, 0.0, 0.0))),
                    parameters={"k": 5.0},
                    passive=True,
                )
            }
        }
    },
    "CallableForce": lambda: {
        "elements": {
            "forces": {
                "drag": CallableForce(
                    at=("a", (0.3, 0.0, 0.0)), wrench=lambda t, pose, twist: [*(-2.0 * twist[:3]), 0, 0, 0]
                )
            }
        }
    },
}


@pytest.mark.parametrize("kind", IN_PYTHON)
def test_an_element_in_python_likewise(rig, kind, monkeypatch):
    system, how = system_of(rig, **IN_PYTHON[kind]())
    check_alarm(system, monkeypatch, **how)


def test_every_element_in_python_has_an_example():
    drives = {"CallableDrive", "CallableMotion"}
    assert {name for family in FAMILIES.values() for name in family.in_python} | drives == set(IN_PYTHON)


def test_contacts_likewise(rig, monkeypatch):
    """The journal is thrown across its play and struck off centre: all goes through contacts."""
    scenario = rig.with_overrides({"clearance.a": PLAY, "duration": 0.05, "output.rate": 1e4})
    how = {"v": pushed(scenario, 1, 0.1)}
    parts = {"contacts", "lost in contact", "lost to friction in contact"}
    assert set(parts_of(simulate(scenario, **how))) == parts
    check_alarm(scenario, monkeypatch, **how)


@pytest.mark.parametrize(
    ("name", "series"), [("linear", "force_impulse"), ("angular", "force_central_impulse")]
)
def test_a_thruster_whose_impulse_is_misstated_opens_the_ledger_of_momentum(rig, name, series, monkeypatch):
    scenario, _ = with_element(rig, "forces", "thruster")
    misstate(monkeypatch, series)
    # Of 2 N for 0.3 s a hundredth is missing: 6 mN s, at once as the jet is on.
    with pytest.warns(LedgerOpenWarning, match=rf"^at t = 0.11\d* s {name} momentum is off by"):
        run = simulate(scenario)
    assert run.outcome is Outcome.LEDGER_OPEN
    if name == "linear":
        assert run.summary()["conservation"]["linear_momentum_drift"] == pytest.approx(
            6e-3, rel=1e-3
        )  # the hull turns
