"""The tables of a scenario file, as docs/scenario.md lists and docs/reference/ describes them.

Each is declared once: where it stands, what it is in a line, its rows. Written by ``reference.py``; a page
holds those of one group, between its marks ``scenario_GROUP``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, get_args

from scenario_reference import Row, first_line, keys_of, kinds_of, listed, said_once

from antenna_pin.contact import MATERIALS
from antenna_pin.elements import FAMILIES, REFERENCES
from antenna_pin.joints.geometry.dimension import dimensions_of
from antenna_pin.scenario import (
    DRIVE_SPECS,
    FAMILY_SPECS,
    REFERENCE_SPECS,
    SPRING_SPECS,
    AnchorSpec,
    AngleEvent,
    ChainSpec,
    ChangeEvent,
    ClosureSpec,
    ContactClearance,
    CouplingSpec,
    DifferentialSpec,
    DimensionSpec,
    ForceEvent,
    GapEvent,
    InitialBaseSpec,
    InitialJointSpec,
    IntegratorSpec,
    JointSpec,
    LinkSpec,
    MaterialSpec,
    MechanismSpec,
    ModalDataSpec,
    ModeSpec,
    ModesSpec,
    OrbitSpec,
    OutputSpec,
    PetalsSpec,
    PlaceSpec,
    PlanetarySpec,
    PointingSpec,
    RateEvent,
    RotorSpec,
    ScalesSpec,
    Scenario,
    SensorSpec,
    ShapeSpec,
    TemperatureSpec,
    TemperatureTable,
    ThermalBearing,
    TimeEvent,
)
from antenna_pin.scenario._class_tables import CONTROLLER_SPECS
from antenna_pin.scenario.clearance import CLEARANCES
from antenna_pin.scenario.parameters import ParameterSpec
from antenna_pin.scenario.requirements import RequirementSpec

#: Title of each page of tables.
GROUPS = {
    "mechanism": "Mechanism",
    "play": "Joints with play",
    "driven": "Drives, references and controllers",
    "outside": "Forces, shaken base, events",
    "elements": "Elements at joints",
    "run": "Start, run, result",
}


@dataclass(frozen=True)
class Part:
    """A table of a scenario."""

    title: str  # its head, as a file has it
    line: str  # what it is, for the overview
    # Its keys, or those of each of its kinds.
    rows: list[Row] | dict[str, list[Row]] = field(default_factory=list)
    more: str = ""  # what else is to be said of it
    said: Mapping[str, str] = field(default_factory=dict)  # what each kind is, in a line


# --- tables that have kinds ---


def _choice(kinds: Mapping[str, Any], default: str = "required") -> Row:
    return Row("`kind`", ", ".join(f"`{kind}`" for kind in kinds), default, "")


def _with_file(row: Row) -> Row:
    """Return a row whose list a file may give instead: it is not required."""
    listed = row.kind.startswith("list of") and row.default == "required"
    return row._replace(default="") if listed else row


def _family(name: str) -> tuple[dict[str, list[Row]], dict[str, str]]:
    """Return the rows of each kind of a family of elements, and what each is."""
    specs: Mapping[str, Any] = {"drives": DRIVE_SPECS, "springs": SPRING_SPECS}.get(name, FAMILY_SPECS[name])
    rows = {}
    for kind, cls in specs.items():
        own = keys_of(cls, without=("joint", "motion", "kind", "first", "second"))
        filed = any(row.key == "`file`" for row in own)
        rows[kind] = said_once([_with_file(row) for row in own] if filed else own)
    return rows, {kind: first_line(cls) for kind, cls in specs.items()}


def _family_part(name: str, line: str, more: str = "", said: Mapping[str, str] | None = None) -> Part:
    """Return the table of a family of elements."""
    rows, own = _family(name)
    default = FAMILIES[name].default
    kinds = f"`kind` is one of these{f'; `{default}` where it is left out' if default in rows else ''}. "
    return Part(f"[{name}.NAME]", line, rows, more=kinds + more, said=own | dict(said or {}))


def _columns(kinds: Mapping[str, Any], kind: str) -> str:
    """Return the columns of the file that a kind's table may name, as a page shows them."""
    return ", ".join(f"`{name}`" for name in kinds[kind].columns)


