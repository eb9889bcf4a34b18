"""The page in a real browser: a slider changes the curves, and their values are those of ``simulate``."""

import contextlib
import html
import http.client
import itertools
import os
import re
import signal
import stat
import subprocess
import sys
import threading
import time
import urllib.parse
import urllib.request
from pathlib import Path

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import journal_motion
from antenna_pin.apps.live import explore
from antenna_pin.errors import OutputError

pytest.importorskip("bokeh", reason="the extra explore is not installed: pip install 'antenna-pin[explore]'")

PLAY = "clearance.elevation.radial_clearance"
FAST = {"clearance.elevation.geometry": "closed-form", "integrator.engine": "compiled", "duration": 0.05}
# Until the page has said something more, and no run is on its way; a first one may compile kernels.
SHOWN = """
for (let k = 0; k < 500; k++) {
  const status = window.Bokeh?.documents[0]?.get_model_by_name('status');
  if (status?.tags[0] > a[0] && !status.text.includes('on its way')) return [status.tags[0], status.text];
  await new Promise((done) => setTimeout(done, 100));
}
return [0, 'nothing'];
"""
CURVE = """
const data = Bokeh.documents[0].get_model_by_name(a[0]).data;
return [Array.from(data.x), Array.from(data.y)];
"""


class Shown:
    """A page that explores the antenna."""

    def __init__(self, page, exploration):
        self.page, self.url = page, exploration.url
        self.count = 0

    def open(self, width=1200, height=900):
        self.page.open(self.url, width, height)
        self.count = 0
        return self.wait()

    def wait(self):
        self.count, said = self.page.run(SHOWN, self.count)
        return said

    def curve(self, name):
        return np.array(self.page.run(CURVE, name if name.startswith("before ") else f"now {name}"))

    def slide(self, place, share):
        self.page.run("Bokeh.documents[0].get_model_by_name(a[0]).value = a[1];", place, share)
        return self.wait()

    def type(self, place, text):
        self.page.run("Bokeh.documents[0].get_model_by_name(`${a[0]} typed`).value = a[1];", place, text)
        return self.wait()

    def value(self, place):
        return self.page.run("return Bokeh.documents[0].get_model_by_name(`${a[0]} typed`).value;", place)

    def click(self, name):
        self.page.run(
            "const model = Bokeh.documents[0].get_model_by_name(a[0]);"
            "Bokeh.index.find_one(model).button_el.click();",
            name,
        )
        return self.wait()


@pytest.fixture
def served(tmp_path):
    """A server of its own, for a page that is opened again goes on where it was."""
    with explore(load_scenario("bai2020", case="case3"), duration=0.05, out=tmp_path) as exploration:
        yield exploration


@pytest.fixture
def shown(local_page, served):
    yield Shown(local_page, served)
    local_page.open("about:blank")


def check_same(shown, run):
    """The page's numbers are the run's to the last bit: doubles go through as they are."""
    acceleration = run.data["motion_acceleration"].sel(joint="elevation").values
    assert np.array_equal(shown.curve("acceleration, elevation"), [run.data["time"].values, acceleration])
    force = run.data["normal_force"].sel(contact=["elevation.radial+", "elevation.radial-"]).values
    assert np.array_equal(shown.curve("radial")[1], force.sum(axis=1))
    offset = journal_motion(run, "elevation")["offset"].values
    assert np.array_equal(shown.curve("end +"), 1e3 * offset[:, 0, :2].T)  # in mm


def test_a_slider_changes_the_curves_to_those_of_simulate(shown):
    scenario = load_scenario("bai2020", case="case3", overrides=FAST)
    assert "blows" in shown.open()
    check_same(shown, simulate(scenario))
    before = shown.curve("radial")
    shown.slide(PLAY, 0.4)
    assert shown.value(PLAY) == "0.11 mm"  # 0.01 mm times 400 to the power of 0.4, in three digits
    assert not np.array_equal(shown.curve("radial"), before)
    check_same(shown, simulate(scenario.with_overrides({PLAY: 110e-6})))
    assert np.array_equal(shown.curve("before radial"), before)  # what it is compared with
    assert shown.page.errors == []
    assert all(one.startswith(shown.url.partition("?")[0]) for one in shown.page.requests if "ws:" not in one)


