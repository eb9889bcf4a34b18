"""Rates of a start: what is given is held, what nothing ties to it keeps zero, what must move is said."""

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin import load_scenario
from antenna_pin.dynamics import Workspace
from antenna_pin.errors import AntennaPinError
from antenna_pin.scenario.assemble import build_system, initial_state, scenario_facts

LINK = (
    '<link name="{0}"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>'
    '<inertia ixx="1e-3" iyy="4e-3" izz="4e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{0}_link"/><origin xyz="0.2 0 0"/>'
    '<axis xyz="0 {3} 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>'
)
#: A chain of hinges, of which the first two lead the others; a rack on the last but one.
KINDS = {"a": "continuous", "b": "revolute", "c": "revolute", "d": "revolute", "e": "prismatic"}


def _start(tmp_path, text="", *, base="fixed", axis=1):
    """Return the rates by joint, and the base's, that a scenario starts with."""
    links = LINK.format("ground") + "".join(LINK.format(f"{name}_link") for name in KINDS)
    parents = ["ground", *(f"{name}_link" for name in KINDS)]
    joints = "".join(
        JOINT.format(name, kind, parent, axis)
        for (name, kind), parent in zip(KINDS.items(), parents, strict=False)
    )
    (tmp_path / "chain.urdf").write_text(f'<robot name="chain">{links}{joints}</robot>', encoding="utf-8")
    path = tmp_path / "scenario.toml"
    head = f'format = 1\nduration = 1\n[mechanism]\nurdf = "chain.urdf"\nbase = "{base}"\n'
    path.write_text(head + text, encoding="utf-8")
    scenario = load_scenario(path)
    system = build_system(scenario)
    _, v = initial_state(scenario, system)
    rates = {name: float(v[slot.v][0]) for name, slot in system.mechanism.joints.items()}
    return rates, v[:6] if base == "free" else None, scenario


COUPLED = '[couplings.c]\nleader = "b"\nmultiplier = -2\n'


@pytest.mark.parametrize("base", ["fixed", "free"])
@pytest.mark.parametrize("axis", [1, -1])
@pytest.mark.parametrize(
    ("text", "moving"),
    [
        ("[initial.joints.b]\nvelocity = 2\n", {"b": 2.0, "c": -4.0}),
        ("[initial.joints.c]\nvelocity = -4\n", {"b": 2.0, "c": -4.0}),
        ("[initial.joints.b]\nvelocity = 2\n[initial.joints.c]\nvelocity = -4\n", {"b": 2.0, "c": -4.0}),
        ("[initial.joints.a]\nvelocity = 3\n", {"a": 3.0}),
        ("", {}),
        # A chain: the rack goes by c, which goes by b.
        (
            '[couplings.e]\nleader = "c"\nmultiplier = "10 mm/rad"\n[initial.joints.b]\nvelocity = 1\n',
            {"b": 1.0, "c": -2.0, "e": -0.02},
        ),
        (
            '[couplings.e]\nleader = "c"\nmultiplier = "10 mm/rad"\n[initial.joints.e]\nvelocity = -0.02\n',
            {"b": 1.0, "c": -2.0, "e": -0.02},
        ),
        # Two leaders: the one that is not given stays.
        (
            '[couplings.d]\nleader = "a"\nmultiplier = 3\nsecond = "e"\nsecond_multiplier = 5\n'
            "[initial.joints.a]\nvelocity = 2\n",
            {"a": 2.0, "d": 6.0},
        ),
        # A motion moves its joint, and what follows that.
        ('[drives.m]\nkind = "motion"\njoint = "b"\nrate = 0.5\n', {"b": 0.5, "c": -1.0}),
        # Two followers of one leader.
        (
            '[couplings.d]\nleader = "b"\nmultiplier = 1\n[initial.joints.d]\nvelocity = 0.7\n',
            {"b": 0.7, "c": -1.4, "d": 0.7},
        ),
    ],
)
def test_only_what_is_tied_to_a_given_rate_moves(tmp_path, text, moving, axis, base):
    rates, body, _ = _start(tmp_path, COUPLED + text, base=base, axis=axis)
    for name, rate in rates.items():
        if name in moving:
            assert rate == pytest.approx(moving[name], rel=1e-13)  # round-off of a sum
        else:
            assert rate == 0.0
    assert body is None or not body.any()


