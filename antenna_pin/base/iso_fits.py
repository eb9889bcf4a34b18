"""Limits and fits of ISO 286: deviations of holes and shafts, and play.

By the rounded tables of the standard, which its formulas miss by up to 14 um, for nominal sizes up to 500 mm,
grades IT1 to IT16 and the letters a to s, A to S.

References:
    ISO 286-1:2010 and ISO 286-2:2010.
"""

from __future__ import annotations

import bisect
import math
import re
from dataclasses import dataclass
from fractions import Fraction

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.errors import InvalidParameterError

# Ranges of nominal sizes, up to and including [mm].
_RANGES = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)
_SUBRANGES = (
    3, 6, 10, 14, 18, 24, 30, 40, 50, 65, 80, 100, 120, 140, 160, 180, 200, 225, 250, 280, 315, 355, 400, 450,
    500,
)  # fmt: skip

# Standard tolerances of the grades [um].
_GRADES: dict[int, tuple[float, ...]] = {
    1: (0.8, 1, 1, 1.2, 1.5, 1.5, 2, 2.5, 3.5, 4.5, 6, 7, 8),
    2: (1.2, 1.5, 1.5, 2, 2.5, 2.5, 3, 4, 5, 7, 8, 9, 10),
    3: (2, 2.5, 2.5, 3, 4, 4, 5, 6, 8, 10, 12, 13, 15),
    4: (3, 4, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20),
    5: (4, 5, 6, 8, 9, 11, 13, 15, 18, 20, 23, 25, 27),
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97),
    9: (25, 30, 36, 43, 52, 62, 74, 87, 100, 115, 130, 140, 155),
    10: (40, 48, 58, 70, 84, 100, 120, 140, 160, 185, 210, 230, 250),
    11: (60, 75, 90, 110, 130, 160, 190, 220, 250, 290, 320, 360, 400),
    12: (100, 120, 150, 180, 210, 250, 300, 350, 400, 460, 520, 570, 630),
    13: (140, 180, 220, 270, 330, 390, 460, 540, 630, 720, 810, 890, 970),
    14: (250, 300, 360, 430, 520, 620, 740, 870, 1000, 1150, 1300, 1400, 1550),
    15: (400, 480, 580, 700, 840, 1000, 1200, 1400, 1600, 1850, 2100, 2300, 2500),
    16: (600, 750, 900, 1100, 1300, 1600, 1900, 2200, 2500, 2900, 3200, 3600, 4000),
}