_SPRINGS = {
    "spring": "A linear spring and damper at a joint",
    "friction": "Friction at a joint, beside that of `[mechanism.joints]`; events can change or switch it",
    "between-points": "Draws two points together or apart "
    "([more](../closed-loops.md#springs-between-points)); "
    "the default where `first` and `second` are given",
    "bouc-wen": "Hysteresis after Bouc and Wen ([formula](../theory/elements.md#bouc-wen-of-springs))",
    "maxwell-slip": "Springs side by side that slip each at a torque of its own; holds at rest, without "
    "creep",
    "constant-torque": "A tape spring or a clock's",
    "table": "Torque over angle, from numbers or a [`file`](../tables.md) with the columns "
    f"{_columns(FAMILIES['springs'].kinds, 'table')}",
    "harness": "A table for each direction, or a [`file`](../tables.md) with the columns "
    f"{_columns(FAMILIES['springs'].kinds, 'harness')}",
}
_DRIVES = {
    "constant": "A constant torque (force)",
    "sine": "A torque that swings",
    "table": "A torque over time; its [`file`](../tables.md) has the columns "
    f"{_columns(FAMILIES['drives'].kinds, 'table')}",
    "pd": "kp (reference - angle) + kd (its rate - rate), at most `limit` either way; the reference is "
    "the sum "
    "of all that is given, its [`file`](../tables.md) has the columns "
    f"{_columns(FAMILIES['drives'].kinds, 'pd')}",
    "motion": "Holds the joint to a given motion, the sum of all that is given; its [`file`](../tables.md) "
    f"has the columns {_columns(FAMILIES['drives'].kinds, 'motion')}",
}
_CONTROLLERS = {
    "pid": "u = kp e + I + D + f, limited in rate, then in size ([more](../control.md#pid))",
    "state-feedback": "u = f - K (y - r) + C z, z' = A z + B (y - r) + G u "
    "([more](../control.md#state-feedback))",
    "attitude": "The base's quaternion and rate, by wheels ([more](../control.md#attitude))",
    "bang-bang": "On, off, or on the other way ([more](../control.md#bang-bang))",
}


def _clearance_rows() -> list[Row]:
    """Return the rows of a joint with play: what is required depends on the model."""
    classes = dict.fromkeys(CLEARANCES.values())
    found = []
    for name in ContactClearance.model_fields:
        if name in ("model", "normal", "radial", "axial", "friction"):
            continue
        needing = [cls for cls in classes if cls.model_fields[name].is_required()]
        said = ", ".join(get_args(cls.model_fields["model"].annotation)[0] for cls in needing)
        found += keys_of((needing or [ContactClearance])[0], name, required=f"required for {said}")
    return found


def _clearance_models() -> dict[str, str]:
    """Return what each model of a joint is."""
    found = {}
    for cls in dict.fromkeys(CLEARANCES.values()):
        own = dimensions_of(cls.shape_class).items() if hasattr(cls, "shape_class") else ()
        other = [f"`{one.key}` is the {name.replace('_', ' ')}" for name, one in own if one.key != name]
        said = "; ".join((first_line(cls), *other))
        found["` or `".join(get_args(cls.model_fields["model"].annotation))] = said
    return found


def _coupling_rows(cls: type[Any]) -> list[Row]:
    """Return the rows of a coupling of three joints."""
    first = keys_of(cls, "carrier", required="the coupling's name")
    return [*first, *keys_of(cls, without=("kind", "carrier"))]


def _event_rows() -> dict[str, list[Row]]:
    """Return the rows of each kind of event."""
    found = {}
    for kind, cls in _EVENTS.items():
        own = keys_of(cls, without=("kind", "motion"))
        own = [row._replace(kind="one or more s") if row.key == "`time`" else row for row in own]
        found[kind] = [
            row._replace(kind="the key's unit", default="where something is set")
            if row.key == "`to`"
            else row
            for row in own
        ]
    return found


_EVENTS: dict[str, type[Any]] = {
    "angle": AngleEvent,
    "rate": RateEvent,
    "time": TimeEvent,
    "gap": GapEvent,
    "force": ForceEvent,
    "change": ChangeEvent,
}
_FLEXIBLE: dict[str, type[Any]] = {"modes": ModesSpec, "petals": PetalsSpec, "modal-data": ModalDataSpec}


