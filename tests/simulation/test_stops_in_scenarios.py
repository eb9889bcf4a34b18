"""Stops and latches in scenario files: the URDF's limits, joints with play, what is told of them."""

import numpy as np
import pytest

from antenna_pin import Trajectory, load_scenario, models_path, simulate
from antenna_pin.analysis import latch_events, said_of_limits, stop_impacts
from antenna_pin.errors import AntennaPinError
from antenna_pin.scenario.assemble import build_system
from antenna_pin.show.plot import figure_stops
from antenna_pin.show.record import record
from antenna_pin.show.report import report

PENDULUM = f"""format = 1
title = "a bar between stops"
duration = "0.7 s"
[mechanism]
urdf = "{models_path() / "pendulum/pendulum.urdf"}"
base = "fixed"
gravity = [0.0, 0.0, -9.80665]
[initial.joints.hinge]
angle = "50 deg"
rate = "4 rad/s"
[stops.hinge]
lower = "-40 deg"
upper = "60 deg"
stiffness = "2000 N*m/rad"
restitution = 0.6
[integrator]
rtol = 1e-9
[output]
rate = "200 Hz"
"""
LATCH = """[latches.hinge]
angle = "0 deg"
width = "2 deg"
direction = "down"
stiffness = "3000 N*m/rad"
damping = "5 N*m*s/rad"
"""
PLAY = """[clearance.hinge]
model = "contact"
bearing_radius = "10 mm"
radial_clearance = "0.1 mm"
bearing_length = "50 mm"
axial_clearance = "0.2 mm"
bearing_outer_radius = "12 mm"
flange_radius = "14 mm"
normal = { law = "lankarani-nikravesh", stiffness = "1e9 N/m**1.5", restitution = 0.5 }
friction = { law = "none" }
"""
SLIDER = f"""format = 1
duration = "1 s"
[mechanism]
urdf = "{models_path() / "slider/slider.urdf"}"
base = "fixed"
"""


def written(folder, text):
    """Write a scenario; return its path."""
    path = folder / "scenario.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A bar that strikes a stop and is latched on its way back."""
    return simulate(load_scenario(written(tmp_path_factory.mktemp("bar"), PENDULUM + LATCH)))


def test_a_stop_takes_the_limits_of_the_urdf_and_changes_of_them(tmp_path):
    """-0.5 m and 0.5 m, or as mechanism.joints says; one table for all joints with limits."""
    law = 'stiffness = "1e5 N/m"\nrestitution = 0.5\n'
    own = load_scenario(written(tmp_path, f"{SLIDER}[stops.slide]\n{law}"))
    assert (own.stops["slide"].lower, own.stops["slide"].upper) == (-0.5, 0.5)
    changed = f'{SLIDER}[mechanism.joints.slide]\nupper = "100 mm"\n[stops."*"]\n{law}'
    every = load_scenario(written(tmp_path, changed))
    assert list(every.stops) == ["slide"]
    assert (every.stops["slide"].lower, every.stops["slide"].upper) == (-0.5, 0.1)
    assert build_system(every).families["stops"]["slide"].upper == 0.1


def test_true_stands_for_rigid_stops_at_the_limits_of_the_urdf(tmp_path):
    """A carriage at 1 m/s comes to rest at 0.5 m, in half a second; what has a stop of its own keeps it."""
    plain = written(tmp_path, SLIDER.replace("duration", "stops = true\nduration"))
    start = {"initial.joints.slide.velocity": 1.0, "mechanism.gravity": [0.0, 0.0, 0.0]}
    run = simulate(load_scenario(plain, overrides=start))
    assert [str(name) for name in run.data.change.values] == ["stop slide: upper: rests"]
    assert float(run.data.change_time[0]) == pytest.approx(0.5, abs=1e-12)
    assert float(run.data.slide_position[-1, 0]) == pytest.approx(0.5, abs=1e-12)
    own = load_scenario(plain, overrides=["stops.slide={kind='rigid', restitution=0.5, upper=0.2}"])
    assert (own.stops["slide"].restitution, own.stops["slide"].upper) == (0.5, 0.2)
    assert load_scenario(plain, overrides=["stops=false"]).stops == {}
    assert load_scenario(written(tmp_path, f"stops = false\n{SLIDER}")).stops == {}
    law = '[stops."*"]\nstiffness = "1e5 N/m"\nrestitution = 0.5\n'
    over = load_scenario(written(tmp_path, SLIDER + law), overrides=["stops=true"])
    assert over.stops["slide"].kind == "rigid"  # in place of the other for all joints
    with pytest.raises(AntennaPinError, match=r"stops must be a table, got 'yes'"):
        load_scenario(plain, overrides=["stops=yes"])