# Fundamental deviations of shafts [um]: distance of the zone's nearer limit, below the nominal size of a to
# h, above it of k to s.
_DEVIATIONS: dict[str, tuple[int, ...]] = {
    "a": (
        270, 270, 280, 290, 290, 300, 300, 310, 320, 340, 360, 380, 410, 460, 520, 580, 660, 740, 820, 920,
        1050, 1200, 1350, 1500, 1650,
    ),
    "b": (
        140, 140, 150, 150, 150, 160, 160, 170, 180, 190, 200, 220, 240, 260, 280, 310, 340, 380, 420, 480,
        540, 600, 680, 760, 840,
    ),
    "c": (
        60, 70, 80, 95, 95, 110, 110, 120, 130, 140, 150, 170, 180, 200, 210, 230, 240, 260, 280, 300, 330,
        360, 400, 440, 480,
    ),
    "d": (20, 30, 40, 50, 65, 80, 100, 120, 145, 170, 190, 210, 230),
    "e": (14, 20, 25, 32, 40, 50, 60, 72, 85, 100, 110, 125, 135),
    "f": (6, 10, 13, 16, 20, 25, 30, 36, 43, 50, 56, 62, 68),
    "g": (2, 4, 5, 6, 7, 9, 10, 12, 14, 15, 17, 18, 20),
    "h": (0,) * 13,
    "k": (0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5),
    "m": (2, 4, 6, 7, 8, 9, 11, 13, 15, 17, 20, 21, 23),
    "n": (4, 8, 10, 12, 15, 17, 20, 23, 27, 31, 34, 37, 40),
    "p": (6, 12, 15, 18, 22, 26, 32, 37, 43, 50, 56, 62, 68),
    "r": (
        10, 15, 19, 23, 23, 28, 28, 34, 34, 41, 43, 51, 54, 63, 65, 68, 77, 80, 84, 94, 98, 108, 114, 126,
        132,
    ),
    "s": (
        14, 19, 23, 28, 28, 35, 35, 43, 43, 53, 59, 71, 79, 92, 100, 108, 122, 130, 140, 158, 170, 190, 208,
        232, 252,
    ),
}  # fmt: skip
# Zones about the nominal size that follow no rule: lower deviations of shafts j, upper ones of holes J [um].
_ABOUT: dict[tuple[str, int], tuple[int, ...]] = {
    ("j", 5): (-2, -2, -2, -3, -4, -5, -7, -9, -11, -13, -16, -18, -20),
    ("j", 6): (-2, -2, -2, -3, -4, -5, -7, -9, -11, -13, -16, -18, -20),
    ("j", 7): (-4, -4, -5, -6, -8, -10, -12, -15, -18, -21, -26, -28, -32),
    ("J", 6): (2, 5, 5, 6, 8, 10, 13, 16, 18, 22, 25, 29, 33),
    ("J", 7): (4, 6, 8, 10, 12, 14, 18, 22, 26, 30, 36, 39, 43),
    ("J", 8): (6, 10, 12, 15, 20, 24, 28, 34, 41, 47, 55, 60, 66),
}
_LARGEST = _RANGES[-1]
_LETTERS = "a b c d e f g h j js k m n p r s"

_CLASS = re.compile(r"([A-Za-z]{1,2})\s*([0-9]{1,2})")
_NUMBER = r"([0-9]+(?:\.[0-9]+)?)\s*(?:mm)?"
_SIZED = re.compile(rf"(?:[øØ⌀]\s*)?{_NUMBER}\s*([A-Za-z]{{1,2}}\s*[0-9]{{1,2}})")
_FIT = re.compile(rf"{_SIZED.pattern}\s*[/-]\s*([A-Za-z]{{1,2}}\s*[0-9]{{1,2}})")


@dataclass(frozen=True, slots=True, kw_only=True)
class SizeLimits:
    """Limits of a size by its tolerance class.

    Attributes:
        nominal: Nominal size [m].
        name: Tolerance class, as ``H7``.
        lower: Lower deviation from the nominal size [m].
        upper: Upper deviation [m].
    """

    nominal: float
    name: str
    lower: float
    upper: float

    @property
    def tolerance(self) -> float:
        """Width of the zone [m]."""
        return self.upper - self.lower

    @property
    def mean(self) -> float:
        """Size in the middle of the zone [m]."""
        return self.size(0.0)

    def size(self, position: float) -> float:
        """Return the size at a position in the zone [m].

        Args:
            position: -1 at the lower limit, 0 in the middle, 1 at the upper limit.
        """
        return self.nominal + 0.5 * (self.lower + self.upper) + 0.5 * position * self.tolerance


