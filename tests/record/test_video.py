"""Pictures and videos: at their exact times, in files that other programs read; and without a browser."""

import base64
import contextlib
import dataclasses
import importlib.util
import io
import os
import signal

import av
import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation
from typer.testing import CliRunner

from antenna_pin.analysis import body_poses
from antenna_pin.apps.cli import app
from antenna_pin.errors import AntennaPinError, InvalidParameterError, MissingToolError, OutputError
from antenna_pin.show.record import Filmed, film_times, record, save_frames, save_picture, save_video
from antenna_pin.show.record import browser as browser_tools
from antenna_pin.show.record.browser import open_browser, open_camera

SMALL = (320, 180)
SLOW = 0.25  # 50 ms last 0.2 s


@pytest.fixture(scope="module")
def recording(clearance_run):
    return record(clearance_run, speed=SLOW)


@pytest.fixture
def browser(page):
    """Where there is none, the tests that need one are skipped, or fail if it is required."""


def picture(path):
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def difference(one, other):
    """Return the mean difference of pictures [of 255]."""
    return np.abs(np.asarray(one, dtype=int) - np.asarray(other, dtype=int)).mean()


def first_of(recording, folder):
    """Return the first picture of a film as it is taken."""
    save_frames(recording, folder, fps=5.0, size=SMALL)
    return picture(folder / "frame_1.png")


# --- times ---


def test_a_film_goes_from_the_start_to_the_end(recording):
    """0.05 s at a quarter of the speed and 30 per second: six steps of 1/120 s, the last at the end."""
    times = film_times(recording, 30.0)
    assert times == pytest.approx(np.arange(7) / 120, rel=1e-12, abs=1e-15)
    odd = film_times(recording, 28.0)  # 5.6 steps: the last picture comes early
    assert len(odd) == 7
    assert np.diff(odd)[:-1] == pytest.approx(SLOW / 28, rel=1e-9, abs=0.0)
    assert odd[-1] == 0.05 and 0.0 < odd[-1] - odd[-2] < SLOW / 28
    late = base64.b64encode(np.array([0.1, 0.15])).decode()
    shifted = film_times(dataclasses.replace(recording, data={**recording.data, "times": late}), 30.0)
    assert shifted == pytest.approx(0.1 + times, rel=1e-12)


# --- what is in the files ---


@pytest.mark.slow
def test_an_mp4_decodes_to_the_pictures_planned(recording, tmp_path, browser):
    told = []
    done = save_video(recording, tmp_path / "a run.mp4", size=SMALL, progress=lambda *now: told.append(now))
    assert done.completed and done.path == tmp_path / "a run.mp4"
    assert told == [(k, 7) for k in range(1, 8)]
    with av.open(done.path) as container:
        (stream,) = container.streams
        assert (stream.codec_context.name, stream.codec_context.pix_fmt) == ("h264", "yuv420p")
        assert stream.average_rate == 30 and (stream.width, stream.height) == SMALL
        frames = [frame.reformat(format="rgb24").to_ndarray() for frame in container.decode(stream)]
    assert len(frames) == done.frames == 7
    first = first_of(recording, tmp_path / "frames")
    assert first.std() > 10  # not blank
    assert difference(frames[0], first) < 3  # of 255: what compression leaves
    assert np.abs(frames[0].astype(int) - frames[-1]).max() > 60  # it moves
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a run.mp4", "frames"]


def test_a_gif_has_its_pictures_for_their_times(recording, tmp_path, browser):
    """30 per second in hundredths of a second: 30, 40, 30 ms in turns, so that the sum does not drift."""
    save_video(recording, tmp_path / "run.gif", size=SMALL, fps=30.0)
    with Image.open(tmp_path / "run.gif") as gif:
        assert (gif.n_frames, gif.size, gif.info["loop"]) == (7, SMALL, 0)
        pictures, shown = [], []
        for number in range(gif.n_frames):
            gif.seek(number)
            shown.append(gif.info["duration"])
            pictures.append(np.asarray(gif.convert("RGB")))
    assert shown[:-1] == [30, 40, 30, 30, 40, 30] and shown[-1] == 1000
    first = first_of(recording, tmp_path / "frames")
    assert difference(pictures[0], first) < 5  # of 255: 256 colours for all
    assert difference(pictures[0], pictures[-1]) > 0.1
    assert np.abs(pictures[0].astype(int) - pictures[-1]).max() > 60


