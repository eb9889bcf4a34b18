"""Contacts from onset to release by single kernels: touch, complete, release."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from plain_kernels import plain

from antenna_pin.base.records import MEMORY
from antenna_pin.dynamics.peak_kernels import PEAK
from antenna_pin.run.engine.episode_kernels import EPISODE, PLACES, complete, release, touch

FLOOR = 1e-3  # [m/s]


def a_book():
    """Return the book of two contacts, the second of which integrates at 5, 6, 7 of a state."""
    places = np.zeros(2, PLACES)
    for k, name in enumerate(("impulse", "lost_normal", "lost_friction", "bristle")):
        places[name] = [1 + k, 5 + k]
    places["bristles"], places["floor"] = 2, FLOOR
    return SimpleNamespace(
        memory=np.zeros(2, MEMORY),
        peaks=np.zeros(2, PEAK),
        open=np.full(2, -1),
        moments=np.zeros(2),
        places=places,
        episodes=np.zeros(3, EPISODE),
        count=np.zeros(1, dtype=np.int64),
    )


def test_an_episode_has_what_its_contact_has_integrated_from_onset_to_release():
    """Impulse [N s] and losses [J] of a second contact: without those of the contact before."""
    book, onset, end = a_book(), np.arange(10.0, 20.0), np.zeros(10)
    impulse, normal, friction = 0.25, 0.5, 0.125
    plain(touch)(book, 1, 0.1, 0.3, 2.0, np.zeros(10))
    plain(release)(book, 1, 0.2, np.arange(10.0, 20.0))
    first = book.episodes[0]
    assert (first["impulse"], first["dissipated"]) == (15.0, 16.0 + 17.0)
    plain(touch)(book, 1, 0.4, 0.2, 3.0, onset)
    book.peaks["force"][1], book.peaks["time"][1], book.peaks["depth"][1] = 70.0, 0.45, 2e-6
    end[5:8] = np.array([15.0, 16.0, 17.0]) + [impulse, normal, friction]
    plain(release)(book, 1, 0.6, end)
    one = book.episodes[1]
    assert (one["contact"], one["onset"], one["release"]) == (1, 0.4, 0.6)
    assert (one["approach_speed"], one["effective_mass"]) == (0.2, 3.0)
    assert (one["peak_force"], one["peak_time"], one["peak_depth"]) == (70.0, 0.45, 2e-6)
    assert one["impulse"] == pytest.approx(impulse, rel=1e-14)
    assert one["dissipated"] == pytest.approx(normal + friction, rel=1e-14)
    assert book.count[0] == 2 and book.open.tolist() == [-1, -1]


def test_an_onset_has_new_bristles_and_a_least_approach_speed():
    """A slow one counts as one at the floor; other contacts' bristles stand."""
    book, y = a_book(), np.arange(10.0)
    plain(touch)(book, 1, 0.4, 0.1 * FLOOR, 3.0, y)
    assert y.tolist() == [*range(8), 0.0, 0.0]
    assert (book.memory["touching"] == [0.0, 1.0]).all()
    assert book.memory["approach_speed"][1] == book.episodes["approach_speed"][0] == FLOOR
    assert math.isnan(book.episodes["release"][0]) and math.isnan(book.moments[1])


def test_nothing_is_completed_of_a_contact_that_is_apart():
    book = a_book()
    plain(complete)(book, 0, np.ones(10))
    assert not any(book.episodes[name].any() for name in book.episodes.dtype.names)