def test_stops_everywhere_leave_out_joints_that_motions_move(tmp_path):
    """A rigid stop there holds what is held already; one that gives way may stand there."""
    moved = f'{SLIDER}[drives.slide]\nkind = "motion"\nrate = "0.1 m/s"\n'
    assert load_scenario(written(tmp_path, f"stops = true\n{moved}")).stops == {}
    law = '[stops."*"]\nstiffness = "1e5 N/m"\nrestitution = 0.5\n'
    assert list(load_scenario(written(tmp_path, moved + law)).stops) == ["slide"]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ('[stops.slide]\nlower = "1 m"\nupper = "0 m"\n', r"stops\.slide\.upper must be above lower, 1"),
        ('[stops.slide]\nlower = "1 deg"\n', r"sliding joint"),
        ('[stops.no]\nlower = "1 m"\n', r"stops\.no\.joint: moving joint 'no' is unknown; known: slide"),
        ('[stops."*"]\nlower = "1 m"\n', r'stops\."\*"\.lower must be left out'),
        ('[stops.slide]\nlaw = "kelvin-voigt"\nlower = 0\n', r"damping must be given; law kelvin-voigt"),
        ("[stops.slide]\ndamping = 1\nlower = 0\n", r"damping must be left out: law exact-restitution takes"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(tmp_path, more, said):
    law = "" if "law" in more else "restitution = 0.5\n"
    text = f'{SLIDER}{more}{law}stiffness = "1e5 N/m"\n'.replace(
        'lower = "1 deg"', 'lower = "1 deg"\nmotion = "translation"'
    )
    with pytest.raises(AntennaPinError, match=said) as refusal:
        build_system(load_scenario(written(tmp_path, text)))
    assert "\n" not in str(refusal.value)


def test_touches_and_captures_are_told(run, tmp_path):
    """The table's numbers fit one another: what comes back of the rate, and what is lost of the energy."""
    touches, latched = stop_impacts(run), latch_events(run)
    assert touches.sizes["touch"] == 1
    assert touches["side"].values.tolist() == ["upper"]
    assert latched["what"].values.tolist() == ["latched"]
    inertia = 0.0251004 + 1.872 * 0.2**2
    approach, rebound = (float(touches[name][0]) for name in ("approach_rate", "rebound_rate"))
    # The weight pushes off this stop all the while, at 60 degrees and a little beyond.
    lasted = float(touches["release"][0] - touches["onset"][0])
    weight = 1.872 * 9.80665 * 0.2 * np.sin(np.radians(60.0)) * lasted
    assert float(touches["impulse"][0]) == pytest.approx(inertia * (approach + rebound) - weight, rel=0.01)
    assert float(touches["loss"][0]) == pytest.approx(0.5 * inertia * (approach**2 - rebound**2), rel=1e-6)
    assert 0.6 < rebound / approach < 0.75  # the weight speeds the bar up on its way out
    found = run.summary()
    assert found["stops"]["hinge"]["touches"] == 1
    assert found["latches"]["hinge"]["captures"] == 1
    path = tmp_path / "run.nc"
    run.save(path)
    again = stop_impacts(Trajectory.load(path))
    assert again.identical(touches)


def test_it_is_in_figure_report_and_recording(run):
    """Marks at the times that the table has; both parts of a mark, of which one is seen."""
    figure = figure_stops([run])
    assert [axes.get_title("left").rpartition("$ ")[2] for axes in figure.axes] == [
        "hinge",
        "what its stops and latches exert",
    ]
    offsets = np.concatenate([one.get_offsets() for one in figure.axes[0].collections])
    assert float(stop_impacts(run)["onset"][0]) in offsets[:, 0]
    (section,) = (
        one for one in report([run], figures=False, recordings=False).sections if one.key == "stops"
    )
    assert [table.key for table in section.items] == ["stops", "latches"]
    tracks = record(run, fps=50).data["actors"][0]["tracks"]
    assert sum("/stops.hinge" in track["path"] for track in tracks) == 4
    assert sum("/latches.hinge" in track["path"] for track in tracks) == 2


def test_rigid_stops_and_latches_in_a_scenario(run, tmp_path):
    """Struck at the same time as the stop that gives way, latched at the window's end."""
    text = PENDULUM.replace('stiffness = "2000 N*m/rad"', 'kind = "rigid"') + LATCH.replace(
        'stiffness = "3000 N*m/rad"\ndamping = "5 N*m*s/rad"', 'kind = "rigid"'
    )
    rigid = simulate(load_scenario(written(tmp_path, text)))
    onset = float(stop_impacts(run)["onset"][0])
    assert float(stop_impacts(rigid)["onset"][0]) == pytest.approx(onset, abs=1e-9)
    assert float(stop_impacts(rigid)["rebound_rate"][0]) == pytest.approx(
        0.6 * float(stop_impacts(rigid)["approach_rate"][0]), rel=1e-12
    )
    assert rigid.data.motion_angle.values[-1, 0] == pytest.approx(np.radians(2.0), abs=1e-9)
    assert np.abs(rigid.data.energy_error).max() < 1e-8


def test_a_stop_acts_about_the_axis_of_a_joint_with_play(tmp_path):
    """As at the ideal joint but for what the play of 0.1 mm lets the bar turn; a rigid stop is refused."""
    text = PENDULUM.replace('"0.7 s"', '"0.25 s"')
    ideal = simulate(load_scenario(written(tmp_path, text)))
    play = simulate(load_scenario(written(tmp_path, text + PLAY)))
    assert play.completed, play.message
    one, other = stop_impacts(ideal), stop_impacts(play)
    assert other.sizes["touch"] >= 1
    assert float(other["onset"][0]) == pytest.approx(float(one["onset"][0]), abs=2e-3)
    assert np.abs(play.data.energy_error).max() < 1e-6
    rigid = text.replace('stiffness = "2000 N*m/rad"', 'kind = "rigid"')
    with pytest.raises(AntennaPinError, match="only a revolute, continuous or prismatic joint without play"):
        build_system(load_scenario(written(tmp_path, rigid + PLAY)))


def test_limits_with_a_stop_are_not_said_to_be_passed(tmp_path):
    """A joint goes into its stop by what that gives way; without one a line tells that it passes."""
    start = '[initial.joints.slide]\nvelocity = "1 m/s"\n'
    law = '[stops.slide]\nstiffness = "1e4 N/m"\nrestitution = 0.5\n'
    assert len(said_of_limits(simulate(load_scenario(written(tmp_path, SLIDER + start))))) == 1
    assert said_of_limits(simulate(load_scenario(written(tmp_path, SLIDER + start + law)))) == ()
