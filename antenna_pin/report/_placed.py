"""Which section of a page a figure is in, and how many figures there is room for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

from antenna_pin.report._page import Picture, Section
from antenna_pin.report._runs import ReportedRun
from antenna_pin.report.figures import DrawnFigure
from antenna_pin.report.joints import joint_key

__all__ = ["FIGURES", "Placed"]

#: What all figures may take in a page; those beyond are left out, and named [MB].
FIGURES = 2.6

# Sections of figures by how the name of one begins; of a joint, its own; others are by themselves.
_SECTIONS = {
    "closure": "loops",
    "coupling": "loops",
    "control": "controllers",
    "applied": "forces",
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
        reasons: Why there are none of some, by the section's key.
        notes: What there was no room for.
        megabytes: What the pictures take [MB].
    """

    sections: dict[str, list[Picture]] = field(default_factory=dict)
    reasons: dict[str, list[str]] = field(default_factory=dict)
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
        reasons: dict[str, list[str]] = {}
        left, size = [], 0.0
        for one in figures:
            begins = (key for begin, key in _SECTIONS.items() if one.name.startswith(begin))
            place = next(begins, "figures" if one.joint is None else "joints")
            if one.joint in played and one.name != "hysteresis":
                place = joint_key(str(one.joint))
            if one.reason:
                reasons.setdefault(place, []).append(one.reason)
            for picture in one.pictures:
                own = 1e-6 * len(picture.packed)
                if size + own > FIGURES:
                    left.append(picture.caption)
                    continue
                size += own
                sections.setdefault(place, []).append(picture)
        unseen = f"Not shown, to keep the page small: {', '.join(left)}; antenna-pin plot draws them."
        return cls(sections, reasons, (unseen,) if left else (), size)

    def __getitem__(self, key: str) -> tuple[Picture, ...]:
        """Return the pictures of a section."""
        return tuple(self.sections.get(key, ()))

    def told(self, section: Section) -> Section:
        """Return a section with why some of its figures are missing."""
        return replace(section, notes=(*section.notes, *self.reasons.get(section.key, ())))
