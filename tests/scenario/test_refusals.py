"""What is wrong in a file is refused in one line: place, rule, value seen, way out."""

from collections import Counter
from typing import get_args

import pytest
from scenario_files import DELETED, FILE, H

from antenna_pin import contact, load_scenario
from antenna_pin.base.units import describe_unit
from antenna_pin.errors import ScenarioError, UnknownNameError
from antenna_pin.scenario import LawChange, LawSpec
from antenna_pin.scenario.spec import QuantityRule, Spec


@pytest.mark.parametrize("key", ["altitude", "period", "rate"])
def test_an_orbit_is_given_by_the_last_word(folder, key):
    """One of altitude, period and rate, set over the file, takes the place of the file's."""
    for below in ({}, {"pointing.orbit": {"period": "2 h"}}, {"pointing.orbit": {"rate": 0.001}}):
        orbit = folder.load(below, overrides={f"pointing.orbit.{key}": 3.0}).pointing.orbit
        given = {name: getattr(orbit, name) for name in ("altitude", "period", "rate")}
        assert given == {"altitude": None, "period": None, "rate": None} | {key: 3.0}


LN = "law lankarani-nikravesh takes stiffness, restitution, exponent"
WHOLE = "law lankarani-nikravesh brings its own; elastic laws are " + ", ".join(
    name for name in contact.NORMAL_LAWS if contact.is_elastic(name)
)
TOP = (
    "format, title, source, duration, mechanism, materials, clearance, flexible, closures, couplings, "
    "rotors, references, drives, springs, stops, latches, frictions, gears, bearings, shake, forces, events, "
    "controllers, initial, integrator, output, pointing, uncertain, requirements, temperature, tolerances"
)

