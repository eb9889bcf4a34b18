"""Base of the tables of joints with play: dimensions, laws, and their checks."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from typing import Annotated, Any, ClassVar, Literal, Self, get_args

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from antenna_pin.base.iso_fits import IsoFit, read_fit
from antenna_pin.base.units import shown
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario.laws import (
    Family,
    LawChange,
    LawSpec,
    changed_law,
    check_values,
    declared_parameters,
    flat,
    laws,
    missing_parameters,
    read_change,
    read_law,
    title,
    unit_of,
)
from antenna_pin.scenario.spec import (
    Count,
    Length,
    PositiveLength,
    PositiveSpeed,
    QuantityRule,
    Spec,
    read_quantity,
    refuse,
)

Variant = Literal["free", "planar", "ideal"]
Kind = Literal["radial", "axial"]
KINDS: tuple[Kind, ...] = get_args(Kind)

RADIAL_PLAY = ("radial_clearance", "journal_radius")
_AXIAL_PLAY = ("axial_clearance", "flange_distance")

_ORDER = (
    ("radial_clearance", "smaller than", "bearing_radius"),
    ("journal_radius", "smaller than", "bearing_radius"),
    ("bearing_outer_radius", "larger than", "bearing_radius"),
    ("flange_radius", "larger than", "bearing_radius"),
)
_HOLDS: dict[str, Callable[[float, float], bool]] = {
    "smaller than": operator.lt,
    "larger than": operator.gt,
}


class Clearance(Spec):
    """Base of the models of a joint with play.

    Attributes:
        fit: Fit of hole and shaft by ISO 286, as ``"20 H7/g6"`` with the diameter in millimetres, instead of
            the radii; sizes are in the middle of their zones unless the next two say otherwise.
        fit_hole: Place of the hole's size in its zone, from -1 at the lower limit to 1 at the upper one [-].
        fit_shaft: Likewise of the shaft [-].
        bearing_radius: R_i, radius of the bore [m].
        radial_clearance: C_r = R_i - R_j, if not given by the journal's radius [m].
        journal_radius: R_j, if not given by the clearance [m].
        bearing_length: L_i [m].
        axial_clearance: C_a at each flange when centred, below 0 a hard preload [m]; if left out, from the
            flanges, else the radial one.
        flange_distance: L_j = L_i + 2 C_a, between the flanges' inner faces, if not given by C_a [m].
        bearing_outer_radius: R_io [m]; 1.5 R_i is assumed where it is not given.
        flange_radius: R_f [m]; R_io is assumed where it is not given.
        guide_width: Of a guide's hollow, along its section's x [m].
        guide_height: Along its section's y [m].
        slider_width: Below the guide's, if not given by the clearance, to each side [m].
        slider_height: Likewise [m].
        slider_length: Along the axis [m].
        corner_radius: Of the rounding of the slider's edges [m]; None for none.
        roll: Of a guide's section about the axis [rad]; None for none.
        guide_length: Along the axis [m]; None for one longer than the slider's way.
        key_width: Of a key that keeps a round slider from turning [m]; None for none.
        keyway_width: Above the key's [m].
        key_reach: From the axis to where the key's flanks bear [m].
        offset: Bearing centre along the joint's axis from the joint's origin [m].
        bearing_on: Link of the joint with the bearing; the other has the journal.
        geometry: Method for gaps: coal's distance queries or the closed form.
        load: One force per contact (``point``), or strips of the bore and sectors of the flanges
            (``distributed``).
        strips: Of the bore under distributed load, even [-].
        sectors: Of the loaded arc of each flange under distributed load [-].
        flange_modulus: Of the flanges' foundation under distributed load [N/m^3]; None for that of a rigid
            annular punch.
        approach_speed_floor: Least approach speed that a law sees [m/s].
        maximum_depth: A run that presses deeper ends [m]; None for a hundredth of the bearing's radius.
        journal_material: Name of a material; steel is assumed of both parts where neither they nor a law are
            given.
        bearing_material: Likewise.
        normal: Normal law of both kinds of contact; where no law is given lankarani-nikravesh with a
            restitution of 0.9 is assumed.
        radial: What is different at the bore.
        axial: What is different at the flanges.
        friction: Friction law of both kinds of contact.
    """

    # The kinds of contact that occur; whether the joint slides along its axis rather than turning about it.
    kinds: ClassVar[tuple[Kind, ...]] = ()
    slides: ClassVar[bool] = False

    fit: str | None = None
    fit_hole: Annotated[float, QuantityRule("1")] = 0.0
    fit_shaft: Annotated[float, QuantityRule("1")] = 0.0
    bearing_radius: PositiveLength | None = None
    radial_clearance: PositiveLength | None = None
    journal_radius: PositiveLength | None = None
    bearing_length: PositiveLength | None = None
    axial_clearance: Length | None = None
    flange_distance: PositiveLength | None = None
    bearing_outer_radius: PositiveLength | None = None
    flange_radius: PositiveLength | None = None
    guide_width: PositiveLength | None = None
    guide_height: PositiveLength | None = None
    slider_width: PositiveLength | None = None
    slider_height: PositiveLength | None = None
    slider_length: PositiveLength | None = None
    corner_radius: Annotated[float, QuantityRule("m", "zero or more")] | None = None
    roll: Annotated[float, QuantityRule("rad")] | None = None
    guide_length: PositiveLength | None = None
    key_width: PositiveLength | None = None
    keyway_width: PositiveLength | None = None
    key_reach: PositiveLength | None = None
    offset: Length = 0.0
    bearing_on: Literal["parent", "child"] = "parent"
    geometry: Literal["coal", "closed-form"] = "coal"
    load: Literal["point", "distributed"] = "point"
    strips: Annotated[int, Count(2, 1000, even=True)] = 16
    sectors: Annotated[int, Count(3, 1000)] = 16
    flange_modulus: Annotated[float, QuantityRule("N/m**3", "positive")] | None = None
    approach_speed_floor: PositiveSpeed = 1e-4
    maximum_depth: PositiveLength | None = None
    journal_material: str | None = None
    bearing_material: str | None = None
    normal: LawSpec | None = None
    radial: LawChange | None = None
    axial: LawChange | None = None
    friction: LawSpec = Field(default_factory=lambda: LawSpec(law="none"))

    @model_validator(mode="before")
    @classmethod
    def _read_laws(cls, data: Any) -> Any:
        """Read the laws together, as units may depend on a sister table."""
        if not isinstance(data, Mapping):
            return data
        return dict(data) | _read_law_tables(data)

    @model_validator(mode="before")
    @classmethod
    def _read_fit(cls, data: Any) -> Any:
        """Complete the radii by the fit, or refuse one beside radii or without play."""
        return _with_fit(data) if isinstance(data, Mapping) else data

    @model_serializer(mode="wrap")
    def _as_in_files(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Return the table without what follows from the fit."""
        found: dict[str, Any] = handler(self)
        of_fit = _OF_FIT if self.fit is not None else ("fit", "fit_hole", "fit_shaft")
        return {key: value for key, value in found.items() if key not in of_fit}

    @property
    def limits_of_fit(self) -> IsoFit | None:
        """The fit, with the limits of hole and shaft; None without one."""
        return None if self.fit is None else read_fit(self.fit)

    @model_validator(mode="after")
    def _check_dimensions(self) -> Self:
        for pair in (RADIAL_PLAY, _AXIAL_PLAY):
            if all(getattr(self, name) is not None for name in pair):
                refuse(f"must have exactly one of {' and '.join(pair)}, got both")
        for name, rule, other in _ORDER:
            value, limit = getattr(self, name), getattr(self, other)
            if value is not None and limit is not None and not _HOLDS[rule](value, limit):
                refuse(f"must be {rule} {other} = {limit:g} m, got {value:g} m", name, value=value)
        return self

    @model_validator(mode="after")
    def _check_laws(self) -> Self:
        """Refuse laws that do not accept their parameters, and for contacts that occur incomplete ones."""
        for kind in KINDS:
            law, change = self.law(kind), self._change(kind)
            if law is None:
                if kind in self.kinds:
                    refuse("is missing; it names the law of the contact and its parameters", "normal")
                continue
            places = dict.fromkeys(change.parameters if change else (), kind)
            table = kind if change is not None and change.law is not None else "normal"
            _check_law(law, "normal", kind in self.kinds, table, places)
        _check_law(self.friction, "friction", bool(self.kinds), "friction", {})
        return self

    def _change(self, kind: Kind) -> LawChange | None:
        return self.radial if kind == "radial" else self.axial

    def law(self, kind: Kind) -> LawSpec | None:
        """Return the normal law of a kind of contact: common law with its changes."""
        return changed_law(self.normal, self._change(kind))

    @property
    def assumed(self) -> dict[str, float | str]:
        """Assumed values, by key: SI numbers, names."""
        return {}


