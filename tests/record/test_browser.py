"""A real browser plays recordings: offline, without complaint, and shows the poses of the run."""

import base64
import dataclasses
import html
import itertools
import json
import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import body_poses, quantity
from antenna_pin.show.record import shared_head

from .conftest import record

SIZE = (900, 640)
FIELD_OF_VIEW = np.radians(32.0)
MARK = np.array([0x00, 0x72, 0xB2])  # the tip's colour; it is drawn without light
CAMERA, TARGET = np.array([4.5, 1.5, 2.9]), np.array([0.0, 0.4, 1.8])

READY = "for (const player of AntennaPin.players) await player.ready;"


@pytest.fixture
def opened(page, tmp_path):
    """Open a recording and wait for its first picture."""

    def open_recording(recording, width=SIZE[0], height=SIZE[1]):
        page.open(recording.save(tmp_path / "a recording.html"), width, height)
        page.run("await window.recording.ready;")
        return page

    return open_recording


def shown(page, t):
    """Go to a time and return the canvas."""
    page.run("recording.seek(a[0]); recording.render();", float(t))
    return page.pixels().astype(int)


def quiet(page):
    return page.errors == [] and page.requests == []


def pinhole(point, width, height, up=(0.0, 0.0, 1.0)):
    """Where a camera at CAMERA that looks at TARGET sees points, (n, 2) pixels."""
    back = (CAMERA - TARGET) / np.linalg.norm(CAMERA - TARGET)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(back, right), back])
    x, y, depth = axes @ (point - CAMERA)
    scale = 0.5 * height / np.tan(0.5 * FIELD_OF_VIEW) / -depth
    return np.array([0.5 * width + scale * x, 0.5 * height - scale * y])


def test_plays_offline_and_the_picture_changes(opened, clearance_run, ideal_run):
    page = opened(record(clearance_run, ideal_run, body="reflector"))
    first, last = shown(page, 0.0), shown(page, 0.05)
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 100  # not blank: shaded bodies
    assert np.abs(first - last).max() > 100
    assert np.array_equal(shown(page, 0.0), first)  # what is drawn depends on the time alone
    page.run("recording.setSpeed(0.1); window.began = performance.now(); recording.play();")
    assert page.settles(True, "return recording.time > 0.0;")
    played, lasted = page.run("recording.pause(); return [recording.time, performance.now() - window.began];")
    assert 0.0 < played <= 0.1e-3 * lasted
    assert quiet(page)


