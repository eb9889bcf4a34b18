"""What marks in a recording are made of, and what they come to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.mechanism import Mechanism, frame_aligning_z
from antenna_pin.record.scene import Scene
from antenna_pin.trajectory import Trajectory

__all__ = ["Label", "Mark", "Marking", "rgb"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Marking:
    """What a mark may need.

    Attributes:
        run: The run.
        mechanism: What it is of.
        samples: Those of the run that are key frames, (frames,).
        scene: What marks are put into.
        paths: Of the links in the scene, by name; what is put below one moves with it.
        position: Of the links at the key frames, (frames, links, 3) [m].
        attitude: Likewise, quaternions xyzw, (frames, links, 4) [-]; links in the order of ``paths``.
        size: Of the mechanism [m].
    """

    run: Trajectory
    mechanism: Mechanism
    samples: NDArray[np.intp]
    scene: Scene
    paths: Mapping[str, str]
    position: Array
    attitude: Array
    size: float

    @property
    def times(self) -> Array:
        """Of the key frames, (frames,) [s]."""
        return np.asarray(self.run.data["time"].values, dtype=float)[self.samples]

    def path(self, link: str) -> str:
        """Return what a thing on a link is put below; one of the world's stands by itself."""
        return self.paths.get(link, "world")

    def seat(self, joint: str) -> tuple[str, Array]:
        """Return what a joint's parent is called in the scene, and the joint's place in it, z along the axis.

        Args:
            joint: Its name.

        Returns:
            The path, and the placement (4, 4) [-, m].
        """
        urdf = self.mechanism.urdf
        turn = np.eye(4)
        turn[:3, :3] = frame_aligning_z(np.asarray(self.mechanism.joint(joint).axis, dtype=float))
        return self.path(urdf.joint(joint).parent), np.asarray(urdf.placement(joint)) @ turn


@dataclass(frozen=True, slots=True)
class Label:
    """A name in the picture.

    Attributes:
        text: What it says.
        path: In the scene, of what it goes with.
        at: Where in its frame, (3,) [m].
    """

    text: str
    path: str
    at: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Mark:
    """Things in the scene that are shown or hidden together.

    Attributes:
        text: What the page calls them.
        colour: Beside it, ``#RRGGBB``.
        paths: Of the things.
        tracks: How they move beside their links, as an actor of the recording takes them.
        shown: Whether they are from the first; else they can be switched on.
        labels: Names of theirs.
    """

    text: str
    colour: str
    paths: tuple[str, ...]
    tracks: tuple[dict[str, Any], ...] = ()
    shown: bool = True
    labels: tuple[Label, ...] = ()

    def listed(self) -> dict[str, Any]:
        """Return it as the page takes it."""
        found: dict[str, Any] = {"text": self.text, "colour": self.colour, "paths": list(self.paths)}
        if not self.shown:
            found["shown"] = False
        if self.labels:
            found["labels"] = [
                {"text": label.text, "path": label.path, "at": list(label.at)} for label in self.labels
            ]
        return found


def rgb(colour: str) -> tuple[float, float, float]:
    """Return red, green and blue, 0 to 1 [-], of ``#RRGGBB``."""
    red, green, blue = (int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return red, green, blue
