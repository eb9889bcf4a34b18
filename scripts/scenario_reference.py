"""Every key of a scenario file and every law of contact and friction, as tables of docs/scenario.md.

Meanings are what docstrings say of attributes, units and defaults those of the fields. Written by
``reference.py``.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any, get_args

from pydantic.fields import FieldInfo

from antenna_pin.contact import (
    DISSIPATIONS,
    FRICTION_LAWS,
    MATERIALS,
    NORMAL_LAWS,
    Parameter,
    is_elastic,
    law_parameters,
)
from antenna_pin.elements import FAMILIES
from antenna_pin.parameters import attribute_docs, parameters_of
from antenna_pin.scenario import (
    DRIVE_SPECS,
    FAMILY_SPECS,
    REFERENCE_SPECS,
    SPRING_SPECS,
    AnchorSpec,
    AngleEvent,
    ClearanceSpec,
    ClosureSpec,
    ContactClearance,
    ControllerSpec,
    CouplingSpec,
    DifferentialSpec,
    ForceEvent,
    GapEvent,
    InitialBaseSpec,
    InitialJointSpec,
    IntegratorSpec,
    JointSpec,
    LinkSpec,
    MadeSpec,
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
    TimeEvent,
)

__all__ = ["law_default", "laws_table", "scenario_table"]


# --- what code says of a key ---


def docs_of(cls: type[Any]) -> dict[str, str]:
    """Return what docstrings say of the keys of a table: its own, and those of the class that it fills."""
    docs = attribute_docs(cls)
    if issubclass(cls, MadeSpec):
        filled = attribute_docs(cls.fills)
        docs |= {key: filled[name] for key in cls.model_fields if (name := cls.field_of(key)) in filled}
    return docs


def plain(text: str) -> str:
    """Return what a docstring says of an attribute as a table of keys and units has it."""
    text = re.sub(r"\s*(\[[^\]]*\]\s*(\(\[[^\]]*\]\))?)(?=[.;]|$)", "", text).replace("``", "`")
    for python, file in (
        ("None for ", "if left out, "),
        ("None if ", "left out if "),
        ("None where ", "left out where "),
        ("None to choose it", "if left out, it is chosen"),
    ):
        text = text.replace(python, file)
    text = text.strip(".; ")
    return text[:1].upper() + text[1:] if text.startswith(("if ", "left ")) else text


def annotations(item: Any) -> Iterator[Any]:
    """Yield what stands in an annotation, at any depth."""
    yield item
    for part in get_args(item):
        yield from annotations(part)


def kind_of(field: FieldInfo, parameter: Parameter | None = None) -> str:
    """Return the unit of a field, or what else it holds."""
    if parameter is not None and parameter.sizes == (0,):
        return f"list of {kind_of_units(parameter.units)}"
    for item in (*field.metadata, *annotations(field.annotation)):
        if type(item).__name__ in ("Quantity", "Vector"):
            text = kind_of_units(item.unit)
            sizes = getattr(item, "sizes", ())
            return f"{' or '.join(map(str, sizes))} × {text}" if sizes else text
    choices = [value for item in annotations(field.annotation) for value in get_args(item)]
    choices = [value for value in choices if isinstance(value, str)]
    if choices:
        return ", ".join(f"`{value}`" for value in choices)
    if str in annotations(field.annotation):
        return "list of text" if "tuple" in str(field.annotation) else "text"
    return "list of -" if "tuple" in str(field.annotation) else "-"


def kind_of_units(unit: str | tuple[str, ...]) -> str:
    """Return a unit, or several of which one will do, as the tables have them."""
    units = unit if isinstance(unit, tuple) else (unit,)
    return " or ".join("-" if unit == "1" else unit.replace("**", "^") for unit in units)


def default_of(field: FieldInfo) -> str:
    """Return the default of a field as a file would have it."""
    value = field.default
    if field.is_required():
        return "required"
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:g}"
    return f"`{json.dumps(value)}`" if value != "" else ""


# --- every key of a scenario ---


def rows(cls: type[Any], *names: str, without: tuple[str, ...] = (), required: str = "required") -> list[str]:
    """Return table rows for the keys of a scenario's table: all of them, or those named."""
    docs = docs_of(cls)
    parameters = parameters_of(cls.fills) if issubclass(cls, MadeSpec) else {}
    lines = []
    for name in names or cls.model_fields:
        if name in without:
            continue
        field = cls.model_fields[name]
        text = plain(docs[name]) or name.replace("_", " ")
        kind, default = kind_of(field, parameters.get(name)), default_of(field)
        lines.append(f"| `{name}` | {kind} | {required if default == 'required' else default} | {text} |")
    return lines


