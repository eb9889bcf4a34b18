"""Ctrl-C, the end of a batch job, a closed terminal: what was computed is kept, and no traceback is seen."""

import contextlib
import importlib
import multiprocessing
import os
import pty
import re
import signal
import subprocess
import sys
import time
from types import SimpleNamespace

import pytest
import typer

from antenna_pin import Outcome, Trajectory, load_scenario
from antenna_pin.apps.cli._common import one_line_errors
from antenna_pin.base.files import replacing
from antenna_pin.base.interruption import (
    Ended,
    acknowledge,
    ending_by_signals,
    held_back,
    interruptible,
    is_interruption,
)
from antenna_pin.errors import InvalidParameterError
from antenna_pin.studies.linear import modes
from antenna_pin.studies.nonlinear import poincare
from antenna_pin.studies.nonlinear.sections import section_of
from antenna_pin.studies.sweep import Cluster
from antenna_pin.studies.sweep.cluster import ClusterLostError

_ENTRY = "import sys; from antenna_pin.apps._entry import main; sys.argv[0] = 'antenna-pin'; sys.exit(main())"
# Far longer than any test waits, and yet it ends by itself, whatever becomes of the test that has started it.
_ENDLESS = ("run", "bai2020", "--case", "case1", "--duration", "1e5", "--out", "run.nc")
_ENDLESS += ("--set", "integrator.max_wall_time=120 s", "--set", "output.rate=10 Hz")