class Written:
    """The same page as a document alone: what a browser would show, and what it would send."""

    def __init__(self, scenario, folder):
        from bokeh.document import Document

        from antenna_pin.apps.live.page import ExplorerPage

        self.document, self.told = Document(), []
        self._page = ExplorerPage(self.document, scenario, None, scenario.duration, folder, self.told.append)

    def __getitem__(self, name):
        return self.document.get_model_by_name(name)

    def curve(self, name):
        return np.array([self[name].data[axis] for axis in "xy"])

    def click(self, name):
        from bokeh.events import ButtonClick

        self[name]._trigger_event(ButtonClick(self[name]))

    def wait(self):
        """Show what the thread of the runs has made, until the last run is done."""
        until = time.monotonic() + 20.0
        while time.monotonic() < until:
            for one in list(self.document.session_callbacks):
                if type(one).__name__ == "NextTickCallback":
                    self.document.remove_next_tick_callback(one)
                    one.callback()
                    if "after the change" in self["status"].text:
                        return
            time.sleep(0.005)
        raise AssertionError("no run came")

    def close(self):
        self._page._runner.close()


@pytest.fixture
def written(tmp_path):
    page = Written(load_scenario("bai2020", case="case3", overrides=FAST | {"duration": 0.02}), tmp_path)
    yield page
    page.close()


def test_a_document_has_the_curves_of_the_runs_of_its_numbers(written, tmp_path):
    """Without a browser: a number is typed, what is shown is kept to compare with, taken back and saved."""
    scenario = load_scenario("bai2020", case="case3", overrides=FAST | {"duration": 0.02})

    def force(run):
        columns = run.data["normal_force"].sel(contact=["elevation.radial+", "elevation.radial-"])
        return np.array([run.data["time"].values, columns.values.sum(axis=1)])

    wide = simulate(scenario.with_overrides({PLAY: 110e-6}))
    first = simulate(scenario)
    written.wait()
    assert np.array_equal(written.curve("now radial"), force(first))
    written[f"{PLAY} typed"].value = "0.11 mm"
    written.wait()
    assert written[PLAY].value == pytest.approx(0.4, abs=1e-3)  # 0.01 mm times 400 to the power of this
    assert np.array_equal(written.curve("now radial"), force(wide))
    assert np.array_equal(written.curve("before radial"), force(first))
    written.click("keep")
    assert np.array_equal(written.curve("before radial"), force(wide))
    written.click("save")
    (saved,) = tmp_path.glob("*.toml")
    assert load_scenario(saved).clearance["elevation"].radial_clearance == 110e-6
    written.click("reset")
    written.wait()
    assert written[f"{PLAY} typed"].value == "0.2 mm"
    assert np.array_equal(written.curve("now radial"), force(first))
    written[f"{PLAY} typed"].value = "2 N"
    assert "must be a length [m], got &#x27;2 N&#x27; (force)" in written["status"].text
    assert written.told[-1].startswith("first run: shown after ")