def section(title: str, lines: list[str], note: str = "") -> str:
    """Return one of a scenario's tables under its heading."""
    head = ["| key | unit or value | default | meaning |", "|---|---|---|---|"]
    return "\n".join([*heading(title, note), *head, *lines, ""])


def heading(title: str, note: str) -> list[str]:
    """Return the lines above a table: a heading, and what is to be said of it."""
    return [f"### {title}", "", *([note, ""] if note else [])]


def clearance_rows() -> list[str]:
    """Return the rows of a clearance joint: what is required depends on the model."""
    classes = get_args(ClearanceSpec)
    meanings = []
    for cls in classes:
        names = " or ".join(f"`{name}`" for name in get_args(cls.model_fields["model"].annotation))
        meanings.append(f"{names}: {(cls.__doc__ or '').splitlines()[0].rstrip('.').replace('``', '`')}")
    choices = [name for cls in classes for name in get_args(cls.model_fields["model"].annotation)]
    listed = ", ".join(f"`{name}`" for name in choices)
    lines = [f"| `model` | {listed} | required | {'. '.join(meanings)} |"]
    laws = ("normal", "radial", "axial", "friction")
    for name in ContactClearance.model_fields:
        if name == "model" or name in laws:
            continue
        needing = [
            get_args(cls.model_fields["model"].annotation)[0]
            for cls in classes
            if cls.model_fields[name].is_required()
        ]
        first = next((cls for cls in classes if cls.model_fields[name].is_required()), ContactClearance)
        lines += rows(first, name, required=f"required for {', '.join(needing)}")
    return lines


# What is said of each kind of controller.
_CONTROLLERS = {
    "pid": "u = kp e + I + D + f, limited in rate, then in size ([more](control.md#pid)).",
    "state-feedback": "u = f - K (y - r) + C z with z' = A z + B (y - r) + G u "
    "([more](control.md#state-feedback)).",
    "attitude": "The base's quaternion and rate, by wheels ([more](control.md#attitude)).",
    "bang-bang": "On, off, or on the other way ([more](control.md#bang-bang)).",
}


def controller_sections() -> list[str]:
    """Return the tables of controllers, kind by kind, and that of their sensors."""
    kinds = ", ".join(f"`{kind}`" for kind in _CONTROLLERS)
    first = "Measures and commands at instants of its own, phase + k period ([more](control.md))."
    found = [section("[controllers.NAME]", [f"| `kind` | {kinds} | required | What it is |"], first)]
    for spec in get_args(ControllerSpec):
        (kind,) = get_args(spec.model_fields["kind"].annotation)
        left = ("kind", "motion", "sensor", "rate_sensor", "sensors")
        found.append(section(f"[controllers.NAME], {kind}", rows(spec, without=left), _CONTROLLERS[kind]))
    title = "[controllers.NAME.sensor], [controllers.NAME.rate_sensor], [[controllers.NAME.sensors]]"
    return [
        *found,
        section(
            title,
            rows(SensorSpec),
            "Of `pid` and `bang-bang` one each; of `state-feedback` one for each measure, or one for all.",
        ),
    ]


