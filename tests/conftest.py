"""What all tests share: repeatable examples, the command line, and a real browser."""

from __future__ import annotations

import base64
import contextlib
import dataclasses
import gc
import io
import json
import math
import os
import re
import signal
import sys
import time
import zlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

from antenna_pin import System, Urdf, build_mechanism, simulate
from antenna_pin.apps.cli import _progress, app
from antenna_pin.base.interruption import acknowledge, late_signal
from antenna_pin.contact import Hertz
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import PrismaticClearance

# Before any module of tests has Numba compile something: that decides of the processor for the process.
with contextlib.suppress(ModuleNotFoundError):
    import antenna_pin.compiled.jit  # noqa: F401

# The same examples in every run, and no deadline, because a first example may compile kernels.
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")
# As the first kernel sets it: Hypothesis complains of a limit that changes while it draws.
sys.setrecursionlimit(max(sys.getrecursionlimit(), 10_000))

# A shell has what it starts in the background ignore Ctrl-C, which many tests send to this process.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


# Power does not fail in a test; to have each file on the disk takes milliseconds.
os.fsync = lambda descriptor: None

# On a busy machine what takes a second takes ten, and a command says so; that has tests of its own.
_progress._FIRST = 1e6  # [s]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Keep the slow tests of one shard, and put long tests first: the worker that ends early would wait."""
    if shard := config.getoption("--shard"):
        number, count = map(int, shard.split("/"))
        seconds = recorded_seconds()
        kept, left_out = [], []
        for item in items:
            slow = item.get_closest_marker("slow")
            here = not slow or shard_of(item.nodeid, count, seconds) == number
            (kept if here else left_out).append(item)
        config.hook.pytest_deselected(items=left_out)
        items[:] = kept
        items.sort(key=lambda item: -seconds.get(item.nodeid, 0.0))
        return
    here = Path(__file__).parent
    items.sort(key=lambda item: item.path.parent not in (here, here / "cli"))


# --- shards of the slow tests ---

#: Seconds of each slow test that takes at least LONG; ``scripts/test -m slow --record`` renews them.
SLOW_SECONDS = Path(__file__).with_name("slow_seconds.json")
LONG = 10.0  # [s]
_BEGUN = time.monotonic()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options on slow tests."""
    parser.addoption("--shard", metavar="K/N", help="of the slow tests only those of shard K of N")
    parser.addoption(
        "--minutes", type=float, default=math.inf, help="time after which no further slow test begins [min]"
    )
    parser.addoption("--record", action="store_true", help=f"write durations to {SLOW_SECONDS.name}")


def pytest_configure(config: pytest.Config) -> None:
    """Refuse a shard that does not exist."""
    shard = config.getoption("--shard")
    found = re.fullmatch(r"([1-9]\d*)/([1-9]\d*)", shard) if shard else None
    if shard and not (found and int(found[1]) <= int(found[2])):
        raise pytest.UsageError(f"--shard must be K/N with K from 1 to N, such as 2/6, got {shard!r}")


def pytest_collectstart() -> None:
    """Look for no garbage while tests are imported."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Leave aside what was imported: it stays, and to look through it takes half a second each time."""
    gc.freeze()
    gc.enable()


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a slow test that would begin after the time that is allowed."""
    minutes = item.config.getoption("--minutes")
    if item.get_closest_marker("slow") and time.monotonic() - _BEGUN > 60.0 * minutes:
        pytest.skip(f"did not begin within {minutes:g} min; run: scripts/test -m slow '{item.nodeid}'")


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Write the durations of long tests that passed, if this is wanted."""
    if terminalreporter.config.getoption("--record"):
        passed = {one.nodeid: round(one.duration) for one in terminalreporter.getreports("passed")}
        seconds = {name: time for name, time in recorded_seconds().items() if name not in passed}
        seconds |= {name: time for name, time in passed.items() if time >= LONG}
        SLOW_SECONDS.write_text(json.dumps(seconds, indent=0, sort_keys=True) + "\n", encoding="utf-8")


def recorded_seconds() -> dict[str, float]:
    """Return the duration of each long test [s]."""
    return dict(json.loads(SLOW_SECONDS.read_text(encoding="utf-8")))


def shard_of(name: str, count: int, seconds: Mapping[str, float]) -> int:
    """Return the shard of a slow test, from 1 to count.

    Long tests are dealt by their durations, the longest first, each to the shard with the least to do; all
    others by a hash of their names.
    """
    loads = [0.0] * count
    for other in sorted(seconds, key=lambda other: (-seconds[other], other)):
        least = loads.index(min(loads))
        if other == name:
            return least + 1
        loads[least] += seconds[other]
    return zlib.crc32(name.encode()) % count + 1


