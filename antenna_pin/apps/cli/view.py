"""``antenna-pin view``: a run in 3D in the browser."""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
import webbrowser
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import load_result, not_interrupted, package_folders, say
from antenna_pin.apps.cli._options import option
from antenna_pin.apps.cli.record import CurveOption, IdealOption, JointOption, ViewName, ViewOption
from antenna_pin.errors import MissingToolError, OutputError

if TYPE_CHECKING:
    from antenna_pin.show.record import Recording


# Of systems with X or Wayland: one of these names the screen, or a browser is named that needs none.
_SCREENS = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")


def browser_for_pages(command: str, way_out: str) -> webbrowser.BaseBrowser:
    """Return the browser.

    Raises:
        MissingToolError: There is no screen, or no browser.
    """
    if sys.platform not in ("win32", "darwin") and not any(os.environ.get(name) for name in _SCREENS):
        raise MissingToolError(
            f"{command}: a browser needs a screen, and none of {', '.join(_SCREENS)} is set; {way_out}"
        )
    try:
        return webbrowser.get()
    except webbrowser.Error:
        raise MissingToolError(f"{command}: a browser must be installed, found none; {way_out}") from None


@contextlib.contextmanager
def opened_by_file(browser: webbrowser.BaseBrowser, address: str) -> Iterator[bool]:
    """Open an address that has a key in it; yield whether the browser has started.

    Every user of a machine reads the command lines of all programs. That of the browser has the name of a
    file which leads to the address, and which this user alone can read while the block lasts.
    """
    with tempfile.TemporaryDirectory(prefix="antenna-pin-") as folder:
        page = Path(folder) / "open.html"
        with open(os.open(page, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as file:
            there = escape(address, quote=True)
            file.write(f'<!doctype html><meta http-equiv="refresh" content="0; url={there}">\n')
        yield browser.open(page.as_uri())


def view(
    file: options.Result,
    ideal: IdealOption = None,
    view: ViewOption = ViewName.MECHANISM,
    joint: JointOption = None,
    curve: CurveOption = None,
    out: Annotated[
        Path | None,
        option("The page; by default in the result's folder, or in a temporary folder.", "NAME.html"),
    ] = None,
    package_path: options.PackagePath = None,
    browser: Annotated[bool, option("Open the page, or only make it and print its path.")] = True,
) -> None:
    """Show a run in 3D in the browser: make its page and open it.

    The page is that of record; it remains and can be opened again.
    """
    from antenna_pin.base.files import check_writable

    opened = browser_for_pages("view", "--no-browser makes the page and prints its path") if browser else None
    target = check_writable(out, ".html") if out is not None else None
    packages = package_folders(package_path)
    run = load_result(file)
    reference = None if ideal is None else load_result(ideal)

    from antenna_pin.show.record import record as make

    recording = make(
        run,
        reference,
        view=view.value,
        joint=joint,
        curves=curve or None,
        package_path=packages,
    )
    for text in (*recording.data["warnings"], *recording.data["thinned"]):
        say(f"note: {text}")
    with not_interrupted():
        page = recording.save(target) if target is not None else _save_nearby(recording, file)
        typer.echo(f"saved {page}")
    if opened is not None and not opened.open(page.resolve().as_uri()):
        raise MissingToolError(f"view: a browser must start, got none; open {page} in one")


def _save_nearby(recording: Recording, file: Path) -> Path:
    """Write the page beside the result, or in a temporary folder."""
    try:
        return recording.save(file.with_name(f"{file.stem}.view.html"))
    except OutputError:
        return recording.save(Path(tempfile.mkdtemp(prefix="antenna-pin-")) / "run.view.html")
