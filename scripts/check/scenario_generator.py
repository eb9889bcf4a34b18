"""Random scenarios that make sense: mechanisms of 2 to 8 links, 1 to 3 of whose joints have play.

A scenario follows from a seed and its number alone, however many others are made. What has names (laws, kinds
of joint, loads, backends) is dealt from shuffled decks over the numbers, so that a few hundred scenarios hold
all of it about evenly; what is a number is drawn at random.

A draw is then brought to the speeds of impacts (``scenario_pace.py``). One that is too slow to have impacts
within the time is dropped, and another made.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scenario_pace import DURATIONS, SPEEDS, at_speed, effective_mass, inverse_mass, numbers

from antenna_pin import Scenario, System, build_system
from antenna_pin.contact import (
    DISSIPATIONS,
    FRICTION_LAWS,
    NORMAL_LAWS,
    BaiZhao,
    LineLaw,
    Material,
    effective_modulus,
    internal_hertz_stiffness,
    is_elastic,
    law_parameters,
    normal_parameters,
)
from antenna_pin.scenario.assemble import initial_state

Array = NDArray[np.float64]
Random = np.random.Generator
Table = dict[str, Any]

ATTEMPTS = 60

_KINDS = (*["point"] * 4, *["distributed"] * 3, *["planar"] * 2, *["spherical"] * 2)
_BRISTLES = ("dahl", "lugre", "gonthier-bristle")
_POINT_LAWS = tuple(
    name for name, law in NORMAL_LAWS.items() if not issubclass(law, LineLaw) and law is not BaiZhao
)


def draw_scenario(seed: int, number: int) -> Scenario:
    """Return the scenario of a number: drawn again until impacts happen within its time.

    Raises:
        RuntimeError: Many draws in turn were too slow.
    """
    rng = np.random.default_rng([seed, number])
    for _ in range(ATTEMPTS):
        found = _attempt(seed, number, rng)
        if found is not None:
            return found
    raise RuntimeError(f"scenario {number} of seed {seed}: no draw of {ATTEMPTS} was fast enough")


# --- drawing and dealing -----------------------------------------------------------------------------------


def dealt(options: Sequence[Any], seed: int, what: str, number: int) -> Any:
    """Return an option from shuffled decks laid one after another: each deck holds every option once."""
    deck, place = divmod(number, len(options))
    order = np.random.default_rng([seed, zlib.crc32(what.encode()), deck]).permutation(len(options))
    return options[int(order[place])]


def log_uniform(rng: Random, low: float, high: float) -> float:
    """Return a number whose logarithm is uniform."""
    return float(np.exp(rng.uniform(math.log(low), math.log(high))))


def direction(rng: Random) -> Array:
    """Return a unit vector, all directions alike."""
    vector = rng.normal(size=3)
    unit: Array = vector / np.linalg.norm(vector)
    return unit


def _sign(rng: Random) -> float:
    return 1.0 if rng.random() < 0.5 else -1.0


# --- the mechanism -----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Tree:
    """A mechanism as it was drawn."""

    urdf: str  # its text
    kinds: dict[str, str]  # type of each joint, by name
    play: dict[str, str]  # the joints with play, and what each is: point, distributed, planar or spherical


def _tree(seed: int, number: int, rng: Random) -> _Tree:
    links = dealt(range(2, 9), seed, "links", number)
    serial = dealt((True, False), seed, "topology", number)
    wanted = min(dealt((1, 2, 3), seed, "play", number), links - 1)
    chosen = rng.permutation(np.arange(1, links))[:wanted]
    play = {f"joint{j}": dealt(_KINDS, seed, f"kind {k}", number) for k, j in enumerate(chosen)}
    masses = [log_uniform(rng, 0.2, 500.0) for _ in range(links)]
    masses[0] = max(masses[1:]) * rng.uniform(1.5, 6.0)
    sizes = [(mass / log_uniform(rng, 200.0, 3000.0)) ** (1.0 / 3.0) for mass in masses]
    parts = [_link(rng, f"link{i}", masses[i], sizes[i]) for i in range(links)]
    kinds = {}
    for j in range(1, links):
        parent = j - 1 if serial else int(rng.integers(0, j))
        name = f"joint{j}"
        turning = ("revolute", "continuous")
        kinds[name] = str(rng.choice(turning if name in play else (*turning, "prismatic")))
        at = 0.6 * sizes[parent] * rng.uniform(-1.0, 1.0, 3)
        parts.append(_joint(rng, name, kinds[name], f"link{parent}", f"link{j}", at))
    text = "\n".join([f'<robot name="random{number}">', *parts, "</robot>"])
    return _Tree(text, kinds, play)


def _text(values: Any) -> str:
    return " ".join(repr(float(value)) for value in values)


def _link(rng: Random, name: str, mass: float, size: float) -> str:
    """Return a link that is a homogeneous box, placed and turned at random in its own frame."""
    a, b, c = size * np.exp(rng.uniform(-0.7, 0.7, 3))
    moments = mass / 12.0 * np.array([b * b + c * c, c * c + a * a, a * a + b * b])
    centre, turn = 0.4 * size * rng.uniform(-1.0, 1.0, 3), rng.uniform(-3.0, 3.0, 3)
    named = zip(("ixx", "iyy", "izz"), moments, strict=True)
    inertia = " ".join(f'{key}="{float(value)!r}"' for key, value in named)
    return (
        f'<link name="{name}"><inertial><origin xyz="{_text(centre)}" rpy="{_text(turn)}"/>'
        f'<mass value="{mass!r}"/><inertia {inertia} ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def _joint(rng: Random, name: str, kind: str, parent: str, child: str, at: Array) -> str:
    axis = direction(rng)
    if rng.random() < 0.25:  # along a coordinate axis, as in most files
        axis = np.eye(3)[int(rng.integers(3))] * _sign(rng)
    limit = "" if kind == "continuous" else '<limit lower="-9" upper="9" effort="1e9" velocity="1e9"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{_text(at)}" rpy="{_text(rng.uniform(-3.0, 3.0, 3))}"/><axis xyz="{_text(axis)}"/>'
        f"{limit}</joint>"
    )


# --- one draw ----------------------------------------------------------------------------------------------


def _attempt(seed: int, number: int, rng: Random) -> Scenario | None:
    """Return one draw, brought to the speeds of impacts, or None if it is too slow."""
    tree = _tree(seed, number, rng)
    table = _frame(seed, number, rng, tree)
    clearances = {}
    for k, (name, kind) in enumerate(tree.play.items()):
        materials = {f"{part}_{name}": _material(rng) for part in ("journal", "bearing")}
        table["materials"] |= materials
        clearances[name] = _dimensions(seed, f"{k}", number, rng, name, kind)
        table["initial"]["joints"][name] = _initial_journal(rng, clearances[name])
    hertz = {"normal": {"law": "hertz"}, "load": "point", "geometry": "closed-form"}
    table["clearance"] = {name: {**one, **hertz} for name, one in clearances.items()}
    draft = Scenario.model_validate(table)
    system = build_system(draft)
    speed = log_uniform(rng, *SPEEDS)
    for k, name in enumerate(tree.play):
        mass = effective_mass(draft, system, name)
        pair = [Material(**table["materials"][f"{part}_{name}"]) for part in ("journal", "bearing")]
        laws = _Laws.of(rng, clearances[name], effective_modulus(*pair), mass, speed)
        clearances[name] |= _law_tables(seed, f"{k}", number, laws, tree.play[name])
    table["clearance"] = clearances
    moments = own_inertias(draft, system)
    table["drives"] = _drives(seed, number, rng, tree, moments)
    table["springs"] = _springs(seed, number, rng, tree, moments, table["initial"]["joints"])
    return at_speed(table, speed, rng)


def _frame(seed: int, number: int, rng: Random, tree: _Tree) -> Table:
    """Return a scenario without joints with play, drives and springs."""
    base, heavy = dealt(
        (("free", False), ("free", False), ("free", True), ("fixed", False), ("fixed", True)),
        seed,
        "base",
        number,
    )
    gravity = numbers(rng.uniform(1.0, 9.81) * direction(rng)) if heavy else [0.0, 0.0, 0.0]
    initial: Table = {"joints": {}}
    if base == "free":
        attitude = rng.normal(size=4)
        initial["base"] = {
            "position": numbers(rng.uniform(-1.0, 1.0, 3)),
            "attitude": numbers(attitude / np.linalg.norm(attitude)),
            "velocity": numbers(dealt((0.0, 0.1), seed, "base velocity", number) * direction(rng)),
            "angular_velocity": numbers(rng.uniform(0.0, 0.2) * direction(rng)),
        }
    for name, kind in tree.kinds.items():
        if name not in tree.play:
            slides = kind == "prismatic"
            at = rng.uniform(-0.2, 0.2) if slides else rng.uniform(-3.0, 3.0)
            initial["joints"][name] = {"position": at, "velocity": rng.uniform(-0.5, 0.5)}
    return {
        "title": f"random scenario {number} of seed {seed}",
        "name": f"random{number}",
        "duration": DURATIONS[1],
        "mechanism": {"urdf": "random.urdf", "base": base, "gravity": gravity},
        "materials": {},
        "initial": initial,
        "urdf_text": tree.urdf,
    }


def _material(rng: Random) -> Table:
    return {"young": log_uniform(rng, 1e9, 210e9), "poisson": rng.uniform(0.2, 0.4)}


# --- joints with play --------------------------------------------------------------------------------------


def _dimensions(seed: int, k: str, number: int, rng: Random, name: str, kind: str) -> Table:
    """Return a joint's table without its laws."""
    radius = log_uniform(rng, 3e-3, 30e-3)
    table: Table = {
        "model": kind if kind in ("planar", "spherical") else "contact",
        "bearing_radius": radius,
        "radial_clearance": min(log_uniform(rng, 2e-5, 5e-4), 0.1 * radius),
        "geometry": dealt(("coal", "closed-form"), seed, f"geometry {kind} {k}", number),
        "load": "distributed" if kind == "distributed" else "point",
        "journal_material": f"journal_{name}",
        "bearing_material": f"bearing_{name}",
    }
    if kind != "spherical":
        table["bearing_length"] = radius * rng.uniform(0.5, 6.0)
        table["offset"] = 0.0 if rng.random() < 0.5 or kind == "planar" else radius * rng.uniform(-2.0, 2.0)
    if table["model"] == "contact":
        tight = dealt((True, *[False] * 7), seed, f"axial {k}", number)
        table["axial_clearance"] = 0.0 if tight else log_uniform(rng, 1e-5, 5e-4)
        table["bearing_outer_radius"] = radius * rng.uniform(1.1, 1.7)
        table["flange_radius"] = radius * rng.uniform(1.1, 1.9)
    if kind == "distributed":
        table["strips"] = 2 * int(rng.integers(1, 13))
        table["sectors"] = int(rng.integers(3, 25))
    return table