REFUSALS = [
    # top level
    ({"clearence": {}}, "clearence is unknown; did you mean clearance?"),
    ({"xyzzy": 1}, f"xyzzy is unknown; known here: {TOP}"),
    ({"urdf_text": "x"}, f"urdf_text is unknown; known here: {TOP}, default_case, cases"),
    ({"replace": True}, "replace must be true or false, and belongs in a table of a case or an override"),
    ({"format": 2}, "format must be 1, got 2"),
    # cases
    ({"default_case": 3}, "default_case must be text, got 3"),
    ({"cases": 3}, "cases must be a table, got 3"),
    ({"cases.tight": 3}, "cases.tight must be a table, got 3"),
    ({"cases.tight.description": 3}, "cases.tight.description must be text, got 3"),
    ({"cases.tight.clearanc": {}}, "cases.tight.clearanc is unknown; did you mean clearance?"),
    ({"cases.tight.name": "x"}, f"cases.tight.name is unknown; known here: {TOP}, default_case, cases"),
    (
        {"cases.tight.clearance.hing": {"geometry": "coal"}},
        "cases.tight.clearance.hing.model is missing; give one of contact, planar, spherical, prismatic, "
        "cylindrical, ideal, constraint (or did you mean clearance.hinge?)",
    ),
    (
        {"cases.tight.clearance.hinge.replace": "yes"},
        "cases.tight.clearance.hinge.replace must be true or false, and belongs in a table of a case "
        "or an override",
    ),
    # mechanism
    (
        {"mechanism.urdf": "bdy.urdf"},
        "mechanism.urdf must be an existing file, got 'bdy.urdf'; did you mean body.urdf?",
    ),
    ({"mechanism.base": "floating"}, "mechanism.base must be 'free' or 'fixed', got 'floating'"),
    (
        {"mechanism.gravity": [0, 0, "9.81 m"]},
        "mechanism.gravity[2] must be an acceleration [m/s**2], got '9.81 m' (length)",
    ),
    (
        {"mechanism.allow_impossible_inertia": [3]},
        "mechanism.allow_impossible_inertia[0] must be text, got 3",
    ),
    (
        {"mechanism.links.body.inertia": [1, 2]},
        "mechanism.links.body.inertia must be an array of 3 or 6 numbers [kg*m**2], got [1, 2]",
    ),
    (
        {"mechanism.links.body.shapes.box.size": [1, 0, 1]},
        "mechanism.links.body.shapes.box.size must be positive, got [1.0, 0.0, 1.0]",
    ),
    (
        {"mechanism.joints.azimuth.axis": [0, 0, 0]},
        "mechanism.joints.azimuth.axis must be three finite numbers, not all zero, got [0.0, 0.0, 0.0]",
    ),
    (
        {"mechanism.joints.azimuth.kind": "lockd"},
        "mechanism.joints.azimuth.kind must be 'ideal', 'locked', 'free' or 'planar', got 'lockd'; "
        "did you mean locked?",
    ),
    (
        {"mechanism.joints.hinge.kind": "locked"},
        "mechanism.joints.hinge.kind must be left out: clearance.hinge.model decides it, got 'locked'",
    ),
    # materials
    # joints with play: keys, dimensions
    (
        {H + "model": DELETED},
        "clearance.hinge.model is missing; give one of contact, planar, spherical, prismatic, "
        "cylindrical, ideal, constraint",
    ),
    (
        {H + "model": "contac"},
        "clearance.hinge.model must be one of contact, planar, spherical, prismatic, cylindrical, ideal, "
        "constraint, got 'contac'; did you mean contact?",
    ),
    (
        {H + "radial_clearance": "20 mm"},
        "clearance.hinge.radial_clearance must make journal_radius positive and finite, got 0.02 m, which "
        "makes it -0.01 m",
    ),
    (
        {H + "radial_clearance": DELETED},
        "clearance.hinge must have exactly one of radial_clearance and journal_radius, got neither",
    ),
    (
        {H + "journal_radius": "9.8 mm"},
        "clearance.hinge must have exactly one of radial_clearance and journal_radius, got both",
    ),
    (
        {H + "radial_clearance": DELETED, H + "journal_radius": "11 mm"},
        "clearance.hinge.journal_radius must be below bearing_radius = 0.01 m, got 0.011 m",
    ),
    (
        {H + "axial_clearance": "-0.2 mm"},
        "clearance.hinge.axial_clearance must make flange_distance at least bearing_length = 0.05 m, or for "
        "a hard preload less by at most 0.02 bearing_radius, got -0.0002 m, which makes it 0.0496 m",
    ),
    (
        {H + "flange_distance": "54 mm"},
        "clearance.hinge must have exactly one of axial_clearance and flange_distance, got both",
    ),
    (
        {H + "axial_clearance": DELETED, H + "flange_distance": "40 mm"},
        "clearance.hinge.flange_distance must be at least bearing_length = 0.05 m, or for a hard preload "
        "less by at most 0.02 bearing_radius, got 0.04 m",
    ),
    (
        {H + "bearing_outer_radius": "10 mm"},
        "clearance.hinge.bearing_outer_radius must be above bearing_radius = 0.01 m, got 0.01 m",
    ),
    (
        {H + "flange_radius": "9 mm"},
        "clearance.hinge.flange_radius must be above bearing_radius = 0.01 m, got 0.009 m",
    ),
    (
        {H + "journal_material": DELETED},
        "clearance.hinge.journal_material is missing; it decides the stiffness, or give normal.stiffness",
    ),
    # laws
    (
        {H + "normal": DELETED, H + "axial": {"law": "hertz", "stiffness": 1e9}},
        "clearance.hinge.normal is missing; it names the law of the contact and its parameters",
    ),
    ({H + "normal": DELETED}, "clearance.hinge.axial.law is missing; there is no normal law to change"),
    ({H + "normal": 3}, "clearance.hinge.normal must be a table, got 3"),
    (
        {H + "normal.law": DELETED},
        f"clearance.hinge.normal.law is missing; give one of {', '.join(contact.NORMAL_LAWS)}",
    ),
    (
        {H + "normal": {"law": "johnson", "dissipation": "flores"}, H + "axial": DELETED},
        "clearance.hinge.normal.restitution is missing; law johnson with flores takes length, "
        "journal_radius, bearing_radius, modulus, restitution",
    ),
    (
        {H + "normal": {"law": "hertz", "dissipation": "flores", "restitution": 0}, H + "axial": DELETED},
        "clearance.hinge.normal.restitution must be in (0, 1]; no finite damping of this form stops a body "
        "dead, got 0.0",
    ),
    (
        {H + "normal": {"law": "hertz", "dissipation": "tsuji", "restitution": 1, "effective_mas": 1}},
        "clearance.hinge.normal.effective_mas is unknown; did you mean effective_mass? law hertz with "
        "tsuji takes stiffness, exponent, restitution, effective_mass",
    ),
    (
        {H + "axial": {"dissipation": "flores"}},
        f"clearance.hinge.axial.dissipation must be left out, for {WHOLE}",
    ),
    (
        {H + "friction.dissipation": "flores"},
        "clearance.hinge.friction.dissipation is unknown; law tanh is a friction law and has no dissipation",
    ),
    ({H + "normal.restitution": 1.3}, "clearance.hinge.normal.restitution must be in [0, 1], got 1.3"),
    (
        {H + "model": "ideal", H + "normal.restitution": 1.3},
        "clearance.hinge.normal.restitution must be in [0, 1], got 1.3",
    ),
    (
        {H + "normal.restitution": "0.9 m"},
        "clearance.hinge.normal.restitution must be a pure number, got '0.9 m' (length)",
    ),
    ({H + "normal.restitution": DELETED}, f"clearance.hinge.normal.restitution is missing; {LN}"),
    (
        {H + "normal.restitutoin": 1},
        f"clearance.hinge.normal.restitutoin is unknown; did you mean restitution? {LN}",
    ),
    (
        {H + "normal.stiffness": "1e9 N/m"},
        "clearance.hinge.normal.stiffness must be a stiffness [N/m**1.5], got '1e9 N/m' (stiffness)",
    ),
    (
        {H + "axial.restitutio": 2},
        f"clearance.hinge.axial.restitutio is unknown; did you mean restitution? {LN}",
    ),
    (
        {H + "axial": {"exponent": 2}, H + "normal.stiffness": 1e9},
        "clearance.hinge.axial.stiffness is missing; another exponent changes the unit of the one in normal",
    ),
    (
        {H + "radial": {"law": "lankarani-nikravesh"}, H + "normal": {"law": "hertz"}},
        f"clearance.hinge.radial.restitution is missing; {LN}",
    ),
    (
        {H + "friction.transition_speed": DELETED},
        "clearance.hinge.friction.transition_speed is missing; law tanh takes "
        "coefficient_of_friction, transition_speed",
    ),
    (
        {H + "friction": {"law": "none", "mu": 1}},
        "clearance.hinge.friction.mu is unknown; law none takes no parameters",
    ),
    # drives
    (
        {"drives.motor.kind": "constat"},
        "drives.motor.kind must be one of constant, sine, table, pd, motion, distance, motor, got 'constat'; "
        "did you mean constant?",
    ),
    (
        {"drives.motor.amplitude": 1},
        "drives.motor.amplitude is unknown; known here: kind, joint, axis, on, value",
    ),
    (
        {"drives.motor.motion": "translation"},
        "drives.motor.value must be for a sliding joint, as motion is, got '4 N*m' (turning)",
    ),
    ({"drives.slow.file": DELETED}, "drives.slow must have either file, or time and torque, got neither"),
    (
        {"drives.slow.file": "torqe.csv"},
        "drives.slow.file must be an existing file, got 'torqe.csv'; did you mean torque.csv?",
    ),
    ({"drives.t": {"kind": "table", "time": [0, 1]}}, "drives.t.torque is missing; give an array of numbers"),
    (
        {"drives.t": {"kind": "table", "time": [0, 1], "torque": 3}},
        "drives.t.torque must be an array of numbers, got 3",
    ),
    (
        {"drives.t": {"kind": "table", "time": [0, 1], "torque": [1]}},
        "drives.t.torque must be as many numbers as time, 2, got 1",
    ),
    (
        {"drives.t": {"kind": "table", "time": [0], "torque": [1]}},
        "drives.t.time must be at least 2 numbers, got 1",
    ),
    # springs
    (
        {"springs.azimuth.damping": "1 N*s/m"},
        "springs.azimuth.damping must be for a turning joint, as stiffness is, got '1 N*s/m' (sliding)",
    ),
    (
        {"springs.azimuth": {"rest_angle": 1}},
        "springs.azimuth must have a stiffness or a damping above zero, got neither",
    ),
    # pointing
    (
        {"pointing.boresight": [0, 0, 0]},
        "pointing.boresight must be three finite numbers, not all zero, got [0.0, 0.0, 0.0]",
    ),
    (
        {"pointing.up": [0, 0, 1]},
        "pointing.up must not lie along boresight = [0.0, 0.0, -2.0], got [0.0, 0.0, 1.0]",
    ),
    (
        {"pointing.commanded": "ideal"},
        'pointing.direction must be left out where commanded is "ideal", got [0.0, 0.1, 1.0]',
    ),
    ({"pointing.direction": DELETED}, 'pointing.direction is missing; give it where commanded is "orbit"'),
    (
        {"pointing.direction_up": [0, -0.1, -1]},
        "pointing.direction_up must not lie along direction = [0.0, 0.1, 1.0], got [0.0, -0.1, -1.0]",
    ),
    ({"pointing.orbit": DELETED}, 'pointing.orbit is missing; give it where commanded is "orbit"'),
    (
        {"pointing.orbit.altitude": DELETED},
        "pointing.orbit must have one of altitude, period and rate, got none",
    ),
    (
        {"pointing.orbit": {"altitude": 1, "period": "90 min"}},
        "pointing.orbit must have one of altitude, period and rate, got altitude and period",
    ),
    (
        {"pointing.orbit.nadir": [0, 0, 1]},
        "pointing.orbit.nadir must be perpendicular to normal = [0.0, 0.0, 2.0], got [0.0, 0.0, 1.0]",
    ),
    # initial state
    (
        {"initial.joints.azimuth.velocity": "1 m/s"},
        "initial.joints.azimuth.velocity must be for a turning joint, as position is, got '1 m/s' (sliding)",
    ),
    (
        {"initial.joints.hinge.position": 1},
        "initial.joints.hinge must have at most one of position and angle, got both",
    ),
    (
        {"initial.base.attitude": [0, 0, 0, 2]},
        "initial.base.attitude must be a unit quaternion x, y, z, w, got [0.0, 0.0, 0.0, 2.0] of length 2",
    ),
    ({"mechanism.base": "fixed"}, 'initial.base must be left out where mechanism.base is "fixed"'),
    # integrator
    ({"integrator.min_step": 1}, "integrator.min_step must be below max_step = 0.01 s, got 1 s"),
    (
        {"integrator.first_step": 1},
        "integrator.first_step must be from min_step = 1e-14 s to max_step = 0.01 s, got 1 s",
    ),
]


