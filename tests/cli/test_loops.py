"""Commands on closed loops and driven joints: a four-bar whose crank is driven, with and without play."""

import dataclasses
import json

import pytest
from coupled_fingers import write_coupled_fingers
from driven_four_bar import write_driven_four_bar
from single_loops import bricard

from antenna_pin import Trajectory, load_scenario, simulate


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A scenario and a result of each of its cases."""
    folder = tmp_path_factory.mktemp("loops")
    path = write_driven_four_bar(folder / "driven")
    for case in ("ideal", "play", "held"):
        simulate(load_scenario(path, case=case)).save(folder / f"{case}.nc")
    return folder


# --- info of a scenario ---


def test_info_counts_what_holds_a_scenario(cli, folder, printed):
    *lines, closed, start, moving = printed(cli("info", folder / "driven")).splitlines()[:11]
    assert lines == [
        "driven, case ideal: Four-bar, its crank driven",
        "  fixed base, 3 moving joints, 3 freedoms",
        "  3 joints drive_pin, crank_pin, ground_pin: continuous",
        "  closure rocker_pin (coupler - rocker): revolute, 5 equations",
        "  drive crank: motion 12\N{NO-BREAK SPACE}rad/s · t, at drive_pin",
        "  5 equations of closures, 2 independent (3 redundant, rocker_pin: along z, about x, about y); "
        "1 motion; mobility 1, of which the motion leaves 0",
    ]
    assert closed.startswith("  the start is closed to ")
    assert start.startswith("  the start found: drive_pin 0 deg, crank_pin ")
    assert moving.startswith("  initial rates that follow from those given: crank_pin ")


def test_info_counts_the_freedoms_that_play_gives_back(cli, folder, printed):
    """The pin's five, of which the plane takes its three: with play a loop is not redundant."""
    said = printed(cli("info", folder / "driven", "--case", "play"))
    assert "  joint crank_pin: with play (contact)\n" in said
    assert (
        "5 equations of closures, 5 independent; 1 motion; mobility 3, of which the motion leaves 2" in said
    )
    said = printed(cli("info", folder / "driven" / "scenario.toml", "--case", "held"))
    assert "  joint crank_pin: revolute, held by constraint\n" in said
    assert "10 equations of closures, 7 independent (3 redundant, shared among crank_pin: " in said
    assert "mobility 1, of which the motion leaves 0" in said


def test_info_of_a_scenario_as_json(cli, folder, printed):
    facts = json.loads(printed(cli("info", folder / "driven", "--json")))
    assert facts["closures"]["rocker_pin"]["links"] == ["coupler", "rocker"]
    counts = facts["constraints"]
    assert counts["freedoms"] - counts["rank"] == counts["freedoms_left"] == 0
    assert counts["redundant"]["rocker_pin"]["equations"] == 3
    assert max(facts["residuals"]) < 1e-12


def test_info_of_a_tree(cli, printed):
    said = printed(cli("info", "pendulum", "--case", "ideal"))
    assert said.splitlines()[-1] == "  no closures; mobility 1"


def test_info_says_in_one_line_what_cannot_be_closed(cli, folder, refused):
    change = "closures.rocker_pin.second.point=[0.9, 0, 0]"
    said = refused(cli("info", folder / "driven", "--set", change))
    assert "the loops cannot be closed: closure 'rocker_pin' lacks" in said


def test_info_takes_one_scenario_or_results(cli, folder, refused):
    said = refused(cli("info", folder / "driven", folder / "ideal.nc"))
    assert "give result files (NAME.nc), any number, or one scenario alone" in said
    assert "--case: is for scenarios only" in refused(cli("info", folder / "ideal.nc", "--case", "play"))
    assert "--set: is for scenarios only" in refused(cli("info", folder / "ideal.nc", "--set", "duration=1"))
    for option in (("--all",), ("--csv", "numbers.csv"), ("--quantity", "own.py:number")):
        said = refused(cli("info", folder / "driven", *option))
        assert f"{option[0]}: is for results only" in said


# --- info of results ---


def test_info_tells_what_closures_and_motions_carried(cli, folder, printed):
    said = printed(cli("info", "--all", folder / "ideal.nc", folder / "play.nc"))
    for row in (
        "equations of closures",
        "freedoms that closures and motions leave",
        "largest rate residual of closures and motions [rad/s]",
        "energy that corrections put in [J]",
        "rocker_pin links",
        "rocker_pin peak force [N]",
        "crank peak torque [N m]",
        "crank work [J]",
    ):
        assert f"\n {row}  " in said
    assert said.splitlines()[-2].startswith("ideal: 5 equations of closures, 2 independent (3 redundant")
    assert said.splitlines()[-1] == (
        "play: 5 equations of closures, 5 independent; 1 motion; mobility 3, of which the motion leaves 2"
    )


def test_info_of_a_lean_result_is_the_same(cli, folder, printed):
    cli("run", folder / "driven", "--case", "ideal", "--lean", "--out", "lean.nc", "-q")
    full, lean = (
        json.loads(printed(cli("info", path, "--json"))) for path in (folder / "ideal.nc", "lean.nc")
    )
    for key in ("constraints", "closures", "motions"):
        assert lean[key] == full[key]


def test_one_of_five_equations_of_bricards_ring_is_redundant(cli, tmp_path, printed):
    """Which of them does not matter; the rest of the loop holds any one."""
    loop = bricard()
    (tmp_path / "loop.urdf").write_text(loop.urdf)
    (tmp_path / "bricard.toml").write_text(loop.scenario)
    assert "(1 redundant, pin_6: 1 of along x, along y, along z, about x, about y); mobility 1" in printed(
        cli("info", "bricard.toml")
    )


# --- what is refused ---