def drive_rows() -> list[str]:
    """Return the rows of a drive: what all have, then what each kind has."""
    lines = [
        "| `joint` | text | the drive's name | Name of the joint |",
        f"| `kind` | {', '.join(f'`{kind}`' for kind in DRIVE_SPECS)} | required | What it is |",
        *rows(next(iter(DRIVE_SPECS.values())), "axis", "on"),
    ]
    for kind, cls in DRIVE_SPECS.items():
        for line in rows(cls, without=("joint", "axis", "on", "motion", "kind")):
            # A list that a file may give instead is required unless there is one.
            line = re.sub(r"(\| list of [^|]*\|) required", r"\1 unless `file`", line)
            lines.append(line.replace("| `", f"| `{kind}`: `", 1))
    return lines


def reference_rows() -> list[str]:
    """Return the rows of a reference: its kind, then what each kind has."""
    lines = [f"| `kind` | {', '.join(f'`{kind}`' for kind in REFERENCE_SPECS)} | required | What it is |"]
    for kind, cls in REFERENCE_SPECS.items():
        for line in rows(cls, without=("motion", "kind")):
            line = (
                re.sub(r"(\| list of [^|]*\|) required", r"\1 unless `file`", line)
                if kind == "table"
                else line
            )
            lines.append(line.replace("| `", f"| `{kind}`: `", 1))
    return lines


# Heading and note of the tables of springs, where they are more than the kind and what it is in a line.
_SPRINGS = {
    "spring": ("", "What stores or loses energy; here a spring and damper at a joint."),
    "friction": (
        " of friction",
        "Friction at a joint, beside what its `<dynamics>` and `[mechanism.joints]` say, and which "
        "events can change or switch.",
    ),
    "between-points": (
        " between points",
        "Draws two points together, or apart ([more](closed-loops.md#springs-between-points)).",
    ),
    "bouc-wen": (
        " with hysteresis (Bouc and Wen)",
        "Torque on the child -alpha k (φ - φ₀) - (1 - alpha) k D z with D z' = A φ' - beta |φ'| |z|ⁿ⁻¹ z "
        "- gamma φ' |z|ⁿ, at any rate the same. It stores alpha k (φ - φ₀)²/2 + (1 - alpha) k D² z²/2A; "
        "the rest is heat, the area of its loop.",
    ),
    "maxwell-slip": (
        " with hysteresis (Maxwell)",
        "Springs side by side, each of which slips at a torque of its own: of a cycle of amplitude X the "
        "heat is the sum of 4 s (X - s/k) of those that slip. It holds at rest, without creep.",
    ),
    "constant-torque": (
        " of constant torque",
        "A tape spring, or a clock's: the same torque from `lower` to `upper`, which falls to none within "
        "`ramp` beyond.",
    ),
    "table": (
        " with a table of torque over angle",
        "Either `file`, a CSV file with the header `angle,torque`, or `angle` and `torque`. The torque is "
        "that on the child; what is stored is its integral.",
    ),
    "harness": (
        " with a table for each direction",
        "Either `file`, a CSV file with the header `angle,torque,torque_back`, or the three as numbers. "
        "On turning back the torque goes from one table to the other within some `reversal`; at rest it "
        "stays where it is, between the two.",
    ),
}


def spring_sections() -> Iterator[str]:
    """Yield a table for each kind of spring; the first says how the others are told from it."""
    for kind, cls in SPRING_SPECS.items():
        title, note = _SPRINGS.get(kind, (f" of kind {kind}", (cls.__doc__ or "").splitlines()[0]))
        lines = rows(cls, without=("joint", "first", "second", "motion", "kind"))
        if "joint" in cls.model_fields:
            lines.insert(0, "| `joint` | text | the spring's name | Name of the joint |")
            if kind != "spring":
                lines.insert(0, f"| `kind` | `{kind}` | required | What it is |")
        if kind == "spring":
            kinds = ", ".join(f"`{one}`" for one in SPRING_SPECS)
            default = "`between-points` with the keys `first` and `second`, else `spring`"
            lines.insert(0, f"| `kind` | {kinds} | {default} | What it is; the others have tables below |")
        yield section(f"[springs.NAME]{title}", lines, note)