@pytest.mark.parametrize(("changes", "message"), REFUSALS, ids=[message[:60] for _, message in REFUSALS])
def test_refusals(folder, changes, message):
    assert folder.refusal(changes) == message


def keys_of(table, place=""):
    """Yield place and field of every key that a file may have in a table, and in the tables below."""
    for name, field in type(table).model_fields.items():
        value = getattr(table, name)
        if name in type(table).carried or isinstance(value, LawSpec | LawChange):
            continue
        yield f"{place}{name}", field
        below = value if isinstance(value, dict) else {}
        for key, one in below.items() if below else [("", value)]:
            if isinstance(one, Spec):
                yield from keys_of(one, f"{place}{name}.{key}.".replace("..", "."))


def in_file(place):
    table = FILE
    for key in place.split("."):
        if key not in table:
            return False
        table = table[key]
    return True


def test_every_key_refuses_what_it_does_not_declare(folder):
    """A foreign unit, a number against the rule, a number for a text, and the lack of a required key."""
    counts = Counter()
    for place, field in keys_of(folder.load()):
        kinds = [one for one in get_args(field.annotation) or (field.annotation,) if one is not type(None)]
        annotations = [*field.metadata, *(one for kind in kinds for one in get_args(kind))]
        wrong = [(3, "must be text, got 3")] if kinds == [str] else []
        for quantity in (one for one in annotations if isinstance(one, QuantityRule)):
            wrong.append(("1 cd", f"must be {describe_unit(quantity.unit)}, got '1 cd' (cd)"))
            wrong += [(-1, f"must be {quantity.rule}, got -1")] if quantity.rule else []
        for value, rule in wrong:
            assert folder.refusal({place: value}) == f"{place} {rule}"
        if field.is_required() and in_file(place) and place.split(".")[-1] not in ("kind", "model", "joint"):
            assert folder.refusal({place: DELETED}).startswith(f"{place} is missing")
            counts["required"] += 1
        counts.update("text" if value == 3 else "quantity" for value, _ in wrong)
    assert counts["quantity"] > 60 and counts["text"] > 10 and counts["required"] > 10


