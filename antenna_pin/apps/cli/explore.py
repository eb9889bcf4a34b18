"""``antenna-pin explore``: a scenario's numbers under sliders, its run beside them, in the browser."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Annotated

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import complain, load, say
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli._progress import waiting_for_the_user
from antenna_pin.apps.cli.view import browser_for_pages, opened_by_file
from antenna_pin.base.interruption import acknowledge
from antenna_pin.errors import MissingToolError


def _say_stage(stage: str) -> None:
    complain(f"note: {stage}")


def explore(
    scenario: options.Scenario,
    case: options.Case = None,
    settings: options.Set = None,
    joint: Annotated[str | None, option("Joint shown first; the first one with play if left out.")] = None,
    duration: Annotated[str, option("Duration of the run after each change.", "TIME")] = "0.5 s",
    out: Annotated[
        Path | None,
        option(
            "Where 'Save as scenario' writes: a file, replaced each time, or a folder for numbered"
            " files; the working folder if left out.",
            "PATH",
        ),
    ] = None,
    port: Annotated[int, option("Port on this machine; a free one if 0.")] = 0,
    browser: Annotated[bool, option("Open the page, or only serve it and print its address.")] = True,
) -> None:
    """Change a scenario's numbers by sliders in the browser, and see its run.

    The page is served on this machine only, under an address with a key, until Ctrl-C.
    """
    _say_stage("loading")
    from antenna_pin.apps.live import check_bokeh

    check_bokeh()
    opened = (
        browser_for_pages("explore", "--no-browser serves the page and prints its address")
        if browser
        else None
    )
    chosen = load(scenario, case, settings)

    from antenna_pin.apps.live import explore as serve

    with (
        serve(chosen, joint=joint, duration=duration, port=port, out=out, progress=_say_stage) as exploration,
        contextlib.ExitStack() as while_served,
    ):
        try:
            with waiting_for_the_user():
                say(f"serving {exploration.url}")
                say("Ctrl-C ends it")
                if opened is not None and not while_served.enter_context(
                    opened_by_file(opened, exploration.url)
                ):
                    rule = "a browser must start, got none; --no-browser prints the address"
                    raise MissingToolError(f"explore: {rule}")
                exploration.wait()
        except KeyboardInterrupt:
            acknowledge()
            exploration.stop()
            say("ended")