@pytest.mark.slow
def test_frames_are_pictures_with_a_table_of_their_times(recording, tmp_path, browser):
    done = save_frames(recording, tmp_path / "frames", fps=10.0, size=(321, 181))
    rows = (tmp_path / "frames" / "frames.csv").read_text().splitlines()
    assert rows == ["file,time [s]", "frame_1.png,0", "frame_2.png,0.025", "frame_3.png,0.05"]
    pictures = [picture(tmp_path / "frames" / f"frame_{k}.png") for k in (1, 2, 3)]
    assert done.frames == 3 and {p.shape for p in pictures} == {(181, 321, 3)}
    assert difference(pictures[0], pictures[1]) > 0 and difference(pictures[1], pictures[2]) > 0


@pytest.mark.slow
@pytest.mark.parametrize("size", [(800, 450), SMALL])
def test_a_film_has_a_line_of_time(recording, tmp_path, browser, size):
    """At the bottom: blue from its left end up to the time, over a picture's width as over the run."""
    save_frames(recording, tmp_path / "frames", fps=20.0, size=size)
    done = []
    for name in sorted((tmp_path / "frames").glob("*.png")):
        below = picture(name)[-36:].astype(int)
        blue = np.abs(below - [0x00, 0x72, 0xB2]).max(axis=2) < 40
        columns = np.flatnonzero(blue.any(axis=0))
        done.append((columns.min(), columns.max()))
    starts, ends = np.array(done).T
    assert len(ends) == 5 and len(set(starts[1:])) == 1
    # The thumb, 16 pixels wide, goes even steps; a pixel of rounding each.
    assert np.diff(ends) == pytest.approx(np.full(4, (ends[-1] - ends[0]) / 4), abs=2.0)
    assert ends[-1] - ends[0] > 0.6 * size[0]


class Pretended:
    """A camera whose pictures are as large as asked for and say nothing; it notes its size and the times."""

    def __init__(self, monkeypatch):
        pretend_tools(monkeypatch)
        monkeypatch.setattr("antenna_pin.show.record.video.open_camera", self._open)

    @contextlib.contextmanager
    def _open(self, recording, size, still=False):
        self.size, self.times = size, []
        yield self

    def seek(self, time):
        self.times.append(time)
        png = io.BytesIO()
        Image.new("RGB", self.size, (0, 114, 178)).save(png, format="PNG", compress_level=0)
        return png.getvalue()

    def advance(self, time, step):
        self.step = step
        return self.seek(time)


def test_size_and_rate_are_those_of_the_kind_of_file_if_left_out(recording, tmp_path, monkeypatch):
    camera = Pretended(monkeypatch)
    save_picture(recording, tmp_path / "run.png")
    assert picture(tmp_path / "run.png").shape == (720, 1280, 3) and camera.times == [0.0]
    save_frames(recording, tmp_path / "frames")
    assert picture(tmp_path / "frames" / "frame_7.png").shape == (720, 1280, 3)
    assert camera.times == film_times(recording, 30.0).tolist() and camera.step == 1 / 30
    save_video(recording, tmp_path / "run.mp4")
    with av.open(tmp_path / "run.mp4") as container:
        (stream,) = container.streams
        assert (stream.width, stream.height, stream.average_rate) == (1280, 720, 30)
    save_video(recording, tmp_path / "run.gif")
    with Image.open(tmp_path / "run.gif") as gif:
        # Pictures that are alike are one, which is shown for the times of all: four of 50 ms, and the last.
        assert gif.size == (800, 450) and gif.info["duration"] == 4 * 50 + 1000
    assert camera.times[-5:] == film_times(recording, 20.0).tolist() and camera.step == 1 / 20


@pytest.mark.parametrize(
    ("size", "scale"),
    [((1280, 720), 1.0), ((640, 360), 1.0), ((1920, 1080), 1.5), ((1921, 1080), 1.0), ((3840, 2160), 3.0)],
)
def test_texts_of_a_large_picture_are_enlarged(size, scale):
    """Where the size is a whole number of pages; a small one keeps them as large as they are."""
    assert browser_tools._scale(*size) == scale


