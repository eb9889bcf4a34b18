"""Dask between the driver and those who make runs: on this machine, and by a scheduler started by hand."""

import asyncio
import concurrent.futures
import contextlib
import gc
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request

import psutil
import pytest

from antenna_pin.studies.sweep import Cluster, Here, driver, run_study, scheduler
from antenna_pin.studies.sweep.cluster import ClusterLostError

PLAY = """
[parameters.play]
key = "clearance.bore.radial_clearance"
start = "0.1 mm"
stop = "0.2 mm"
count = 12
"""


@pytest.fixture(scope="module")
def cluster():
    """Two processes of this machine, that take seconds to start."""
    cluster = Cluster(2)
    try:
        cluster.start()
        yield cluster
    finally:
        cluster.close()


def test_processes_of_this_machine_make_the_store_of_one_process(write, tmp_path, cluster):
    """The same bytes; and what the processes have to load they load before they are asked for anything."""
    study = write(PLAY)
    until = time.monotonic() + 120.0
    while not all(cluster._client.run(_loaded).values()):
        assert time.monotonic() < until
        time.sleep(0.1)
    run_study(study, tmp_path / "two.study", executor=cluster)
    run_study(study, tmp_path / "here.study", executor=Here())
    two, here = (tmp_path / f"{name}.study" / "runs.nc" for name in ("two", "here"))
    assert two.read_bytes() == here.read_bytes()


def test_what_all_runs_share_is_with_every_process(cluster):
    """Batches go where it is: with one process alone, that one would make all the runs."""
    data = cluster._data(b"shared")
    (holders,) = cluster._client.who_has([data]).values()
    assert len(set(holders)) == cluster.width == 2


def test_no_page_tells_what_the_processes_do(cluster):
    """Any user of this machine could read it; Dask makes one wherever Bokeh is installed."""
    process = psutil.Process()
    for one in [process, *process.children(recursive=True)]:
        for connection in one.net_connections("tcp"):
            if connection.status == psutil.CONN_LISTEN:
                for page in ("status", "info/main/workers.html", "json/identity.json", "metrics", "health"):
                    with pytest.raises(OSError):  # 404, or no server of pages
                        urllib.request.urlopen(f"http://127.0.0.1:{connection.laddr.port}/{page}", timeout=5)


def test_ctrl_c_on_a_terminal_leaves_the_processes_alone(cluster):
    """Terminals and batch queues send signals to all of them: each would end, and some with a traceback."""
    before = cluster._client.run(os.getpid)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        for process in before.values():
            os.kill(process, number)
    time.sleep(0.5)
    assert cluster._client.run(os.getpid) == before


def test_what_fails_in_dasks_own_loop_makes_no_traceback(cluster, caplog, capfd):
    """As where it hears of the end of a process that it does not know. Errors of other tasks are logged."""
    closing = ("remove", "tls://127.0.0.1:1")

    class Told:
        async def read(self):
            return [closing]

    async def fails():
        raise ZeroDivisionError

    def in_the_loop():
        tasks = [cluster._local._watch_worker_status(Told()), fails()]
        for one in tasks:
            asyncio.ensure_future(one)
        cluster._local.loop.add_callback(cluster._local._update_worker_status, *closing)
        cluster._local.loop.call_later(0.1, done.set)

    done = threading.Event()
    cluster._local.loop.add_callback(in_the_loop)
    assert done.wait(60.0)
    gc.collect()
    said = caplog.text + capfd.readouterr().err
    assert "KeyError" not in said and "ZeroDivisionError" in said


@pytest.mark.slow
def test_a_stranger_on_this_machine_gives_no_orders(cluster):
    """Who has not the certificate of these very processes is refused by each of them, whatever uid it has."""
    about = cluster._client.scheduler_info()
    worker, told = next(iter(about["workers"].items()))
    scheduler.check_scheduler(about["address"], cluster._security)
    with pytest.raises(ClusterLostError, match="got that of a Worker"):  # so that much it tells who has it
        scheduler.check_scheduler(worker, cluster._security)
    for door in (about["address"], worker, told["nanny"]):
        for address, security in ((door.replace("tls", "tcp"), None), (door, scheduler.own_security())):
            with pytest.raises(ClusterLostError, match="must answer, got|of the authority|its refusal"):
                scheduler.check_scheduler(address, security)


