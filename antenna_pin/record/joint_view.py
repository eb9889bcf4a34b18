"""One clearance joint close up: its bearing cut open, the play magnified, contacts coloured by their load."""

from __future__ import annotations

from typing import Any

import numpy as np

from antenna_pin.analysis import bearing_up, steady_up
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.geometry import LOOKS
from antenna_pin.record._ball_picture import BallPicture
from antenna_pin.record._joint_picture import JointPicture
from antenna_pin.record._journal_picture import JournalPicture
from antenna_pin.record._rod_picture import RodPicture
from antenna_pin.record._slider_picture import SliderPicture
from antenna_pin.record.key_frames import Impacts, KeyFrames
from antenna_pin.record.triad import triad
from antenna_pin.trajectory import Trajectory

__all__ = ["PICTURES", "joint_view"]

#: The close-ups that kinds of clearance joints name (:class:`antenna_pin.geometry.Look`).
PICTURES: dict[str, type[JointPicture]] = {
    "journal": JournalPicture,
    "ball": BallPicture,
    "slider": SliderPicture,
    "rod": RodPicture,
}

_DIRECTIONS = 300  # of gravity that a page carries, for bearings that turn


def joint_view(
    run: Trajectory,
    frames: KeyFrames,
    impacts: Impacts,
    places: dict[str, dict[str, Any]],
    joint: str | None = None,
    magnify: float | None = None,
) -> dict[str, Any]:
    """Return the data of a recording that depend on the view (see :class:`Recording`).

    Args:
        run: The run.
        frames: Its key frames.
        impacts: Contact episodes in the span.
        places: Shapes of the clearance joints (its attribute ``clearance_joints``).
        joint: Name of the joint; the first one with clearance if left out.
        magnify: How many times wider gaps are drawn [-]; chosen by the play if left out.
    """
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
    seen = picture.data()
    count = len(frames.indices)
    some = np.unique(np.linspace(0, count - 1, min(_DIRECTIONS, count)).astype(int))
    up = bearing_up(run, name, frames.indices[some]) if "mechanism" in run.data.attrs else None
    gravity = None if up is None else -up @ picture.turn.T
    drawn = {"play": picture.factor}
    return (
        seen | drawn | {"triad": triad("axes of the bearing", picture.turn.T, gravity, picture.times[some])}
    )
