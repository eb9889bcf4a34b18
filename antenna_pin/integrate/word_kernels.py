"""Numbers of a flat array that depend on parameters: displacement and restoration, compiled.

Of each parameter a few numbers change: where they stand and by how much, one after the other, with where
those of each parameter begin.
"""

from __future__ import annotations

from typing import NamedTuple

from antenna_pin.base.records import Floats, Ints
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import inlined


@by_address
class Words(NamedTuple):
    """Numbers of an array that go with parameters."""

    first: Ints  # where those of each parameter begin, and the end, (parameters + 1,)
    at: Ints  # where they stand in the array, (words,)
    slopes: Floats  # by how much they change, (words,)
    was: Floats  # what they are undisplaced, scratch, (words,)


@inlined
def note_words(array: Floats, words: Words, m: int) -> None:
    """Note what the numbers of parameter m are before they are displaced."""
    for i in range(words.first[m], words.first[m + 1]):
        words.was[i] = array[words.at[i]]


@inlined
def displace_words(array: Floats, words: Words, m: int, h: float) -> None:
    """Displace them by h times their change, from what was noted."""
    for i in range(words.first[m], words.first[m + 1]):
        array[words.at[i]] = words.was[i] + h * words.slopes[i]


@inlined
def put_back_words(array: Floats, words: Words, m: int) -> None:
    """Put them back as they were noted."""
    for i in range(words.first[m], words.first[m + 1]):
        array[words.at[i]] = words.was[i]