@pytest.mark.slow
def test_the_only_process_may_be_killed(write, tmp_path, monkeypatch):
    """What the runs share is lost with it, and is given to the one that takes its place."""
    study = write(PLAY)
    monkeypatch.setattr(driver, "_LARGEST_BATCH", 1)
    cluster, seen = Cluster(1), []

    def kill_one(standing):
        if standing.stage == "run" and standing.done == 3 and not seen:
            seen.extend(cluster._client.run(os.getpid).values())
            os.kill(seen[0], signal.SIGKILL)

    try:
        run_study(study, tmp_path / "one.study", executor=cluster, progress=kill_one)
    finally:
        cluster.close()
    assert seen
    run_study(study, tmp_path / "here.study", executor=Here())
    one, two = (tmp_path / f"{name}.study" / "runs.nc" for name in ("one", "here"))
    assert one.read_bytes() == two.read_bytes()


def test_a_connection_that_closes_at_any_call_is_lost_in_one_line(monkeypatch):
    """Dask raises errors of several kinds then; here each of the client's calls does."""
    monkeypatch.setattr("antenna_pin.studies.sweep.cluster._LOOK_EVERY", 0.01)
    errors = (RuntimeError("ConnectionPool is closed"), OSError("closed"), TimeoutError("late"))
    for name, error in zip(("scatter", "submit", "nthreads"), errors, strict=True):
        cluster = Cluster(1)
        cluster._client = Closing(name, error)
        with pytest.raises(ClusterLostError, match="was lost: .*; finished runs are saved") as lost:
            list(cluster.each(len, "shared", iter([["a batch"]])))
        assert "\n" not in str(lost.value)


class Closing:
    """A client one of whose calls raises."""

    status = "running"

    def __init__(self, name, error):
        self.name, self.error, self.asked = name, error, 0

    def _said(self, name, answer):
        self.asked += name == "nthreads"
        if name == self.name and (name != "nthreads" or self.asked > 3):
            raise self.error
        return answer

    def scatter(self, *_, **__):
        return self._said("scatter", ["data"])

    def submit(self, *_, **__):
        return self._said("submit", concurrent.futures.Future())  # that never comes

    def nthreads(self):
        return self._said("nthreads", {"one": 1})

    def cancel(self, _):
        pass


def _loaded():
    return "antenna_pin.studies.sweep.jobs" in sys.modules


@pytest.fixture
def certificate(tmp_path):
    """Return a function that makes a certificate of its own authority, and names its files."""
    if shutil.which("openssl") is None:
        pytest.skip("certificates are made by openssl, which is not there")

    def made(name):
        cert, key = str(tmp_path / f"{name}.pem"), str(tmp_path / f"{name}.key")
        make = ["openssl", *"req -x509 -newkey rsa:2048 -nodes -days 2 -subj".split(), f"/CN={name}"]
        make += ["-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out", cert]
        subprocess.run(make, check=True, capture_output=True)
        return {"ca": cert, "cert": cert, "key": key}

    return made


@pytest.mark.slow
def test_a_scheduler_by_tls_takes_those_with_its_certificates_only(write, tmp_path, cli, certificate):
    """Started by hand as the guide says, with two workers that stand in a folder of their own."""
    study, own, other = write(PLAY), certificate("own"), certificate("other")
    port = free_port()
    address = f"tls://127.0.0.1:{port}"
    tls = ["--tls-ca-file", own["ca"], "--tls-cert", own["cert"], "--tls-key", own["key"]]
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    with contextlib.ExitStack() as started:
        at = ["--protocol", "tls", "--host", "127.0.0.1", "--port", str(port)]
        started.enter_context(_started("scheduler", folder, *at, *tls))
        for _ in range(2):
            started.enter_context(_started("worker", folder, address, "--nthreads", "1", "--no-nanny", *tls))
        given = ["sweep", study.folder / "trial.study.toml", "--no-progress", "--scheduler", address]
        files = [word for name, path in own.items() for word in (f"--tls-{name}", path)]
        said = cli(*given, "--out", "tls.study", *files)
        assert said.code == 0, said.err
        refused = cli(*given, "--out", "no.study", *files[:-1], other["key"])
        assert refused.code == 2 and len(refused.err.splitlines()) == 1 and "its own key" in refused.err
        for match, where, tls in (
            ("must have a certificate of the authority that is given, got one of another", address, other),
            # Its refusal may come as such, or as the end of the connection.
            ("got its refusal|is --tls-cert signed by its authority", address, other | {"ca": own["ca"]}),
            ("must answer, got: .*; .* is it not one of tls://", address.replace("tls", "tcp"), None),
        ):
            with pytest.raises(ClusterLostError, match=match) as error:
                Cluster(scheduler=where, tls=tls).start()
            assert "\n" not in str(error.value)
        kept = Cluster(scheduler=address, tls=own)
        kept.start()
        assert kept.width == 2
        worker = next(iter(kept._client.scheduler_info()["workers"]))
        kept.close()
        with pytest.raises(ClusterLostError, match="the address of a scheduler, got that of a Worker"):
            Cluster(scheduler=worker, tls=own).start()
    run_study(study, tmp_path / "here.study", executor=Here())
    one, two = (tmp_path / f"{name}.study" / "runs.nc" for name in ("tls", "here"))
    assert one.read_bytes() == two.read_bytes()
    assert not (tmp_path / "no.study").exists()


