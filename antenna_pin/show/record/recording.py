"""A run as a 3D recording that plays in a browser."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.analysis import bearing_up, steady_up
from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.files import check_writable, replacing
from antenna_pin.base.rules import NumberRule
from antenna_pin.base.views import in_frame
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.joints.geometry import LOOKS
from antenna_pin.scenario import Scenario
from antenna_pin.show.record import page
from antenna_pin.show.record._joint_pictures import PICTURES
from antenna_pin.show.record.curves import curves_of
from antenna_pin.show.record.key_frames import Impacts, KeyFrames, impacts_of, key_frames, rate_of_turns
from antenna_pin.show.record.mechanism_view import mechanism_view
from antenna_pin.show.record.scene import packed_doubles, packed_floats, triad
from antenna_pin.trajectory import Counts, Outcome, Trajectory, series

# --- a clearance joint close up: its bearing cut open, play magnified, contacts coloured by load ---

_DIRECTIONS = 300  # of gravity that a page carries, for bearings that turn


def joint_view(
    run: Trajectory,
    frames: KeyFrames,
    impacts: Impacts,
    places: dict[str, dict[str, Any]],
    joint: str | None = None,
    magnify: float | None = None,
) -> dict[str, Any]:
    """Return the data of a recording that depend on the view (see :class:`Recording`)."""
    if not places or "gap" not in run.data:
        raise InvalidParameterError(
            "recording",
            "view",
            "mechanism for a run without a clearance joint (its joints are ideal; there is no play to show)",
            "joint",
        )
    name = next(iter(places)) if joint is None else joint
    if name not in places:
        raise UnknownNameError("recording", "joint with clearance", name, places)
    if magnify is not None and not 0.0 < magnify < 1e9:
        raise InvalidParameterError("recording", "magnify", "a positive number", magnify)
    place = places[name]
    if place["kind"] not in LOOKS:
        raise UnknownNameError("recording", "kind of clearance joint", place["kind"], LOOKS)
    made = PICTURES[LOOKS[place["kind"]].picture]
    picture = made(run.data, frames, impacts, name, place, magnify, steady_up(run, name))
    count = len(frames.indices)
    some = np.unique(np.linspace(0, count - 1, min(_DIRECTIONS, count)).astype(int))
    up = bearing_up(run, name, frames.indices[some]) if "mechanism" in run.data.attrs else None
    gravity = None if up is None else -up @ picture.turn.T
    axes = triad("axes of the bearing", picture.turn.T, gravity, picture.times[some])
    return picture.data() | {"play": picture.factor, "triad": axes}


View = Literal["mechanism", "joint"]

# Key frames per second of a run, and of one that is drawn as a ghost; more where bodies turn fast [Hz].
_RATE, _GHOST_RATE = 500.0, 200.0
_TRIAL = 10_000  # key frames
_CURVES = 1.0  # what the curves under the slider take at most [MB]


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """3D recording: its data, and the page that plays it without a network.

    Attributes:
        data: Input of the player, as in JSON: texts (``title``, ``subtitle``, ``facts``,
            ``warnings``, ``thinned``), ``times`` of the key frames and the ``impacts`` marked on the
            slider, the viewer's ``commands`` that build the scene, ``actors`` whose ``tracks`` move parts of
            it (poses of seven numbers, placements of twelve, or times from which and until which it is
            visible), ``bodies``, ``contacts``, ``trails``, ``camera``, ``curves``, ``speed``, and the time of
            its ``poster`` for paper. Numbers in bulk are base64 of little-endian floats, 64 bits for times
            and series and 32 for the rest.
        frames: Samples of the run that became key frames.
    """

    data: dict[str, Any]
    frames: KeyFrames

    def __repr__(self) -> str:
        """Return one line: title, key frames, impacts."""
        frames, impacts = len(self.frames.indices), len(self.frames.impacts.times)
        return f"<Recording {self.data['title']!r}: {frames} key frames, {impacts} impacts>"

    @property
    def html(self) -> str:
        """The whole page, self-contained."""
        return page.page(self.data)

    def embedded(self, identity: str, height: str = "30rem", *, packed: bool = False) -> str:
        """Return the part for a page with several recordings; its head needs ``shared_head()`` once.

        Args:
            identity: Id of the element, unique in the page.
            height: CSS height of the element.
            packed: Whether its data are deflated, to two thirds; then it appears some time after the page.
        """
        return page.embedded(self.data, identity, height, packed=packed)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the page, ``NAME.html``; return its path.

        Raises:
            OutputError: The name ends otherwise, or it cannot be written there.
        """
        target = check_writable(path, ".html")
        with replacing(target) as partial:
            partial.write_text(self.html, encoding="utf-8", errors="backslashreplace")
        return target

    def _repr_html_(self) -> str:
        """Return the recording in a frame, for a notebook."""
        return in_frame(self.html, "30rem")