def test_the_camera_waits_for_the_page_s_own_script(browser, tmp_path):
    """Until it has run, ``window.recording`` is the element of that id, which has no ``pause``."""
    player = "{ready: Promise.resolve(), pause() { document.title = 'paused'; }}"
    late = tmp_path / "late.html"
    late.write_text(
        '<!DOCTYPE html><title>page</title><div id="recording"></div>'
        f"<script>setTimeout(() => {{ window.recording = {player}; }}, 400);</script>"
    )
    with open_browser() as there:
        there.open(late.as_uri())
        assert there.run("return recording instanceof Element && !recording.pause;")
        assert there.run(browser_tools._OPEN, ".ap-bar") == ""
        assert there.run("return document.title;") == "paused"


@pytest.mark.slow
def test_an_enlarged_picture_has_the_size_asked_for(recording, browser, monkeypatch):
    monkeypatch.setattr(browser_tools, "_VIEW", SMALL)  # larger ones take software long
    with open_camera(recording, (640, 360)) as camera:
        assert picture(io.BytesIO(camera.seek(0.0))).shape == (360, 640, 3)
        seen = camera._browser.run(
            "return [innerWidth, innerHeight, recording.canvas.width, devicePixelRatio];"
        )
    assert seen == [320, 180, 640, 2]


MAGENTA = """
<visual name="mark"><origin xyz="0.1 0.05 0.9"/><geometry><sphere radius="0.06"/></geometry>
<material name="mark_colour"><color rgba="1 0 1 1"/></material></visual>
"""
MATRICES = """
const {camera} = window.recording.viewer;
camera.updateMatrixWorld();
return [camera.projectionMatrix.toArray(), camera.matrixWorldInverse.toArray()];
"""


@pytest.mark.slow
def test_a_mark_in_a_picture_is_where_the_trajectory_has_it(clearance_run, tmp_path, browser):
    """A ball fixed to the reflector, found by its colour, against pose and camera."""
    head, link, tail = clearance_run.data.attrs["urdf"].partition('<link name="reflector">')
    assert link
    data = clearance_run.data.assign_attrs(urdf=head + link + MAGENTA + tail)
    marked = record(dataclasses.replace(clearance_run, data=data))
    times = clearance_run.data["time"].values[[0, -1]]
    with open_camera(marked, (640, 480), still=True) as camera:
        matrices = np.array(camera._browser.run(MATRICES)).reshape(2, 4, 4)  # by columns
        pictures = [picture(io.BytesIO(camera.seek(float(time)))) for time in times]
    saved = picture(save_picture(marked, tmp_path / "mark.png", float(times[1]), size=(640, 480)))
    assert np.array_equal(saved, pictures[1])
    for index, seen in zip((0, -1), pictures, strict=True):
        pose = body_poses(clearance_run, times=[index]).sel(body="reflector").isel(time=0)
        turn = Rotation.from_quat(pose["attitude"].values)
        x, y, z = pose["position"].values + turn.apply([0.1, 0.05, 0.9])
        at = np.array([x, z, -y, 1.0]) @ matrices[1] @ matrices[0]  # three.js' y is up
        expected = 320 * (1 + at[0] / at[3]), 240 * (1 - at[1] / at[3])
        red, green, blue = np.moveaxis(seen, 2, 0)
        rows, columns = np.nonzero((red > 2 * green + 40) & (blue > 2 * green + 40))
        assert len(rows) > 50
        # Half a pixel: pixels cut at the ball's rim, whose picture is an ellipse a little off its centre.
        assert (columns.mean() + 0.5, rows.mean() + 0.5) == pytest.approx(expected, rel=0.0, abs=0.5)


