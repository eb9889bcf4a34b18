"""Recordings without a browser: what the page holds, that it is right, and what is refused."""

import base64
import dataclasses
import html
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin.analysis import body_poses, quantity
from antenna_pin.errors import InvalidParameterError, OutputError, UnknownNameError
from antenna_pin.mechanism import Urdf
from antenna_pin.show.record import shared_head
from antenna_pin.show.record._joint_pictures import BEARING, DIRECTION, JOURNAL, LOAD_COLOURS, drawn_axes
from antenna_pin.show.record.curves import thinned
from antenna_pin.show.record.scene import clearest
from antenna_pin.show.record.shapes import visual_shapes
from antenna_pin.trajectory import Outcome, Trajectory

from .conftest import doubles, drawn_meshes, floats, record


class Loads(HTMLParser):
    """Collects what a page would load."""

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("src", "href", "srcset", "data", "poster", "action"):
                self.found.append(value)


def test_the_page_loads_nothing(clearance_run, ideal_run):
    text = record(clearance_run, ideal_run, body="reflector").html
    page = Loads()
    page.feed(text)
    assert [address for address in page.found if not address.startswith("data:")] == []
    style = "".join(re.findall(r"<style>(.*?)</style>", text, re.DOTALL))
    assert "@import" not in style and "url(" not in style
    assert text.count("<script") == text.count("</script>")


def test_key_frames_hold_all_impacts(clearance_run):
    recording = record(clearance_run, fps=50.0)
    times = doubles(recording.data["times"])
    data = clearance_run.data
    for name in ("onset_time", "peak_time", "release_time"):
        events = data[name].values
        assert np.isin(events[np.isfinite(events)], times).all(), name
    assert len(recording.frames.impacts.times) == data.sizes["episode"] > 0
    assert np.array_equal(doubles(recording.data["impacts"]["times"]), np.sort(data["peak_time"].values))


def test_poses_at_key_frames_are_those_of_the_bodies(clearance_run, ideal_run):
    recording = record(clearance_run, ideal_run)
    for actor, run in zip(recording.data["actors"], (clearance_run, ideal_run), strict=True):
        times = doubles(actor["times"])
        chosen = np.unique(run.data["time"].values, return_index=True)[1]
        chosen = chosen[np.isin(run.data["time"].values[chosen], times)]
        poses = body_poses(run, times=chosen)
        for k, track in enumerate(actor["tracks"]):
            assert track["name"].endswith(str(poses["body"].values[k]))
            both = np.hstack([poses["position"].values[:, k], poses["attitude"].values[:, k]])
            assert np.array_equal(floats(track["data"], 7), both.astype("<f4"))


def test_forces_of_key_frames_and_their_bearing(clearance_run):
    recording = record(clearance_run)
    contacts = recording.data["contacts"]
    force = clearance_run.data["contact_force"].values[recording.frames.indices]
    for k, item in enumerate(contacts["items"]):
        loaded = np.frombuffer(base64.b64decode(item["frames"]), dtype="<u4")
        assert len(loaded) < len(force)
        assert np.array_equal(floats(item["force"], 3), force[loaded, k].astype("<f4"))
        assert not np.delete(force[:, k], loaded, axis=0).any()
        assert item["path"] == "run/1/bearing elevation"  # shaft1 is the second link
    assert any(item["force"] for item in contacts["items"])
    assert "N drawn" in recording.data["facts"][0]["text"]


def test_joint_view_says_how_it_is_magnified(clearance_run, planar_run, ball_run):
    texts = [
        record(run, view="joint").data["facts"][0]["text"] for run in (clearance_run, planar_run, ball_run)
    ]
    assert texts == [
        "elevation: play, eccentricity and tilt drawn 15 times as large",
        "hinge: play and eccentricity drawn 30 times as large",
        "upper: play and eccentricity drawn 50 times as large",
    ]
    text = record(clearance_run, view="joint", magnify=300).data["facts"]
    assert "300 times" in text[0]["text"] and "200 µm drawn 60 mm" in text[2]["text"]
    lower = record(ball_run, view="joint", joint="lower").data
    assert "lower" in lower["facts"][0]["text"]
    assert [item["name"] for item in lower["contacts"]["items"]] == ["lower.spherical"]