@dataclass(frozen=True, slots=True, kw_only=True)
class IsoFit:
    """Hole and shaft of one nominal size.

    Attributes:
        hole: Limits of the hole.
        shaft: Limits of the shaft.
    """

    hole: SizeLimits
    shaft: SizeLimits

    @property
    def name(self) -> str:
        """The fit as it stands on a drawing, ``20 H7/g6``."""
        return f"{1e3 * self.hole.nominal:.10g} {self.hole.name}/{self.shaft.name}"

    @property
    def least(self) -> float:
        """Least radial clearance, negative if parts may interfere [m]."""
        return 0.5 * (self.hole.lower - self.shaft.upper)

    @property
    def largest(self) -> float:
        """Largest radial clearance [m]."""
        return 0.5 * (self.hole.upper - self.shaft.lower)

    @property
    def mean(self) -> float:
        """Radial clearance with both sizes in the middle of their zones [m]."""
        return 0.5 * (self.least + self.largest)

    @property
    def tolerance(self) -> float:
        """Tolerance of the radial clearance: its largest less its least value [m]."""
        return self.largest - self.least

    @property
    def tolerance_ratio(self) -> float:
        """Mean radial clearance over its tolerance [-], at least 3 by ECSS-E-ST-33-01C."""
        return self.mean / self.tolerance

    def sigma(self, capability: float = 1.0) -> float:
        """Return the standard deviation of the radial clearance [m].

        Of sizes that are normal and independent, each about the middle of its zone.

        Args:
            capability: C_p of both processes: a zone is 6 C_p standard deviations wide [-].
        """
        check_number("IsoFit", "capability", capability, "positive")
        return math.hypot(self.hole.tolerance, self.shaft.tolerance) / (12.0 * capability)

    def radial_clearance(self, hole: float = 0.0, shaft: float = 0.0) -> float:
        """Return the radial clearance at positions in both zones [m].

        Args:
            hole: From -1 at the hole's lower limit to 1 at its upper one.
            shaft: Likewise of the shaft.
        """
        return 0.5 * (self.hole.size(hole) - self.shaft.size(shaft))


def _range(nominal: float, limits: tuple[int, ...] = _RANGES) -> int:
    return bisect.bisect_left(limits, nominal)


@takes(nominal="m")
def tolerance_grade(nominal: float, grade: int) -> float:
    """Return the standard tolerance of a grade [m], IT7 for instance.

    Args:
        nominal: Nominal size, above 0 and up to 0.5 [m].
        grade: From 1 to 16.
    """
    size = _millimetres("tolerance_grade", nominal)
    _check_grade("tolerance_grade", grade)
    return _metres(_micrometres(size, grade))


@takes(nominal="m")
def size_limits(nominal: float, name: str) -> SizeLimits:
    """Return the limits of a size.

    Args:
        nominal: Nominal size, above 0 and up to 0.5 [m].
        name: Tolerance class: a hole's in capitals, ``H7``, a shaft's in small letters, ``g6``.
    """
    match = _CLASS.fullmatch(name.strip())
    if match is None:
        raise InvalidParameterError("size_limits", "name", "a letter and a grade, such as H7 or g6", name)
    size = _millimetres("size_limits", nominal)
    letter, grade = match[1], int(match[2])
    lower, upper = _deviations(size, letter, grade)
    return SizeLimits(
        nominal=float(size / 1000), name=f"{letter}{grade}", lower=_metres(lower), upper=_metres(upper)
    )


@takes()
def read_fit(text: str) -> IsoFit:
    """Return a fit as written on a drawing: ``20 H7/g6``, in millimetres.

    Raises:
        InvalidParameterError: It is no fit, or of a class or size that is not known here.
    """
    match = _FIT.fullmatch(" ".join(text.split()))
    if match is None:
        rule = 'a nominal size in millimetres and two tolerance classes, such as "20 H7/g6"'
        raise InvalidParameterError("read_fit", "fit", rule, text)
    nominal = float(Fraction(match[1]) / 1000)
    hole, shaft = (part.replace(" ", "") for part in (match[2], match[3]))
    if not hole[0].isupper() or not shaft[0].islower():
        rule = "the hole's class in capitals before the shaft's in small letters, such as H7/g6"
        raise InvalidParameterError("read_fit", "fit", rule, text)
    found = IsoFit(hole=size_limits(nominal, hole), shaft=size_limits(nominal, shaft))
    if not nominal + found.shaft.lower > 0.0:
        raise InvalidParameterError("read_fit", "fit", "of a size above the deviations of its shaft", text)
    return found


