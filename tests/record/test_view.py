"""``antenna-pin view``: the page is made and opened in the browser of the user's, or its path is said."""

import os
import subprocess
import sys

import pytest


@pytest.fixture(scope="module")
def result(tmp_path_factory, clearance_run):
    return clearance_run.save(tmp_path_factory.mktemp("run") / "play.nc")


def view(result, *arguments, **variables):
    """Run the command in a process of its own, with no screen but what the variables name."""
    screens = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
    own = {name: value for name, value in os.environ.items() if name not in screens} | variables
    command = [sys.executable, "-m", "antenna_pin.apps.cli", "view", str(result), *map(str, arguments)]
    return subprocess.run(command, env=own, capture_output=True, text=True, check=False)


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="screens are named by variables elsewhere")
def test_the_page_is_opened(result, tmp_path, page):
    """By a browser of the user's, which here notes what it is given; that page then plays."""
    browser, noted = tmp_path / "browser", tmp_path / "noted"
    browser.write_text(f'#!/bin/sh\necho "$1" > "{noted}"\n')
    browser.chmod(0o755)
    done = view(result, "--curve", "motion_rate[elevation]", BROWSER=str(browser))
    made = result.with_name("play.view.html")
    assert (done.returncode, done.stdout) == (0, f"saved {made}\n"), done.stderr
    assert noted.read_text() == f"{made.as_uri()}\n"
    page.open(made)
    page.run("await window.recording.ready;")
    assert page.run("return recording.curve.shown.name;") == "motion_rate[elevation]"
    assert page.run("return recording.end;") == pytest.approx(0.05)
    assert page.errors == [] and page.requests == []


@pytest.mark.slow
def test_the_path_is_said(result, tmp_path, but_for_work):
    out = tmp_path / "joint.html"
    done = view(result, "--no-browser", "--view", "joint", "--out", out)
    assert (done.returncode, done.stdout, but_for_work(done.stderr)) == (0, f"saved {out}\n", "")
    assert 'id="recording"' in out.read_text(encoding="utf-8")


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="there is always a screen")
def test_without_a_screen_it_says_so_before_any_work(result, tmp_path):
    done = view(tmp_path / "missing.nc")
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr == (
        "antenna-pin: view: a browser needs a screen, and none of DISPLAY, WAYLAND_DISPLAY, BROWSER is set; "
        "--no-browser makes the page and prints its path\n"
    )


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="screens are named by variables elsewhere")
def test_a_browser_that_does_not_start_leaves_the_page(result, tmp_path, but_for_work):
    browser = tmp_path / "browser"
    browser.write_text("#!/bin/sh\nexit 1\n")
    browser.chmod(0o755)
    out = tmp_path / "page.html"
    done = view(result, "--out", out, BROWSER=str(browser))
    assert done.returncode == 2 and out.exists()
    said = f"antenna-pin: view: a browser must start, got none; open {out} in one\n"
    assert but_for_work(done.stderr) == said


@pytest.mark.slow
def test_where_nothing_can_be_written_beside_the_page_is_in_a_temporary_folder(result, tmp_path):
    """A name of 255 characters has no longer one beside it; nor could root write that."""
    kept = tmp_path / f"{'x' * 252}.nc"
    kept.write_bytes(result.read_bytes())
    done = view(kept, "--no-browser", TMPDIR=str(tmp_path))
    assert done.returncode == 0, done.stderr
    (made,) = tmp_path.glob("antenna-pin-*/run.view.html")
    assert done.stdout == f"saved {made}\n"
