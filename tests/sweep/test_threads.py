"""Studies in threads of one process: the store of one thread, and Ctrl-C."""

import os
import signal
import sys
import threading
import time
import warnings

import pytest
from typer.testing import CliRunner

from antenna_pin.apps.cli import app
from antenna_pin.errors import InvalidParameterError
from antenna_pin.studies.sweep import Here, Threads, TrialRun, driver, run_study
from antenna_pin.studies.sweep.jobs import Job, _told_of

#: The default engine: by machine code where the shim is there.
STUDY = """
scenario = "bai2020"
case = "case3"
{more}
[set]
duration = "20 ms"

{parameters}

[responses]
force = {{ measure = "peak_force" }}
turn = {{ measure = "base_turn" }}
"""

PLAY = """
[parameters.play]
key = "clearance.elevation.radial_clearance"
start = "0.1 mm"
stop = "0.2 mm"
count = 9
"""


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Return the bytes of the study's dataset, made on one thread."""
    from antenna_pin.studies.sweep import load_study

    folder = tmp_path_factory.mktemp("whole")
    (folder / "trial.study.toml").write_text(STUDY.format(parameters=PLAY, more=""))
    run_study(load_study(folder / "trial.study.toml"), folder / "here.study", executor=Here())
    return (folder / "here.study" / "runs.nc").read_bytes()


def test_threads_make_the_store_of_one_thread(write, tmp_path, whole):
    run_study(write(PLAY, text=STUDY), tmp_path / "three.study", executor=Threads(3))
    assert (tmp_path / "three.study" / "runs.nc").read_bytes() == whole


def test_threads_of_studies_pass_the_lock_on_soon():
    """As long as they run, also if one fails; whoever has it pass sooner keeps that."""
    own = sys.getswitchinterval()

    def fail(shared, batch):
        if batch == [2]:
            raise ValueError
        return sys.getswitchinterval()

    try:
        for before, meanwhile in ((0.005, 5e-4), (1e-4, 1e-4)):
            sys.setswitchinterval(before)
            found = []
            with pytest.raises(ValueError):
                for _, answer in Threads(1).each(fail, None, iter([[1], [2]])):
                    found.append(answer)
            # In whole microseconds, rounded down.
            assert [*found, sys.getswitchinterval()] == pytest.approx([meanwhile, before], abs=2e-6)
            # Of two studies at once the one that began first ends first.
            studies = [Threads(1).each(fail, None, iter([[1], [3]])) for _ in range(2)]
            for study in (*studies, *studies):
                assert next(study)[1] == pytest.approx(meanwhile, abs=2e-6)
            for study, after in zip(studies, (meanwhile, before), strict=True):
                assert [*study] == []
                assert sys.getswitchinterval() == pytest.approx(after, abs=2e-6)
    finally:
        sys.setswitchinterval(own)


def test_ctrl_c_ends_the_runs_under_way_and_the_study_continues(write, tmp_path, whole):
    """The signal reaches the main thread only; runs of minutes in other threads end between two batches."""
    before, sent = threading.active_count(), []

    def press(progress):
        if progress.stage == "run" and progress.done >= 2 and not sent:
            sent.append(time.monotonic())
            threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT)).start()

    study = write(PLAY, text=STUDY)
    with pytest.raises(KeyboardInterrupt):
        run_study(study, tmp_path / "cut.study", executor=Threads(2), progress=press)
        pytest.fail("all runs were made before the signal")
    assert threading.active_count() == before
    lines = (tmp_path / "cut.study" / "journal").read_bytes().count(b'"COMPLETED"')
    assert 2 <= lines < 9
    assert b"INTERRUPTED" not in (tmp_path / "cut.study" / "journal").read_bytes()
    run_study(study, tmp_path / "cut.study", executor=Threads(2))
    assert (tmp_path / "cut.study" / "runs.nc").read_bytes() == whole


def test_ctrl_c_does_not_wait_for_long_runs(write, tmp_path, monkeypatch):
    """Each would take minutes; its trial, a part of it, is left out."""
    monkeypatch.setattr(driver, "trial", lambda plan, run: TrialRun(1.0))
    study = write(PLAY, text=STUDY.replace('"20 ms"', '"1000 s"'))
    pressed = []

    def press(progress):
        if progress.stage == "run":
            pressed.append(time.monotonic() + 0.3)
            threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()

    with pytest.raises(KeyboardInterrupt):
        run_study(study, tmp_path / "long.study", executor=Threads(2), progress=press)
    # On a busy machine; what a batch of steps takes is 0.1 s at most.
    assert time.monotonic() - pressed[0] < 20.0


def test_warnings_of_threads_bear_the_numbers_of_their_runs():
    """And what is shown before and behind is the process's own."""
    shown, both = [], threading.Barrier(2)

    def warn(number):
        with _told_of(Job(number, {}, 0)):
            both.wait()
            warnings.warn(f"of {number}", RuntimeWarning, stacklevel=1)
            both.wait()

    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.showwarning = lambda message, *rest, **more: shown.append(str(message))
        own = warnings.showwarning
        threads = [threading.Thread(target=warn, args=(number,)) for number in (3, 8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert warnings.showwarning is own
    assert sorted(shown) == ["run 3: of 3", "run 8: of 8"]


def test_a_number_of_threads_that_is_none():
    with pytest.raises(InvalidParameterError, match="threads must be positive, got 0"):
        Threads(0)
    assert Threads().width >= 1


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--threads", "2", "--workers", "1"], "--threads: must be left out with --workers and --scheduler"),
        (["--threads", "-1"], "'--threads': must be zero or more, got -1"),
    ],
)
def test_threads_besides_processes_are_refused(arguments, said):
    done = CliRunner().invoke(app, ["sweep", "bai2020/clearances", *arguments])
    assert done.exit_code == 2
    assert said in done.stderr