def family_sections() -> Iterator[str]:
    """Yield a table for each kind of each family besides drives and springs."""
    for family, specs in FAMILY_SPECS.items():
        if family in ("drives", "springs"):
            continue
        word, default = FAMILIES[family].word, FAMILIES[family].default
        for kind, cls in specs.items():
            given = default if kind == default else "required"
            lines = [
                f"| `kind` | {', '.join(f'`{one}`' for one in specs)} | {given} | What it is |",
                *rows(cls, without=("joint", "motion", "kind")),
            ]
            if "joint" in cls.model_fields:
                lines.insert(1, f"| `joint` | text | the {word}'s name | Name of the joint |")
            title = "" if len(specs) == 1 else f" of kind {kind}"
            yield section(f"[{family}.NAME]{title}", lines, (cls.__doc__ or "").splitlines()[0])


def flexible_rows() -> list[str]:
    """Return the rows of a flexible link: what all have, then what each kind has."""
    kinds = {"modes": ModesSpec, "petals": PetalsSpec, "modal-data": ModalDataSpec}
    said = " ".join(f"`{kind}`: {(cls.__doc__ or '').splitlines()[0]}" for kind, cls in kinds.items())
    lines = [
        "| `link` | text | the table's name | Name of the link |",
        f"| `kind` | {', '.join(f'`{kind}`' for kind in kinds)} | required | {said.rstrip('.')} |",
    ]
    for kind, cls in kinds.items():
        for line in rows(cls, without=("link", "kind", "modes", "places")):
            line = re.sub(r"(\| list of [^|]*\|) required", r"\1 unless `file`", line)
            lines.append(line.replace("| `", f"| `{kind}`: `", 1))
    return lines


def _coupling_rows(kind: str, cls: type[Any]) -> list[str]:
    """Return the rows of a coupling of three joints."""
    lines = rows(cls, "carrier", required="the coupling's name") + rows(cls, without=("kind", "carrier"))
    return [line.replace("| `", f"| `{kind}`: `", 1) for line in lines]


def event_rows() -> list[str]:
    """Return the rows of an event: what all have, then what each kind has."""
    kinds = {"angle": AngleEvent, "rate": RateEvent, "time": TimeEvent, "gap": GapEvent, "force": ForceEvent}
    said = " ".join(f"`{kind}`: {(cls.__doc__ or '').splitlines()[0]}" for kind, cls in kinds.items())
    lines = [f"| `kind` | {', '.join(f'`{kind}`' for kind in kinds)} | required | {said.rstrip('.')} |"]
    for kind, cls in kinds.items():
        names = [name for name in cls.model_fields if name in ("joint", "contact", "time", "value")]
        lines += [line.replace("| `", f"| `{kind}`: `", 1) for line in rows(cls, *names)]
    lines = [line.replace("| list of - | required |", "| one or more s | required |") for line in lines]
    said = "| `to` | the key's unit | where something is set |"
    more = rows(AngleEvent, "direction", "action", "after", "set", "to")
    return lines + [re.sub(r"^\| `to` \|[^|]*\|[^|]*\|", said, line) for line in more]


def _materials() -> str:
    """Return which materials need no table."""
    *first, last = (f"`{name}`" for name in MATERIALS)
    return (
        f"Without a table {', '.join(first)} and {last} are known, with the numbers that "
        "`antenna-pin contact list` prints; a table of the same name takes the place of one."
    )