def test_play_at_a_closure_is_refused_with_the_joints_that_could_close_the_loop(cli, folder, refused):
    """A joint with play is one of the tree; which others of the loop can close it depends on what they do."""
    law = "normal={law='lankarani-nikravesh', stiffness=1e8, restitution=0.9}"
    parts = f"model='planar', radial_clearance=1e-4, bearing_radius=0.01, geometry='closed-form', {law}"
    play = f"clearance.rocker_pin={{{parts}}}"
    place = "antenna-pin: driven: clearance.rocker_pin: must be a joint of the tree, got a closure; "
    so_that = "instead, so that rocker_pin can be a joint of the URDF"
    said = refused(cli("info", folder / "driven", "--set", play))
    assert said == f"{place}cut the loop at crank_pin or ground_pin {so_that}"
    said = refused(cli("run", folder / "driven", "--case", "play", "--set", play))
    assert said == f"{place}cut the loop at ground_pin {so_that}"
    # One between points acts at no joint.
    ends = "first={link='world', point=[0, 0, 0]}, second={link='coupler', point=[0, 0, 0]}"
    rope = f"springs.rope={{{ends}, stiffness=1, free_length=0.1}}"
    assert refused(cli("run", folder / "driven", "--case", "play", "--set", play, "--set", rope)) == said
    other = play.replace("rocker_pin", "ground_pin")
    said = refused(cli("info", folder / "driven", "--case", "play", "--set", play, "--set", other))
    assert said == (
        f"{place}all joints of its loop without play (drive_pin) have drives or springs, which act at joints "
        "of the tree: take them off one of these to cut the loop there"
    )
    third = play.replace("rocker_pin", "drive_pin")
    changes = [part for change in (play, other, third) for part in ("--set", change)]
    said = refused(cli("info", folder / "driven", "--case", "play", *changes))
    joints = "crank_pin, drive_pin or ground_pin"
    assert said == f"{place}nothing is left to cut: give one joint of the loop no play ({joints})"


# --- other commands ---


def test_analyse_tells_what_closures_and_drives_carried(cli, folder, printed):
    said = printed(cli("analyse", folder / "play.nc", "--ideal", folder / "ideal.nc"))
    for words in (
        "play: deviation from the ideal run",
        "play: impacts and load",
        "play: forces of closures",
        "play: what drives exert",
        "motion crank [N m]",
        "5 equations of closures, 5 independent; 1 motion; mobility 3, of which the motion leaves 2",
    ):
        assert words in said
    found = json.loads(printed(cli("analyse", folder / "play.nc", "--json")))
    facts = json.loads(printed(cli("info", folder / "play.nc", "--json")))
    (closure,), (drive,) = found["closures"], found["drives"]
    assert closure["peak_force"] == facts["closures"]["rocker_pin"]["peak_force"]
    assert drive["peak_effort"] == facts["motions"]["crank"]["peak_torque"]
    assert (drive["units"], drive["motion"], drive["work"]) == (
        "N m",
        True,
        facts["motions"]["crank"]["work"],
    )


def test_the_urdf_of_a_case_is_a_tree_and_says_so(cli, folder, printed):
    said = printed(cli("urdf", folder / "driven", "--out", "tree.urdf"))
    assert said.splitlines()[-1] == (
        "note: a URDF is a tree; the closures of the scenario are not in it: rocker_pin"
    )


@pytest.mark.parametrize("singular", [[], [{"time": 0.25, "share": 1e-9}, {"time": 0.5, "share": 2e-9}]])
def test_singular_positions_that_were_passed_are_named(cli, folder, singular, printed):
    run = Trajectory.load(folder / "ideal.nc")
    counts = run.constraints | {"singular": singular}
    data = run.data.assign_attrs(constraints=json.dumps(counts))
    dataclasses.replace(run, data=data).save("passed.nc")
    last = printed(cli("info", "--all", "passed.nc")).splitlines()[-1]
    text = (
        "passed: passed 2 singular positions, at 0.25 s, 0.5 s: where the motion of the loops is not unique"
    )
    assert last.replace("\N{NO-BREAK SPACE}", " ") == text if singular else "mobility" in last


# --- coupled joints ---


def test_commands_tell_what_is_coupled_and_what_that_carried(cli, tmp_path, printed):
    path = write_coupled_fingers(tmp_path / "fingers")
    said = printed(cli("info", path)).replace("\N{NO-BREAK SPACE}", " ").splitlines()
    assert said[4:7] == [
        "  coupling finger: finger = −1 · thumb + 0.1 rad",
        "  coupling rack: rack = 10 mm/rad · thumb",
        "  2 equations of couplings, 2 independent; mobility 1",
    ]
    assert cli("run", path, "--out", tmp_path / "fingers.nc").code == 0
    said = printed(cli("analyse", tmp_path / "fingers.nc"))
    assert "fingers: torques of couplings, on followers" in said
    assert "2 equations of couplings, 2 independent; mobility 1" in said
    found = json.loads(printed(cli("analyse", tmp_path / "fingers.nc", "--json")))["couplings"]
    facts = json.loads(printed(cli("info", tmp_path / "fingers.nc", "--json")))["couplings"]
    assert [(one["of"], one["units"]) for one in found] == [("finger", "N m"), ("rack", "N")]
    assert found[0]["peak_torque"] == facts["finger"]["peak_torque"] > 0.0
    assert found[1]["peak_torque"] == facts["rack"]["peak_force"] > 0.0
    assert cli("info", "--all", tmp_path / "fingers.nc").out.count("equations of couplings") == 2
    said = printed(cli("urdf", path, "--out", "tree.urdf"))
    assert said.splitlines()[-1] == "note: the couplings of the scenario are not in it: rack"
