"""Turns of processes that compile the same kernel: how long one waits for another."""

from types import SimpleNamespace

import pytest

from antenna_pin.compiled import kernel_cache


def test_one_who_never_ends_is_waited_for_five_minutes(tmp_path, monkeypatch):
    """Longer than any kernel takes; then the kernel is compiled twice rather than never."""
    clock, pauses = [0.0], []

    def sleep(seconds):
        pauses.append(seconds)
        clock[0] += seconds

    def held_by_another(*_):
        raise BlockingIOError

    monkeypatch.setattr(kernel_cache, "time", SimpleNamespace(monotonic=lambda: clock[0], sleep=sleep))
    monkeypatch.setattr(kernel_cache.os, "lockf", held_by_another)
    turn = kernel_cache.Turn("kernel")
    turn.begin(str(tmp_path))
    assert not turn.is_held
    assert clock[0] == pytest.approx(300.0, abs=0.1)
    assert max(pauses) < 0.1  # nobody notices that it was not at once
    monkeypatch.undo()
    turn.begin(str(tmp_path))
    assert turn.is_held
    turn.end()