@takes()
def read_size(text: str) -> SizeLimits:
    """Return a size as written on a drawing: ``20 H7``, in millimetres."""
    match = _SIZED.fullmatch(" ".join(text.split()))
    if match is None:
        rule = 'a nominal size in millimetres and a tolerance class, such as "20 H7"'
        raise InvalidParameterError("read_size", "size", rule, text)
    return size_limits(float(Fraction(match[1]) / 1000), match[2].replace(" ", ""))


# --- in millimetres and micrometres, exactly ----------------------------------------------------------------


def _millimetres(place: str, nominal: float) -> Fraction:
    # The decimal that a person would write, so that 10 mm is not a range higher by round-off.
    size = Fraction(repr(float(nominal))) * 1000 if math.isfinite(nominal) else Fraction(0)
    if not 0 < size <= _LARGEST:
        raise InvalidParameterError(place, "nominal", f"a size above 0 and up to {_LARGEST} mm", nominal)
    return size


def _metres(micrometres: Fraction) -> float:
    return float(micrometres / 1_000_000)


def _check_grade(place: str, grade: int) -> None:
    if grade not in _GRADES:
        raise InvalidParameterError(place, "grade", f"a grade from {min(_GRADES)} to {max(_GRADES)}", grade)


def _micrometres(size: Fraction, grade: int) -> Fraction:
    return Fraction(str(_GRADES[grade][_range(float(size))]))


def _deviations(size: Fraction, letter: str, grade: int) -> tuple[Fraction, Fraction]:
    """Return lower and upper deviation [um]."""
    _check_grade("size_limits", grade)
    width, is_hole = _micrometres(size, grade), letter[0].isupper()
    own = letter.lower()
    if own == "js":
        return -width / 2, width / 2
    if own == "j":
        return _about(size, letter, grade, width)
    if own not in _DEVIATIONS or (letter not in (own, own.upper())):
        known = _LETTERS.upper() if is_hole else _LETTERS
        raise InvalidParameterError("size_limits", "name", f"of a letter among {known}", f"{letter}{grade}")
    column = _DEVIATIONS[own]
    nearer = Fraction(column[_range(float(size), _RANGES if len(column) == len(_RANGES) else _SUBRANGES)])
    if own == "k" and not 4 <= grade <= 7 and not is_hole:
        nearer = Fraction(0)
    if own <= "h":  # below the nominal size, of a hole above
        return (nearer, nearer + width) if is_hole else (-nearer - width, -nearer)
    if not is_hole:
        return nearer, nearer + width
    upper = _upper_of_hole(size, own, grade, nearer)
    return upper - width, upper


def _about(size: Fraction, letter: str, grade: int, width: Fraction) -> tuple[Fraction, Fraction]:
    if (letter, grade) not in _ABOUT:
        known = ", ".join(f"{one}{number}" for one, number in _ABOUT if one == letter)
        raise InvalidParameterError("size_limits", "name", f"one of {known}", f"{letter}{grade}")
    found = Fraction(_ABOUT[letter, grade][_range(float(size))])
    return (found - width, found) if letter == "J" else (found, found + width)


def _upper_of_hole(size: Fraction, letter: str, grade: int, nearer: Fraction) -> Fraction:
    """Return the upper deviation of a hole from K on [um]."""
    if letter == "k" and grade > 8 and size > 3:
        raise InvalidParameterError(
            "size_limits", "name", "of grade 8 or finer for K above 3 mm", f"K{grade}"
        )
    if letter == "n" and grade > 8:
        return -nearer if size <= 3 else Fraction(0)
    fine = grade <= (8 if letter in "kmn" else 7)
    if letter == "m" and grade == 6 and 250 < size <= 315:
        return Fraction(-9)  # the one exception in the standard's table
    if not fine or size <= 3 or grade < 3:
        return -nearer
    return -nearer + _micrometres(size, grade) - _micrometres(size, grade - 1)