# --- the groups ---


def _mechanism() -> list[Part]:
    simple = [name for name in Scenario.model_fields if name in ("format", "title", "source", "duration")]
    default_case = Row("`default_case`", "text", "", "The case that is run where none is named")
    *first, last = (f"`{name}`" for name in MATERIALS)
    flexible = {
        kind: keys_of(cls, without=("link", "kind", "modes", "places", "reading"))
        for kind, cls in _FLEXIBLE.items()
    }
    flexible["modal-data"] = [_with_file(row) for row in flexible["modal-data"]]
    ratio = keys_of(CouplingSpec, without=("kind", "follower", "motion", "conversion"))
    follower = Row("`follower`", "text", "the coupling's name", "Name of the joint that follows")
    return [
        Part("Top of the file", "format, title, duration", [*keys_of(Scenario, *simple), default_case]),
        Part("[mechanism]", "URDF, base, gravity", keys_of(MechanismSpec, without=("links", "joints"))),
        Part(
            "[mechanism.links.LINK]",
            "mass, inertia and mass centre of a link, in place of the URDF's",
            keys_of(LinkSpec, without=("shapes",)),
        ),
        Part("[mechanism.links.LINK.shapes.NAME]", "size of a visual shape", keys_of(ShapeSpec)),
        Part(
            "[mechanism.joints.JOINT]",
            "kind, frame, bounds, damping and friction of a joint, in place of the URDF's",
            keys_of(JointSpec, without=("motion",)),
            more="`damping` c and `friction` T, else those of the URDF's `<dynamics>`, act as "
            "-c w - T sign(w), and T holds what it sticks, as `[frictions.NAME]`. Where a joint has play or "
            "no axis of its own, is moved by a motion, or has `sticks = false` or a "
            "`regularisation_speed` w_r, T is rounded off, -c w - T w / sqrt(w² + w_r²): a load L below T "
            "creeps at w_r L / sqrt(T² - L²), and a run says so. Their loss is the entry "
            "`JOINT.dynamics`. At a joint with play they act about its axis *beside* the friction of its "
            "contacts; "
            "`friction = 0` leaves that alone. A joint without an axis has none of them, and a run says "
            "so. Little inertia I behind much friction that is rounded off is stiff (time scale w_r I / T): "
            "`radau5`, or a larger `regularisation_speed` w_r.",
        ),
        Part(
            "[materials.NAME]",
            "elastic constants of a material that is not known, or in place of one",
            keys_of(MaterialSpec),
            more=f"Known are {', '.join(first)} and {last}; `antenna-pin contact list` prints their numbers.",
        ),
        Part(
            "[flexible.NAME]",
            "a rigid link made a hub with elastic parts on springs ([more](../flexible.md))",
            {kind: [Row("`link`", "text", "the table's name", ""), *own] for kind, own in flexible.items()},
            said={kind: first_line(cls) for kind, cls in _FLEXIBLE.items()},
        ),
        Part(
            "[flexible.NAME.modes.MODE]", 'a mode of `kind = "modes"`', keys_of(ModeSpec, without=("motion",))
        ),
        Part(
            "[closures.NAME]",
            "a joint that closes a loop ([more](../closed-loops.md))",
            keys_of(ClosureSpec, without=("first", "second")),
        ),
        Part(
            "[closures.NAME.first], [closures.NAME.second]", "the two sides of a closure", keys_of(AnchorSpec)
        ),
        Part(
            "[couplings.NAME]",
            "a joint that follows others, as by `<mimic>` ([more](../closed-loops.md#coupled-joints))",
            {
                "ratio": [follower, *ratio],
                "differential": _coupling_rows(DifferentialSpec),
                "planetary": _coupling_rows(PlanetarySpec),
            },
            more="`kind` is one of these; `ratio` where it is left out. A follower that is locked drops it.",
        ),
        Part(
            "[rotors.NAME]",
            "the rotor of a motor, a body geared to its joint",
            [
                Row("`joint`", "text", "the rotor's name", "Name of the joint that it turns with"),
                *keys_of(RotorSpec, without=("joint",)),
            ],
            more="Its joint is called `NAME_rotor`; what its carrier feels of it, gyroscopic torques too, "
            "is exact.",
        ),
    ]


