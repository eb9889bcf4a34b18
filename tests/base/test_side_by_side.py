"""Work in forked processes gives what it gives in this one: the same, in order, whatever befalls them."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
import warnings

import pytest

from antenna_pin.base.side_by_side import cores_for, side_by_side


def test_all_is_made_in_order_however_long_each_takes():
    """The first pieces take longest, so that others are done before them."""

    def work(piece):
        time.sleep(0.02 * (5 - piece))
        return piece, os.getpid()

    found = list(side_by_side(work, range(6), processes=3))
    assert [piece for piece, _ in found] == list(range(6))
    made_by = {process for _, process in found}
    assert os.getpid() not in made_by and len(made_by) > 1
    assert not multiprocessing.active_children()


@pytest.mark.parametrize(("pieces", "processes"), [(20, 1), (3, 8), (1, 2), (0, 2)])
def test_few_pieces_are_made_here(pieces, processes):
    """A process costs more than one piece gives."""
    found = list(side_by_side(lambda _: os.getpid(), range(pieces), processes))
    assert found == [os.getpid()] * pieces


def test_what_a_killed_process_left_is_made_here():
    here = os.getpid()

    def work(piece):
        if piece in (0, 3) and os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return piece

    assert list(side_by_side(work, range(8), processes=2)) == list(range(8))


def test_an_exception_is_raised_where_it_would_be_without_processes():
    def work(piece):
        if piece == 2:
            raise ZeroDivisionError("of piece 2")
        return piece

    made = side_by_side(work, range(6), processes=2)
    assert [next(made), next(made)] == [0, 1]
    with pytest.raises(ZeroDivisionError, match="of piece 2"):
        next(made)
    assert not multiprocessing.active_children()


def test_warnings_are_told_here():
    def work(piece):
        warnings.warn(f"of {piece}", stacklevel=1)
        return piece

    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        assert list(side_by_side(work, range(4), processes=2)) == [0, 1, 2, 3]
    assert sorted(str(one.message) for one in told) == [f"of {k}" for k in range(4)]


INTERRUPTED = """
import os, sys, time
from antenna_pin.base.side_by_side import side_by_side

def work(piece):
    os.write(1, b"%d\\n" % os.getpid())  # at once, or what two processes say would mix
    time.sleep(float(sys.argv[1]))

try:
    list(side_by_side(work, range(1000), 2))
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


def test_ctrl_c_ends_all_processes_at_once():
    """It comes to all processes of a terminal."""
    with _interrupted(seconds=60.0) as process:
        workers = _workers(process)
        os.killpg(process.pid, signal.SIGINT)
        assert process.stdout.read() == "interrupted\n"
        assert process.wait(10.0) == 0
        assert not any(map(alive, workers))  # waited for before the exception went on


def test_no_process_outlives_the_one_it_works_for():
    """Even where that is killed: at the end of a piece nobody is there to take it."""
    with _interrupted(seconds=0.2) as process:
        workers = _workers(process)
        process.kill()
        until = time.monotonic() + 20.0
        while any(map(alive, workers)) and time.monotonic() < until:
            time.sleep(0.01)
        assert not any(map(alive, workers))


def _interrupted(seconds):
    return subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED, str(seconds)],
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def _workers(process):
    found = set()
    while len(found) < 2:
        found.add(int(process.stdout.readline()))
    return found


def alive(process: int) -> bool:
    """Whether a process runs; one that has ended and waits to be asked how does not."""
    try:
        with open(f"/proc/{process}/stat", encoding="ascii") as status:
            return status.read().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_processes_are_no_more_than_cores_and_fit_into_memory():
    assert 1 <= cores_for(1.0) <= len(os.sched_getaffinity(0))
    assert cores_for(1e18) == 1
