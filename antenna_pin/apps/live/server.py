"""A server on this machine for one user, whose pages explore a scenario."""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import logging
import os
import secrets
import socket
import sys
import threading
from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path
from typing import Any

from antenna_pin.apps.live.explored import SPAN, Explored
from antenna_pin.apps.live.runner import COMPILING
from antenna_pin.base.arguments import takes
from antenna_pin.compiled.compile_time import told_of_compiling
from antenna_pin.errors import InvalidParameterError, MissingToolError, OutputError
from antenna_pin.scenario import Scenario, scenario_named

# Other machines do not reach it; other users of this one lack what the address has behind it.
_HERE = "127.0.0.1"
_HEIGHT = "980px"
_PORTS = 65535


def _write(stage: str) -> None:
    """Write a stage of the work on the error stream, if somebody still reads it."""
    with contextlib.suppress(OSError):
        sys.stderr.write(f"explore: {stage}\n")
        sys.stderr.flush()


@takes(duration="s")
def explore(
    scenario: Scenario | str | os.PathLike[str],
    *,
    joint: str | None = None,
    duration: float | str = SPAN,
    port: int = 0,
    out: Path | str | None = None,
    progress: Callable[[str], None] | None = _write,
) -> Exploration:
    """Serve a page with sliders for a scenario's numbers, on this machine only.

    In a notebook what is returned shows itself; else open its ``url`` in a browser.

    Args:
        scenario: Where it starts from; or its name or path.
        joint: Joint shown first; the first with play, or the first that moves.
        duration: How much of the run is made after each change [s].
        port: Where it listens; a free one if 0.
        out: Where "Save as scenario" writes: a file, or a folder for numbered ones; the working folder if
            left out.
        progress: Called with each stage of the work, a line of text: building, compiling, the first run of a
            page (these in the server's thread). The error stream has them if left out, nobody if None.

    Raises:
        AntennaPinError: The scenario cannot be explored.
        MissingToolError: Bokeh is not installed.
        OutputError: The port is taken, or there is no such folder.
    """
    assert not isinstance(duration, str)  # read already, by `takes`
    tell = progress or (lambda stage: None)
    tell("building the mechanism")
    check_bokeh()
    scenario = scenario_named(scenario)
    if not 0 <= port <= _PORTS:
        raise InvalidParameterError("explore", "port", f"from 0 to {_PORTS}", port)
    target = Path.cwd() if out is None else Path(out)
    if not target.is_dir() and not target.absolute().parent.is_dir():
        raise OutputError(f"{target}: the output's folder {str(target.parent)!r} does not exist; make it")
    left = [COMPILING]
    with told_of_compiling(lambda: tell(left.pop()) if left else None):
        Explored(scenario, joint, duration).scenario()
    return Exploration(scenario, joint, duration, port, target, tell)


def check_bokeh() -> None:
    """Refuse to go on where Bokeh is missing."""
    try:
        importlib.import_module("bokeh.server.server")
    except ImportError:
        raise MissingToolError(
            "explore needs bokeh; install it with pip install 'antenna-pin[explore]'"
        ) from None


def _application_for(hosts: Sequence[str]) -> Any:
    """Return Bokeh's application that answers requests to these hosts and ports alone.

    A page of another site, whose name an attacker has lead to this machine, comes with that name as its Host.
    """
    from bokeh.server.tornado import BokehTornado
    from tornado.web import ErrorHandler

    class OnlyForHosts(BokehTornado):  # type: ignore[misc]
        def find_handler(self, request: Any, **more: Any) -> Any:
            if request.host.lower() not in hosts:
                return self.get_handler_delegate(request, ErrorHandler, {"status_code": 403})
            return super().find_handler(request, **more)

    return OnlyForHosts


class Exploration:
    """A scenario that is being explored in a browser, served by a thread.

    Attributes:
        url: Where its page is, with the key that lets one in.
    """

    def __init__(
        self,
        scenario: Scenario,
        joint: str | None,
        duration: float,
        port: int,
        out: Path,
        tell: Callable[[str], None],
    ) -> None:
        """Listen, and serve from now on."""
        self._about = scenario, joint, duration, out, tell
        self._key = secrets.token_bytes(32)
        self._ready = threading.Event()
        self._failed: BaseException | None = None
        self.url = ""
        self._loop: Any = None
        self._thread = threading.Thread(
            target=self._serve, args=(port,), name="antenna-pin explore server", daemon=True
        )
        self._thread.start()
        self._ready.wait()
        if self._failed is not None:
            raise self._failed

    def _serve(self, port: int) -> None:
        from bokeh.application import Application
        from bokeh.application.handlers import FunctionHandler
        from bokeh.server.server import BaseServer
        from bokeh.util.token import generate_session_id
        from tornado.httpserver import HTTPServer
        from tornado.ioloop import IOLoop

        # A page that is closed while its run goes on is no fault.
        logging.getLogger("bokeh.server.views.ws").setLevel(logging.ERROR)
        loop = asyncio.new_event_loop()
        asyncio.set_event_loop(loop)
        try:
            listening = socket.create_server((_HERE, port))
            listening.setblocking(False)
            found = listening.getsockname()[1]
            hosts = [f"{_HERE}:{found}", f"localhost:{found}"]
            application = _application_for(hosts)(
                {"/": Application(FunctionHandler(self._fill))},
                extra_websocket_origins=hosts,
                secret_key=self._key,
                sign_sessions=True,
                generate_session_ids=False,
            )
            http = HTTPServer(application)
            http.add_sockets([listening])
            server = BaseServer(IOLoop.current(), application, http)
            server.start()
        except BaseException as error:
            self._failed = error
            if isinstance(error, OSError):
                said = error.strerror or str(error)
                self._failed = OutputError(
                    f"explore: port {port} must be free, got: {said}; leave --port out for a free one"
                )
            self._ready.set()
            loop.close()
            return
        key = generate_session_id(self._key, signed=True)
        self.url = f"http://{_HERE}:{found}/?bokeh-session-id={key}"
        self._loop = loop
        self._ready.set()
        try:
            loop.run_forever()
        finally:
            with contextlib.suppress(Exception):
                server.unlisten()
                server.stop()
            loop.run_until_complete(loop.shutdown_asyncgens())
            loop.close()

    def _fill(self, document: Any) -> None:
        from antenna_pin.apps.live.page import ExplorerPage

        ExplorerPage(document, *self._about)

    def wait(self) -> None:
        """Return when it has been stopped; Ctrl-C comes through."""
        while self._thread.is_alive():
            self._thread.join(0.2)

    def stop(self) -> None:
        """Serve no longer."""
        loop, self._loop = self._loop, None
        if loop is not None:
            loop.call_soon_threadsafe(loop.stop)
            self._thread.join(5.0)

    def __enter__(self) -> Exploration:
        return self

    def __exit__(self, *error: object) -> None:
        self.stop()

    def __repr__(self) -> str:
        state = f"at {self.url}" if self._thread.is_alive() else "stopped"
        return f"Exploration of {self._about[0].name} {state}"

    def _repr_html_(self) -> str:
        address = escape(self.url, quote=True)
        return f'<iframe src="{address}" style="width:100%;height:{_HEIGHT};border:0"></iframe>'
