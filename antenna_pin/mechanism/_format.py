"""What the format of URDFs defines: elements, what each may hold, numbers. A slip in a name is refused.

What the format does not define is other tools' and means nothing here. But a name that is almost one of the
format's own is a slip, and passing over it would change the mechanism: ``<origin xzy="0 0 1"/>`` is a joint
at zero.
"""

from __future__ import annotations

import math
from decimal import Decimal, InvalidOperation
from typing import Any, NamedTuple

from lxml import etree

from antenna_pin.base.numerals import decimal_in
from antenna_pin.errors import MechanismError, nearest
from antenna_pin.mechanism._source import tag_of

__all__ = [
    "FORMAT",
    "MOMENTS",
    "SHAPES",
    "check_names",
    "half_unit",
    "numbers_in",
    "placed",
    "text_in",
]

# Tag of a shape -> its attributes: how many numbers each holds.
SHAPES: dict[str, dict[str, int]] = {
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "mesh": {},
}

MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


class Defined(NamedTuple):
    """What an element may hold."""

    children: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()


FORMAT = {
    "robot": Defined(("link", "joint", "material"), ("name", "version")),
    "link": Defined(("inertial", "visual", "collision"), ("name",)),
    "joint": Defined(
        ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic"),
        ("name", "type"),
    ),
    "inertial": Defined(("origin", "mass", "inertia")),
    "visual": Defined(("origin", "geometry", "material"), ("name",)),
    "collision": Defined(("origin", "geometry"), ("name",)),
    "geometry": Defined(tuple(SHAPES)),
    "material": Defined(("color", "texture"), ("name",)),
    "origin": Defined((), ("xyz", "rpy")),
    "mass": Defined((), ("value",)),
    "inertia": Defined((), MOMENTS),
    "parent": Defined((), ("link",)),
    "child": Defined((), ("link",)),
    "axis": Defined((), ("xyz",)),
    "limit": Defined((), ("lower", "upper", "effort", "velocity")),
    "dynamics": Defined((), ("damping", "friction")),
    "mimic": Defined((), ("joint", "multiplier", "offset")),
    **{shape: Defined((), tuple(numbers)) for shape, numbers in SHAPES.items()},
    "mesh": Defined((), ("filename", "scale")),
    "color": Defined((), ("rgba",)),
    "texture": Defined((), ("filename",)),
}

# Looks, in which a slip changes no mechanism: it is passed over like all that means nothing.
_LOOKS = ("material",)

# Letters by which a name may differ from one of the format and still be a slip of it. Four of five slips are
# one wrong, missing, added or swapped letter (Damerau (1964), Commun. ACM 7(3), 171-176), and most others are
# two. Names of other tools are farther off: of 400 files of 20 packages the nearest one, gear_velocity of
# <limit>, by five letters.
_SLIP = 2

# Names that have a meaning elsewhere and are near by chance: a safety controller's, SDF's, MJCF's, a motor's.
_NO_SLIPS = ("k_velocity", "axis2", "limited", "power")


def numbers_in(text: str | None) -> tuple[float, ...] | None:
    """Return the numbers of an attribute's text, or None where it holds something else."""
    numbers = [decimal_in(word, infinite=True) for word in (text or "").split()]
    known = tuple(number for number in numbers if number is not None)
    return known if len(known) == len(numbers) else None


# Numbers of a joint that a scenario may give in its file's place: how many, and whether they may be infinite.
_OF_JOINTS = {
    "origin": (3, False),
    "axis": (3, False),
    "limit": (1, True),
    "dynamics": (1, False),
}


def broken_numbers(robot: Any, where: str) -> tuple[str, ...]:
    """Return a line for each attribute of a joint that holds something else than its numbers.

    Where it acts it is refused; what is left has been given another value, or has no meaning for its joint.
    """
    return tuple(
        f"{placed(element, where)}: <{element.tag}> {name}={element.get(name)!r} is no number and does not "
        "count; mend it, or take it out"
        for joint in robot.findall("joint")
        for element in joint
        if element.tag in _OF_JOINTS
        for name in FORMAT[element.tag].attributes
        if element.get(name) is not None and not _is_sound(element.get(name), *_OF_JOINTS[element.tag])
    )


