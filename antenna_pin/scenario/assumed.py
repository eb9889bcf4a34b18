"""Assumptions about joints with play, and their messages.

So that a first answer needs four lines: model, bore, length and play. What is assumed is said by each run, so
that nobody takes it for what was given.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from antenna_pin.base.readable import number, readable
from antenna_pin.scenario._clearance import Clearance, Kind
from antenna_pin.scenario.laws import LawSpec

__all__ = ["LAW", "MATERIAL", "OUTER", "RESTITUTION", "Assuming", "said_of_assumed", "words_of_assumed"]

#: The normal law where none is given, and the coefficient of restitution that it is asked for [-]: what the
#: literature on joints with play takes most often.
LAW, RESTITUTION = "lankarani-nikravesh", 0.9
#: What both parts are of, where neither a law nor a material is given.
MATERIAL = "steel"
#: Outer radius of a bearing over that of its bore [-]: as of a thick plain bush.
OUTER = 1.5


class Assuming(Clearance):
    """A joint with play whose law and materials may be left out together."""

    def law(self, kind: Kind) -> LawSpec | None:
        """Return the assumed normal law of a kind of contact."""
        if self._says_no_law:
            return LawSpec(law=LAW, parameters={"restitution": RESTITUTION})
        return super().law(kind)

    @property
    def materials(self) -> tuple[str | None, str | None]:
        """Materials of bearing and journal."""
        if self.says_no_material:
            return MATERIAL, MATERIAL
        return self.bearing_material, self.journal_material

    @property
    def _says_no_law(self) -> bool:
        return self.normal is None and self.radial is None and self.axial is None

    @property
    def says_no_material(self) -> bool:
        """Return whether no key decides the stiffness; a given law has its own."""
        return self._says_no_law and self.bearing_material is None and self.journal_material is None

    @property
    def assumed(self) -> dict[str, float | str]:
        """Assumed values, by key: SI numbers, names."""
        found: dict[str, float | str] = {}
        if self._says_no_law:
            found["normal"] = LAW
        if self.says_no_material:
            found |= {"bearing_material": MATERIAL, "journal_material": MATERIAL}
        return found


def said_of_assumed(joints: Mapping[str, Clearance]) -> Iterator[str]:
    """Yield a line for each joint with play, by its name, of which something is assumed."""
    for name, joint in joints.items():
        if words := words_of_assumed(joint):
            yield f"{name}: assumed {words}; keys of [clearance.{name}] say otherwise"


def words_of_assumed(joint: Clearance) -> str:
    """Return what is assumed of a joint with play, or ""."""
    return ", ".join(_parts(joint))


def _parts(joint: Clearance) -> Iterator[str]:
    said = joint.assumed
    if "normal" in said:
        yield f"law {LAW} with restitution {number(RESTITUTION)}"
    if "journal_material" in said:
        yield f"{MATERIAL} on {MATERIAL}"
    if "axial_clearance" in said:
        yield f"axial play {readable(float(said['axial_clearance']), 'm')} as the radial"
    for key, words in (("bearing_outer_radius", "outer radius"), ("flange_radius", "flanges of radius")):
        if key in said:
            yield f"{words} {readable(float(said[key]), 'm')}"
