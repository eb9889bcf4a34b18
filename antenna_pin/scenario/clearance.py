"""A joint with play: its dimensions, its laws, and how it is to be modelled; a class a model."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar, Literal, Self, get_args

from pydantic import model_validator

from antenna_pin.errors import InvalidParameterError, ScenarioError
from antenna_pin.scenario._base import PositiveLength, refuse
from antenna_pin.scenario._clearance import (
    KINDS,
    RADIAL_PLAY,
    Clearance,
    Kind,
    Variant,
    check_play,
)
from antenna_pin.scenario._kinds import Tables
from antenna_pin.scenario.assumed import OUTER, Assuming
from antenna_pin.scenario.laws import LawSpec, needs_materials

if TYPE_CHECKING:
    from antenna_pin.geometry import ClearanceGeometry

__all__ = [
    "CLEARANCES",
    "ClearanceSpec",
    "ContactClearance",
    "CylindricalClearance",
    "IdealClearance",
    "PlanarClearance",
    "PrismaticClearance",
    "SphericalClearance",
    "TouchingSpec",
]


class IdealClearance(Clearance):
    """A joint modelled without play; dimensions and laws, if given, wait for another case.

    Attributes:
        model: ``ideal``, the joint as the URDF has it, or ``constraint``, the joint freed and held by
            constraint to what it is in the URDF; a floating one is held as a ball joint.
    """

    model: Literal["ideal", "constraint"]

    @property
    def variant(self) -> Variant:
        """Type that replaces the URDF's joint."""
        return "free" if self.model == "constraint" else "ideal"

    @property
    def urdf_types(self) -> tuple[str, ...]:
        """Types that the joint may have in the URDF."""
        return ("revolute", "continuous", "prismatic", *(("floating",) if self.model == "constraint" else ()))


class TouchingSpec(Assuming):
    """Base of the models whose journal touches the bearing.

    A kind of joint with play is one class below, which says its sizes, and its place in ``ClearanceSpec``.
    """

    # The kind of its shape, by which results and readers know it (:data:`antenna_pin.geometry.LOOKS`).
    kind: ClassVar[str]
    # Why no law along a line can be its law, if none can; how many contacts share a line along the bearing.
    no_line: ClassVar[str] = ""
    ends: ClassVar[int] = 1
    # What becomes of the URDF's joint, and which types it may have there.
    becomes: ClassVar[Variant] = "free"
    of_types: ClassVar[tuple[str, ...]] = ("revolute", "continuous")

    @property
    def variant(self) -> Variant:
        """Type that replaces the URDF's joint."""
        return self.becomes

    @property
    def urdf_types(self) -> tuple[str, ...]:
        """Types that the joint may have in the URDF."""
        return self.of_types

    @property
    def radial_play(self) -> float:
        """C_r, whichever way it was given [m]."""
        if self.radial_clearance is not None:
            return self.radial_clearance
        assert self.journal_radius is not None and self.bearing_radius is not None
        return self.bearing_radius - self.journal_radius

    def sizes(self) -> dict[str, float]:
        """Return the dimensions of its shape by the names that its class has for them."""
        raise NotImplementedError

    def shape(self) -> ClearanceGeometry:
        """Return the joint's shape."""
        from antenna_pin.geometry.registry import SHAPES

        shape: ClearanceGeometry = SHAPES[self.kind](**self.sizes())
        return shape

    @property
    def radial_law(self) -> LawSpec:
        """The normal law at the bore, or of the only contacts: ``normal``, with what ``radial`` changes."""
        return self._law_of("radial")

    @property
    def axial_law(self) -> LawSpec:
        """The normal law at the flanges: ``normal``, with what ``axial`` changes."""
        return self._law_of("axial")

    def _law_of(self, kind: Kind) -> LawSpec:
        law = self.law(kind)
        assert law is not None
        return law

    def hertz_stiffness(self, modulus: float, place: str) -> float:
        """Return the stiffness of a Hertz contact of the pair [N/m^1.5].

        Args:
            modulus: Effective one of the materials [Pa].
            place: Where the law stands, for a message.
        """
        from antenna_pin.contact import internal_hertz_stiffness

        assert self.bearing_radius is not None
        return internal_hertz_stiffness(self.bearing_radius, self.bearing_radius - self.radial_play, modulus)

    @model_validator(mode="after")
    def _check_contact(self) -> Self:
        self._check_plays()
        left = needs_materials(self.radial_law)
        for name in ("journal_material", "bearing_material") if left and not self.says_no_material else ():
            if getattr(self, name) is None:
                refuse(f"is missing; it decides the {left}, or give normal.{left}", name)
        return self

    def _check_plays(self) -> None:
        check_play(self, RADIAL_PLAY)