@pytest.fixture(autouse=True, scope="module")
def closed_terminals_are_heard():
    """As in a terminal, also where the tests run under ``nohup``, which their processes inherit."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.fixture
def endless(tmp_path):
    """Start a run that would take for ever, with a terminal, and return both when it makes its steps."""
    made = []

    def start(**options):
        ours, theirs = pty.openpty()
        process = subprocess.Popen(
            [sys.executable, "-c", _ENTRY, *_ENDLESS],
            cwd=tmp_path,
            stdin=theirs,
            stdout=theirs,
            stderr=theirs,
            process_group=0,
            **options,
        )
        made.append(process)
        os.close(theirs)
        said = b""  # its bar starts with its first step; before that a busy machine has it say that it works
        while not re.sub(rb".*note: run is at work.*", b"", said).strip():
            said += os.read(ours, 1000)
        return process, ours

    yield start
    for process in made:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _ended(process, terminal):
    """Return all that a process still says, and its exit code."""
    said = b""
    try:
        while found := os.read(terminal, 1000):
            said += found
    except OSError:  # how a terminal ends
        pass
    os.close(terminal)
    return said.decode(), process.wait(timeout=60)


@pytest.fixture
def as_command_line():
    """SIGTERM and SIGHUP as the command line takes them, for one test."""
    numbers = (signal.SIGTERM, signal.SIGHUP, signal.SIGINT, signal.SIGALRM)
    before = {number: signal.getsignal(number) for number in numbers}
    hook = sys.unraisablehook
    ending_by_signals()
    yield
    acknowledge()
    sys.unraisablehook = hook
    for number, handler in before.items():
        signal.signal(number, handler)


def test_what_ctrl_c_stops_is_saved(tmp_path, endless):
    process, terminal = endless()
    process.send_signal(signal.SIGINT)
    said, ended = _ended(process, terminal)
    assert ended == 130
    assert "saved run.nc" in said
    assert "Traceback" not in said
    assert Trajectory.load(tmp_path / "run.nc").outcome is Outcome.INTERRUPTED
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.nc", "run.nc.parts"]


def test_a_run_outlives_its_terminal_for_as_long_as_it_takes_to_save(tmp_path, endless):
    """The bar, the summary and the last words are printed to a terminal that is gone."""
    process, terminal = endless()
    os.close(terminal)  # from here on every write raises EIO
    time.sleep(0.3)
    process.send_signal(signal.SIGHUP)
    assert process.wait(timeout=60) == 129
    assert Trajectory.load(tmp_path / "run.nc").outcome is Outcome.INTERRUPTED


def test_nohup_keeps_a_run_alive(tmp_path, endless):
    """Until it is asked to end."""
    process, terminal = endless(preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    process.send_signal(signal.SIGHUP)
    time.sleep(0.5)
    assert process.poll() is None
    process.send_signal(signal.SIGTERM)
    assert _ended(process, terminal)[1] == 143
    assert Trajectory.load(tmp_path / "run.nc").outcome is Outcome.INTERRUPTED


def test_ctrl_c_while_modules_are_imported_is_no_traceback(tmp_path):
    """Sent at times spread over the imports; on a fast machine the run has begun when it is heard."""
    ready = _ENTRY.replace("import sys;", "import gc, sys; gc.set_threshold = lambda *_: print(flush=True);")
    kept = r"(.* s/s step .*\n)?antenna-pin: bai2020-case3: at t = .* the results so far are saved .*\n"
    for delay in (0.0, 0.05, 0.2):
        process = subprocess.Popen(
            [sys.executable, "-c", ready, "run", "bai2020"],
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        process.stdout.read(1)
        time.sleep(delay)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=120)
        assert process.returncode in (-signal.SIGINT, 130)
        assert err in ("", "antenna-pin: interrupted\n") or re.fullmatch(kept, err)


def test_a_script_is_left_its_own_way_with_sigterm():
    """In Python only Ctrl-C is taken over, or a script of many runs could not be ended."""
    seen = []
    before = signal.signal(signal.SIGTERM, lambda number, frame: seen.append(number))
    try:
        with interruptible() as interrupted:
            signal.raise_signal(signal.SIGTERM)
            assert not interrupted()
    finally:
        signal.signal(signal.SIGTERM, before)
    assert seen == [signal.SIGTERM]


def test_signals_count_as_ctrl_c_on_the_command_line(as_command_line):
    with interruptible() as interrupted:
        signal.raise_signal(signal.SIGTERM)
        assert interrupted()
        with held_back():  # within, too
            signal.raise_signal(signal.SIGHUP)
        with pytest.raises(KeyboardInterrupt):  # the third interrupts at once
            signal.raise_signal(signal.SIGINT)
    with pytest.raises(Ended):
        signal.raise_signal(signal.SIGHUP)


def test_a_signal_is_not_lost_where_python_drops_exceptions(as_command_line, capsys):
    """As in the callbacks of weak references and in ``__del__``: it comes again, and nothing is printed."""

    class Removed:
        def __del__(self):
            signal.raise_signal(signal.SIGTERM)

    with pytest.raises(Ended):  # noqa: PT012 - removed first, ended later
        one = Removed()
        del one
        time.sleep(5.0)
    assert capsys.readouterr().err == ""


def test_what_comes_of_a_dropped_signal_is_an_interruption(as_command_line, capsys, monkeypatch):
    """What compiled code calls back has no way to raise: its caller goes on with what is no answer."""

    class Removed:
        def __del__(self):
            signal.raise_signal(signal.SIGTERM)

    @one_line_errors
    def command():
        one = Removed()
        del one
        raise InvalidParameterError("law", "force", "finite", float("nan"))

    with pytest.raises(typer.Exit) as ended:
        command()
    assert ended.value.exit_code == 128 + signal.SIGTERM
    assert capsys.readouterr().err == "antenna-pin: interrupted\n"
    monkeypatch.setattr("antenna_pin.base.interruption._raised", [])
    assert not is_interruption(ZeroDivisionError())


def test_a_signal_after_the_last_look_is_not_lost(as_command_line):
    """As at the end of one of many runs: its result is returned, and the signal comes then."""

    def made():
        with interruptible() as interrupted:
            assert not interrupted()
            signal.raise_signal(signal.SIGTERM)
        return "result"

    returned = []
    with pytest.raises(Ended):  # noqa: PT012 - returned first, ended later
        returned.append(made())
        time.sleep(5.0)
    assert returned == ["result"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_work_that_stops_between_steps_ends_with_the_signals_code(as_command_line, number):
    """As exponents, sweeps, sensitivities: the signal is a flag, and what is raised no longer says which."""

    @one_line_errors
    def command():
        with interruptible() as interrupted:
            signal.raise_signal(number)
            if interrupted():
                raise KeyboardInterrupt

    with pytest.raises(typer.Exit) as ended:
        command()
    assert ended.value.exit_code == 128 + number


def test_what_a_library_makes_of_ctrl_c_is_an_interruption_still(as_command_line, monkeypatch):
    """Matplotlib, interrupted while its C library is imported, says that the initialization failed.

    Pydantic says, of a class that it makes, that its schema is none. What comes long afterwards is a bug.
    """
    monkeypatch.setattr("antenna_pin.base.interruption._raised", [])
    assert not is_interruption(ZeroDivisionError())
    with pytest.raises(ValueError) as seen:
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            raise ValueError from None
    assert is_interruption(seen.value)
    assert is_interruption(ImportError("initialization failed"))
    assert is_interruption(ZeroDivisionError())
    assert not is_interruption(InvalidParameterError("law", "force", "finite", float("nan")))
    later = time.monotonic() + 20.0
    monkeypatch.setattr(time, "monotonic", lambda: later)
    assert not is_interruption(ZeroDivisionError())


def test_what_is_held_back_comes_in_the_end(tmp_path, as_command_line):
    target = tmp_path / "file"
    with pytest.raises(Ended):
        with replacing(target) as partial, held_back():
            signal.raise_signal(signal.SIGTERM)
            partial.write_text("whole")
    assert not target.exists()
    with pytest.raises(KeyboardInterrupt):
        with held_back(), replacing(target) as partial:
            signal.raise_signal(signal.SIGINT)
            partial.write_text("whole")
    assert target.read_text() == "whole"


def test_a_library_that_swallows_the_signal_while_it_is_imported(tmp_path, monkeypatch):
    """Trimesh takes whatever an import raises, a signal too, and fails where it needs what it did not get."""
    (tmp_path / "swallows.py").write_text("def f() -> None | int.nothing: ...\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr("antenna_pin.base.interruption._last", [])
    monkeypatch.setattr("antenna_pin.base.interruption._raised", [])
    with pytest.raises(AttributeError) as failed:
        importlib.import_module("swallows")
    assert not is_interruption(failed.value)
    monkeypatch.setattr("antenna_pin.base.interruption._last", [int(signal.SIGTERM)])
    assert is_interruption(failed.value) and not is_interruption(AttributeError())


@pytest.mark.parametrize("alarm", [signal.SIG_DFL, lambda number, frame: None])
def test_a_signal_that_something_catches_comes_again(monkeypatch, as_command_line, alarm):
    """As some libraries do, with whatever is raised; not where the work has ended, or goes on knowingly."""
    monkeypatch.setattr("antenna_pin.base.interruption._MUCH_LATER", 0.3)
    signal.signal(signal.SIGALRM, alarm)  # of a script that has its own, too
    for is_known in (False, True):
        with contextlib.suppress(BaseException):
            signal.raise_signal(signal.SIGTERM)
        with contextlib.nullcontext() if is_known else pytest.raises(Ended):
            if is_known:
                acknowledge()
            time.sleep(0.6 if is_known else 20.0)  # twice as long as until it would come
    assert signal.getsignal(signal.SIGALRM) is alarm or alarm is signal.SIG_DFL


def test_a_command_that_is_done_before_its_signal_comes_again_ends_by_it(tmp_path):
    """As one within its last import; what it has printed is there."""
    late = "from antenna_pin.apps import _entry, cli; from antenna_pin.base import interruption\n"
    late += "cli.main = lambda: (print('done'), interruption._send_again(15, 60.0)); _entry.main()"
    ended = subprocess.run([sys.executable, "-c", late], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (-signal.SIGTERM, "done\n", "")


def test_a_signal_within_an_import_comes_behind_it(tmp_path, monkeypatch, as_command_line):
    """Some libraries go on without what they were importing, as if nothing had been."""
    (tmp_path / "interrupted.py").write_text(
        "import signal\nsignal.raise_signal(signal.SIGINT)\nwhole = True\n"
    )
    (tmp_path / "goes_on.py").write_text("try:\n    import interrupted\nexcept BaseException:\n    pass\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    imported = []
    with pytest.raises(KeyboardInterrupt):  # noqa: PT012 - imported first, ended later
        imported.append(importlib.import_module("goes_on"))
        time.sleep(30.0)
    assert imported[0].interrupted.whole


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_while_processes_start_or_end_comes_when_they_have(monkeypatch, as_command_line, number):
    """In the midst of either Dask would make tracebacks of it, or leave processes behind."""
    done = []

    class Peer:
        def __init__(self, name):
            signal.raise_signal(number)
            self.name = name
            done.append(f"{name} there")

        def close(self):
            signal.raise_signal(number)
            done.append(f"{self.name} closed")

    monkeypatch.setattr(Cluster, "_processes", lambda self: Peer("processes"))
    monkeypatch.setattr(Cluster, "_connected", lambda self: Peer("client"))
    cluster = Cluster(2)
    with pytest.raises(KeyboardInterrupt):
        cluster.start()
    assert done == ["processes there", "client there"]
    with pytest.raises(KeyboardInterrupt):
        cluster.close()
    assert done[2:] == ["client closed", "processes closed"]


def test_a_signal_while_a_batch_is_given_out_comes_when_it_has_been(as_command_line):
    """Half of that leaves Dask with a batch that nobody knows of."""
    done = []

    class Client:
        def __getattr__(self, name):
            def call(*arguments, **more):
                signal.raise_signal(signal.SIGINT)
                done.append(name)
                return [self] if name == "scatter" else self

            return call

        def nthreads(self):
            return {"a worker": 1}

    cluster = Cluster(1)
    cluster._client = Client()
    with pytest.raises(KeyboardInterrupt):
        list(cluster.each(len, "shared", iter([["a batch"]])))
    assert done[:3] == ["scatter", "submit", "add_done_callback"]


def test_a_signal_that_ends_processes_at_their_start_is_an_interruption(monkeypatch, as_command_line):
    """A batch queue sends it to all of them: that they do not start is not what is to be said."""

    def ended(self):
        signal.raise_signal(signal.SIGTERM)
        raise OSError("one was ended by SIGTERM")

    monkeypatch.setattr(Cluster, "_processes", ended)
    with pytest.raises(Ended):
        Cluster(1).start()


def test_processes_that_dask_does_not_end_are_ended(monkeypatch):
    """As where some have started and others have not."""
    left = multiprocessing.get_context("spawn").Process(target=time.sleep, args=(600.0,), daemon=True)
    other = multiprocessing.get_context("spawn").Process(target=time.sleep, args=(600.0,), daemon=True)
    other.start()

    def fails(self):
        left.start()
        raise OSError("no more processes")

    monkeypatch.setattr(Cluster, "_processes", fails)
    with pytest.raises(ClusterLostError):
        Cluster(1).start()
    left.join(60.0)
    assert left.exitcode == -signal.SIGKILL and other.is_alive()
    other.kill()


def _stopped(*_, **__):
    return SimpleNamespace(outcome=Outcome.INTERRUPTED)


@pytest.mark.parametrize(
    ("room", "work"),
    [
        (
            "studies.nonlinear.returns",
            lambda scenario: poincare(scenario, section_of("rate.hinge=0"), ["q[hinge]"]),
        ),
        ("studies.linear.modal_analysis", lambda scenario: modes(scenario, at=0.1)),
    ],
)
def test_a_signal_within_a_short_run_ends_what_the_run_is_for(monkeypatch, room, work):
    """The run takes it, and returns what it has: a part, of which nothing is to be concluded."""
    monkeypatch.setattr(f"antenna_pin.{room}.simulate", _stopped)
    with pytest.raises(KeyboardInterrupt):
        work(load_scenario("pendulum", case="ideal"))
