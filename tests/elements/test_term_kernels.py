"""Terms of a course one by one, as the kernel ``course`` sums them: closed forms with two derivatives."""

import math

import numpy as np
import pytest
from plain_kernels import plain

from antenna_pin.elements.term_kernels import CYCLOID, SINE, SINES, SIZE, TERM, course

SUM = plain(course)


def term(kind, tail=(), **values):
    """Return the words of one term."""
    words = np.concatenate([np.zeros(SIZE), np.array(tail, dtype=float)])
    head = words[:SIZE].view(TERM)
    head["kind"], head["length"] = kind, len(words)
    for name, value in values.items():
        head[name] = value
    return words


def swing(size, omega, phase, t):
    """Return size times the sine of omega t + phase, with two derivatives."""
    angle = omega * t + phase
    return size * np.array([math.sin(angle), omega * math.cos(angle), -(omega**2) * math.sin(angle)])


def test_a_sine_has_the_rate_and_acceleration_of_its_closed_form():
    """Of a course of one sine, at times of all four quarters of its period."""
    words = term(SINE, amount=0.7, omega=2.0, phase=0.3)
    for t in (0.0, 0.4, 1.1, 2.0, 2.9):
        assert SUM(words, 0, len(words), t) == pytest.approx(swing(0.7, 2.0, 0.3, t), rel=1e-14)


def test_a_course_is_the_sum_of_its_terms():
    """Of several sines in one term, a sine, and a rise that rolls as a wheel: each by its own formula."""
    sines = ((0.7, 2.0, 0.3), (-0.2, 5.0, -1.0), (0.05, 11.0, 2.5))
    rise, span, begin = 0.4, 2.0, 0.5
    words = np.concatenate(
        [
            term(SINES, np.ravel(sines), count=len(sines)),
            term(SINE, amount=1.3, omega=0.6, phase=-0.4),
            term(CYCLOID, amount=rise, span=span, begin=begin),
        ]
    )
    for t in (0.2, 0.9, 1.7, 3.0):
        expected = sum(swing(*one, t) for one in (*sines, (1.3, 0.6, -0.4)))
        s, turn = min(max((t - begin) / span, 0.0), 1.0), 2.0 * math.pi
        expected[0] += rise * (s - math.sin(turn * s) / turn)
        expected[1] += rise / span * (1.0 - math.cos(turn * s))
        expected[2] += rise / span**2 * turn * math.sin(turn * s)
        # Round-off of sums and of a whole turn's sine.
        assert SUM(words, 0, len(words), t) == pytest.approx(expected, rel=1e-13, abs=1e-14)