class PlanarClearance(TouchingSpec):
    """Planar joint with radial play: contact at the bore only."""

    kind = "planar"
    kinds: ClassVar[tuple[Kind, ...]] = ("radial",)
    becomes = "planar"

    model: Literal["planar"]
    bearing_radius: PositiveLength

    def sizes(self) -> dict[str, float]:
        """Return the radii."""
        return {
            "bearing_radius": self.bearing_radius,
            "journal_radius": self.bearing_radius - self.radial_play,
        }


class SphericalClearance(TouchingSpec):
    """A ball in a socket: ``bearing_radius`` is the socket's, ``journal_radius`` the ball's."""

    kind = "spherical"
    kinds: ClassVar[tuple[Kind, ...]] = ("radial",)
    no_line = "a ball in a socket"
    of_types = ("revolute", "continuous", "floating")

    model: Literal["spherical"]
    bearing_radius: PositiveLength

    def sizes(self) -> dict[str, float]:
        """Return the radii."""
        return {"socket_radius": self.bearing_radius, "ball_radius": self.bearing_radius - self.radial_play}


class ContactClearance(TouchingSpec):
    """A joint held together by contact alone: bore and flanges, six degrees of freedom."""

    kind = "revolute"
    kinds: ClassVar[tuple[Kind, ...]] = KINDS
    ends = 2

    model: Literal["contact"]
    bearing_radius: PositiveLength
    bearing_length: PositiveLength

    @property
    def axial_play(self) -> float:
        """C_a = (L_j - L_i) / 2, whichever way it was given [m]; as the radial one where it was not."""
        if self.axial_clearance is not None:
            return self.axial_clearance
        if self.flange_distance is None:
            return self.radial_play
        return (self.flange_distance - self.bearing_length) / 2.0

    @property
    def radii(self) -> tuple[float, float]:
        """R_io and R_f, given or assumed [m]."""
        outer = (
            OUTER * self.bearing_radius if self.bearing_outer_radius is None else self.bearing_outer_radius
        )
        return outer, outer if self.flange_radius is None else self.flange_radius

    @property
    def assumed(self) -> dict[str, float | str]:
        """Assumed values, by key: SI numbers, names."""
        found = super().assumed
        if self.axial_clearance is None and self.flange_distance is None:
            found["axial_clearance"] = self.axial_play
        for key, radius in zip(("bearing_outer_radius", "flange_radius"), self.radii, strict=True):
            if getattr(self, key) is None:
                found[key] = radius
        return found

    def sizes(self) -> dict[str, float]:
        """Return radii and lengths of bearing and journal."""
        outer, flange = self.radii
        return {
            "bearing_radius": self.bearing_radius,
            "journal_radius": self.bearing_radius - self.radial_play,
            "bearing_length": self.bearing_length,
            "flange_distance": self.bearing_length + 2.0 * self.axial_play,
            "bearing_outer_radius": outer,
            "flange_radius": flange,
        }

    def _check_plays(self) -> None:
        check_play(self, RADIAL_PLAY)
        if self.axial_play < 0.0:
            self._check_hard()

    def _check_hard(self) -> None:
        """Refuse a hard preload that presses deeper than contact stiffness applies."""
        from antenna_pin.geometry import HARDEST

        key, least, ends = "axial_clearance", "zero", 1
        if self.axial_clearance is None:
            key, least, ends = "flange_distance", f"bearing_length = {self.bearing_length:g} m", 2
        deepest, value = HARDEST * self.bearing_radius, getattr(self, key)
        if self.axial_play < -deepest * (1.0 + 1e-9):
            rule = f"must be at least {least}, or for a hard preload less by at most {ends * deepest:g} m"
            refuse(f"{rule}, got {value:g} m", key, value=value)