def scenario_table() -> str:
    """Return every key of a scenario but those of laws, table by table."""
    simple = [name for name in Scenario.model_fields if name in ("format", "title", "source", "duration")]
    parts = [
        section(
            "Top of the file",
            [
                *rows(Scenario, *simple),
                "| `default_case` | text | | The case that is run where none is named |",
            ],
        ),
        section("[mechanism]", rows(MechanismSpec, without=("links", "joints"))),
        section("[mechanism.links.LINK]", rows(LinkSpec, without=("shapes",))),
        section("[mechanism.links.LINK.shapes.NAME]", rows(ShapeSpec), "Looks only."),
        section(
            "[mechanism.joints.JOINT]",
            rows(JointSpec, without=("motion",)),
            "A joint's own `damping` and `friction` are those of its `<dynamics>` in the URDF if they do "
            "not stand here: -c w - T w / sqrt(w² + w_r²), smooth, with the `regularisation_speed` w_r; "
            "it does not stick, unless `sticks = true` makes it a friction of `[frictions]`. "
            "What they take is an entry `JOINT.dynamics` among the losses of springs "
            "and dampers. At a joint with play or held by constraint they act about its axis all the "
            "same, *beside* the friction of its contacts: where that stands for all friction, set "
            "`friction = 0`. A joint made free or planar without contact, or written as floating or "
            "planar, has no axis: a run says that theirs is left out. With little inertia behind much "
            "friction rest is stiff (w_r I / T is the time scale): `radau5`, or a larger speed.",
        ),
        section("[materials.NAME]", rows(MaterialSpec), _materials()),
        section(
            "[clearance.JOINT]",
            clearance_rows(),
            "A revolute or continuous joint of the URDF. Its laws: `[clearance.JOINT.normal]` and"
            " `[clearance.JOINT.friction]`, [below](#contact-laws-and-friction).",
        ),
        section(
            "[flexible.NAME]",
            flexible_rows(),
            "Makes of a rigid link a hub with elastic parts on springs, its mass properties kept"
            " ([more](flexible.md)).",
        ),
        section("[flexible.NAME.modes.MODE]", rows(ModeSpec, without=("motion",)), 'Of `kind = "modes"`.'),
        section(
            "[closures.NAME]",
            rows(ClosureSpec, without=("first", "second")),
            "A joint that closes a loop of the tree ([more](closed-loops.md)).",
        ),
        section("[closures.NAME.first], [closures.NAME.second]", rows(AnchorSpec)),
        section(
            "[couplings.NAME]",
            [
                "| `follower` | text | the coupling's name | Name of the joint that follows |",
                "| `kind` | `ratio`, `differential`, `planetary` | `ratio` | `ratio`: the keys below; "
                "`differential`, `planetary`: their own |",
                *rows(CouplingSpec, without=("kind", "follower", "motion", "conversion")),
                *_coupling_rows("differential", DifferentialSpec),
                *_coupling_rows("planetary", PlanetarySpec),
            ],
            "A joint that follows another, beside those that the URDF couples by `<mimic>`"
            " ([more](closed-loops.md#coupled-joints)). With a `follower` that the scenario locks it is"
            " dropped.",
        ),
        section(
            "[rotors.NAME]",
            [
                "| `joint` | text | the rotor's name | Name of the joint that it turns with |",
                *rows(RotorSpec, without=("joint",)),
            ],
            "The rotor of a motor: a body of its own on a joint `NAME_rotor`, geared to the joint, with a"
            " moment of inertia about the axis alone: what the joint, its carrier and gyroscopic"
            " torques feel of it is exact.",
        ),
        section(
            "[references.NAME]",
            reference_rows(),
            'A course over time that a drive follows, by `follows = "NAME"` of `motion` and `pd`'
            " ([more](references.md)). Units are those of the joint that follows it.",
        ),
        section("[drives.NAME]", drive_rows()),
        *spring_sections(),
        section("[springs.NAME.first], [springs.NAME.second], [forces.NAME.at]", rows(PlaceSpec)),
        *family_sections(),
        section(
            "[events.NAME]",
            event_rows(),
            "Looked for in every step, located to round-off, recorded with a sample of the state"
            " ([more](python.md#events)).",
        ),
        *controller_sections(),
        section(
            "[initial.joints.JOINT]",
            rows(InitialJointSpec, without=("motion",)),
            "Zero where nothing is said.",
        ),
        section("[initial.base]", rows(InitialBaseSpec)),
        section("[integrator]", rows(IntegratorSpec, without=("scales",))),
        section("[integrator.scales]", rows(ScalesSpec)),
        section(
            "[output]",
            rows(OutputSpec),
            "`times` are met to the bit, and change no step: all else of the result stays as it is. They "
            "stand beside those of the `rate`.",
        ),
        section(
            "[pointing]",
            rows(PointingSpec, without=("orbit",)),
            "For [analysis](pointing.md); the motion does not see it.",
        ),
        section("[pointing.orbit]", rows(OrbitSpec), "Circular."),
        section(
            "[cases.NAME]",
            [
                "| `description` | text | | One line for `antenna-pin list` |",
                "| `base` | name of a case | | Case that this one builds on, laid over the tables first |",
                "| any other | | | Laid over the tables above; a table with `replace = true` replaces its"
                " like |",
            ],
        ),
    ]
    return "\n".join(parts)


