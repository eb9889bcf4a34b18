"""Adjustable numbers of a scenario, with sensible ranges."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import Any

from antenna_pin.base.arguments import takes
from antenna_pin.base.parameters import parameters_of
from antenna_pin.base.readable import GIVEN, bare, readable
from antenna_pin.base.units import quantity
from antenna_pin.joints.geometry.dimension import dimensions_of
from antenna_pin.scenario import LawChange, LawSpec, Scenario, TouchingSpec
from antenna_pin.scenario.laws import declared_parameters, laws, needs_materials, unit_of
from antenna_pin.scenario.merge import key_of

# How far a number may be turned, as a factor either way: a stiffness, anything else that is positive.
_WIDE, _USUAL = 100.0, 20.0
# Parts of the bore's radius that a play may come to.
_WIDEST_PLAY = 0.5
# Three digits are what a slider sets: a file of them can be read.
_DIGITS = 3
# The same number another way, or one that makes another unit of its neighbour's.
_LEFT = frozenset({"exponent", "poisson", "on", "bearing_radius", "journal_radius", "length"})
# Units that angles are written in as well.
_OTHERS = {
    "rad": ("deg",),
    "rad/s": ("deg/s", "rpm"),
    "rad/s**2": ("deg/s**2",),
    "N*m/rad": ("N*m/deg",),
    "N*m*s/rad": ("N*m*s/deg",),
}
# Of a table's name: of springs a spring, of latches a latch.
_PLURAL = re.compile(r"(?<=ch)es$|s$")
_FROM_0_TO_1 = frozenset({"restitution", "efficiency", "efficiency_back"})


@dataclass(frozen=True, slots=True)
class Knob:
    """Adjustable number.

    Attributes:
        group: Name of its group.
        name: Description.
        place: Where the scenario has it: ``clearance.elevation.radial_clearance``.
        unit: SI unit, as a scenario writes it.
        value: What the scenario has [unit].
        low: Least value of the slider [unit].
        high: Greatest [unit].
        logarithmic: Whether the slider goes by factors.
        start: What stands at the place is ``start + factor * value``: a journal's radius, for a play [unit].
        factor: Likewise [-].
        beside: Further values to set with it, by place.
    """

    group: str
    name: str
    place: str
    unit: str
    value: float
    low: float
    high: float
    logarithmic: bool
    start: float = 0.0
    factor: float = 1.0
    beside: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))

    def settings(self, value: float) -> dict[str, Any]:
        """Return what is laid over the scenario for a value [unit], by place."""
        return {**self.beside, self.place: self.start + self.factor * value}

    def read(self, text: str) -> float:
        """Return a value that is typed, a number in SI units or with a unit.

        Raises:
            QuantityError: It is none, or of another dimension.
        """
        plain = text.replace("\N{MINUS SIGN}", "-").replace("\N{NO-BREAK SPACE}", " ")
        return quantity(bare(plain), self.unit, self.place)

    def display_text(self, value: float) -> str:
        """Return a value as displayed and typed: ``0.2 mm``."""
        unit, factor = self._written
        if unit == self.unit and self._is_plain:
            return readable(value, self.unit, GIVEN).replace("\N{NO-BREAK SPACE}", " ")
        return f"{value / factor:.{GIVEN}g} {unit}".removesuffix(" 1").replace("**", "^")

    @property
    def _written(self) -> tuple[str, float]:
        """Unit in which the scenario's value has fewest digits, and its SI size."""
        units = [(unit, quantity(f"1 {unit}", self.unit, self.place)) for unit in _OTHERS.get(self.unit, ())]
        return min([(self.unit, 1.0), *units], key=lambda one: _digits(self.value / one[1]))

    @property
    def _is_plain(self) -> bool:
        """Return whether the unit takes prefixes and reads the same when printed."""
        return self.unit in ("m", "s", "N", "Hz", "Pa", "rad", "1")

    def to_slider(self, value: float) -> float:
        """Return the slider's place from 0 to 1, an end for values beyond the range."""
        if self.logarithmic:
            value = max(value, self.low)
            share = math.log(value / self.low) / math.log(self.high / self.low)
        else:
            share = (value - self.low) / (self.high - self.low)
        return min(max(share, 0.0), 1.0)

    def from_slider(self, share: float) -> float:
        """Return the value for a slider at 0 to 1, in three digits."""
        if self.logarithmic:
            value = self.low * (self.high / self.low) ** share
        else:
            value = self.low + share * (self.high - self.low)
            if abs(value) < 0.5 * (self.high - self.low) * 10.0**-_DIGITS:
                return 0.0
        unit, factor = self._written
        return self.read(f"{value / factor:.{_DIGITS - 1}e} {unit}")


