"""A command that takes long says so where no bar shows it: at once after a while, then ever more rarely."""

import _thread
import math
import re
import threading
import time

import pytest

from antenna_pin.apps.cli import _progress
from antenna_pin.run.simulation.loop import Progress


@pytest.mark.parametrize("bar", [False, True])
def test_a_command_that_takes_long_says_so(monkeypatch, capsys, bar):
    """After 0.05, 0.1, 0.2 s of 0.35 s; with how far it is, if that is known; and not when it is done."""
    monkeypatch.setattr(_progress, "_FIRST", 0.05)
    said, begun = [], time.monotonic()
    with _progress.said_at_work("report", said.append), _progress.progress_bar("panel", bar) as report:
        if report is not None:
            report(Progress(0.25, 1.0, 1e-3, 10, 1.0))
        time.sleep(0.35)
    count, most = len(said), 1 + math.log2((time.monotonic() - begun) / 0.05)
    time.sleep(0.1)
    assert 1 <= count == len(said) <= most
    how_far = ": panel, 25 % done" if bar else ""
    # Of the last, for on a busy machine the bar itself may take longer to come than the first.
    assert re.fullmatch(rf"note: report is at work, for \d\.\d s so far{how_far}", said[-1])


def test_a_command_does_its_work_where_no_thread_can_be_had(monkeypatch):
    """Out of memory, or of threads: that it is at work is not worth the work."""

    def refused(*_):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(_thread, "start_new_thread", refused)
    monkeypatch.setattr(threading.Thread, "start", refused)
    done = []
    with _progress.said_at_work("report", print):
        done.append(True)
    assert done


def test_a_command_that_waits_for_its_user_is_not_at_work(monkeypatch):
    """Of 0.05, 0.1 s of waiting nothing is said; of the work after it is."""
    monkeypatch.setattr(_progress, "_FIRST", 0.05)
    said = []
    with _progress.said_at_work("explore", said.append):
        with _progress.waiting_for_the_user():
            time.sleep(0.15)
            waited = len(said)
        time.sleep(0.35)
    assert waited == 0 < len(said)


def test_a_command_that_is_quick_says_nothing():
    said = []
    with _progress.said_at_work("report", said.append):
        pass
    assert said == []
