"""Loops and motions that cannot be: one clear line each, before any step is made; and what ends a run."""

import math
import re

import pytest
from typer.testing import CliRunner

from antenna_pin import Outcome, load_scenario, simulate
from antenna_pin.apps.cli import app
from antenna_pin.errors import AntennaPinError

BODY = """<link name="{0}"><inertial><origin xyz="{1} 0 0"/><mass value="0.3"/>
  <inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """<joint name="{0}" type="{4}"><parent link="{1}"/><child link="{2}"/><origin xyz="{3} 0 0"/>
  <axis xyz="{5}"/><limit lower="{6}" upper="{7}" effort="1" velocity="1"/></joint>"""

# A crank of 50 mm, a rod of 120 mm and a slider along x.
SLIDER_CRANK = "\n".join(
    [
        '<robot name="slider_crank"><link name="ground"/><link name="mount"/>',
        '<joint name="mounted" type="fixed"><parent link="ground"/><child link="mount"/></joint>',
        *(BODY.format(*row) for row in (("crank", 0.025), ("rod", 0.06), ("slider", 0.0))),
        JOINT.format("main", "ground", "crank", 0, "continuous", "0 -1 0", 0, 0),
        JOINT.format("big_end", "crank", "rod", 0.05, "continuous", "0 -1 0", 0, 0),
        JOINT.format("way", "ground", "slider", 0, "prismatic", "1 0 0", 0.0, 0.2),
        "</robot>",
    ]
)
SCENARIO = """
duration = "20 ms"
[mechanism]
urdf = "slider_crank.urdf"
base = "fixed"
[closures.pin]
kind = "revolute"
first = { link = "rod", point = ["120 mm", 0, 0], axis = [0, -1, 0] }
second = { link = "slider", point = [0, 0, 0], axis = [0, -1, 0] }
[drives.motor]
kind = "motion"
joint = "main"
position = "20 deg"
rate = "100 rad/s"
"""
WITHOUT_MOTOR = SCENARIO[: SCENARIO.index("[drives.motor]")]


@pytest.fixture
def run(tmp_path):
    def run(text, urdf=SLIDER_CRANK):
        (tmp_path / "slider_crank.urdf").write_text(urdf)
        (tmp_path / "my.toml").write_text(text)
        return simulate(load_scenario(tmp_path / "my.toml"))

    return run


def test_the_mechanism_itself_runs(run):
    found = run(SCENARIO)
    assert found.outcome is Outcome.COMPLETED
    held = found.constraints
    assert (held["closure_equations"], held["closure_rank"], held["rank"]) == (5, 2, 3)
    assert (held["freedoms"], held["mobility"], held["freedoms_left"]) == (3, 1, 0)


# Of the piston where the crank stands at 20 deg and turns at 100 rad/s.
CRANK, SWING = 0.05, 0.05 * math.sin(math.radians(20.0))
PISTON = CRANK * math.cos(math.radians(20.0)) + math.sqrt(0.12**2 - SWING**2)
PISTON_RATE = 100.0 * (-SWING - SWING * CRANK * math.cos(math.radians(20.0)) / math.sqrt(0.12**2 - SWING**2))

CANNOT_BE = {
    "a loop too short": (
        SCENARIO.replace("120 mm", "10 mm"),
        "my: initial state: the loops cannot be closed: closure 'pin' lacks 0.00",
    ),
    "held open": (
        WITHOUT_MOTOR
        + '[initial.joints.main]\nposition = "10 deg"\n[initial.joints.way]\nposition = "0.1 m"\n',
        "my: initial state: the loops cannot be closed: closure 'pin' lacks",
    ),
    "one link twice": (
        SCENARIO.replace('second = { link = "slider"', 'second = { link = "rod"'),
        "my.toml: closures.pin.second.link must be on another link than first, got 'rod'",
    ),
    "the base with itself": (
        SCENARIO
        + "[closures.again]\nkind = 'fixed'\nfirst = { frame = 'mount' }\n"
        + "second = { frame = 'ground' }\n",
        "closure 'again': its links 'mount' and 'ground' are one body, the world, and cannot move against "
        "each other; name links between which a joint moves",
    ),
    "a start at a dead centre of the slider": (
        SCENARIO.replace('"main"', '"way"').replace('"20 deg"', '"0.17 m"').replace('"100 rad/s"', '"0 m/s"'),
        "my: initial state: a singular position: 2 of 6 equations of closures and motions are independent "
        "here and 3 beside it",
    ),
    "axes that are parallel only nearly": (
        SCENARIO.replace("axis = [0, -1, 0] }\nsecond", "axis = [4e-6, -1, 0] }\nsecond"),
        "my: initial state: the loops cannot be closed: closure 'pin' lacks 4×10⁻⁶ rad at best; check the "
        "closures' points and axes, or check the dimensions (angles must be exact: 1.5707963267948966, not "
        "1.5708)",
    ),
    "a table that ends early": (
        SCENARIO.replace('rate = "100 rad/s"', "time = [0, 0.005, 0.01]\npositions = [0, 0.1, 0.3]"),
        "drive 'motor': time must be a table that covers the run from 0 to 0.02 s; extend it or shorten "
        "the run",
    ),
    "out of the joint's limits": (
        SCENARIO.replace('"main"', '"way"')
        .replace('"20 deg"', '"0.16 m"')
        .replace('"100 rad/s"', '"-9 m/s"'),
        "motion 'motor': joint 'way' must stay from 0 to 0.2 m by its <limit>, got",
    ),
    "out of reach": (
        SCENARIO.replace('"main"', '"way"')
        .replace('"20 deg"', '"0.12 m"')
        .replace('"100 rad/s"', '"-4 m/s"'),
        "motions: out of reach from t = 0.0125",
    ),
    "a drive and a motion": (
        SCENARIO + '[drives.brake]\nkind = "constant"\njoint = "main"\nvalue = "1 N*m"\n',
        "drive 'motor': joint 'main' already has a drive, 'brake'; its motion is prescribed",
    ),
    "a motion twice": (
        SCENARIO + '[drives.again]\nkind = "motion"\njoint = "main"\n',
        "drive 'motor': joint 'main' already has a motion, 'again'",
    ),
    "two motions of one freedom": (
        SCENARIO
        + '[drives.other]\nkind = "motion"\njoint = "way"\n'
        + f'position = "{PISTON!r} m"\nrate = "{PISTON_RATE!r} m/s"\n',
        "my: motions 'motor', 'other': the closures leave 1 freedoms, and 2 motions prescribe 1 of them "
        "independently",
    ),
    "a speed that contradicts": (
        WITHOUT_MOTOR
        + '[initial.joints.main]\nposition = "30 deg"\nvelocity = "9 rad/s"\n'
        + '[initial.joints.way]\nvelocity = "1 m/s"\n',
        "my: initial velocities: contradict closure 'pin', which lacks",
    ),
}


@pytest.mark.parametrize("case", CANNOT_BE)
def test_what_cannot_be_is_refused_in_one_line(run, case):
    text, message = CANNOT_BE[case]
    with pytest.raises(AntennaPinError) as caught:
        run(text)
    said = re.sub(r"^/\S*/", "", str(caught.value))
    assert "\n" not in said
    assert said.startswith(message)


# A parallelogram of bars of 1 m, upright: it falls through the position in which all lie on one line.
BAR = """<link name="{0}"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>
  <inertia ixx="0.001" iyy="0.0833" izz="0.0833" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
