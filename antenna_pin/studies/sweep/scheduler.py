"""Reachability of a Dask scheduler at an address, within a bounded time.

Dask's own client waits forever for a peer that accepts the connection and stays silent, and prompts on the
terminal for the passphrase of a key. So the scheduler is contacted here first.
"""

from __future__ import annotations

import asyncio
import gc
import importlib
import ssl
import warnings
from typing import Any
from urllib.parse import urlsplit

from antenna_pin.errors import AntennaPinError, MissingToolError

ANSWERS_WITHIN = 20.0  # [s]


class ClusterLostError(AntennaPinError, RuntimeError):
    """Scheduler or workers that cannot be reached."""


def check_address(address: str, tls: dict[str, str]) -> None:
    """Refuse a malformed address, or one that contradicts the files for TLS."""
    try:
        parts = urlsplit(address)
        whole = parts.scheme in ("tcp", "tls") and bool(parts.hostname) and parts.port is not None
    except ValueError:  # a port that is no number, or too large
        whole = False
    if not whole:
        raise ClusterLostError(
            f"scheduler {address!r}: must be an address tcp://HOST:PORT or tls://HOST:PORT, as Dask's "
            f"scheduler prints at its start"
        )
    secure = address.startswith("tls://")
    if secure and len(tls) < 3:
        raise ClusterLostError(
            f"scheduler {address}: must be given the files of its authority, of a certificate and of its key "
            "(--tls-ca, --tls-cert, --tls-key)"
        )
    if tls and not secure:
        raise ClusterLostError(
            f"scheduler {address}: must be one that is reached by tls:// where files for TLS are given; "
            "leave them out, or write tls://"
        )


def security_of(tls: dict[str, str]) -> Any:
    """Return Dask's security for files ``ca``, ``cert`` and ``key``; None without files."""
    if not tls:
        return None
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    try:
        context.load_verify_locations(tls["ca"])
    except (OSError, ssl.SSLError) as error:
        raise ClusterLostError(
            f"--tls-ca {tls['ca']}: must hold the certificate of an authority as PEM, got: {words_of(error)}"
        ) from None
    try:
        # A key with a passphrase is not asked about on the terminal, where nobody may be.
        context.load_cert_chain(tls["cert"], tls["key"], password="")
    except (OSError, ssl.SSLError, ValueError) as error:
        raise ClusterLostError(
            f"--tls-cert {tls['cert']}, --tls-key {tls['key']}: must hold a certificate and its own key as "
            f"PEM, the key without a passphrase, got: {words_of(error)}"
        ) from None
    return importlib.import_module("distributed").Security(
        tls_ca_file=tls["ca"], tls_client_cert=tls["cert"], tls_client_key=tls["key"], require_encryption=True
    )


def own_security() -> Any:
    """Return Dask's security for local processes: a certificate of this run's own.

    A port of the loopback is open to every user of the machine, and a worker executes what is sent to it. The
    certificate is made again each time, and is stored in a file only while it is loaded from there.

    Raises:
        MissingToolError: The library that makes certificates is not installed.
    """
    try:
        return importlib.import_module("distributed").Security.temporary()
    except ImportError:
        raise MissingToolError(
            "studies on several cores keep other users of the machine out by a certificate, and need "
            "cryptography to make it; install it with pip install 'antenna-pin[studies]', or run them in "
            "this process with --workers 0"
        ) from None


def check_scheduler(address: str, security: Any) -> None:
    """Refuse an address without a scheduler, or without an answer within :data:`ANSWERS_WITHIN`."""
    problem = _problem(address, security)
    # Connections that are given up half-way are closed when they are let go of, which is now.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        gc.collect()
    if problem:
        raise ClusterLostError(f"scheduler {address}: {problem}")


def _problem(address: str, security: Any) -> str:
    """Return the fault of a scheduler's address, in words, or ""."""
    secure = address.startswith("tls://")
    try:
        kind = asyncio.run(_process_type(address, security))
    except TimeoutError:
        return (
            f"must answer within {ANSWERS_WITHIN:g} s, got silence; is it running, is the address right, and "
            f"does it speak {'TLS' if secure else 'plain TCP'}?"
        )
    except Exception as error:  # of sockets, TLS, Dask's protocol, or of reading what is none of these
        return _why(error, secure)
    return "" if kind == "Scheduler" else f"must be the address of a scheduler, got that of a {kind}"


async def _process_type(address: str, security: Any) -> str:
    """Return the type of a Dask process at an address."""
    core = importlib.import_module("distributed.comm.core")
    more = {} if security is None else security.get_connection_args("client")

    async def query() -> str:
        comm = await core.connect(address, timeout=ANSWERS_WITHIN, **more)
        try:
            await comm.write({"op": "identity", "reply": True})
            answer = await comm.read()
            return str(answer.get("type")) if isinstance(answer, dict) else type(answer).__name__
        finally:
            comm.abort()

    return await asyncio.wait_for(query(), ANSWERS_WITHIN + 1.0)


def _why(error: BaseException, secure: bool) -> str:
    """Return the fault of a connection as rule, value and way out."""
    chain: list[BaseException] = []
    now: BaseException | None = error
    while now is not None and now not in chain:
        chain.append(now)
        now = now.__cause__ or now.__context__
    texts = " ".join(str(one) for one in chain)
    if any(isinstance(one, ssl.SSLCertVerificationError) for one in chain):
        return (
            "must have a certificate of the authority that is given, got one of another; --tls-ca must be "
            "what the scheduler has as --tls-ca-file"
        )
    if "ALERT" in texts:
        return (
            "must take the certificate that is given, got its refusal; --tls-cert must be signed by the "
            "scheduler's authority"
        )
    if "Timed out" in texts:
        return (
            f"must answer within {ANSWERS_WITHIN:g} s, got: {words_of(chain[-1])}; is it running, and is the "
            "address right?"
        )
    # A scheduler that refuses a certificate may just close the connection, as one without TLS does.
    more = (
        "does it speak TLS, and is --tls-cert signed by its authority"
        if secure
        else "is it not one of tls://"
    )
    return f"must answer, got: {words_of(chain[-1])}; is it running, is the address right, {more}?"


def words_of(error: BaseException) -> str:
    """Return the message of an error on one line."""
    return " ".join(str(error).split())[:200] or type(error).__name__