def test_every_table_is_one_and_knows_its_keys(folder):
    tables = {place.rpartition(".")[0] for place, _ in keys_of(folder.load())} - {""}
    assert len(tables) >= 20
    for place in filter(in_file, tables):
        assert folder.refusal({place: 3}).startswith(f"{place} must be a table, got 3")
        assert folder.refusal({f"{place}.qqq": 1}).startswith(f"{place}.qqq is unknown; ")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"default_case": "tigth"},
            "default_case: case 'tigth' is unknown; did you mean tight? known: by-radius,",
        ),
        (
            {H + "journal_material": "stel"},
            "clearance.hinge.journal_material: material 'stel' is unknown; did you mean steel? "
            "known: alloy, aluminium-2024-t3,",
        ),
        (
            {H + "normal.law": "lankarani"},
            "clearance.hinge.normal.law: law 'lankarani' is unknown; did you mean "
            "lankarani-nikravesh? known: adams-impact,",
        ),
        (
            {H + "normal.law": "tanh"},
            "clearance.hinge.normal.law: law 'tanh' is unknown; known: adams-impact,",
        ),
        (
            {H + "normal": {"law": "hertz", "dissipation": "floras"}},
            "clearance.hinge.normal.dissipation: dissipation 'floras' is unknown; did you mean flores? "
            "known: adams-impact,",
        ),
        (
            {H + "friction.law": "hertz"},
            "clearance.hinge.friction.law: law 'hertz' is unknown; known: ambrosio,",
        ),
    ],
)
def test_unknown_names(folder, changes, message):
    assert folder.refusal(changes, error=UnknownNameError).startswith(message)


