"""Pictures and videos of recordings by a real browser (the extra ``video``).

Each picture is taken at its exact time, however long it takes to draw. In a video, an impact that falls
between two pictures is not lost: the later one has its largest force.
"""

from __future__ import annotations

import base64
import importlib.util
import io
import math
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable, replacing
from antenna_pin.base.interruption import interruptible
from antenna_pin.base.tables import write_csv
from antenna_pin.errors import InvalidParameterError, MissingToolError, OutputError
from antenna_pin.show.record.browser import Camera, check_size, find_browser, open_camera
from antenna_pin.show.record.recording import Recording

if TYPE_CHECKING:
    from PIL.Image import Image


# --- files of moving pictures: MP4 by FFmpeg's libraries (PyAV), GIF by Pillow ---

_QUALITY = {"crf": "18", "preset": "medium"}  # 18 is what the eye takes for lossless
_BT709 = 1  # colours and range as all players take those of HD pictures to be
_COLOURS = 256  # of a GIF
_REFINEMENTS = 3  # of the palette
_HOLD = 1000  # [ms] that a GIF shows its last picture before it begins again


def check_writers(suffix: str) -> None:
    """Raise MissingToolError if the package that writes ``.mp4`` or ``.gif`` files is missing."""
    package, name = {".mp4": ("av", "av"), ".gif": ("PIL", "pillow")}[suffix]
    if importlib.util.find_spec(package) is None:
        raise MissingToolError(
            f"a {suffix} file needs the Python package {name}, which is not installed; "
            'pip install "antenna-pin[video]"'
        )


def _image(png: bytes) -> Image:
    from PIL import Image

    with Image.open(io.BytesIO(png)) as image:
        return image.convert("RGB")


def write_mp4(path: Path, pictures: Iterable[bytes], size: tuple[int, int], fps: float) -> None:
    """Write PNG pictures as H.264 video in pixels of every player (yuv420p)."""
    import av

    rate = Fraction(fps).limit_denominator(1001)
    # The index goes to the front, so that a page can play the file while it loads.
    with av.open(path, "w", format="mp4", options={"movflags": "+faststart"}) as container:
        stream = container.add_stream("libx264", rate=rate, options=_QUALITY)
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"
        codec = stream.codec_context
        codec.colorspace = codec.color_range = codec.color_primaries = codec.color_trc = _BT709
        for number, png in enumerate(pictures):
            frame = av.VideoFrame.from_ndarray(np.asarray(_image(png)), format="rgb24").reformat(
                format="yuv420p", dst_colorspace="ITU709", dst_color_range="MPEG"
            )
            frame.pts = number
            frame.time_base = 1 / rate
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))


def palette_of(pictures: Sequence[bytes]) -> Image:
    """Return the colours that fit pictures best; one set for all prevents flicker.

    A colour counts by the square root of its pixels, else the background takes nearly all of the palette.
    """
    from PIL import Image

    stacked = np.concatenate([np.asarray(_image(png)).reshape(-1, 3) for png in pictures]).astype(np.uint32)
    packed = stacked[:, 0] << 16 | stacked[:, 1] << 8 | stacked[:, 2]
    colours, counts = np.unique(packed, return_counts=True)
    times = np.ceil(np.sqrt(counts)).astype(int)
    chosen = np.repeat(
        np.stack([colours >> 16 & 255, colours >> 8 & 255, colours & 255], axis=-1), times, axis=0
    )
    weighted = Image.fromarray(chosen[np.newaxis].astype(np.uint8))
    return weighted.quantize(_COLOURS, method=Image.Quantize.MEDIANCUT, kmeans=_REFINEMENTS)


def write_gif(path: Path, pictures: Iterable[bytes], palette: Image, fps: float) -> None:
    """Write PNG pictures as an animation that repeats for ever.

    All pictures are stored until the last has come, 1 byte for each pixel. Display times are in hundredths of
    a second, rounded without drift.
    """
    from PIL import Image

    shown = [_image(png).quantize(palette=palette, dither=Image.Dither.NONE) for png in pictures]
    times = [int(t) for t in _hundredths(len(shown), fps)]
    times[-1] = max(times[-1], _HOLD)
    first, *others = shown
    first.save(path, format="GIF", save_all=True, append_images=others, duration=times, loop=0)


def _hundredths(count: int, fps: float) -> NDArray[np.int64]:
    """Return the display time of each picture [ms], whole hundredths of a second."""
    ends = np.round(100.0 * np.arange(count + 1) / fps).astype(np.int64)
    return 10 * np.diff(ends)


