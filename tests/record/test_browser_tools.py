"""The browser that tests and videos use: offline, drawing WebGL in software, telling what a page did."""

import contextlib
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from antenna_pin.errors import MissingToolError
from antenna_pin.show.record import browser as browser_tools

PAGE = """<!doctype html><title>probe</title><body style="margin:0">
<canvas width="60" height="40"></canvas><p style="margin:0;height:20px;width:60px;background:#00f"></p>
<script>
const gl = document.querySelector("canvas").getContext("webgl2", {preserveDrawingBuffer: true});
gl.clearColor(1, 0, 0, 1);
gl.clear(gl.COLOR_BUFFER_BIT);
gl.enable(gl.SCISSOR_TEST);
gl.scissor(0, 30, 10, 10);  // WebGL counts rows from below
gl.clearColor(0, 1, 0, 1);
gl.clear(gl.COLOR_BUFFER_BIT);
CODE
</script>"""
RED, GREEN, BLUE = [255, 0, 0], [0, 255, 0], [0, 0, 255]


@pytest.fixture
def probe(page, tmp_path):
    """Open a page with a WebGL canvas: red, its upper left corner green; below it blue."""

    def open_probe(code=""):
        path = tmp_path / "probe page.html"
        path.write_text(PAGE.replace("CODE", code))
        return page.open(path, 60, 70)

    return open_probe


def test_pixels_of_a_canvas_and_of_the_page(probe):
    page = probe()
    canvas = page.pixels()
    assert canvas.shape == (40, 60, 3)
    assert (canvas[:10, :10] == GREEN).all()
    assert (canvas[10:] == RED).all()
    seen = page.screenshot()
    assert seen.shape == (70, 60, 3)
    assert (seen[:10, :10] == GREEN).all() and (seen[20:38] == RED).all() and (seen[48:62] == BLUE).all()
    assert np.array_equal(seen[:40], canvas)
    assert page.errors == [] and page.requests == []


def test_a_page_may_be_asked_and_waited_for(probe):
    page = probe("window.later = new Promise((done) => setTimeout(() => done(7), 50));")
    assert page.run("return (await window.later) * a[0];", 6) == 42
    assert page.run("return document.title;") == "probe"


def test_what_a_page_complains_of_and_asks_for_is_seen(probe):
    """Else tests that find neither would say nothing. The network cannot answer: no name is resolved."""
    page = probe(
        "window.done = fetch('https://example.invalid/x').catch(() => fetch('data:,y'));"
        "console.warn('careful'); setTimeout(() => { throw new Error('broken'); });"
    )
    page.run("await window.done; await new Promise((done) => setTimeout(done, 50));")
    assert page.requests == ["https://example.invalid/x"]
    assert [any(text in line for line in page.errors) for text in ("careful", "broken", "ERR_")] == [True] * 3
    assert probe().errors == []  # the next page starts clean


def test_a_variable_that_names_no_program_is_refused(monkeypatch, tmp_path):
    monkeypatch.setenv(browser_tools.BROWSER_VARIABLE, str(tmp_path / "none"))
    with pytest.raises(MissingToolError, match="ANTENNA_PIN_BROWSER: must name a program"):
        browser_tools.find_browser()


def test_a_browser_that_does_not_start_is_named(page):
    programs = browser_tools.BrowserPrograms("/bin/false", browser_tools.find_browser().driver)
    with pytest.raises(MissingToolError, match="/bin/false must start"), browser_tools.open_browser(programs):
        pass


def test_a_proxy_of_the_environment_does_not_come_between(page, monkeypatch):
    for variable in ("http_proxy", "HTTP_PROXY"):
        monkeypatch.setenv(variable, "http://127.0.0.1:9")
    with browser_tools.open_browser() as browser:
        assert browser.run("return 1 + a[0];", 2) == 3


def test_a_driver_that_does_not_answer_is_given_up(monkeypatch, tmp_path):
    """Whether it ends without a word or hangs."""
    monkeypatch.setattr(browser_tools, "_START", 0.3)
    for number, command in enumerate(("echo no such port", "exec sleep 60")):
        script = tmp_path / f"driver{number}"
        script.write_text(f"#!/bin/sh\n{command}\n")
        script.chmod(0o755)
        programs = browser_tools.BrowserPrograms("/bin/true", str(script))
        with pytest.raises(MissingToolError, match="must start and print its port"):
            with browser_tools.open_browser(programs):
                pass


KILLED = """
import time
from antenna_pin.show.record.browser import open_browser
with open_browser() as browser:
    print(browser._driver.capabilities["chrome"]["userDataDir"], flush=True)
    time.sleep(60)
"""


def test_the_browser_ends_with_us_even_if_we_are_killed(page, monkeypatch, tmp_path):
    """And it starts where the folder for temporary files has a name too long for its sockets."""
    long = tmp_path / ("long" * 20)
    long.mkdir()
    monkeypatch.setenv("TMPDIR", str(long))
    with subprocess.Popen([sys.executable, "-c", KILLED], stdout=subprocess.PIPE, text=True) as ours:
        profile = Path(ours.stdout.readline().strip())
        assert profile in profiles()
        ours.kill()
    try:
        for _ in range(200):
            if profile not in profiles():
                return
            time.sleep(0.05)
        pytest.fail("the browser still runs")
    finally:
        shutil.rmtree(profile.parent, ignore_errors=True)  # what a process that is killed leaves


def profiles():
    """Return the profiles of all browsers that run now."""
    found = set()
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):  # it has just ended
            for word in path.read_bytes().decode(errors="replace").replace("\0", " ").split():
                if word.startswith("--user-data-dir="):
                    found.add(Path(word.partition("=")[2]))
    return found
