"""Files of moving pictures: MP4 by FFmpeg's libraries (PyAV), GIF by Pillow."""

from __future__ import annotations

import importlib.util
import io
from collections.abc import Iterable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import MissingToolError

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["check_writers", "palette_of", "write_gif", "write_mp4"]

_QUALITY = {"crf": "18", "preset": "medium"}  # 18 is what the eye takes for lossless
_BT709 = 1  # colours and range as all players take those of HD pictures to be
_COLOURS = 256  # of a GIF
_REFINEMENTS = 3  # of the palette
_HOLD = 1000  # [ms] that a GIF shows its last picture before it begins again


def check_writers(suffix: str) -> None:
    """Raise if what writes such files is not installed.

    Args:
        suffix: ``.mp4`` or ``.gif``.

    Raises:
        MissingToolError: A package of the extra ``video`` is missing.
    """
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
    """Write H.264 video in pixels that every player shows (yuv420p).

    Args:
        path: Of the file.
        pictures: PNG files, taken one by one.
        size: Of each, even numbers [px].
        fps: Pictures per second [1/s].
    """
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
    """Return the colours that fit pictures best; one set for all of a GIF keeps it from flickering.

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
    """Write an animation that repeats for ever.

    Args:
        path: Of the file.
        pictures: PNG files; all are kept until the last has come, 1 byte for each pixel.
        palette: Their colours.
        fps: Pictures per second [1/s]; times are in hundredths of a second, rounded without drift.
    """
    from PIL import Image

    shown = [_image(png).quantize(palette=palette, dither=Image.Dither.NONE) for png in pictures]
    times = [int(t) for t in _hundredths(len(shown), fps)]
    times[-1] = max(times[-1], _HOLD)
    first, *others = shown
    first.save(path, format="GIF", save_all=True, append_images=others, duration=times, loop=0)


def _hundredths(count: int, fps: float) -> NDArray[np.int64]:
    """Return how long each picture is shown [ms], whole hundredths of a second."""
    ends = np.round(100.0 * np.arange(count + 1) / fps).astype(np.int64)
    return 10 * np.diff(ends)