def _digits(value: float) -> int:
    """Return the number of significant digits that are displayed."""
    return len(f"{value:.{GIVEN - 1}e}".partition("e")[0].replace(".", "").strip("-0"))


def play_names(scenario: Scenario) -> list[str]:
    """Return the joints of a scenario whose journal touches the bearing."""
    return [name for name, one in scenario.clearance.items() if isinstance(one, TouchingSpec)]


@takes()
def knobs_of(scenario: Scenario, joint: str | None = None, sliding: Collection[str] = ()) -> list[Knob]:
    """Return the knobs of a joint's play, laws and elements, and of all drives.

    Args:
        scenario: The scenario.
        joint: The joint; without one drives alone.
        sliding: Joints that slide, where the scenario's units do not state this.
    """
    found = [*_of_play(scenario, joint), *_of_laws(scenario, joint)]
    for family, elements in scenario.families.items():
        for name, spec in elements.items():
            if family == "drives" or joint in _joints(spec):
                found += _of_element(family, name, spec, sliding)
    found += _of_start(scenario, sliding)
    return found


def _joints(spec: Any) -> tuple[Any, ...]:
    """Return the joints that an element acts at."""
    return tuple(getattr(spec, key, None) for key in ("joint", "input", "output"))


def _ranged(value: float, wide: float = _USUAL) -> tuple[float, float, bool]:
    """Return ends of a range about a value, and whether it goes by factors."""
    if value > 0.0:
        return value / wide, value * wide, True
    reach = 3.0 * abs(value) or 1.0
    return -reach, reach, False


def _ranged_by(key: str, value: float, *wide: str) -> tuple[float, float, bool]:
    """Return the range of a number by its key; wider of stiffness or ``wide``."""
    if key in _FROM_0_TO_1:
        return 0.0, 1.0, False
    return _ranged(value, _WIDE if key in ("stiffness", *wide) else _USUAL)


def _words(key: str) -> str:
    return key.replace("_", " ")


def _of_play(scenario: Scenario, joint: str | None) -> Iterator[Knob]:
    """Yield how much play a joint has, whichever way its table gives it."""
    spec = scenario.clearance.get(joint or "")
    if not isinstance(spec, TouchingSpec):
        return
    # Key that stands in the table: name, and start and factor of the play that it makes.
    sizes: dict[str, tuple[str, float, float]] = {}
    hollow, given = [], spec.sizes()
    for play in spec.shape_class.plays:
        if play.key:
            name = dimensions_of(spec.shape_class)[play.decides].key
            start, sign = (given[play.inner], 1.0) if play.along else (given[play.outer], -1.0)
            sizes[play.key] = (play._replace(name="").words, 0.0, 1.0)
            sizes[name] = (play.words, start, sign * play.share)
            hollow += [] if play.along else [start]
    widest, shown = _WIDEST_PLAY * min(hollow), {*sizes}
    if spec.fit is not None:  # its radii follow from places in the zones of hole and shaft
        shown -= {"journal_radius"}
        for key, name in (("fit_hole", "hole in its zone"), ("fit_shaft", "shaft in its zone")):
            place = key_of(("clearance", str(joint), key))
            yield Knob(f"Play in {joint}", name, place, "1", getattr(spec, key), -1.0, 1.0, False)
    for key, (name, start, factor) in sizes.items():
        written = getattr(spec, key)
        if written is None or key not in shown:
            continue
        play = (written - start) / factor
        low, high, logarithmic = _ranged(play)
        if logarithmic:
            high = min(high, max(widest, play))
        else:  # pressed, or with no play: up to what it may be
            low, high = min(2.0 * play, 0.0), 0.05 * widest
        place, ends = key_of(("clearance", str(joint), key)), (low, high, logarithmic)
        yield Knob(f"Play in {joint}", name, place, "m", play, *ends, start, factor)