@pytest.mark.parametrize("secure", [False, pytest.param(True, marks=pytest.mark.slow)])
@pytest.mark.parametrize("peer", ["silent", "closed", "of another kind", "nobody"])
def test_what_is_no_scheduler_is_told_in_a_bounded_time(monkeypatch, certificate, peer, secure):
    """One that takes the connection and says nothing, that closes it, that speaks HTTP; and an empty port."""
    monkeypatch.setattr(scheduler, "ANSWERS_WITHIN", 0.2)
    address = f"{'tls' if secure else 'tcp'}://127.0.0.1"
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        address += f":{server.getsockname()[1]}"
        if peer != "nobody":
            server.listen()
            threading.Thread(target=_answer, args=(server, peer), daemon=True).start()
        began = time.monotonic()
        with pytest.raises(ClusterLostError, match=rf"scheduler {address}: must answer") as error:
            Cluster(scheduler=address, tls=certificate("own") if secure else None).start()
        # A second more to say it; the rest is for a machine that is busy.
        assert time.monotonic() - began < 0.2 + 1.0 + 30.0
        with contextlib.suppress(OSError):
            server.shutdown(socket.SHUT_RDWR)
    assert "\n" not in str(error.value)


def _answer(server, peer):
    with contextlib.ExitStack() as kept, contextlib.suppress(OSError):
        while True:
            connection = kept.enter_context(server.accept()[0])
            if peer == "closed":
                connection.close()
                continue
            if peer == "of another kind":
                connection.sendall(b"HTTP/1.0 400 Bad Request\r\n\r\n")


@pytest.mark.parametrize(
    ("address", "tls", "match"),
    [
        ("nonsense", {}, "must be an address tcp://HOST:PORT or tls://HOST:PORT"),
        ("", {}, "must be an address"),
        ("http://127.0.0.1:8786", {}, "must be an address"),
        ("tcp://127.0.0.1", {}, "must be an address"),
        ("tcp://127.0.0.1:99999", {}, "must be an address"),
        ("tls://127.0.0.1:8786", {}, "must be given the files"),
        (
            "tcp://127.0.0.1:8786",
            {"ca": "a", "cert": "b", "key": "c"},
            "must be one that is reached by tls://",
        ),
        (
            "tls://127.0.0.1:8786",
            {"ca": __file__, "cert": "b", "key": "c"},
            "--tls-ca .*: must hold the cert",
        ),
        ("tls://127.0.0.1:8786", {"ca": "/no/file", "cert": "b", "key": "c"}, "--tls-ca /no/file: must hold"),
    ],
)
def test_addresses_and_files_that_are_none(address, tls, match):
    with pytest.raises(ClusterLostError, match=match) as error:
        Cluster(scheduler=address, tls=tls)
    assert "\n" not in str(error.value)


def test_a_key_with_a_passphrase_is_refused_and_not_asked_for(tmp_path, certificate):
    own = certificate("own")
    locked = tmp_path / "locked.key"
    change = ["openssl", "rsa", "-aes256", "-passout", "pass:word", "-in", own["key"], "-out", str(locked)]
    subprocess.run(change, check=True, capture_output=True)
    with pytest.raises(ClusterLostError, match="the key without a passphrase"):
        Cluster(scheduler="tls://127.0.0.1:8786", tls=own | {"key": str(locked)})


def test_nothing_is_started_where_nothing_is_missing(write, tmp_path, fake):
    """The command of a study that has ended waits for no processes."""
    study = write()
    run_study(study, tmp_path / "trial.study", executor=fake())
    again = fake()
    again.start = lambda: pytest.fail("started")
    run_study(study, tmp_path / "trial.study", executor=again)
    assert again.made == []


def free_port():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


@contextlib.contextmanager
def _started(what, folder, *arguments):
    command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *arguments, "--no-dashboard"]
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        process.kill()
        process.wait()
