"""Dask between the driver and those who make runs: on this machine, and by a scheduler started by hand."""

import contextlib
import socket
import subprocess
import sys
import time

import pytest

from antenna_pin.sweep import Cluster, Here, run_study

PLAY = """
[parameters.play]
key = "clearance.bore.radial_clearance"
start = "0.1 mm"
stop = "0.2 mm"
count = 12
"""


def test_processes_of_this_machine_make_the_store_of_one_process(write, tmp_path):
    """The same bytes; and what the processes have to load they load before they are asked for anything."""
    study = write(PLAY)
    cluster = Cluster(2)
    try:
        cluster.start()
        until = time.monotonic() + 120.0
        while not all(cluster._client.run(_loaded).values()):
            assert time.monotonic() < until
            time.sleep(0.1)
        run_study(study, tmp_path / "two.study", executor=cluster)
    finally:
        cluster.close()
    run_study(study, tmp_path / "here.study", executor=Here())
    two, here = (tmp_path / f"{name}.study" / "runs.nc" for name in ("two", "here"))
    assert two.read_bytes() == here.read_bytes()


def _loaded():
    return "antenna_pin.sweep.work" in sys.modules


@pytest.mark.slow
def test_a_scheduler_by_tls_takes_those_with_a_certificate_only(write, tmp_path, cli):
    """Started by hand as the guide says, with a worker that stands in a folder of its own."""
    study = write(PLAY)
    cert, key = str(tmp_path / "cert.pem"), str(tmp_path / "key.pem")
    make = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=trial"]
    make += ["-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out", cert]
    subprocess.run(make, check=True, capture_output=True)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    address = f"tls://127.0.0.1:{port}"
    tls = ["--tls-ca-file", cert, "--tls-cert", cert, "--tls-key", key]
    own = tmp_path / "elsewhere"
    own.mkdir()
    scheduler = _started("scheduler", own, "--protocol", "tls", "--host", "127.0.0.1", "--port", port, *tls)
    worker = _started("worker", own, address, "--nthreads", "1", "--no-nanny", *tls)
    with scheduler, worker:
        given = ["sweep", study.folder / "trial.study.toml", "--no-progress", "--scheduler", address]
        refused = cli(*given, "--out", "no.study")
        assert refused.code == 2 and len(refused.err.splitlines()) == 1 and "--tls-key" in refused.err
        said = cli(*given, "--out", "tls.study", "--tls-ca", cert, "--tls-cert", cert, "--tls-key", key)
        assert said.code == 0, said.err
    run_study(study, tmp_path / "here.study", executor=Here())
    assert (tmp_path / "tls.study" / "runs.nc").read_bytes() == (
        tmp_path / "here.study" / "runs.nc"
    ).read_bytes()


@contextlib.contextmanager
def _started(what, folder, *arguments):
    command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *arguments, "--no-dashboard"]
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        process.kill()
        process.wait()