@takes(start="s", end="s", fps="Hz")
def record(
    run: Trajectory | xr.Dataset,
    ideal: Trajectory | xr.Dataset | None = None,
    *,
    view: View = "mechanism",
    joint: str | None = None,
    magnify: float | None = None,
    body: str | None = None,
    boresight: ArrayLike | None = None,
    fps: float | None = None,
    speed: float | None = None,
    start: float | None = None,
    end: float | None = None,
    max_megabytes: Annotated[float, NumberRule("positive", finite=False)] = 5.0,
    curves: Iterable[str] | None = None,
    package_path: Iterable[str | Path] = (),
) -> Recording:
    """Return a recording of a run.

    Key frames are samples of the run at a regular rate, and at every onset, peak and release of a contact,
    so that no impact is skipped; the player interpolates between them.

    Args:
        run: The run, or its data.
        ideal: A run whose bodies are drawn as a ghost, and its curves beside those of the run, usually
            with ideal joints. For the mechanism.
        view: ``mechanism``, all bodies in the world, or ``joint``, a clearance joint close up.
        joint: Name of the clearance joint; the first one if left out. For a joint.
        magnify: Magnification [-]: of a joint's gaps, by default so that its play is drawn a third as wide as
            its pin; of deflections of flexible links in the view of a mechanism, 1 by default.
        body: Link whose boresight is drawn; the scenario's pointing body if left out. For the mechanism.
        boresight: Its direction in the link's frame, (3,) [-]; the scenario's, or x, if left out. For the
            mechanism.
        fps: Regular key frames per second of the run [1/s]; if left out 500, or as many as limit every body's
            turn between two of them to 0.1 rad.
        speed: Seconds of the run per second at first [-]; if left out, real time or, for a run below 4 s, so
            slow that it takes that long; ten times slower for a joint.
        start: First time recorded [s]; the run's start if left out.
        end: Last time recorded [s]; the run's end if left out.
        max_megabytes: Largest size of the page [MB]; key frames are thinned to meet it.
        curves: Names of quantities (:func:`antenna_pin.analysis.quantity`) that the curve under the slider
            offers first; if left out, it begins with the greatest contact force. No curve if empty.
        package_path: Folders of packages of ``package://``, searched before those of the run.

    Raises:
        InvalidParameterError: Values that make no sense, or a joint's view of a run without clearance.
        UnknownNameError: A body, joint or quantity that does not exist.
        FileFormatError: The run lacks the description of its bodies.
    """
    if view not in ("mechanism", "joint"):
        raise InvalidParameterError("recording", "view", "mechanism or joint", view)
    foreign: dict[str, Any] = (
        {"joint": joint} if view == "mechanism" else {"ideal": ideal, "body": body, "boresight": boresight}
    )
    for name, value in foreign.items():
        if value is not None:
            shown = "a run" if name == "ideal" else value
            raise InvalidParameterError("recording", name, f"left out in the view of a {view}", shown)
    folders = [str(Path(folder).absolute()) for folder in package_path]
    run = _looking_in(folders, _trajectory(run))
    ideal = None if ideal is None else _looking_in(folders, _trajectory(ideal))
    first, last = _span(run, start, end)
    line = _boresight(run, body, boresight)
    places: dict[str, dict[str, Any]] = json.loads(run.data.attrs.get("clearance_joints", "{}"))
    impacts = impacts_of(run.data, first, last)
    own = None if view == "mechanism" else joint or next(iter(places), None)
    share = min(_CURVES, 0.2 * max(max_megabytes - page.viewer_megabytes(), 0.0))
    under = curves_of(run, first, last, ideal=ideal, wanted=curves, joint=own, megabytes=share)
    times = np.asarray(run.data["time"].values, dtype=float)
    turning = rate_of_turns(run.data)
    fps = max(_RATE, turning) if fps is None else fps
    limit = 1e6 * max_megabytes
    most: int | None = None
    wanted = len(key_frames(times, impacts, fps, first, last).indices)
    # What a key frame of a long run takes is found out with fewer: all of them may be too many for memory.
    trial = wanted > _TRIAL
    for _ in range(6):
        frames = key_frames(times, impacts, fps, first, last, _TRIAL if trial else most)
        if view == "joint":
            seen = joint_view(run, frames, frames.impacts, places, joint, magnify)
        else:
            ghost = (
                None if ideal is None else (ideal, _ghost_frames(ideal, frames, turning, first, last, most))
            )
            seen = mechanism_view(run, frames, frames.impacts, places, ghost, line, magnify)
        seen["curves"] = under
        recording = Recording(_data(run, view, frames, seen, fps, speed, first, last), frames)
        size = len(recording.html.encode())
        if size <= limit and not trial:
            return recording
        moving = _moving_bytes(recording.data)
        fixed = size - moving
        most = int(0.97 * (limit - fixed) / moving * len(frames.indices))
        if trial and most >= wanted:
            most = None
        trial = False
        if most is not None and most < 2:
            break
    raise InvalidParameterError(
        "recording", "max_megabytes", f"above {1e-6 * fixed:.2f}, what viewer and shapes take", max_megabytes
    )