# What a fit decides.
_OF_FIT = ("bearing_radius", "radial_clearance", "journal_radius")


def _with_fit(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the table of a joint with the radii that its fit decides."""
    text, done = data.get("fit"), dict(data)
    positions = {key: data[key] for key in ("fit_hole", "fit_shaft") if data.get(key) is not None}
    if text is None:
        for key, value in positions.items():
            if read_quantity(value, "1", "", key) != 0.0:
                refuse("must be left out without fit, in whose zone it is a place", key, value=value)
        return done
    if not isinstance(text, str):
        refuse(f"must be text, got {shown(text)}", "fit", value=text)
    if data.get("model") == "prismatic":
        refuse(
            "must be left out of a rectangular slider: give guide_width and slider_width", "fit", value=text
        )
    for key in _OF_FIT:
        if data.get(key) is not None:
            refuse(f"must be left out with fit = {shown(text)}, which decides it", key, value=data[key])
    try:
        fit = read_fit(text)
    except InvalidParameterError as error:
        refuse(f"must be {error.rule}, got {shown(text)}", "fit", value=text)
    hole, shaft = (read_quantity(positions.get(key, 0.0), "1", "", key) for key in ("fit_hole", "fit_shaft"))
    for key, value in (("fit_hole", hole), ("fit_shaft", shaft)):
        if not -1.0 <= value <= 1.0:
            refuse(f"must be from -1 to 1, the limits of the zone, got {value:g}", key, value=value)
    play = fit.radial_clearance(hole, shaft)
    if not play > 0.0:
        most = f"{1e6 * fit.largest:.3g} um at most" if fit.largest > 0.0 else "none at any size"
        refuse(
            f"must leave play, got {shown(text)} with a radial clearance of {1e6 * play:.3g} um at these "
            f"sizes, {most}; take a fit with play, or fit_hole and fit_shaft",
            "fit",
            value=text,
        )
    return done | {
        "bearing_radius": 0.5 * fit.hole.size(hole),
        "journal_radius": 0.5 * fit.shaft.size(shaft),
    }


def law_tables(joint: Clearance) -> dict[str, dict[str, Any]]:
    """Return a joint's normal laws as in a file, with dependent units resolved.

    So the stiffness of a law of one exponent is not taken for that of another, laid over it.
    """
    known = laws("normal")
    found = {}
    for place in ("normal", *KINDS):
        table: LawSpec | LawChange | None = getattr(joint, place)
        if table is None:
            continue
        common = joint.normal if joint.normal is not None else table
        law = table.law or common.law or ""
        outer = common.parameters if law == common.law else {}
        dissipation = table.dissipation or (common.dissipation if law == common.law else None)
        units = {
            name: unit_of(name, law, known, outer | table.parameters, dissipation)
            for name in table.parameters
        }
        found[place] = flat(table) | {name: f"{table.parameters[name]!r} {units[name]}" for name in units}
    return found


def check_play(joint: Clearance, pair: tuple[str, str]) -> None:
    if all(getattr(joint, name) is None for name in pair):
        refuse(f"must have exactly one of {' and '.join(pair)}, got neither")


def _check_law(law: LawSpec, family: Family, complete: bool, table: str, places: Mapping[str, str]) -> None:
    """Refuse a law that rejects its parameters, or if ``complete`` lacks some."""
    known = laws(family)
    missing = missing_parameters(law, known)
    if missing and not complete:
        return
    for name in missing:
        takes = ", ".join(declared_parameters(law.law, known, law.dissipation))
        refuse(f"is missing; law {title(law)} takes {takes}", places.get(name, table), name)
    broken = check_values(law, family)
    if broken is not None:
        name, text = broken
        refuse(text, places.get(name, table), name)


def _read_law_tables(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the law tables of a joint, their parameters in SI units."""
    tables = {name: data[name] for name in ("normal", "radial", "axial", "friction") if name in data}
    families: tuple[Family, ...] = ("normal", "friction")
    for family in families:
        if isinstance(tables.get(family), Mapping | LawSpec):
            tables[family] = read_law(flat(tables[family]), laws(family), family)
    if tables.get("normal") is not None and not isinstance(tables["normal"], LawSpec):
        return tables  # refused for its normal law
    for kind in KINDS:
        if isinstance(tables.get(kind), Mapping | LawSpec | LawChange):
            tables[kind] = read_change(flat(tables[kind]), tables.get("normal"), kind)
    return tables