def test_a_motion_drags_no_joint_along_that_hangs_behind_it(tmp_path):
    """Shoulder moved, nothing coupled: elbow and all behind it start at rest."""
    rates, _, _ = _start(tmp_path, '[drives.m]\nkind = "motion"\njoint = "a"\nrate = 2.0\n')
    assert rates == {"a": pytest.approx(2.0, rel=1e-13), "b": 0.0, "c": 0.0, "d": 0.0, "e": 0.0}


def test_rates_that_contradict_one_another_are_refused_with_their_names(tmp_path):
    text = f"{COUPLED}[initial.joints.b]\nvelocity = 2\n[initial.joints.c]\nvelocity = 4\n"
    with pytest.raises(AntennaPinError, match=r"contradict coupling 'c', which lacks 4 rad/s; .* held: b, c"):
        _start(tmp_path, text)


LOOP = """[closures.tip]
kind = "revolute"
first = { link = "d_link", point = [0.2, 0, 0], axis = [0, 1, 0] }
second = { link = "world", point = [0.55, 0, 0.25], axis = [0, 1, 0] }
[initial.joints.a]
velocity = 1.5
"""


def test_in_a_loop_the_rest_goes_with_the_given_rate(tmp_path):
    """Four hinges and a point held in a plane: of two freedoms one is given; the slide outside stays."""
    rates, _, scenario = _start(tmp_path, LOOP)
    assert rates["a"] == 1.5
    assert rates["e"] == 0.0
    assert all(rates[name] != 0.0 for name in "bcd")
    facts = scenario_facts(scenario)
    assert set(facts["constraints"]["moving"]) == {"a", "b", "c", "d"}


def test_a_free_base_moves_only_if_it_must(tmp_path):
    """Its arm is held to the world by a hinge: with rates of all its joints given the base goes with them."""
    one, body, _ = _start(tmp_path, LOOP, base="free")
    assert one["a"] == 1.5
    assert not body.any()
    rest = "".join(f"[initial.joints.{name}]\nvelocity = 0\n" for name in "bcd")
    rates, body, scenario = _start(tmp_path, LOOP + rest, base="free")
    assert rates == {"a": 1.5, "b": 0.0, "c": 0.0, "d": 0.0, "e": 0.0}
    assert np.linalg.norm(body[:3]) > 0.1
    assert "base" in scenario_facts(scenario)["constraints"]["moving"]


def test_info_and_run_say_what_moves_though_no_rate_is_given(tmp_path, cli):
    _start(tmp_path, f"{COUPLED}[initial.joints.b]\nvelocity = 2\n")
    said = "initial rates that follow from those given: c \N{MINUS SIGN}4\N{NO-BREAK SPACE}rad/s\n"
    assert f"  {said}" in cli("info", tmp_path / "scenario.toml").out
    ran = cli("run", tmp_path / "scenario.toml", "--out", tmp_path / "a.nc", "--duration", "1 ms")
    assert f"note: {said}" in ran.out
    _start(tmp_path, f"{COUPLED}[initial.joints.b]\nvelocity = 2\n[initial.joints.c]\nvelocity = -4\n")
    assert "initial rates" not in cli("info", tmp_path / "scenario.toml").out


def test_velocities_in_loops_are_the_nearest_in_kinetic_energy(tmp_path):
    """With the given rate held: the gradient of the energy has no part along what the loop leaves free."""
    _, _, scenario = _start(tmp_path, LOOP)
    system = build_system(scenario)
    q, v = initial_state(scenario, system)
    workspace = Workspace(system)
    y = system.state(q, v)
    workspace.constraints.residuals(0.0, y, workspace.program)
    rows = workspace.constraints.jacobian
    mass = pin.crba(system.model, system.model.createData(), q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    loop = [1, 2, 3]  # b, c, d
    _, values, right = np.linalg.svd(rows[:, loop])
    free = right[int((values > 1e-9).sum()) :]
    assert free.shape[0] == 1
    assert np.abs(free @ mass[np.ix_(loop, loop)] @ v[loop]).max() < 1e-12
