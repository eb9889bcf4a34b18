"""Rules for numbers by their texts: bounds, what obeys them, and refusal of a text that is none."""

import math
from typing import Annotated

import pytest

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.rules import AtLeastOne, NumberRule, Positive, PositiveOrInfinite, obeys
from antenna_pin.errors import InvalidParameterError


@pytest.mark.parametrize(
    ("rule", "good", "bad"),
    [
        ("positive", (1e-300, math.inf), (0.0, -1.0)),
        ("zero or more", (0.0, math.inf), (-1e-300,)),
        ("zero or more and below 1", (0.0, 0.999), (-1e-9, 1.0)),
        ("between 0 and 1", (1e-9, 0.999), (0.0, 1.0)),
        ("in [0, 1]", (0.0, 1.0), (-1e-9, 1.0 + 1e-9)),
        ("in (0, 1]", (1e-9, 1.0), (0.0, 1.1)),
        ("in [0, 1)", (0.0, 0.999), (1.0,)),
        ("from 0 to 1", (0.0, 1.0), (-1e-9, 1.1)),
        ("from 0 to below 1, a part of the period", (0.0, 0.999), (1.0,)),
        ("above -1 and at most 0.5", (-0.999, 0.5), (-1.0, 0.501)),
        ("3 or more, or a direction is free", (3, math.inf), (2,)),
        ("at least 1 and finite", (1,), (0.5,)),
    ],
)
def test_a_rule_is_obeyed_within_its_bounds(rule, good, bad):
    """By its text alone; NaN obeys none."""
    assert [obeys(number, rule) for number in (*good, *bad, math.nan)] == [True] * len(good) + [False] * (
        len(bad) + 1
    )


@pytest.mark.parametrize("text", ["small", "positive or zero", "below", "zero or more or so"])
def test_a_text_that_is_no_rule_is_an_error_at_import(text):
    with pytest.raises(ValueError, match="is no rule for numbers"):
        NumberRule(text)


@takes(time="s", rate="1/s")
def asked(
    time: Positive | None = None,
    count: AtLeastOne = 1,
    sizes: tuple[Positive, ...] = (),
    rate: Annotated[float, NumberRule("")] = 0.0,
    width: PositiveOrInfinite = 1.0,
):
    return time, count, sizes, rate, width


def test_an_argument_obeys_the_rule_of_its_annotation():
    """Text with a unit as a number; each of several; infinity only where the rule allows it."""
    assert asked("2 ms", 3, (1, 2.0), -1.0, math.inf) == (0.002, 3, (1, 2.0), -1.0, math.inf)
    for given, message in (
        ({"time": "-1 s"}, "asked: time must be positive and finite [s], got -1.0"),
        ({"time": math.inf}, "asked: time must be positive and finite [s], got inf"),
        ({"count": 0}, "asked: count must be 1 or more, got 0"),
        ({"sizes": (1.0, 0.0)}, "asked: sizes must be positive and finite, got 0.0"),
        ({"rate": math.nan}, "asked: rate must be finite [1/s], got nan"),
        ({"width": math.nan}, "asked: width must be positive, got nan"),
    ):
        with pytest.raises(InvalidParameterError) as refusal:
            asked(**given)
        assert str(refusal.value) == message


def test_a_number_is_checked_where_no_argument_has_it():
    check_number("here", "size", 2.0, "1 or more", "m")
    with pytest.raises(InvalidParameterError, match=r"^here: size must be 1 or more \[m\], got '1 mm'$"):
        check_number("here", "size", 1e-3, "1 or more", "m", text="'1 mm'")
