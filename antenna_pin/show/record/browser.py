"""Real browser without a screen: Chromium, offline with WebGL in software, and pictures of recordings."""

from __future__ import annotations

import base64
import contextlib
import importlib.util
import os
import re
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from antenna_pin.errors import InvalidParameterError, MissingToolError

if TYPE_CHECKING:
    from selenium.webdriver import ChromeOptions
    from selenium.webdriver.remote.webdriver import WebDriver

    from antenna_pin.show.record.recording import Recording


# --- browser ------------------------------------------------------------------------------------------------
#
# Selenium drives it. Both programs are taken from where they are installed; nothing is ever downloaded.

#: Environment variables that name the programs where they are not found on the path.
BROWSER_VARIABLE = "ANTENNA_PIN_BROWSER"
DRIVER_VARIABLE = "ANTENNA_PIN_CHROMEDRIVER"

_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_DRIVERS = ("chromedriver",)
_INSTALL = "install both (Debian, Ubuntu: apt-get install chromium chromium-driver)"

_PORT = re.compile(r"success\w* on port (\d+)")
_LONGEST_FOLDER = 36  # characters; what we and the browser append takes 70 more
_START = 60.0  # [s] that a driver may take to start

#: Nothing that a browser does on its own: it opens one page of ours, offline, and draws it without a
#: graphics card, so that pictures are the same on every machine.
_FLAGS = (
    "--headless",
    "--app=data:,",  # an empty page, in place of the browser's own
    "--no-first-run",
    "--no-default-browser-check",
    "--disable-background-networking",
    "--disable-client-side-phishing-detection",
    "--disable-component-update",
    "--disable-default-apps",
    "--disable-domain-reliability",
    "--disable-extensions",
    "--disable-quic",
    "--disable-search-engine-choice-screen",
    "--disable-sync",
    "--disable-features=MediaRouter,OptimizationHints,Translate",
    "--disable-dev-shm-usage",  # /dev/shm is small in containers
    "--force-color-profile=srgb",
    "--force-device-scale-factor=1",
    "--hide-scrollbars",
    "--mute-audio",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)


@dataclass(frozen=True, slots=True)
class BrowserPrograms:
    """Paths of Chromium or Chrome and of its ChromeDriver, of one version."""

    browser: str
    driver: str


def find_browser() -> BrowserPrograms:
    """Return the browser and its driver on this machine.

    Raises:
        MissingToolError: One of them, or Selenium, is not installed.
    """
    if importlib.util.find_spec("selenium") is None:
        raise MissingToolError(
            "pictures of a recording need the Python package selenium, which is not installed; "
            'pip install "antenna-pin[video]"'
        )
    return BrowserPrograms(
        browser=_program("a browser", _BROWSERS, BROWSER_VARIABLE),
        driver=_program("the browser's driver", _DRIVERS, DRIVER_VARIABLE),
    )


def _program(what: str, names: tuple[str, ...], variable: str) -> str:
    named = os.environ.get(variable)
    if named:
        found = shutil.which(named)
        if found is None:
            raise MissingToolError(f"{variable}: must name a program, got {named!r}")
        return found
    for name in names:
        found = shutil.which(name)
        if found is not None:
            return found
    raise MissingToolError(
        f"pictures of a recording need {what}, found no {' or '.join(names)}; {_INSTALL} or name it in "
        f"{variable}"
    )


@contextlib.contextmanager
def _answering() -> Iterator[None]:
    """Convert failures of browser and driver into one line."""
    from selenium.common.exceptions import WebDriverException

    try:
        yield
    except WebDriverException as error:
        raise MissingToolError(f"the browser must execute its commands, got: {_reason(error)}") from error
    except Exception as error:  # of the layers below, when the browser or its driver has gone
        raise MissingToolError(
            f"the browser must stay until its work is done, got: {_reason(error)}"
        ) from error


def _reason(error: Exception) -> str:
    return " ".join(str(getattr(error, "msg", None) or repr(error)).split())[:300]