def test_until_the_first_run_is_there_the_page_has_its_stage(local_page, monkeypatch):
    """At once, in the place of the first figure, and as long as nothing of a run has come.

    Who started it is told of compiling and of the end in a line each.
    """
    from antenna_pin.apps.live import runner
    from antenna_pin.compiled.compile_time import CompileClock

    release, compiling, told = threading.Event(), threading.Event(), []
    monkeypatch.setattr(CompileClock, "is_compiling", property(lambda clock: compiling.is_set()))
    begin = runner.start

    def held(*arguments):
        release.wait(60.0)
        return begin(*arguments)

    monkeypatch.setattr(runner, "start", held)
    with explore("bai2020", duration=0.05, progress=told.append) as exploration:
        with urllib.request.urlopen(exploration.url) as answer:
            assert "Loading the page" in answer.read().decode()  # before any script
        local_page.open(exploration.url, 1200, 900)
        text = "return Bokeh.documents[0]?.get_model_by_name('first').children[0].text;"
        for stage in ("loading", f"{runner.COMPILING} ("):
            assert local_page.settles(True, f"return (() => {{ {text} }})()?.includes('First run: {stage}');")
            compiling.set()
        compiling.clear()
        assert not local_page.run("return document.querySelector('.plots p').offsetHeight;")
        release.set()
        shown = Shown(local_page, exploration)
        assert "blows" in shown.wait()
        assert local_page.run(text) is None  # a figure
        *some, last = told
        assert some == ["building the mechanism", f"first run: {runner.COMPILING}"]
        assert last.startswith("first run: shown after ")
        local_page.open("about:blank")


def test_what_is_done_before_the_page_is_served_is_told(monkeypatch, capsys):
    """On the error stream, kernels that are compiled once; or to nobody."""
    from antenna_pin.apps.live import runner, server
    from antenna_pin.compiled.compile_time import tell_of_compiling

    class Compiled(server.Explored):
        def scenario(self):
            tell_of_compiling()
            tell_of_compiling()

    monkeypatch.setattr(server, "Explored", Compiled)
    explore("bai2020").stop()
    assert capsys.readouterr().err.splitlines() == [
        "explore: building the mechanism",
        f"explore: {runner.COMPILING}",
    ]
    explore("bai2020", progress=None).stop()
    assert capsys.readouterr() == ("", "")


def test_a_tab_that_is_closed_while_its_run_goes_on_is_no_warning(local_page, caplog):
    with explore(load_scenario("bai2020", case="case3"), duration=5.0) as exploration:
        Shown(local_page, exploration).page.open(exploration.url, 800, 600)
        assert local_page.settles(True, "return Boolean(window.Bokeh?.documents[0]);")
        local_page.open("about:blank")
        time.sleep(2.0)
    assert caplog.records == []


def test_a_key_moves_a_slider(shown):
    shown.open()
    before = shown.value(PLAY)
    shown.page.run(
        "const found = Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name(a[0]));"
        "found.shadow_el.querySelector('.noUi-handle').focus();",
        PLAY,
    )
    shown.page.press("ArrowRight")
    shown.wait()
    assert shown.value(PLAY) != before


@pytest.mark.slow
def test_a_refused_value_is_told_and_the_curves_stay(shown):
    shown.open()
    before = shown.curve("radial")
    said = shown.type("clearance.elevation.normal.restitution", "1.3")
    assert "normal.restitution must be in [0, 1], got 1.3" in said and "role='alert'" in said
    assert np.array_equal(shown.curve("radial"), before)
    assert "must be a length [m], got &#x27;2 N&#x27; (force)" in shown.type(PLAY, "2 N")
    assert "refused" not in shown.type("clearance.elevation.normal.restitution", "0.5")


def test_save_writes_a_file_that_makes_the_curves_and_reset_undoes(shown, tmp_path):
    shown.open()
    before = shown.curve("radial")
    shown.type(PLAY, "0.15 mm")
    for k in range(2):
        name = f"bai2020-case3-explored{'-1' * k}.toml"
        assert f"antenna-pin run {tmp_path / name}" in shown.click("save")
        check_same(shown, simulate(load_scenario(tmp_path / name)))
    shown.click("reset")
    assert shown.value(PLAY) == "0.2 mm"
    assert np.array_equal(shown.curve("radial"), before)


@pytest.mark.slow
def test_another_joint_has_other_curves(shown):
    shown.open()
    shown.page.run("Bokeh.documents[0].get_model_by_name('joint').value = 'azimuth';")
    shown.wait()
    run = simulate(load_scenario("bai2020", case="case3", overrides=FAST))
    rate = run.data["motion_rate"].sel(joint="azimuth").values
    assert np.array_equal(shown.curve("rate, azimuth")[1], rate)