def test_a_pendulum_rests_on_the_bottom_of_its_bore(planar_run, clearance_run):
    """The bearing bears the weight from below: the mean force on the journal points up in the picture.

    Without gravity the view would have the bearing's y upwards, which points down there.
    """
    data = record(planar_run, view="joint").data
    axes = np.array(data["triad"]["axes"])
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12) and np.linalg.det(axes) == pytest.approx(1.0)
    (item,) = data["contacts"]["items"]
    force, point = (floats(item[name], 3) @ axes for name in ("force", "point"))
    load = np.linalg.norm(force, axis=1)
    assert np.average(point[:, 2], weights=load) < 0.0 < np.average(force[:, 2], weights=load)
    assert floats(data["triad"]["gravity"], 3) == pytest.approx(np.array([[0.0, 0.0, -1.0]]), abs=1e-6)
    assert record(clearance_run, view="joint").data["triad"]["gravity"] is None
    world = record(planar_run).data
    up = np.array(world["camera"]["upright"]) @ floats(world["triad"]["gravity"], 3)[0]
    assert up / np.linalg.norm(up) == pytest.approx([0.0, 0.0, -1.0])


@pytest.mark.parametrize("angle", [0.0, 0.05, 0.5, 1.5, 3.0])
def test_up_is_up_whatever_the_bearing(angle):
    up = np.array([np.sin(angle) * 0.6, np.sin(angle) * 0.8, np.cos(angle)])
    turn = drawn_axes(up)
    assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-12) and np.linalg.det(turn) == pytest.approx(1.0)
    assert turn @ up == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)


def test_loads_are_seen_on_bearing_and_journal():
    """Luminance falls from step to step; no step is near the colour of what it is drawn on, 0 to 255 each."""
    colours = np.array(LOAD_COLOURS, dtype=float)
    luminance = ((colours / 255.0) ** 2.2) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(luminance) < 0.0).all() and luminance[0] > 10.0 * luminance[-1]
    for part in (BEARING, JOURNAL):
        assert np.linalg.norm(colours - 255.0 * np.array(part), axis=1).min() > 80.0