def _initial_journal(rng: Random, joint: Mapping[str, Any]) -> Table:
    """Return where a journal starts: inside its play, sometimes centred and parallel, at rest or not."""
    play, model = joint["radial_clearance"], joint["model"]
    state: Table = {"angle": rng.uniform(-3.0, 3.0), "rate": rng.uniform(-1.0, 1.0)}
    if rng.random() < 0.15:
        return state
    if model == "spherical":
        state["journal_position"] = numbers(play * rng.uniform(0.0, 0.9) * direction(rng))
        state["journal_tilt"] = numbers(rng.uniform(0.0, 0.3) * direction(rng) * [1.0, 1.0, 0.0])
        state["journal_velocity"] = numbers(rng.uniform(0.0, 0.05) * direction(rng))
        state["journal_angular_velocity"] = numbers(rng.uniform(0.0, 1.0) * direction(rng) * [1.0, 1.0, 0.0])
        return state
    way = rng.uniform(0.0, 2.0 * math.pi)
    across = np.array([math.cos(way), math.sin(way), 0.0])
    speed = rng.uniform(0.0, 0.05) * np.array([*direction(rng)[:2], 0.0])
    if model == "planar":
        state["journal_position"] = numbers(play * rng.uniform(0.0, 0.9) * across)
        state["journal_velocity"] = numbers(speed)
        return state
    axial, half = joint["axial_clearance"], 0.5 * joint["bearing_length"]
    outer = max(joint["bearing_outer_radius"], joint["flange_radius"])
    # Shares of both plays that the tilt takes; the rest is left to the centre.
    tilt = rng.uniform(0.0, 0.4) * min(play / (half + 0.5 * axial), axial / outer)
    position = rng.uniform(0.0, 0.5) * play * across
    position[2] = rng.uniform(-0.5, 0.5) * axial
    turn = rng.uniform(0.0, 2.0 * math.pi)
    state["journal_position"] = numbers(position)
    state["journal_tilt"] = numbers((tilt * math.cos(turn), tilt * math.sin(turn), 0.0))
    if axial > 0.0:
        speed[2] = rng.uniform(-0.02, 0.02)
        spin = rng.uniform(0.0, 0.02) / max(half, outer)
        state["journal_angular_velocity"] = numbers(spin * direction(rng) * [1.0, 1.0, 0.0])
    state["journal_velocity"] = numbers(speed)
    return state