@pytest.mark.parametrize(("scheme", "dark"), [("light", False), ("dark", True)])
def test_the_page_follows_the_systems_wish_and_fits_a_phone(shown, scheme, dark):
    shown.page.open("about:blank")
    shown.open(400, 800)
    shown.page.resize(400, 800, mobile=True)
    shown.page.prefer(scheme)
    # Nothing to be moved sideways, once what the page has was laid out anew.
    assert shown.page.settles(True, "return document.documentElement.scrollWidth <= innerWidth;")
    for _ in range(100):  # colours of figures follow when the server has answered
        picture = shown.page.screenshot()
        if (picture.mean() < 90.0) == dark:
            break
    assert (picture.mean() < 90.0) == dark  # most of it is paper
    assert picture.std() > 5.0


def test_only_who_has_the_key_and_names_its_own_host_is_answered(served):
    """A name that another site has led to this machine, or another port, gets nothing."""
    where = urllib.parse.urlsplit(served.url)
    assert where.hostname == "127.0.0.1"

    def status(host, path):
        with contextlib.closing(http.client.HTTPConnection(where.hostname, where.port)) as line:
            line.request("GET", path, headers={"Host": host})
            return line.getresponse().status

    own, port = "/static/js/bokeh.min.js", where.port
    for host in (where.netloc, f"localhost:{port}", f"LOCALHOST:{port}"):
        assert status(host, own) == 200 and status(host, where.path) == 403
    for host in ("evil.example", f"evil.example:{port}", "localhost:1", "127.0.0.1", "", f"@{where.netloc}"):
        assert {status(host, path) for path in (own, f"/?{where.query}", "/ws")} <= {400, 403}, host


def test_the_command_serves_until_ctrl_c_and_has_the_key_on_no_command_line(tmp_path, but_for_work):
    """What is passed to the browser is a file of the user's own, which leads to the page and goes with it."""
    here, browser, seen = tmp_path / "here", tmp_path / "browser", tmp_path / "seen"
    here.mkdir()
    browser.write_text(f'#!/bin/sh\necho "$@" > {seen}\n')
    browser.chmod(0o700)
    command = [sys.executable, "-m", "antenna_pin.apps.cli", "explore", "bai2020"]
    settings = os.environ | {"BROWSER": str(browser)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with (
        subprocess.Popen(command, cwd=here, env=settings, **pipes) as served,
        contextlib.ExitStack() as ending,
    ):
        ending.callback(served.kill)
        said = "".join(itertools.islice(served.stdout, 2))
        while not seen.exists() or not seen.read_text():
            assert served.poll() is None
        address = seen.read_text().strip()
        page = Path(urllib.parse.urlsplit(address).path)
        assert address.startswith("file://")
        assert stat.S_IMODE(page.stat().st_mode) == 0o600
        assert stat.S_IMODE(page.parent.stat().st_mode) == 0o700
        url = re.search(r"serving (\S+)", said)[1]
        assert html.escape(url) in page.read_text()
        with urllib.request.urlopen(url) as answer:
            assert "Dual-axis satellite antenna" in answer.read().decode()
        served.send_signal(signal.SIGINT)
        out, err = served.communicate(timeout=120)
    assert (served.returncode, out) == (0, "ended\n") and not page.parent.exists()
    loading, building, *run = but_for_work(err).splitlines()
    assert (loading, building) == ("antenna-pin: note: loading", "antenna-pin: note: building the mechanism")
    assert all("note: first run: " in line for line in run)  # where the page's came so far
    assert list(here.iterdir()) == []


def test_a_taken_port_is_refused_in_one_line(served):
    port = int(re.search(r":(\d+)/", served.url)[1])
    with pytest.raises(OutputError, match=f"explore: port {port} must be free"):
        explore(load_scenario("bai2020", case="case3"), port=port)