Progress = Callable[[int, int], None]

_FPS = {".mp4": 30.0, ".gif": 20.0, "": 30.0}
_SIZE = {".mp4": (1280, 720), ".gif": (800, 450), "": (1280, 720)}
_MOST_FPS = {".mp4": 120.0, ".gif": 50.0, "": 1e6}  # faster GIFs are slowed down by browsers
_MOST_GIF_PIXELS = 4e8  # all pictures of a GIF are in memory until it is written
_PALETTE_PICTURES = 9


@dataclass(frozen=True, slots=True)
class Filmed:
    """Result of filming.

    Attributes:
        path: The file, or the folder of frames.
        frames: Number of pictures taken.
        planned: Number of pictures of the whole film.
    """

    path: Path
    frames: int
    planned: int

    @property
    def completed(self) -> bool:
        """Return whether filming was completed."""
        return self.frames == self.planned


@takes()
def check_film(path: str | os.PathLike[str], suffix: str) -> Path:
    """Return the path if a film can be made and written there, else raise.

    Args:
        path: Path of the file, or of the folder of frames.
        suffix: ``.png``, ``.mp4``, ``.gif``, or nothing for a folder of frames.

    Raises:
        MissingToolError: Browser or packages are not installed.
        OutputError: The file or folder cannot be written there, or the folder has something in it.
    """
    target = Path(path)
    if suffix:
        check_writable(target)
    elif target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise OutputError(f"{target}: the folder for frames must be new or empty; name another")
    else:
        check_writable(target / "frame" if target.exists() else target)
    find_browser()
    if suffix in (".mp4", ".gif"):
        check_writers(suffix)
    return target


@takes()
def film_times(recording: Recording, fps: float) -> NDArray[np.float64]:
    """Return the times of a film's pictures in the run [s], from first to last.

    Args:
        recording: Recording with span and speed.
        fps: Pictures per second of the film [1/s].
    """
    start, end = _span(recording)
    speed = float(recording.data["speed"])
    count = math.ceil((end - start) * fps / speed - 1e-6)  # the last picture may come early: it is the end
    return np.minimum(start + np.arange(count + 1, dtype=np.float64) * (speed / fps), end)


@takes(time="s")
def save_picture(
    recording: Recording,
    path: str | os.PathLike[str],
    time: float | None = None,
    *,
    size: tuple[int, int] | None = None,
) -> Path:
    """Write a picture of a recording at a time, a PNG file; return its path.

    Args:
        recording: Recording to draw.
        path: Path of the file.
        time: Time of the run [s]; the recording's start if not given.
        size: Width and height [px]; 1280 x 720 if not given.

    Raises:
        InvalidParameterError: The time is outside the recording, or the size makes no sense.
        MissingToolError: Browser or packages are not installed.
        OutputError: The file cannot be written there.
    """
    target = check_film(path, ".png")
    start, end = _span(recording)
    shown = start if time is None else float(time)
    if not start <= shown <= end:
        raise InvalidParameterError("picture", "time", f"within the recording, {start:g} to {end:g} s", shown)
    with open_camera(recording, _SIZE[""] if size is None else size, still=True) as camera:
        _write(target, camera.seek(shown))
    return target


@takes()
def save_frames(
    recording: Recording,
    folder: str | os.PathLike[str],
    *,
    fps: float | None = None,
    size: tuple[int, int] | None = None,
    progress: Progress | None = None,
) -> Filmed:
    """Write a film's pictures one by one, with a table of their times (``frames.csv``).

    Ctrl-C ends it; the pictures done remain.

    Args:
        recording: Recording to film, with its speed.
        folder: New or empty; made if missing.
        fps: Pictures per second of the film [1/s]; 30 if not given.
        size: Width and height [px]; 1280 x 720 if not given.
        progress: Called with the pictures done and planned.

    Raises:
        InvalidParameterError: Rate or size make no sense.
        MissingToolError: Browser or packages are not installed.
        OutputError: The folder has something in it, or cannot be written to.
    """
    target = check_film(folder, "")
    rate, view = _settings("", fps, size)
    times = film_times(recording, rate)
    digits = len(str(len(times)))
    names = [f"frame_{number + 1:0{digits}d}.png" for number in range(len(times))]
    done = 0
    with open_camera(recording, view) as camera:
        target.mkdir(exist_ok=True)
        for png in _pictures(camera, times, rate, progress):
            _write(target / names[done], png)
            done += 1
    with (
        replacing(target / "frames.csv") as partial,
        partial.open("w", newline="", encoding="utf-8") as file,
    ):
        write_csv(file, ("file", "time [s]"), ((names[k], f"{times[k]:.9g}") for k in range(done)))
    return Filmed(target, done, len(times))


