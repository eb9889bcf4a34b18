"""``antenna-pin record``: a run in 3D as a page, as pictures or as a video."""

from __future__ import annotations

import re
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import (
    SIGNALLED,
    complain,
    load_result,
    not_interrupted,
    package_folders,
    say,
)
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli._progress import picture_bar
from antenna_pin.apps.cli._usage import direction_of, seconds_in
from antenna_pin.base.interruption import ended_by
from antenna_pin.base.readable import decimal_in
from antenna_pin.base.rules import NumberRule, Positive
from antenna_pin.errors import InvalidParameterError, OutputError

if TYPE_CHECKING:
    from antenna_pin.show.record import Filmed, Recording


_SIZE = re.compile(r"([0-9]{1,6})\s*[xX×]\s*([0-9]{1,6})")


class Kind(StrEnum):
    """Format of a recording, by the suffix of the output's name."""

    PAGE = ".html"
    PICTURE = ".png"
    MP4 = ".mp4"
    GIF = ".gif"
    FRAMES = ""


def kind_of(out: Path) -> Kind:
    """Return the format of a name; a folder or no suffix means frames."""
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
    """Refuse an output that cannot be written, and options without effect on it."""
    from antenna_pin.base.files import check_writable
    from antenna_pin.show.record import check_film

    for name, given, kinds in (
        ("--at", at, (Kind.PICTURE,)),
        ("--fps", fps, (Kind.MP4, Kind.GIF, Kind.FRAMES)),
        ("--size", size, (Kind.PICTURE, Kind.MP4, Kind.GIF, Kind.FRAMES)),
    ):
        if given is not None and kind not in kinds:
            names = ", ".join(known.value or "a folder" for known in kinds)
            raise InvalidParameterError(name, "output", f"one of {names}", str(out))
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
    """Write pictures of a recording and print their place."""
    from antenna_pin.show.record import save_frames, save_picture, save_video

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


class ViewName(StrEnum):
    """View of a recording."""

    MECHANISM = "mechanism"
    JOINT = "joint"


IdealOption = Annotated[Path | None, option("Result with ideal joints, drawn as a ghost.", "FILE")]
ViewOption = Annotated[ViewName, option("The whole mechanism, or a clearance joint close up.")]
JointOption = Annotated[str | None, option("Clearance joint to show; the first one if left out.")]
CurveOption = Annotated[
    list[str] | None,
    option(
        "Quantity that the curve under the slider offers first, one of phase --list; can be repeated.", "NAME"
    ),
]


def record(
    file: options.Result,
    out: Annotated[
        Path,
        option(
            "What to write: NAME.html, a page that opens offline; NAME.mp4 or NAME.gif, a video;"
            " NAME.png, a picture; a name without suffix, a folder of frames."
        ),
    ],
    ideal: IdealOption = None,
    view: ViewOption = ViewName.MECHANISM,
    joint: JointOption = None,
    curve: CurveOption = None,
    magnify: Annotated[
        float | None,
        option(
            "How many times wider the joint's play is drawn, by itself a third as wide as its pin; of a"
            " mechanism how many times larger deflections of flexible links are, 1 by itself."
        ),
    ] = None,
    body: Annotated[str | None, option("Link whose boresight is drawn; the scenario's if left out.")] = None,
    boresight: Annotated[
        str | None, option("Direction of the boresight in the link's frame.", "X,Y,Z")
    ] = None,
    speed: Annotated[
        str | None, option("Speed, such as 1 or 1/100; while a page plays it can be changed.")
    ] = None,
    start: Annotated[str | None, option("First time, in seconds or with a unit ('20 ms').")] = None,
    end: Annotated[str | None, option("Last time, in seconds or with a unit.")] = None,
    at: Annotated[str | None, option("Time of a picture; the start if left out.")] = None,
    fps: Annotated[
        float | None, option("Pictures per second of a video or folder; 30, or 20 for a GIF.")
    ] = None,
    size: Annotated[
        str | None, option("Size of pictures in pixels; 1280x720, or 800x450 for a GIF.", "WxH")
    ] = None,
    key_rate: Annotated[
        float | None,
        option("Key frames per second of the run, besides all impacts; 500, or more where bodies turn fast."),
        NumberRule("positive"),
    ] = None,
    max_size: Annotated[
        Positive, option("Largest size of a page; key frames are thinned to it.", "MB")
    ] = 5.0,
    package_path: options.PackagePath = None,
    progress: Annotated[bool, option("Show a progress bar while filming.")] = True,
) -> None:
    """Record a run in 3D: one self-contained HTML page with a player.

    Pictures and videos are taken of that page by Chromium (the extra "video" of the package).
    """
    kind = kind_of(out)
    check_options(out, kind, at=at, fps=fps, size=size)
    time, pixels = seconds_in(at, "--at"), size_of(size)
    packages = package_folders(package_path)
    run = load_result(file)
    reference = None if ideal is None else load_result(ideal)

    from antenna_pin.show.record import record as make

    recording = make(
        run,
        reference,
        view=view.value,
        joint=joint,
        magnify=magnify,
        body=body,
        boresight=None if boresight is None else direction_of(boresight, "record", "--boresight"),
        fps=key_rate,
        speed=None if speed is None else _ratio(speed),
        start=seconds_in(start, "--start"),
        end=seconds_in(end, "--end"),
        max_megabytes=max_size,
        curves=curve or None,
        package_path=packages,
    )
    for text in (*recording.data["warnings"], *recording.data["thinned"]):
        say(f"note: {text}")
    if kind is not Kind.PAGE:
        film(recording, out, kind, at=time, fps=fps, size=pixels, progress=progress)
        return
    with not_interrupted():
        recording.save(out)
        typer.echo(f"saved {out}")


def _ratio(text: str) -> float:
    above, slash, below = text.partition("/")
    number, by = decimal_in(above), decimal_in(below) if slash else 1.0
    if number is None or not by:
        raise InvalidParameterError("--speed", "speed", "a number or a fraction such as 1/100", text)
    return number / by
