"""Which section of a page a figure is in, and how many figures there is room for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from antenna_pin.report._page import Picture
from antenna_pin.report._runs import ReportedRun
from antenna_pin.report.figures import DrawnFigure

__all__ = ["FIGURES", "Placed"]

#: What all figures may take in a page; those beyond are left out, and named [MB].
FIGURES = 2.6

# Sections of figures by how the name of one begins; of a joint, its own; others are by themselves.
_SECTIONS = {
    "closure": "loops",
    "coupling": "loops",
    "drive": "drives",
    "swept": "drives",
    "shock": "drives",
    "random": "drives",
    "hysteresis": "springs",
    "stops": "stops",
    "gears": "gears",
    "deflection": "elastic",
    "base": "base",
    "body": "base",
    "joints": "joints",
    "pointing": "pointing",
    "energy": "conservation",
    "momentum": "conservation",
}


@dataclass(frozen=True, slots=True)
class Placed:
    """The figures of a page by their sections.

    Attributes:
        sections: Pictures by the section's key.
        joints: Pictures of joints with play, by the joint.
        notes: Which there are none of, and why.
        megabytes: What the pictures take [MB].
    """

    sections: dict[str, list[Picture]] = field(default_factory=dict)
    joints: dict[str, list[Picture]] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    megabytes: float = 0.0

    @classmethod
    def of(cls, figures: Iterable[DrawnFigure], runs: Sequence[ReportedRun]) -> Placed:
        """Return figures in their sections, as many as there is room for.

        Args:
            figures: In the catalogue's order.
            runs: What they are of.
        """
        played = {name for run in runs for name in run.names("clearance_joint")}
        sections: dict[str, list[Picture]] = {}
        joints: dict[str, list[Picture]] = {}
        notes, left, size = [], [], 0.0
        for one in figures:
            if one.reason:
                notes.append(one.reason)
            for picture in one.pictures:
                own = 1e-6 * len(picture.packed)
                if size + own > FIGURES:
                    left.append(picture.caption)
                    continue
                size += own
                begins = (key for begin, key in _SECTIONS.items() if one.name.startswith(begin))
                if one.joint in played and one.name != "hysteresis":
                    joints.setdefault(str(one.joint), []).append(picture)
                else:
                    rest = "figures" if one.joint is None else "joints"
                    sections.setdefault(next(begins, rest), []).append(picture)
        if left:
            notes.append(
                f"Not shown, to keep the page small: {', '.join(left)}; antenna-pin plot draws them."
            )
        return cls(sections, joints, tuple(notes), size)

    def __getitem__(self, key: str) -> tuple[Picture, ...]:
        """Return the pictures of a section."""
        return tuple(self.sections.get(key, ()))

    def joint(self, name: str) -> tuple[Picture, ...]:
        """Return the pictures of a joint with play."""
        return tuple(self.joints.get(name, ()))