@pytest.mark.slow
def test_an_impact_between_two_pictures_is_seen(recording, clearance_run, browser):
    """Between contacts no arrow stands; in a video the picture has those of the impacts before it."""
    data = clearance_run.data
    free = np.flatnonzero((data["normal_force"].values == 0.0).all(axis=1))
    times = data["time"].values
    after = times[free[times[free] > data["peak_time"].values.min()][0]]

    def orange(png):
        red, green, blue = np.moveaxis(picture(io.BytesIO(png)), 2, 0)
        return ((red > 150) & (green > 40) & (red > 1.6 * green) & (blue < 60)).sum()

    with open_camera(recording, (640, 480)) as camera:
        exact = orange(camera.seek(after))
        camera.seek(0.0)
        in_video = orange(camera.advance(after, 1 / 30))
    assert in_video > exact + 50


# --- how it ends ---


@pytest.mark.parametrize(
    "name", ["run.gif", *(pytest.param(one, marks=pytest.mark.slow) for one in ("run.mp4", "frames"))]
)
def test_ctrl_c_keeps_the_pictures_done(recording, tmp_path, name, browser):
    def press(done, planned):
        if done == 3:
            os.kill(os.getpid(), signal.SIGINT)

    save = save_video if "." in name else save_frames
    done = save(recording, tmp_path / name, size=SMALL, fps=30.0, progress=press)
    assert not done.completed and (done.frames, done.planned) == (3, 7)
    if name == "run.mp4":
        with av.open(done.path) as container:
            assert sum(1 for _ in container.decode(video=0)) == 3
    elif name == "run.gif":
        with Image.open(done.path) as gif:
            assert gif.n_frames == 3
    else:
        found = sorted(path.name for path in done.path.iterdir())
        assert found == ["frame_1.png", "frame_2.png", "frame_3.png", "frames.csv"]
        assert len((done.path / "frames.csv").read_text().splitlines()) == 4
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_what_fails_leaves_nothing_behind(recording, tmp_path, browser):
    def fail(done, planned):
        raise RuntimeError("no")

    with pytest.raises(RuntimeError, match="no"):
        save_video(recording, tmp_path / "run.mp4", size=SMALL, progress=fail)
    assert list(tmp_path.iterdir()) == []


# --- refusals, all before the browser starts ---


@pytest.mark.parametrize(
    ("name", "settings", "error", "message"),
    [
        ("run.mp4", {"size": (641, 360)}, InvalidParameterError, "size must be even"),
        ("run.gif", {"size": (640, 9000)}, InvalidParameterError, "size must be 64 to 4096 pixels"),
        ("run.mp4", {"fps": 0.0}, InvalidParameterError, "fps must be above 0"),
        ("run.mp4", {"fps": float("nan")}, InvalidParameterError, "fps must be above 0"),
        ("run.gif", {"fps": 60.0}, InvalidParameterError, "at most 50"),
        ("run.avi", {}, OutputError, "must end in .mp4 or .gif"),
        ("nowhere/run.mp4", {}, OutputError, "does not exist"),
    ],
)
def test_refusals(recording, tmp_path, monkeypatch, name, settings, error, message):
    pretend_tools(monkeypatch)
    with pytest.raises(error, match=message):
        save_video(recording, tmp_path / name, **settings)


def test_a_gif_too_large_for_memory_is_refused(clearance_run, tmp_path, monkeypatch):
    pretend_tools(monkeypatch)
    slow = record(clearance_run, speed=1e-4)
    with pytest.raises(OutputError, match="10001 pictures of 800x450 are too many for a GIF"):
        save_video(slow, tmp_path / "run.gif")


def test_a_folder_with_something_in_it_is_refused(recording, tmp_path, monkeypatch):
    pretend_tools(monkeypatch)
    (tmp_path / "frame_1.png").touch()
    with pytest.raises(OutputError, match="must be new or empty"):
        save_frames(recording, tmp_path)


def test_a_time_outside_is_refused(recording, tmp_path, monkeypatch):
    pretend_tools(monkeypatch)
    with pytest.raises(InvalidParameterError, match=r"time must be within the recording, 0 to 0.05 s"):
        save_picture(recording, tmp_path / "run.png", 0.06)


def pretend_tools(monkeypatch):
    """What is refused is refused without the tools, too."""
    monkeypatch.setattr("antenna_pin.show.record.video.find_browser", lambda: None)