def test_names_of_cases_files_and_tables_in_messages(folder):
    """Known names, where a file was looked for, quotes where a name needs them."""
    message = folder.refusal(case="tigth", error=UnknownNameError)
    assert message == "case 'tigth' is unknown; did you mean tight? known: by-radius, elastic, tight"
    message = folder.refusal({"mechanism.urdf": "sub/x.urdf"})
    where = folder.path.resolve() / "sub"
    assert message == f"mechanism.urdf must be an existing file, got 'sub/x.urdf'; searched in {where}"
    file = FILE | {"clearance": {"my hinge": {"model": "ideal", "bearing_radius": -1}}}
    with pytest.raises(
        ScenarioError, match=r'^my\.toml: clearance\."my hinge"\.bearing_radius must be positive'
    ):
        folder.load(file=file)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: the header must have time,torque, got an empty file"),
        (
            "time,torque [mm]\n0,1\n1,2\n",
            "the unit of column torque must be that of a torque [N*m] or a force [N], got 'mm'",
        ),
        ("time,torque\n0,1\n", "line 2: must have at least 2 rows of numbers, got 1"),
        ("time,torque\n0,1\n1,x\n", "line 3: torque must be a finite number, got 'x'"),
    ],
)
def test_bad_torque_tables_are_refused_with_file_and_line(folder, text, message):
    (folder.path / "bad.csv").write_text(text)
    assert folder.refusal({"drives.slow.file": "bad.csv"}) == f"drives.slow.file: bad.csv, {message}"


@pytest.mark.parametrize("frequency", [0.3, 900.0])
@pytest.mark.parametrize("share", [0.4999, 0.5, 2.0])
def test_an_elastic_frequency_is_below_half_the_output_rate(frequency, share):
    """Slower samples show another one; a result without samples may have any."""
    mode = "flexible.reflector.modes"
    overrides = {f"{mode}.nod.frequency": frequency, f"{mode}.bend.frequency": 0.5 * frequency}
    overrides |= {"output.rate": frequency / share}

    def load(**more):
        return load_scenario("bai2020", case="flexible-ideal", overrides=overrides | more)

    if share < 0.5:
        assert load().output.rate == frequency / share
    else:
        with pytest.raises(
            ScenarioError, match=r"flexible\.reflector\.modes\.nod\.frequency must be below half"
        ):
            load()
    assert load(**{"output.form": "lean"}).output.rate == frequency / share


@pytest.mark.parametrize("name", ["body.urdf", "torque.csv"])
def test_files_that_are_no_text_are_refused(folder, name):
    (folder.path / name).write_bytes(b"\xff\xff")
    place = "mechanism.urdf" if name == "body.urdf" else "drives.slow.file"
    assert folder.refusal() == f"{place} must be UTF-8 text, got '{name}' (byte 0)"
