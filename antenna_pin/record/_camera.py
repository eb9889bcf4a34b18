"""A recording in a real browser, and pictures of it at exact times."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from antenna_pin.errors import InvalidParameterError, MissingToolError
from antenna_pin.record._browser import Browser, BrowserPrograms, open_browser

if TYPE_CHECKING:
    from antenna_pin.record.recording import Recording

__all__ = ["Camera", "check_size", "open_camera"]

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
    """Return a size of pictures that can be made, else raise.

    Raises:
        InvalidParameterError: It is too small or too large.
    """
    if not all(_SMALLEST <= pixels <= _LARGEST for pixels in size):
        raise InvalidParameterError("pictures", "size", f"{_SMALLEST} to {_LARGEST} pixels each way", size)
    return size


def _scale(width: int, height: int) -> float:
    """Return the pixels per unit of the page, the most that leave it the usual view and divide the size."""
    for scale in _SCALES:
        view = (width / scale, height / scale)
        if all(v.is_integer() and v >= usual for v, usual in zip(view, _VIEW, strict=True)):
            return scale
    return 1.0


class Camera:
    """Takes pictures of a recording that a browser shows.

    Args:
        browser: With the page of the recording, ready.
    """

    def __init__(self, browser: Browser) -> None:
        """Take over a browser."""
        self._browser = browser

    def seek(self, time: float) -> bytes:
        """Return the picture at a time [s], a PNG file; it depends on nothing but the time."""
        self._browser.run(_SEEK, time)
        return self._browser.picture()

    def advance(self, time: float, wall: float) -> bytes:
        """Return the picture at a later time, with the impacts since the picture before it.

        Args:
            time: Of the run [s].
            wall: Since the picture before, for who watches [s]; arrows of force fade with it.
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
    """Show a recording in a browser, of its controls the line of time only.

    Args:
        recording: What is filmed.
        size: Of the pictures, width and height [px].
        still: Whether line of time and speed are left out, as of a single picture.
        programs: Browser and driver; found if not given.

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