# --- the command line ---


@dataclasses.dataclass(frozen=True)
class Said:
    """What a command said and how it ended."""

    code: int
    out: str
    err: str


@pytest.fixture(autouse=True)
def no_late_signal() -> Iterator[None]:
    """Cancel a signal that a command run in this process would send to itself again, in another test."""
    yield
    if late_signal() is not None:
        acknowledge()
    assert signal.getsignal(signal.SIGINT) != signal.SIG_DFL, "Ctrl-C would end these tests, with no word"


@pytest.fixture
def cli(capsys, tmp_path, monkeypatch):
    """Run a command in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")  # tables are not folded

    def run(*arguments):
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            app([str(argument) for argument in arguments])
        return Said(ended.value.code or 0, *capsys.readouterr())

    return run


@pytest.fixture(scope="session")
def but_for_work() -> Callable[[str], str]:
    """Return a function: what a command of its own process said, but for how long it has been at work."""
    return lambda said: re.sub(r"^.*note: \w+ is at work, for .*\n", "", said, flags=re.MULTILINE)


# --- a real browser, offline ---

#: "required": a missing browser is an error (scripts/test sets it); "skip": tests that need one are left out;
#: otherwise they are skipped where there is none.
BROWSER_TESTS = "ANTENNA_PIN_TEST_BROWSER"


class Page:
    """One page in the browser: its pixels, its console, and what it asked of the network.

    Times are given to the page by its own scripts; sizes are in pixels of the page.
    """

    def __init__(self, browser: Any) -> None:
        self.browser = browser
        self._console: list[dict[str, Any]] = []
        self._requests: list[str] = []

    def open(self, path: Path | str, width: int = 800, height: int = 600) -> Page:
        """Open a file as a user does who is offline, or an address, in a view of the given size."""
        self.browser.open("about:blank")  # ends what the page before still does
        self._collect()
        self._console.clear()
        self._requests.clear()
        self.resize(width, height)
        self.prefer("light")
        self.browser.open(path if isinstance(path, str) else path.resolve().as_uri())
        # On a busy machine the driver was seen to return while a large page was still being read.
        self.run(
            "if (document.readyState !== 'complete')"
            " await new Promise((done) => addEventListener('load', done, { once: true }));"
        )
        return self

    def resize(self, width: int, height: int, mobile: bool = False) -> None:
        """Give the page another view, such as a phone's."""
        self.browser.resize(width, height, mobile=mobile)

    def run(self, code: str, *arguments: Any) -> Any:
        """Return what JavaScript returns: a function's body, which may ``await``; ``a`` are its arguments."""
        return self.browser.run(code, *arguments)

    def settles(self, wanted: Any, code: str, *arguments: Any) -> Any:
        """Return what JavaScript returns, looked at again for 10 s at most until it is what is wanted.

        What a page does after an event comes frames later, however many a busy machine leaves it.
        """
        until = time.monotonic() + 10.0
        while (seen := self.run(code, *arguments)) != wanted and time.monotonic() < until:
            time.sleep(0.02)
        return seen

    def press(self, key: str, *, shift: bool = False) -> None:
        """Press a key as a person does: it goes to what has the focus."""
        codes = {
            "Tab": 9,
            "Enter": 13,
            "Escape": 27,
            "End": 35,
            "Home": 36,
            "ArrowLeft": 37,
            "ArrowRight": 39,
        }
        text = {"text": key} if len(key) == 1 else {}
        about = {"key": key, "windowsVirtualKeyCode": codes.get(key, ord(key[0].upper())), **text}
        for kind in ("keyDown", "keyUp"):
            self.browser.command("Input.dispatchKeyEvent", type=kind, modifiers=8 * shift, **about)

    def point(self, x: float, y: float, *kinds: str) -> None:
        """Move the mouse to a place of the view [px], or press ("mousePressed") and let go there."""
        for kind in kinds or ("mouseMoved",):
            held = {} if kind == "mouseMoved" else {"button": "left", "clickCount": 1}
            self.browser.command("Input.dispatchMouseEvent", type=kind, x=x, y=y, **held)

    def prefer(self, scheme: str) -> None:
        """Have the page shown "light" or "dark"."""
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        self.browser.command("Emulation.setEmulatedMedia", features=features)

    def pixels(self, selector: str = "canvas") -> np.ndarray:
        """Return what a canvas shows, (height, width, 3) of 0 to 255.

        A WebGL canvas must keep its drawing buffer (``preserveDrawingBuffer``), else it is blank.
        """
        address = self.run("return document.querySelector(a[0]).toDataURL('image/png');", selector)
        return _picture(base64.b64decode(address.partition(",")[2]))

    def screenshot(self) -> np.ndarray:
        """Return what a user sees of the page, (height, width, 3) of 0 to 255."""
        return _picture(self.browser.picture())

    @property
    def errors(self) -> list[str]:
        """What the console has complained of since the page was opened: errors and warnings."""
        self._collect()
        return [entry["message"] for entry in self._console if entry["level"] in ("SEVERE", "WARNING")]

    @property
    def requests(self) -> list[str]:
        """Addresses the page has asked for besides its own file and what it holds within itself."""
        self._collect()
        return [url for url in self._requests[1:] if not url.startswith(("data:", "blob:"))]

    def _collect(self) -> None:
        self._console += self.browser.log("browser")
        for entry in self.browser.log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                self._requests.append(message["params"]["request"]["url"])