def seen_by(colours):
    """Colours (n, 3) of 0 to 1 as who lacks the green-sensitive cones sees them, and who lacks the red ones.

    In linear light, as Vienot, Brettel and Mollon (1999) have it, Color Research and Application 24(4).
    """
    to_cones = np.array(
        [[17.8824, 43.5161, 4.11935], [3.45565, 27.1554, 3.86714], [0.0299566, 0.184309, 1.46709]]
    )
    no_red = np.array([[0.0, 2.02344, -2.52581], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    no_green = np.array([[1.0, 0.0, 0.0], [0.494207, 0.0, 1.24827], [0.0, 0.0, 1.0]])
    linear = colours**2.2
    for lack in (np.eye(3), no_red, no_green):
        yield np.clip(linear @ (np.linalg.inv(to_cones) @ lack @ to_cones).T, 0.0, 1.0) ** (1.0 / 2.2)


def test_links_without_a_colour_are_told_apart():
    """Eight of them, by every kind of eye: by a sixteenth of the way from black to white at least."""
    shape = "<visual><geometry><sphere radius='1'/></geometry></visual>"
    mass = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"
    links = "".join(f"<link name='l{k}'>{mass}{shape}{shape}</link>" for k in range(9))
    joints = "".join(
        f"<joint name='j{k}' type='fixed'><parent link='l{k}'/><child link='l{k + 1}'/></joint>"
        for k in range(8)
    )
    shapes, _ = visual_shapes(Urdf.from_text(f"<robot name='r'>{links}{joints}</robot>", "r.urdf"))
    own = np.array([each.colour[:3] for each in shapes])
    assert np.array_equal(own[::2], own[1::2])  # a link has one colour
    assert np.linalg.norm(own[16] - own[0]) > 0.1  # the ninth is darker
    for colours in seen_by(own[:16:2]):
        apart = np.linalg.norm(colours[:, None] - colours[None], axis=2) + np.eye(8)
        assert apart.min() > np.sqrt(3.0) / 16.0


def test_the_camera_looks_from_where_bodies_do_not_hide_one_another():
    """A plate behind a cube, as seen from the usual side: the camera goes round until both are seen."""
    side = np.linspace(-0.5, 0.5, 21)
    face = np.array([(y, z) for y in side for z in side])
    cube = np.concatenate([np.insert(face, axis, end, axis=1) for axis in range(3) for end in (-0.5, 0.5)])
    behind = np.array([-1.0, 0.75, -0.55])
    plate = 0.4 * np.insert(face, 0, 0.0, axis=1) + behind
    first = -behind
    chosen = clearest([cube[None], plate[None]], first, np.eye(3))
    assert chosen @ first / np.linalg.norm(first) < 0.9
    # From there the plate's middle is not in the shadow of the cube, a ball of its inradius.
    beside = behind - (behind @ chosen) * chosen
    assert np.linalg.norm(beside) > 0.5
    assert clearest([cube[None], plate[None] - 4.0 * behind], first, np.eye(3)) == pytest.approx(
        first / np.linalg.norm(first)
    )


def test_curves_of_an_ideal_run_stand_beside_where_it_has_them(clearance_run, ideal_run):
    """What has no play has no contacts, and so no curve of their forces."""
    series = {one["name"]: one for one in record(clearance_run, ideal_run).data["curves"]["series"]}
    beside = {name for name, one in series.items() if "ideal" in one}
    assert "motion_angle[elevation]" in beside
    assert not any(name.startswith(("|contact_force", "gap")) for name in beside) and beside < set(series)
    for name in beside:
        one, exact = series[name]["ideal"], quantity(ideal_run, name)
        times, values = (doubles(one[part]) for part in ("times", "values"))
        assert np.isin(times, exact.time).all() and np.isin(values, exact.values).all(), name
        assert one["samples"] == len(exact.time) and len(times) <= 1000
    alone = record(clearance_run).data["curves"]["series"]
    assert not any("ideal" in one for one in alone)


def test_curves_hold_samples_of_the_run_and_say_what_they_leave_out(clearance_run):
    data = record(clearance_run).data["curves"]
    times, peaks = clearance_run.data["time"].values, {}
    for one in data["series"]:
        exact = quantity(clearance_run, one["name"])
        at, values = doubles(one["times"]), doubles(one["values"])
        assert set(zip(at, values, strict=True)) <= set(zip(times, exact.values, strict=True))
        assert (at[0], at[-1]) == (times[0], times[-1])
        assert (values.min(), values.max()) == (exact.values.min(), exact.values.max())
        peaks[one["name"]] = values.max()
        once = np.append(True, np.diff(times) > 0) & np.append(np.diff(times) > 0, True)
        off = np.abs(np.interp(times[once], at, values) - exact.values[once]).max()
        assert off == pytest.approx(one["off"], rel=1e-9, abs=1e-300)
        # A tenth of a pixel of a curve that is 80 pixels high; all else has been looked at before.
        assert off <= 1e-3 * np.ptp(exact.values)
    first = data["series"][data["first"]]["name"]
    forces = {name: peak for name, peak in peaks.items() if name.startswith("|contact_force")}
    assert forces[first] == max(forces.values())
    wanted = ("|journal_velocity[elevation]|", "gap[elevation.axial+]")
    asked = record(clearance_run, curves=wanted).data["curves"]
    assert asked["first"] == 0 and tuple(one["name"] for one in asked["series"][:2]) == wanted
    assert record(clearance_run, curves=()).data["curves"]["series"] == []
    with pytest.raises(UnknownNameError, match="name 'sped'"):
        record(clearance_run, curves=("sped",))


@pytest.mark.parametrize("samples", [100_001, 300_001])
def test_a_long_curve_keeps_its_peaks(samples):
    """Needles one sample wide among very many, and numbers that are none, which break the line.

    The sine's chords are off by h^2 / 8; 0.1 rad apart, where needles take no more than six, by 1.3e-3.
    """
    times = np.linspace(0.0, 10.0, samples)
    values = np.sin(times)
    values[[31_415, 70_000]] = [9.0, -9.0]
    kept, off = thinned(times, values, 110)
    assert len(kept) <= 110 and {0, 31_415, 70_000, samples - 1} <= set(kept)
    assert off < 1.3e-3 * 2.0  # the best places are not even ones
    values[500:600] = np.nan
    kept, _ = thinned(times, values, 110)
    assert {31_415, 70_000} <= set(kept) and np.isnan(values[kept]).any()


def test_between_blows_a_thinned_force_is_zero():
    """More blows than there is room for: where nothing touches, no line goes from one to the next."""
    times = np.linspace(0.0, 1.0, 6001)
    phase = np.arange(6001) % 40
    random = np.random.default_rng(2)
    values = np.where(phase < 7, np.sin(np.pi * phase / 7.0) * np.repeat(random.random(151), 40)[:6001], 0.0)
    kept, _ = thinned(times, values, 200)
    drawn = np.interp(times, times[kept], values[kept])
    assert len(kept) <= 200 and values[kept].max() == values.max()
    assert drawn[values == 0.0].max() <= 1e-4  # of the range, which counts as zero


def test_a_material_has_its_colour_wherever_it_is_named():
    """Given in a link, named by another before it: the name stands for one colour."""
    shape = "<visual><geometry><sphere radius='1'/></geometry>{}</visual>"
    named = shape.format("<material name='red'/>")
    given = shape.format("<material name='red'><color rgba='1 0 0 1'/></material>")
    mass = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"
    joint = "<joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>"
    links = f"<link name='a'>{mass}{named}</link><link name='b'>{mass}{given}</link>"
    text = f"<robot name='r'>{links}{joint}</robot>"
    shapes, warnings = visual_shapes(Urdf.from_text(text, "r.urdf"))
    assert [each.colour for each in shapes] == [(1.0, 0.0, 0.0, 1.0)] * 2 and not warnings


def test_the_frame_holds_the_traces(clearance_run, ideal_run):
    """Of the run's boresight and the ghost's: framed points reach as far as they do, in every direction.

    But for what 256 directions leave between them, 4 degrees: 1 - cos(4 deg) of the size.
    """
    moved = ideal_run.data.assign(q=ideal_run.data["q"] + 0.0)
    moved["q"][:, 0] += 5.0  # the free base, 5 m off
    ghost = dataclasses.replace(ideal_run, data=moved)
    data = record(clearance_run, ghost).data
    framed = floats(data["camera"]["points"], 3)
    size = np.ptp(framed, axis=0).max()
    assert len(data["trails"]) == 2
    for trail in data["trails"]:
        points = floats(trail["points"], 3)
        for way in np.random.default_rng(1).normal(size=(50, 3)):
            way /= np.linalg.norm(way)
            assert (points @ way).max() < (framed @ way).max() + 3e-3 * size


def test_a_small_limit_thins_the_key_frames(clearance_run):
    full = record(clearance_run, view="joint", fps=1e6, curves=())
    limit = len(full.html.encode()) - 8000
    small = record(clearance_run, view="joint", fps=1e6, curves=(), max_megabytes=1e-6 * limit)
    assert len(small.html.encode()) <= limit
    assert 10 < len(small.frames.indices) < len(full.frames.indices)
    with pytest.raises(InvalidParameterError, match="max_megabytes must be above"):
        record(clearance_run, max_megabytes=0.5)


def test_speed_is_such_that_a_short_run_can_be_watched(clearance_run):
    """50 ms take 4 s or more: 1/100 of real time; the joint close up is ten times slower."""
    assert record(clearance_run).data["speed"] == pytest.approx(0.01)
    assert record(clearance_run, view="joint").data["speed"] == pytest.approx(0.001)
    assert record(clearance_run, speed=0.5).data["speed"] == 0.5


def test_the_scenario_says_what_looks_where(clearance_run):
    assert clearance_run.scenario.pointing.body == "reflector"
    data = record(clearance_run).data
    assert any(fact["text"] == "boresight of reflector and its trace" for fact in data["facts"])
    (trail,) = data["trails"]
    recording = record(clearance_run)
    poses = body_poses(clearance_run, times=recording.frames.indices).sel(body="reflector")
    axis = Rotation.from_quat(poses["attitude"].values).apply(clearance_run.scenario.pointing.boresight)
    tips = floats(trail["points"], 3) - poses["position"].values
    assert np.cross(tips, axis) == pytest.approx(0.0, abs=1e-6)  # 32-bit floats


def test_a_recording_says_what_it_is_in_one_line(clearance_run):
    said = repr(record(clearance_run))
    assert said.startswith("<Recording ")
    assert "key frames" in said
    assert len(said) < 200
    assert "\n" not in said


def test_a_span(clearance_run):
    times = doubles(record(clearance_run, start=0.01, end=0.02).data["times"])
    assert times[0] >= 0.01 and times[-1] <= 0.02 and len(times) > 5
    for start, end, what in ((0.02, 0.01, "end"), (-1.0, None, "start"), (0.0, 9.0, "end")):
        with pytest.raises(InvalidParameterError, match=f"recording: {what} must be"):
            record(clearance_run, start=start, end=end)


def test_a_missing_mesh_is_named_and_the_rest_drawn(clearance_run):
    attributes = clearance_run.data.attrs | {"urdf_folder": "/nowhere"}
    moved = dataclasses.replace(clearance_run, data=clearance_run.data.assign_attrs(attributes))
    data = record(moved).data
    assert data["warnings"] == ["reflector: mesh file 'dish.obj' is missing; not drawn"]
    assert len(data["commands"]) == len(record(clearance_run).data["commands"]) - 2  # object and transform


@pytest.mark.parametrize(("x", "said"), [("1e300", "1e+300 m"), ("-2e9", "2e+09 m")])
def test_a_mesh_with_a_vertex_too_far_away_is_named(clearance_run, tmp_path, recwarn, x, said):
    (tmp_path / "dish.obj").write_text(f"v 0 0 0\nv {x} 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
    attributes = clearance_run.data.attrs | {"urdf_folder": str(tmp_path)}
    moved = dataclasses.replace(clearance_run, data=clearance_run.data.assign_attrs(attributes))
    (warning,) = record(moved).data["warnings"]
    assert warning.startswith(
        f"reflector: mesh file 'dish.obj' must have its vertices within 1e+09 m, got {said}"
    )
    assert not recwarn.list


def test_interrupted_one_sample_and_nothing_to_show(clearance_run, ideal_run):
    stopped = dataclasses.replace(
        clearance_run,
        outcome=Outcome.INTERRUPTED,
        message="stopped by the user; the results so far are saved",
    )
    assert record(stopped).data["warnings"] == [
        "the run ended early: stopped by the user; the results so far are saved"
    ]
    single = dataclasses.replace(clearance_run, data=clearance_run.data.isel(time=slice(0, 1)))
    for view in ("mechanism", "joint"):
        data = record(single, view=view).data
        assert len(doubles(data["times"])) == 1
        assert "one sample" in data["warnings"][-1]
    with pytest.raises(
        InvalidParameterError, match="view must be mechanism for a run without a clearance joint"
    ):
        record(ideal_run, view="joint")


def test_names_that_do_not_exist(clearance_run):
    with pytest.raises(UnknownNameError, match="body 'reflectr' is unknown; did you mean reflector"):
        record(clearance_run, body="reflectr")
    with pytest.raises(UnknownNameError, match="joint with clearance 'azimuth' is unknown"):
        record(clearance_run, view="joint", joint="azimuth")
    with pytest.raises(InvalidParameterError, match="boresight must be three finite numbers, not all zero"):
        record(clearance_run, body="reflector", boresight=(0, 0, 0))
    with pytest.raises(InvalidParameterError, match="view must be"):
        record(clearance_run, view="side")


def test_saved_shown_in_a_notebook_and_embedded(clearance_run, tmp_path):
    recording = record(clearance_run)
    path = recording.save(tmp_path / "run.html")
    assert path.read_text(encoding="utf-8") == recording.html
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(OutputError, match="does not exist"):
        recording.save(tmp_path / "none" / "run.html")
    frame = recording._repr_html_()
    assert html.unescape(re.search(r'srcdoc="(.*?)"', frame, re.DOTALL)[1]) == recording.html
    part = recording.embedded("case3")
    assert len(part) < len(recording.html) - 800_000 < len(shared_head().html) + len(part)
    data = re.search(r'id="case3-data">(.*?)</script>', part)[1]
    assert json.loads(data) == json.loads(json.dumps(recording.data))


def test_the_same_run_gives_the_same_page(clearance_run, tmp_path):
    """No clock, no name of the machine: a page can be compared and cached."""
    path = clearance_run.save(tmp_path / "run.nc")
    assert record(Trajectory.load(path)).html == record(clearance_run).html


@pytest.mark.parametrize(("run", "hollow"), [("clearance_run", "bearing"), ("ball_run", "socket")])
def test_of_the_bearing_the_half_towards_the_camera_is_cut_away(request, run, hollow):
    """Both halves meet in the plane through its axis and across the view; only the one behind is solid."""
    picture = record(request.getfixturevalue(run), view="joint")
    parts = drawn_meshes(picture)
    behind, before = parts[f"run/{hollow}"], parts[f"run/{hollow} cut away"]
    towards = np.array(DIRECTION) @ np.array(picture.data["triad"]["axes"]).T
    towards[2] = 0.0  # the bearing's axis is z
    towards /= np.linalg.norm(towards)
    radius = np.linalg.norm(behind[:, :2], axis=1).max()
    assert (behind @ towards).max() == pytest.approx(0.0, abs=1e-6 * radius)
    assert (before @ towards).min() == pytest.approx(0.0, abs=1e-6 * radius)
    assert (behind @ towards).min() == pytest.approx(-radius, rel=1e-6)
    assert (before @ towards).max() == pytest.approx(radius, rel=1e-6)