def _play() -> list[Part]:
    return [
        Part(
            "[clearance.JOINT]",
            "model, dimensions and materials of a joint with play",
            {"": _clearance_rows()},
            more="`model` is required, and one of these:",
            said=_clearance_models(),
        ),
        Part(
            "[clearance.JOINT.normal]",
            "the law of contact, of all contacts of the joint",
            [
                Row(
                    "`law`",
                    "name of an [elastic law](../theory/laws.md#elastic-laws) or a "
                    "[law as a whole](../theory/laws.md#laws-as-a-whole)",
                    "required",
                    "",
                ),
                Row(
                    "`dissipation`",
                    "name of a [dissipation](../theory/laws.md#dissipation)",
                    "`none`",
                    "beside an elastic law; its parameters stand in the same table",
                ),
            ],
            more="Beside `law` stand its own [parameters](../theory/laws.md#parameters). "
            "`[clearance.JOINT.radial]` and "
            "`[clearance.JOINT.axial]` change any of them for the bore or the flanges.",
        ),
        Part(
            "[clearance.JOINT.friction]",
            "the law of friction",
            [Row("`law`", "name of a [law of friction](../theory/laws.md#friction)", "required", "")],
            more="Beside `law` stand its own [parameters](../theory/laws.md#parameters). Without a table "
            "there is none.",
        ),
    ]


def _driven() -> list[Part]:
    references = {kind: keys_of(cls, without=("motion", "kind")) for kind, cls in REFERENCE_SPECS.items()}
    references["table"] = [_with_file(row) for row in references["table"]]
    controllers = {}
    for kind, spec in CONTROLLER_SPECS.items():
        left = ("kind", "motion", "sensor", "rate_sensor", "sensors")
        controllers[kind] = keys_of(spec, without=left)
    return [
        _family_part(
            "drives",
            "torque, given motion, controller or motor at a joint",
            "At a joint with play the angle is the motion angle; angles count whole turns; a table covers "
            "the run. "
            "Steps end where a limit is met. In the result: `drive_torque`, `control_reference`, "
            "`control_error`.",
            _DRIVES,
        ),
        Part(
            "[references.NAME]",
            'a course over time, followed by `follows = "NAME"` ([more](../references.md))',
            {kind: [_choice(REFERENCE_SPECS), *own] for kind, own in references.items()},
            more="Units are those of the joint that follows it; a [`file`](../tables.md) "
            f"has the columns {_columns(REFERENCES, 'table')}.",
        ),
        Part(
            "[controllers.NAME]",
            "a sampled controller, at instants phase + k period ([more](../control.md))",
            {kind: [_choice(controllers), *own] for kind, own in controllers.items()},
            said=_CONTROLLERS,
        ),
        Part(
            "[controllers.NAME.sensor], [controllers.NAME.rate_sensor], [[controllers.NAME.sensors]]",
            "bias, noise and resolution of what it measures",
            keys_of(SensorSpec),
            more="Of `pid` and `bang-bang` one each; of `state-feedback` one for each measure, or one for "
            "all.",
        ),
    ]


def _outside() -> list[Part]:
    return [
        _family_part("forces", "a force, thruster or gravity gradient on a link ([more](../forces.md))"),
        _family_part("shake", "a shaken base ([more](../vibration.md))"),
        Part(
            "[events.NAME]",
            "what is located, marked, or ends the run or sets a number ([more](../python.md#events))",
            {kind: [_choice(_EVENTS), *own] for kind, own in _event_rows().items()},
            said={kind: first_line(cls) for kind, cls in _EVENTS.items()},
        ),
    ]


def _elements() -> list[Part]:
    return [
        _family_part("springs", "springs, dampers, hysteresis, friction that does not stick", said=_SPRINGS),
        Part(
            "[springs.NAME.first], [springs.NAME.second], [forces.NAME.at]",
            "points between which a spring acts, or at which a force does",
            keys_of(PlaceSpec),
        ),
        _family_part("stops", "end stops ([more](../stops.md))"),
        _family_part("latches", "latches ([more](../stops.md))"),
        _family_part("frictions", "dry friction that sticks, or has bristles ([more](../elements.md))"),
        _family_part("gears", "gears, racks, belts, cables, with play ([more](../elements.md))"),
        _family_part("bearings", "ball bearings and preload ([more](../elements.md))"),
    ]


