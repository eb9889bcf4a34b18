"""Complete scenario: all data of a run, so that its result can be repeated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import Field, model_validator

from antenna_pin.base.readable import brief
from antenna_pin.base.units import shown
from antenna_pin.base.views import as_html
from antenna_pin.elements import FAMILIES
from antenna_pin.errors import InvalidParameterError, UnknownNameError, nearest
from antenna_pin.scenario._class_tables import (
    CONTROLLER_SPECS,
    COUPLING_SPECS,
    EVENT_SPECS,
    FLEXIBLE_SPECS,
    OneOf,
)
from antenna_pin.scenario._clearance import law_tables
from antenna_pin.scenario._layers import Source, built, check_files, read_layer, with_each
from antenna_pin.scenario.clearance import CLEARANCES, ClearanceSpec
from antenna_pin.scenario.closures import ClosureSpec
from antenna_pin.scenario.drives import (
    DRIVE_SPECS,
    FAMILY_SPECS,
    REFERENCE_SPECS,
    SPRING_SPECS,
    AnySpring,
    DriveSpec,
    FamilyTables,
    ReferenceSpec,
    check_references,
    is_at_joint,
    is_between_points,
    kind_in,
)
from antenna_pin.scenario.mechanism import MaterialSpec, MechanismSpec, RotorSpec
from antenna_pin.scenario.parameters import ParameterSpec
from antenna_pin.scenario.pointing import PointingSpec
from antenna_pin.scenario.requirements import RequirementSpec, check_requirements
from antenna_pin.scenario.run import InitialBaseSpec, InitialSpec, IntegratorSpec, OutputSpec, settings_key
from antenna_pin.scenario.shipped import tables
from antenna_pin.scenario.spec import Folder, PositiveTime, Version, refuse, refuse_name
from antenna_pin.scenario.stops import with_urdf_limits
from antenna_pin.scenario.temperature import OneTemperature
from antenna_pin.scenario.tolerances import ChainSpec

if TYPE_CHECKING:
    from antenna_pin.contact import Material
    from antenna_pin.scenario.closures import AnyCoupling
    from antenna_pin.scenario.controllers import ControllerSpec
    from antenna_pin.scenario.events import EventSpec
    from antenna_pin.scenario.flexible import FlexibleSpec
else:  # their classes are made when one is met
    ControllerSpec = AnyCoupling = EventSpec = FlexibleSpec = Any


class Scenario(FamilyTables):
    """Mechanism, play in its joints, elements, and settings of a computation.

    Validated data in SI units, nothing computed. JSON preserves it exactly
    (``model_dump_json``, ``model_validate_json``), with the texts and tables of the files it names.

    Attributes:
        format: Version of the format of scenario files.
        title: Short title.
        source: Source of the numbers.
        duration: Simulated time [s].
        mechanism: The mechanism.
        materials: The scenario's own materials by name; :meth:`material` also finds the shipped ones.
        clearance: Joints with play, by the name of the joint.
        flexible: Flexible links, by name.
        closures: Joints that close loops, by name.
        couplings: Joints that follow others, by name, in addition to the URDF's.
        rotors: Rotors of motors, by name.
        references: Courses over time that drives follow, by name.
        drives: Drives, by name.
        springs: Springs, by name.
        events: Events of the run, by name.
        controllers: Sampled controllers, by name.
        initial: The initial state.
        integrator: Settings of integration.
        output: Settings of the record.
        pointing: Actual and commanded pointing of the antenna; None without one.
        uncertain: Uncertain numbers of the scenario by name, with their limits or distributions.
        requirements: Requirements by name, as ``antenna-pin verify`` shows them.
        temperature: Of the parts, all or each; None where all numbers hold as they are.
        tolerances: Chains of dimensions with their tolerances, by name; the motion does not see them.
        name: Name of the scenario: its folder's, or its file's.
        case: Name of the case, or None.
        description: Description of the case.
        overrides: Overrides of the file, as ``a.b=value``.
        folder: Folder of the files that it names.
        urdf_text: The text of the URDF.
    """

    __repr__ = __str__ = brief

    format: Version = 1
    title: str = ""
    source: str = ""
    duration: PositiveTime
    mechanism: MechanismSpec
    materials: dict[str, MaterialSpec] = Field(default_factory=dict)
    clearance: dict[str, Annotated[ClearanceSpec, OneOf(CLEARANCES, "model")]] = Field(default_factory=dict)
    flexible: dict[str, Annotated[FlexibleSpec, OneOf(FLEXIBLE_SPECS)]] = Field(default_factory=dict)
    closures: dict[str, ClosureSpec] = Field(default_factory=dict)
    couplings: dict[str, Annotated[AnyCoupling, OneOf(COUPLING_SPECS)]] = Field(default_factory=dict)
    rotors: dict[str, RotorSpec] = Field(default_factory=dict)
    references: dict[str, Annotated[ReferenceSpec, OneOf(REFERENCE_SPECS)]] = Field(default_factory=dict)
    drives: dict[str, Annotated[DriveSpec, OneOf(DRIVE_SPECS)]] = Field(default_factory=dict)
    springs: dict[str, Annotated[AnySpring, OneOf(SPRING_SPECS)]] = Field(default_factory=dict)
    events: dict[str, Annotated[EventSpec, OneOf(EVENT_SPECS)]] = Field(default_factory=dict)
    controllers: dict[str, Annotated[ControllerSpec, OneOf(CONTROLLER_SPECS)]] = Field(default_factory=dict)
    initial: InitialSpec = Field(default_factory=InitialSpec)
    integrator: IntegratorSpec = Field(default_factory=IntegratorSpec)
    output: OutputSpec = Field(default_factory=OutputSpec)
    pointing: PointingSpec | None = None
    uncertain: dict[str, ParameterSpec] = Field(default_factory=dict)
    requirements: dict[str, RequirementSpec] = Field(default_factory=dict)
    temperature: OneTemperature | None = None
    tolerances: dict[str, ChainSpec] = Field(default_factory=dict)
    name: str = ""
    case: str | None = None
    description: str = ""
    overrides: tuple[str, ...] = ()
    folder: Folder = Path()
    urdf_text: str = Field(repr=False)

    carried: ClassVar[frozenset[str]] = frozenset(
        {"name", "case", "description", "overrides", "folder", "urdf_text"}
    )

    def _repr_html_(self) -> str:
        """Show what it is in a notebook."""
        return as_html(self)

    @property
    def urdf_path(self) -> Path:
        """Path of the URDF, from which its references are resolved."""
        return self.folder / self.mechanism.urdf

    def material(self, name: str) -> Material:
        """Return a material by name: the scenario's own, or a shipped one."""
        from antenna_pin import contact

        if name in self.materials:
            made: Material = self.materials[name].build()
            return made
        if name not in contact.MATERIALS:
            raise UnknownNameError("Scenario", "material", name, {*self.materials, *contact.MATERIALS})
        return contact.MATERIALS[name]

    def to_set(self, event: str) -> dict[str, float]:
        """Return what an event sets, in SI units, by key; {} if nothing."""
        from antenna_pin.scenario.events import numbers_to_set

        return numbers_to_set(self.events[event], self.families, "events", event)

    @property
    def families(self) -> dict[str, Mapping[str, Any]]:
        """Tables of elements by family and name; empty further families are left out."""
        found = {table: getattr(self, table) for table in FAMILY_SPECS}
        return {table: named for table, named in found.items() if named or table in ("drives", "springs")}

    @classmethod
    def keys(cls) -> list[str]:
        """Return the keys of a file; those of all families of elements stand together."""
        others = [table for table in FAMILY_SPECS if table not in ("drives", "springs")]
        found = [name for name in super().keys() if name not in others]
        at = found.index("springs") + 1
        return [*found[:at], *others, *found[at:]]

    def lasting(self, duration: float) -> Scenario:
        """Return the scenario with another duration [s], positive, without checks of the rest."""
        _, record = read_layer({"duration": duration})
        return self.model_copy(update={"duration": duration, "overrides": (*self.overrides, *record)})

    def with_overrides(self, overrides: Mapping[str, Any] | Sequence[str]) -> Scenario:
        """Return the scenario with some values replaced, as ``load_scenario`` does.

        Files are read only where another file is named.

        Args:
            overrides: ``{"integrator.rtol": 1e-9}`` or ``["integrator.rtol=1e-9"]``.
        """
        layer, record = read_layer(overrides)
        data = self.model_dump(exclude_none=True)
        carried = {name: data.pop(name, None) for name in Scenario.carried}
        carried["overrides"] = (*self.overrides, *record)
        if "urdf" in tables(layer.get("mechanism")):
            del carried["urdf_text"]
        for joint, clearance in self.clearance.items():
            data["clearance"][joint].update(law_tables(clearance))
        for name in tables(layer.get("flexible")).keys() & self.flexible.keys():
            table = data["flexible"][name]
            if "file" in tables(layer["flexible"][name]) and len(table["damping_ratio"]) == len(
                table["frequency"]
            ):
                table.pop("damping_ratio")  # that of the old file's modes
        # What old units said of a joint's motion does not bind new values.
        joints = tables(layer.get("initial")).get("joints")
        for below, above in (
            *((data[table], layer.get(table)) for table in FAMILY_SPECS),
            (data["couplings"], layer.get("couplings")),
            (data["references"], layer.get("references")),
            (data["controllers"], layer.get("controllers")),
            (data["initial"]["joints"], joints),
        ):
            for name in tables(above).keys() & below.keys():
                below[name].pop("motion", None)
                below[name].pop("conversion", None)
        source = Source(f"scenario {self.name}".strip(), data, overrides=layer)
        check_files(layer, source)
        return built(type(self), carried, source)

    @model_validator(mode="before")
    @classmethod
    def _complete_tables(cls, data: Any) -> Any:
        """Complete tables named after their joint or link, and require their kind."""
        if not isinstance(data, Mapping):
            return data
        done = dict(data)
        if "stops" in done:
            done["stops"] = with_urdf_limits(data)
        for place in FAMILY_SPECS:
            done = with_each(done, place, partial(_at_its_joint, place))
        for place, key in (("flexible", "link"), ("rotors", "joint")):
            done = with_each(done, place, partial(_with_name, key))
        done = with_each(done, "couplings", _at_its_carrier)
        choices = {
            "couplings": COUPLING_SPECS,
            "references": REFERENCE_SPECS,
            "flexible": FLEXIBLE_SPECS,
            "clearance": CLEARANCES,
            **FAMILY_SPECS,
            "events": EVENT_SPECS,
            "controllers": CONTROLLER_SPECS,
        }
        for place, specs in choices.items():
            _check_choice(done, place, "model" if place == "clearance" else "kind", specs)
        return done

    @model_validator(mode="after")
    def _check_together(self) -> Self:
        from antenna_pin import contact

        known = {*self.materials, *contact.MATERIALS}
        for joint, clearance in self.clearance.items():
            for key in ("journal_material", "bearing_material"):
                name = getattr(clearance, key)
                if name is not None and name not in known:
                    refuse_name("material", name, sorted(known), "clearance", joint, key)
            change = self.mechanism.joints.get(joint)
            if change is not None and change.kind is not None:
                text = f"must be left out: clearance.{joint}.model decides it, got {shown(change.kind)}"
                refuse(text, "mechanism", "joints", joint, "kind", value=change.kind)
        self._check_pace()
        followed: dict[tuple[str, ...], str] = {
            (table, name, "follows"): spec.follows
            for table, named in {**self.families, "controllers": self.controllers}.items()
            for name, spec in named.items()
            if getattr(spec, "follows", None) is not None
        }
        check_references(self.references, followed)
        for name in self.events:
            self.to_set(name)
        if self.controllers:
            from antenna_pin.scenario.controllers import check_commands

            check_commands(self.controllers, self.families)
        for name, link in self.flexible.items():
            self._check_shown(name, link)
        check_requirements(self.requirements, self.uncertain)
        if self.mechanism.base == "fixed" and self.initial.base != InitialBaseSpec():
            refuse('must be left out where mechanism.base is "fixed"', "initial", "base")
        return self

    def _check_pace(self) -> None:
        """Refuse a run without end."""
        settings = self.integrator.build(output_rate=self.output.rate, output_times=self.output.times)
        try:
            settings.check_span(0.0, self.duration)
        except InvalidParameterError as error:
            refuse(error.reason, *settings_key(error.parameter))

    def _check_shown(self, name: str, link: Any) -> None:
        """Refuse a frequency that the samples cannot show."""
        for part, frequency in link.build().frequencies.items():
            if self.output.form == "full" and not 2.0 * frequency < self.output.rate:
                refuse(
                    f"must be below half of output.rate = {self.output.rate:g} Hz for samples to show it, "
                    f"got {frequency:g} Hz; raise output.rate",
                    "flexible",
                    name,
                    *(("modes", part) if link.kind == "modes" else ()),
                    "frequency",
                )