@takes()
def save_video(
    recording: Recording,
    path: str | os.PathLike[str],
    *,
    fps: float | None = None,
    size: tuple[int, int] | None = None,
    progress: Progress | None = None,
) -> Filmed:
    """Write a video of a recording: MP4 (H.264) or GIF, as the name ends.

    Ctrl-C ends it; the file then has the pictures done.

    Args:
        recording: Recording to film, with its speed.
        path: Path of the file, ``.mp4`` or ``.gif``.
        fps: Pictures per second of the film [1/s]; 30, or 20 for a GIF, if not given.
        size: Width and height [px]; 1280 x 720, or 800 x 450 for a GIF, if not given.
        progress: Called with the pictures done and planned.

    Raises:
        InvalidParameterError: Rate or size make no sense.
        MissingToolError: Browser or packages are not installed.
        OutputError: The file cannot be written there, or the film is too large for a GIF.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (".mp4", ".gif"):
        raise OutputError(f"{path}: a video's name must end in .mp4 or .gif")
    target = check_film(path, suffix)
    rate, view = _settings(suffix, fps, size)
    times = film_times(recording, rate)
    if suffix == ".gif" and len(times) * view[0] * view[1] > _MOST_GIF_PIXELS:
        raise OutputError(
            f"{target}: {len(times)} pictures of {view[0]}x{view[1]} are too many for a GIF; write an .mp4, "
            "or lower fps, size or the span, or raise the speed"
        )
    done = 0

    def count(number: int, planned: int) -> None:
        nonlocal done
        done = number
        if progress is not None:
            progress(number, planned)

    with open_camera(recording, view) as camera, replacing(target) as partial:
        if suffix == ".gif":
            palette = palette_of([camera.seek(t) for t in _typical(recording, times)])
            write_gif(partial, _pictures(camera, times, rate, count), palette, rate)
        else:
            write_mp4(partial, _pictures(camera, times, rate, count), view, rate)
    return Filmed(target, done, len(times))


def _span(recording: Recording) -> tuple[float, float]:
    """Return the times of the first and last key frame [s]."""
    times = np.frombuffer(base64.b64decode(recording.data["times"]), dtype="<f8")
    return float(times[0]), float(times[-1])


def _settings(suffix: str, fps: float | None, size: tuple[int, int] | None) -> tuple[float, tuple[int, int]]:
    """Return rate and size, checked."""
    rate = _FPS[suffix] if fps is None else float(fps)
    if not 0.0 < rate <= _MOST_FPS[suffix]:
        raise InvalidParameterError(
            "video", "fps", f"above 0 and at most {_MOST_FPS[suffix]:g} per second", rate
        )
    view = check_size(_SIZE[suffix] if size is None else size)
    if suffix == ".mp4" and any(pixels % 2 for pixels in view):
        raise InvalidParameterError("video", "size", "even each way, as H.264 halves its colours", view)
    return rate, view


def _pictures(
    camera: Camera, times: NDArray[np.float64], fps: float, progress: Progress | None
) -> Iterator[bytes]:
    """Yield the pictures of a film until its end or Ctrl-C, one at least."""
    with interruptible() as interrupted:
        for number, time in enumerate(times):
            if number and interrupted():
                return
            picture = camera.advance(float(time), 1.0 / fps) if number else camera.seek(float(time))
            if progress is not None:
                progress(number + 1, len(times))
            yield picture


def _typical(recording: Recording, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return times with all colours of a film, the hardest impact among them."""
    chosen = np.unique(np.linspace(0, len(times) - 1, _PALETTE_PICTURES).round().astype(int))
    spread: NDArray[np.float64] = times[chosen]
    impacts = recording.frames.impacts
    if not len(impacts.peaks):
        return spread
    hardest = float(impacts.times[int(np.argmax(impacts.peaks))])
    return np.concatenate([spread, [min(max(hardest, times[0]), times[-1])]])


def _write(path: Path, content: bytes) -> None:
    with replacing(path) as partial:
        partial.write_bytes(content)