@pytest.mark.parametrize("save", [save_picture, save_video, save_frames])
def test_without_a_browser_it_says_what_to_install(recording, tmp_path, monkeypatch, save):
    for variable in ("ANTENNA_PIN_BROWSER", "ANTENNA_PIN_CHROMEDRIVER"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    target = tmp_path / ("frames" if save is save_frames else "run.mp4")
    with pytest.raises(AntennaPinError, match="apt-get install chromium chromium-driver"):
        save(recording, target)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("package", "name"), [("selenium", "selenium"), ("av", "av"), ("PIL", "pillow")])
def test_without_the_extra_it_says_what_to_install(recording, tmp_path, monkeypatch, package, name):
    there = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda asked, *rest: None if asked == package else there(asked, *rest)
    )
    monkeypatch.setenv("ANTENNA_PIN_BROWSER", "/bin/true")
    monkeypatch.setenv("ANTENNA_PIN_CHROMEDRIVER", "/bin/true")
    target = tmp_path / ("run.gif" if package == "PIL" else "run.mp4")
    with pytest.raises(MissingToolError, match=rf'package {name}, .*pip install "antenna-pin\[video\]"'):
        save_video(recording, target)


# --- the command ---


@pytest.fixture(scope="module")
def result(clearance_run, tmp_path_factory):
    return clearance_run.save(tmp_path_factory.mktemp("result") / "run.nc")


@pytest.fixture
def command(result, tmp_path, monkeypatch):
    """Run ``antenna-pin record`` in an empty folder; return exit code and what it says on both streams."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        done = CliRunner().invoke(app, ["record", str(result), "--no-progress", *arguments])
        return done.exit_code, done.stdout, done.stderr

    return run


@pytest.mark.slow
def test_a_picture_by_the_command(command, recording, tmp_path, browser):
    code, said, complaint = command(
        "--out", "run.png", "--at", "20 ms", "--speed", "1/4", "--size", "320x180"
    )
    assert (code, said, complaint) == (0, "saved run.png\n", "")
    same = picture(save_picture(recording, tmp_path / "same.png", 0.02, size=SMALL))
    assert np.array_equal(picture(tmp_path / "run.png"), same)


def test_an_interrupted_video_by_the_command(command, monkeypatch):
    pretend_tools(monkeypatch)
    monkeypatch.setattr("antenna_pin.show.record.save_video", lambda made, out, **settings: Filmed(out, 3, 7))
    code, said, complaint = command("--out", "run.mp4")
    assert code == 130 and said == "saved run.mp4\n"
    assert complaint == "antenna-pin: interrupted: run.mp4 has the first 3 of 7 pictures\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--out", "run.avi"), "must end in .html (page), .mp4 or .gif (video), .png (picture), or have no"),
        (("--out", "run.html", "--fps", "25"), "--fps: output must be one of .mp4, .gif, a folder"),
        (("--out", "run.mp4", "--at", "0.01"), "--at: output must be one of .png"),
        (("--out", "run.html", "--size", "640x480"), "--size: output must be one of .png, .mp4, .gif, a fol"),
        (("--out", "run.png", "--size", "640"), "--size: size must be WIDTHxHEIGHT in pixels such as 1280x"),
        (("--out", "run.png", "--at", "3 m"), "--at"),
        (("--out", "run.png", "--at", "1 s"), "time must be within the recording, 0 to 0.05 s, got 1.0"),
        (("--out", "."), "the folder for frames must be new or empty"),
    ],
)
def test_the_command_refuses_in_one_line(command, monkeypatch, tmp_path, arguments, message):
    pretend_tools(monkeypatch)
    (tmp_path / "something").touch()
    code, said, complaint = command(*arguments)
    assert code == 2 and said == ""
    assert complaint.count("\n") == 1 and complaint.startswith("antenna-pin: ") and message in complaint


def test_the_command_without_a_browser(command, monkeypatch, tmp_path):
    for variable in ("ANTENNA_PIN_BROWSER", "ANTENNA_PIN_CHROMEDRIVER"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    code, said, complaint = command("--out", "run.mp4")
    assert code == 2 and said == "" and complaint.count("\n") == 1
    assert "found no chromium or" in complaint and "apt-get install chromium chromium-driver" in complaint