def _run() -> list[Part]:
    return [
        Part(
            "[initial.joints.JOINT]",
            "where a joint starts, and how fast; zero by default",
            keys_of(InitialJointSpec, without=("motion",)),
        ),
        Part("[initial.base]", "where the base starts, and how fast", keys_of(InitialBaseSpec)),
        Part(
            "[integrator]", "engine, method, tolerance, limits", keys_of(IntegratorSpec, without=("scales",))
        ),
        Part("[integrator.scales]", "what errors are measured against", keys_of(ScalesSpec)),
        Part(
            "[output]",
            "when samples are taken",
            keys_of(OutputSpec),
            more="`times` are met to the bit, stand beside those of the `rate`, and change no step.",
        ),
        Part(
            "[temperature]",
            "temperatures of the parts: play, lengths, preload follow ([more](../fits.md))",
            [
                *keys_of(TemperatureSpec, without=("parts", "tables", "bearings")),
                Row("`parts`", "K", "", "Of links, a table by their names"),
            ],
            more='One temperature for all parts is `temperature = "60 degC"`.',
        ),
        Part(
            "[temperature.tables.NAME]",
            "a number of the scenario over temperature",
            keys_of(TemperatureTable),
        ),
        Part(
            "[temperature.bearings.NAME]",
            "materials around a pair of ball bearings, whose preload follows",
            keys_of(ThermalBearing),
        ),
        Part(
            "[tolerances.NAME]",
            "a chain of dimensions and the play that it leaves ([more](../fits.md))",
            keys_of(ChainSpec, without=("dimensions",)),
        ),
        Part(
            "[tolerances.NAME.dimensions.NAME]",
            "a dimension of a chain with its limits",
            keys_of(DimensionSpec),
        ),
        Part(
            "[pointing]",
            "what looks where, for [analysis](../pointing.md) only",
            keys_of(PointingSpec, without=("orbit",)),
        ),
        Part("[pointing.orbit]", "the circular orbit of a commanded direction", keys_of(OrbitSpec)),
        Part(
            "[uncertain.NAME]",
            "uncertain numbers, for [verification](../verification.md)",
            keys_of(ParameterSpec, without=("start", "stop", "count", "zip")),
            more="One of `values`, `between`, `distribution`, `tolerance`.",
        ),
        Part(
            "[requirements.NAME]",
            "what has to be shown ([more](../verification.md))",
            keys_of(RequirementSpec),
        ),
        Part(
            "[cases.NAME]",
            "variants, each laid over all of the above",
            [
                Row("`description`", "text", "", "A line for `antenna-pin list`"),
                Row("`base`", "name of a case", "", "That this one builds on, laid over the tables first"),
                Row("any other", "", "", "Laid over the tables; `replace = true` in one replaces its like"),
            ],
        ),
    ]


_PARTS: dict[str, Callable[[], list[Part]]] = {
    "mechanism": _mechanism,
    "play": _play,
    "driven": _driven,
    "outside": _outside,
    "elements": _elements,
    "run": _run,
}


# --- pages ---


def _anchor(title: str) -> str:
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def page_of(group: str) -> str:
    """Return the tables of a group, each under its heading."""
    lines = []
    for part in _PARTS[group]():
        line = part.line[:1].upper() + part.line[1:]
        lines += [f"## {part.title}", "", f"{line}. {part.more}".strip(), ""]
        if isinstance(part.rows, dict):
            lines += kinds_of(part.rows, part.said)
        else:
            lines += listed(part.rows)
    # Links of docstrings lead from docs/, where this page's folder lies.
    return re.sub(r"\]\((?=[\w-]+\.md)", "](../", "\n".join(lines))


def overview() -> str:
    """Return every table of a scenario with a line each, group by group."""
    lines = []
    for group, title in GROUPS.items():
        lines += [f"**[{title}](reference/scenario-{group}.md)**", ""]
        for part in _PARTS[group]():
            link = f"reference/scenario-{group}.md#{_anchor(part.title)}"
            title = f"`{part.title}`" if "[" in part.title else part.title
            lines.append(f"- [{title}]({link}): {part.line.replace('](../', '](')}")
        lines.append("")
    return "\n".join(lines)