def _looking_in(folders: list[str], run: Trajectory) -> Trajectory:
    """Return a run with further folders of packages, searched first."""
    if not folders or "mechanism" not in run.data.attrs:
        return run
    about = json.loads(run.data.attrs["mechanism"])
    about["package_path"] = [*folders, *about.get("package_path", ())]
    return replace(run, data=run.data.assign_attrs(mechanism=json.dumps(about)))


def _trajectory(run: Trajectory | xr.Dataset) -> Trajectory:
    """Return a run with outcome and origin, rebuilt from its data alone."""
    if not isinstance(run, Trajectory | xr.Dataset):
        raise InvalidParameterError("recording", "run", "a Trajectory or its data", said=type(run).__name__)
    series(run.data if isinstance(run, Trajectory) else run, "recording")
    if isinstance(run, Trajectory):
        return run
    outcome = Outcome[run.attrs.get("outcome", "COMPLETED")]
    text = run.attrs.get("scenario")
    return Trajectory(
        data=run,
        outcome=outcome,
        message=str(run.attrs.get("outcome_message", outcome.value)),
        counts=Counts(),
        scenario=Scenario.model_validate_json(text) if text else None,
    )


def _span(run: Trajectory, start: float | None, end: float | None) -> tuple[float, float]:
    times = np.asarray(run.data["time"].values, dtype=float)
    low, high = float(times[0]), float(times[-1])
    first = low if start is None else float(start)
    last = high if end is None else float(end)
    for name, value in (("start", first), ("end", last)):
        if not low <= value <= high:
            raise InvalidParameterError("recording", name, f"within the run, {low:g} to {high:g} s", value)
    if first > last or (first == last and low < high):
        raise InvalidParameterError("recording", "end", f"after start = {first:g} s", last)
    inside = (times >= first) & (times <= last)
    if not inside.any():
        raise InvalidParameterError(
            "recording", "end", f"so far from start = {first:g} s that a sample lies between", last
        )
    return first, last


def _ghost_frames(
    ideal: Trajectory, frames: KeyFrames, turning: float, start: float, end: float, most: int | None
) -> KeyFrames:
    times = np.asarray(ideal.data["time"].values, dtype=float)
    nothing = impacts_of(ideal.data, np.inf, np.inf)
    rate = min(frames.rate, max(_GHOST_RATE, turning))
    if not ((times >= start) & (times <= end)).any():
        raise InvalidParameterError(
            "recording", "ideal", f"a run with samples between {start:g} and {end:g} s", f"{times[-1]:g} s"
        )
    return key_frames(times, nothing, rate, start, end, most)