def _with_name(key: str, name: str, table: object) -> object:
    """Return a table with its own name as default of a key."""
    return {key: name, **table} if isinstance(table, Mapping) else table


def _at_its_joint(place: str, name: str, table: object) -> object:
    """Return the table of an element with its own name as its joint's."""
    if not isinstance(table, Mapping):
        return table
    kind = kind_in(place, table)
    if kind is not None:
        table = {"kind": kind, **table}
    if is_between_points(place, table.get("kind")):
        if "joint" in table:
            refuse(
                f"must be left out with first and second; a {FAMILIES[place].word} is at a joint or "
                "between points",
                place,
                name,
                "joint",
            )
        return table
    return _with_name("joint", name, table) if is_at_joint(place, table.get("kind")) else table


def _at_its_carrier(name: str, table: object) -> object:
    """Return the table of a coupling with its kind and follower."""
    if not isinstance(table, Mapping):
        return table
    table = {"kind": next(iter(COUPLING_SPECS)), **table}
    spec = COUPLING_SPECS.get(str(table["kind"]))
    return table if spec is None else _with_name(spec.roles["follower"], name, table)


def _check_choice(data: Mapping[str, Any], place: str, key: str, values: Mapping[str, type[Any]]) -> None:
    """Refuse a table without the key that selects its class."""
    names = ", ".join(values)
    tables = data.get(place)
    for name, table in tables.items() if isinstance(tables, Mapping) else ():
        if not isinstance(table, Mapping):
            continue
        if key not in table:
            guess = nearest(name, [other for other in data[place] if other != name])
            hint = f" (or did you mean {place}.{guess}?)" if guess else ""
            refuse(f"is missing; give one of {names}{hint}", place, name, key)
        if table[key] not in values:
            guess = nearest(str(table[key]), values)
            hint = f"; did you mean {guess}?" if guess else ""
            refuse(f"must be one of {names}, got {shown(table[key])}{hint}", place, name, key)