# --- laws ---


def law_default(name: str, parameters: dict[str, Parameter]) -> str:
    """Return the default of a law's parameter, or where it comes from if a file leaves it out."""
    parameter = parameters[name]
    if parameter.default is not None:
        return f"{parameter.default:g}"
    if not parameter.from_joint:
        return "required"
    if name == "stiffness":
        given = "from materials and radii"
        return given if parameters["exponent"].default == 1.5 else f"required; {given} if exponent is 1.5"
    return {"modulus": "from materials", "effective_mass": "from the contact"}.get(name, "from the joint")


def normal_law_keys() -> list[str]:
    """Return the rows of the keys that a normal law has beside its parameters."""
    names = ", ".join(f"`{name}`" for name in DISSIPATIONS)
    elastic = ", ".join(f"`{name}`" for name in NORMAL_LAWS if is_elastic(name))
    return [
        "| any | `law` | a name below | required | Name of the law |",
        f"| {elastic} | `dissipation` | {names} | `none` | What dissipates beside an elastic law. Its"
        " parameters stand in the same table; they are those of the law of its name below, but for stiffness"
        " and exponent |",
    ]


def law_section(title: str, laws: Any, note: str, keys: list[str]) -> str:
    """Return the parameters of all laws of a kind under their heading."""
    lines = list(keys)
    for law, cls in laws.items():
        parameters = law_parameters(cls)
        for name, parameter in parameters.items():
            unit = "-" if parameter.unit == "1" else parameter.unit.replace("**", "^")
            default = law_default(name, parameters)
            lines.append(f"| `{law}` | `{name}` | {unit} | {default} | {parameter.doc} |")
        if not parameters:
            lines.append(f"| `{law}` | | | | |")
    head = ["| law | parameter | unit | default | meaning |", "|---|---|---|---|---|"]
    return "\n".join([*heading(title, note), *head, *lines, ""])


def laws_table() -> str:
    """Return all normal laws and friction laws with their parameters."""
    normal = law_section(
        "[clearance.JOINT.normal]",
        NORMAL_LAWS,
        "The law of all contacts of the joint; `[clearance.JOINT.radial]` and `[clearance.JOINT.axial]`"
        " change `law`, `dissipation` or parameters for the bore or the flanges.",
        normal_law_keys(),
    )
    friction = law_section(
        "[clearance.JOINT.friction]",
        FRICTION_LAWS,
        "`none` if left out.",
        ["| any | `law` | a name below | required | Name of the law |"],
    )
    return "\n".join([normal, friction])