PARALLELOGRAM = "\n".join(
    [
        '<robot name="slider_crank"><link name="ground"/>',
        *(BAR.format(name) for name in ("left", "top", "right")),
        JOINT.format("a", "ground", "left", 0, "continuous", "0 -1 0", 0, 0),
        JOINT.format("b", "left", "top", 1, "continuous", "0 -1 0", 0, 0),
        JOINT.format("c", "top", "right", 1, "continuous", "0 -1 0", 0, 0),
        "</robot>",
    ]
)
FLAT = """
duration = "0.8 s"
[mechanism]
urdf = "slider_crank.urdf"
base = "fixed"
gravity = [0, 0, -9.81]
[closures.d]
kind = "revolute"
first = { link = "ground", point = [1, 0, 0], axis = [0, -1, 0] }
second = { link = "right", point = [1, 0, 0], axis = [0, -1, 0] }
[initial.joints.a]
position = "90 deg"
velocity = "-1 rad/s"
[initial.joints.b]
position = "-90 deg"
[initial.joints.c]
position = "-90 deg"
"""


def test_a_singular_position_that_is_passed_is_named(run):
    """The parallelogram is flat at an angle of zero, where it may go on as one or crossed."""
    found = run(FLAT, PARALLELOGRAM)
    assert found.outcome is Outcome.COMPLETED
    assert "passed a singular position at t = " in found.message
    (place,) = found.constraints["singular"]
    angle = found.data.motion_angle.sel(joint="a")
    before = angle.sel(time=slice(0.0, place["time"])).values
    assert abs(before[-1]) < 0.01  # within a sample of the flat position
    assert before[0] == pytest.approx(math.pi / 2.0)
    assert place["share"] < 1e-3


def test_a_loop_that_is_pulled_beyond_its_reach_ends_the_run(run):
    """A motion of the slider, beside a wheel that is free: the run ends where rod and crank are in line."""
    spare = JOINT.format("spare", "ground", "wheel", 0.5, "continuous", "1 0 0", 0, 0)
    urdf = SLIDER_CRANK.replace("</robot>", spare + BODY.format("wheel", 0.0) + "</robot>")
    text = SCENARIO.replace('"main"', '"way"').replace('"20 deg"', '"0.12 m"')
    found = run(text.replace('"100 rad/s"', '"4 m/s"'), urdf)
    assert found.outcome is Outcome.NOT_CLOSED
    # 0.17 m are reached after 12.5 ms.
    assert found.message.startswith("at t = 0.01249") or found.message.startswith("at t = 0.0125")
    assert "closure 'pin': the loops cannot be closed from here on" in found.message
    assert float(found.data.time[-1]) < 0.0125 + 1e-9


def test_a_motion_too_fast_for_its_loops_is_named():
    """Of 1e12 rad/s round-off is 1e-4 rad/s: no loop is closed to a millionth."""
    crank = load_scenario("slider_crank", case="ideal", overrides={"drives.crank.rate": "1e13 rpm"})
    with pytest.raises(
        AntennaPinError, match=r"motion 'crank' is too fast: it moves joint 'crank' by 1.*rad/s at t = 0"
    ):
        simulate(crank, duration=1e-12)


def test_a_command_that_completes_names_the_singular_position_it_passed(run, tmp_path):
    run(FLAT, PARALLELOGRAM)
    done = CliRunner().invoke(app, ["run", str(tmp_path / "my.toml"), "--out", str(tmp_path / "my.nc")])
    assert done.exit_code == 0 and "note: passed a singular position at t = " in done.output
