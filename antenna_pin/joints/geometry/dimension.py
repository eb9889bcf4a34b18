"""Dimensions of shapes as declared: unit, rule, part, key, and plays between two.

A shape declares each dimension as a field, by :func:`dimension`, and says which two of them leave which
:class:`Play`. Tables of scenarios, assumptions, growth with temperature and knobs follow from these.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import MISSING
from functools import cache
from typing import Any, Literal, NamedTuple

from antenna_pin.base.parameters import parameter

Part = Literal["bearing", "journal"]


class Dimension(NamedTuple):
    """Declaration of a dimension, besides its unit and rule.

    Attributes:
        part: The part that it is of, whose material it grows with.
        key: Its key in a scenario.
        above: The dimension that it must exceed; "" for none.
        below: The dimension that must exceed it.
        times: Multiple of which dimension it is assumed to be where a scenario does not give it.
        words: Its name where an assumption is stated.
    """

    part: Part
    key: str = ""
    above: str = ""
    below: str = ""
    times: tuple[float, str] | None = None
    words: str = ""


class Play(NamedTuple):
    """Play between two dimensions.

    The outer exceeds the inner by ``share`` times the play.

    Attributes:
        key: Its key in a scenario, given instead of the dimension that it decides; "" for none.
        outer: The larger dimension.
        inner: The smaller dimension.
        doc: Meaning of the key.
        share: 1 for radii, 2 for widths [-].
        rule: A rule for the key's number.
        name: Its name, if not that of the key; of the key ``radial_clearance`` "radial play".
        along: Whether it is along the axis, between flanges on the journal: it decides the outer dimension,
            else the inner.
        like: Key of the play that it equals where nothing is given; "" if it must be given.
    """

    key: str
    outer: str
    inner: str
    doc: str = ""
    share: float = 1.0
    rule: str = "positive"
    name: str = ""
    along: bool = False
    like: str = ""

    @property
    def decides(self) -> str:
        """The dimension that follows from it and the other one."""
        return self.outer if self.along else self.inner

    @property
    def words(self) -> str:
        """Its name."""
        return self.name or self.key.replace("_clearance", " play")

    def of(self, sizes: Mapping[str, float]) -> float:
        """Return the play [m] that dimensions [m] leave."""
        return (sizes[self.outer] - sizes[self.inner]) / self.share

    def decided(self, sizes: Mapping[str, float], play: float) -> float:
        """Return the dimension [m] that leaves a play [m] with the other one."""
        if self.along:
            return sizes[self.inner] + self.share * play
        return sizes[self.outer] - self.share * play


#: The play of a round part in a round hollow.
RADIAL = Play(
    "radial_clearance",
    "bearing_radius",
    "journal_radius",
    "C_r = R_i - R_j, if not given by the journal's radius; of a slider with sides, to each of these [m].",
)


def dimension(
    part: Part,
    *,
    unit: str = "m",
    rule: str = "positive",
    default: Any = MISSING,
    key: str = "",
    above: str = "",
    below: str = "",
    times: tuple[float, str] | None = None,
    words: str = "",
) -> Any:
    """Return a dataclass field that holds a dimension of a shape.

    Args:
        part: The part that it is of.
        unit: SI unit.
        rule: A rule for numbers (:mod:`antenna_pin.base.rules`).
        default: The default; required if not given.
        key: Its key in a scenario, if not its name.
        above: The dimension that it must exceed.
        below: The dimension that must exceed it.
        times: Multiple of which dimension a scenario assumes.
        words: Its name where that assumption is stated.
    """
    declared = Dimension(part, key, above, below, times, words)
    return parameter(unit, rule=rule, default=default, more={"dimension": declared})


def dimensions_of(shape: type[Any]) -> Mapping[str, Dimension]:
    """Return the dimensions that a shape declares, by name, in the order of fields."""
    owner: Any = shape
    return _dimensions_of(owner)


@cache
def _dimensions_of(shape: type[Any]) -> Mapping[str, Dimension]:
    return {
        item.name: item.metadata["dimension"]._replace(key=item.metadata["dimension"].key or item.name)
        for item in dataclasses.fields(shape)
        if "dimension" in item.metadata
    }
