"""A real browser plays recordings: offline, without complaint, and shows the poses of the run."""

import dataclasses
import html
import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin.analysis import body_poses
from antenna_pin.record import record, shared_head

SIZE = (900, 640)
FIELD_OF_VIEW = np.radians(32.0)
BORESIGHT = np.array([0.0, 0.0, 1.0])  # z of the reflector: nothing hides its tip
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
    page.run(
        "recording.setSpeed(0.1); recording.play();"
        "await new Promise((done) => setTimeout(done, 300)); recording.pause();"
    )
    played = page.run("return recording.time;")
    assert 0.0 < played < 0.05
    assert quiet(page)


@pytest.mark.parametrize(("gravity", "up"), [((0, 0, 0), (0, 0, 1)), ((9.81, 0, 0), (-1, 0, 0))])
def test_a_mark_is_where_the_trajectory_has_it(opened, clearance_run, gravity, up):
    """The tip of the boresight, found by its colour, against pose and pinhole camera worked out here.

    Up is against gravity, whichever way it points in the world.
    """
    mechanism = json.loads(clearance_run.data.attrs["mechanism"]) | {"gravity": gravity}
    data = clearance_run.data.assign_attrs(mechanism=json.dumps(mechanism))
    recording = record(dataclasses.replace(clearance_run, data=data), body="reflector", boresight=BORESIGHT)
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


@pytest.mark.parametrize("run", ["clearance_run", "planar_run", "ball_run"])
def test_the_joint_close_up(opened, run, request):
    page = opened(record(request.getfixturevalue(run), view="joint"))
    page.run("recording.jump(1);")
    t = page.run("return recording.time;")
    at_peak = shown(page, t)
    assert np.abs(at_peak - shown(page, page.run("return recording.start;"))).max() > 60
    assert "times as large" in page.run("return document.querySelector('.ap-facts').textContent;")
    assert quiet(page)


def test_keys_work_on_a_fresh_page(opened, clearance_run):
    """Nothing was clicked and nothing has the focus: the key goes to the page's body."""
    page = opened(record(clearance_run))
    assert page.run("return document.activeElement === document.body;")
    press = "document.body.dispatchEvent(new KeyboardEvent('keydown', {key: a[0], bubbles: true}));"
    page.run(press, "End")
    assert page.run("return recording.time === recording.end;")
    page.run("recording.dispose();" + press, "Home")
    assert page.run("return recording.time === recording.end;")


def test_keys_and_the_size_of_a_phone(opened, clearance_run):
    page = opened(record(clearance_run), 390, 780)
    width, height = page.run("return [recording.canvas.clientWidth, recording.canvas.clientHeight];")
    assert width == 390 and 500 < height < 780
    assert page.run("return document.documentElement.scrollWidth;") == 390
    smallest = page.run(
        "return Math.min(...Array.from(document.querySelectorAll('.ap-button, .ap-speed'))"
        ".map((node) => node.getBoundingClientRect().height));"
    )
    assert smallest >= 44  # what a finger hits
    press = (
        "recording.root.dispatchEvent("
        "new KeyboardEvent('keydown', {key: a[0], shiftKey: a[1], bubbles: true}));"
    )
    page.run(press, "ArrowRight", True)
    first = clearance_run.data["peak_time"].values.min()
    assert page.run("return recording.time;") == pytest.approx(first, rel=1e-12)
    page.run(press, "End", False)
    assert page.run("return recording.time;") == pytest.approx(0.05, rel=1e-12)
    page.run(press, " ", False)
    assert page.run("return recording.playing;")
    page.run(press, " ", False)
    assert not page.run("return recording.playing;")
    assert quiet(page)


STILLS = """return Array.from(document.querySelectorAll(".ap-still")).map((still) => {
  const {data} = still.getContext("2d").getImageData(0, 0, still.width, still.height);
  return new Set(new Uint32Array(data.buffer)).size;  // colours
});"""


def colours(page, selector):
    return len(np.unique(page.pixels(selector).reshape(-1, 3), axis=0))


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
        page.run(f"await new Promise((done) => setTimeout(done, 100)); {READY}")
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
const seen = [];
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
await new Promise((done) => setTimeout(done, 300));
return [window.pwned === true, [...new Set(seen)].sort()];
"""


def test_what_a_stranger_put_into_a_page_runs_nothing_and_sends_nothing(opened, ideal_run):
    """Were markup of a file's to get in, the page's policy would stop it."""
    page = opened(record(ideal_run))
    ran, stopped = page.run(STRANGE)
    assert not ran
    # Each as it was stopped; the log of requests has some of them all the same.
    assert {"connect-src", "form-action", "frame-src", "img-src"} < set(stopped)
    assert {"script-src-elem", "script-src-attr"} < set(stopped)


def test_what_the_heading_names_can_be_hidden(opened, clearance_run, ideal_run):
    page = opened(record(clearance_run, ideal_run, body="reflector"))
    page.run("recording.seek(recording.data.poster); recording.render();")
    before = page.pixels().astype(int)
    count = page.run("return document.querySelectorAll('.ap-fact').length;")
    assert count == 3  # forces, boresight, ideal run
    for k in range(count):
        toggle = "document.querySelectorAll('.ap-fact')[a[0]].click(); recording.render();"
        page.run(toggle, k)
        assert np.abs(page.pixels() - before).max() > 30
        page.run(toggle, k)
        assert np.array_equal(page.pixels(), before)


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