class Browser:
    """Browser with one page, as :func:`open_browser` yields it."""

    def __init__(self, driver: WebDriver) -> None:
        """Take over Selenium's driver."""
        self._driver = driver

    def open(self, url: str) -> None:
        """Load a page; return after its ``load`` event."""
        with _answering():
            self._driver.get(url)

    def run(self, code: str, *arguments: Any) -> Any:
        """Return the value of JavaScript: the body of a function, which may ``await``.

        Arguments, numbers, text, and lists or dicts of them, are ``a[0]``, ``a[1]``, ...
        """
        with _answering():
            body = f"const a = arguments; return (async () => {{ {code} }})();"
            return self._driver.execute_script(body, *arguments)

    def command(self, name: str, **parameters: Any) -> Any:
        """Send a command of the Chrome DevTools protocol and return its result."""
        with _answering():
            return self._driver.execute("executeCdpCommand", {"cmd": name, "params": parameters})["value"]

    def resize(self, width: int, height: int, *, scale: float = 1.0, mobile: bool = False) -> None:
        """Set the page's view [px], and the picture's pixels per unit of the page.

        A ``mobile`` page is laid out as on a phone.
        """
        self.command(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=scale,
            mobile=mobile,
        )

    def picture(self) -> bytes:
        """Return a screenshot of the page, as a PNG file."""
        shot = self.command("Page.captureScreenshot", format="png", optimizeForSpeed=True)
        return base64.b64decode(shot["data"])

    def log(self, kind: str) -> list[dict[str, Any]]:
        """Return the log entries since the last call; needs ``logs=True``.

        The kind is "browser" for the console, "performance" for the network.
        """
        found: list[dict[str, Any]] = self._driver.execute("getLog", {"type": kind})["value"]
        return found


@contextlib.contextmanager
def open_browser(
    programs: BrowserPrograms | None = None, *, logs: bool = False, timeout: float = 60.0, here: bool = False
) -> Iterator[Browser]:
    """Start a browser without a screen, with settings of its own, and end it afterwards.

    Args:
        programs: Browser and driver; found if not given.
        logs: Whether the console's messages and the network's requests are logged.
        timeout: For a page to load and for a script to return [s].
        here: Whether pages may reach servers on this machine; none reaches another.

    Yields:
        The browser, with an empty page.

    Raises:
        MissingToolError: It is not installed or does not start.
    """
    programs = find_browser() if programs is None else programs
    from selenium.webdriver import Remote
    from selenium.webdriver.chrome.remote_connection import ChromeRemoteConnection
    from selenium.webdriver.common.proxy import Proxy, ProxyType
    from selenium.webdriver.remote.client_config import ClientConfig

    # The browser may write to its folder until the last of its processes has gone.
    folder = tempfile.TemporaryDirectory(
        prefix="antenna-pin-", dir=_temporary_folder(), ignore_cleanup_errors=True
    )
    with folder as own, _running_driver(programs.driver, own) as address, contextlib.ExitStack() as ending:
        # The driver listens on this machine, so no proxy of the environment leads there.
        direct = Proxy({"proxyType": ProxyType.DIRECT})
        config = ClientConfig(address, proxy=direct, timeout=int(2 * timeout))
        connection = ChromeRemoteConnection(address, client_config=config)
        try:
            driver = Remote(command_executor=connection, options=_options(programs.browser, own, logs, here))
        except Exception as error:
            raise MissingToolError(
                f"{programs.browser} must start with {programs.driver}, got: {_reason(error)}; {_INSTALL}, "
                "of one version"
            ) from error
        ending.callback(_quit, driver)
        driver.set_page_load_timeout(timeout)
        driver.set_script_timeout(timeout)
        yield Browser(driver)


def _temporary_folder() -> str:
    """Return a folder for temporary files with names short enough for sockets."""
    usual = tempfile.gettempdir()
    return usual if len(usual) <= _LONGEST_FOLDER else "/tmp"


@contextlib.contextmanager
def _running_driver(program: str, folder: str) -> Iterator[str]:
    """Start the browser's driver and yield its address; end all its processes afterwards.

    They are a group of processes of their own: Ctrl-C reaches only this process, which then ends them in good
    order. A shell leads the group and ends it when its input closes, so also when this process is killed.
    """
    group = subprocess.Popen(
        ["/bin/sh", "-c", '"$0" --port=0 <&- & exec >&-; read -r _; kill -s KILL 0', program],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=os.environ | {"TMPDIR": folder},
        text=True,
        start_new_session=True,
    )
    assert group.stdin is not None and group.stdout is not None
    # Nor may a driver that hangs at its start make us hang.
    late = threading.Timer(_START, group.stdin.close)
    late.start()
    try:
        with group.stdout as told:
            said = ""
            for line in told:
                said += line
                port = _PORT.search(line)
                if port is not None:
                    late.cancel()
                    yield f"http://localhost:{port.group(1)}"
                    return
        raise MissingToolError(
            f"{program} must start and print its port, got: {' '.join(said.split())[:300]!r}; {_INSTALL}"
        )
    finally:
        late.cancel()
        group.stdin.close()
        group.wait()


