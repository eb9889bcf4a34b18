"""Joints with play: dimensions, laws, model, and assumptions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, ClassVar, Literal, Self, cast, get_args

from pydantic import model_validator

from antenna_pin.base.readable import number, readable
from antenna_pin.errors import InvalidParameterError, ScenarioError
from antenna_pin.scenario._class_tables import Tables
from antenna_pin.scenario._clearance import KINDS, RADIAL_PLAY, Clearance, Kind, Variant, check_play
from antenna_pin.scenario.laws import LawSpec, needs_materials
from antenna_pin.scenario.spec import PositiveLength, refuse

if TYPE_CHECKING:
    from antenna_pin.joints.geometry import ClearanceGeometry


#: The normal law where none is given, and the coefficient of restitution that it is asked for [-]: what the
#: literature on joints with play takes most often.
LAW, RESTITUTION = "lankarani-nikravesh", 0.9
#: What both parts are of, where neither a law nor a material is given.
MATERIAL = "steel"
#: Outer radius of a bearing over that of its bore [-]: as of a thick plain bush.
OUTER = 1.5


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


class TouchingSpec(Clearance):
    """Base of the models whose journal touches the bearing.

    A kind of joint with play is one class below, which says its sizes.
    """

    if TYPE_CHECKING:
        model: str

    # The kind of its shape, by which results and readers know it (:data:`antenna_pin.joints.geometry.LOOKS`).
    kind: ClassVar[str]
    # Why no law along a line can be its law, if none can; how many contacts share a line along the bearing.
    no_line: ClassVar[str] = ""
    ends: ClassVar[int] = 1
    # Type that replaces the URDF's joint, and the types that it may have there.
    variant: ClassVar[Variant] = "free"
    urdf_types: ClassVar[tuple[str, ...]] = ("revolute", "continuous")

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
        from antenna_pin.joints.geometry.registry import SHAPES

        shape: ClearanceGeometry = SHAPES[self.kind](**self.sizes())
        return shape

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

    @property
    def radial_law(self) -> LawSpec:
        """Normal law at the bore, or of the only contacts: ``normal`` changed by ``radial``."""
        return cast(LawSpec, self.law("radial"))

    @property
    def axial_law(self) -> LawSpec:
        """Normal law at the flanges: ``normal`` changed by ``axial``."""
        return cast(LawSpec, self.law("axial"))

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

    def _check_slider(self) -> None:
        if self.load != "point":
            refuse(f"must be point for a slider, got {self.load!r}", "load", value=self.load)
        try:
            self.shape()
        except InvalidParameterError as error:
            refuse(error.reason, error.parameter)


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
        """C_a = (L_j - L_i) / 2 [m], however given; by default the radial play."""
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
        from antenna_pin.joints.geometry import HARDEST

        key, least, ends = "axial_clearance", "zero", 1
        if self.axial_clearance is None:
            key, least, ends = "flange_distance", f"bearing_length = {self.bearing_length:g} m", 2
        deepest, value = HARDEST * self.bearing_radius, getattr(self, key)
        if self.axial_play < -deepest * (1.0 + 1e-9):
            rule = f"must be at least {least}, or for a hard preload less by at most {ends * deepest:g} m"
            refuse(f"{rule}, got {value:g} m", key, value=value)


class PlanarClearance(TouchingSpec):
    """Planar joint with radial play: contact at the bore only."""

    kind = "planar"
    kinds: ClassVar[tuple[Kind, ...]] = ("radial",)
    variant = "planar"

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
    urdf_types = ("revolute", "continuous", "floating")

    model: Literal["spherical"]
    bearing_radius: PositiveLength

    def sizes(self) -> dict[str, float]:
        """Return the radii."""
        return {"socket_radius": self.bearing_radius, "ball_radius": self.bearing_radius - self.radial_play}


class PrismaticClearance(TouchingSpec):
    """A rectangular slider in a rectangular guide, with six degrees of freedom.

    ``normal`` is the law of each of the slider's eight corners on each of its two walls.
    """

    kind = "prismatic"
    kinds: ClassVar[tuple[Kind, ...]] = ("radial",)
    no_line = "the corner of a slider"
    urdf_types = ("prismatic",)
    slides = True

    model: Literal["prismatic"]
    guide_width: PositiveLength
    guide_height: PositiveLength
    slider_length: PositiveLength

    def sizes(self) -> dict[str, float]:
        """Return the dimensions of guide and slider, corner radius and roll."""
        sizes = {name: getattr(self, name) or 0.0 for name in ("corner_radius", "roll", "guide_length")}
        for side in ("width", "height"):
            guide, slider = getattr(self, f"guide_{side}"), getattr(self, f"slider_{side}")
            sizes[f"guide_{side}"] = guide
            sizes[f"slider_{side}"] = guide - 2.0 * self.radial_play if slider is None else slider
        return {"slider_length": self.slider_length, **sizes}

    def hertz_stiffness(self, modulus: float, place: str) -> float:
        """Return the Hertz stiffness of a rounded corner on a plane [N/m^1.5]."""
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
        self._check_slider()


class CylindricalClearance(TouchingSpec):
    """A round slider in a round guide, free to turn unless it has a key.

    ``bearing_radius`` is the guide's, ``journal_radius`` the slider's. ``normal`` is the law of each of its
    two ends, and of the key's flanks.
    """

    kind = "cylindrical"
    kinds: ClassVar[tuple[Kind, ...]] = ("radial",)
    no_line = "the end of a round slider"
    urdf_types = ("prismatic",)
    slides = True

    model: Literal["cylindrical"]
    bearing_radius: PositiveLength
    slider_length: PositiveLength

    def sizes(self) -> dict[str, float]:
        """Return radii, lengths and the dimensions of a key."""
        more = ("guide_length", "key_width", "keyway_width", "key_reach")
        return {
            "bearing_radius": self.bearing_radius,
            "journal_radius": self.bearing_radius - self.radial_play,
            "slider_length": self.slider_length,
            **{name: getattr(self, name) or 0.0 for name in more},
        }

    def _check_plays(self) -> None:
        check_play(self, RADIAL_PLAY)
        self._check_slider()


ClearanceSpec = TouchingSpec | IdealClearance
"""A joint with play; ``model`` says which class it is."""

_CLASSES: tuple[type[Clearance], ...] = (*TouchingSpec.__subclasses__(), IdealClearance)
_MODELS = {model: cls for cls in _CLASSES for model in get_args(cls.model_fields["model"].annotation)}

CLEARANCES = Tables(_MODELS, _MODELS.__getitem__)
"""Joints with play by their ``model``."""


def said_of_assumed(joints: Mapping[str, Clearance]) -> Iterator[str]:
    """Yield a line of assumptions for each joint with play, by name."""
    for name, joint in joints.items():
        if words := words_of_assumed(joint):
            yield f"{name}: assumed {words}; set keys of [clearance.{name}] to change this"


def words_of_assumed(joint: Clearance) -> str:
    """Return the assumptions about a joint with play as text; "" without any."""
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