@dataclass(frozen=True, slots=True)
class _Laws:
    """What the parameters of a joint's laws are drawn around."""

    rng: Random  # where they are drawn from
    stiffness: float  # of Hertz's law [N/m^1.5]
    mass: float  # that a contact sees [kg]
    speed: float  # of its impacts [m/s]

    @classmethod
    def of(cls, rng: Random, joint: Mapping[str, Any], modulus: float, mass: float, speed: float) -> _Laws:
        """Return what follows from a joint's dimensions and modulus."""
        radius = joint["bearing_radius"]
        stiffness = internal_hertz_stiffness(radius, radius - joint["radial_clearance"], modulus)
        return cls(rng, stiffness, mass, speed)

    @property
    def depth(self) -> float:
        """Of an elastic impact with Hertz's law [m]."""
        return float((1.25 * self.mass * self.speed**2 / self.stiffness) ** 0.4)

    def normal(self, law: str, dissipation: str | None) -> Table:
        """Return the table of a normal law, with parameters that fit the joint's impacts."""
        rng, depth = self.rng, self.depth
        declared = normal_parameters(law, dissipation)
        table: Table = {"law": law} | ({} if dissipation is None else {"dissipation": dissipation})
        if "exponent" in declared:
            exponent = declared["exponent"].default or 1.5
            if rng.random() < 0.2:
                exponent = float(rng.choice([1.0, 1.5, 1.5, 2.0] if "stiffness" in declared else [1.0, 1.5]))
            table["exponent"] = exponent
            if "stiffness" in declared and (exponent != 1.5 or rng.random() < 0.3):
                table["stiffness"] = self.stiffness * depth ** (1.5 - exponent) * rng.uniform(0.7, 2.0)
        if "restitution" in declared:
            table["restitution"] = 1.0 if rng.random() < 0.1 else rng.uniform(0.3, 1.0)
        if "slope" in declared:
            table["slope"] = rng.uniform(0.05, 0.6) / self.speed
        if "damping" in declared:
            # A share of critical damping for the stiffness at the impact's depth.
            damping = 2.0 * rng.uniform(0.02, 0.3) * math.sqrt(1.5 * self.stiffness * depth**0.5 * self.mass)
            per_root = declared["damping"].unit == "N*s/m**1.5"
            table["damping"] = damping / math.sqrt(depth) if per_root else damping
        if "full_damping_depth" in declared:
            table["full_damping_depth"] = depth * rng.uniform(0.05, 0.5)
        return table

    def friction(self, law: str) -> Table:
        """Return the table of a friction law."""
        rng = self.rng
        dynamic = rng.uniform(0.03, 0.25)
        slow = log_uniform(rng, 5e-4, 2e-2)
        values: dict[str, float] = {
            "static": dynamic * rng.uniform(1.0, 1.6),
            "dynamic": dynamic,
            "coefficient_of_friction": dynamic,
            "static_speed": slow,
            "dynamic_speed": slow * rng.uniform(2.0, 20.0),
            "lower_speed": 0.1 * slow,
            "upper_speed": slow,
            "transition_speed": slow,
            "regularisation_speed": slow,
            "stribeck_speed": 5.0 * slow,
            "decay": rng.uniform(1.0, 100.0),
            "bristle_stiffness": log_uniform(rng, 1e4, 5e5),
            "bristle_damping": log_uniform(rng, 10.0, 300.0),
            "dwell_time": log_uniform(rng, 1e-3, 0.1),
        }
        declared = law_parameters(FRICTION_LAWS[law])
        return {"law": law} | {name: value for name, value in values.items() if name in declared}