def _of_laws(scenario: Scenario, joint: str | None) -> Iterator[Knob]:
    """Yield the knobs of a joint's contact and friction laws and their materials."""
    spec = scenario.clearance.get(joint or "")
    if not isinstance(spec, TouchingSpec):
        return
    if needs_materials(spec.radial_law):
        for name in dict.fromkeys(reversed(spec.materials)):
            if name is not None:
                yield _of_material(scenario, name, f"Contact in {joint}")
    for table in ("normal", "radial", "axial", "friction"):
        law: LawSpec | LawChange | None = getattr(spec, table)
        if law is not None:
            yield from _of_law(spec, key_of(("clearance", str(joint), table)), table, law, str(joint))


def _of_law(
    spec: TouchingSpec, place: str, table: str, law: LawSpec | LawChange, joint: str
) -> Iterator[Knob]:
    """Yield the numbers that a law's table gives."""
    frictional = table == "friction"
    known = laws("friction" if frictional else "normal")
    common = spec.normal if spec.normal is not None and not frictional else law
    name = law.law or common.law or ""
    dissipation = law.dissipation or (common.dissipation if name == common.law else None)
    declared = declared_parameters(name, known, dissipation)
    values = {**(common.parameters if name == common.law else {}), **law.parameters}
    for key, value in law.parameters.items():
        if key in _LEFT or key not in declared:
            continue
        unit = unit_of(key, name, known, values, dissipation)
        ends = _ranged_by(key, value, "modulus")
        if frictional and unit == "1" and key not in _FROM_0_TO_1:
            ends = 0.0, max(1.0, 2.0 * value), False
        group = f"{'Friction' if frictional else 'Contact'} in {joint}"
        word = {"radial": "bore, ", "axial": "flanges, "}.get(table, "") + _words(key)
        word += " friction" if frictional and key in ("static", "dynamic") else ""
        yield Knob(group, word, f"{place}.{key}", unit, value, *ends)


def _of_material(scenario: Scenario, name: str, group: str) -> Knob:
    """Return the knob of a material's modulus."""
    material = scenario.material(name)
    place = key_of(("materials", name))
    beside: dict[str, Any] = {}
    if name not in scenario.materials:
        for key in (item.name for item in fields(material) if item.name != "young"):
            if getattr(material, key) not in (None, ""):
                beside[f"{place}.{key}"] = getattr(material, key)
    title, young = f"Young's modulus, {name}", material.young
    ends, more = _ranged(young, _WIDE), MappingProxyType(beside)
    return Knob(group, title, f"{place}.young", "Pa", young, *ends, beside=more)


def _of_element(family: str, name: str, spec: Any, sliding: Collection[str]) -> Iterator[Knob]:
    """Yield the numbers of an element that its table gives, or that are not zero."""
    declared = parameters_of(type(spec).fills)
    slides = getattr(spec, "motion", None) == "translation" or getattr(spec, "joint", None) in sliding
    for key in type(spec).model_fields:
        about = declared.get(type(spec).field_of(key))
        value = getattr(spec, key, None)
        if about is None or about.sizes or key in _LEFT or key == "phase":
            continue
        if not isinstance(value, float) or (value == 0.0 and not about.required):
            continue
        group = f"{_PLURAL.sub('', _words(family)).capitalize()} {name}"
        unit, place = about.sliding if slides and about.sliding else about.unit, key_of((family, name, key))
        yield Knob(group, _words(key), place, unit, value, *_ranged_by(key, value))


def _of_start(scenario: Scenario, sliding: Collection[str]) -> Iterator[Knob]:
    """Yield the speeds that joints start with, where the scenario gives some."""
    for name, spec in scenario.initial.joints.items():
        slides = spec.motion == "translation" or name in sliding
        for key, unit, along in (("velocity", "rad/s", "m/s"), ("rate", "rad/s", "rad/s")):
            value = getattr(spec, key)
            if value:
                place, own = key_of(("initial", "joints", name, key)), along if slides else unit
                yield Knob(f"Start of {name}", _words(key), place, own, value, *_ranged(value))