class PrismaticClearance(TouchingSpec):
    """A rectangular slider in a rectangular guide: slides along the joint's axis, six degrees of freedom.

    ``normal`` is the law of each of the slider's eight corners on each of its two walls.
    """

    kind = "prismatic"
    kinds: ClassVar[tuple[Kind, ...]] = ("radial",)
    no_line = "the corner of a slider"
    of_types = ("prismatic",)
    slides = True

    model: Literal["prismatic"]
    guide_width: PositiveLength
    guide_height: PositiveLength
    slider_length: PositiveLength

    def sizes(self) -> dict[str, float]:
        """Return the sides of guide and slider, what rounds the edges and how the section is turned."""
        sizes = {name: getattr(self, name) or 0.0 for name in ("corner_radius", "roll", "guide_length")}
        for side in ("width", "height"):
            guide, slider = getattr(self, f"guide_{side}"), getattr(self, f"slider_{side}")
            sizes[f"guide_{side}"] = guide
            sizes[f"slider_{side}"] = guide - 2.0 * self.radial_play if slider is None else slider
        return {"slider_length": self.slider_length, **sizes}

    def hertz_stiffness(self, modulus: float, place: str) -> float:
        """Return the stiffness of a Hertz contact of a rounded corner, a ball, on a plane [N/m^1.5]."""
        if not self.corner_radius:
            raise ScenarioError(
                f"{place}: is missing; give it, or the joint's corner_radius: a sharp corner has no stiffness"
            )
        return 4.0 / 3.0 * modulus * math.sqrt(self.corner_radius)

    def _check_plays(self) -> None:
        if self.journal_radius is not None:
            refuse("must be left out; a slider has slider_width and slider_height", "journal_radius")
        sides = (self.slider_width, self.slider_height)
        if (self.radial_clearance is None) == (None in sides):
            refuse("must have exactly one of radial_clearance, and slider_width with slider_height")
        if self.radial_clearance is not None and sides != (None, None):
            refuse("must have exactly one of radial_clearance, and slider_width with slider_height, got both")
        if self.load != "point":
            refuse(f"must be point for a slider, got {self.load!r}", "load", value=self.load)
        try:
            self.shape()
        except InvalidParameterError as error:
            refuse(error.reason, error.parameter)


class CylindricalClearance(TouchingSpec):
    """A round slider in a round guide: slides along the joint's axis, and turns about it unless it has a key.

    ``bearing_radius`` is the guide's, ``journal_radius`` the slider's. ``normal`` is the law of each of its
    two ends, and of the key's flanks.
    """

    kind = "cylindrical"
    kinds: ClassVar[tuple[Kind, ...]] = ("radial",)
    no_line = "the end of a round slider"
    of_types = ("prismatic",)
    slides = True

    model: Literal["cylindrical"]
    bearing_radius: PositiveLength
    slider_length: PositiveLength

    def sizes(self) -> dict[str, float]:
        """Return radii, lengths and what there is of a key."""
        more = ("guide_length", "key_width", "keyway_width", "key_reach")
        return {
            "bearing_radius": self.bearing_radius,
            "journal_radius": self.bearing_radius - self.radial_play,
            "slider_length": self.slider_length,
            **{name: getattr(self, name) or 0.0 for name in more},
        }

    def _check_plays(self) -> None:
        check_play(self, RADIAL_PLAY)
        if self.load != "point":
            refuse(f"must be point for a slider, got {self.load!r}", "load", value=self.load)
        try:
            self.shape()
        except InvalidParameterError as error:
            refuse(error.reason, error.parameter)


ClearanceSpec = (
    ContactClearance
    | PlanarClearance
    | SphericalClearance
    | PrismaticClearance
    | CylindricalClearance
    | IdealClearance
)
"""A joint with play; ``model`` says which class it is."""

_MODELS = {
    model: cls for cls in get_args(ClearanceSpec) for model in get_args(cls.model_fields["model"].annotation)
}

CLEARANCES = Tables(_MODELS, _MODELS.__getitem__)
"""Joints with play by their ``model``."""