def _options(browser: str, folder: str, logs: bool, here: bool) -> ChromeOptions:
    from selenium.webdriver import ChromeOptions

    options = ChromeOptions()
    options.binary_location = browser
    for flag in _FLAGS:
        options.add_argument(flag)
    options.add_argument(f"--user-data-dir={folder}/profile")
    options.add_argument(f"--host-resolver-rules=MAP * ~NOTFOUND{', EXCLUDE 127.0.0.1' * here}")
    if hasattr(os, "geteuid") and os.geteuid() == 0:  # Chromium's sandbox refuses root
        options.add_argument("--no-sandbox")
    if logs:
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return options


def _quit(driver: WebDriver) -> None:
    with contextlib.suppress(Exception):  # it may be gone already, and fails then in many ways
        driver.quit()


# --- pictures at exact times --------------------------------------------------------------------------------

_SMALLEST, _LARGEST = 64, 4096  # [px]

# Texts have a fixed size on the page, made for such a view; larger pictures are the same page, enlarged.
_VIEW = (1280, 720)  # [px]
_SCALES = (4.0, 3.0, 2.0, 1.5, 1.0)

# Until the page's own script has run, the name is that of the element that the player will be in.
_OPEN = """
const begun = () => Boolean(window.recording && (window.recording.ready || window.recording.failed));
for (let k = 0; k < 600 && !begun(); k++) await new Promise((done) => setTimeout(done, 50));
if (!begun()) return "a page whose script has not run within 30 s";
const player = window.recording;
if (player.failed) return player.stage.textContent;
const none = "{ display: none !important; }";
if (a[0]) document.head.insertAdjacentHTML("beforeend", `<style>${a[0]} ${none}</style>`);
else player.film();
await player.ready;
// The stage grows into the place of the controls with the next layout.
await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
player.pause();
return "";
"""
_OF_STILLS = ".ap-bar, .ap-rate"  # what a still picture goes without
_SEEK = """
const player = window.recording;
player.seek(a[0]);
if (!player.whole) player.resetCamera();  // of a single picture; the camera of a film stays
player.render();
"""
_ADVANCE = "window.recording.advance(a[0], a[1]); window.recording.render();"


def check_size(size: tuple[int, int]) -> tuple[int, int]:
    """Return a size of pictures that can be made, else raise InvalidParameterError."""
    if not all(_SMALLEST <= pixels <= _LARGEST for pixels in size):
        raise InvalidParameterError("pictures", "size", f"{_SMALLEST} to {_LARGEST} pixels each way", size)
    return size


def _scale(width: int, height: int) -> float:
    """Return the largest scale that divides the size and leaves the usual view."""
    for scale in _SCALES:
        view = (width / scale, height / scale)
        if all(v.is_integer() and v >= usual for v, usual in zip(view, _VIEW, strict=True)):
            return scale
    return 1.0


class Camera:
    """Camera of a recording that is ready in a browser."""

    def __init__(self, browser: Browser) -> None:
        """Take over a browser with the page."""
        self._browser = browser

    def seek(self, time: float) -> bytes:
        """Return the picture at a time [s], a PNG file of that time alone."""
        self._browser.run(_SEEK, time)
        return self._browser.picture()

    def advance(self, time: float, wall: float) -> bytes:
        """Return the picture at a later time [s], with the impacts since the last picture.

        Arrows of force fade with ``wall``, the display time since that picture [s].
        """
        self._browser.run(_ADVANCE, time, wall)
        return self._browser.picture()


@contextlib.contextmanager
def open_camera(
    recording: Recording,
    size: tuple[int, int],
    *,
    still: bool = False,
    programs: BrowserPrograms | None = None,
) -> Iterator[Camera]:
    """Open a recording in a browser with the line of time only.

    A ``still`` picture has neither line of time nor speed.

    Raises:
        InvalidParameterError: The size is too small or too large.
        MissingToolError: The browser is not installed, or cannot show recordings.
    """
    width, height = check_size(size)
    scale = _scale(width, height)
    with (
        tempfile.TemporaryDirectory(prefix="antenna-pin-recording-") as folder,
        open_browser(programs) as browser,
    ):
        page = recording.save(Path(folder) / "recording.html")
        browser.resize(int(width / scale), int(height / scale), scale=scale)
        browser.open(page.as_uri())
        complaint = browser.run(_OPEN, _OF_STILLS if still else "")
        if complaint:
            raise MissingToolError(
                f"the browser must show 3D pictures without a graphics card, got: {complaint}"
            )
        yield Camera(browser)