@pytest.mark.parametrize(("gravity", "up"), [((0, 0, 0), (0, 0, 1)), ((9.81, 0, 0), (-1, 0, 0))])
def test_a_mark_is_where_the_trajectory_has_it(opened, clearance_run, gravity, up):
    """The tip of the boresight, found by its colour, against pose and pinhole camera worked out here.

    Up is against gravity, whichever way it points in the world.
    """
    mechanism = json.loads(clearance_run.data.attrs["mechanism"]) | {"gravity": gravity}
    data = clearance_run.data.assign_attrs(mechanism=json.dumps(mechanism))
    recording = record(
        dataclasses.replace(clearance_run, data=data), body="reflector", boresight=(0.0, 0.0, 1.0)
    )  # nothing hides its tip
    page = opened(recording)
    page.run("recording.setCamera(a[0], a[1]);", CAMERA.tolist(), TARGET.tolist())
    reflector = f"run/{list_of_bodies(clearance_run).index('reflector')}"
    # Only the tip is to have its colour: its line and trace are taken away.
    page.run(
        "recording.trails.forEach((trail) => { trail.mesh.visible = false; });"
        "recording.viewer.scene_tree.find(a[0].split('/')).object.visible = false;",
        f"{reflector}/line",
    )
    tip_at = "return recording.viewer.scene_tree.find(a[0].split('/')).object.position.toArray();"
    reach = page.run(tip_at, f"{reflector}/tip")
    height, width = shown(page, 0.0).shape[:2]
    times = clearance_run.data["time"].values
    for index in (0, len(times) // 2, len(times) - 1):
        pose = body_poses(clearance_run, times=[index]).sel(body="reflector").isel(time=0)
        tip = pose["position"].values + Rotation.from_quat(pose["attitude"].values).apply(reach)
        expected = pinhole(tip, width, height, up)
        marked = np.abs(shown(page, times[index]) - MARK).max(axis=2) <= 2
        rows, columns = np.nonzero(marked)
        assert len(rows) > 20
        centre = np.array([columns.mean() + 0.5, rows.mean() + 0.5])
        # Half a pixel: pixels cut at the ball's rim, whose picture is an ellipse a little off its centre.
        assert np.abs(centre - expected).max() < 0.5
        assert (
            np.abs(np.array(page.run("return recording.project(a[0]);", tip.tolist())) - expected).max()
            < 1e-3
        )
        seen = page.run("return recording.pose('reflector');")
        assert seen["position"] == pytest.approx(pose["position"].values, rel=0.0, abs=1e-6)  # 32-bit floats
    assert quiet(page)


def list_of_bodies(run):
    return [str(name) for name in body_poses(run, times=[0])["body"].values]


def test_between_key_frames_poses_are_interpolated(opened, clearance_run):
    page = opened(record(clearance_run, fps=100.0))
    times = page.run("return Array.from(recording.times);")
    k = int(np.argmax(np.diff(times)))
    poses = []
    for t in (times[k], 0.5 * (times[k] + times[k + 1]), times[k + 1]):
        page.run("recording.seek(a[0]);", t)
        poses.append(page.run("return recording.pose('shaft2');"))
    before, middle, after = (np.array(pose["position"]) for pose in poses)
    assert middle == pytest.approx(0.5 * (before + after), rel=0.0, abs=1e-9)
    turns = [Rotation.from_quat(pose["quaternion"]) for pose in poses]
    halves = [(turns[1] * turns[0].inv()).as_rotvec(), (turns[2] * turns[1].inv()).as_rotvec()]
    assert halves[0] == pytest.approx(halves[1], rel=0.0, abs=1e-6)  # 32-bit floats


def test_an_impact_between_two_pictures_is_shown(opened, clearance_run):
    """Played at 30 frames per second in real time, the whole run is two pictures; no peak is lost."""
    page = opened(record(clearance_run))
    page.run("recording.seek(0); recording.advance(0.05, 1 / 30);")
    shown_forces = np.array(page.run("return recording.contacts.items.map((item) => item.shown.size);"))
    largest = np.linalg.norm(clearance_run.data["contact_force"].values, axis=2).max(axis=0)
    assert shown_forces == pytest.approx(largest, rel=1e-6, abs=0.0)
    page.run("recording.seek(0.05);")
    exact = np.array(page.run("return recording.contacts.items.map((item) => item.shown.size);"))
    now = np.linalg.norm(clearance_run.data["contact_force"].values[-1], axis=1)
    assert exact == pytest.approx(now, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    "run",
    [
        "clearance_run",
        pytest.param("planar_run", marks=pytest.mark.slow),
        pytest.param("ball_run", marks=pytest.mark.slow),
    ],
)
def test_the_joint_close_up(opened, run, request):
    page = opened(record(request.getfixturevalue(run), view="joint"))
    page.run("recording.jump(1);")
    t = page.run("return recording.time;")
    at_peak = shown(page, t)
    assert np.abs(at_peak - shown(page, page.run("return recording.start;"))).max() > 60
    assert "times as large" in page.run("return document.querySelector('.ap-facts').textContent;")
    assert quiet(page)


def test_keys_work_without_a_click(opened, clearance_run):
    """Real keys, on a page that nobody has touched."""
    page = opened(record(clearance_run))
    assert page.run("return document.activeElement === recording.root;")
    page.press("End")
    assert page.run("return recording.time === recording.end;")
    page.press("Home")
    page.press("ArrowRight", shift=True)
    first = clearance_run.data["peak_time"].values.min()
    assert page.run("return recording.time;") == pytest.approx(first, rel=1e-12)
    speed = page.run("return recording.speed;")
    page.press("[")
    assert page.run("return recording.speed;") < speed
    page.press("]")
    assert page.run("return recording.speed;") == speed
    page.press(" ")
    assert page.run("return recording.playing;")
    page.press(" ")
    assert not page.run("return recording.playing;")
    for key, way in (("1", [1.0, 0.0]), ("2", [0.0, 1.0])):
        page.press(key)
        position, target = seen(page)
        away = position - target
        assert away[:2] / np.linalg.norm(away) == pytest.approx(way, abs=1e-9)
    page.press("f")
    assert page.run("return recording.eye.followed.name;") == list_of_bodies(clearance_run)[0]
    for key, part in (("?", "help"), ("p", "panel")):
        page.press(key)
        assert not page.run("return recording[a[0]].node.hidden;", part)
    page.press("Escape")
    assert page.run("return recording.help.node.hidden && recording.panel.node.hidden;")
    page.run("recording.seek(recording.start); recording.dispose();")
    page.press("End")
    assert page.run("return recording.time === recording.start;")
    assert quiet(page)


def seen(page):
    """Where the camera is and what it looks at, as read back."""
    camera = page.run("return recording.camera;")
    return np.array(camera["position"]), np.array(camera["target"])


@pytest.mark.parametrize("size", [(1400, 900), (390, 780)])
@pytest.mark.parametrize("view", ["iso", *(pytest.param(axis, marks=pytest.mark.slow) for axis in "xyz")])
def test_all_of_the_motion_is_in_the_picture(opened, clearance_run, view, size):
    """Whatever is reached at any time lies below the heading, and fills the stage one way at least."""
    page = opened(record(clearance_run), *size)
    page.run("recording.view(a[0], true);", view)
    top, width, height = page.run(
        "const [head, stage] = [recording.head, recording.stage].map((one) => one.getBoundingClientRect());"
        "return [Math.max(head.bottom - stage.top, 0), stage.width, stage.height];"
    )
    framed = np.frombuffer(
        base64.b64decode(page.run("return recording.data.camera.points;")), dtype="<f4"
    ).reshape(-1, 3)
    places = np.array(page.run("return a[0].map((point) => recording.project(point));", framed.tolist()))
    assert places[:, 0].min() > 0.0 and places[:, 0].max() < width
    assert places[:, 1].min() > top and places[:, 1].max() < height
    # 1.06 is left about it, on both sides together.
    across, down = np.ptp(places, axis=0) / [width, height - top]
    assert max(across, down) > 0.93


OUTERMOST = """
const found = [];
for (const body of recording.bodies) for (const shape of body.shapes) shape.traverse((one) => {
  if (!one.geometry) return;
  const vertices = one.geometry.attributes.position;
  one.updateWorldMatrix(true, false);
  for (let i = 0; i < vertices.count; i++) {
    const place = new MeshCat.THREE.Vector3().fromBufferAttribute(vertices, i).applyMatrix4(one.matrixWorld);
    found.push(recording.eye.pixels(place));
  }
});
const [head, stage] = [recording.head, recording.stage].map((one) => one.getBoundingClientRect());
return [found, Math.max(head.bottom - stage.top, 0), stage.width, stage.height];
"""


def test_it_begins_with_the_mechanism_in_the_picture_and_shows_all_of_the_motion_on_a_key(page, tmp_path):
    """Panels swing far out: folded, they fill the picture; what is reached later is framed on a key."""
    run = simulate(load_scenario("solar_array", case="ideal"), duration=2.0)
    page.open(record(run, curves=()).save(tmp_path / "array.html"), 1280, 720)
    page.run("await window.recording.ready;")

    def filled():
        places, top, width, height = page.run(OUTERMOST)
        places = np.array(places)
        assert places.min() > 0.0 and places[:, 0].max() < width and places[:, 1].max() < height
        assert places[:, 1].min() > top
        return max(np.ptp(places, axis=0) / [width, height - top])

    assert filled() > 0.93  # 1.06 is left about it, on both sides together
    page.press("a")
    assert filled() < 0.93
    page.press("End")
    filled()  # in the picture there as well
    page.press("r")
    assert filled() > 0.93
    assert quiet(page)


def test_a_body_that_is_followed_stays_where_it_is(opened, clearance_run):
    page = opened(record(clearance_run))
    centre = "const one = recording.eye.followed; return recording.eye.pixels(recording.eye.place(one));"
    page.run("recording.seek(0); recording.follow('reflector');")
    before = page.run(centre)
    position, _ = seen(page)
    page.run("recording.seek(0.05);")
    # Single precision of three.js' matrices, over some 500 pixels.
    assert page.run(centre) == pytest.approx(before, abs=1e-3)
    moved, _ = seen(page)
    # The camera has gone the way of the dish's middle.
    poses = body_poses(clearance_run, times=[0, -1]).sel(body="reflector")
    middle = page.run("return recording.eye.followed.centre.toArray();")
    ends = poses["position"].values + Rotation.from_quat(poses["attitude"].values).apply(middle)
    assert np.linalg.norm(ends[1] - ends[0]) > 1e-4
    assert moved - position == pytest.approx(ends[1] - ends[0], abs=1e-6)  # 32-bit floats
    width, height = page.run("return [recording.stage.clientWidth, recording.stage.clientHeight];")
    assert before == pytest.approx([0.5 * width, before[1]]) and 0 < before[1] < height
    page.run("recording.follow(null);")
    kept, _ = seen(page)
    page.run("recording.seek(0);")
    assert seen(page)[0] == pytest.approx(kept, abs=1e-12)
    assert quiet(page)


def place_of_curve(page):
    """Left and middle height of the curve's canvas in the view, and its width [px]."""
    return page.run(
        "const r = recording.curve.canvas.getBoundingClientRect();"
        "return [r.left, 0.5 * (r.top + r.bottom), r.width];"
    )


@pytest.mark.parametrize("name", ["|contact_force[elevation.radial-]|", "motion_angle[elevation]"])
def test_the_value_below_the_pointer_is_the_results(opened, clearance_run, name):
    """To the last digit, with its unit, at a sample that is nearest in time of those that are drawn."""
    page = opened(record(clearance_run, curves=(name,)))
    exact = quantity(clearance_run, name)
    left, middle, width = place_of_curve(page)
    unit = "N" if name.startswith("|") else "rad"
    found = set()
    peak = float(exact.time[np.argmax(exact.values)])
    places = page.run(
        "return a[0].map((t) => recording.curve.xAt(t));", [*np.linspace(0.002, 0.048, 13), peak]
    )
    for x in places:
        page.point(left + x, middle)
        text = page.run("return recording.curve.value.textContent;")
        value, shown_unit, time = re.fullmatch(r"(\S+) (\S+) at (\S+) s", text).groups()
        assert shown_unit == unit
        at = np.flatnonzero(np.isclose(exact.time, float(time), rtol=1e-8, atol=0.0))  # nine digits are shown
        assert float(value) in exact.values[at]
        reached = page.run("return recording.curve.timeAt(a[0]);", x)
        drawn = np.array(page.run("return Array.from(recording.curve.times);"))
        assert np.abs(drawn - reached).min() == pytest.approx(abs(float(time) - reached), abs=1e-9)
        found.add(float(value))
    assert len(found) > 1 and max(found) == exact.values.max()
    page.point(left + 0.5 * width, middle - 200)
    assert " at " not in page.run("return recording.curve.value.textContent;")
    assert quiet(page)


GHOST = np.array([0xAA, 0x44, 0x99])  # of the ideal run's curve


def test_the_curve_of_the_ideal_run_is_beside_and_said(opened, clearance_run, ideal_run):
    page = opened(record(clearance_run, ideal_run), 1400, 900)
    page.run("recording.curve.choose('motion_rate[elevation]');")
    time, exact = 0.031, quantity(ideal_run, "motion_rate[elevation]")
    page.run("recording.seek(a[0]);", time)
    said = page.run("return recording.curve.other.textContent;")
    value, unit = re.fullmatch(r"ideal \u2248 (\S+) (\S+)", said).groups()
    factor = {"rad/s": 1.0, "mrad/s": 1e-3}[unit]
    expected = float(np.interp(time, exact.time, exact.values)) / factor
    # Four digits are shown, and a curve is off by a ten-thousandth of its range at most.
    assert float(value.replace("\u2212", "-")) == pytest.approx(
        expected, rel=5e-4, abs=1e-4 * np.ptp(exact.values) / factor
    )
    pixels = page.pixels(".ap-curve canvas").astype(int)
    assert (np.abs(pixels - GHOST).max(axis=2) <= 24).any(
        axis=0
    ).mean() > 0.3  # it goes along most of the time
    # A contact has no curve without play.
    page.run("recording.curve.choose(recording.data.curves.first);")
    assert page.run("return recording.curve.other.textContent;") == ""
    assert not (np.abs(page.pixels(".ap-curve canvas").astype(int) - GHOST).max(axis=2) <= 24).any()
    assert quiet(page)


def test_on_a_phone_no_number_lies_over_the_curve(opened, clearance_run, ideal_run):
    page = opened(record(clearance_run, ideal_run), 400, 800)
    page.resize(400, 800, mobile=True)
    page.run("recording.curve.choose('motion_rate[elevation]');")
    boxes = page.run(
        "return ['.ap-curve canvas', '.ap-range', '.ap-pick', '.ap-left'].map((one) => {"
        "  const box = document.querySelector(one).getBoundingClientRect();"
        "  return [box.top, box.bottom, box.right];"
        "});"
    )
    for (_, bottom, right), (top, _, _) in itertools.pairwise(boxes):  # one below the other
        assert bottom <= top and right <= 400
    said = page.run("return document.querySelector('.ap-range').innerText;")
    assert said.count("rad/s") == 2
    for value in (".ap-value", ".ap-other"):
        wide, room = page.run(
            "const one = document.querySelector(a[0]); return [one.scrollWidth, one.clientWidth];", value
        )
        assert wide <= room, value
    assert quiet(page)


def test_the_curve_goes_with_time_and_time_with_the_curve(opened, clearance_run):
    page = opened(record(clearance_run), 1400, 900)
    left, middle, width = place_of_curve(page)
    slider = page.run("const r = recording.bar.slider.getBoundingClientRect(); return [r.left, r.width];")
    assert [left, width] == pytest.approx(slider, abs=1.0)  # the same time at the same place
    page.point(left + 0.25 * width, middle, "mousePressed")
    quarter = page.run("return recording.time;")
    assert quarter == pytest.approx(0.05 * (0.25 * width - 8.0) / (width - 16.0), abs=0.05 / width)
    page.point(left + 0.75 * width, middle)  # dragged
    assert page.run("return recording.time;") == pytest.approx(0.05 - quarter, abs=0.1 / width)
    page.point(left + 0.75 * width, middle, "mouseReleased")
    page.point(left + 0.3 * width, middle - 200)
    assert page.run("return recording.time;") == pytest.approx(0.05 - quarter, abs=0.1 / width)
    for share in (0.1, 0.6):
        page.run("recording.seek(a[0]);", 0.05 * share)
        line = np.abs(page.pixels(".ap-curve canvas").astype(int) - MARK).max(axis=2) <= 40
        columns = np.flatnonzero(line.mean(axis=0) > 0.9)  # one that goes all the way down
        assert columns == pytest.approx(8.0 + share * (width - 16.0), abs=1.5)
    # Between samples the value is that of the line, which says so.
    assert page.run("return recording.curve.value.textContent;").endswith(" N")
    page.run("recording.curve.choose('motion_rate[elevation]');")
    assert page.run("return recording.curve.value.textContent;").endswith(" mrad/s")
    assert quiet(page)


def test_bodies_are_shown_hidden_and_seen_through(opened, clearance_run):
    page = opened(record(clearance_run))
    page.press("p")
    rows = page.run("return Array.from(document.querySelectorAll('.ap-body')).map((row) => row.textContent);")
    assert rows == list_of_bodies(clearance_run)  # a chain: in the order in which they hang on one another
    page.run("recording.seek(0.02); recording.render();")
    before = page.pixels().astype(int)
    clear = "const input = document.querySelectorAll('.ap-body .ap-clear')[0]; input.value = a[0];"
    clear += "input.dispatchEvent(new Event('input')); recording.render();"
    hide = "document.querySelectorAll('.ap-body input[type=checkbox]')[0].click(); recording.render();"
    page.run(clear, 0.3)
    through = np.abs(page.pixels().astype(int) - before)
    page.run(clear, 1.0)
    assert np.array_equal(page.pixels(), before)
    page.run(hide)
    gone = np.abs(page.pixels().astype(int) - before)
    assert 0.1 * gone.sum() < through.sum() < gone.sum()
    page.run(hide)
    assert np.array_equal(page.pixels(), before)
    assert quiet(page)


def test_names_stand_at_their_bodies_and_joints(opened, clearance_run):
    page = opened(record(clearance_run))
    page.press("n")
    page.run("recording.switches.find((one) => one.text.startsWith('joints')).set(true); recording.render();")
    shown_names = page.run(
        "return recording.labels.items.filter((one) => !one.node.hidden).map((one) => {"
        "  const r = one.node.getBoundingClientRect(), s = recording.stage.getBoundingClientRect();"
        "  return [one.text, one.kind, 0.5 * (r.left + r.right) - s.left];"
        "});"
    )
    assert {text for text, kind, _ in shown_names if kind == "joint"} == {"azimuth", "elevation"}
    assert {text for text, kind, _ in shown_names if kind == "body"} == set(list_of_bodies(clearance_run))
    # The joint's origin is that of its child: the URDF has it so.
    position = body_poses(clearance_run, times=[0]).sel(body="shaft1")["position"].values[0]
    across = page.run("return recording.project(a[0]);", position.tolist())[0]
    assert next(x for text, _, x in shown_names if text == "azimuth") == pytest.approx(across, abs=0.6)
    page.press("n")
    page.run("recording.render();")
    assert page.run("return recording.labels.node.hidden;")


@pytest.mark.slow
def test_the_scale_bar_is_as_long_as_it_says(opened, clearance_run):
    """At the depth that the camera looks at, and in a joint close up of the play M times as long."""
    for view, kwargs in (("mechanism", {}), ("joint", {"magnify": 40.0})):
        page = opened(record(clearance_run, view=view, **kwargs))
        text, wide = page.run(
            "recording.render(); return [recording.scaleBar.text.textContent,"
            " recording.scaleBar.bar.getBoundingClientRect().width];"
        )
        numbers = [
            float(n) * {"m": 1.0, "mm": 1e-3, "µm": 1e-6}[u] for n, u in re.findall(r"(\S+) (mm|µm|m)", text)
        ]
        position, target = seen(page)
        right = np.cross(target - position, [0.0, 0.0, 1.0])
        end = target + numbers[0] * right / np.linalg.norm(right)
        one, other = (
            np.array(page.run("return recording.project(a[0]);", p.tolist())) for p in (target, end)
        )
        assert np.linalg.norm(other - one) == pytest.approx(wide, abs=0.1)  # a tenth of a pixel is written
        assert numbers[1:] == ([] if view == "mechanism" else [pytest.approx(numbers[0] / 40.0, rel=1e-3)])


def test_a_page_is_dark_where_pages_are(opened, clearance_run):
    page = opened(record(clearance_run))
    light = page.screenshot().mean()
    page.prefer("dark")
    page.run("await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));")
    dark = page.screenshot()
    assert light > 200.0 and dark.mean() < 60.0
    page.run("recording.paper(); recording.render();")
    assert page.pixels().mean() > 200.0  # paper is white
    page.prefer("light")
    assert quiet(page)


def test_a_stop_is_orange_while_it_is_touched(opened):
    """Of the two wedges in one place that one is seen which the recorded mode asks for."""
    run = simulate(load_scenario("solar_array"), duration=0.05)
    modes = run.data["element_mode"].sel(element="stops.second").values
    assert {0, 2} <= set(modes)
    page = opened(record(run))
    times = run.data["time"].values
    for k in np.unique(np.linspace(0, len(times) - 1, 25).astype(int)):
        page.run("recording.seek(a[0]);", float(times[k]))
        rest, touched = page.run(
            "return ['4D5866', 'D55E00'].map((colour) => recording.actors[0].tracks.find("
            "(track) => track.kind === 'shown' && track.name.endsWith('stops.second upper')"
            " && track.path.endsWith(colour)).object.visible);"
        )
        last = np.flatnonzero(times == times[k])[0]  # of samples at one instant the first is a key frame
        assert touched == (modes[last] == 2) and rest != touched


def test_the_size_of_a_phone(opened, clearance_run):
    page = opened(record(clearance_run), 350, 780)
    width, height = page.run("return [recording.canvas.clientWidth, recording.canvas.clientHeight];")
    assert width == 350 and 380 < height < 780
    assert page.run("return document.documentElement.scrollWidth;") == 350
    ends = (
        "return Math.max(...Array.from(recording.root.querySelectorAll('.ap-bar *'))"
        ".map((one) => one.getBoundingClientRect().right));"
    )
    assert page.run(ends) <= 350
    smallest = page.run(
        "return Math.min(...Array.from(document.querySelectorAll('.ap-button, .ap-speed'))"
        ".filter((node) => node.offsetParent).map((node) => node.getBoundingClientRect().height));"
    )
    assert smallest >= 44  # what a finger hits
    assert quiet(page)


def test_a_narrow_frame_in_a_page_leaves_the_scene_its_height(page, tmp_path, planar_run):
    """In a column of a report all that stands beside the scene takes more than the height that was given."""
    part = record(planar_run, view="joint").embedded("narrow", "24rem")
    text = f"<!DOCTYPE html><head>{shared_head().html}</head><div style='width: 540px'>{part}</div>"
    (tmp_path / "column.html").write_text(text, encoding="utf-8")
    page.open(tmp_path / "column.html", 1280, 900)
    page.run(f"await AntennaPin.ready; await new Promise((done) => setTimeout(done, 300)); {READY}")
    stage, bar, frame = page.run(
        "const {stage, bar, root} = AntennaPin.players[0];"
        "const bottom = (node) => node.getBoundingClientRect().bottom;"
        "return [stage.clientHeight, bottom(bar.node), bottom(root)];"
    )
    assert stage >= 240
    assert bar <= frame
    assert quiet(page)


STILLS = """return Array.from(document.querySelectorAll(".ap-still")).map((still) => {
  const {data} = still.getContext("2d").getImageData(0, 0, still.width, still.height);
  return new Set(new Uint32Array(data.buffer)).size;  // colours
});"""


def colours(page, selector):
    return len(np.unique(page.pixels(selector).reshape(-1, 3), axis=0))


@pytest.mark.slow
def test_many_in_one_page(page, tmp_path, clearance_run, ideal_run):
    """They share the scripts, begin when they come into view, and never hold too many graphics contexts."""
    names = [f"r{k}" for k in range(10)]
    runs = [record(clearance_run), record(ideal_run), record(clearance_run, view="joint")]
    parts = "".join(runs[k % 3].embedded(name, "20rem") for k, name in enumerate(names))
    path = tmp_path / "many.html"
    path.write_text(f"<!doctype html><title>many</title>{shared_head().html}{parts}", encoding="utf-8")
    page.open(path, 640, 300)
    for name in (*names[::3], names[0]):
        page.run("document.getElementById(a[0]).scrollIntoView();", name)
        there = "return document.querySelector(a[0]) !== null;"
        assert page.settles(True, there, f"#{name} canvas")
        page.run(READY)
        assert page.run("return AntennaPin.players.length;") <= 8
    page.run("window.dispatchEvent(new Event('beforeprint'));")
    stills = page.run(STILLS)
    assert len(stills) == len(names) and min(stills) > 100
    page.run(f"window.dispatchEvent(new Event('afterprint')); {READY}")
    assert page.run("return document.querySelectorAll('.ap-still').length;") == 0
    assert colours(page, "#r0 canvas") > 100
    assert quiet(page)


def test_one_in_a_notebook(page, tmp_path, ideal_run):
    notebook = tmp_path / "notebook.html"
    notebook.write_text(
        f"<!doctype html><title>cell</title>{record(ideal_run)._repr_html_()}", encoding="utf-8"
    )
    page.open(notebook, *SIZE)
    for _ in range(100):  # nothing outside can ask it whether it is ready, nor it anything outside
        seen = len(np.unique(page.screenshot().reshape(-1, 3), axis=0))
        if seen > 300:
            break
        page.run("await new Promise((done) => setTimeout(done, 100));")
    assert seen > 300
    assert page.run("return document.querySelector('iframe').contentDocument === null;")
    assert quiet(page)


STRANGE = """
const seen = window.stopped = [];
document.addEventListener("securitypolicyviolation", (event) => seen.push(event.effectiveDirective));
const made = (tag) => document.createElement(tag);
const [script, image, frame, form] = ["script", "img", "iframe", "form"].map(made);
script.textContent = "window.pwned = true;";
image.setAttribute("onerror", "window.pwned = true;");
image.src = "http://127.0.0.1:9/image.png";
frame.src = "http://127.0.0.1:9/";
form.action = "http://127.0.0.1:9/";
for (const one of [script, image, frame, form]) document.body.append(one);
form.submit();
await fetch("http://127.0.0.1:9/").catch(() => 0);
try { new WebSocket("ws://127.0.0.1:9/"); } catch (error) { }
"""


def test_what_a_stranger_put_into_a_page_runs_nothing_and_sends_nothing(opened, ideal_run):
    """Were markup of a file's to get in, the page's policy would stop it."""
    page = opened(record(ideal_run))
    page.run(STRANGE)
    # Each as it was stopped; the log of requests has some of them all the same.
    wanted = ["connect-src", "form-action", "frame-src", "img-src", "script-src-attr", "script-src-elem"]
    assert page.settles([], "return a[0].filter((one) => !window.stopped.includes(one));", wanted) == []
    assert not page.run("return window.pwned === true;")


@pytest.mark.slow
def test_what_the_heading_names_can_be_hidden(opened, clearance_run, ideal_run):
    page = opened(record(clearance_run, ideal_run, body="reflector"))
    page.run("recording.seek(recording.data.poster); recording.render();")
    before = page.pixels().astype(int)
    count = page.run("return document.querySelectorAll('.ap-facts li:not([hidden]) .ap-fact').length;")
    assert (
        count == 3
    )  # forces, boresight, ideal run; joints and frames are hidden, and shown the other way round
    for k in range(count):
        toggle = "document.querySelectorAll('.ap-fact')[a[0]].click(); recording.render();"
        page.run(toggle, k)
        assert np.abs(page.pixels() - before).max() > 30
        page.run(toggle, k)
        assert np.array_equal(page.pixels(), before)


def test_a_note_is_of_what_is_missing_and_can_be_closed(opened, clearance_run):
    """How small a page was made is said among the keys; impacts that are left out lie over the scene."""
    full = 1e-6 * len(record(clearance_run, fps=1e6, curves=()).html.encode())
    small = record(clearance_run, fps=1e6, curves=(), max_megabytes=full - 3e-3)
    assert small.data["thinned"] and not small.data["warnings"]
    page = opened(small)
    assert page.run("return document.querySelector('.ap-notes');") is None
    page.press("?")
    assert page.run("return recording.help.node.innerText;").endswith("keep the page small")
    least = 1e-6 * len(record(clearance_run, fps=1.0, curves=()).html.encode())
    page = opened(record(clearance_run, curves=(), max_megabytes=least - 3e-3))
    assert "impacts are left out" in page.run("return document.querySelector('.ap-notes').innerText;")
    page.run("document.querySelector('.ap-close').click();")
    assert page.run("return document.querySelector('.ap-notes');") is None
    assert quiet(page)


def test_notes_and_one_sample(opened, clearance_run):
    import dataclasses

    attributes = clearance_run.data.attrs | {"urdf_folder": "/nowhere", "title": "<b> & </script>"}
    data = clearance_run.data.isel(time=slice(0, 1)).assign_attrs(attributes)
    page = opened(record(dataclasses.replace(clearance_run, data=data)))
    notes = page.run("return document.querySelector('.ap-notes').innerText;")
    assert "dish.obj" in notes and "one sample" in notes
    assert page.run("return document.querySelector('.ap-title').textContent;") == html.unescape(
        "<b> & </script>"
    )
    assert page.run("return document.querySelector('.ap-slider').disabled;")
    assert len(np.unique(shown(page, 0.0).reshape(-1, 3), axis=0)) > 100
    assert quiet(page)