def _boresight(
    run: Trajectory, body: str | None, boresight: ArrayLike | None
) -> tuple[str, ArrayLike] | None:
    pointing: Any = getattr(run.scenario, "pointing", None)
    if body is not None:
        same = pointing is not None and pointing.body == body
        return body, boresight if boresight is not None else pointing.boresight if same else (1.0, 0.0, 0.0)
    if pointing is not None:
        return pointing.body, pointing.boresight if boresight is None else boresight
    if boresight is not None:
        raise InvalidParameterError(
            "recording", "body", "given with boresight, as the scenario has no [pointing]", body
        )
    return None


def _data(
    run: Trajectory,
    view: View,
    frames: KeyFrames,
    view_data: dict[str, Any],
    fps: float,
    speed: float | None,
    start: float,
    end: float,
) -> dict[str, Any]:
    attributes = run.data.attrs
    warnings = list(view_data["warnings"])
    if not run.completed:
        warnings.append(f"the run {run.outcome.verdict}: {run.message}")
    thinned = []
    if frames.rate < fps:
        thinned.append(f"{frames.rate:.3g} key frames per second in place of {fps:g} keep the page small")
    if frames.left_out:
        number = frames.left_out + len(frames.impacts.times)
        warnings.append(
            f"the {frames.left_out} weakest of {number} impacts are left out to keep the page small"
        )
    if len(frames.indices) == 1:
        warnings.append("the run has one sample in this span; there is no motion to play")
    impacts = frames.impacts
    if speed is None:
        speed = _speed(end - start) * (1.0 if view == "mechanism" else 0.1)
    check_number("recording", "speed", speed, "positive")
    title, case = str(attributes.get("title") or ""), str(attributes.get("case") or "")
    name = run.scenario.name if run.scenario is not None and run.scenario.name else ""
    return {
        "version": 1,
        "view": view,
        "title": title or name or "run",
        "subtitle": case,
        "speed": float(speed),
        "times": packed_doubles(np.asarray(run.data["time"].values, dtype=float)[frames.indices]),
        "impacts": {"times": packed_doubles(impacts.times), "peaks": packed_floats(impacts.peaks)},
        "poster": impacts.hardest(0.5 * (start + end)),
        **view_data,
        "warnings": warnings,
        "thinned": thinned,
    }


def _speed(span: float) -> float:
    """Return the greatest speed that makes a span last 4 s [-]."""
    steps = [step for k in range(7) for step in (10.0**-k, 0.5 * 10.0**-k)]
    return next((step for step in steps if span >= 4.0 * step), 1.0)


def _moving_bytes(data: dict[str, Any]) -> int:
    """Return the bytes of a recording that grow with its key frames."""
    texts = [data["times"], data["impacts"]["times"], data["impacts"]["peaks"]]
    for actor in data["actors"]:
        texts += [actor["times"], *(track["data"] for track in actor["tracks"])]
    for arrows in filter(None, (data["contacts"], data.get("applied"))):
        for item in arrows["items"]:
            texts += [item["frames"], item["force"], item["point"]]
    texts += [trail[name] for trail in data["trails"] for name in ("times", "points")]
    return sum(map(len, texts))


# --- several runs, one recording below the other ---

# Key frames of each in all; short runs have as many as they have samples.
_EVERY = 1e6


@takes()
def record_several(
    runs: Iterable[Trajectory], path: str | os.PathLike[str], title: str, max_megabytes: float = 5.0
) -> Path:
    """Write one page with a recording of each run, headed by its case.

    Every sample is a key frame, and there are no curves: for runs of few samples, such as the swings of mode
    shapes, which have no series but their motion.

    Args:
        runs: The runs, one or more.
        path: Path of the page, ``NAME.html``; returned.
        title: Title of the page.
        max_megabytes: Largest size of each recording, the viewer included [MB].

    Raises:
        AntennaPinError: A run that cannot be recorded, or a page that cannot be written.
    """
    target = check_writable(path, ".html")
    made = [
        (str(run.data.attrs.get("case") or run.data.attrs.get("title") or f"run {k}"), run)
        for k, run in enumerate(runs, 1)
    ]
    if not made:
        raise InvalidParameterError("recording", "runs", "at least one", 0)
    parts = [
        (heading, record(run, fps=_EVERY, curves=(), max_megabytes=max_megabytes).data)
        for heading, run in made
    ]
    with replacing(target) as partial:
        partial.write_text(page.page_of_several(parts, title), encoding="utf-8", errors="backslashreplace")
    return target
