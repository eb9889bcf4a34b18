"""What ``antenna-pin record`` writes besides pages: pictures, their folders, and videos."""

from __future__ import annotations

import re
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from antenna_pin.base.interruption import ended_by
from antenna_pin.cli._common import SIGNALLED, complain
from antenna_pin.cli._progress import picture_bar
from antenna_pin.errors import InvalidParameterError, OutputError

if TYPE_CHECKING:
    from antenna_pin.record import Filmed, Recording

_SIZE = re.compile(r"([0-9]{1,6})\s*[xX×]\s*([0-9]{1,6})")


class Kind(StrEnum):
    """What a recording is written as, by the suffix of the output's name."""

    PAGE = ".html"
    PICTURE = ".png"
    MP4 = ".mp4"
    GIF = ".gif"
    FRAMES = ""


def kind_of(out: Path) -> Kind:
    """Return what a name asks for: a folder or a name without suffix is a folder of frames."""
    if out.is_dir():
        return Kind.FRAMES
    try:
        return Kind(out.suffix.lower())
    except ValueError:
        raise OutputError(
            f"--out {out}: the name must end in .html (page), .mp4 or .gif (video), .png (picture), or have "
            "no suffix (folder of frames)"
        ) from None


def check_options(
    out: Path, kind: Kind, *, at: str | None = None, fps: float | None = None, size: str | None = None
) -> None:
    """Refuse, before any work, what cannot be written, and options that the output does not know."""
    from antenna_pin.base.files import check_writable
    from antenna_pin.record import check_film

    for option, given, kinds in (
        ("--at", at, (Kind.PICTURE,)),
        ("--fps", fps, (Kind.MP4, Kind.GIF, Kind.FRAMES)),
        ("--size", size, (Kind.PICTURE, Kind.MP4, Kind.GIF, Kind.FRAMES)),
    ):
        if given is not None and kind not in kinds:
            names = ", ".join(known.value or "a folder" for known in kinds)
            raise InvalidParameterError(option, "output", f"one of {names}", str(out))
    if kind is Kind.PAGE:
        check_writable(out)
    else:
        check_film(out, kind.value)


def size_of(text: str | None) -> tuple[int, int] | None:
    """Return width and height [px] of ``WIDTHxHEIGHT``."""
    if text is None:
        return None
    found = _SIZE.fullmatch(text.strip())
    if found is None:
        raise InvalidParameterError("--size", "size", "WIDTHxHEIGHT in pixels such as 1280x720", text)
    return int(found.group(1)), int(found.group(2))


def film(
    recording: Recording,
    out: Path,
    kind: Kind,
    *,
    at: float | None,
    fps: float | None,
    size: tuple[int, int] | None,
    progress: bool,
) -> None:
    """Write pictures of a recording, and say so."""
    from antenna_pin.record import save_frames, save_picture, save_video

    if kind is Kind.PICTURE:
        save_picture(recording, out, at, size=size)
        typer.echo(f"saved {out}")
        return
    with picture_bar(out.name, progress) as report:
        save = save_frames if kind is Kind.FRAMES else save_video
        done: Filmed = save(recording, out, fps=fps, size=size, progress=report)
    typer.echo(f"saved {out}")
    if not done.completed:
        complain(f"interrupted: {out} has the first {done.frames} of {done.planned} pictures")
        raise typer.Exit(SIGNALLED + ended_by())