def _picture(png: bytes) -> np.ndarray:
    from PIL import Image

    with Image.open(io.BytesIO(png)) as image:
        return np.asarray(image.convert("RGB"))


def _programs() -> Any:
    """Return what pages are opened with; where there is none, leave the test out, or fail as is wished."""
    from antenna_pin.errors import MissingToolError
    from antenna_pin.show.record.browser import find_browser

    if os.environ.get(BROWSER_TESTS) == "skip":
        pytest.skip(f"{BROWSER_TESTS}=skip")
    try:
        return find_browser()
    except MissingToolError as error:
        if os.environ.get(BROWSER_TESTS) == "required":
            pytest.fail(f"{error} ({BROWSER_TESTS}=required)", pytrace=False)
        pytest.skip(str(error))


@pytest.fixture(scope="session")
def _browser() -> Iterator[Any]:
    """One browser for each worker, with a profile of its own."""
    from antenna_pin.show.record.browser import open_browser

    with open_browser(_programs(), logs=True) as browser:
        yield browser


@pytest.fixture(scope="session")
def _local_browser() -> Iterator[Any]:
    """One that reaches servers on this machine."""
    from antenna_pin.show.record.browser import open_browser

    with open_browser(_programs(), logs=True, here=True) as browser:
        yield browser


@pytest.fixture
def page(_browser: Any) -> Page:
    """A page of a real browser without network: ``page.open(path)``, then its pixels, errors and requests."""
    return Page(_browser)


@pytest.fixture
def local_page(_local_browser: Any) -> Page:
    """The same of a browser that reaches servers on this machine, and no others."""
    return Page(_local_browser)


SLIDER_URDF = """
<robot name="slider">
  <link name="guide"><visual><geometry><box size="0.3 0.06 0.06"/></geometry></visual></link>
  <link name="sled"><inertial><origin xyz="0.003 0.002 0.01"/><mass value="2"/>
    <inertia ixx="0.01" iyy="0.012" izz="0.008" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.08 0.03 0.02"/></geometry></visual></link>
  <joint name="slide" type="{kind}"><parent link="guide"/><child link="sled"/>
    <origin xyz="0.02 0 0.05" rpy="0 0 0.3"/><axis xyz="1 0 0"/>{limit}</joint>
</robot>
"""


@pytest.fixture(scope="session")
def guide():
    """Dimensions of a slider in its guide."""
    return dict(
        guide_width=30.3e-3,
        guide_height=20.4e-3,
        slider_width=30e-3,
        slider_height=20e-3,
        slider_length=80e-3,
        corner_radius=0.5e-3,
        roll=0.2,
    )


@pytest.fixture(scope="session")
def slider_run(guide):
    """A slider thrown through its guide, turned by 0.2 rad; it knocks against all walls."""
    urdf = Urdf.from_text(SLIDER_URDF.format(kind="floating", limit=""), "slider.urdf")
    shape = PrismaticClearance(**guide)
    joint = ClearanceJoint(name="slide", geometry=shape, radial=Hertz(stiffness=1e8), backend="closed-form")
    system = System(build_mechanism(urdf, base="fixed"), clearances=[joint])
    return simulate(system, duration=0.1, v=np.array([0.3, 0.02, 0.03, 0.2, 0.1, 0.15]))


@pytest.fixture(scope="session")
def ideal_slider_run():
    """The same without play."""
    limit = '<limit lower="-9" upper="9" effort="9" velocity="9"/>'
    urdf = Urdf.from_text(SLIDER_URDF.format(kind="prismatic", limit=limit), "slider.urdf")
    return simulate(System(build_mechanism(urdf, base="fixed")), duration=0.1, v=np.array([0.3]))