def _is_sound(text: str, count: int, infinite: bool) -> bool:
    numbers = numbers_in(text) or ()
    known = not any(math.isnan(one) or (math.isinf(one) and not infinite) for one in numbers)
    return known and len(numbers) == count


def half_unit(text: str | None) -> float:
    """Return half a unit of the last digit behind the point that a number is written with.

    That is how far it may be off. Zeros and whole numbers are exact, and what is no number is not told.
    """
    try:
        number = Decimal((text or "").strip())
        last = number.as_tuple().exponent
    except InvalidOperation:
        return 0.0
    return 0.5 * 10.0**last if number and isinstance(last, int) and last < 0 else 0.0


def placed(element: Any, where: str) -> str:
    """Return file, line and the link or joint that an element belongs to."""
    owner = next(
        (e for e in (element, *element.iterancestors()) if e.tag in ("link", "joint") and e.get("name")), None
    )
    name = "" if owner is None else f": {owner.tag} {owner.get('name')!r}"
    line = f", line {element.sourceline}" if element.sourceline else ""  # none of what a change has made
    return f"{where}{line}{name}"


def check_names(element: Any, where: str) -> None:
    """Refuse names, in an element and below, that are almost ones that the format defines at their place.

    An attribute that is written as an element counts too, and an element as an attribute, and text that
    stands for attributes. Names with a prefix are other tools'.

    Args:
        element: Of the format.
        where: Name of the file, for messages.
    """
    defined = FORMAT[element.tag]
    if not defined.children and (text := text_in(element)):
        raise MechanismError(
            f"{placed(element, where)}: <{element.tag}> must hold no text, got {text!r}; "
            f"write it as attributes ({', '.join(defined.attributes)})"
        )
    for name in element.attrib:
        guess = _meant(name, defined.attributes, element)
        if guess is not None and not _repeats(element, name, guess):
            raise MechanismError(
                f"{placed(element, where)}: attribute {name} of <{element.tag}> is unknown; "
                f"did you mean {_called(guess, defined)}?"
            )
    for child in element.iterchildren(etree.Element):
        guess = _meant(child.tag, defined.children, element)
        if guess is not None:
            raise MechanismError(
                f"{placed(child, where)}: <{tag_of(child)}> in <{element.tag}> is unknown; "
                f"did you mean {_called(guess, defined)}?"
            )
        if child.tag in defined.children and child.tag not in _LOOKS:
            check_names(child, where)


def _meant(name: str, known: tuple[str, ...], element: Any) -> str | None:
    """Return the name of the format that a name which is none is a slip of: rather one that is missing."""
    if name in known or name in _NO_SLIPS or name.startswith("{"):
        return None
    children, attributes = FORMAT[element.tag]
    names = [one for one in (*children, *attributes) if one not in _LOOKS]
    missing = [one for one in names if one not in element.attrib and element.find(one) is None]
    return nearest(name, missing, _SLIP) or nearest(name, names, _SLIP)


def _called(name: str, defined: Defined) -> str:
    return f"<{name}>" if name in defined.children else f"the attribute {name}"


def _repeats(element: Any, name: str, meant: str) -> bool:
    """Whether an attribute says what the one that is meant says too, as iyx does beside ixy."""
    numbers = numbers_in(element.get(name))
    return (
        meant != name
        and meant in element.attrib
        and numbers is not None
        and numbers == numbers_in(element.get(meant))
    )


def text_in(element: Any) -> str:
    """Return the text that stands in an element, without that of elements in it."""
    return " ".join([element.text or "", *(child.tail or "" for child in element)]).strip()