def _law_tables(seed: int, k: str, number: int, laws: _Laws, kind: str) -> Table:
    """Return a joint's normal and friction laws, dealt among those that its kind takes."""
    group = "point" if kind == "spherical" else "any"
    law = dealt(_POINT_LAWS if group == "point" else tuple(NORMAL_LAWS), seed, f"law {group} {k}", number)
    dissipation = None
    if is_elastic(law):
        dissipation = dealt((None, *DISSIPATIONS), seed, f"dissipation {k}", number)
    frictions = [name for name in FRICTION_LAWS if kind != "distributed" or name not in _BRISTLES]
    friction = dealt(frictions, seed, f"friction {len(frictions)} {k}", number)
    tables = {"normal": laws.normal(law, dissipation), "friction": laws.friction(friction)}
    if kind in ("point", "distributed") and laws.rng.random() < 0.2:
        other = dealt((None, *DISSIPATIONS), seed, f"axial dissipation {k}", number)
        tables["axial"] = laws.normal("hertz", other) | {"exponent": 1.5, "stiffness": laws.stiffness}
    return tables


# --- what acts ---------------------------------------------------------------------------------------------


def own_inertias(draft: Scenario, system: System) -> dict[str, float]:
    """Return the inertia about (mass along) each joint's axis, all others free [kg m^2] ([kg])."""
    q, _ = initial_state(draft, system)
    inverse = inverse_mass(system, q)
    found = {}
    for name, slot in system.mechanism.joints.items():
        block = inverse[slot.v, slot.v]
        axis = np.ones(1)
        if slot.kind == "floating":
            axis = np.array([0.0, 0.0, 0.0, *slot.axis])
        elif slot.kind == "planar":
            axis = np.array([0.0, 0.0, 1.0])
        found[name] = 1.0 / float(axis @ block @ axis)
    return found


def _acted_on(rng: Random, tree: _Tree, share: float) -> list[str]:
    """Return some joints that a drive or spring can act at, at least one if there is one."""
    able = [name for name in tree.kinds if tree.play.get(name) != "spherical"]
    chosen = [name for name in able if rng.random() < share]
    return chosen or able[:1]


def _drives(seed: int, number: int, rng: Random, tree: _Tree, moments: Mapping[str, float]) -> Table:
    if dealt((False, *[True] * 7), seed, "driven", number) is False:
        return {}
    drives = {}
    for name in _acted_on(rng, tree, 0.5):
        effort = _sign(rng) * log_uniform(rng, 3.0, 60.0) * moments[name]
        kind = dealt(("constant", "sine", "table"), seed, f"drive {name}", number)
        drive: Table = {"joint": name, "kind": kind}
        if name in tree.play:
            drive["axis"] = str(rng.choice(["bearing", "journal"]))
        if kind == "constant":
            drive["value"] = effort
        elif kind == "sine":
            drive |= {"amplitude": effort, "frequency": log_uniform(rng, 5.0, 100.0)}
            drive["phase"] = rng.uniform(0.0, 6.0)
        else:
            knots = int(rng.integers(2, 8))
            drive["time"] = [DURATIONS[1] * i / (knots - 1) for i in range(knots)]
            drive["torque"] = numbers(effort * rng.uniform(-1.0, 1.0, knots))
            drive["interpolation"] = str(rng.choice(["linear", "cubic"]))
        drives[f"drive_{name}"] = drive
    return drives


def _springs(
    seed: int, number: int, rng: Random, tree: _Tree, moments: Mapping[str, float], initial: Mapping[str, Any]
) -> Table:
    if not dealt((False, True), seed, "sprung", number):
        return {}
    springs = {}
    for name in _acted_on(rng, tree, 0.4):
        start = initial[name].get("position", initial[name].get("angle"))
        frequency = 2.0 * math.pi * log_uniform(rng, 1.0, 15.0)
        springs[f"spring_{name}"] = {
            "joint": name,
            "stiffness": moments[name] * frequency**2,
            "damping": 2.0 * rng.uniform(0.0, 0.5) * moments[name] * frequency,
            "rest_angle": start + rng.uniform(-0.02, 0.02),
        }
    return springs
